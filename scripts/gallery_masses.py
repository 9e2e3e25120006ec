"""Pictures of the gallery: masses, bars, buildings; a function a case, its runs by deck."""

import numpy as np
from contact_solutions import bars_head_on
from exact_solutions import (
    ball_impact_times, bar_contact_force, bouncing_ball, masses_in_line, oscillator, two_dof,
)
from gallery_style import (
    BLUE, EXACT, GREEN, ORANGE, PURPLE, RED, SIGNED, STRESS, bar, body, figure, halves, key_below,
    nearest, note, wall, window,
)


def draw_sdof(runs):
    """The oscillator in front of its wall."""
    run = runs["sdof"]
    made, axes = figure("One mass on a spring hits a wall, e = 1")
    time = run.time
    fine = np.linspace(0, time[-1], 2001)
    exact = oscillator(time[-1])
    axes.plot(time, run.node(1).U1, color=BLUE, lw=5, alpha=0.55, label="carom, dt = 0.04")
    axes.plot(fine, exact.at(fine)[0], **EXACT, label="exact")
    hits = run.hits
    axes.plot(hits, np.full(len(hits), -0.5), "o", ms=9, color=RED, zorder=7, label="impacts")
    axes.set(xlim=(0, time[-1]), ylim=(-0.8, 1.1), xlabel="time", ylabel="displacement U1")
    wall(axes, -0.5, "wall")
    key_below(made, axes)
    return made


def draw_two_dof(runs):
    """Two masses, the second in front of a wall."""
    run = runs["two_dof"]
    made, axes = figure("Two masses on two springs, a wall for the second")
    time = run.time
    fine = np.linspace(0, time[-1], 3001)
    exact = two_dof(time[-1]).at(fine)[0]
    for i, (colour, name) in enumerate(((ORANGE, "mass 1"), (BLUE, "mass 2"))):
        axes.plot(time, run.node(i + 1).U1, color=colour, lw=5, alpha=0.55, label=name)
        axes.plot(fine, exact[i], **EXACT, label="exact" if i else None)
    hits = run.hits
    axes.plot(hits, np.full(len(hits), -0.5), "o", ms=9, color=RED, zorder=7, label="impacts")
    axes.set(xlim=(0, time[-1]), ylim=(-0.85, 1.2), xlabel="time", ylabel="displacement U1")
    wall(axes, -0.5, "wall of mass 2")
    key_below(made, axes, 4)
    return made


def draw_ball(runs):
    """Heights of bounces that come to an end."""
    made, axes = figure("A ball is dropped on a plane, e = 0.5")
    fine = np.linspace(0, 1.6, 4001)
    exact, _, rest = bouncing_ball(fine, 1.0, 10.0, 0.5)
    for name, colour, words in (("ball", BLUE, "transformation"),
                                ("ball_fictitious", ORANGE, "fictitious force")):
        run = runs[name]
        axes.plot(run.time, 1 + run.node(1).U2, color=colour, lw=5, alpha=0.6,
                  ls="-" if name == "ball" else (0, (1.2, 0.8)), label=words)
    axes.plot(fine, exact, **EXACT, label="exact")
    tops = ball_impact_times(rest, 1.0, 10.0, 0.5)
    for i, (left, right) in enumerate(zip(tops[:2], tops[1:3])):
        note(axes, 0.5 * (left + right), 0.25 ** (i + 1) + 0.035, f"{0.25 ** (i + 1):.4g}",
             ha="center")
    axes.axvline(rest, color="0.35", lw=1.4, ls=":")
    note(axes, rest - 0.015, 0.6, f"exact: at rest\nfrom {rest:.4f}", "0.2", ha="right")
    axes.set(xlim=(0, 1.6), ylim=(-0.12, 1.05), xlabel="time", ylabel="height of the ball")
    wall(axes, 0.0, "plane")
    key_below(made, axes)
    return made


def positions(title, runs_of, starts, gaps, speeds, masses, end):
    """Places of masses in a row over time, those that touch at the same place, with exact lines."""
    made, axes = figure(title)
    run = runs_of
    fine = np.linspace(0, end, 2001)
    exact = masses_in_line(end, masses, gaps, speeds, 0.7 if len(masses) == 2 else 1.0)[0]
    looks = zip((BLUE, ORANGE, GREEN, PURPLE), ("-", "--", "-.", (0, (1, 1))))
    for i, (colour, line) in enumerate(looks):
        if i == len(masses):
            break
        axes.plot(run.time, starts[i] + run.node(i + 1).U1, color=colour, lw=5,
                  alpha=0.7, ls=line, label=f"mass {i + 1}" if len(masses) > 2
                  else f"mass of {masses[i]:g}", zorder=2 + i)
        axes.plot(fine, starts[i] + exact.at(fine)[0][i], **EXACT,
                  label="exact" if i == len(masses) - 1 else None)
    axes.set(xlabel="time", xlim=(0, end))
    key_below(made, axes, 5)
    return made, axes


def draw_colliding_masses(runs):
    """Two masses meet, e = 0.7."""
    run = runs["colliding_masses"]
    made, axes = positions("Two free masses collide, e = 0.7", run, (0.0, 1.0), (1.0,),
                           (2.0, -1.0), (3.0, 1.0), 2.0)
    axes.set_ylabel("place x = X + U1")
    axes.plot(run.hits, [2 / 3], "o", ms=10, color=RED, zorder=8)
    axes.annotate("impact at 1/3", (1 / 3, 2 / 3), (0.62, 0.0), fontsize=14,
                  arrowprops={"arrowstyle": "->"})
    after = [run.node(i).V1[-1] for i in (1, 2)]
    note(axes, 0.19, 0.0, "velocity 2", BLUE, weight="bold")
    note(axes, 0.02, 1.2, "velocity −1", "#9a6a00", weight="bold")
    note(axes, 1.3, 0.85, f"velocity {after[0]:.3f}", BLUE, weight="bold")
    note(axes, 1.2, 3.5, f"velocity {after[1]:.3f}", "#9a6a00", weight="bold", ha="right")
    return made


def draw_cradle(runs):
    """The impact runs through the row."""
    run = runs["cradle"]
    starts = (0.0, 0.5, 0.6, 0.7)
    made, axes = positions("Newton's cradle: four equal masses, e = 1", run, starts,
                           (0.5, 0.1, 0.1), (1.0, 0.0, 0.0, 0.0), (1.0,) * 4, 1.4)
    hits = run.hits
    axes.plot(hits, [0.5, 0.6, 0.7], "o", ms=10, color=RED, zorder=9)
    axes.annotate("impacts at 0.5, 0.6, 0.7", (0.6, 0.6), (0.1, 1.05), fontsize=14,
                  arrowprops={"arrowstyle": "->"})
    axes.set(ylabel="place (widths of balls left out)", ylim=(-0.05, 1.45))
    return made


def draw_bar(runs):
    """Contact force, and the wave in the bar."""
    made, axes = figure("An elastic bar hits a wall and leaves it", 2, 1, sharex=True,
                        height_ratios=(1.25, 1))
    for name, colour, line, words in (
            ("bar_fictitious", ORANGE, "-", "fictitious force"),
            ("bar_implicit", BLUE, "-", "implicit"), ("bar_explicit", GREEN, "--", "explicit")):
        run = runs[name]
        axes[0].plot(run.time, np.abs(run.pair.CF1), color=colour, ls=line, label=words,
                     lw=1.6 if name == "bar_fictitious" else 3, alpha=0.9)
    fine = np.linspace(0.3, 1.4, 5001)
    axes[0].plot(fine, bar_contact_force(fine)[0], **EXACT, label="exact")
    axes[0].set(ylabel="contact force", xlim=(0.4, 1.3), ylim=(-20, 400))
    key_below(made, axes[0], 4)
    run = runs["bar_implicit"]
    mesh = run.mesh
    cells, points = mesh.lines(True)
    middle = mesh.points[points, 0].mean(axis=1)
    order = np.argsort(middle)
    stress = np.array([mesh.component("Cell", "S11", frame)[cells][order]
                       for frame in range(mesh.n_frames)])
    painted = axes[1].pcolormesh(mesh.times, middle[order] - mesh.points[:, 0].min(), stress.T,
                                 cmap=STRESS, vmin=-320, vmax=0, rasterized=True, shading="nearest")
    axes[1].set(xlabel="time", ylabel="place in\nthe bar", ylim=(0, 10))
    axes[1].grid(False)
    bar(made, painted, axes[1], "stress S11", aspect=9, ticks=[-300, -150, 0])
    return made


def draw_buildings(runs):
    """The third floors, which meet most, and the tops."""
    run = runs["buildings"]
    made, axes = figure("Two buildings 3 cm apart pound in an earthquake", 2, 1,
                        height_ratios=(1.3, 1))
    time = run.time
    left, right = (100 * run.node(n).U1 for n in (13, 23))
    axes[0].plot(time, left, color=BLUE, label="left, 3 storeys")
    axes[0].plot(time, right + 3, color=ORANGE, ls="--", label="right, 5 storeys")
    hits = np.unique(run.hits)
    axes[0].plot(hits, np.interp(hits, time, left), "o", color=RED, ms=7, zorder=7,
                 label="impacts")
    axes[0].set(xlim=(1.4, 6), ylim=(-7, 17), ylabel="U1 (cm)")
    axes[0].set_title("third floors, the right one 3 cm further", fontsize=14)
    axes[1].plot(time, 100 * run.node(13).U1, color=BLUE, lw=1.6)
    axes[1].plot(time, 100 * run.node(25).U1, color=ORANGE, lw=1.6, ls="--")
    axes[1].set(xlim=(0, 20), xlabel="time (s)", ylabel="U1 (cm)", ylim=(-14, 14))
    axes[1].set_title("tops", fontsize=14)
    key_below(made, axes[0])
    return made


def mean_velocity(mesh, chosen, frame):
    """Mean V1 of the cells chosen (masks by type of solid), which are of one size."""
    v = mesh.values("Point", "V", frame)[:, 0]
    return np.concatenate([v[mesh.block(kind)[1][mask]].mean(axis=1)
                           for kind, mask in chosen.items()]).mean()


def draw_two_bars(runs):
    """A short bar on a long one: contact force and mean velocities."""
    run = runs["short_on_long"]
    made, axes = figure("A bar of length 5 hits one of 10 at rest", 2, 1, sharex=True)
    force, duration, short, long = bars_head_on(5.0, 10.0, 10.0, 0.0)
    begin, end = 0.05, 0.05 + duration
    fine = np.linspace(0, 1, 5001)
    axes[0].plot(run.time, np.abs(run.pair.CF1), color=BLUE, label="carom")
    axes[0].plot(fine, np.where((fine >= begin) & (fine < end), force, 0), **EXACT, label="exact")
    axes[0].set(ylabel="contact force", xlim=(0, 0.7), ylim=(-10, 195))
    axes[0].legend(loc="upper right")
    mesh = run.mesh
    middle = 0.5 * (mesh.points[:, 0].min() + mesh.points[:, 0].max()) - 2.5
    for side, colour, line, after, before, words in (
            (-1, BLUE, "-", short, 10.0, "short bar"), (1, ORANGE, "-.", long, 0.0, "long bar")):
        chosen = {kind: side * (mesh.points[mesh.block(kind)[1], 0].mean(axis=1) - middle) > 0
                  for kind in mesh.solids()}
        mean = [mean_velocity(mesh, chosen, f) for f in range(mesh.n_frames)]
        axes[1].plot(mesh.times, mean, color=colour, ls=line, marker="o", ms=6, label=words)
        axes[1].plot([0, begin, end, 1], [before, before, after, after], **EXACT)
        note(axes[1], 0.69, after + 0.9, f"exact {after:.4g}".replace("-0", "0"), ha="right")
    axes[1].set(xlabel="time", ylabel="mean velocity", ylim=(-1.5, 11.5))
    axes[1].legend(loc="upper right")
    return made


def draw_pounding_frame(runs):
    """The frames at a blow, and their floors."""
    run = runs["frames"]
    made, left, right = halves("Two concrete frames 1 cm apart pound", 1.35)
    axes = dict(zip("ab", left.subplots(2, 1)))
    mesh = run.mesh
    low, high = mesh.points[:, :2].min(axis=0), mesh.points[:, :2].max(axis=0)
    for name, wanted, words in (("a", 0.2, "apart"), ("b", 0.38, "in contact")):
        frame = nearest(mesh.times, wanted)
        painted = body(axes[name], mesh, frame, "S22", (-4000, 4000), 30, SIGNED, 0.15)
        window(axes[name], low - (1.4, 0.1), high + (0.9, 0.2),
               f"{words}, time {mesh.times[frame]:.2f} s")
    bar(left, painted, [axes["a"], axes["b"]], "S22 (kPa), displacements × 30", location="bottom",
        aspect=18, ticks=[-4000, 0, 4000])
    time, axis = run.time, right.subplots()
    slender, stiff = (1000 * run.node(node).U1 for node in run.nodes)
    axis.plot(time, slender, color=BLUE, label="slender")
    axis.plot(time, stiff + 10, color=ORANGE, ls="--", label="stiff")
    axis.fill_between(time, 0, 1, where=run.pair.CNUM > 0, color=RED, alpha=0.25, lw=0,
                      transform=axis.get_xaxis_transform(), label="in contact")
    axis.set(xlabel="time (s)", xlim=(0, 1), ylabel="U1 (mm)", ylim=(-30, 30))
    axis.set_title("first floors, the stiff one 10 mm further", fontsize=14)
    key_below(right, axis)
    return made
