"""Writes the deck and mesh of this folder, a block thrown at a wall: make_block.py [elements a side] [folder]"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import node_set, rectangle, write  # noqa: E402

SIDE = 1.0
DENSITY, MODULUS, POISSON = 1.0, 900.0, 0.3
SPEED = 1.0
FLIGHT = 5.4     # steps until the wall is hit


def wave_speed():
    """Of pressure waves in plane strain."""
    return (MODULUS * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON)) / DENSITY) ** 0.5


def mesh(n):
    """n by n elements of 8 nodes; `face` are the nodes of the left side."""
    body = rectangle(0, 0, SIDE, SIDE, n, n).quadratic()
    return (f'** written by make_block.py: {n} by {n} elements\n' + body.cards('CPE8', 'block')
            + node_set('face', body.points(lambda x: x[0] < 1e-9 * SIDE)))


def deck(n, impact='*IMPACT, METHOD=TRANSFORMATION', steps=None, dynamic='DYNAMIC, DIRECT'):
    """A pressure wave passes one element in a step. The wave comes back after 2 n steps and the block
    leaves the wall; by default the run ends a quarter of that later."""
    dt = SIDE / n / wave_speed()
    steps = steps or round(FLIGHT + 2.5 * n)
    return f"""*HEADING
A block of {n} by {n} elements is thrown at a wall (plane strain)
** dt: a pressure wave passes one element in a step
*PARAMETER
dt = {dt:.12e}
end = {steps * dt:.12e}
*INCLUDE, INPUT=block.inc
*MATERIAL, NAME=elastic
*ELASTIC
{MODULUS:g}, {POISSON:g}
*DENSITY
{DENSITY:g}
*SOLID SECTION, ELSET=block, MATERIAL=elastic
1
*SURFACE, NAME=front, TYPE=NODE
face
** the wall stands {FLIGHT:g} steps' way before the block
*RIGID SURFACE, NAME=wall, TYPE=PLANE
{-FLIGHT * SPEED * dt:.12e}, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=hit
{impact}
*CONTACT PAIR, INTERACTION=hit
front, wall
*INITIAL CONDITIONS, TYPE=VELOCITY
block, 1, {-SPEED:g}
*STEP, INC=10000000
*{dynamic}
<dt>, <end>
*NODE FILE, FREQUENCY=10
U, V
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
"""


def texts(n=40):
    """All files of this folder, for so many elements a side."""
    return {'block.inc': mesh(n), 'block.inp': deck(n)}


if __name__ == '__main__':
    arguments = sys.argv[1:]
    folder = Path(arguments[1]) if len(arguments) > 1 else Path(__file__).parent
    folder.mkdir(parents=True, exist_ok=True)
    write(folder, texts(int(arguments[0]) if arguments else 40))
