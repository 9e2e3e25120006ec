"""Writes the decks and the mesh of this folder, balls that bounce obliquely: make_ball.py"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import disc, write  # noqa: E402

RADIUS, GAP = 1.0, 0.02


def mesh():
    """A disc above y = 0 with its whole rim as the surface, so that it may roll."""
    body = disc(RADIUS, 10, 6)
    return ('** written by make_ball.py\n'
            + body.moved(0, RADIUS + GAP).cards('CPE4', 'ball')
            + body.surface('rim', body.rim()))


def contact(slave, restitution):
    return f"""*RIGID SURFACE, NAME=plane, TYPE=PLANE
0, 0, 0
0, 1, 0
*SURFACE INTERACTION, NAME=rough
*IMPACT{restitution}
*FRICTION
<mu>
*CONTACT PAIR, INTERACTION=rough
{slave}, plane
*INITIAL CONDITIONS, TYPE=VELOCITY
ball, 1, <across>
ball, 2, <down>
"""


def step(prints):
    return f"""*STEP, INC=10000000
*DYNAMIC, DIRECT
<dt>, <end>
*NODE FILE, FREQUENCY=5
U, V
{prints}*CONTACT PRINT
CF, CDIS
*CONTACT FILE, FREQUENCY=5
CF, CDIS
*ENERGY PRINT
*END STEP
"""


def point():
    """A single mass with restitution: its bounces are known exactly."""
    return """*HEADING
A ball of one mass bounces obliquely on a rough plane, without gravity until the first blow
*PARAMETER
mu = 0.3
across = 2
down = -1
dt = 0.01
end = 1
*NODE, NSET=ball
1, 0, 0.5
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*MASS, ELSET=mass
2
*SURFACE, NAME=node, TYPE=NODE
1
""" + contact('node', ', RESTITUTION=0.8') + step('*NODE PRINT\nU, V\n')


def elastic():
    """An elastic disc: friction makes it spin."""
    return """*HEADING
An elastic ball bounces obliquely on a rough plane and begins to spin
*PARAMETER
mu = 0.2
across = 0.5
down = -0.5
dt = 4e-3
end = 1.2
*INCLUDE, INPUT=ball.inc
*MATERIAL, NAME=soft
*ELASTIC
100, 0.3
*DENSITY
1
*SOLID SECTION, ELSET=ball, MATERIAL=soft
*ELEMENT GROUP, ELSET=ball, SCHEME=IMPLICIT, MASS=LUMPED
""" + contact('rim', '') + step('*EL FILE, FREQUENCY=5\nS\n')


def texts():
    """All files of this folder."""
    return {'ball.inc': mesh(), 'point.inp': point(), 'elastic.inp': elastic()}


if __name__ == '__main__':
    write(Path(__file__).parent, texts())
