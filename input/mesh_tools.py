"""Plane meshes for the decks of this folder: grids and discs of quadrilaterals, their sides, their cards.

Used by the make_*.py beside the decks. Everything is counted from 0 here and from 1 in the cards.
"""

import numpy as np

SIDES = ((0, 1), (1, 2), (2, 3), (3, 0))


class Body:
    """Points x (n, 2) and elements (m, 4 or 8) of one body: corners counterclockwise, then middles."""

    def __init__(self, x, elements):
        self.x = np.array(x, dtype=float)
        self.elements = np.array(elements, dtype=int)

    @property
    def nodes(self):
        """Of an element."""
        return self.elements.shape[1]

    def quadratic(self, *circles):
        """The same with 8 nodes: middle nodes amid the corners, those of edges that lie on a circle
        (centre x, centre y, radius) on its arc."""
        number, x, elements = {}, list(self.x), []
        for ring in self.elements[:, :4]:
            middles = []
            for a, b in ((ring[i], ring[j]) for i, j in SIDES):
                key = (min(a, b), max(a, b))
                if key not in number:
                    number[key] = len(x)
                    x.append(middle(self.x[a], self.x[b], circles))
                middles.append(number[key])
            elements.append([*ring, *middles])
        return Body(x, elements)

    def moved(self, dx=0.0, dy=0.0, turn=0.0, factor=1.0):
        """A copy that is enlarged, turned by an angle in radians about the origin, then shifted."""
        c, s = np.cos(turn), np.sin(turn)
        return Body(factor * self.x @ np.array([[c, s], [-s, c]]) + (dx, dy), self.elements)

    def mirrored(self):
        """A copy reflected at the x axis."""
        order = [0, 3, 2, 1] if self.nodes == 4 else [0, 3, 2, 1, 7, 6, 5, 4]
        return Body(self.x * (1.0, -1.0), self.elements[:, order])

    def side(self, element, i):
        """The points of side i of an element, in the order in which its body lies on the left."""
        ring = self.elements[element]
        a, b = SIDES[i]
        return [ring[a], ring[b]] + ([ring[4 + i]] if self.nodes == 8 else [])

    def rim(self, chosen=lambda x: True):
        """(element, side) of the boundary whose points all satisfy a condition on their places."""
        owners = {}
        for e, ring in enumerate(self.elements):
            for i, (a, b) in enumerate(SIDES):
                owners.setdefault((min(ring[a], ring[b]), max(ring[a], ring[b])), []).append((e, i))
        return [who[0] for who in owners.values()
                if len(who) == 1 and all(chosen(self.x[p]) for p in self.side(*who[0]))]

    def points(self, chosen):
        """Points that satisfy a condition on their places."""
        return [p for p, x in enumerate(self.x) if chosen(x)]

    def points_of(self, sides):
        """Points of some sides, each once, ascending."""
        return sorted({int(p) for side in sides for p in self.side(*side)})

    def smallest_jacobian(self):
        """Smallest determinant of the Jacobian at 3 by 3 Gauss points and the nodes, relative to a
        quarter of the element's area: positive for a mesh that can be used."""
        least = np.inf
        places = [-1.0, -np.sqrt(0.6), 0.0, np.sqrt(0.6), 1.0]
        slopes = [shape_slopes(self.nodes, a, b) for a in places for b in places]
        for ring in self.elements:
            x = self.x[ring]
            corners = x[:4]
            area = 0.5 * abs(cross(corners[2] - corners[0], corners[3] - corners[1]))
            least = min(least, min(np.linalg.det(slope @ x) for slope in slopes) / (area / 4))
        return least

    # Cards

    def cards(self, kind, name, first_node=1, first_element=1):
        """*NODE and *ELEMENT with their sets."""
        lines = [f'*NODE, NSET={name}']
        lines += [f'{first_node + i}, {x:.12g}, {y:.12g}' for i, (x, y) in enumerate(self.x + 0.0)]
        lines.append(f'*ELEMENT, TYPE={kind}, ELSET={name}')
        lines += [f'{first_element + e}, ' + ', '.join(str(first_node + n) for n in ring)
                  for e, ring in enumerate(self.elements)]
        return '\n'.join(lines) + '\n'

    def surface(self, name, sides, first_element=1):
        """*SURFACE, TYPE=ELEMENT."""
        return f'*SURFACE, NAME={name}, TYPE=ELEMENT\n' + ''.join(
            f'{first_element + e}, S{i + 1}\n' for e, i in sides)


def node_set(name, points, first_node=1):
    """*NSET, eight to a line."""
    numbers = [str(first_node + p) for p in points]
    return f'*NSET, NSET={name}\n' + ''.join(
        ', '.join(numbers[i:i + 8]) + '\n' for i in range(0, len(numbers), 8))


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def middle(a, b, circles=()):
    """The point half-way between two: on the arc of a circle on which both lie."""
    for cx, cy, radius in circles:
        centre = np.array([cx, cy])
        if all(abs(np.hypot(*(p - centre)) - radius) < 1e-9 * radius for p in (a, b)):
            half = 0.5 * (a + b) - centre
            return centre + half * (radius / np.hypot(*half))
    return 0.5 * (a + b)


def shape_slopes(nodes, a, b):
    """Derivatives (2, nodes) of the shape functions at natural coordinates."""
    x, y = np.array([-1, 1, 1, -1.0]), np.array([-1, -1, 1, 1.0])
    p, q = 1 + x * a, 1 + y * b
    if nodes == 4:
        return np.array([x * q, p * y]) / 4
    return np.array([
        np.concatenate((x * q * (2 * x * a + y * b) / 4,
                        [-a * (1 - b), (1 - b * b) / 2, -a * (1 + b), -(1 - b * b) / 2])),
        np.concatenate((y * p * (x * a + 2 * y * b) / 4,
                        [-(1 - a * a) / 2, -b * (1 + a), (1 - a * a) / 2, -b * (1 - a)]))])


def grid(columns, rows):
    """A grid of 4-node elements over given abscissae and ordinates, point by point along x first."""
    nx, ny = len(columns), len(rows)
    x = [(a, b) for b in rows for a in columns]
    elements = [(j * nx + i, j * nx + i + 1, (j + 1) * nx + i + 1, (j + 1) * nx + i)
                for j in range(ny - 1) for i in range(nx - 1)]
    return Body(x, elements)


def rectangle(x0, y0, x1, y1, nx, ny):
    """A regular grid of 4-node elements."""
    return grid(np.linspace(x0, x1, nx + 1), np.linspace(y0, y1, ny + 1))


def joined(*bodies, tolerance=1e-9):
    """Bodies of 4-node elements made one: points at one place become one."""
    x, elements, number = [], [], {}
    for body in bodies:
        here = []
        for point in body.x:
            key = tuple(np.round(point / tolerance).astype(np.int64).tolist())
            near = [(key[0] + i, key[1] + j) for i in (0, -1, 1) for j in (0, -1, 1)]
            found = next((number[k] for k in near if k in number), None)
            if found is None:
                found = number[key] = len(x)
                x.append(point)
            here.append(found)
        elements += np.array(here)[body.elements].tolist()
    return Body(x, elements)


def ring(inner, outer, parts):
    """4-node elements between two curves of as many points each, at given parts (0 to 1) of the way;
    the curves run counterclockwise seen from within."""
    inner, outer = np.asarray(inner, float), np.asarray(outer, float)
    n = len(inner)
    x = np.concatenate([inner + t * (outer - inner) for t in parts])
    elements = [(j * n + i, (j + 1) * n + i, (j + 1) * n + i + 1, j * n + i + 1)
                for j in range(len(parts) - 1) for i in range(n - 1)]
    return Body(x, elements)


def disc(radius, divisions, rings, core=0.5):
    """A disc about the origin: a square of divisions by divisions elements with bulged sides amid, and
    rings around it. 4-node elements; 4 * divisions of them along the circle."""
    t = np.linspace(-1, 1, divisions + 1)
    square = rectangle(-1, -1, 1, 1, divisions, divisions)
    a, b = square.x.T
    # between a square and the circle: sides bulge by a third
    size = np.maximum(np.abs(a), np.abs(b))
    angle_a, angle_b = np.tan(np.pi / 4 * a), np.tan(np.pi / 4 * b)
    straight = np.stack((angle_a, angle_b), axis=1)
    top = np.max(np.abs(straight), axis=1)
    length = np.hypot(*straight.T)
    on_circle = straight * np.where(length > 0, top / np.maximum(length, 1e-300), 0.0)[:, None]
    blend = 0.4 * size[:, None]
    square.x = core * radius * ((1 - blend) * straight + blend * on_circle)
    parts, angles = [square], np.pi / 4 * t
    for quarter in range(4):
        turn = quarter * np.pi / 2
        edge = [p for p in square.points(lambda x: True)
                if abs((a, b)[quarter % 2][p] - (1 if quarter < 2 else -1)) < 1e-12]
        inner = square.x[edge]
        inner = inner[np.argsort((np.arctan2(inner[:, 1], inner[:, 0]) - turn + np.pi) % (2 * np.pi))]
        outer = radius * np.stack((np.cos(angles + turn), np.sin(angles + turn)), axis=1)
        parts.append(ring(inner, outer, np.linspace(0, 1, rings + 1)))
    return joined(*parts, tolerance=1e-9 * radius)


def quarter_disc(radius, width, growth=1.15, across=8, reach=1.25):
    """The quarter x >= 0, y <= radius of a disc about (0, radius), fine around its lowest point, the
    origin: `across` elements over the width of the contact, as fine up to reach * width, then ever
    larger by `growth`. 4-node elements. A conformal map takes a quarter plane to it, |z| = 2 radius to
    its upper side."""
    n = round(across * reach)
    fine = np.linspace(0, reach * width, n + 1)
    block = grid(fine, fine)
    inner = np.concatenate((np.stack((np.full(n, fine[-1]), fine[:-1]), axis=1),
                            np.stack((fine[::-1], np.full(n + 1, fine[-1])), axis=1)))
    angles = np.linspace(0, np.pi / 2, 2 * n + 1)
    arc = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    # first from the square to an arc about it, then rings that grow
    first = 2.0 * reach * width
    steps = max(2, round(np.log(2 * radius / first) / np.log(growth)))
    radii = first * (2 * radius / first) ** (np.arange(steps + 1) / steps)
    near = ring(inner, first * arc, np.linspace(0, 1, max(2, n // 2) + 1))
    far = Body(np.concatenate([r * arc for r in radii]),
               ring(arc, arc, np.arange(steps + 1)).elements)
    body = joined(block, near, far, tolerance=1e-9 * width)
    zeta = body.x[:, 0] + 1j * body.x[:, 1]
    z = 2j * radius * zeta / (zeta + 2j * radius)
    body.x = np.stack((z.real, z.imag), axis=1)
    body.x[np.abs(body.x) < 1e-14 * radius] = 0.0
    return body


def write(folder, texts):
    """Writes files of a folder: names and texts."""
    for name, text in texts.items():
        (folder / name).write_text(text)
        print(f'{folder / name}: {len(text) / 1000:.0f} kB')
