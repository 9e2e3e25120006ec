"""Pictures of the gallery: solids, friction, cracks; a function a case, its runs by deck."""

import numpy as np
from contact_solutions import (
    hertz_line, hertz_pressure, oblique_bounce, slope_acceleration, stopping,
)
from exact_solutions import bar_contact_force
from gallery_style import (
    BLACK, BLUE, EXACT, GREEN, ORANGE, PURPLE, SIGNED, SPEED, STRESS, WALL, bar, body, figure,
    ground, halves, key_below, lines_of, mosaic, nearest, note, window,
)
from plot_contact import surfaces


def draw_cantilever(runs):
    """Bent by a force at its tip, and three modes."""
    made, axes = mosaic("A cantilever of plane elements, bent and vibrating",
                        [["s"] * 3, ["a", "b", "c"]], height_ratios=(1.15, 1))
    mesh, modes = runs["cantilever"].mesh, runs["modes"].mesh
    deflection = np.abs(mesh.values("Point", "U", 1)[:, 1]).max()
    frequency = runs["modes"].frequencies
    undeformed(axes["s"], mesh)
    painted = body(axes["s"], mesh, 1, "S11", (-6e5, 6e5), 1e4, SIGNED)
    window(axes["s"], (-0.03, -0.3), (1.06, 0.07),
           f"1000 N at the tip: {deflection:.4g} m (beam: 1.919e-05 m)")
    drawn = bar(made, painted, axes["s"], "S11 (MPa)", aspect=10, ticks=[-6e5, 0, 6e5])
    drawn.ax.set_yticklabels(["−0.6", "0", "0.6"])
    note(axes["s"], 0.02, -0.25, "displacements × 10 000")
    axial = int(np.argmin(np.abs(frequency - 1299.0)))
    for name, mode, words, beam in (("a", 0, "bending", "83.17"), ("b", 1, "bending", "498.8"),
                                    ("c", axial, "axial", "1297")):
        u = modes.values("Point", "U", mode)[:, :2]
        undeformed(axes[name], modes)
        most = u.flat[np.argmax(np.abs(u))]  # its sign is nobody's choice: up, and outward
        body(axes[name], modes, mode, scale=0.14 / most)
        window(axes[name], (-0.03, -0.26), (1.16, 0.26),
               f"{words}, {frequency[mode]:.4g} Hz\n(beam: {beam} Hz)")
    return made


def undeformed(axes, mesh):
    """The outline before."""
    for block in mesh.boundary(mesh.points[:, :2], 2):
        for edge in block:
            axes.plot(*edge.T, color="0.35", lw=1.0, ls=(0, (4, 2)), zorder=5)


def along_radius(mesh, frame):
    """Radius and stresses at the nodes of the lower side: r, radial, hoop."""
    line = np.flatnonzero(mesh.points[:, 1] < 1e-9)
    line = line[np.argsort(mesh.points[line, 0])]
    stress = mesh.values("Point", "S", frame)[line]
    return mesh.points[line, 0], stress[:, 0], stress[:, 2]


def draw_thick_cylinder(runs):
    """Stresses through the wall, elastic and beyond yield."""
    made, axes = figure("A thick cylinder under pressure, elastic and plastic", 1, 2, sharex=True)
    r = np.linspace(1, 2, 401)
    radial = 100 / 3 * (1 - 4 / r**2), 100 / 3 * (1 + 4 / r**2)
    k, c = 240 / np.sqrt(3), 1.5
    outer = k * c**2 / 4
    inside = outer * (1 - 4 / c**2) + 2 * k * np.log(r / c)
    yielded = (np.where(r < c, inside, outer * (1 - 4 / r**2)),
               np.where(r < c, inside + 2 * k, outer * (1 + 4 / r**2)))
    for axis, name, exact, frame, title in (
            (axes[0], "elastic_cax8", radial, 1, "pressure 100"),
            (axes[1], "plastic_cax4", yielded, 10, "pressure 173, yield stress 240")):
        place, *stress = along_radius(runs[name].mesh, frame)
        every = slice(None) if len(place) < 40 else slice(None, None, 4)
        for values, colour, mark, words in zip(stress, (BLUE, ORANGE), "os", ("radial", "hoop")):
            axis.plot(place[every], values[every], mark, color=colour, ms=7,
                      label=f"{words} stress")
        for i, curve in enumerate(exact):
            axis.plot(r, curve, **EXACT, label=None if i else "exact")
        axis.set(xlabel="radius", xlim=(0.96, 2.04))
        axis.set_title(title, fontsize=14)
    axes[0].set_ylabel("stress")
    axes[1].axvspan(1, 1.5, color=PURPLE, alpha=0.2, lw=0)
    note(axes[1], 1.25, -60, "plastic\nto r = 1.5", "#7a2f5c", ha="center")
    key_below(made, axes[0])
    return made


def draw_strip(runs):
    """The wave in the strip at four times, and the contact force."""
    made, axes = mosaic("A strip of plane elements flies against a wall", [["force"], ["strip"]],
                        height_ratios=(1.3, 1))
    speed = (4 * 0.7 / (1.3 * 0.4)) ** 0.5
    begin = 0.0001 / 0.01
    end, height = begin + 2 / speed, speed * 0.01 * 0.05
    force = axes["force"]
    for name, colour, line in (("implicit", BLUE, "-"), ("explicit", ORANGE, "--")):
        force.plot(runs[name].time, 1000 * np.abs(runs[name].pair.CF1), color=colour, ls=line,
                   label=name)
    t = np.linspace(-0.1, 1.31, 6001)
    force.plot(t, 1000 * np.where((t >= begin) & (t < end), height, 0), **EXACT, label="exact")
    force.set(xlim=(-0.05, 1.3), ylim=(-0.1, 2.0), xlabel="time",
              ylabel="1000 ×\ncontact force")
    force.legend(loc="upper right", bbox_to_anchor=(1.0, 1.05))
    strip, mesh = axes["strip"], runs["implicit"].mesh
    painted = None
    for row, wanted in enumerate((0.0, 0.2, 0.6, 1.2)):
        frame = nearest(mesh.times, wanted)
        value = mesh.component("Point", "V1", frame)
        line = np.flatnonzero(mesh.points[:, 1] < 1e-9)
        line = line[np.argsort(mesh.points[line, 0])]
        x = mesh.points[line, 0] + mesh.values("Point", "U", frame)[line, 0]
        painted = strip.pcolormesh(
            x, [-row - 0.35, -row + 0.35], np.tile(value[line] * 1000, (2, 1)), shading="gouraud",
            cmap=SPEED, vmin=-10, vmax=10)
        strip.text(1.02, -row, f"t = {mesh.times[frame]:.1f}", va="center", fontsize=13.5)
    strip.axvspan(-0.03, -0.0001, **WALL)
    strip.set(xlim=(-0.03, 1.16), ylim=(-3.6, 0.6), yticks=[])
    strip.set_xlabel("x, the wall at 0")
    strip.spines["left"].set_visible(False)
    strip.grid(False)
    bar(made, painted, strip, "1000 × V1", aspect=9, ticks=[-10, 0, 10])
    return made


def draw_elastic_strip(runs):
    """The force at the wall, whole and about its plateau, and the bulged strip."""
    made, axes = mosaic("An elastic strip hits a wall, four ways",
                        [["whole", "plateau"], ["mesh", "mesh"]], height_ratios=(2.3, 1))
    looks = (("q4_fictitious", ORANGE, "-", "fictitious force"), ("q8", PURPLE, "-.", "8 nodes"),
             ("q4", BLUE, "-", "4 nodes"), ("q4_massless", GREEN, "--", "no mass in contact"))
    fine = np.linspace(0.3, 1.4, 6001)
    for axis in (axes["whole"], axes["plateau"]):
        for name, colour, line, words in looks:
            axis.plot(runs[name].time, np.abs(runs[name].pair.CF1), color=colour, ls=line,
                      label=words, lw=1.6 if name in ("q4_fictitious", "q8") else 2.6)
        axis.plot(fine, bar_contact_force(fine)[0], **EXACT, label="exact")
        axis.set_xlabel("time")
    axes["whole"].set(xlim=(0.4, 1.3), ylim=(-15, 420), ylabel="contact force")
    axes["plateau"].set(xlim=(0.55, 1.12), ylim=(270, 330))
    axes["plateau"].set_title("the plateau, 300 ± 10 %", fontsize=14)
    mesh = runs["q4"].mesh
    frame = nearest(mesh.times, 0.5 + 1 / 6)
    low, high = lines_of(mesh)
    painted = body(axes["mesh"], mesh, frame, "V1", (-10, 0), 1.0, SPEED, 0.12)
    place = mesh.place(frame, 1.0)
    start = place[:, 0].min()
    axes["mesh"].axvspan(start - 0.4, start, **WALL)
    window(axes["mesh"], (start - 0.4, low[1] - 0.25), (place[:, 0].max() + 0.2, high[1] + 0.25))
    bar(made, painted, axes["mesh"], "V1", aspect=7, ticks=[-10, -5, 0], shrink=1.0)
    note(axes["mesh"], place[:, 0].max() - 0.2, np.mean([low[1], high[1]]), "time 0.67", ha="right",
         va="center")
    key_below(made, axes["whole"], 3)
    return made


def pressures(mesh):
    """Place and pressure along the contact of the last frame, in the order of the place."""
    found = surfaces(mesh)[0]
    order = np.argsort(found.place[:, 0])
    return found.place[order, 0], found.pressure(mesh.n_frames - 1)[order], found


def draw_hertz(runs):
    """Pressure against Hertz, and the stress below it."""
    made, left, right = halves("Two discs pressed together: line contact of Hertz", 1.4)
    axes = {"mesh": left.subplots(), "pressure": right.subplots()}
    radius, modulus = 0.75, 998.901
    mesh = runs["nonmatching"].mesh
    _, _, found = pressures(mesh)
    force = 2 * np.linalg.norm(found.forces(mesh.n_frames - 1).sum(axis=0))
    width, peak = hertz_line(force, radius, modulus)
    axis = axes["pressure"]
    for name, colour, mark, words in (("nonmatching_nodes", ORANGE, "s", "rows at nodes"),
                                      ("nonmatching", BLUE, "o", "weighted rows")):
        place, values, _ = pressures(runs[name].mesh)
        shown = place < 1.4 * width
        axis.plot(place[shown], values[shown], mark, color=colour, ms=8 if mark == "s" else 6,
                  label=words, mfc="white" if mark == "s" else colour, mew=1.8)
    fine = np.linspace(0, width, 400)
    axis.plot(np.append(fine, 1.3 * width),
              np.append(hertz_pressure(fine, force, radius, modulus), 0), **EXACT, label="Hertz")
    axis.set(xlabel="x from the middle of the contact", ylabel="contact pressure",
             xlim=(-0.03 * width, 1.3 * width), ylim=(-0.03 * peak, 1.3 * peak))
    axis.legend(loc="upper right")
    reach = 3.2 * width
    painted = body(axes["mesh"], mesh, mesh.n_frames - 1, "S22", (-peak, 0), 1.0, STRESS, 0.2)
    level = mesh.place(mesh.n_frames - 1, 1.0)[found.points, 1]
    level = level[np.argsort(found.place[:, 0])][0]
    window(axes["mesh"], (0, level - 0.62 * reach), (reach, level + 0.62 * reach),
           "nonmatching meshes,\nx ≥ 0")
    bar(left, painted, axes["mesh"], "stress S22", location="bottom", aspect=16)
    return made


def draw_sliding_block(runs):
    """Velocities on the level and on the slope, against Coulomb."""
    made, axes = mosaic("Blocks slide on rough planes, μ = 0.3", [["v", "a"], ["v", "b"]],
                        width_ratios=(1.7, 1))
    level, slope = runs["sliding"], runs["slope"]
    v = axes["v"]
    time = np.linspace(0, 2, 401)
    _, stop = stopping(5.0, 0.3)
    v.plot(level.time, level.node(level.nodes[0]).V1, color=BLUE, lw=5, alpha=0.6,
           label="level plane, carom")
    seen = slope.node(slope.nodes[0])
    along = np.hypot(seen.V1, seen.V2)
    v.plot(slope.time, along, color=ORANGE, lw=5, alpha=0.7, ls=(0, (1.5, 0.6)),
           label="slope of 30°, carom")
    v.plot(time, np.maximum(5 - 0.3 * 9.81 * time, 0), **EXACT, label="exact")
    v.plot(time[time <= 1], slope_acceleration(np.pi / 6, 0.3) * time[time <= 1], **EXACT)
    v.set(xlabel="time", ylabel="velocity along the plane", xlim=(0, 2), ylim=(-0.2, 7.2))
    v.legend(loc="upper right")
    note(v, 1.45, 1.3, f"stops at\n{stop:.3f}")
    for key, run, wanted, title in (("a", level, 0.5, "level, time 0.5"),
                                    ("b", slope, 0.5, "slope, time 0.5")):
        mesh = run.mesh
        frame = nearest(mesh.times, wanted)
        painted = body(axes[key], mesh, frame, "MISES", (0, 15), 1.0, STRESS, 0.3)
        place = mesh.place(frame, 1.0)
        low, high = place.min(axis=0) - 0.3, place.max(axis=0) + 0.3
        if key == "a":
            ground(axes[key], 0.0, low[0], high[0], 0.3)
        else:
            x = np.array([low[0] - 3, high[0] + 3])
            axes[key].fill_between(x, -9, -x / np.sqrt(3), **WALL)
        window(axes[key], low, high, title)
    bar(made, painted, [axes["a"], axes["b"]], "Mises stress", aspect=20)
    return made


def draw_oblique_ball(runs):
    """The path of the point, and the forces on the disc."""
    made, axes = mosaic("Balls bounce obliquely on rough planes", [["path", "a"], ["path", "b"]],
                        width_ratios=(1, 1.15))
    point = runs["point"]
    path = axes["path"]
    x, y = point.node(1).U1, 0.5 + point.node(1).U2
    path.plot(x, y, color=BLUE, lw=5, alpha=0.6, label="carom")
    across, up = oblique_bounce(2.0, -1.0, 0.3, 0.8)
    path.plot([0, 1, 1 + 0.5 * across], [0.5, 0, 0.5 * up], **EXACT, label="exact")
    path.set(xlabel="x", ylabel="y", xlim=(0, 1.9), ylim=(-0.1, 0.75))
    ground(path, 0.0, 0, 1.9, 0.1)
    path.set_title("a point, e = 0.8, μ = 0.3", fontsize=14)
    path.legend(loc="upper right", handlelength=1.5)
    note(path, 0.05, 0.06, "velocity\n2, −1")
    note(path, 1.88, 0.02, f"{across:.2f}, {up:.1f}", ha="right")
    elastic = runs["elastic"]
    mesh = elastic.mesh
    frame = nearest(mesh.times, elastic.time[np.argmax(np.abs(elastic.pair.CF2))])
    painted = body(axes["a"], mesh, frame, "MISES", (0, 12), 1.0, STRESS, 0.2)
    place = mesh.place(frame, 1.0)
    low, high = place.min(axis=0), place.max(axis=0)
    ground(axes["a"], low[1], low[0] - 0.4, high[0] + 0.4, 0.15)
    window(axes["a"], (low[0] - 0.4, low[1] - 0.15), (high[0] + 0.4, high[1] + 0.05),
           f"an elastic disc, μ = 0.2, time {mesh.times[frame]:.2g}")
    bar(made, painted, axes["a"], "Mises stress", aspect=12)
    force = axes["b"]
    normal, along = elastic.pair.CF2, elastic.pair.CF1
    force.plot(elastic.time, np.abs(normal), color=BLUE)
    force.plot(elastic.time, np.abs(along), color=ORANGE)
    force.plot(elastic.time, 0.2 * np.abs(normal), color=BLACK, lw=1.4, ls="--")
    force.set(xlabel="time", ylabel="force", xlim=(0, 1.2), ylim=(-0.3, 9.5))
    note(force, 0.66, 5.0, "normal", BLUE, weight="bold")
    note(force, 0.7, 1.0, "friction,\nμ × normal", "#9a6a00", weight="bold")
    return made


def draw_crack(runs):
    """Open and shut, and the contact force."""
    made, left, right = halves("A crack opens, and its faces slap", 0.8)
    axes = dict(zip("abuf", (*left.subplots(1, 2), *right.subplots(2, 1))))
    run = runs["slap"]
    mesh = run.mesh
    low, high = lines_of(mesh)
    force = np.hypot(run.pair.CF1, run.pair.CF2)
    opening = openings(mesh)
    widest = int(np.argmax(opening))
    shut = nearest(mesh.times, run.time[int(np.argmax(force))])
    for name, frame, words in (("a", widest, "open"), ("b", shut, "shut")):
        painted = body(axes[name], mesh, frame, "S22", (-3, 3), 10, SIGNED, 0.15)
        window(axes[name], low - 0.3, high + (0.3, 0.4), f"{words},\ntime {mesh.times[frame]:.2f}")
    bar(left, painted, [axes["a"], axes["b"]], "S22, displacements × 10", location="bottom",
        aspect=22, ticks=[-3, 0, 3])
    axes["u"].plot(mesh.times, opening, color=BLUE)
    axes["f"].plot(run.time, force, color=ORANGE)
    axes["u"].set(ylabel="opening", xlim=(0, 3), ylim=(-0.001, 0.022))
    axes["f"].set(ylabel="contact force", xlim=(0, 3), xlabel="time")
    axes["u"].tick_params(labelbottom=False)
    for frame, words in ((widest, "open"), (shut, "shut")):
        for name in "uf":
            axes[name].axvline(mesh.times[frame], color="0.35", lw=1.3, ls=":")
        note(axes["u"], mesh.times[frame], 0.0225, words, ha="center")
    return made


def openings(mesh):
    """How far the faces are apart in each frame, at most: of points that began at one place."""
    places = np.round(mesh.points[:, :2] * 1e8).astype(np.int64)
    order = np.lexsort(places.T)
    same = np.flatnonzero(np.all(places[order][1:] == places[order][:-1], axis=1))
    one, other = order[same], order[same + 1]
    way = np.ptp(mesh.points[one, :2], axis=0)  # the crack rises to the right
    normal = np.array([-way[1], way[0]]) / np.linalg.norm(way)
    displacements = (mesh.values("Point", "U", f)[:, :2] for f in range(mesh.n_frames))
    return np.array([np.abs((u[one] - u[other]) @ normal).max() for u in displacements])
