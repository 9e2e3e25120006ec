"""Meshes of plane and axisymmetric solids as decks: what the scripts about solids share."""
import sys

import numpy as np


class Mesh:
    """Points x (n, 2) with places st (n, 2) in the unit square, elements (m, nodes) from 0."""

    def __init__(self, nx, ny, nodes, place=lambda s, t: (s, t), straight=False):
        """A grid of nx by ny quadrilaterals (4 or 8 nodes) or twice as many triangles (3 or 6),
        put in place by a function of s and t. Straight: middle nodes amid the corners."""
        fine = 1 if nodes <= 4 else 2
        columns, rows = fine * nx + 1, fine * ny + 1
        number = -np.ones((columns, rows), dtype=int)
        count = 0
        for j in range(rows):
            for i in range(columns):
                if nodes == 8 and i % 2 and j % 2:
                    continue
                number[i, j] = count
                count += 1
        i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing='ij')
        kept = number >= 0
        order = np.argsort(number[kept])
        self.st = np.stack((i[kept][order] / (columns - 1), j[kept][order] / (rows - 1)), axis=1)
        self.nodes = nodes
        elements = []
        for b in range(0, rows - 1, fine):
            for a in range(0, columns - 1, fine):
                corners = [(a, b), (a + fine, b), (a + fine, b + fine), (a, b + fine)]
                rings = [corners]
                if nodes in (3, 6):
                    even = (a + b) // fine % 2 == 0
                    rings = [[corners[k] for k in part] for part in
                             ([(0, 1, 2), (0, 2, 3)] if even else [(0, 1, 3), (1, 2, 3)])]
                for ring in rings:
                    middle = [((p[0] + q[0]) // 2, (p[1] + q[1]) // 2)
                              for p, q in zip(ring, ring[1:] + ring[:1])] if fine == 2 else []
                    elements.append([number[p] for p in ring + middle])
        self.elements = np.array(elements)
        self.x = np.stack(np.broadcast_arrays(*place(*self.st.T)), axis=1).astype(float)
        if straight and fine == 2:
            corners = nodes // 2
            for ring in self.elements:
                for k in range(corners):
                    self.x[ring[corners + k]] = 0.5 * (self.x[ring[k]]
                                                       + self.x[ring[(k + 1) % corners]])

    def at(self, s=None, t=None):
        """Points with the given s or t, from 0, in the order of the other."""
        axis, value = (0, s) if t is None else (1, t)
        found = np.flatnonzero(np.abs(self.st[:, axis] - value) < 1e-12)
        return found[np.argsort(self.st[found, 1 - axis])]

    def rim(self):
        """Points of the boundary."""
        return np.unique(np.concatenate([self.at(s=0), self.at(s=1), self.at(t=0), self.at(t=1)]))

    def text(self, kind, name='solid', first_node=1, first_element=1):
        """The cards *NODE and *ELEMENT; the element type is kind + number of nodes, or has its own R."""
        lines = ['*NODE']
        lines += [f'{first_node + i}, {x!r}, {y!r}' for i, (x, y) in enumerate(self.x.tolist())]
        lines.append(f'*ELEMENT, TYPE={kind}, ELSET={name}')
        lines += [f'{first_element + e}, ' + ', '.join(str(first_node + n) for n in ring)
                  for e, ring in enumerate(self.elements)]
        return '\n'.join(lines) + '\n'


def node_set(name, points):
    """*NSET of points counted from 0."""
    return f'*NSET, NSET={name}\n' + ''.join(f'{p + 1}\n' for p in points)


def material(young, poisson, density=1.0, thickness=None, more='', section=''):
    """*MATERIAL and *SOLID SECTION of the set `solid`."""
    return (f'*MATERIAL, NAME=stuff\n*ELASTIC\n{young!r}, {poisson!r}\n*DENSITY\n{density!r}\n{more}'
            f'*SOLID SECTION, ELSET=solid, MATERIAL=stuff{section}\n'
            + ('' if thickness is None else f'{thickness!r}\n'))


def step(procedure, line, cards='', prints='*NODE FILE\nU\n*ENERGY PRINT\n'):
    """A step with its data line, cards and requests."""
    return f'*STEP\n*{procedure}\n{line}\n{cards}{prints}*END STEP\n'


def kept(checks, path, text):
    """A deck of input/ that a script makes: sees that the file holds this text, or writes it when
    the script's second argument is --write."""
    if sys.argv[2:] == ['--write']:
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    checks.true(same_deck(path.read_text(), text),
                f'{path.parent.name}/{path.name} is what this script makes')
    return path


def same_deck(one, other):
    """Equal word by word, numbers to round-off: numpy's versions differ in the last digit."""
    words = [text.replace(',', ' ').split() for text in (one, other)]
    if len(words[0]) != len(words[1]):
        return False
    for left, right in zip(*words):
        if left == right:
            continue
        try:
            if abs(float(left) - float(right)) > 1e-12 * (1 + abs(float(left))):
                return False
        except ValueError:
            return False
    return True


def last_frame(run, name, place='PointData'):
    """A field of the last frame."""
    data = run[f'VTKHDF/{place}/{name}']
    n = len(run['model/node_id' if place == 'PointData' else 'model/element_id'])
    return data[-n:]


def shapes(nodes, xi):
    """Shape functions (nodes) and derivatives (2, nodes) at natural coordinates."""
    a, b = xi
    if nodes in (3, 6):
        l, dl = np.array([1 - a - b, a, b]), np.array([[-1, 1, 0], [-1, 0, 1.0]])
        if nodes == 3:
            return l, dl
        m, dm = np.roll(l, -1), np.roll(dl, -1, axis=1)
        return (np.concatenate((l * (2 * l - 1), 4 * l * m)),
                np.concatenate(((4 * l - 1) * dl, 4 * (dl * m + l * dm)), axis=1))
    x, y = np.array([-1, 1, 1, -1.0]), np.array([-1, -1, 1, 1.0])
    p, q = 1 + x * a, 1 + y * b
    if nodes == 4:
        return p * q / 4, np.array([x * q, p * y]) / 4
    n = np.concatenate((p * q * (x * a + y * b - 1) / 4,
                        [(1 - a * a) * (1 - b) / 2, (1 + a) * (1 - b * b) / 2,
                         (1 - a * a) * (1 + b) / 2, (1 - a) * (1 - b * b) / 2]))
    return n, np.array([
        np.concatenate((x * q * (2 * x * a + y * b) / 4,
                        [-a * (1 - b), (1 - b * b) / 2, -a * (1 + b), -(1 - b * b) / 2])),
        np.concatenate((y * p * (x * a + 2 * y * b) / 4,
                        [-(1 - a * a) / 2, -b * (1 + a), (1 - a * a) / 2, -b * (1 - a)]))])


def rule(nodes, n=5):
    """Points and weights of a fine rule."""
    s, w = np.polynomial.legendre.leggauss(n)
    if nodes in (4, 8):
        return [((a, b), u * v) for a, u in zip(s, w) for b, v in zip(s, w)]
    # the square collapsed
    return [(((1 + a) * (1 - b) / 4, (1 + b) / 2), u * v * (1 - b) / 8)
            for a, u in zip(s, w) for b, v in zip(s, w)]


def integrate(mesh, function, n=5):
    """Sum of function(ring, shape functions, their derivatives along x and y, place, area)."""
    for xi, weight in rule(mesh.nodes, n):
        values, slopes = shapes(mesh.nodes, xi)
        for ring in mesh.elements:
            jacobian = slopes @ mesh.x[ring]
            function(ring, values, np.linalg.solve(jacobian, slopes), values @ mesh.x[ring],
                     weight * np.linalg.det(jacobian))
