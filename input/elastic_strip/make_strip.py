"""Writes the decks and meshes of this folder, an elastic strip against a wall: make_strip.py"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import node_set, rectangle, write  # noqa: E402

LENGTH, HEIGHT = 10.0, 1.0


def strip(nodes, divisions=100):
    """A strip with so many distances of nodes along it, square elements of 4 or 8 nodes."""
    if nodes == 4:
        return rectangle(0, 0, LENGTH, HEIGHT, divisions, divisions // 10)
    return rectangle(0, 0, LENGTH, HEIGHT, divisions // 2, divisions // 20).quadratic()


def mesh(nodes, divisions=100):
    """Mesh, the set of its far end and the surface of its left end."""
    body = strip(nodes, divisions)
    return ('** written by make_strip.py\n' + body.cards(f'CPS{nodes}', 'strip')
            + node_set('far', body.points(lambda x: x[0] > LENGTH * (1 - 1e-9)))
            + body.surface('end', body.rim(lambda x: x[0] < 1e-9)))


def deck(title, mesh_card, impact='*IMPACT', pair='', procedure='DYNAMIC, DIRECT', group=''):
    """The strip flies with 10 against a wall 5 away; it starts so that one node distance takes one
    step at dt = 0.1/30."""
    return f"""*HEADING
{title}
** dt: one Courant step is 0.1/30; nu: Poisson's ratio
*PARAMETER
dt = 3.333333333333333e-3
end = 1.4
nu = 0
{mesh_card}*MATERIAL, NAME=elastic
*ELASTIC
900, <nu>
*DENSITY
1
*SOLID SECTION, ELSET=strip, MATERIAL=elastic
1
{group}** the wall stands 5 before the strip's end, which flies towards it with 10
*RIGID SURFACE, NAME=wall, TYPE=PLANE
-5, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=hit
{impact}
*CONTACT PAIR, INTERACTION=hit{pair}
end, wall
*INITIAL CONDITIONS, TYPE=VELOCITY
strip, 1, -10
*STEP, INC=10000000
*{procedure}
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


LUMPED = '*ELEMENT GROUP, ELSET=strip, SCHEME=IMPLICIT, MASS=LUMPED\n'


def texts():
    """All files of this folder."""
    decks = {'q4.inc': mesh(4), 'q8.inc': mesh(8)}
    for nodes in (4, 8):
        title = f'An elastic strip of {nodes}-node elements hits a wall'
        card = f'*INCLUDE, INPUT=q{nodes}.inc\n'
        decks[f'q{nodes}.inp'] = deck(title, card, group=LUMPED)
        decks[f'q{nodes}_massless.inp'] = deck(title + ', contact nodes without mass', card,
                                               pair=', MASS=REDISTRIBUTED', group=LUMPED)
    decks['q4_fictitious.inp'] = deck(
        'An elastic strip of 4-node elements hits a wall: fictitious force',
        '*INCLUDE, INPUT=q4.inc\n', '*IMPACT, METHOD=FICTITIOUS FORCE, RETURN=0.3', group=LUMPED)
    return decks


if __name__ == '__main__':
    write(Path(__file__).parent, texts())
