"""Pressure, gap and slip along contact surfaces: plot_contact.py RESULT.h5 [--frames -1] [--hertz R,E]

Draws the nodes of contact pairs in frames of /VTKHDF (*CONTACT FILE) over their place in the
undeformed body: x or y, whichever they extend in more, or the length s along the surface (--along).
Filled symbols touch, hollow ones are open. Pressures are those of the file, or if it has none those
that follow from the contact forces. --hertz draws the exact pressure under the same force, given the
radius and the modulus E* of the contact, --exact any curve of a file with two columns.
"""

import numpy as np
from carom_mesh import Mesh
from carom_plots import (
    BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, deliver, head, legend_beside, make_parser, plt,
    two_numbers,
)
from carom_results import Result
from carom_script import ScriptError, finite, run
from contact_solutions import hertz_line, hertz_pressure, pressure_of_forces

COLOURS = [BLUE, ORANGE, GREEN, PURPLE, RED]
MARKS = "osD^v"
NONE, OPEN = 0, 1


class Surface:
    """A chain of edges whose points all belong to a contact pair."""

    def __init__(self, mesh, edges):
        self.mesh = mesh
        edges = chained(edges)
        self.points = np.array([p for e in edges for p in e[:-1]] + [edges[-1][-1]])
        if self.points[0] == self.points[-1]:
            self.points = self.points[:-1]
        self.place = mesh.points[self.points, :2]
        number = {point: i for i, point in enumerate(self.points.tolist())}
        self.edges = [[number[p] for p in (e[0], e[-1], *e[1:-1])] for e in edges]
        self.step = np.concatenate(
            ([0.0], np.cumsum(np.linalg.norm(np.diff(self.place, axis=0), axis=1))))

    def normals(self):
        """Outward unit normals at the points."""
        total = np.zeros((len(self.points), 2))
        for first, last, *_ in self.edges:
            way = self.place[last] - self.place[first]
            for point in (first, last):
                total[point] += way[1], -way[0]
        lonely = ~total.any(axis=1)  # middle points: as their neighbours on both sides
        total[lonely] = np.roll(total, 1, axis=0)[lonely] + np.roll(total, -1, axis=0)[lonely]
        return total / np.linalg.norm(total, axis=1)[:, None]

    def field(self, name, frame):
        """A field along the surface, None if the file has none."""
        if name not in self.mesh.frames.names("Point"):
            return None
        return self.mesh.values("Point", name, frame)[self.points]

    def forces(self, frame):
        """Contact forces (n, 2)."""
        found = self.field("CF", frame)
        return np.zeros((len(self.points), 2)) if found is None else found[:, :2]

    def pressure(self, frame):
        """The file's, or what follows from the forces."""
        found = self.field("CPRESS", frame)
        if found is not None:
            return found
        normal = -np.einsum("nx,nx->n", self.forces(frame), self.normals())
        if not np.any(normal > 0):
            return np.zeros(len(normal))
        return pressure_of_forces(self.place, self.edges, normal)

    def state(self, frame):
        """0 none, 1 open, 2 and more touching."""
        found = self.field("CSTATE", frame)
        if found is not None:
            return np.rint(found).astype(int)
        return np.where(np.linalg.norm(self.forces(frame), axis=1) > 0, 2, OPEN)


def chained(edges):
    """Edges in a row, each beginning where the one before ends."""
    after = {e[0]: e for e in edges}
    ends = {e[-1] for e in edges}
    start = next((e for e in edges if e[0] not in ends), edges[0])
    found = [start]
    while found[-1][-1] in after and after[found[-1][-1]] is not start:
        found.append(after[found[-1][-1]])
    return found


def surfaces(mesh):
    """The surfaces of the slaves: points that have a state, or a gap."""
    names = mesh.frames.names("Point")
    if "CSTATE" in names:
        chosen = np.zeros(len(mesh.points), bool)
        for frame in range(mesh.n_frames):
            chosen |= mesh.values("Point", "CSTATE", frame) != NONE
    elif "CF" in names:
        chosen = np.zeros(len(mesh.points), bool)
        for frame in range(mesh.n_frames):
            chosen |= np.any(mesh.values("Point", "CF", frame) != 0, axis=1)
    else:
        raise ScriptError(f"'{mesh.path}' has no contact in its frames (*CONTACT FILE)")
    edges = [tuple(e.tolist()) for block in mesh.rim() for e in block if chosen[e].all()]
    found = []
    while edges:
        chain = chained(grow(edges))
        found.append(Surface(mesh, chain))
        edges = [e for e in edges if e not in set(chain)]
    if not found:
        raise ScriptError(f"'{mesh.path}' has no edges of solids in contact")
    return found


def grow(edges):
    """The edges that hang together with the first one."""
    connected, points = [edges[0]], {edges[0][0], edges[0][-1]}
    left = edges[1:]
    while True:
        near = [e for e in left if e[0] in points or e[-1] in points]
        if not near:
            return connected
        connected += near
        points |= {p for e in near for p in (e[0], e[-1])}
        left = [e for e in left if e not in set(near)]


def near_side(surface, frame, along):
    """The points that look the same way as those that touch: of a whole rim, the side in contact."""
    everything = np.full(len(surface.points), True)
    touching = surface.state(frame) > OPEN
    normals = surface.normals()
    if along == "s" or not touching.any():
        return everything
    chosen = normals @ normals[touching].mean(axis=0) > 0
    return chosen if chosen.any() else everything


def abscissa(surface, along):
    """Places along the surface, and in words what they are."""
    if along == "s":
        return surface.step, "length along the surface s"
    axis = "xy".index(along)
    return surface.place[:, axis], along


def choose_frames(mesh, text):
    """Frames counted from 0."""
    chosen = []
    for word in text.split(","):
        try:
            number = int(word)
        except ValueError:
            raise ScriptError(f"--frames takes numbers, not '{word}'") from None
        if number == 0 or abs(number) > mesh.n_frames:
            raise ScriptError(f"'{mesh.path}' has the frames 1 to {mesh.n_frames} (-1 is the last)")
        chosen.append(number - 1 if number > 0 else mesh.n_frames + number)
    return chosen


def strongest(mesh, found):
    """The frame with the largest pressure."""
    return int(np.argmax([max(s.pressure(frame).max() for s in found)
                          for frame in range(mesh.n_frames)]))


def scatter(axes, x, y, touching, colour, mark, label):
    """A curve with its nodes: filled where they touch."""
    axes.plot(x, y, color=colour, lw=1.0, alpha=0.6)
    for chosen, face in ((touching, colour), (~touching, "white")):
        axes.plot(x[chosen], y[chosen], mark, ms=5.5, mfc=face, mec=colour, lw=0,
                  label=label if face == colour else None)


def exact_curves(axes, given, found, frames):
    """Hertz or a curve of a file."""
    if given.hertz:
        radius, modulus = given.hertz
        for i, frame in enumerate(frames):
            force = np.linalg.norm(sum(s.forces(frame).sum(axis=0) for s in found))
            if force == 0:
                continue
            force *= 2 if given.half else 1
            width, peak = hertz_line(force, radius, modulus)
            x = np.linspace(0 if given.half else -width, width, 400)
            axes.plot(given.centre + x, hertz_pressure(x, force, radius, modulus), color=BLACK,
                      lw=1.6, label="Hertz" if i == 0 else None, zorder=5)
            print(f"Hertz: half-width {width:.6g}, peak {peak:.6g}, force {force:.6g}")
    if given.exact:
        try:
            x, y = np.loadtxt(given.exact, delimiter=None, comments="#").T
        except (OSError, ValueError) as error:
            raise ScriptError(f"'{given.exact}' should hold two columns: {error}") from None
        axes.plot(x, y, color=BLACK, lw=1.6, label="exact", zorder=5)


def figure_words(mesh, frames):
    """The time, where there is but one."""
    return f"time {mesh.times[frames[0]]:.4g}" if len(frames) == 1 else ""


def draw(result, mesh, found, frames, given):
    """The figure: pressure, gap and, with friction, slip."""
    slips = [s.field("CSLIP", f) for s in found for f in frames]
    with_slip = any(slip is not None and np.any(slip != 0) for slip in slips)
    with_gap = "CDIS" in mesh.frames.names("Point")
    rows = 1 + with_gap + with_slip
    figure, panels = plt.subplots(rows, 1, sharex=True, squeeze=False, layout="constrained",
                                  figsize=(8.5, 3.2 + 1.9 * rows),
                                  height_ratios=[2.2] + [1.0] * (rows - 1))
    panels = panels[:, 0]
    spread = np.ptp(np.concatenate([s.place for s in found]), axis=0)
    along = given.along or "xy"[int(np.argmax(spread))]
    curve = 0
    for frame in frames:
        for surface in found:
            x, words = abscissa(surface, along)
            near = near_side(surface, frame, along)
            x, touching = x[near], (surface.state(frame) > OPEN)[near]
            look = COLOURS[curve % len(COLOURS)], MARKS[curve % len(MARKS)]
            curve += 1
            pressure = surface.pressure(frame)[near]
            scatter(panels[0], x, pressure, touching, *look, f"time {mesh.times[frame]:.4g}")
            print(f"time {mesh.times[frame]:.6g}: largest pressure {pressure.max():.6g} at "
                  f"{words} = {x[pressure.argmax()]:.6g}, {touching.sum()} nodes touch")
            if with_gap:
                scatter(panels[1], x, surface.field("CDIS", frame)[near], touching, *look, None)
            if with_slip:
                scatter(panels[-1], x, surface.field("CSLIP", frame)[near], touching, *look, None)
    exact_curves(panels[0], given, found, frames)
    panels[0].set_ylabel("contact pressure")
    zoom(panels[0], found, frames, along, given)
    if with_gap:
        panels[1].set_ylabel("gap")
        panels[1].axhline(0.0, color="0.5", lw=0.8)
        least = 1e-9 * max(np.ptp(mesh.points[:, :2], axis=0).max(), 1e-300)  # no picture of round-off
        low, high = seen_range(panels[1])
        panels[1].set_ylim(min(low, -least) - 0.08 * (high - low), max(high, least) * 1.08)
    if with_slip:
        panels[-1].set_ylabel("slip")
        least = 1e-9 * max(np.ptp(mesh.points[:, :2], axis=0).max(), 1e-300)  # no picture of round-off
        low, high = panels[1].get_ylim()
        panels[1].set_ylim(min(low, -least), max(high, least))
    for axes in panels[1:]:
        axes.ticklabel_format(axis="y", scilimits=(-2, 3))
    panels[-1].set_xlabel(words)
    legend_beside(panels[0])
    head(figure, result, figure_words(mesh, frames))
    return figure


def seen_range(axes):
    """Least and largest ordinate of what lies within the abscissae shown."""
    first, last = axes.get_xlim()
    values = np.concatenate([line.get_ydata()[(line.get_xdata() >= first) & (line.get_xdata() <= last)]
                             for line in axes.lines if len(line.get_xdata()) > 2] or [np.zeros(1)])
    values = values[np.isfinite(values)]  # nodes that face nothing have no gap
    return (values.min(), values.max()) if len(values) else (0.0, 0.0)


def zoom(axes, found, frames, along, given):
    """Shows what touches with half as much on both sides."""
    if given.range:
        axes.set_xlim(given.range)
        return
    places = np.concatenate([abscissa(s, along)[0][s.state(f) > OPEN] for s in found for f in frames])
    if len(places) < 2:
        return
    low, high = places.min(), places.max()
    margin = 0.3 * (high - low)
    axes.set_xlim(low - (0.03 * (high - low) if given.half else margin), high + margin)


def main():
    parser = make_parser(__doc__)
    parser.add_argument("--frames", help="frames, comma-separated: 1 is the first, -1 the last"
                        " (default: the one with the largest pressure)")
    parser.add_argument("--along", choices=("x", "y", "s"), help="the abscissa")
    parser.add_argument("--hertz", type=two_numbers, metavar="R,E",
                        help="radius and modulus E* of the contact: the exact line contact")
    parser.add_argument("--half", action="store_true",
                        help="half of a symmetric contact is in the file")
    parser.add_argument("--centre", type=finite, default=0.0, help="of the exact curve (0)")
    parser.add_argument("--exact", help="a file with two columns: place, pressure")
    parser.add_argument("--range", type=two_numbers, metavar="A,B", help="what is shown")
    given = parser.parse_args()
    with Result(given.result) as result:
        mesh = Mesh(result)
        found = surfaces(mesh)
        frames = choose_frames(mesh, given.frames) if given.frames else [strongest(mesh, found)]
        deliver(draw(result, mesh, found, frames, given), given, result, "_contact.png")


if __name__ == "__main__":
    run(main)
