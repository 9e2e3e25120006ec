"""Decks of any size for bench.py: grids of plane strain elements, numbered row by row."""

import numpy as np

MODULUS, POISSON, DENSITY = 900.0, 0.3, 1.0
WAVE = (MODULUS * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON)) / DENSITY) ** 0.5


def q4_grid(n, m=None):
    """Points and corners (from 0) of n by m unit squares."""
    m = m or n
    j, i = np.divmod(np.arange((n + 1) * (m + 1)), n + 1)
    first = (np.arange(m)[:, None] * (n + 1) + np.arange(n)).ravel()
    elements = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1)
    return np.stack([i, j], axis=1).astype(float), elements


def q8_grid(n):
    """Points and nodes (from 0) of n by n unit squares with middle nodes, row by row."""
    j, i = np.divmod(np.arange((2 * n + 1) ** 2), 2 * n + 1)
    exists = (i % 2 == 0) | (j % 2 == 0)
    number = np.cumsum(exists) - 1
    first = (2 * np.arange(n)[:, None] * (2 * n + 1) + 2 * np.arange(n)).ravel()
    row = 2 * n + 1
    offsets = [0, 2, 2 * row + 2, 2 * row, 1, row + 2, 2 * row + 1, row]
    elements = number[first[:, None] + offsets]
    return 0.5 * np.stack([i, j], axis=1)[exists], elements


def lines(first, rows, form):
    """Rows of numbers as lines of text, each with its id before them."""
    ids = np.arange(first, first + len(rows))
    return "\n".join(map(form.format, ids, *rows.T.tolist())) + "\n"


def mesh_cards(x, elements, kind):
    """The cards of nodes and elements; the set of all elements is `body`."""
    return (
        "*NODE, NSET=all\n" + lines(1, x, "{}, {:.10g}, {:.10g}")
        + f"*ELEMENT, TYPE={kind}, ELSET=body\n"
        + lines(1, elements + 1, "{}" + ", {}" * elements.shape[1])
    )


def moving_deck(grid, kind, courant, dynamic, held="", plastic="", requests="", impact=""):
    """A body that starts with a speed in x which falls off with x, by `steps` increments."""
    x, elements = grid
    dt = courant / WAVE
    return f"""*HEADING
{len(elements)} elements {kind}
*PARAMETER
dt = {dt:.12e}
end = {10.5 * dt:.12e}
{mesh_cards(x, elements, kind)}*MATERIAL, NAME=stuff
*ELASTIC
{MODULUS}, {POISSON}
{plastic}*DENSITY
{DENSITY}
*SOLID SECTION, ELSET=body, MATERIAL=stuff
1
{held}{impact}*STEP, INC=100000000
*DYNAMIC, DIRECT{dynamic}
<dt>, <end>
{requests}*END STEP
"""


def left_side(x):
    """The cards that hold the points at x = 0 and push the others away from it."""
    held = np.flatnonzero(x[:, 0] < 1e-9) + 1
    moving = np.flatnonzero(x[:, 0] > x[:, 0].max() - 1e-9) + 1
    return (
        "*NSET, NSET=held\n" + "".join(f"{node}\n" for node in held)
        + "*NSET, NSET=moving\n" + "".join(f"{node}\n" for node in moving)
        + "*BOUNDARY\nheld, 1, 2\n*INITIAL CONDITIONS, TYPE=VELOCITY\nmoving, 1, 3.0\n"
    )


def implicit_block(n):
    """n by n CPE8, held on the left; a wave passes an element in a step."""
    grid = q8_grid(n)
    return moving_deck(grid, "CPE8", 1.0, "", left_side(grid[0]))


def parse_block(n):
    """n by n CPE4 with coordinates of ten digits, to be read."""
    x, elements = q4_grid(n)
    return moving_deck((x / 7.0, elements), "CPE4", 0.8 / 7.0, ", EXPLICIT", left_side(x))


def explicit_block(n, plastic=False, requests="", m=None):
    """n by m CPE4 at 0.8 of the critical step; plastic: beyond yield from the first step on."""
    grid = q4_grid(n, m)
    card = "*PLASTIC\n1.0, 0\n101.0, 1\n" if plastic else ""
    return moving_deck(grid, "CPE4", 0.8, ", EXPLICIT", left_side(grid[0]), card, requests)


FIELDS = "*NODE FILE, FREQUENCY=10\nU, V\n"
