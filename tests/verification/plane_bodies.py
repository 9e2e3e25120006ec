"""Decks of several plane bodies and point masses that may touch: what the scripts about contact share.

Bodies are `Mesh`es of `solid_mesh`; nodes and elements are counted from 1 through all of them.
"""
import numpy as np

from solid_mesh import Mesh


def block(nx, ny, nodes, low, high):
    """A rectangle between two corners."""
    (x0, y0), (x1, y1) = low, high
    return Mesh(nx, ny, nodes, lambda s, t: (x0 + s * (x1 - x0), y0 + t * (y1 - y0)))


def arch(nx, ny, nodes, inner, outer, angles, centre=(0.0, 0.0)):
    """A sector of a ring, s along the angles (degrees), t from the inner to the outer radius. With
    angles that fall, body and elements are the right way round."""
    first, last = np.radians(angles)

    def place(s, t):
        r, a = inner + t * (outer - inner), first + s * (last - first)
        return centre[0] + r * np.cos(a), centre[1] + r * np.sin(a)
    return Mesh(nx, ny, nodes, place)


def ring(n, ny, nodes, inner, outer, centre=(0.0, 0.0)):
    """A whole ring of n elements, closed."""
    mesh = arch(n, ny, nodes, inner, outer, (360.0, 0.0), centre)
    first, last = mesh.at(s=0), mesh.at(s=1)
    same = np.arange(len(mesh.x))
    same[last] = first
    kept = np.setdiff1d(np.arange(len(mesh.x)), last)
    number = np.full(len(mesh.x), -1)
    number[kept] = np.arange(len(kept))
    mesh.elements = number[same[mesh.elements]]
    mesh.x, mesh.st = mesh.x[kept], mesh.st[kept]
    return mesh


class Deck:
    """Bodies by name with their element sets, node sets and surfaces by sides."""

    def __init__(self):
        self.lines, self.nodes, self.elements = [], 0, 0
        self.first, self.mesh = {}, {}

    def body(self, name, mesh, young=1e3, poisson=0.0, density=1.0, kind='CPE', more=''):
        """A meshed body of element set `name` and node set `name`_N."""
        self.first[name], self.mesh[name] = (self.nodes, self.elements), mesh
        text = mesh.text(f'{kind}{mesh.nodes}', name, self.nodes + 1, self.elements + 1)
        self.lines.append(text.replace('*NODE\n', f'*NODE, NSET={name}_N\n'))
        self.lines.append(f'*MATERIAL, NAME={name}\n*ELASTIC\n{young!r}, {poisson!r}\n*DENSITY\n{density!r}\n'
                          f'{more}*SOLID SECTION, ELSET={name}, MATERIAL={name}\n')
        self.nodes += len(mesh.x)
        self.elements += len(mesh.elements)
        return self

    def point(self, name, place, mass=1.0):
        """A point mass, node set and element set `name`, node surface `name`_S."""
        self.nodes += 1
        self.elements += 1
        self.first[name] = (self.nodes - 1, self.elements - 1)
        x, y = place
        self.lines.append(f'*NODE, NSET={name}_N\n{self.nodes}, {float(x)!r}, {float(y)!r}\n'
                          f'*ELEMENT, TYPE=MASS, ELSET={name}\n{self.elements}, {self.nodes}\n'
                          f'*MASS, ELSET={name}\n{float(mass)!r}\n'
                          f'*SURFACE, NAME={name}_S, TYPE=NODE\n{self.nodes}\n')
        return self

    def node(self, name, k=0):
        """The deck's number of point k of a body."""
        return self.first[name][0] + int(k) + 1

    def surface(self, name, *parts):
        """*SURFACE by parts (body, side 1 to 4): the element sides on that side of the unit square.
        Side 1 is t = 0, 2 is s = 1, 3 is t = 1, 4 is s = 0."""
        lines = [f'*SURFACE, NAME={name}\n']
        for body, side in parts:
            mesh, offset = self.mesh[body], self.first[body][1]
            corners = mesh.nodes if mesh.nodes in (3, 4) else mesh.nodes // 2
            axis, value = ((1, 0.0), (0, 1.0), (1, 1.0), (0, 0.0))[side - 1]
            for e, nodes in enumerate(mesh.elements):
                on = np.abs(mesh.st[nodes[:corners], axis] - value) < 1e-12
                for k in range(corners):
                    if on[k] and on[(k + 1) % corners] and self._runs(mesh, nodes, k, corners, axis):
                        lines.append(f'{offset + e + 1}, S{k + 1}\n')
        self.lines.append(''.join(lines))
        return self

    @staticmethod
    def _runs(mesh, nodes, k, corners, axis):
        """Whether side k of an element goes along the boundary, not across."""
        ends = mesh.st[[nodes[k], nodes[(k + 1) % corners]]]
        return abs(ends[0, axis] - ends[1, axis]) < 1e-12

    def add(self, text):
        """Any cards."""
        self.lines.append(text if text.endswith('\n') else text + '\n')
        return self

    def fix(self, name):
        """Holds a whole body."""
        return self.add(f'*BOUNDARY\n{name}_N, 1, 2')

    def speed(self, name, vx=0.0, vy=0.0):
        """Initial velocity of a body."""
        return self.add('*INITIAL CONDITIONS, TYPE=VELOCITY\n'
                        f'{name}_N, 1, {float(vx)!r}\n{name}_N, 2, {float(vy)!r}')

    def pair(self, slave, master, options='', impact='METHOD=TRANSFORMATION', friction=None):
        """*CONTACT PAIR with an interaction of its own."""
        name = f'I{sum(line.count("*SURFACE INTERACTION") for line in self.lines)}'
        rough = '' if friction is None else f'*FRICTION\n{friction!r}\n'
        return self.add(f'*SURFACE INTERACTION, NAME={name}\n*IMPACT, {impact}\n{rough}'
                        f'*CONTACT PAIR, INTERACTION={name}{options and ", " + options}\n{slave}, {master}')

    def text(self, dt, end, cards='', prints='', node_file='U, V', options='DIRECT', every=1):
        """The whole deck with one dynamic step."""
        requests = (f'*NODE FILE, FREQUENCY={every}\n{node_file}\n*CONTACT FILE, FREQUENCY={every}\nCF, CDIS\n'
                    '*CONTACT PRINT\nCF, CDIS\n*ENERGY PRINT\n')
        return ''.join(self.lines) + (f'*STEP\n*DYNAMIC, {options}\n{float(dt)!r}, {float(end)!r}\n{cards}{prints}'
                                      f'{requests}*END STEP\n')


def frames(run, name):
    """A point field of all frames: (n_frames, n_nodes, components)."""
    data, n = run[f'VTKHDF/PointData/{name}'], len(run['model/node_id'])
    return data.reshape((-1, n) + data.shape[1:])


def positions(run):
    """Undeformed positions of all nodes as the run has them."""
    return run['VTKHDF/Points'][:len(run['model/node_id'])]
