"""An elastic bar hits a wall (Doyen, Ern and Piperno 2011): input/bar and its solution."""
import re

import h5py
import numpy as np

from carom_case import INPUT, Checks, run_deck, whole

FOLDER = INPUT / 'bar'
COURANT = 0.1/30
FORCE, BEGIN, DURATION = 300.0, 0.5, 2/3
IMPULSE = FORCE*DURATION
MOMENTUM = 10*10.0



class Bar:
    """The figures of one run."""

    def __init__(self, deck, courant, **definitions):
        self.run = run_deck(deck, dt=courant*COURANT, **definitions)
        self.time = self.run['history/time']
        self.force = self.run['history/contact_END-WALL/CF1']
        self.gap = self.run['history/contact_END-WALL/CDIS']
        self.impulse = self.run['history/contact_END-WALL/impulse'].sum()
        total = self.run['energy/total']
        self.energy = total[-1]/total[0]
        self.most_energy = total.max()/total[0]
        middle = (self.time > BEGIN + 0.1*DURATION) & (self.time < BEGIN + 0.9*DURATION)
        self.plateau = self.force[middle].mean()
        self.deviation = self.force[middle].std()
        touching = self.time[self.force > 0]
        self.last = touching[-1] if touching.size else 0.0
        self.impacts = len(self.run.events('impact')['time'])
        self.releases = len(self.run.events('release')['time'])
        self.captures = len(self.run.events('capture')['time'])

    def line(self):
        return (f'plateau {self.plateau:.3f} deviation {self.deviation:.3f} '
                f'energy {self.energy:.5f} impulse {self.impulse:.3f} '
                f'last contact {self.last:.4f} events '
                f'{self.impacts} {self.captures} {self.releases}')

    def log(self):
        return self.run.path.with_suffix('.log').read_text()


def momentum(bar):
    """Sum of nodal mass times velocity at the first and the last frame."""
    with h5py.File(bar.run.path) as file:
        v = whole(file, 'VTKHDF/PointData/V')[:, 0].reshape(-1, 101)
    mass = np.full(101, 0.1)
    mass[[0, -1]] = 0.05
    return v[[0, -1]] @ mass


def check_sustained(checks, name, bar):
    """One impact, one release, no node through the wall, impulse and momentum in balance."""
    checks.true((bar.impacts, bar.captures, bar.releases) == (1, 1, 1),
                f'{name}: one impact, one capture, one release: '
                f'{bar.impacts} {bar.captures} {bar.releases}')
    checks.at_least(bar.gap.min(), -1e-12, f'{name}: smallest gap')
    before, after = momentum(bar)
    checks.close(after - before, bar.impulse, 1e-9, f'{name}: momentum gained is the impulse')
    checks.close(bar.last, BEGIN + DURATION, 0.02, f'{name}: last contact at {bar.last:.4f}')


def check_implicit(checks):
    bar = Bar(FOLDER/'bar_implicit.inp', 1)
    print(f'        implicit, Courant 1: {bar.line()}')
    checks.close(bar.plateau, FORCE, 1e-3*FORCE, 'implicit: plateau is 300 within 0.1 %')
    checks.at_most(bar.deviation, 1, 'implicit: standard deviation on the plateau')
    checks.close(bar.energy, 0.9950, 5e-4, 'implicit: energy after, less the stopped node')
    checks.close(bar.energy, 1 - 0.5*0.05*100/500, 1e-6,
                 'implicit: the loss is the kinetic energy of the stopped node')
    checks.at_most(np.abs(bar.run['energy/balance_error']).max(), 1e-9*500,
                   'implicit: energy balance error')
    check_sustained(checks, 'implicit', bar)


def check_fictitious(checks):
    bar = Bar(FOLDER/'bar_fictitious.inp', 1)
    print(f'        fictitious, Courant 1: {bar.line()}')
    checks.close(bar.impulse, IMPULSE, 0.01*IMPULSE, 'fictitious force: impulse within 1 % of 200')
    before, after = momentum(bar)
    checks.close(after - before, bar.impulse, 1e-9,
                 'fictitious force: momentum gained is the impulse')


def motion(bar, times):
    """Displacements of three nodes at given times (all times are steps of the run)."""
    rows = np.rint(times/(bar.time[1] - bar.time[0])).astype(int)
    return np.array([bar.run[f'history/node_{n}/U1'][rows] for n in (1, 51, 101)])


def check_schemes(checks):
    """Implicit, explicit and half-and-half go together as the step shrinks."""
    runs = {}
    for scheme in ('implicit', 'explicit', 'mixed'):
        for courant in (0.5, 0.25, 0.125):
            runs[scheme, courant] = Bar(FOLDER/f'bar_{scheme}.inp', courant)
            print(f'        {scheme}, Courant {courant}: {runs[scheme, courant].line()}')
    for scheme in ('explicit', 'mixed'):
        for courant, bound in ((0.5, 1.0), (0.25, 0.5)):
            bar = runs[scheme, courant]
            name = f'{scheme} at Courant {courant}'
            checks.close(bar.plateau, FORCE, 1e-3*FORCE, f'{name}: plateau within 0.1 % of 300')
            checks.at_most(bar.deviation, bound, f'{name}: standard deviation on the plateau')
            checks.close(bar.energy, 0.9950, 1e-3, f'{name}: energy after')
            check_sustained(checks, name, bar)
        # in flight the difference of the two schemes is of second order; the first reflection
        # has sharp fronts, for which only the mean square shrinks, at a rate between 1 and 2
        times = np.arange(60, 84)*COURANT*2.5
        errors = [np.sqrt(np.mean((motion(runs[scheme, c], times)
                                   - motion(runs['implicit', c], times))**2))
                  for c in (0.5, 0.25, 0.125)]
        rates = np.log2(np.array(errors[:-1])/errors[1:])
        print(f'        {scheme} less implicit, root mean square: {errors}, rates {rates}')
        checks.at_least(rates.min(), 1.7, f'{scheme}: rate at which it nears the implicit run')


def with_impact(card):
    """The implicit deck with another *IMPACT card."""
    text = (FOLDER/'bar_implicit.inp').read_text().replace('INPUT=', f'INPUT={FOLDER}/')
    return re.sub(r'\*IMPACT.*', card, text)


def check_nodal_restitution(checks):
    """e = 1 on the end node: one small impact after another, and no energy lost."""
    bar = Bar(with_impact('*IMPACT, RESTITUTION=1, BETA=1/4'), 1)
    print(f'        e = 1, beta 1/4, Courant 1: {bar.line()}')
    checks.at_least(bar.impacts, 50, 'e = 1: impacts of the end node')
    checks.close(bar.run['energy/total']/500, np.ones(len(bar.time)), 1e-10,
                 'e = 1, beta 1/4: energy is kept')
    checks.at_least(bar.gap.min(), -1e-12, 'e = 1: smallest gap')
    before, after = momentum(bar)
    checks.close(after - before, bar.impulse, 1e-9, 'e = 1: momentum gained is the impulse')


def check_automatic_beta(checks):
    """BETA=AUTO: as in the steps without impacts; log and events say it, the energy is kept."""
    for courant in (1, 0.2):
        bar = Bar(with_impact('*IMPACT, RESTITUTION=1, BETA=AUTO'), courant)
        said = [line for line in bar.log().splitlines() if 'beta of the impact step' in line]
        checks.true(len(said) == 1 and '0.25 (that of the step)' in said[0],
                    f'BETA=AUTO at Courant {courant}: the log says "{"".join(said).strip()}"')
        checks.close(bar.run.events()['beta'], np.full(bar.impacts, 1/4), 1e-15,
                     f'BETA=AUTO at Courant {courant}: beta of the events')
        checks.at_most(bar.most_energy, 1 + 1e-10, f'BETA=AUTO at Courant {courant}: largest energy')


def check_warning(checks):
    """A step near the critical one of explicit elements is warned of."""
    for courant, warned in ((0.9, False), (1.0, True)):
        text = Bar(FOLDER/'bar_explicit.inp', courant).log()
        checks.true(('critical' in ''.join(line for line in text.splitlines()
                                           if line.startswith(('warning', 'note')))) == warned,
                    f'explicit at Courant {courant}: ' + ('warned' if warned else 'not warned')
                    + ' of the critical step')


def main():
    checks = Checks()
    check_implicit(checks)
    check_fictitious(checks)
    check_schemes(checks)
    check_nodal_restitution(checks)
    check_automatic_beta(checks)
    check_warning(checks)
    for scheme in ('explicit', 'mixed'):
        for courant in (0.9, 0.95, 0.99, 1.0):
            print(f'        for the record: {scheme}, Courant {courant}: '
                  f"{Bar(FOLDER/f'bar_{scheme}.inp', courant).line()}")
    checks.finish()


if __name__ == '__main__':
    main()
