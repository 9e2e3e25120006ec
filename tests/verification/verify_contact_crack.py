"""A plate with a slanted crack whose faces slap: input/crack."""
import numpy as np

from carom_case import Checks, run_deck
from contact_case import Folder

folder = Folder('crack', 'make_plate')
make = folder.make
CARD = '*INCLUDE, INPUT=plate.inc\n'


def line(name, contact, scale):
    print(f'        {name}: largest force {contact.size.max():.5f}, impulse {contact.impulse.sum():.5f}, '
          f'smallest gap {contact.gap.min():.3g}, impacts {len(contact.moments("impact"))}, most a '
          f'step {contact.most_moments()}, balance {contact.balance / scale:.3g}')


def openings(contact):
    """Normal distance of the faces at the middle of the crack (frames), upward."""
    u = contact.frames('U')[..., :2]
    row = (make.ACROSS // 2) * (make.ALONG + 1)
    inner = np.arange(row + make.FIRST + 1, row + make.LAST)
    second = len(u[0]) - len(inner) + np.arange(len(inner))
    angle = np.radians(30.0)
    normal = np.array([-np.sin(angle), np.cos(angle)])
    return (u[:, second] - u[:, inner]) @ normal


def check_slap(checks):
    """The faces open, slap, and never overlap; where they are open there is no traction."""
    contact = folder.run('slap.inp')
    scale = contact.energy.max()
    line('slap', contact, scale)
    gap = openings(contact)
    print(f'        opening from {gap.min():.3g} to {gap.max():.3g}')
    checks.at_least(contact.gap.min(), -1e-8, 'slap: smallest gap')
    checks.at_most(contact.balance / scale, 1e-6, 'slap: balance of energy')
    checks.at_least(gap.max(), 1e-2, 'slap: the crack opens')
    checks.at_least(len(contact.moments('impact')), 1, 'slap: its faces hit')
    state, force = contact.frames('CSTATE'), contact.frames('CF')
    distance = contact.frames('CDIS')
    open_nodes = (np.rint(state) == 1) & (distance > 1e-9)
    checks.true(open_nodes.any(), 'slap: some nodes are open in some frames')
    checks.close(np.abs(force[open_nodes]).max(initial=0.0), 0.0, 0.0, 'slap: no traction where open')
    return contact


def check_fictitious(checks, reference):
    """Three return parameters, one picture."""
    seen = {}
    for alpha in (0.1, 0.3, 0.9):
        contact = folder.run('slap_fictitious.inp', **{'return': alpha})
        line(f'return {alpha}', contact, contact.energy.max())
        seen[alpha] = openings(contact)
        exact = openings(reference)
        far = np.abs(seen[alpha] - exact).max() / exact.max()
        print(f'        return {alpha}: opening differs by {far:.3%} from the transformation')
        checks.at_most(far, 0.1, f'return {alpha}: opening is that of the transformation')
        checks.at_most(contact.balance / contact.energy.max(), 1e-6,
                       f'return {alpha}: balance of energy')


def check_intact(checks):
    """Pressed faces that stick make the plate as good as new."""
    press = ''.join(f'{t / 16:.6g}, {-np.sin(2 * np.pi * t / 16) + 0.0:.12g}\n' for t in range(8)) \
        + '0.5, 0\n'
    run = {}
    for cracked in (True, False):
        deck = make.deck('pressed', CARD if cracked else make.mesh(cracked=False), pulse=press,
                         friction='*FRICTION\n1000\n', cracked=cracked)
        deck = deck if cracked else deck.replace('*CONTACT PRINT\nCF, CDIS\n', '').replace(
            '*CONTACT FILE, FREQUENCY=4\nCF, CDIS\n', '')
        if cracked:
            run[cracked] = folder.run(deck, end=0.6).frames('U')
        else:
            result = run_deck(deck, end=0.6)
            n = len(result['VTKHDF/Points'])
            run[cracked] = result['VTKHDF/PointData/U'].reshape(-1, n, 3)
    n = run[False].shape[1]
    difference = np.abs(run[True][:, :n] - run[False]).max(axis=(1, 2)) / np.abs(run[False]).max()
    print('        pressed and stuck less intact:', f'{difference.max():.2g}')
    checks.at_most(difference.max(), 1e-12, 'pressed faces that stick: as the plate without a crack')


checks = Checks()
folder.check(checks)
reference = check_slap(checks)
check_fictitious(checks, reference)
check_intact(checks)
checks.finish()
