"""ORDER=4: steps of fourth order between impacts, to them and from them, and in sustained contact.

Against exact solutions: the oscillator and the two masses of input/, a damped oscillator, and a
damped, loaded row of masses whose last one hits a wall, stays there and lets go. Energies balance
to round-off whatever the step is.
"""
import numpy as np

from carom_case import INPUT, Checks, run_deck
from exact_solutions import bouncing_ball, oscillator, two_dof

STEPS = (0.08, 0.04, 0.02, 0.01)
ORDER_4 = ('DIRECT', 'DIRECT, ORDER=4')


def fourth_order(path):
    """A deck of input/ with ORDER=4 (which has no beta)."""
    return path.read_text().replace(*ORDER_4).replace(', BETA=1/6', '')


def order(steps, errors):
    """Exponent of the step in the error, fitted through all of them."""
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


def largest(difference):
    """Largest absolute value."""
    return float(np.max(np.abs(difference)))


def balance(run):
    """Largest balance error, as a part of the largest energy, loss or work."""
    names = ('total', 'external_work', 'damping', 'impact_loss')
    return largest(run['energy/balance_error']) / max(largest(run[f'energy/{name}'])
                                                      for name in names)


# --- cases with exact solutions ---------------------------------------------------------------

def check_oscillator(checks):
    text = fourth_order(INPUT / 'sdof' / 'sdof.inp')
    steps = (*STEPS, 0.005)
    for e, n_impacts in ((1.0, 5), (0.6, 4)):
        exact = oscillator(20.0, restitution=e)
        errors = []
        for h in steps:
            run = run_deck(text, e=e, dt=h, end=20.0)
            errors.append(largest(run['history/node_1/U1'] - exact.at(run['history/time'])[0]))
            events = run.events()
            checks.close(len(events['time']), n_impacts, 0, f'e = {e}, h = {h}: impacts')
            # the period comes out longer by (omega h)^4 / 720
            late = largest(events['time'] - exact.impact_times)
            checks.at_most(late, 1.1 * 20.0 * h**4 / 720.0, f'e = {e}, h = {h}: impact times')
            checks.at_most(balance(run), 2e-14, f'e = {e}, h = {h}: energy balance')
            total = run['energy/total'] + run['energy/impact_loss']
            checks.at_most(largest(total - total[0]), 1e-14, f'e = {e}, h = {h}: energy')
        checks.at_least(order(steps, errors), 3.95,
                        f'e = {e}: order of the error, {errors[0]:.3g} to {errors[-1]:.3g}')
        checks.at_most(errors[-1], 1e-10, f'e = {e}, h = {steps[-1]}: error')


def check_damped(checks):
    """m = 2, k = 5, c = 0.3, d0 = 0.7, v0 = 0.3, wall at -0.4, e = 0.8."""
    text = row_of_masses(m=[2.0], k=[5.0], c=[0.3], wall=0.6, restitution=0.8, end=9.6,
                         d0=[0.7], v0=[0.3])
    exact = Row([2.0], [5.0], [0.3], [0.0], 0.4, 0.8)
    errors = []
    for h in STEPS:
        run = run_deck(text, dt=h)
        errors.append(largest(run['history/node_1/U1']
                              - exact.motion([0.7], [0.3], run['history/time'])[:, 0]))
        checks.at_most(balance(run), 2e-14, f'damped oscillator, h = {h}: energy balance')
    for h, error, limit in zip(STEPS, errors, (9.0e-7, 5.7e-8, 3.6e-9, 2.3e-10)):
        checks.at_most(error, limit, f'damped oscillator, h = {h}: error')
    checks.at_least(order(STEPS, errors), 3.95, 'damped oscillator: order of the error')


def check_two_dof(checks):
    text = fourth_order(INPUT / 'two_dof' / 'two_dof.inp')
    exact = two_dof(30.0)
    errors = []
    for h in STEPS:
        run = run_deck(text, dt=h, end=30.0)
        d = exact.at(run['history/time'])[0]
        errors.append(max(largest(run[f'history/node_{i + 1}/U1'] - d[i]) for i in (0, 1)))
        checks.at_most(balance(run), 1e-13, f'two masses, h = {h}: energy balance')
    checks.at_least(order(STEPS, errors), 3.9,
                    f'two masses: order of the error, {errors[0]:.3g} to {errors[-1]:.3g}')


# --- a row of masses that is caught by a wall, pressed on it and lets go ---------------------

class Row:
    """M u'' + C u' + K u = f in a row of masses; the last one keeps u >= -gap, impacts with e or,
    for e = 0, sustained contact. Exact by eigenvectors; events by bisection to round-off."""

    def __init__(self, m, k, c, f, gap, restitution):
        self.m, self.gap, self.e = np.array(m), gap, restitution
        self.k, self.c = chain(k), chain(c)
        self.f = np.array(f)

    def _mode(self, touching):
        n = len(self.m) - touching
        load = self.f[:n].copy()
        if touching:  # the last mass stays at -gap
            load += self.k[:n, n] * self.gap
        rest = np.linalg.solve(self.k[:n, :n], load)
        rows = -np.hstack([self.k[:n, :n], self.c[:n, :n]]) / self.m[:n, None]
        values, vectors = np.linalg.eig(
            np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), rows]))
        return n, rest, values, vectors

    def _flow(self, touching, d, v):
        """Displacements and velocities as functions of the time since d, v."""
        n, rest, values, vectors = self._mode(touching)
        share = np.linalg.solve(vectors, np.concatenate([d[:n] - rest, v[:n]]).astype(complex))

        def at(s):
            s = np.atleast_1d(s)
            y = (vectors @ (share[:, None] * np.exp(np.outer(values, s)))).real.T
            u, w = y[:, :n] + rest, y[:, n:]
            if touching:
                u = np.hstack([u, np.full((len(s), 1), -self.gap)])
                w = np.hstack([w, np.zeros((len(s), 1))])
            return u, w
        return at

    def force(self, u, w):
        """Contact force that holds the last mass."""
        return u @ self.k[-1] + w @ self.c[-1] - self.f[-1]

    def motion(self, d0, v0, times):
        """Displacements at the times; `events` lists impacts and releases."""
        out, self.events, self.forces = np.empty((len(times), len(d0))), [], np.zeros(len(times))
        start, d, v, touching = 0.0, np.array(d0), np.array(v0), False
        while True:
            at = self._flow(touching, d, v)

            def distance(s, at=at, touching=touching):
                u, w = at(s)
                return self.force(u, w) if touching else u[:, -1] + self.gap
            s = np.linspace(1e-4, times[-1] - start + 1e-3, 200001)
            g = distance(s)
            crossing = np.flatnonzero((g[:-1] > 0.0) & (g[1:] <= 0.0))
            wait = np.inf
            if len(crossing):
                low, high = s[crossing[0]], s[crossing[0] + 1]
                while high - low > 2e-16 * max(1.0, high):
                    middle = (low + high) / 2.0
                    if middle in (low, high):
                        break
                    low, high = (middle, high) if distance(middle)[0] > 0.0 else (low, middle)
                wait = (low + high) / 2.0
            inside = (times >= start) & (times <= start + wait)
            u, w = at(times[inside] - start)
            out[inside] = u
            self.forces[inside] = self.force(u, w) if touching else 0.0
            if start + wait > times[-1]:
                return out
            start += wait
            self.events.append(start)
            (d,), (v,) = at(wait)
            if touching:
                touching = False
            else:
                d[-1], v[-1] = -self.gap, -self.e * v[-1]
                touching = not self.e > 0.0 and self.force(d, v) > 0.0


def chain(values):
    """Matrix of springs (or dashpots) in a row, the first one to the ground."""
    n = len(values)
    matrix = np.diag(np.array(values, dtype=float))
    for i in range(n - 1):
        matrix[i, i] += values[i + 1]
        matrix[i, i + 1] = matrix[i + 1, i] = -values[i + 1]
    return matrix


def row_of_masses(m, k, c, wall, end, d0, v0, restitution=None, cards='', head='', more='ORDER=4'):
    """A deck with masses at x = 1, 2, ..., the wall behind the last of them; `cards` in the step."""
    n = len(m)
    lines = ['*PARAMETER', 'dt = 0.04', '*NODE']
    lines += [f'{i + 1}, {i + 1}, 0' for i in range(n)]
    for i in range(n):
        one = '1' if i == 0 else '2'
        nodes = '1' if i == 0 else f'{i}, {i + 1}'
        way = '1' if i == 0 else '1, 1'
        lines += [f'*ELEMENT, TYPE=MASS, ELSET=m{i + 1}', f'{i + 1}, {i + 1}',
                  f'*MASS, ELSET=m{i + 1}', repr(m[i]),
                  f'*ELEMENT, TYPE=SPRING{one}, ELSET=k{i + 1}', f'{101 + i}, {nodes}',
                  f'*SPRING, ELSET=k{i + 1}', way, repr(k[i]),
                  f'*ELEMENT, TYPE=DASHPOT{one}, ELSET=c{i + 1}', f'{201 + i}, {nodes}',
                  f'*DASHPOT, ELSET=c{i + 1}', way, repr(c[i])]
    impact = '*IMPACT' if restitution is None else f'*IMPACT, RESTITUTION={restitution}'
    lines += ['*SURFACE, NAME=body, TYPE=NODE', str(n), '*RIGID SURFACE, NAME=wall, TYPE=PLANE',
              f'{wall}, 0, 0', '1, 0, 0', '*SURFACE INTERACTION, NAME=hit', impact,
              '*CONTACT PAIR, INTERACTION=hit', 'body, wall', head,
              '*INITIAL CONDITIONS, TYPE=DISPLACEMENT']
    lines += [f'{i + 1}, 1, {d0[i]!r}' for i in range(n)]
    lines += ['*INITIAL CONDITIONS, TYPE=VELOCITY']
    lines += [f'{i + 1}, 1, {v0[i]!r}' for i in range(n)]
    lines += ['*STEP', f'*DYNAMIC, DIRECT{", " + more if more else ""}', f'<dt>, {end}', cards,
              '*NODE PRINT', 'U, V, A, RF', '*CONTACT PRINT', 'CF, CDIS', '*ENERGY PRINT',
              '*END STEP']
    return '\n'.join(line for line in lines if line) + '\n'


def check_caught(checks):
    """Three masses with dashpots under a constant load that presses them towards the wall."""
    m, k, c, f = [1.0, 1.5, 0.8], [2.0, 9.0, 14.0], [0.05, 0.1, 0.2], [0.0, 0.0, -0.9]
    d0, v0, gap = [0.3, 0.9, 1.4], [0.0, -0.4, 0.2], 0.35
    text = row_of_masses(m, k, c, 3.0 - gap, 8.0, d0, v0, cards='*CLOAD\n3, 1, -0.9')
    exact = Row(m, k, c, f, gap, 0.0)
    errors, late, forces = [], [], []
    for h in STEPS:
        run = run_deck(text, dt=h)
        u = exact.motion(d0, v0, run['history/time'])
        errors.append(max(largest(run[f'history/node_{i + 1}/U1'] - u[:, i]) for i in range(3)))
        times = np.unique(run['events/time'])  # caught and let go at once is one
        checks.close(len(times), len(exact.events), 0, f'caught row, h = {h}: impacts and releases')
        late.append(largest(times - exact.events))
        forces.append(largest(run['history/contact_BODY-WALL/CF1'] - exact.forces))
        checks.at_most(balance(run), 1e-13, f'caught row, h = {h}: energy balance')
        checks.at_least(np.min(run['history/node_3/U1']), -gap - 1e-13, f'caught row, h = {h}: wall')
    checks.at_least(len(exact.events), 4, 'caught row: events in all')
    for name, values, least in (('displacement', errors, 3.9), ('event times', late, 3.8),
                                ('contact force', forces, 3.8)):
        checks.at_least(order(STEPS, values), least, f'caught row: order of the error of '
                        f'{name}, {values[0]:.3g} to {values[-1]:.3g}')


# --- loads, prescribed motion: against a fine run ---------------------------------------------

AMPLITUDES = '''*AMPLITUDE, NAME=push
0, 0, 0.7, 1, 1.9, -0.6, 3.1, 0.2
*AMPLITUDE, NAME=ground, TIME=TOTAL TIME
0, 0, 0.5, 1.2, 1.1, -1, 2.3, 0.4
3.7, 0
'''
DRIVEN = {
    'loads and base motion': '*CLOAD, AMPLITUDE=push\n2, 1, 1.7\n*BASE MOTION, DOF=1, '
                             'AMPLITUDE=ground\n*CLOAD\n3, 1, -0.3',
    'prescribed displacement': '*BOUNDARY, AMPLITUDE=push\n1, 1, 1, 0.4',
    'prescribed velocity': '*BOUNDARY, TYPE=VELOCITY, AMPLITUDE=push\n1, 1, 1, 0.8',
    'prescribed acceleration': '*BOUNDARY, TYPE=ACCELERATION, AMPLITUDE=ground\n1, 1, 1, -1.1',
}


def check_driven(checks):
    """Corners of amplitudes stand inside increments: none of these steps hits them all."""
    m, k, c = [1.0, 1.5, 0.8], [2.0, 9.0, 14.0], [0.05, 0.1, 0.2]
    steps = (0.08, 0.04, 0.02)
    for name, cards in DRIVEN.items():
        d0 = [0.0 if 'prescribed' in name else 0.1, 0.2, 0.4]
        settings = {'head': AMPLITUDES, 'cards': cards, 'restitution': 0.7}
        text = row_of_masses(m, k, c, 2.8, 4.0, d0, [0.0, 0.3, -0.5], **settings)
        fine = run_deck(text, dt=0.0025)
        reference = [fine[f'history/node_{i}/U1'] for i in (1, 2, 3)]
        checks.at_least(len(fine.events()['time']), 1, f'{name}: impacts')
        errors = []
        for h in steps:
            run = run_deck(text, dt=h)
            every = round(h / 0.0025)
            errors.append(max(largest(run[f'history/node_{i + 1}/U1'] - reference[i][::every])
                              for i in range(3)))
            checks.at_most(balance(run), 1e-12, f'{name}, h = {h}: energy balance')
        checks.at_least(order(steps, errors), 3.8,
                        f'{name}: order of the error, {errors[0]:.3g} to {errors[-1]:.3g}')
        second = run_deck(text.replace(', ORDER=4', ''), dt=0.0025)
        gap = largest(second['history/node_3/U1'] - reference[2])
        checks.at_most(gap, 1e-4, f'{name}: distance from ORDER=2 at step 0.0025')


# --- what else a deck may have ----------------------------------------------------------------

TIED = '''*PARAMETER
dt = 0.04
*NODE
1, 0, 0
2, 1, 0
3, 2, 0
4, 3, 0
5, 5, 0
6, 6, 0
*ELEMENT, TYPE=T2D2, ELSET=bar
1, 1, 2
2, 2, 3
3, 3, 4
4, 5, 6
*ELEMENT, TYPE=MASS, ELSET=extra
5, 4
*MASS, ELSET=extra
0.4
*MATERIAL, NAME=m
*ELASTIC
6
*DENSITY
0.7
*DAMPING, ALPHA=0.05, BETA=0.02
*SOLID SECTION, ELSET=bar, MATERIAL=m
1
*EQUATION
2
5, 1, 1, 4, 1, -2
*BOUNDARY
1, 1, 2
2, 2
3, 2
4, 2
5, 2
6, 2
*SURFACE, NAME=body, TYPE=NODE
6
*RIGID SURFACE, NAME=wall, TYPE=PLANE
6.3, 0, 0
-1, 0, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, RESTITUTION=0.5
*CONTACT PAIR, INTERACTION=hit
body, wall
*AMPLITUDE, NAME=rise
0, 0, 0.33, 1, 1.37, -1, 2, 0.5
*STEP
*STATIC
1, 1
*CLOAD
4, 1, -1.2
*NODE PRINT
U, RF
*ENERGY PRINT
*END STEP
*STEP
*DYNAMIC, DIRECT, ORDER=4
<dt>, 2
*CLOAD, OP=NEW
3, 1, 0.2
*CONTACT PRINT
CF, CDIS
*END STEP
*STEP
*DYNAMIC, DIRECT, ORDER=4
<dt>, 2
*CLOAD, OP=NEW, AMPLITUDE=rise
4, 1, 1.5
*BOUNDARY, AMPLITUDE=rise
1, 1, 1, 0.3
*END STEP
'''


def check_tied(checks):
    """Consistent mass, Rayleigh damping, a linear constraint, a static step before two dynamic ones,
    bounces that die out at a wall (e = 0.5), a support that moves."""
    steps = (0.08, 0.04, 0.02)
    names = [f'history/node_{i}/{of}' for i, of in ((1, 'U1'), (4, 'U1'), (6, 'U1'), (1, 'RF1'))]
    fine = run_deck(TIED, dt=0.00125)
    errors = []
    for h in steps:
        run = run_deck(TIED, dt=h)
        same = np.searchsorted(fine['history/time'], run['history/time'] - 1e-9)
        errors.append([largest(run[name] - fine[name][same]) for name in names])
        checks.at_most(balance(run), 1e-13, f'tied bars, h = {h}: energy balance')
    checks.at_least(np.sum(fine['events/kind'] == b'capture'), 1, 'tied bars: captures')
    for name, column in zip(names[1:], np.array(errors).T[1:]):
        checks.at_least(order(steps, column), 3.5,
                        f'tied bars, {name}: order of the error, {column[0]:.3g} to {column[-1]:.3g}')


# --- many freedoms ----------------------------------------------------------------------------

def check_bar(checks):
    text = (INPUT / 'bar' / 'bar_implicit.inp').read_text()
    for part in ('bar_model.inc', 'bar_step.inc', 'bar_mesh.inc'):
        text = text.replace(f'*INCLUDE, INPUT={part}', (INPUT / 'bar' / part).read_text())
    text = text.replace(*ORDER_4).replace(', BETA=1/4', '')
    for courant in (1.0, 4.0):
        run = run_deck(text, dt=courant / 300.0)
        total = run['energy/total']
        checks.close(total[-1] / total[0], 0.995, 1e-10, f'bar, Courant {courant}: energy left')
        checks.at_most(balance(run), 1e-13, f'bar, Courant {courant}: energy balance')
        checks.close([len(run.events(kind)['time']) for kind in ('impact', 'release')], [1, 1], 0,
                     f'bar, Courant {courant}: impacts and releases')
        if courant < 2.0:
            t, force = run['history/time'], run['history/contact_END-WALL/CF1']
            plateau = force[(t > 0.5 + 0.0667) & (t < 0.5 + 0.6)]
            checks.close(np.mean(plateau), 300.0, 0.3, 'bar: contact force')
            checks.at_most(np.std(plateau), 1.5, 'bar: scatter of the contact force')
    bouncing = text.replace('METHOD=TRANSFORMATION', 'RESTITUTION=1')
    for courant in (0.5, 4.0):
        run = run_deck(bouncing, dt=courant / 300.0)
        checks.at_least(len(run.events()['time']), 2, f'bar, e = 1, Courant {courant}: impacts')
        total = run['energy/total']
        checks.at_most(largest(total / total[0] - 1.0), 1e-12,
                       f'bar, e = 1, Courant {courant}: energy')


# --- where impacts are hard to find -----------------------------------------------------------

def check_graze(checks):
    """The oscillator swings by 1 towards a wall at -(1 - depth). The last two depths cannot be told
    from none: hit or not, eight impacts at 1.4e-6 change the phase by no more than 2.3e-5."""
    text = fourth_order(INPUT / 'sdof' / 'sdof.inp')
    for depth, n_impacts in ((1e-4, 3), (1e-6, 3), (-1e-4, 0), (-1e-6, 0)):
        steps = (0.15, 0.075, 0.0375)
        exact = oscillator(20.0, wall=-(1.0 - depth))
        errors = []
        for h in steps:
            run = run_deck(text.replace('-0.5, 0, 0', f'{-(1.0 - depth)!r}, 0, 0'), dt=h, end=20.0,
                           e=1.0)
            checks.close(len(run.events()['time']), n_impacts, 0, f'graze {depth}, h = {h}: impacts')
            errors.append(largest(run['history/node_1/U1'] - exact.at(run['history/time'])[0]))
            checks.at_most(balance(run), 2e-14, f'graze {depth}, h = {h}: energy balance')
        checks.at_least(order(steps, errors), 3.8,
                        f'graze {depth}: order of the error, {errors[0]:.3g} to {errors[-1]:.3g}')
    for depth in (1e-12, -1e-12):
        run = run_deck(text.replace('-0.5, 0, 0', f'{-(1.0 - depth)!r}, 0, 0'), dt=0.05, end=50.0)
        checks.close(run['history/node_1/U1'], np.cos(run['history/time']), 2.4e-5,
                     f'graze {depth}: displacement')


def check_instants(checks):
    """A free mass hits at the end of an increment, at its start, and several times in one."""
    free = '''*NODE
1, 1, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*MASS, ELSET=mass
2
*SURFACE, NAME=body, TYPE=NODE
1
*RIGID SURFACE, NAME=left, TYPE=PLANE
0, 0, 0
1, 0, 0
*RIGID SURFACE, NAME=right, TYPE=PLANE
1.25, 0, 0
-1, 0, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, RESTITUTION=1
*CONTACT PAIR, INTERACTION=hit
body, left
body, right
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, <v>
*STEP
*DYNAMIC, DIRECT, ORDER=4
<dt>, <end>
*NODE PRINT
U, V
*ENERGY PRINT
*END STEP
'''
    for v, dt, end, n in ((-1, 0.25, 3, 2), (1, 0.25, 2.5, 2), (-7, 0.5, 4, 22), (-1, 1, 3, 2)):
        run = run_deck(
            '*PARAMETER\nv = 0\ndt = 1\nend = 1\n' + free, v=v, dt=dt, end=end)
        path = 1.0 + v * run['history/time']  # unfolded between walls 1.25 apart
        folded = np.abs((path + 1.25) % 2.5 - 1.25)
        checks.close(1.0 + run['history/node_1/U1'], folded, 1e-12, f'v = {v}, dt = {dt}: position')
        checks.close(len(run.events()['time']), n, 0, f'v = {v}, dt = {dt}: impacts')
    text = free.replace('1, 1, 0\n', '1, 0, 0\n', 1)
    run = run_deck('*PARAMETER\nv = -1\ndt = 0.1\nend = 1\n' + text)
    checks.close(run['history/node_1/U1'], run['history/time'], 1e-14, 'impact at t = 0')


def check_ball(checks):
    """A ball comes to rest after bounces without end, by CAPTURE or by MAX EVENTS, and stays."""
    text = fourth_order(INPUT / 'ball' / 'ball.inp')
    rest = np.sqrt(0.2) * 3.0  # e = 0.5, g = 10, height 1: (1 + e)/(1 - e) of the first fall
    for name, other in (('default', text), ('MAX EVENTS', text.replace(
            'RESTITUTION=<e>', 'RESTITUTION=<e>, CAPTURE=0, MAX EVENTS=6'))):
        run = run_deck(other)
        t, y = run['history/time'], 1.0 + run['history/node_1/U2']
        checks.close(y, bouncing_ball(t, 1.0, 10.0, 0.5)[0], 1e-5 if name == 'default' else 2e-4,
                     f'ball, {name}: height')
        still = t > rest + 0.02
        checks.at_most(largest(y[still]), 1e-12, f'ball, {name}: at rest')
        checks.close(run['history/contact_BODY-FLOOR/CF2'][still], np.full(np.sum(still), 20.0),
                     1e-10, f'ball, {name}: weight')
        checks.at_most(balance(run), 1e-14, f'ball, {name}: energy balance')


# --- what it costs ----------------------------------------------------------------------------

def check_cost(checks):
    """Solves at an error of 1e-8; a complex solve counts as four. Second order: extrapolated by
    its order from the last of three steps."""
    exact = oscillator(20.0)
    figures = {}
    text = (INPUT / 'sdof' / 'sdof.inp').read_text()
    for name, deck, steps in (('second', text.replace('BETA=1/6', 'BETA=1/4'), (8e-3, 4e-3, 2e-3)),
                              ('fourth', fourth_order(INPUT / 'sdof' / 'sdof.inp'),
                               (0.08, 0.04, 0.025))):
        errors, solves = [], []
        for h in steps:
            run = run_deck(deck, dt=h, end=20.0)
            errors.append(largest(run['history/node_1/U1'] - exact.at(run['history/time'])[0]))
            solves.append(float(run['cost/solves'][0]))
        figures[name] = solves[-1] * (errors[-1] / 1e-8)**(1.0 / order(steps, errors))
    ratio = figures['second'] / figures['fourth']
    checks.at_least(ratio, 30.0, f'error 1e-8: {figures["second"]:.0f} solves of second order over '
                    f'{figures["fourth"]:.0f} of fourth')


CHECKS = Checks()
for check in (check_oscillator, check_damped, check_two_dof, check_caught, check_driven, check_tied,
              check_bar, check_graze, check_instants, check_ball, check_cost):
    check(CHECKS)
CHECKS.finish()
