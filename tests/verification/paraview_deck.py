"""A deck with every kind of cell that results have, for verify_paraview.py: a row of bodies in free fall
onto a plane, each with elements of another type, and masses, springs, trusses and a line beside them."""

# the type of the elements, their nodes in a unit square, the elements
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
MIDDLES = [(0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5)]
BODIES = [
    ('CPE3', SQUARE, [(1, 2, 3), (1, 3, 4)]),
    ('CPE4', SQUARE, [(1, 2, 3, 4)]),
    ('CPE6', SQUARE + MIDDLES + [(0.5, 0.5)], [(1, 2, 3, 5, 6, 9), (1, 3, 4, 9, 7, 8)]),
    ('CPE8', SQUARE + MIDDLES, [(1, 2, 3, 4, 5, 6, 7, 8)]),
]
# what VTK calls the cells: https://vtk.org/doc/nightly/html/vtkCellType_8h.html
VTK_TYPES = {'CPE3': 5, 'CPE4': 9, 'CPE6': 22, 'CPE8': 23, 'T2D2': 3, 'T2D3': 21, 'SPRINGA': 3,
             'SPRING1': 1, 'MASS': 1, 'GAPUNI': 3}

CARDS = """*MATERIAL, NAME=m
*ELASTIC
1000, 0.3
*DENSITY
1
*SOLID SECTION, ELSET=solids, MATERIAL=m
*SOLID SECTION, ELSET=T2D2, MATERIAL=m
0.1
*MASS, ELSET=MASS
0.5
*SPRING, ELSET=SPRINGA

100
*SPRING, ELSET=SPRING1
2
1
*GAP, ELSET=GAPUNI, INTERACTION=hit
2, 0, 1
*SURFACE, NAME=feet, TYPE=NODE
bodies
*RIGID SURFACE, NAME=floor, TYPE=PLANE
0, -0.3, 0
0, 1, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, METHOD=TRANSFORMATION
*CONTACT PAIR, INTERACTION=hit
feet, floor
*BOUNDARY
ground, 1, 2
*INITIAL CONDITIONS, TYPE=VELOCITY
bodies, 2, -2
*STEP
*DYNAMIC, DIRECT
0.01, 0.2
*NODE FILE, FREQUENCY=4
U, V, A, RF
*EL FILE, FREQUENCY=4
S, E, PEEQ, ENER
*CONTACT FILE, FREQUENCY=4
CF, CDIS
*NODE PRINT, NSET=bodies
U
*ENERGY PRINT
*END STEP
"""


def every_kind():
    """The text of the deck, and the types of its elements in their order."""
    nodes, cards, kinds = [], [], []
    bodies = []
    for column, (kind, places, elements) in enumerate(BODIES):
        first = len(nodes)
        nodes += [(x + 1.5 * column, y) for x, y in places]
        bodies += range(first + 1, len(nodes) + 1)
        cards.append(f'*ELEMENT, TYPE={kind}, ELSET=solids')
        for element in elements:
            kinds.append(kind)
            cards.append(', '.join(str(n) for n in [len(kinds), *(first + n for n in element)]))
    last = len(nodes)       # a stand beside the bodies: ground, ground, and a mass on a truss
    nodes += [(7, 0), (8, 0), (7, 1)]
    q8 = last - 7
    for kind, ring in (('T2D2', (last + 1, last + 3)), ('SPRINGA', (last + 2, last + 3)),
                       ('MASS', (last + 3,)), ('SPRING1', (q8 + 2,)), ('GAPUNI', (last + 2, last + 3)),
                       ('T2D3', (q8, q8 + 1, q8 + 4))):
        kinds.append(kind)
        cards += [f'*ELEMENT, TYPE={kind}, ELSET={kind}', ', '.join(map(str, [len(kinds), *ring]))]
    sets = ['*NSET, NSET=bodies', *(f'{n},' for n in bodies),
            '*NSET, NSET=ground', f'{last + 1}, {last + 2}']
    lines = ['*NODE'] + [f'{i}, {x}, {y}' for i, (x, y) in enumerate(nodes, 1)]
    return '\n'.join([*lines, *cards, *sets]) + '\n' + CARDS, kinds
