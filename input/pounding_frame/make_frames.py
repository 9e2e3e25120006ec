"""Writes the decks and meshes of this folder, two frames that pound: make_frames.py"""
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import grid, joined, node_set, write  # noqa: E402

STOREY, BAY, FLOOR = 3.0, 5.0, 0.4       # height and width between axes, depth of a floor, m
GAP = 0.01


def frame(storeys, column, x0, fineness=1):
    """A frame of one bay, 8-node elements: its columns are so wide; x0 is its left face. Returns the
    body and which of its elements are floors."""
    parts = []
    across = np.linspace(0, column, fineness + 1)
    right = BAY
    span = np.linspace(column, right, 8 * fineness + 1)
    for storey in range(storeys):
        low, high = storey * STOREY, (storey + 1) * STOREY - FLOOR
        up = np.linspace(low, high, 5 * fineness + 1)
        deck = np.linspace(high, high + FLOOR, fineness + 1)
        parts += [grid(across, up), grid(right + across, up),
                  grid(across, deck), grid(span, deck), grid(right + across, deck)]
    body = joined(*parts)
    centres = body.x[body.elements].mean(axis=1)
    body = body.quadratic()
    floors = np.flatnonzero((centres[:, 1] % STOREY) > STOREY - FLOOR)
    return body.moved(x0), floors


def mesh(fineness=2):
    """A frame of two slender storeys on the left, one of a single stiff storey on the right; the
    faces of their first floors stand the gap apart, about x = 0."""
    slender, stiff = 0.3, 0.5
    text, first_node, first_element = '** written by make_frames.py\n', 1, 1
    for name, storeys, column in (('left', 2, slender), ('right', 1, stiff)):
        x0 = GAP / 2 if name == 'right' else -GAP / 2 - BAY - column
        face = -GAP / 2 if name == 'left' else GAP / 2
        body, floors = frame(storeys, column, x0, fineness)
        text += body.cards('CPS8', name, first_node, first_element)
        text += f'*ELSET, ELSET={name}_floors\n' + ''.join(f'{first_element + e}\n' for e in floors)
        columns = np.setdiff1d(np.arange(len(body.elements)), floors)
        text += f'*ELSET, ELSET={name}_columns\n' + ''.join(
            f'{first_element + e}\n' for e in columns)
        text += node_set(f'{name}_foot', body.points(lambda x: x[1] < 1e-9), first_node)
        top = body.points(lambda x: abs(x[0] - face) < 1e-9 and abs(x[1] - STOREY) < 1e-9)
        text += node_set(f'{name}_floor', top, first_node)
        sides = body.rim(lambda x: abs(x[0] - face) < 1e-9
                         and STOREY - FLOOR - 1e-9 < x[1] < STOREY + 1e-9)
        text += body.surface(f'{name}_face', sides, first_element)
        first_node += len(body.x)
        first_element += len(body.elements)
    return text


def ground():
    """Data lines of an amplitude: an acceleration of one sine in half a second, largest 6."""
    t = np.arange(0, 0.5 + 1e-9, 0.02)
    pairs = [f'{when:.2f}, {6.0 * math.sin(4 * math.pi * when) + 0.0:.6f}' for when in t]
    return ''.join(', '.join(pairs[i:i + 4]) + '\n' for i in range(0, len(pairs), 4))


def deck(title, mesh_card, impact='*IMPACT', pair=', TYPE=SURFACE TO SURFACE'):
    """Concrete, floors that carry ten times their weight, a common motion of the ground."""
    sections = ''.join(f'*SOLID SECTION, ELSET={name}_{part}, MATERIAL={part}\n1\n'
                       for name in ('left', 'right') for part in ('floors', 'columns'))
    return f"""*HEADING
{title}
** metre, tonne, second, kilonewton
*PARAMETER
dt = 1e-3
end = 1
{mesh_card}*MATERIAL, NAME=columns
*ELASTIC
3e7, 0.2
*DENSITY
2.5
*DAMPING, BETA=1e-3
*MATERIAL, NAME=floors
*ELASTIC
3e7, 0.2
*DENSITY
25
*DAMPING, BETA=1e-3
{sections}*AMPLITUDE, NAME=ground
{ground()}*SURFACE INTERACTION, NAME=hit
{impact}
*CONTACT PAIR, INTERACTION=hit{pair}
left_face, right_face
*BOUNDARY
left_foot, 1, 2
right_foot, 1, 2
*STEP, INC=10000000
*DYNAMIC, DIRECT
<dt>, <end>
*BASE MOTION, AMPLITUDE=ground, DOF=1
*NODE PRINT, NSET=left_floor
U, V
*NODE PRINT, NSET=right_floor
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


def texts():
    """All files of this folder."""
    return {
        'frames.inc': mesh(),
        'frames.inp': deck('Two frames pound when the ground moves', '*INCLUDE, INPUT=frames.inc\n'),
    }


if __name__ == '__main__':
    write(Path(__file__).parent, texts())
