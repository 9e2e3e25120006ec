"""The deformed mesh: plot_mesh.py RESULT.h5 [--field S11] [--frame N] [--groups] [--supports]

Draws a frame of /VTKHDF in the x-y plane, points + scale * U, the undeformed outline in grey; of
a *FREQUENCY step a mode shape. Colours: a field (at the nodes if the file has it there, else one
value an element), or implicit and explicit elements. Without --scale small displacements are
enlarged.
"""

import numpy as np
from carom_mesh import VERTEX, Mesh
from carom_plots import (
    BLUE, GREEN, ORANGE, axis_label, colours_of, deliver, head, legend_below, make_parser,
    plt,
)
from carom_results import Result
from carom_script import ScriptError, finite, run
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.tri import Triangulation

MANY = 20000  # cells beyond which inner edges are not drawn
PLAIN = "#cfe3f2"
SCHEMES = {1: (BLUE, "implicit"), 2: (ORANGE, "explicit"), 0: ("0.6", "neither")}


def choose_frame(mesh, number):
    """The frame counted from 0."""
    n = mesh.n_frames
    if number is None:
        return min(mesh.modes(), default=n - 1)
    if number == 0 or abs(number) > n:
        raise ScriptError(f"'{mesh.path}' has the frames 1 to {n} (-1 is the last), not {number}")
    return number - 1 if number > 0 else n + number


class Drawing:
    """The axes with the mesh in one frame."""

    def __init__(self, mesh, frame, scale, with_bar, with_legend):
        self.mesh, self.frame = mesh, frame
        self.before = mesh.points[:, :2]
        self.place = mesh.place(frame, scale)
        low = np.minimum(self.before.min(axis=0), self.place.min(axis=0))
        high = np.maximum(self.before.max(axis=0), self.place.max(axis=0))
        size = (high - low).max()
        if size <= 1e-9 * np.abs(low).max() or size == 0.0:  # a single point
            size = max(np.abs(low).max(), 1.0)
        aspect = min(max((high - low)[1], 0.12 * size) / max((high - low)[0], 0.12 * size), 2.0)
        wide = 9.0 if aspect < 1 else 9.0 / aspect + 1.5
        self.flat = aspect < 0.6
        tall = min(9.0 * aspect, 9.0) + 1.6 + (0.6 if with_legend else 0.0)
        tall += 1.2 if self.flat and with_bar else 0.0
        self.figure, self.axes = plt.subplots(figsize=(wide, tall), layout="constrained")
        self.axes.set_xlim(low[0] - 0.07 * size, high[0] + 0.07 * size)
        self.axes.set_ylim(low[1] - 0.07 * size, high[1] + 0.07 * size)
        self.axes.set_aspect("equal")
        self.axes.grid(False)
        self.axes.set_xlabel("x")
        self.axes.set_ylabel("y")
        self.n_solids = sum(len(mesh.block(kind)[0]) for kind in mesh.solids())
        self.parts = 8 if self.n_solids <= 2000 else 4 if self.n_solids <= MANY else 2
        self.handles = []

    def undeformed(self):
        """The outline before, in grey."""
        edges = [e for block in self.mesh.boundary(self.before, self.parts) for e in block]
        edges += list(self.before[self.mesh.lines(True)[1]])
        self.axes.add_collection(LineCollection(edges, colors="0.65", lw=0.9, zorder=1))

    def edges(self):
        """The edges of the solids, of large meshes the outline only; gaps as dotted lines."""
        mesh = self.mesh
        if self.n_solids <= MANY:
            width = 0.7 if self.n_solids <= 600 else 0.4 if self.n_solids <= 4000 else 0.15
            for kind in mesh.solids():
                self.axes.add_collection(PolyCollection(
                    mesh.outlines(kind, self.place, self.parts), facecolors="none",
                    edgecolors="black", lw=width, zorder=4))
        else:
            edges = [e for block in mesh.boundary(self.place, self.parts) for e in block]
            self.axes.add_collection(LineCollection(edges, colors="black", lw=0.5, zorder=4))
        self.axes.add_collection(LineCollection(
            self.place[mesh.lines(False)[1]], colors="0.6", lw=1.0, linestyles="dotted", zorder=1))

    def plain(self, colour_of):
        """Solids and lines in one colour each; colour_of(cells) gives them."""
        mesh = self.mesh
        for kind in mesh.solids():
            self.axes.add_collection(PolyCollection(
                mesh.outlines(kind, self.place, self.parts), lw=0, zorder=2, antialiaseds=False,
                facecolors=colour_of(mesh.block(kind)[0], PLAIN)))
        cells, points = mesh.lines(True)
        self.axes.add_collection(LineCollection(
            self.place[points], colors=colour_of(cells, BLUE), lw=2.5, zorder=3))
        self.points(colour_of)

    def points(self, colour_of):
        """Masses, where there is no solid that would hide them."""
        cells, points = self.mesh.block(VERTEX)
        if len(cells) and len(cells) <= 2000:
            self.axes.scatter(*self.place[points[:, 0]].T, s=80 if len(cells) <= 20 else 12,
                              c=colour_of(cells, BLUE), edgecolor="black", lw=0.6, zorder=5)

    def groups(self):
        """Implicit and explicit elements."""
        colours = np.array([SCHEMES[i][0] for i in range(3)])
        self.plain(lambda cells, _: colours[self.mesh.scheme[cells]])
        for scheme in (1, 2):
            n = np.count_nonzero(self.mesh.scheme == scheme)
            self.handles.append(Patch(color=SCHEMES[scheme][0],
                                      label=f"{SCHEMES[scheme][1]} ({n} elements)"))

    def field(self, name, by_cell):
        """Colours of a field with their bar."""
        mesh = self.mesh
        cell = mesh.component("Cell", name, self.frame)
        point = None if by_cell else mesh.component("Point", name, self.frame)
        if cell is None and point is None:
            raise ScriptError(f"'{mesh.path}' has no field {name}"
                              f"{' in its cells' if by_cell else ''}; "
                              f"there are: {', '.join(mesh.fields())}")
        lines, ends = mesh.lines(True)
        along = cell[lines] if cell is not None else point[ends].mean(axis=1)
        solids = np.concatenate(
            [np.zeros(0)] + [(cell[mesh.block(kind)[0]] if point is None
                              else point[mesh.block(kind)[1]].reshape(-1))
                             for kind in mesh.solids()])
        shown = np.concatenate([along, solids]) if len(along) + len(solids) else \
            (point if point is not None else cell)
        style = colours_of(shown, f"'{mesh.path}': {name}")
        for kind in mesh.solids():
            self.paint(kind, cell, point, style)
        drawn = LineCollection(self.place[ends], lw=4.0, zorder=3, **style)
        drawn.set_array(along)
        self.axes.add_collection(drawn)
        if not len(along) + len(solids):  # points only
            drawn = self.axes.scatter(*self.place.T, c=shown, s=60, zorder=5,
                                      **style) if point is not None else drawn
        else:
            self.points(lambda *_: "0.4")
        bar = self.figure.colorbar(drawn, ax=self.axes, shrink=0.8, aspect=30,
                                   location="bottom" if self.flat else "right")
        bar.set_label(axis_label(name) + ("" if point is not None else ", mean of each element"))
        self.extremes = float(shown.min()) + 0.0, float(shown.max()) + 0.0

    def paint(self, kind, cell, point, style):
        """Solids of one type in the colours of a field."""
        if point is None:
            drawn = PolyCollection(self.mesh.outlines(kind, self.place, self.parts), lw=0, zorder=2,
                                   antialiaseds=False, **style)
            drawn.set_array(cell[self.mesh.block(kind)[0]])
            self.axes.add_collection(drawn)
            return
        parts = self.parts if kind in (22, 23) else min(self.parts, 4)
        if self.n_solids > MANY:
            parts = 1
        where, what, triangles = self.mesh.triangles(kind, self.place, point, parts)
        self.axes.tripcolor(Triangulation(*where.T, triangles), what, shading="gouraud",
                            zorder=2, **style)

    def supports(self):
        """A triangle for each freedom that is held or moved, its tip at the node."""
        model = self.mesh.file.get("model", {})
        if "fixed_point" not in model:
            raise ScriptError(f"'{self.mesh.path}' has no /model/fixed_point: run carom again")
        points, dofs = model["fixed_point"][()], model["fixed_dof"][()]
        size = 110 if len(points) <= 60 else 40 if len(points) <= 300 else 12
        centre = 0.5 * (self.before.min(axis=0) + self.before.max(axis=0))
        for axis in (0, 1):
            chosen = points[dofs == axis + 1]
            after = self.before[chosen, axis] > centre[axis]
            for side, nodes in ((-1, chosen[~after]), (1, chosen[after])):
                tip = np.array([[0, 0], [side, 0.55], [side, -0.55], [0, 0]])
                self.axes.scatter(*self.place[nodes].T, s=size * 2, zorder=6, color=GREEN,
                                  marker=tip if axis == 0 else tip[:, ::-1], lw=0)
        self.handles.append(Line2D([], [], color=GREEN, marker="^", ls="", ms=8,
                                   label=f"supports ({len(points)} freedoms)"))

    def finish(self, result, title):
        """Title and legend."""
        head(self.figure, result, title)
        if self.handles:
            legend_below(self.figure, 3, handles=self.handles)
        return self.figure


def main():
    parser = make_parser(__doc__)
    parser.add_argument("--field", help="colours: U1, U, V, S11, MISES, PEEQ, ENER, ...")
    parser.add_argument("--cells", action="store_true", help="the field's mean in each element")
    parser.add_argument("--frame", type=int,
                        help="1 is the first state or mode, -1 the last (default: last, mode 1)")
    parser.add_argument("--scale", type=finite, help="factor on the displacements"
                        " (default: chosen to be seen)")
    parser.add_argument("--groups", action="store_true", help="colours: implicit and explicit")
    parser.add_argument("--supports", action="store_true", help="draw boundary conditions")
    given = parser.parse_args()
    if given.field and given.groups:
        raise ScriptError("--field and --groups both want the colours: give one of them")
    if given.cells and not given.field:
        raise ScriptError("--cells goes with --field")
    with Result(given.result) as result:
        mesh = Mesh(result)
        modes = mesh.modes()
        frame = choose_frame(mesh, given.frame)
        scale = given.scale
        if scale is None:
            scale = mesh.visible_scale(frame)
        drawing = Drawing(mesh, frame, scale, bool(given.field),
                          given.groups or given.supports)
        if scale != 0:
            drawing.undeformed()
        title = f"time {mesh.times[frame]:.4g}"
        if frame in modes:
            title = mesh.mode_title(frame)
        else:
            title += f", displacements × {scale:.4g}"
        if given.field:
            field = given.field.upper()
            drawing.field(field, given.cells)
            title += "; {} from {:.4g} to {:.4g}".format(field, *drawing.extremes)
        elif given.groups:
            drawing.groups()
        else:
            drawing.plain(lambda _, colour: colour)
        drawing.edges()
        if given.supports:
            drawing.supports()
        deliver(drawing.finish(result, title), given, result, "_mesh.png")


if __name__ == "__main__":
    run(main)
