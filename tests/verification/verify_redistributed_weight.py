"""Weight with MASS=REDISTRIBUTED: what falls freely is not strained and has all of its momentum from
the first increment on, what is at rest under its weight stays so when motion begins."""
import numpy as np

from carom_case import Checks, run_deck
from plane_bodies import Deck, block, frames
from solid_mesh import Mesh

GRAVITY = '*DLOAD\n, GRAV, 10, 0, -1, 0\n'


def warped(nx, ny, nodes):
    """A block of skew elements."""
    return Mesh(nx, ny, nodes, lambda s, t: (2 + s + 0.1*t*(1 - t), t + 0.15*s*t*(1 - t) + 0.05*s))


def body(kind, mesh, held=''):
    """A body above a floor far below it, whose lower face has no mass."""
    deck = Deck().body('body', mesh, poisson=0.3, kind=kind)
    deck.surface('sole', ('body', 1))
    deck.add('*RIGID SURFACE, NAME=floor, TYPE=PLANE\n0, -5\n0, 1')
    deck.pair('sole', 'floor', 'MASS=REDISTRIBUTED')
    return deck.add(held) if held else deck


def check_fall(checks):
    """d = -g t^2/2 everywhere, without stress; the energy balances."""
    for kind, mesh in (('CPE', block(4, 4, 4, (2, 0), (3, 1))), ('CPE', warped(4, 4, 8)),
                       ('CPS', warped(4, 4, 6)), ('CAX', block(4, 4, 8, (2, 0), (3, 1)))):
        label = f'{kind}{mesh.nodes} falls'
        run = run_deck(body(kind, mesh).text(5e-4, 0.04, GRAVITY, '*EL FILE\nS\n'))
        t = run['VTKHDF/Steps/Values']
        u = frames(run, 'U')
        checks.at_most(np.abs(u[:, :, 1] + 5*t[:, None]**2).max(), 1e-12, label + ': displacement')
        checks.at_most(np.abs(u[:, :, 0]).max(), 1e-12, label + ': none sideways')
        checks.at_most(np.abs(run['VTKHDF/CellData/S']).max(), 1e-9, label + ': stress')
        checks.at_most(np.abs(run['energy/balance_error']).max(), 1e-12, label + ': balance')


def check_rest(checks):
    """Hung up at rest by its upper face, then in motion: nothing moves."""
    for mesh in (warped(4, 4, 4), warped(4, 4, 8)):
        ids = 1 + np.array(mesh.at(t=1))
        held = '*NSET, NSET=top\n' + ''.join(f'{i}\n' for i in ids) + '*BOUNDARY\ntop, 1, 2'
        text = body('CPE', mesh, held).text(5e-4, 0.04)
        start = text.index('*STEP')
        text = (text[:start] + '*STEP\n*STATIC\n1, 1\n' + GRAVITY + '*END STEP\n' + text[start:])
        u = frames(run_deck(text), 'U')
        checks.at_least(np.abs(u[-1]).max(), 1e-3, f'CPE{mesh.nodes} hangs')
        checks.at_most(np.abs(u[2:] - u[-1]).max(), 1e-12, f'CPE{mesh.nodes} hangs on')


def main():
    checks = Checks()
    check_fall(checks)
    check_rest(checks)
    checks.finish()


main()
