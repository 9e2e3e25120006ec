"""Writes the decks and meshes of this folder, static line contact: make_hertz.py

By symmetry a quarter of each disc is meshed: x >= 0, from the contact up to the middle.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mesh_tools import node_set, quarter_disc, write  # noqa: E402

GROWTH = 1.3
POISSON = 0.3


def quarter(radius, width, across):
    """A quarter of a disc above the origin, 8-node elements."""
    return quarter_disc(radius, width, GROWTH, across).quadratic((0, radius, radius))


def low_side(body, radius, reach):
    """Sides of the circle about the contact, as far as x = reach."""
    return body.rim(lambda x: abs((x[0]**2 + (x[1] - radius)**2)**0.5 / radius - 1) < 1e-9
                    and x[0] < reach)


def sets(body, name, radius, first_node=1):
    """Nodes of the axis of symmetry and of the middle of the disc."""
    return (node_set(f'{name}_axis', body.points(lambda x: abs(x[0]) < 1e-12 * radius), first_node)
            + node_set(f'{name}_middle',
                       body.points(lambda x: abs(abs(x[1]) / radius - 1) < 1e-9), first_node))


def single(radius, width, across=8):
    """The mesh of one disc with its surface."""
    body = quarter(radius, width, across)
    return ('** written by make_hertz.py\n' + body.cards('CPE8', 'disc') + sets(body, 'disc', radius)
            + body.surface('low', low_side(body, radius, 2.5 * width)))


def pair(radius_up, radius_down, width, across_up, across_down):
    """The mesh of two discs, one above the other, with their surfaces."""
    up, down = quarter(radius_up, width, across_up), quarter(radius_down, width, across_down)
    sides = low_side(down, radius_down, 2.5 * width)
    down = down.mirrored()
    sides = [(e, {0: 3, 1: 2, 2: 1, 3: 0}[i]) for e, i in sides]
    node, element = len(up.x) + 1, len(up.elements) + 1
    return ('** written by make_hertz.py\n' + up.cards('CPE8', 'up') + sets(up, 'up', radius_up)
            + up.surface('low', low_side(up, radius_up, 2.5 * width))
            + down.cards('CPE8', 'down', node, element) + sets(down, 'down', radius_down, node)
            + down.surface('top', sides, element))


def section(name, young):
    return (f'*MATERIAL, NAME={name}\n*ELASTIC\n{young}, {POISSON}\n'
            f'*SOLID SECTION, ELSET={name}, MATERIAL={name}\n')


def deck(title, mesh, push, sections, boundary, contact):
    """A deck that pushes `middle` down by push in one increment."""
    return f"""*HEADING
{title}
** how far the middle of the upper disc is moved
*PARAMETER
push = {-push}
*INCLUDE, INPUT={mesh}
{sections}*BOUNDARY
{boundary}*SURFACE INTERACTION, NAME=smooth
*IMPACT
{contact}*STEP
*STATIC, DIRECT
1, 1
*NODE FILE
U
*EL FILE
S
*CONTACT PRINT
CF, CDIS
*CONTACT FILE
CF, CDIS
*ENERGY PRINT
*END STEP
"""


def disc_on_plane():
    return deck('A disc on a rigid plane: static line contact of Hertz', 'disc.inc', 4.85e-3,
                section('disc', 1000), 'disc_axis, 1\ndisc_middle, 2, 2, <push>\n',
                '*RIGID SURFACE, NAME=plane, TYPE=PLANE\n0, 0, 0\n0, 1, 0\n'
                '*CONTACT PAIR, INTERACTION=smooth, TYPE=NODE TO SURFACE\nlow, plane\n')


def disc_on_disc(title, mesh, push, youngs, kind, surfaces='low, top'):
    return deck(title, mesh, push, section('up', youngs[0]) + section('down', youngs[1]),
                'up_axis, 1\ndown_axis, 1\ndown_middle, 2\nup_middle, 2, 2, <push>\n',
                f'*CONTACT PAIR, INTERACTION=smooth, TYPE={kind}\n{surfaces}\n')


def texts():
    """All files of this folder."""
    unequal = 'Disc on disc, radii 1 and 3, moduli 1000 and 10000, nonmatching: '
    return {
        'disc.inc': single(1.0, 0.05),
        'matching.inc': pair(1.0, 1.0, 0.05, 8, 8),
        'nonmatching.inc': pair(1.0, 3.0, 0.0075, 8, 7),
        'disc_on_plane.inp': disc_on_plane(),
        'matching.inp': disc_on_disc('Two equal discs with matching meshes', 'matching.inc',
                                     2 * 4.85e-3, (1000, 1000), 'NODE TO SURFACE'),
        'nonmatching.inp': disc_on_disc(unequal + 'weighted rows', 'nonmatching.inc', 2.1924e-4,
                                        (1000, 10000), 'SURFACE TO SURFACE'),
        'nonmatching_nodes.inp': disc_on_disc(unequal + 'node rows', 'nonmatching.inc', 2.1924e-4,
                                              (1000, 10000), 'NODE TO SURFACE'),
        'nonmatching_swapped.inp': disc_on_disc(
            unequal + 'node rows, the coarser side as slave', 'nonmatching.inc', 2.1924e-4,
            (1000, 10000), 'NODE TO SURFACE', 'top, low'),
    }


if __name__ == '__main__':
    write(Path(__file__).parent, texts())
