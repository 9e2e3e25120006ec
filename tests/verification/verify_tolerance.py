"""TOLERANCE of *DYNAMIC: what is asked of the error of a whole step is delivered within a factor of 5.

Error: largest distance from the exact displacement over all increments and freedoms, over the largest
displacement. Every case is run at tolerances a decade apart; the table in the end has what was asked,
delivered and estimated, and what it took.
"""
import re

import numpy as np

from carom_case import INPUT, Checks, run_deck
from exact_solutions import bouncing_ball, oscillator, two_dof

DECADES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
FACTOR = 5.0
OSCILLATOR = """*PARAMETER
c = 0
*NODE
1, 0, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*ELEMENT, TYPE=SPRING1, ELSET=spring
2, 1
*ELEMENT, TYPE=DASHPOT1, ELSET=dashpot
3, 1
*MASS, ELSET=mass
1
*SPRING, ELSET=spring
1
4
*DASHPOT, ELSET=dashpot
1
<c>
"""
PULLED = '*INITIAL CONDITIONS, TYPE=DISPLACEMENT\n1, 1, 1\n'
OMEGA = 2.0


def automatic(deck, tolerance):
    """The deck of fixed increments with a TOLERANCE in their place."""
    asked = f', TOLERANCE={tolerance!r}' if tolerance else ''
    return re.sub(r'\*DYNAMIC, DIRECT', f'*DYNAMIC{asked}', deck)


def step(tolerance, times, loads=''):
    """A dynamic step with automatic increments."""
    return f'*STEP\n*DYNAMIC, TOLERANCE={tolerance!r}\n{times}\n{loads}*NODE PRINT\nU\n*END STEP\n'


def log_of(run):
    return run.path.with_suffix('.log').read_text()


def said(run):
    """The estimate, the increments and the cost that the log states, one of each a run."""
    text = log_of(run)
    estimates = [float(x) for x in re.findall(r'estimated error (\S+) of the largest', text)]
    counts = [int(x) for x in re.findall(r'(\d+) automatic increment', text)]
    factors, solves = (run[f'cost/{name}'][0] for name in ('factorizations', 'solves'))
    return estimates, counts, int(factors), int(solves), 'warning: step' in text


def motion(run, nodes, dof=1):
    return np.array([run[f'history/node_{i}/U{dof}'] for i in nodes])


class Table:
    """One line a run; printed in the end."""

    def __init__(self, checks):
        self.checks, self.lines = checks, []

    def add(self, name, asked, run, d, exact, above=True):
        """Checks one run; `above` says that it must not be far more accurate than asked."""
        delivered = np.max(np.abs(d - exact)) / np.max(np.abs(exact))
        estimates, counts, factors, solves, warned = said(run)
        self.lines.append(f'{name:34} {asked:7.0e} {delivered:9.2e} {estimates[0]:9.2e} '
                          f'{counts[0]:7d} {solves:8d} {factors:6d}')
        self.checks.at_most(delivered / asked, FACTOR, f'{name}, {asked:g}: delivered of asked')
        self.checks.true(not warned or estimates[0] > asked, f'{name}, {asked:g}: no idle warning')
        if above:
            self.checks.at_least(delivered / asked, 1 / FACTOR, f'{name}, {asked:g}: not wasted')
            self.checks.at_least(estimates[0] / delivered, 1 / 2.5, f'{name}, {asked:g}: estimate')
            self.checks.at_most(estimates[0] / delivered, 2.5, f'{name}, {asked:g}: estimate')
        return counts[0]

    def growth(self, name, counts, decades):
        """A decade of accuracy costs about sqrt(10) times the increments."""
        power = np.polyfit(np.log(decades), np.log(counts), 1)[0]
        self.checks.close(power, -0.5, 0.08, f'{name}: power of TOLERANCE in the increments')

    def show(self):
        print(f'{"case":34} {"asked":>7} {"delivered":>9} {"estimate":>9} {"incr.":>7} '
              f'{"solves":>8} {"factor.":>6}')
        print('\n'.join(self.lines))


def check_walls(table):
    deck = (INPUT / 'sdof' / 'sdof.inp').read_text()
    for e, beta in ((1.0, '1/6'), (1.0, 'AUTO'), (0.6, '1/6'), (0.3, 'AUTO'), (0.0, '1/4')):
        exact, counts, name = oscillator(20.0, restitution=e), [], f'oscillator, wall, e = {e:g}, {beta}'
        for asked in DECADES:
            run = run_deck(automatic(deck, asked).replace('BETA=1/6', f'BETA={beta}'), e=e)
            counts.append(table.add(name, asked, run, motion(run, [1])[0],
                                    exact.at(run['history/time'])[0]))
        table.growth(name, counts, DECADES)
    deck = (INPUT / 'two_dof' / 'two_dof.inp').read_text()
    for e in (1.0, 0.7):
        exact, counts, name = two_dof(30.0, restitution=e), [], f'two masses, wall, e = {e:g}'
        for asked in DECADES:
            run = run_deck(automatic(deck, asked), e=e)
            counts.append(table.add(name, asked, run, motion(run, [1, 2]),
                                    exact.at(run['history/time'])[0]))
        table.growth(name, counts, DECADES)


def decay(t, c):
    """Free motion of the oscillator from 1 at rest, m = 1, damping c."""
    rate, omega = c / 2, np.sqrt(OMEGA**2 - c**2 / 4)
    return np.exp(-rate * t) * (np.cos(omega * t) + rate / omega * np.sin(omega * t))


def check_free(table):
    for c, first, end in ((0.0, 0.5, 10.0), (0.0, 1e-4, 40.0), (0.2, 0.1, 30.0), (2.0, 0.1, 10.0)):
        counts, name = [], f'free oscillator, c = {c:g}, to {end:g}'
        decades = DECADES[:4] if end > 30.0 else DECADES
        for asked in decades:
            run = run_deck(OSCILLATOR + PULLED + step(asked, f'{first!r}, {end!r}'), c=c)
            counts.append(table.add(name, asked, run, motion(run, [1])[0],
                                    decay(run['history/time'], c)))
        table.growth(name, counts, decades)


def under_load(times, points, values):
    """Undamped oscillator at rest, m = 1, under a force that is linear between points."""
    d, v, out = 0.0, 0.0, np.zeros_like(times)
    for i, start in enumerate(points):
        end = points[i + 1] if i + 1 < len(points) else max(times[-1], start) + 1.0
        slope = (values[i + 1] - values[i]) / (end - start) if i + 1 < len(points) else 0.0

        def at(s, d=d, v=v, p=values[i] / OMEGA**2, q=slope / OMEGA**2):
            c, sn = np.cos(OMEGA * s), np.sin(OMEGA * s)
            return (p + q * s + (d - p) * c + (v - q) / OMEGA * sn,
                    q - OMEGA * (d - p) * sn + (v - q) * c)

        here = (times >= start) & (times <= end)
        out[here] = at(times[here] - start)[0]
        d, v = at(end - start)
    return out


def check_loads(table):
    """A force put on at once, a ramp, and a pulse that begins long after the step."""
    for name, points, values in (('force at once', [0.0], [3.0]),
                                 ('ramp', [0.0, 2.5], [0.0, 3.0]),
                                 ('late pulse', [0.0, 8.0, 8.05, 8.1], [0.0, 0.0, 100.0, 0.0])):
        amplitude = '*AMPLITUDE, NAME=history\n' + ''.join(
            f'{t!r}, {a!r}\n' for t, a in zip(points, values))
        counts = []
        for asked in DECADES:
            run = run_deck(OSCILLATOR + amplitude + step(
                asked, '0.1, 20', '*CLOAD, AMPLITUDE=history\n1, 1, 1\n'))
            t = run['history/time']
            counts.append(table.add(name, asked, run, motion(run, [1])[0],
                                    under_load(t, points, values)))
        table.growth(name, counts, DECADES)


class Chain:
    """A bar of n truss elements with lumped mass that flies against a wall: sustained contact of its
    first node, exact in time by its modes, free and held."""

    LENGTH, MODULUS, GAP, SPEED = 10.0, 900.0, 5.0, 10.0

    def __init__(self, n, end):
        spring, mass = self.MODULUS * n / self.LENGTH, self.LENGTH / n
        self.k = spring * (2 * np.eye(n + 1) - np.eye(n + 1, k=1) - np.eye(n + 1, k=-1))
        self.k[0, 0] = self.k[n, n] = spring
        self.root = np.sqrt(mass * np.r_[0.5, np.ones(n - 1), 0.5])
        self.modes = {held: self.find_modes(held) for held in (False, True)}
        self.pieces, self.starts = [], []
        t, d, v, held = 0.0, np.zeros(n + 1), np.full(n + 1, -self.SPEED), False
        while t < end:
            self.starts.append(t)
            self.pieces.append(self.piece(d, v, held))
            wait = self.next_event(self.pieces[-1], held, end - t, 0.01 / np.sqrt(spring / mass))
            if wait is None:
                break
            t += wait
            d, v = (x[:, 0] for x in self.pieces[-1](np.array([wait])))
            held = not held
            if held:
                v[0] = 0.0

    def find_modes(self, held):
        root = self.root[held:]
        squares, modes = np.linalg.eigh(self.k[held:, held:] / np.outer(root, root))
        return np.sqrt(np.maximum(squares, 0.0)), modes

    def piece(self, d, v, held):
        """Motion from (d, v) on; a held end stays where it is, and d counts from there."""
        omega, modes = self.modes[held]
        root, base = self.root[held:], d[0] if held else 0.0
        a, b = modes.T @ (root * (d[held:] - base)), modes.T @ (root * v[held:])
        slow = omega < 1e-6 * omega.max()
        safe = np.where(slow, 1.0, omega)

        def at(s):
            c, sn = np.cos(np.outer(omega, s)), np.sin(np.outer(omega, s))
            reach = np.where(slow[:, None], s, sn / safe[:, None])
            x = np.full((len(self.root), len(s)), base)
            y = np.zeros_like(x)
            x[held:] += modes @ (a[:, None] * c + b[:, None] * reach) / root[:, None]
            y[held:] = modes @ (b[:, None] * c - (a * omega)[:, None] * sn) / root[:, None]
            return x, y

        return at

    def next_event(self, piece, held, end, step):
        """When the force on a held end vanishes, or a free end comes down to the wall."""
        def margin(s):
            d = piece(s)[0]
            return (self.k[0, :2] @ d[:2]) if held else d[0] + self.GAP

        grid = step * np.arange(1, int(end / step) + 2)
        through = np.flatnonzero(margin(grid) < 0.0)
        # a node let go has its gap open from zero: its first points are round-off
        through = through[grid[through] > 2 * step]
        if len(through) == 0:
            return None
        low, high = grid[through[0]] - step, grid[through[0]]
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (low, middle) if margin(np.array([middle]))[0] < 0.0 else (middle, high)
        return high

    def at(self, times):
        owner = np.searchsorted(self.starts, times, side='right') - 1
        out = np.zeros((len(self.root), len(times)))
        for i in np.unique(owner):
            out[:, owner == i] = self.pieces[i](times[owner == i] - self.starts[i])[0]
        return out


def chain_deck(n, asked, end):
    nodes = ''.join(f'{i + 1}, {Chain.LENGTH * i / n!r}, 0\n' for i in range(n + 1))
    bars = ''.join(f'{i + 1}, {i + 1}, {i + 2}\n' for i in range(n))
    return (f'*NODE, NSET=all\n{nodes}*ELEMENT, TYPE=T2D2, ELSET=bar\n{bars}'
            f'*ELEMENT GROUP, ELSET=bar, SCHEME=IMPLICIT, MASS=LUMPED\n'
            f'*BOUNDARY\nall, 2\n*MATERIAL, NAME=elastic\n*ELASTIC\n{Chain.MODULUS!r}\n*DENSITY\n1\n'
            '*SOLID SECTION, ELSET=bar, MATERIAL=elastic\n1\n*SURFACE, NAME=tip, TYPE=NODE\n1\n'
            f'*RIGID SURFACE, NAME=wall, TYPE=PLANE\n{-Chain.GAP!r}, 0, 0\n1, 0, 0\n'
            '*SURFACE INTERACTION, NAME=hit\n*IMPACT\n*CONTACT PAIR, INTERACTION=hit\ntip, wall\n'
            f'*INITIAL CONDITIONS, TYPE=VELOCITY\nall, 1, {-Chain.SPEED!r}\n'
            + step(asked, f'0.01, {end!r}'))


def check_bar(table):
    """The end node of a bar is stopped: a shock that every frequency of the mesh takes part in."""
    for n, end in ((10, 1.4), (40, 1.4)):
        exact, counts, name = Chain(n, end), [], f'bar of {n} elements'
        for asked in DECADES:
            run = run_deck(chain_deck(n, asked, end))
            counts.append(table.add(name, asked, run, motion(run, range(1, n + 2)),
                                    exact.at(run['history/time'])))
        # above, increments are too long for the highest frequencies, and errors fall more slowly
        table.growth(name, counts[2:], DECADES[2:])


def check_exact_flights(table):
    """Free flight between impacts is exact in increments of any size: none is made small for nothing."""
    for name, nodes in (('colliding_masses', 2), ('cradle', 4)):
        deck = (INPUT / name / f'{name}.inp').read_text()
        fixed = run_deck(deck)
        for asked in (1e-2, 1e-6):
            run = run_deck(automatic(deck, asked))
            d, exact = motion(run, range(1, nodes + 1))[:, -1], motion(fixed, range(1, nodes + 1))[:, -1]
            count = table.add(name, asked, run, d, exact, above=False)
            checks.at_most(count, 20, f'{name}, {asked:g}: increments')
            checks.at_most(np.max(np.abs(d - exact)), 1e-12, f'{name}, {asked:g}: exact')
    deck = (INPUT / 'ball' / 'ball.inp').read_text()
    for asked in (1e-2, 1e-4, 1e-6):
        run = run_deck(automatic(deck, asked))
        exact = bouncing_ball(run['history/time'], gravity=10.0, restitution=0.5)[0] - 1.0
        table.add('ball', asked, run, motion(run, [1], 2)[0], exact, above=False)


def check_other_methods(table):
    """Methods of first order: the order is found out, and the tolerance holds all the same."""
    deck = (INPUT / 'sdof' / 'sdof.inp').read_text()
    exact = oscillator(5.0)
    for method, more in (('FICTITIOUS FORCE', ', RESTITUTION=<e>'),):
        text = deck.replace('METHOD=TRANSFORMATION, RESTITUTION=<e>, BETA=1/6', f'METHOD={method}{more}')
        for asked in (1e-2, 1e-3):
            run = run_deck(automatic(text, asked), end=5)
            table.add(f'oscillator, wall, {method.lower()}', asked, run, motion(run, [1])[0],
                      exact.at(run['history/time'])[0], above=False)


def check_limits(checks):
    deck = OSCILLATOR + PULLED
    run = run_deck(deck + step(1e-12, '0.1, 10'), expect_status=4)
    checks.true('TOLERANCE=1e-12 takes' in run.text and 'without INC a step has at most 1000000' in run.text
                and 'raise INC' in run.text, 'beyond reach: an error that says so')
    run = run_deck(deck + step(1e-5, '0.1, 10').replace('*STEP', '*STEP, INC=500'), expect_status=4)
    checks.true('INC=500 allows' in run.text, 'INC: an error before the run')
    run = run_deck(deck + step(1e-5, '0.1, 10, 0.05'))
    estimates, _, _, _, warned = said(run)
    t, u = run['history/time'], motion(run, [1])[0]
    error = np.max(np.abs(u - decay(t, 0.0)))
    checks.true(warned and estimates[0] > 1e-5, 'smallest increment too large: a warning')
    checks.at_least(np.min(np.diff(t)), 0.05 - 1e-12, 'smallest increment: kept to')
    checks.close(estimates[0] / error, 1.0, 0.5, 'smallest increment: the estimate is right all the same')
    # no TOLERANCE: 1e-3
    run = run_deck(deck + step(1, '0.1, 10').replace(', TOLERANCE=1', ''))
    error = np.max(np.abs(motion(run, [1])[0] - decay(run['history/time'], 0.0)))
    checks.at_most(error, 5e-3, 'no TOLERANCE: 1e-3')
    checks.at_least(error, 2e-4, 'no TOLERANCE: 1e-3')


def check_steps(checks):
    """TOLERANCE is of each step; a new load comes with the second."""
    asked = 1e-4
    run = run_deck(OSCILLATOR + PULLED + step(asked, '0.1, 4')
                   + step(asked, '0.1, 6', '*CLOAD\n1, 1, 3\n'))
    t, u = run['history/time'], motion(run, [1])[0]
    rest, v4 = 0.75, -OMEGA * np.sin(8.0)
    s = t - 4.0
    exact = np.where(s < 0, np.cos(OMEGA * t), rest + (np.cos(8.0) - rest) * np.cos(OMEGA * s)
                     + v4 / OMEGA * np.sin(OMEGA * s))
    estimates = said(run)[0]
    checks.true(len(estimates) == 2, 'two steps: an estimate each')
    scale = np.max(np.abs(exact))
    checks.at_most(np.max(np.abs(u - exact)) / scale, 5 * 2 * asked, 'two steps: error of both')


checks = Checks()
table = Table(checks)
check_walls(table)
check_free(table)
check_loads(table)
check_bar(table)
check_exact_flights(table)
check_other_methods(table)
check_limits(checks)
check_steps(checks)
table.show()
checks.finish()
