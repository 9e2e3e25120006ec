"""The penalty method and Lagrange multipliers: oscillator, bar, two bodies, friction."""
import re

import numpy as np

from carom_case import INPUT, Checks, run_deck
from solid_mesh import Mesh, integrate

SDOF = (INPUT / 'sdof' / 'sdof.inp').read_text()
BAR = INPUT / 'bar'
COURANT = 0.1 / 30
IMPEDANCE, SPEED = 30.0, 10.0   # of the bar: force by velocity


def with_method(text, method):
    return re.sub(r'\*IMPACT.*', f'*IMPACT, METHOD={method}', text)


class PenalisedOscillator:
    """m = k = 1 from d = 1 at rest, with a spring kappa beyond -0.5: harmonic pieces, exactly."""

    def __init__(self, kappa):
        self.omega = np.sqrt(1 + kappa)
        self.centre = -0.5 * kappa / (1 + kappa)
        self.entry = 2 * np.pi / 3
        self.rate = np.sqrt(0.75)
        # from -0.5 with this speed inwards until it is back there
        self.depth = -0.5 - self.centre
        self.stay = 2 * np.arctan2(self.rate / self.omega, -self.depth) / self.omega
        self.period = 2 * self.entry + self.stay

    def at(self, t):
        """Displacements; the motion is even about the middle of every contact and flight."""
        s = np.mod(t, self.period)
        s = np.where(s > self.period / 2, self.period - s, s)
        inside = self.omega * (s - self.entry)
        return np.where(s < self.entry, np.cos(s), self.centre + self.depth * np.cos(inside)
                        - self.rate / self.omega * np.sin(inside))


def check_oscillator(checks):
    for kappa, largest in ((10.0, 0.02), (1000.0, 0.002)):
        steps = largest / 2.0 ** np.arange(5)
        exact = PenalisedOscillator(kappa)
        for scheme, line in (('trapezoidal rule', ''), ('central differences', ', EXPLICIT')):
            errors = []
            for h in steps:
                text = with_method(SDOF, f'PENALTY, STIFFNESS={kappa}')
                run = run_deck(text.replace('DYNAMIC, DIRECT', 'DYNAMIC, DIRECT' + line),
                               dt=float(h), end=12.0)
                errors.append(np.abs(run['history/node_1/U1'] - exact.at(run['history/time'])).max())
            name = f'oscillator, spring {kappa:g}, {scheme}'
            # where in a step the spring comes and goes is chance
            checks.at_most((errors / (kappa * steps**2 / 2)).max(), 1, f'{name}: errors '
                           + ' '.join(f'{e:.2g}' for e in errors) + ' over k h^2/2')
            contacts = run.events('contact')['time']
            expected = exact.entry + exact.period * np.arange(len(contacts))
            checks.close(contacts, expected, 2 * steps[-1], f'{name}: {len(contacts)} contacts begin')
            if not line:
                total = run['energy/total']
                checks.at_most(np.abs(total / total[0] - 1).max(), 2e-5, f'{name}: energy')
                checks.at_most(np.abs(run['energy/balance_error']).max(), 1e-12,
                               f'{name}: balance error')
        if kappa == 1000.0:
            run = run_deck(with_method(SDOF, 'PENALTY, STIFFNESS=1e9').replace(
                'DYNAMIC, DIRECT', 'DYNAMIC, DIRECT, EXPLICIT'), dt=0.01, end=12.0,
                expect_status=4)
            checks.true('the contact spring of node 1 is too stiff' in run.text,
                        'a spring that an explicit step cannot follow is an error')


class Bar:
    """The elastic bar of input/bar with a method: force, energy, events."""

    def __init__(self, method, deck='implicit', courant=1.0, alpha=0.0, damping=0.0):
        text = with_method((BAR / f'bar_{deck}.inp').read_text(), method)
        if damping:
            model = (BAR / 'bar_model.inc').read_text().replace(
                '*DENSITY\n1\n', f'*DENSITY\n1\n*DAMPING, BETA={damping!r}\n')
            text = text.replace('*INCLUDE, INPUT=bar_model.inc\n', model)
        text = text.replace('INPUT=', f'INPUT={BAR}/')
        if alpha:
            text = text.replace('*DYNAMIC, DIRECT', f'*DYNAMIC, DIRECT, ALPHA={alpha}')
        run = run_deck(text, dt=courant * COURANT)
        self.run, self.name = run, f'bar, {method}, {deck}, Courant {courant:g}, alpha {alpha:g}'
        self.time = run['history/time']
        self.force = run['history/contact_END-WALL/CF1']
        self.gap = run['history/contact_END-WALL/CDIS']
        middle = (self.time > 0.5 + 0.2 / 3) & (self.time < 0.5 + 1.8 / 3)
        self.mean, self.deviation = self.force[middle].mean(), self.force[middle].std()
        total = run['energy/total']
        self.energy, self.most = total[-1] / total[0], total.max() / total[0]
        mass = np.full(101, 0.1)
        mass[[0, -1]] = 0.05
        v = run['VTKHDF/PointData/V'][:, 0].reshape(-1, 101)
        self.gained = (v[-1] - v[0]) @ mass
        self.impulse = run['history/contact_END-WALL/impulse'].sum()

    def events(self):
        return [len(self.run.events(kind)['time']) for kind in ('impact', 'contact', 'release')]

    def line(self):
        return (f'        {self.name}: mean {self.mean:.2f} deviation {self.deviation:.2f} '
                f'energy {self.energy:.4f} most {self.most:.4f} impulse {self.impulse:.2f} '
                f'overlap {-min(self.gap.min(), 0):.3g} events {self.events()}')


def check_penalty_bar(checks):
    """A soft spring is followed exactly, a stiff one only with numerical damping."""
    bar = Bar('PENALTY, STIFFNESS=1000')
    print(bar.line())
    during = (bar.time > 0.5) & (bar.time < 0.5 + 2 / 3 - 0.02)
    exact = IMPEDANCE * SPEED * (1 - np.exp(-1000 / IMPEDANCE * (bar.time[during] - 0.5)))
    checks.at_most(np.abs(bar.force[during] - exact).max(), 0.02 * 300,
                   f'{bar.name}: force against 300 (1 - exp(-k t/30))')
    checks.close(bar.energy, 1, 1e-4, f'{bar.name}: energy kept')
    checks.close(bar.events(), [0, 1, 1], 0, f'{bar.name}: one contact')
    checks.close(bar.impulse, 200, 0.005 * 200, f'{bar.name}: impulse')
    for stiffness in ('1e4', '1e5', '1e6'):
        bar = Bar(f'PENALTY, STIFFNESS={stiffness}')
        print(bar.line())
        checks.close(bar.energy + bar.run['energy/impact_loss'][-1] / 500, 1, 1e-10,
                     f'{bar.name}: what energy is gained, the ledger has as a negative loss')
        checks.close(bar.gained, bar.impulse, 1e-9, f'{bar.name}: momentum gained is the impulse')
        # at 1e5 round-off decides how much: 1.2 to 2
        if stiffness == '1e6':
            checks.at_least(bar.energy, 5, f'{bar.name}: a stiff spring pumps energy in')
        bar = Bar(f'PENALTY, STIFFNESS={stiffness}', alpha=-0.3)
        print(bar.line())
        checks.close(bar.mean, 300, 0.3, f'{bar.name}: plateau')
        checks.at_most(bar.deviation, 0.5, f'{bar.name}: deviation')
        checks.at_most(bar.most, 1 + 1e-9, f'{bar.name}: energy never gained')
        checks.at_least(bar.energy, 0.98, f'{bar.name}: energy kept')
        checks.close(bar.gained, bar.impulse, 1e-9, f'{bar.name}: momentum gained is the impulse')
    for deck in ('explicit', 'mixed'):
        bar = Bar('PENALTY, STIFFNESS=1000', deck, 0.5)
        print(bar.line())
        checks.close(bar.mean, 300, 3, f'{bar.name}: plateau')
        checks.close(bar.energy, 1, 1e-3, f'{bar.name}: energy')
        checks.close(bar.events(), [0, 1, 1], 0, f'{bar.name}: one contact')


def check_lagrange_bar(checks):
    for deck, courant, alpha in (('implicit', 0.25, 0), ('implicit', 1, 0), ('implicit', 4, 0),
                                 ('implicit', 1, -0.3), ('explicit', 0.45, 0),
                                 ('explicit', 0.5, 0), ('mixed', 0.5, 0)):
        bar = Bar('LAGRANGE', deck, courant, alpha)
        print(bar.line())
        checks.close(bar.mean, 300, 0.3, f'{bar.name}: plateau within 0.1 %')
        checks.at_most(bar.deviation, 3 if courant > 1 else 1, f'{bar.name}: deviation')
        checks.at_most(bar.most, 1 + 1e-6, f'{bar.name}: energy never gained')
        if courant <= 1 and not alpha:
            checks.close(bar.energy, 0.995, 1e-3, f'{bar.name}: energy after')
        checks.close(bar.gained, bar.impulse, 1e-9, f'{bar.name}: momentum gained is the impulse')
        checks.close(bar.events(), [1, 0, 1], 0, f'{bar.name}: one impact, one release')
        checks.at_least(bar.gap.min(), -1e-12, f'{bar.name}: smallest gap')
    for courant in (4, 10):
        bar = Bar('LAGRANGE', 'implicit', courant, damping=courant * COURANT)
        print(bar.line())
        name = f'{bar.name}, stiffness damping of one step'
        checks.at_most(bar.most, 1 + 1e-9, f'{name}: energy never gained')
        checks.at_most(bar.force.max(), 1500, f'{name}: largest force')
        checks.at_least(bar.force.min(), 0, f'{name}: smallest force')
        checks.at_most(np.abs(bar.run['energy/balance_error']).max(), 1e-9 * 500,
                       f'{name}: balance error')


HEADON = """*MATERIAL, NAME=stuff
*ELASTIC
900, 0.3
*DENSITY
1
*SOLID SECTION, ELSET=left, MATERIAL=stuff
*SOLID SECTION, ELSET=right, MATERIAL=stuff
*ELEMENT GROUP, ELSET=left, SCHEME=IMPLICIT, MASS={mass}
*ELEMENT GROUP, ELSET=right, SCHEME=IMPLICIT, MASS={mass}
*SURFACE, NAME=one
left, S2
*SURFACE, NAME=other
right, S4
*SURFACE INTERACTION, NAME=hit
*IMPACT, METHOD={method}
*FRICTION
{friction}
*CONTACT PAIR, INTERACTION=hit{pair}
face_one, face_other
*INITIAL CONDITIONS, TYPE=VELOCITY
left, 1, 1
right, 1, -0.6
right, 2, 0.1
*STEP
*DYNAMIC, DIRECT
2e-3, 0.3
*NODE FILE
U, V
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
"""


def two_bars(nodes, counts, method, friction, pair):
    """Blocks of 2 by 0.25 and 0.5 a gap of 0.05 apart, with weights of their nodes for momentum."""
    meshes = [Mesh(8, counts[0], nodes, lambda s, t: (2 * s - 2.05, 0.1 + 0.25 * t)),
              Mesh(8, counts[1], nodes, lambda s, t: (2 * s, 0.5 * t))]
    first = len(meshes[0].x) + 1
    later = len(meshes[0].elements) + 1
    text = meshes[0].text(f'CPS{nodes}', 'left') + meshes[1].text(f'CPS{nodes}', 'right', first,
                                                                  later)
    sets = [('at_one', [8 * (j + 1) for j in range(counts[0])]),
            ('at_other', [later + 8 * j for j in range(counts[1])])]
    for name, members in sets:
        text += f'*ELSET, ELSET={name}\n' + ''.join(f'{e}\n' for e in members)
    for name, offset in (('left', 1), ('right', first)):
        mesh = meshes[name == 'right']
        text += f'*NSET, NSET={name}\n' + ''.join(f'{offset + i}\n' for i in range(len(mesh.x)))
    deck = HEADON.replace('*SURFACE, NAME=one\nleft, S2', '*SURFACE, NAME=face_one\nat_one, S2') \
        .replace('*SURFACE, NAME=other\nright, S4', '*SURFACE, NAME=face_other\nat_other, S4')
    text += deck.format(mass='LUMPED' if nodes == 4 else 'CONSISTENT', method=method,
                        friction=friction, pair=pair)
    weights = []
    for mesh in meshes:
        weight = np.zeros(len(mesh.x))

        def add(ring, values, slopes, place, area, weight=weight):
            weight[ring] += values * area

        integrate(mesh, add)
        weights.append(weight)
    return text, np.concatenate(weights)


def check_momentum(checks):
    for method in ('LAGRANGE', 'PENALTY, STIFFNESS=150'):
        for nodes in (4, 8):
            for counts in ((2, 2), (2, 3)):
                for friction, pair in ((0, ''), (0.3, ''), (0.3, ', TYPE=SURFACE TO SURFACE')):
                    text, mass = two_bars(nodes, counts, method, friction, pair)
                    run = run_deck(text)
                    v = run['VTKHDF/PointData/V'].reshape(-1, len(mass), 3)
                    momentum = np.einsum('tnc,n->tc', v, mass)
                    size = np.abs(v[0]).max() * mass.sum()
                    name = f'two bars, {method}, {nodes} nodes, {counts}, mu {friction}{pair}'
                    checks.at_most(np.abs(momentum - momentum[0]).max() / size, 1e-11,
                                   f'{name}: linear momentum')
                    kinds = [len(run.events(kind)['time']) for kind in ('impact', 'contact')]
                    checks.at_least(sum(kinds), 3, f'{name}: nodes that met')
                    total = run['energy/total']
                    error = np.abs(run['energy/balance_error']).max() / total[0]
                    gap = run['history/contact_FACE_ONE-FACE_OTHER/CDIS'].min()
                    print(f'        {name}: energy {total[-1] / total[0]:.5f} most '
                          f'{total.max() / total[0]:.5f} balance error {error:.2g} gap {gap:.2g}')
                    checks.at_most(total.max() / total[0], 1 + 1e-3, f'{name}: energy')
                    if method == 'LAGRANGE':
                        checks.at_least(gap, -1e-12, f'{name}: smallest gap')
                        # rows are followed along the turning faces, small displacements apart
                        checks.at_most(error, 1e-4, f'{name}: balance error')
                    else:
                        checks.at_most(error, 1e-11, f'{name}: balance error')


BLOCK = """*NODE, NSET=all
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
*ELEMENT, TYPE=CPS4, ELSET=block
1, 1, 2, 3, 4
*ELEMENT, TYPE=SPRING1, ELSET=hold
2, 1
3, 2
*SPRING, ELSET=hold
2
1e-3
*MATERIAL, NAME=stuff
*ELASTIC
10000, 0
*DENSITY
1
*SOLID SECTION, ELSET=block, MATERIAL=stuff
*ELEMENT GROUP, ELSET=block, SCHEME=IMPLICIT, MASS=LUMPED
*SURFACE, NAME=base
block, S1
*RIGID SURFACE, NAME=plane, TYPE=PLANE
0, 0, 0
0, 1, 0
*SURFACE INTERACTION, NAME=rough
*IMPACT, METHOD=METHOD_
*FRICTION
0.3
*CONTACT PAIR, INTERACTION=rough
base, plane
*STEP
*STATIC, DIRECT
1, 1
*BOUNDARY
all, 1, 1
*DLOAD
block, GRAV, 10, 0, -1, 0
*NODE PRINT
U, V
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
*STEP
*DYNAMIC, DIRECT
1e-3, 1.5
*BOUNDARY, OP=NEW
1, 3
*INITIAL CONDITIONS, TYPE=VELOCITY
all, 1, 3
*END STEP
"""


def check_friction(checks):
    """A block of one element slides from speed 3 to rest on mu = 0.3, g = 10: 1.5 in time 1."""
    for method, near in (('LAGRANGE', 5e-4), ('PENALTY, STIFFNESS=1e4', 2e-3)):
        run = run_deck(BLOCK.replace('METHOD_', method))
        u, v = (np.array([run[f'history/node_{i}/{name}1'] for i in range(1, 5)]).mean(axis=0)
                for name in 'UV')
        time = run['history/time'] - 1
        checks.close(u[-1], 1.5, near * 1.5, f'block, {method}: way')
        sliding = (time > 0) & (time < 0.95)
        checks.close(v[sliding], 3 - 3 * time[sliding], 0.02, f'block, {method}: speed')
        checks.at_most(np.abs(v[time > 1.2]).max(), 0.02, f'block, {method}: speed after')
        checks.close(run['energy/friction'][-1], 4.5, 0.002 * 4.5, f'block, {method}: friction work')
        checks.at_most(np.abs(run['energy/balance_error']).max(), 1e-10 * 4.5,
                       f'block, {method}: balance error')
        force = run['history/contact_BASE-PLANE/CF2'][time > 0]
        checks.close(force.mean(), 10, 0.01, f'block, {method}: weight')


def main():
    checks = Checks()
    check_oscillator(checks)
    check_penalty_bar(checks)
    check_lagrange_bar(checks)
    check_momentum(checks)
    check_friction(checks)
    checks.finish()


if __name__ == '__main__':
    main()
