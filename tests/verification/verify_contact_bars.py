"""Two bars that hit head-on, as strips of 4- and 8-node elements: input/two_bars."""
import numpy as np

from carom_case import Checks
from contact_case import Folder
from contact_solutions import bars_head_on

folder = Folder('two_bars', 'make_bars')
GAP, CLOSING = folder.make.GAP, 10.0
BEGIN = GAP / CLOSING


class Bars:
    """The figures of one run."""

    def __init__(self, contact):
        self.contact = contact
        force = np.abs(contact.force[:, 0])
        self.force = force
        half = contact.time[force > 75.0]
        self.duration = half[-1] - half[0]
        middle = (contact.time > BEGIN + 0.1 * self.duration) \
            & (contact.time < BEGIN + 0.9 * self.duration)
        self.plateau, self.deviation = force[middle].mean(), force[middle].std() / 150.0
        mass = contact.masses()
        left = contact.run['VTKHDF/Points'][:, 0] < -1e-9
        v = contact.frames('V')[-1, :, 0]
        self.speeds = [mass[part] @ v[part] / mass[part].sum() for part in (left, ~left)]
        total, _, _, size = contact.momentum()
        self.drift = np.abs(total - total[0]).max() / size

    def line(self, name):
        c = self.contact
        print(f'        {name}: plateau {self.plateau:.4f}, deviation {self.deviation:.3%}, contact '
              f'for {self.duration:.4f}, speeds after {self.speeds[0]:.4f} {self.speeds[1]:.4f}, '
              f'energy {c.energy[-1] / c.energy[0]:.6f}, impacts {len(c.moments("impact"))}, '
              f'smallest gap {c.gap.min():.2g}, drift of momentum {self.drift:.2g}')


def check_equal(checks):
    """As if each bar hit a rigid wall with half the closing speed."""
    force, duration, *after = bars_head_on(10, 10, 5, -5)
    bars = Bars(folder.run('equal.inp'))
    bars.line('equal bars')
    checks.close(bars.plateau, force, 3e-3 * force, 'equal bars: mean of the plateau')
    checks.at_most(bars.deviation, 5e-3, 'equal bars: deviation on the plateau')
    checks.close(bars.duration, duration, 0.02 * duration, 'equal bars: duration of the contact')
    checks.close(bars.speeds, after, 0.02 * 5, 'equal bars: velocities after')
    checks.at_most(bars.drift, 1e-11, 'equal bars: drift of momentum')
    checks.true(len(bars.contact.moments('impact')) == 1, 'equal bars: one instant of impact')
    checks.close(bars.contact.energy[-1] / 250, 1 - 0.005, 2e-4,
                 'equal bars: energy lost is that of the stopped nodes')
    checks.at_least(bars.contact.gap.min(), -1e-8, 'equal bars: smallest gap')


def check_short_on_long(checks):
    """The short bar stops, the long one leaves at half the speed."""
    for name, bars in (
            ('short on long', Bars(folder.run('short_on_long.inp'))),
            ('short on long, no mass at the contact', Bars(folder.run(
                folder.make.deck('bars', '*INCLUDE, INPUT=short_on_long.inc\n', (10, 0),
                                 folder.make.SURFACES + ', MASS=REDISTRIBUTED'))))):
        force, duration, *after = bars_head_on(5, 10, 10, 0)
        bars.line(name)
        checks.close(bars.plateau, force, 3e-3 * force, f'{name}: mean of the plateau')
        checks.close(bars.duration, duration, 2 * 0.1 / 30,
                     f'{name}: the contact ends, to half its force, within two transit times')
        checks.close(bars.speeds[0], after[0], 0.02 * 10, f'{name}: the short bar stops')
        checks.close(bars.speeds[1], after[1], 0.02 * 5, f'{name}: half the speed of the long bar')
        most = bars.contact.energy.max() / bars.contact.energy[0]
        massless = 'no mass' in name
        total, _, _, size = bars.contact.momentum(None if massless else 1.0)
        checks.at_most(most, 1 + (1e-3 if massless else 1e-9), f'{name}: largest energy')
        checks.at_most(np.abs(total - total[0]).max() / size, 1e-11, f'{name}: drift of momentum')


checks = Checks()
folder.check(checks)
check_equal(checks)
check_short_on_long(checks)
checks.finish()
