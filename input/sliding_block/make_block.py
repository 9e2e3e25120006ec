"""Writes the decks and meshes of this folder, blocks on rough planes: make_block.py"""
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import node_set, rectangle, write  # noqa: E402

LENGTH, HEIGHT, YOUNG, GRAVITY = 2.0, 1.0, 1.0e4, 9.81
WAVE = math.sqrt(YOUNG)                 # speed of waves at density 1, and nu = 0


def mesh(nodes=4, angle=0.0, along=8):
    """A block on a plane through the origin that falls to the right by an angle in degrees."""
    across = along // 2
    body = rectangle(-LENGTH / 2, 0, LENGTH / 2, HEIGHT, along, across)
    if nodes == 8:
        body = rectangle(-LENGTH / 2, 0, LENGTH / 2, HEIGHT, along // 2, across // 2).quadratic()
    sides = body.rim(lambda x: x[1] < 1e-9)
    return ('** written by make_block.py\n'
            + body.moved(turn=-math.radians(angle)).cards(f'CPS{nodes}', 'block')
            + node_set('seen', body.points(lambda x: abs(x[0]) < 1e-9 and x[1] > HEIGHT - 1e-9))
            + body.surface('base', sides))


def deck(title, mesh_card, parameters, angle=0.0, damping=0.3, velocity='', impact='*IMPACT',
         poisson=0.3):
    """A block under its weight; damping: b_K in units of height / wave speed."""
    slope = math.radians(angle)
    return f"""*HEADING
{title}
** mu: friction; damping: of the block's stiffness, {damping} of height / wave speed
*PARAMETER
damping = {damping * HEIGHT / WAVE:.12g}
{parameters}{mesh_card}*MATERIAL, NAME=elastic
*ELASTIC
{YOUNG}, {poisson}
*DENSITY
1
*DAMPING, BETA=<damping>
*SOLID SECTION, ELSET=block, MATERIAL=elastic
1
*RIGID SURFACE, NAME=plane, TYPE=PLANE
0, 0, 0
{math.sin(slope) + 0.0:.15g}, {math.cos(slope):.15g}, 0
*SURFACE INTERACTION, NAME=rough
{impact}
*FRICTION
<mu>
*CONTACT PAIR, INTERACTION=rough
base, plane
{velocity}*STEP, INC=10000000
*DYNAMIC, DIRECT
<dt>, <end>
*DLOAD
block, GRAV, {GRAVITY}, 0, -1, 0
*NODE PRINT, NSET=seen
U, V
*NODE FILE, FREQUENCY=10
U, V
*EL FILE, FREQUENCY=10
S
*CONTACT PRINT
CF, CDIS
*CONTACT FILE, FREQUENCY=10
CF, CDIS
*ENERGY PRINT
*END STEP
"""


ANGLE = 30.0


def texts():
    """All files of this folder."""
    slide = 'mu = 0.3\ndt = 1e-3\nend = 2\nspeed = 5\n'
    return {
        'flat.inc': mesh(),
        'slope.inc': mesh(angle=ANGLE),
        'sliding.inp': deck('A block slides to rest on a rough plane', '*INCLUDE, INPUT=flat.inc\n',
                            slide, velocity='*INITIAL CONDITIONS, TYPE=VELOCITY\n'
                                            'block, 1, <speed>\n'),
        'slope.inp': deck('A block on a slope of 30 degrees: it slides for mu < 0.577',
                          '*INCLUDE, INPUT=slope.inc\n', 'mu = 0.3\ndt = 1e-3\nend = 1\n',
                          angle=ANGLE, damping=1.0),
    }


if __name__ == '__main__':
    write(Path(__file__).parent, texts())
