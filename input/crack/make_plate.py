"""Writes the decks and the mesh of this folder, a plate with a slanted crack: make_plate.py"""
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import Body, node_set, rectangle, write  # noqa: E402

WIDTH, HEIGHT = 4.0, 6.0
ALONG, ACROSS = 24, 36                   # elements
FIRST, LAST = 8, 16                      # columns of nodes where the crack begins and ends


def plate(angle, cracked=True):
    """The plate about the origin and the sides of the crack above and below it; its middle row of
    nodes is slanted by an angle in degrees. The tips of the crack are one node."""
    body = rectangle(-WIDTH / 2, -HEIGHT / 2, WIDTH / 2, HEIGHT / 2, ALONG, ACROSS)
    x, y = body.x.T
    body.x[:, 1] += x * math.tan(math.radians(angle)) * (1 - (2 * y / HEIGHT)**2)
    above = [(ACROSS // 2) * ALONG + i for i in range(FIRST, LAST)]
    below = [(ACROSS // 2 - 1) * ALONG + i for i in range(FIRST, LAST)]
    sides = [(e, 0) for e in above], [(e, 2) for e in below]
    if not cracked:
        return body, sides
    # every point of the crack but its tips gets a second node, which the elements above take
    row = (ACROSS // 2) * (ALONG + 1)
    inner = [row + i for i in range(FIRST + 1, LAST)]
    second = {p: len(body.x) + k for k, p in enumerate(inner)}
    elements = body.elements.copy()
    for e in range((ACROSS // 2) * ALONG, len(elements)):
        elements[e] = [second.get(p, p) for p in elements[e]]
    return Body(np.concatenate((body.x, body.x[inner])), elements), sides


def mesh(angle=30.0, cracked=True):
    """Mesh, surfaces of the crack, and the set of the lower edge."""
    body, (above, below) = plate(angle, cracked)
    text = '** written by make_plate.py\n' + body.cards('CPE4', 'plate')
    text += node_set('foot', body.points(lambda x: x[1] < -HEIGHT / 2 + 1e-9))
    loaded = [e + 1 for e, i in body.rim(lambda x: x[1] > HEIGHT / 2 - 1e-9)]
    text += '*ELSET, ELSET=head\n' + ''.join(f'{e}\n' for e in loaded)
    if cracked:
        text += body.surface('above', above) + body.surface('below', below)
    return text


def sine(period=1.0, pieces=16):
    """Data lines of an amplitude: one period of a sine, straight between its points."""
    pairs = [f'{period * i / pieces:.6g}, {round(math.sin(2 * math.pi * i / pieces), 12) + 0.0:.12g}'
             for i in range(pieces + 1)]
    return ''.join(', '.join(pairs[i:i + 4]) + '\n' for i in range(0, len(pairs), 4))


def deck(title, mesh_card, impact='*IMPACT', pair='', friction='', pulse='', cracked=True,
         step='DYNAMIC, DIRECT'):
    """A sine of stress, first tension, on the upper edge; the lower edge is held."""
    contact = f"""*SURFACE INTERACTION, NAME=faces
{impact}
{friction}*CONTACT PAIR, INTERACTION=faces{pair}
above, below
"""
    return f"""*HEADING
{title}
** waves run at 11.6 (pressure) and 6.2 (shear)
*PARAMETER
dt = 5e-3
end = 3
{mesh_card}*MATERIAL, NAME=elastic
*ELASTIC
100, 0.3
*DENSITY
1
*SOLID SECTION, ELSET=plate, MATERIAL=elastic
*ELEMENT GROUP, ELSET=plate, SCHEME=IMPLICIT, MASS=LUMPED
*AMPLITUDE, NAME=pulse
{pulse or sine()}*BOUNDARY
foot, 1, 2
{contact if cracked else ''}*STEP, INC=10000000
*{step}
<dt>, <end>
*DLOAD, AMPLITUDE=pulse
head, P3, -1
*NODE FILE, FREQUENCY=4
U, V
*EL FILE, FREQUENCY=4
S
*CONTACT PRINT
CF, CDIS
*CONTACT FILE, FREQUENCY=4
CF, CDIS
*ENERGY PRINT
*END STEP
"""


def texts():
    """All files of this folder."""
    return {
        'plate.inc': mesh(),
        'slap.inp': deck('A plate with a slanted crack under a pulse of tension and compression',
                         '*INCLUDE, INPUT=plate.inc\n'),
        'slap_fictitious.inp': deck(
            'A plate with a slanted crack: fictitious force', '*INCLUDE, INPUT=plate.inc\n',
            '*PARAMETER\nreturn = 0.3\n*IMPACT, METHOD=FICTITIOUS FORCE, RETURN=<return>'),
    }


if __name__ == '__main__':
    write(Path(__file__).parent, texts())
