"""Writes the decks and meshes of this folder, two bars that hit head-on: make_bars.py"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import node_set, rectangle, write  # noqa: E402

GAP, HEIGHT = 0.5, 1.0


def bar(length, along, across, nodes, more=0.0):
    """A bar from x = 0 on, higher by so much on both sides; along and across count distances of
    nodes."""
    low, high = -more, HEIGHT + more
    if nodes == 4:
        return rectangle(0, low, length, high, along, across)
    return rectangle(0, low, length, high, along // 2, across // 2).quadratic()


def mesh(left, right):
    """Two bars (length, along, across, nodes[, more height]), the gap between them before x = 0."""
    one, two = bar(*left).moved(-left[0] - GAP), bar(*right)
    node, element = len(one.x) + 1, len(one.elements) + 1
    far = [p for p, x in enumerate(two.x) if x[0] > right[0] * (1 - 1e-9)]
    return ('** written by make_bars.py\n' + one.cards(f'CPS{left[3]}', 'left')
            + one.surface('left_end', one.rim(lambda x: abs(x[0] + GAP) < 1e-9))
            + two.cards(f'CPS{right[3]}', 'right', node, element)
            + two.surface('right_end', two.rim(lambda x: abs(x[0]) < 1e-9), element)
            + node_set('far', far, node))


def deck(title, mesh_card, speeds, pair='', impact='*IMPACT', friction=''):
    """E = 900, density 1, so that waves run at 30; the bars close the gap of 0.5 at speed 10."""
    return f"""*HEADING
{title}
*PARAMETER
dt = 3.333333333333333e-3
end = 1
nu = 0
{mesh_card}*MATERIAL, NAME=elastic
*ELASTIC
900, <nu>
*DENSITY
1
*SOLID SECTION, ELSET=left, MATERIAL=elastic
1
*SOLID SECTION, ELSET=right, MATERIAL=elastic
1
*ELEMENT GROUP, ELSET=left, SCHEME=IMPLICIT, MASS=LUMPED
*ELEMENT GROUP, ELSET=right, SCHEME=IMPLICIT, MASS=LUMPED
*SURFACE INTERACTION, NAME=hit
{impact}
{friction}*CONTACT PAIR, INTERACTION=hit{pair}
left_end, right_end
*INITIAL CONDITIONS, TYPE=VELOCITY
left, 1, {speeds[0]}
right, 1, {speeds[1]}
*STEP, INC=10000000
*DYNAMIC, DIRECT
<dt>, <end>
*NODE PRINT, NSET=far
U, V
*NODE FILE, FREQUENCY=10
U, V
*EL FILE, FREQUENCY=10
S
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
"""


SURFACES = ', TYPE=SURFACE TO SURFACE'
EQUAL = ((10.0, 100, 4, 4), (10.0, 100, 4, 4))
SHORT_ON_LONG = ((5.0, 50, 4, 4), (10.0, 80, 3, 4))


def texts():
    """All files of this folder."""
    return {
        'equal.inc': mesh(*EQUAL),
        'short_on_long.inc': mesh(*SHORT_ON_LONG),
        'equal.inp': deck('Two equal bars fly against each other', '*INCLUDE, INPUT=equal.inc\n',
                          (5, -5)),
        'short_on_long.inp': deck('A bar hits one of twice its length at rest, nonmatching meshes',
                                  '*INCLUDE, INPUT=short_on_long.inc\n', (10, 0), SURFACES),
    }


if __name__ == '__main__':
    write(Path(__file__).parent, texts())
