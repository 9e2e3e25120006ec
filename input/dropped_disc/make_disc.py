"""Writes the decks and meshes of this folder, a disc dropped on a rigid plane: make_disc.py"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import disc, write  # noqa: E402

RADIUS, GAP = 1.0, 0.01


def mesh(nodes=4, fineness=1, radius=RADIUS):
    """A disc above y = 0, with its lower half as the surface: 1458 freedoms of 4-node elements at
    fineness 1, 8-node elements twice as large."""
    if nodes == 4:
        body = disc(radius, 14 * fineness, 9 * fineness)
    else:
        body = disc(radius, 7 * fineness, 5 * fineness).quadratic((0, 0, radius))
    sides = body.rim(lambda x: x[1] < -0.3 * radius)
    body = body.moved(0, radius + GAP)
    return ('** written by make_disc.py\n' + body.cards(f'CPE{nodes}', 'disc')
            + body.surface('low', sides))


LUMPED = '*ELEMENT GROUP, ELSET=disc, SCHEME=IMPLICIT, MASS=LUMPED\n'


def deck(title, mesh_card, impact='*IMPACT', pair='', group=LUMPED, procedure='DYNAMIC, DIRECT'):
    """The disc flies down with 0.5 and touches at 0.02."""
    return f"""*HEADING
{title}
*PARAMETER
dt = 4e-3
end = 1.2
{mesh_card}*MATERIAL, NAME=soft
*ELASTIC
100, 0.3
*DENSITY
1
*SOLID SECTION, ELSET=disc, MATERIAL=soft
{group}*RIGID SURFACE, NAME=plane, TYPE=PLANE
0, 0, 0
0, 1, 0
*SURFACE INTERACTION, NAME=hit
{impact}
*CONTACT PAIR, INTERACTION=hit{pair}
low, plane
*INITIAL CONDITIONS, TYPE=VELOCITY
disc, 2, -0.5
*STEP, INC=10000000
*{procedure}
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


def texts():
    """All files of this folder."""
    return {
        'q4.inc': mesh(4), 'q8.inc': mesh(8),
        'q4.inp': deck('A disc is dropped on a plane', '*INCLUDE, INPUT=q4.inc\n'),
        'q8.inp': deck('A disc of 8-node elements is dropped on a plane',
                       '*INCLUDE, INPUT=q8.inc\n'),
        'q4_massless.inp': deck('A disc is dropped on a plane, contact nodes without mass',
                                '*INCLUDE, INPUT=q4.inc\n', pair=', MASS=REDISTRIBUTED'),
        'q4_fictitious.inp': deck('A disc is dropped on a plane: fictitious force',
                                  '*INCLUDE, INPUT=q4.inc\n',
                                  '*IMPACT, METHOD=FICTITIOUS FORCE, RETURN=0.3'),
    }


if __name__ == '__main__':
    write(Path(__file__).parent, texts())
