"""The plane mesh of an open gmsh model as cards of carom, for mesh_from_gmsh.py; nothing to be run."""

import re

import numpy as np

from carom_script import ScriptError, folded

# gmsh's types of plane elements: corners, nodes that carom takes
PLANE = {2: (3, 3), 3: (4, 4), 9: (3, 6), 16: (4, 8), 10: (4, 8)}
FLAT = 1e-9     # of the size of the mesh
LONGEST = 80    # bytes of a name


class PlaneMesh:
    """Nodes, elements and groups, counted from 0: `x` (n, 2), `elements` (lists of nodes),
    `areas` {name: elements}, `curves` {name: edges}, `points` {name: nodes}."""

    def __init__(self, gmsh):
        self.gmsh = gmsh
        tags, x, _ = gmsh.model.mesh.getNodes()
        self.place = {int(tag): i for i, tag in enumerate(tags)}
        self.x = np.reshape(x, (-1, 3))
        self.elements, self.of_tag = [], {}
        self.read_elements()
        self.areas, self.curves, self.points = {}, {}, {}
        self.read_groups()
        self.drop_unused_nodes()
        self.flatten()
        self.orient()
        self.find_sides()

    def cells(self, dimension, entity=-1):
        """Tag, type and nodes of all elements of a dimension."""
        kinds, tags, nodes = self.gmsh.model.mesh.getElements(dimension, entity)
        for kind, own, their in zip(kinds, tags, nodes):
            for tag, ring in zip(own, np.reshape(their, (len(own), -1))):
                yield int(tag), int(kind), [self.place[int(node)] for node in ring]

    def read_elements(self):
        for tag, kind, nodes in self.cells(2):
            if kind not in PLANE:
                name = self.gmsh.model.mesh.getElementProperties(kind)[0]
                raise ScriptError(f"the mesh has elements '{name}': make it of order 1 or 2")
            self.of_tag[tag] = len(self.elements)
            self.elements.append(nodes[: PLANE[kind][1]])
        if not self.elements:
            raise ScriptError("there are no plane elements: draw a surface in the x, y plane")

    def read_groups(self):
        """The physical groups by name."""
        written = {}  # each name as the user wrote it
        for dimension, tag in self.gmsh.model.getPhysicalGroups():
            own = self.gmsh.model.getPhysicalName(dimension, tag)
            name = clean_name(own) or f"{('POINT', 'CURVE', 'SURFACE', 'VOLUME')[dimension]}_{tag}"
            entities = self.gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
            cells = [cell for entity in entities for cell in self.cells(dimension, entity)]
            if dimension == 3:
                raise ScriptError(f"'{name}' is a group of volumes: bodies are plane here")
            if name in written:
                raise ScriptError(f"two physical groups, '{written[name]}' and '{own}', are both '{name}' "
                                  "in a deck: give one of them another name")
            written[name] = own
            if dimension == 2:
                self.areas[name] = [self.of_tag[tag] for tag, _, _ in cells]
            elif dimension == 1:
                self.curves[name] = [nodes for _, _, nodes in cells]
            else:
                self.points[name] = [nodes[0] for _, _, nodes in cells] or self.nodes_at(entities)
        if not self.areas:
            self.areas = {"PART": list(range(len(self.elements)))}

    def nodes_at(self, entities):
        """The nodes of points; those without an element have none of dimension 0."""
        found = [self.gmsh.model.mesh.getNodes(0, entity)[0] for entity in entities]
        return [self.place[int(node)] for nodes in found for node in nodes]

    def drop_unused_nodes(self):
        """Centres of arcs and curves that bound nothing are no part of the body."""
        chosen = sorted({node for name in self.areas for e in self.areas[name]
                         for node in self.elements[e]})
        new = {node: i for i, node in enumerate(chosen)}
        kept = sorted({e for elements in self.areas.values() for e in elements})
        number = {e: i for i, e in enumerate(kept)}
        self.x = self.x[chosen]
        self.elements = [[new[node] for node in self.elements[e]] for e in kept]
        self.areas = {name: [number[e] for e in group] for name, group in self.areas.items()}
        self.curves = {name: [[new[n] for n in edge] for edge in group
                              if all(n in new for n in edge)]
                       for name, group in self.curves.items()}
        self.points = {name: [new[n] for n in group if n in new]
                       for name, group in self.points.items()}

    def flatten(self):
        """Coordinates x, y; the z of all nodes must be the same."""
        size = np.ptp(self.x, axis=0)
        if size[2] > FLAT * max(size):
            raise ScriptError(f"the mesh is no plane one: its z spans {size[2]:g}; "
                              "draw the body in the x, y plane")
        self.x = self.x[:, :2]

    def orient(self):
        """Turns elements that run clockwise; their number is kept."""
        self.turned = 0
        for i, nodes in enumerate(self.elements):
            n = len(nodes) if len(nodes) < 5 else len(nodes) // 2
            x, y = self.x[nodes[:n]].T
            if np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) < 0:
                self.elements[i] = [nodes[0], *nodes[n - 1 : 0 : -1], *nodes[: n - 1 : -1]]
                self.turned += 1

    def find_sides(self):
        """`sides` {ends: [(element, side from 1)]}."""
        self.sides = {}
        for i, nodes in enumerate(self.elements):
            n = len(nodes) if len(nodes) < 5 else len(nodes) // 2
            for k in range(n):
                ends = frozenset((nodes[k], nodes[(k + 1) % n]))
                self.sides.setdefault(ends, []).append((i, k + 1))

    def surface(self, name):
        """The sides of elements on which a group of curves lies; none where it lies inside."""
        found = [self.sides.get(frozenset(edge[:2]), []) for edge in self.curves[name]]
        return sorted({sides[0] for sides in found if len(sides) == 1})

    def outline(self):
        """All sides with an element on one side only."""
        return sorted(sides[0] for sides in self.sides.values() if len(sides) == 1)

    def outline_name(self):
        """The name of the surface of all sides."""
        return "OUTLINE" if len(self.areas) > 1 else f"{next(iter(self.areas))}_OUTLINE"

    def split(self, name):
        """Opens a crack along a straight curve inside the body: its nodes but the two ends are
        doubled, the new ones belong to the elements on its left."""
        edges = self.curves[name]
        ends = np.array([edge[:2] for edge in edges])
        counts = np.bincount(ends.ravel(), minlength=len(self.x))
        tips = np.flatnonzero(counts == 1)
        if len(edges) < 2:
            length = np.linalg.norm(np.subtract(*self.x[ends[0]]))
            raise ScriptError(f"the crack is one side of an element long, {length:g}, and has nothing "
                              f"between its tips that could open: --size {length / 4:.3g} or less")
        inside = sorted({n for edge in edges for n in edge} - set(tips.tolist()))
        new = {node: len(self.x) + i for i, node in enumerate(inside)}
        start, along = self.x[tips[0]], self.x[tips[1]] - self.x[tips[0]]
        for i, nodes in enumerate(self.elements):
            n = len(nodes) if len(nodes) < 5 else len(nodes) // 2
            away = np.mean(self.x[nodes[:n]], axis=0) - start
            if along[0] * away[1] - along[1] * away[0] > 0:
                self.elements[i] = [new.get(node, node) for node in nodes]
        self.x = np.vstack([self.x, self.x[inside]])
        self.curves[name] = edges + [[new.get(n, n) for n in edge] for edge in edges]
        self.find_sides()


def clean_name(name):
    """A name that a deck may have, as carom has it: none of the characters below, at most 80 bytes,
    no number."""
    name = folded(re.sub(r"[\s,=\"'/*<>]+", "_", name)).strip("_")
    name = name.encode()[:LONGEST].decode(errors="ignore")
    return f"GROUP_{name}" if re.fullmatch(r"[-+\d]+", name) else name


def rows(numbers, in_row=12):
    """Numbers with commas between, so many a line."""
    return [", ".join(map(str, numbers[i : i + in_row])) for i in range(0, len(numbers), in_row)]


def cards(mesh, kind, first_node=1, first_element=1, heading=""):
    """The cards of a mesh: kind is CPE, CPS or CAX."""
    if kind == "CAX" and mesh.x[:, 0].min() < -FLAT * np.ptp(mesh.x):
        raise ScriptError("axisymmetric elements need x (the radius) of zero or more")
    x = np.where(np.abs(mesh.x) < FLAT * np.ptp(mesh.x), 0.0, mesh.x)
    lines = [f"** {line}" for line in heading.splitlines()] + ["*NODE"]
    lines += [f"{i}, {a:.12g}, {b:.12g}" for i, (a, b) in enumerate(x, first_node)]
    for n in sorted({len(nodes) for nodes in mesh.elements}):
        lines.append(f"*ELEMENT, TYPE={kind}{n}")
        lines += [", ".join(map(str, [first_element + i, *(first_node + node for node in nodes)]))
                  for i, nodes in enumerate(mesh.elements) if len(nodes) == n]
    for name, group in mesh.areas.items():
        nodes = sorted({node for e in group for node in mesh.elements[e]})
        lines += [f"*ELSET, ELSET={name}", *rows([first_element + e for e in group])]
        lines += [f"*NSET, NSET={name}", *rows([first_node + n for n in nodes])]
    for name, edges in mesh.curves.items():
        nodes = sorted({n for edge in edges for n in edge})
        lines += set_of_nodes(name, nodes, first_node)
        lines += surface(name, mesh.surface(name), first_element)
    for name, nodes in mesh.points.items():
        lines += set_of_nodes(name, sorted(nodes), first_node)
    if not mesh.curves:
        lines += surface(mesh.outline_name(), mesh.outline(), first_element)
    return "\n".join(lines) + "\n"


def set_of_nodes(name, nodes, first_node):
    """An *NSET card; none without nodes."""
    return [f"*NSET, NSET={name}", *rows([first_node + n for n in nodes])] if nodes else []


def surface(name, sides, first_element):
    """A *SURFACE card; none without sides."""
    found = [f"{first_element + e}, S{side}" for e, side in sides]
    return [f"*SURFACE, NAME={name}", *found] if found else []
