"""An elastic strip against a wall (Doyen, Ern and Piperno 2011): input/elastic_strip."""
import numpy as np

from carom_case import Checks
from contact_case import Folder

COURANT = 0.1 / 30
FORCE, BEGIN, DURATION = 300.0, 0.5, 2 / 3
ENERGY = 500.0
folder = Folder('elastic_strip', 'make_strip')


class Strip:
    """The figures of one run."""

    def __init__(self, deck, courant=1.0, **definitions):
        self.contact = contact = folder.run(deck, dt=courant * COURANT, **definitions)
        time, force = contact.time, contact.force[:, 0]
        middle = (time > BEGIN + 0.1 * DURATION) & (time < BEGIN + 0.9 * DURATION)
        self.plateau = force[middle].mean()
        self.deviation = force[middle].std() / FORCE
        self.impulse = contact.impulse.sum() / (FORCE * DURATION)
        self.left = contact.energy[-1] / ENERGY
        self.most = contact.energy.max() / ENERGY
        self.impacts, self.releases = (contact.moments(kind) for kind in ('impact', 'release'))
        self.last = contact.last()

    def line(self, name):
        print(f'        {name}: plateau {self.plateau:.4f}, deviation {self.deviation:.3%}, impulse '
              f'{self.impulse - 1:+.3%}, energy {self.left:.6f}, last contact {self.last:.4f}, '
              f'impacts {len(self.impacts)}, releases {len(self.releases)}, smallest gap '
              f'{self.contact.gap.min():.2g}')


def stopped(nodes, divisions=100):
    """The part of the mass that the end nodes have: lumped, 4 nodes; 8 nodes, by the diagonal of the
    consistent mass 3 : 16 : 3 along an edge of an element of 76."""
    return 0.5 / divisions if nodes == 4 else (22 / 76) / (divisions / 2)


def check_sustained(checks):
    """One impact, a flat force, one release."""
    for nodes, deviation, impulse in ((4, 5e-3, 1e-2), (8, 2e-2, 1.5e-2)):
        for nu in (0, 0.3):
            name = f'Q{nodes}, nu = {nu}'
            strip = Strip(f'q{nodes}.inp', nu=nu)
            strip.line(name)
            checks.close(strip.plateau, FORCE, 3e-3 * FORCE, f'{name}: mean of the plateau')
            checks.true(len(strip.impacts) == 1, f'{name}: one instant of impact')
            touched = strip.contact.size > 0
            spells = np.count_nonzero(np.diff(touched.astype(int)) == 1)
            checks.true(spells == 1, f'{name}: contact is lost once and for good')
            checks.close(strip.left, 1 - stopped(nodes), 2e-4,
                         f'{name}: energy lost is that of the stopped nodes')
            checks.at_least(strip.contact.gap.min(), -1e-8, f'{name}: smallest gap')
            checks.at_most(strip.contact.balance / ENERGY, 1e-9, f'{name}: balance of energy')
            if nu == 0:
                checks.at_most(strip.deviation, deviation, f'{name}: deviation on the plateau')
                checks.close(strip.impulse, 1.0, impulse, f'{name}: impulse')
                checks.close(strip.last, BEGIN + DURATION, 0.02, f'{name}: last contact')


def check_large_steps(checks):
    """At four Courant steps the energy never rises: the release is located."""
    for nodes in (4, 8):
        for nu in (0, 0.3):
            strip = Strip(f'q{nodes}.inp', 4.0, nu=nu)
            strip.line(f'Q{nodes}, nu = {nu}, Courant 4')
            checks.at_most(strip.most, 1 + 1e-9, f'Q{nodes}, nu = {nu}, Courant 4: largest energy')
            checks.true(len(strip.impacts) == 1, f'Q{nodes}, nu = {nu}, Courant 4: one impact')


def check_massless(checks):
    """Contact nodes without mass: nothing is stopped, the force is smooth."""
    for nodes, deviation, group in ((4, 1e-3, True), (8, 3e-2, True), (8, 1.5e-2, False)):
        name = f'Q{nodes}, {"lumped" if group else "consistent"}, no mass at the contact'
        text = (folder.path / f'q{nodes}_massless.inp').read_text()
        strip = Strip(text if group else text.replace(folder.make.LUMPED, ''))
        strip.line(name)
        checks.close(strip.plateau, FORCE, 3e-3 * FORCE, f'{name}: mean of the plateau')
        checks.at_most(strip.deviation, deviation, f'{name}: deviation on the plateau')
        checks.close(strip.left, 1.0, 1e-3, f'{name}: energy is kept')
        checks.close(strip.impulse, 1.0, 1.5e-2, f'{name}: impulse')


def check_fictitious(checks):
    """The pure iteration of the fictitious force."""
    strip = Strip('q4_fictitious.inp')
    strip.line('Q4, fictitious force')
    checks.close(strip.impulse, 1.0, 1.2e-2, 'fictitious force: impulse')
    checks.at_most(strip.deviation, 7e-2, 'fictitious force: deviation on the plateau')


checks = Checks()
folder.check(checks)
check_sustained(checks)
check_large_steps(checks)
check_massless(checks)
check_fictitious(checks)
checks.finish()
