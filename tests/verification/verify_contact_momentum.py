"""Two bodies keep their momentum: every method, every pairing of meshes, with friction and without."""
import itertools

import numpy as np

from carom_case import Checks
from contact_case import Folder

folder = Folder('two_bars', 'make_bars')
make = folder.make
METHODS = {
    'transformation': '*IMPACT',
    'transformation, e = 0.5': '*IMPACT, RESTITUTION=0.5',
    'fictitious force': '*IMPACT, METHOD=FICTITIOUS FORCE, RETURN=0.3',
    'penalty': '*IMPACT, METHOD=PENALTY, STIFFNESS=1e4',
    'Lagrange': '*IMPACT, METHOD=LAGRANGE',
}
MESHES = {   # (length, along, across, nodes, more height on both sides), the left bar and the right one
    '4 on 4': ((3.0, 12, 4, 4), (4.0, 16, 6, 4, 0.25)),
    '4 on 4, nonmatching': ((3.0, 12, 4, 4), (4.0, 12, 5, 4, 0.25)),
    '8 on 8': ((3.0, 12, 4, 8), (4.0, 16, 6, 8, 0.25)),
    '8 on 8, nonmatching': ((3.0, 12, 4, 8), (4.0, 16, 4, 8, 0.25)),
    '8 on 4': ((3.0, 12, 4, 8), (4.0, 16, 6, 4, 0.25)),
    '4 on 8': ((3.0, 12, 3, 4), (4.0, 16, 6, 8, 0.25)),
}
PAIRS = {'node rows': '', 'two passes': ', PASSES=2', 'weighted rows': make.SURFACES,
         'no mass at the contact': ', MASS=REDISTRIBUTED',
         'weighted rows, no mass at the contact': make.SURFACES + ', MASS=REDISTRIBUTED'}


def run(method, mesh, pair, friction):
    """Bars that meet a little askew: one flies across as well."""
    deck = make.deck('momentum', make.mesh(*mesh), (5, -5), pair, method,
                     '*FRICTION\n0.3\n' if friction else '')
    deck = deck.replace('left, 1, 5\n', 'left, 1, 5\nleft, 2, 0.5\n')
    return folder.run(deck, dt=0.25 / 30, end=0.4, nu=0.3)


def check_slipping_off(checks):
    """The upper node of the left bar slides off the end of the right one."""
    deck = make.deck('off', make.mesh((3.0, 12, 4, 4), (4.0, 16, 4, 4)), (5, -5))
    contact = folder.run(deck.replace('left, 1, 5\n', 'left, 1, 5\nleft, 2, 0.5\n'),
                         dt=0.25 / 30, end=0.4, nu=0.3)
    total, _, _, size = contact.momentum()
    checks.at_most(np.abs(total - total[0]).max() / size, 1e-11, 'slipping off: drift of momentum')


def check_driven(checks, method, pair):
    """A bar hits one that is moved, all of it, at a given speed: what moves it does the work of the
    impulses, those of friction included."""
    deck = make.deck('driven', make.mesh((3.0, 12, 4, 4), (4.0, 16, 5, 4, 0.25)), (5, -5), pair,
                     METHODS[method], '*FRICTION\n0.3\n')
    deck = deck.replace('right, 1, -5\n', 'right, 1, -5\nright, 2, 0.5\n')
    deck = deck.replace('<dt>, <end>\n', '<dt>, <end>\n*BOUNDARY, TYPE=VELOCITY\n'
                        'right, 1, 1, -5\nright, 2, 2, 0.5\n')
    contact = folder.run(deck, dt=0.25 / 30, end=0.15, nu=0.3)
    name = f'{method}, {pair}: a driven bar'
    checks.at_least(np.abs(contact.impulse).sum(), 1.0, f'{name} is hit')
    checks.at_most(contact.balance / contact.energy[0], 1e-9, f'{name}, energy balance')


def check(checks, method, mesh, pair, friction):
    name = f'{method}, {mesh}, {pair}' + (', friction' if friction else '')
    contact = run(METHODS[method], MESHES[mesh], PAIRS[pair], friction)
    # the masses of the mesh, or those written where contact nodes have none
    total, reference, _, size = contact.momentum(None if 'no mass' in pair else 1.0)
    touched = np.abs(contact.impulse).sum() / size
    drift = np.abs(total - total[0]).max() / size
    print(f'        {name}: impulse {touched:.4f} of the momentum, energy '
          f'{contact.energy[-1] / contact.energy[0]:.5f}, smallest gap {contact.gap.min():.2g}, '
          f'angular momentum drifts by {np.abs(reference - reference[0]).max() / size:.2g}')
    checks.at_least(touched, 0.1, f'{name}: they hit')
    checks.at_most(drift, 1e-11, f'{name}: drift of momentum')


checks = Checks()
check_slipping_off(checks)
for method in ('transformation', 'transformation, e = 0.5', 'Lagrange'):
    check_driven(checks, method, PAIRS['node rows'])
for method, mesh in itertools.product(METHODS, MESHES):
    for friction in (False, True):
        check(checks, method, mesh, 'node rows', friction)
for pair, mesh in itertools.product(list(PAIRS)[1:], ('4 on 4, nonmatching', '8 on 8, nonmatching')):
    for method in ('transformation', 'fictitious force'):
        check(checks, method, mesh, pair, False)
checks.finish()
