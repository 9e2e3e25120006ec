"""The mesh of a result file and its frames, for the scripts that draw it; nothing to be run."""

import numpy as np
from carom_script import ScriptError

VERTEX, LINE, CURVE = 1, 3, 21
# VTK types of solids: the corners, then the nodes between them
CORNERS = {5: 3, 9: 4, 22: 3, 23: 4}
QUADRATIC = (22, 23)
TENSOR = {"11": 0, "22": 1, "33": 2, "12": 3, "23": 4, "13": 5}


class Mesh:
    """Points, cells by type, and the fields of each frame."""

    def __init__(self, result):
        self.path, self.file = result.path, result.file
        self.frames = frames = result.frames
        if "U" not in frames.names("Point"):
            raise ScriptError(f"'{self.path}' has no frames of U in /VTKHDF (*NODE FILE with U)")
        self.n_frames, self.times = len(frames), frames.times
        if self.n_frames == 0:
            raise ScriptError(f"'{self.path}' has no frames yet")
        self.points, self.n_cells = frames.points, len(frames.types)
        self.blocks = frames.cells
        scheme = self.file.get("model/element_scheme")
        self.scheme = np.ones(self.n_cells, int) if scheme is None else scheme[()]

    def block(self, kind):
        """The numbers of the cells of a type and their points; empty without any."""
        return self.blocks.get(kind, (np.zeros(0, int), np.zeros((0, 3), int)))

    def solids(self):
        """The types of solids that there are."""
        return [kind for kind in CORNERS if kind in self.blocks]

    def lines(self, active):
        """Cells and end points of line elements that carry something, or of gaps and boundaries."""
        cells, points = self.block(LINE)
        chosen = (self.scheme[cells] != 0) == active
        return cells[chosen], points[chosen][:, :2]

    def values(self, where, name, frame):
        """A field in one frame: where is Point or Cell."""
        return self.frames.values(where, name, frame)

    def place(self, frame, scale):
        """The x and y of all points."""
        return (self.points + scale * self.values("Point", "U", frame))[:, :2]

    def component(self, where, field, frame):
        """The values of a field such as U1, S11, MISES or U (size); None if it is not there."""
        name, component = field.rstrip("0123456789"), field[len(field.rstrip("0123456789")) :]
        if name not in self.frames.names(where):
            return None
        values = self.values(where, name, frame)
        n = 1 if values.ndim == 1 else values.shape[1]
        if n == 1 and not component:
            return values.reshape(-1)
        if n == 3 and not component:
            return np.linalg.norm(values, axis=1)
        place = {"1": 0, "2": 1, "3": 2} if n == 3 else TENSOR if n == 6 else {}
        return values[:, place[component]] if component in place else None

    def fields(self):
        """The names that `component` takes."""
        names = []
        for where in ("Point", "Cell"):
            for name in self.frames.names(where):
                item = self.frames.grid[f"{where}Data/{name}"]
                n = 1 if item.ndim == 1 else item.shape[1]
                ends = {1: [""], 3: ["", "1", "2", "3"]}.get(n, list(TENSOR))
                names += [name + end for end in ends if name + end not in names]
        return names

    def modes(self):
        """The frequencies of the frames that are mode shapes, by frame: the last ones."""
        found = self.file.get("frequency/frequency")
        values = [] if found is None else found[()]
        return {self.n_frames - len(values) + i: float(value) for i, value in enumerate(values)}

    def mode_title(self, frame):
        """A mode shape in words."""
        modes = self.modes()
        return f"mode {frame - min(modes) + 1}, frequency {modes[frame]:.5g}"

    def visible_scale(self, frame):
        """A factor on the displacements: 1, or of mode shapes and displacements that could not be
        seen a round number that shows them."""
        size = max(np.ptp(self.points[:, :2], axis=0).max(), 1e-300)
        most = np.linalg.norm(self.values("Point", "U", frame), axis=1).max()
        small = most <= 0.04 * size or frame in self.modes()
        if most <= 0 or not np.isfinite(most) or not small:
            return 1.0
        wanted = 0.1 * size / most
        power = 10.0 ** np.floor(np.log10(wanted))
        return float(power * max(f for f in (1, 2, 5) if f * power <= wanted * 1.000001))

    def outlines(self, kind, place, parts):
        """The cells of a solid type as polygons (cells, vertices, 2), edges in so many parts."""
        _, points = self.block(kind)
        n = CORNERS[kind]
        edges = [edge(points, kind, i) for i in range(n)]
        if kind not in QUADRATIC:
            return place[points[:, :n]]
        return np.concatenate([curve(place[e], parts)[:, :-1] for e in edges], axis=1)

    def rim(self):
        """Edges that belong to one solid only: points (edges, 2 or 3), a middle one in the middle; a
        list with an array a type of solid and side."""
        edges = [edge(self.block(kind)[1], kind, i) for kind in self.solids()
                 for i in range(CORNERS[kind])]
        if not edges:
            return []
        ends = np.sort(np.concatenate([e[:, [0, -1]] for e in edges]), axis=1)
        _, inverse, counts = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
        single = counts[inverse.reshape(-1)] == 1
        begin = np.cumsum([0] + [len(e) for e in edges])
        return [e[single[first : first + len(e)]] for e, first in zip(edges, begin)]

    def boundary(self, place, parts):
        """Edges that belong to one solid only, as curves (edges, vertices, 2), a list of arrays."""
        return [curve(place[e], parts) if e.shape[1] == 3 else place[e] for e in self.rim()]

    def triangles(self, kind, place, values, parts):
        """The cells of a solid type cut into triangles: vertices, values there, triangles."""
        _, points = self.block(kind)
        shape, local = division(kind, parts)
        points = points[:, : shape.shape[1]]
        where = np.einsum("pn,cnx->cpx", shape, place[points])
        what = values[points] @ shape.T
        first = np.arange(len(points))[:, None, None] * len(shape)
        return where.reshape(-1, 2), what.reshape(-1), (first + local).reshape(-1, 3)


def edge(points, kind, i):
    """The points of edge i of all cells: its ends, with the node between them if there is one."""
    n = CORNERS[kind]
    middle = [n + i] if kind in QUADRATIC else []
    return points[:, [i, *middle, (i + 1) % n]]


def curve(x, parts):
    """Points along parabolas through three points each."""
    t = np.linspace(0.0, 1.0, parts + 1)
    shape = np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)], axis=1)
    return np.einsum("pn,enx->epx", shape, x)


def division(kind, parts):
    """Shape functions at the points of a division of a cell, and its triangles."""
    at, triangles = {}, []
    for i in range(parts + 1):
        for j in range(parts + 1 - (i if CORNERS[kind] == 3 else 0)):
            at[i, j] = len(at)
    for i, j in at:
        if (i + 1, j) in at and (i, j + 1) in at:
            triangles.append([at[i, j], at[i + 1, j], at[i, j + 1]])
        if (i + 1, j + 1) in at:
            triangles.append([at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]])
    r, s = np.array(list(at)).T / parts
    return shape_functions(kind, r, s), np.array(triangles)


def shape_functions(kind, r, s):
    """Values at points with coordinates from 0 to 1."""
    if CORNERS[kind] == 3:
        a = 1 - r - s
        if kind not in QUADRATIC:
            return np.stack([a, r, s], axis=1)
        return np.stack([a * (2 * a - 1), r * (2 * r - 1), s * (2 * s - 1),
                         4 * a * r, 4 * r * s, 4 * s * a], axis=1)
    x, y = 2 * r - 1, 2 * s - 1
    signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    linear = [(1 + p * x) * (1 + q * y) / 4 for p, q in signs]
    if kind not in QUADRATIC:
        return np.stack(linear, axis=1)
    corners = [n * (p * x + q * y - 1) for n, (p, q) in zip(linear, signs)]
    middles = [(1 - x**2) * (1 - y) / 2, (1 + x) * (1 - y**2) / 2,
               (1 - x**2) * (1 + y) / 2, (1 - x) * (1 - y**2) / 2]
    return np.stack(corners + middles, axis=1)
