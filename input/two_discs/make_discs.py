"""Writes the decks and meshes of this folder, two discs that collide: make_discs.py"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import disc, write  # noqa: E402

GAP = 0.02


def body(nodes, radius, fineness=1):
    """A disc about the origin."""
    if nodes == 4:
        return disc(radius, 14 * fineness, 9 * fineness)
    return disc(radius, 7 * fineness, 5 * fineness).quadratic((0, 0, radius))


def mesh(left, right, height=0.0):
    """Two discs (nodes, radius, fineness) side by side, the right one higher by so much; their
    surfaces are the halves that face each other."""
    one, two = body(*left), body(*right)
    apart = ((left[1] + right[1] + GAP)**2 - height**2)**0.5
    node, element = len(one.x) + 1, len(one.elements) + 1
    right_half = one.rim(lambda x: x[0] > -1e-9 * left[1])
    left_half = two.rim(lambda x: x[0] < 1e-9 * right[1])
    return ('** written by make_discs.py\n' + one.cards(f'CPE{left[0]}', 'left')
            + one.surface('left_rim', right_half)
            + two.moved(apart, height).cards(f'CPE{right[0]}', 'right', node, element)
            + two.surface('right_rim', left_half, element))


def deck(title, mesh_card, speeds, youngs=(100, 100), impact='*IMPACT', pair='', friction=''):
    """Discs of density 1 that fly along x."""
    return f"""*HEADING
{title}
*PARAMETER
dt = 4e-3
end = 1.6
{mesh_card}*MATERIAL, NAME=left
*ELASTIC
{youngs[0]}, 0.3
*DENSITY
1
*SOLID SECTION, ELSET=left, MATERIAL=left
*MATERIAL, NAME=right
*ELASTIC
{youngs[1]}, 0.3
*DENSITY
1
*SOLID SECTION, ELSET=right, MATERIAL=right
*ELEMENT GROUP, ELSET=left, SCHEME=IMPLICIT, MASS=LUMPED
*ELEMENT GROUP, ELSET=right, SCHEME=IMPLICIT, MASS=LUMPED
*SURFACE INTERACTION, NAME=hit
{impact}
{friction}*CONTACT PAIR, INTERACTION=hit{pair}
left_rim, right_rim
*INITIAL CONDITIONS, TYPE=VELOCITY
left, 1, {speeds[0]}
right, 1, {speeds[1]}
*STEP, INC=10000000
*DYNAMIC, DIRECT
<dt>, <end>
*NODE FILE, FREQUENCY=5
U, V
*EL FILE, FREQUENCY=5
S
*CONTACT PRINT
CF, CDIS
*CONTACT FILE, FREQUENCY=5
CF, CDIS
*ENERGY PRINT
*END STEP
"""


SURFACES = ', TYPE=SURFACE TO SURFACE'
FRICTION = '*FRICTION\n0.2\n'


def texts():
    """All files of this folder."""
    return {
        'equal.inc': mesh((4, 1.0), (4, 1.0)),
        'oblique.inc': mesh((8, 1.0), (4, 0.7), 0.8),
        'equal.inp': deck('Two equal discs fly against each other', '*INCLUDE, INPUT=equal.inc\n',
                          (0.5, -0.5)),
        'oblique.inp': deck('A disc hits a smaller and stiffer one beside its middle, with friction',
                            '*INCLUDE, INPUT=oblique.inc\n', (1.0, 0.0), (100, 200),
                            pair=SURFACES, friction=FRICTION),
    }


if __name__ == '__main__':
    write(Path(__file__).parent, texts())
