"""Pictures of the gallery: bodies before, at and after a blow; a function a case."""

import numpy as np
from gallery_style import (
    BLUE, EXACT, ORANGE, SPEED, STRESS, WALL, bar, body, ground, halves, lines_of, mosaic,
    nearest, window,
)


def before_at_after(made, axes, mesh, times, look, reach, plane=None, scale=1.0, unit=("", 1)):
    """Frames side by side in the same window and colours: look is the field, its limits, colours
    and words, unit that of time and what makes it."""
    (field, limits, colours, words), (low, high) = look, reach
    for axis, wanted in zip(axes, times):
        frame = nearest(mesh.times, wanted)
        painted = body(axis, mesh, frame, field, limits, scale, colours, 0.15)
        window(axis, low, high, f"time {unit[1] * mesh.times[frame]:.3g}{unit[0]}")
        if plane is not None:
            ground(axis, plane, low[0], high[0], plane - low[1])
    return bar(made, painted, axes, words, aspect=14)


def draw_dropped_disc(runs):
    """Before, at and after; contact force by two methods."""
    made, axes = mosaic("An elastic disc is dropped on a plane", [["a", "b", "c"], ["f"] * 3],
                        height_ratios=(1.25, 1))
    mesh = runs["q4"].mesh
    low, high = lines_of(mesh)
    plane = low[1] - 0.01
    before_at_after(made, [axes[k] for k in "abc"], mesh, (0.02, 0.32, 1.0),
                    ("MISES", (0, 12), STRESS, "Mises stress"),
                    ((low[0] - 0.1, plane - 0.18), high + (0.1, 0.22)), plane=plane)
    for name, colour, line, words in (("q4_fictitious", ORANGE, "--", "fictitious force"),
                                      ("q4", BLUE, "-", "transformation")):
        run = runs[name]
        axes["f"].plot(run.time, np.abs(run.pair.CF2), color=colour, ls=line, label=words)
    axes["f"].set(xlabel="time", ylabel="contact force", xlim=(0, 1.1), ylim=(-0.3, 9.5))
    axes["f"].legend(loc="upper right")
    return made


def draw_two_discs(runs):
    """An oblique blow with friction."""
    made, axes = mosaic("A disc hits a stiffer one beside its middle, μ = 0.2",
                        [["a", "b", "c"], ["f"] * 3], height_ratios=(1.6, 1))
    run = runs["oblique"]
    mesh = run.mesh
    last = nearest(mesh.times, 1.2)
    places = np.concatenate([mesh.place(f, 1.0) for f in (0, last)])
    low, high = places.min(axis=0) - 0.08, places.max(axis=0) + 0.08
    number, time = run.pair.CNUM, run.time
    middle = time[number > 0].mean()
    before_at_after(made, [axes[k] for k in "abc"], mesh, (0, middle, 1.2),
                    ("MISES", (0, 8), STRESS, "Mises stress"), (low, high))
    force, push = np.abs(run.pair.CF1), np.abs(run.pair.CF2)
    axes["f"].plot(time, force, color=BLUE, label="along x")
    axes["f"].plot(time, push, color=ORANGE, ls="--", label="along y")
    axes["f"].set(xlabel="time", ylabel="contact force", xlim=(0, 1.2),
                  ylim=(-0.03 * force.max(), 1.15 * force.max()))
    axes["f"].legend(loc="upper right")
    return made


def draw_block(runs):
    """A pressure wave goes to the free side and back."""
    made, axes = mosaic("A block is thrown at a wall", [["a", "b", "c"], ["f"] * 3],
                        height_ratios=(1.25, 1))
    run = runs["block"]
    mesh = run.mesh
    low, high = lines_of(mesh)
    dt = run.time[1]
    before_at_after(made, [axes[k] for k in "abc"], mesh, (0, 30 * dt, 100 * dt),
                    ("V1", (-1, 1), SPEED, "velocity V1"), (low - (0.12, 0.05), high + 0.05))
    for k in "abc":
        axes[k].axvspan(low[0] - 0.12, low[0] - 5.4 * dt, **WALL)
    axes["f"].plot(1000 * run.time, np.abs(run.pair.CF1), color=BLUE, label="carom")
    speed = 1 / 40 / dt
    axes["f"].plot([0, 5.4e3 * dt, 5.4e3 * dt, 85.4e3 * dt, 85.4e3 * dt, 75],
                   [0, 0, speed, speed, 0, 0], **EXACT,
                   label="plane wave ρ c v")
    axes["f"].set(xlabel="1000 × time", ylabel="contact force", xlim=(0, 75),
                  ylim=(-2, 1.25 * max(speed, np.abs(run.pair.CF1).max())))
    axes["f"].legend(loc="lower center")
    return made


def draw_from_gmsh(runs):
    """The ring becomes an oval, and leaves."""
    made, axes = mosaic("A nylon ring falls on a plane (mesh of gmsh)",
                        [["a", "b", "c"], ["f"] * 3], height_ratios=(1.35, 1))
    run = runs["ring"]
    mesh = run.mesh
    low, high = lines_of(mesh)
    scale = 3.0
    plane = low[1] - 0.2 * scale  # the gap is as much larger as the displacements
    lowest = run.time[int(np.argmin(run.node(run.nodes[0]).U2))]
    before_at_after(made, [axes[k] for k in "abc"], mesh, (0, lowest, 3e-3),
                    ("MISES", (0, 16), STRESS, "Mises (MPa)"),
                    ((low[0] - 8, plane - 9), high + (8, 9)), plane=plane, scale=scale,
                    unit=(" ms", 1000))
    axes["f"].set_title("above: displacements × 3", fontsize=13.5, loc="right")
    axes["f"].plot(1000 * run.time, np.abs(run.pair.CF2), color=BLUE)
    axes["f"].set(xlabel="time (ms)", ylabel="contact force (N)", xlim=(0, 4))
    return made


def draw_from_freecad(runs):
    """The arch at rest under its load, and thrown on a plane."""
    made, left, right = halves("A steel arch, loaded and dropped (mesh of FreeCAD)", 1.0)
    rest, blow = runs["export/FEMMeshGmsh"], runs["impact"]
    axes = left.subplots(2, 1)
    for axis, run, frame, scale, words in (
            (axes[0], rest, -1, 200, "1000 N on the crown"),
            (axes[1], blow, nearest(blow.frames.times, 4e-5), 200, "dropped, at 0.04 ms")):
        mesh = run.mesh
        low, high = lines_of(mesh)
        frame = frame % mesh.n_frames
        painted = body(axis, mesh, frame, "MISES", (0, 40), scale, STRESS, 0.2)
        window(axis, low - (10, 8), high + (10, 6), words)
        plane = low[1] - (0.01 * scale if run is blow else 0.0)  # the gap grows as displacements
        ground(axis, plane, low[0] - 10, high[0] + 10, 6)
    bar(left, painted, list(axes), "Mises (MPa), displacements × 200",
        location="bottom")
    above, below = right.subplots(2, 1, sharex=True)
    above.plot(1000 * blow.time, np.abs(blow.pair.CF2), color=BLUE)
    above.set(ylabel="contact force (N)")
    crown = blow.node(blow.nodes[0])
    below.plot(1000 * blow.time, crown.V2 / 1000, color=ORANGE, lw=1.3)
    below.set(ylabel="crown V2 (m/s)", xlabel="time (ms)", xlim=(0, 0.5), xticks=(0, 0.2, 0.4))
    return made
