"""Small meshes as gmsh writes them to .inp files, for verify_meshes.py: no gmsh is needed."""

import numpy as np

# a strip of two squares: corners counterclockwise, of each square or of each half of it
QUADS = [[0, 1, 4, 3], [1, 2, 5, 4]]
TRIANGLES = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]
CORNERS = np.array([[x, y] for y in (0, 1) for x in (0, 1, 2)], dtype=float)
BOTTOM = [[0, 1], [1, 2]]
SIDE = [[3, 0]]


def with_middles(rings, points, numbers):
    """The rings with nodes between their corners; points and numbers grow."""
    found = []
    for ring in rings:
        pairs = list(zip(ring, ring[1:] + ring[:1])) if len(ring) > 2 else [tuple(ring)]
        for pair in pairs:
            if frozenset(pair) not in numbers:
                numbers[frozenset(pair)] = len(points)
                points.append((points[pair[0]] + points[pair[1]]) / 2)
        found.append(ring + [numbers[frozenset(pair)] for pair in pairs])
    return found


def rows(numbers):
    """Ten numbers a line, each with a comma and a blank behind it."""
    return [' '.join(f'{n},' for n in numbers[i : i + 10]) + ' '
            for i in range(0, len(numbers), 10)]


def gmsh_text(cells=(QUADS, []), order=1, groups=('part', 'bottom'), node_sets=False,
              clockwise=False, lines=True, center=False):
    """A mesh of cells (first square, second square): curves, surfaces, then groups."""
    points, numbers = list(CORNERS), {}
    bottom, side = BOTTOM, SIDE
    if order == 2:
        bottom, side, *cells = [with_middles(c, points, numbers) for c in (bottom, side, *cells)]
    if clockwise:
        cells = [[ring[::-1] for ring in part] for part in cells]
    parts = [('T3D' + str(order + 1), 'Line1', bottom), ('T3D' + str(order + 1), 'Line2', side)]
    parts = parts if lines else []
    parts += [(f'CPS{len(part[0])}', f'Surface{i}', part) for i, part in enumerate(cells, 1) if part]
    text = ['*Heading', ' mesh.inp', '*NODE']
    text += [f'{i}, {x:.14g}, {y:.14g}, 0' for i, (x, y) in enumerate(points, 1)]
    text += [f'{len(points) + 1}, 1, 5, 0'] if center else []
    text.append('******* E L E M E N T S *************')
    number, own = 0, {}
    for kind, name, rings in parts:
        text.append(f'*ELEMENT, type={kind}, ELSET={name}')
        for ring in rings:
            number += 1
            own.setdefault(name[:4], []).append((number, ring))
            text.append(', '.join(str(n) for n in [number, *(node + 1 for node in ring)]))
    members = {groups[0]: own['Surf'], groups[1]: own.get('Line', [])[: len(bottom)]} if groups else {}
    for name, group in members.items():
        text += [f'*ELSET,ELSET={name}', *rows([n for n, _ in group])] if group else []
    for name, group in members.items() if node_sets else ():
        text += [f'*NSET,NSET={name}', *rows(sorted({n + 1 for _, ring in group for n in ring}))]
    return '\n'.join(text) + '\n'
