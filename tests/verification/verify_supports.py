"""Loads and supports that go with OP=NEW, without data lines, and supports that are words, beside
the exact answers.

Two masses of 1 on a spring of 2: the first swings with omega^2 = 2 while the second is held, both
with omega^2 = 4 against each other when it is not. The trapezoidal rule turns (u, v/omega) by
theta a step, tan(theta/2) = omega h/2, which is met to round-off.
"""
import numpy as np

from carom_case import Checks, run_deck

MASSES = """*NODE
1, 0, 0
2, 1, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
2, 2
*ELEMENT, TYPE=SPRING2, ELSET=spring
3, 1, 2
*MASS, ELSET=mass
1
*SPRING, ELSET=spring
1, 1
2
*BOUNDARY
2, 1
"""
SQUARE = """*NODE, NSET=all
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
*ELEMENT, TYPE=CPS4, ELSET=square
1, 1, 2, 3, 4
*MATERIAL, NAME=soft
*ELASTIC
100, 0
*SOLID SECTION, ELSET=square, MATERIAL=soft
1
*BOUNDARY
1, 1, 2
4, 1
all, 2
"""
PRINTS = '*NODE PRINT\nU, V\n*ENERGY PRINT\n'
H, N = 0.02, 100            # length and number of the dynamic increments


def step(procedure, times, cards):
    """A step with its cards and what it records."""
    return f'*STEP\n*{procedure}\n{times}\n{cards}{PRINTS}*END STEP\n'


def dynamic(cards):
    """N increments of H."""
    return step('DYNAMIC, DIRECT', f'{H}, {H * N}', cards)


def turn(omega, u, v):
    """u and v of N increments of the trapezoidal rule, the start too."""
    angle = 2.0 * np.arctan(0.5 * omega * H) * np.arange(N + 1)
    return (u * np.cos(angle) + v / omega * np.sin(angle),
            v * np.cos(angle) - u * omega * np.sin(angle))


def check_masses(checks):
    """A force goes, then gravity, then the support, each by a card without lines."""
    run = run_deck(MASSES + step('STATIC, DIRECT', '1, 1', '*CLOAD\n1, 1, 2\n'
                                 '*DLOAD\nmass, GRAV, 3, 1, 0, 0\n')
                   + step('STATIC, DIRECT', '1, 1', '*CLOAD, OP=NEW\n')
                   + dynamic('*DLOAD, OP=NEW\n') + dynamic('*BOUNDARY, OP=NEW\n'))
    u = [run[f'history/node_{i}/U1'] for i in (1, 2)]
    v = [run[f'history/node_{i}/V1'] for i in (1, 2)]
    checks.close(u[0][:3], [0.0, 2.5, 1.5], 1e-14, 'force and gravity, then gravity alone')
    held = slice(2, N + 3)
    d, rate = turn(np.sqrt(2.0), 1.5, 0.0)
    checks.close(u[0][held], d, 1e-12, 'gravity gone: swings about 0')
    checks.close(u[1][held], np.zeros(N + 1), 0.0, 'gravity gone: the support stays')
    free = slice(N + 2, 2 * N + 3)
    apart, _ = turn(2.0, d[-1], rate[-1])
    middle = 0.5 * (d[-1] + rate[-1] * H * np.arange(N + 1))
    checks.close(0.5 * (u[0] + u[1])[free], middle, 1e-12, 'support gone: the middle goes on')
    checks.close((u[0] - u[1])[free], apart, 1e-12, 'support gone: both swing')
    checks.close((v[0] + v[1])[free], np.full(N + 1, rate[-1]), 1e-12, 'support gone: momentum')
    checks.at_most(np.ptp(run['energy/balance_error'][2:]), 1e-12, 'balance of the free motion')


def check_first_step(checks):
    """OP=NEW in the first step drops the supports of the deck."""
    start = '*INITIAL CONDITIONS, TYPE=VELOCITY\n1, 1, 3\n'
    for cards, together in (('*BOUNDARY, OP=NEW\n', True), ('', False)):
        run = run_deck(MASSES + start + dynamic(cards))
        middle = 0.5 * (run['history/node_1/U1'] + run['history/node_2/U1'])
        expected = (1.5 * H * np.arange(N + 1) if together
                    else 0.5 * turn(np.sqrt(2.0), 0.0, 3.0)[0])
        checks.close(middle, expected, 1e-12, f"first step with '{cards.strip()}'")


def check_pressure(checks):
    """A pressure on an element's edge goes."""
    run = run_deck(SQUARE + step('STATIC, DIRECT', '1, 1', '*DLOAD\n1, P2, -5\n')
                   + step('STATIC, DIRECT', '1, 1', '*DLOAD, OP=NEW\n'))
    checks.close(run['history/node_3/U1'], [0.0, 0.05, 0.0], 1e-15, 'pressure that goes')


def check_words(checks):
    """A square in tension on planes of symmetry, and one that is held all around."""
    soft = SQUARE[:SQUARE.index('*BOUNDARY')].replace('100, 0\n', '100, 0.25\n')
    pull = step('STATIC, DIRECT', '1, 1', '*DLOAD\n1, P2, -5\n')
    words = '*NSET, NSET=left\n1, 4\n*BOUNDARY\nleft, XSYMM\n1, ysymm\n2, YSYMM\n'
    run = run_deck(soft + words + pull)
    for i, u in enumerate(([0, 0], [0.05, 0], [0.05, -0.0125], [0, -0.0125]), 1):
        checks.close([run[f'history/node_{i}/U{k}'][-1] for k in (1, 2)], u, 1e-15,
                     f'tension between planes of symmetry: node {i}')
    for word in ('ENCASTRE', 'Pinned'):
        run = run_deck(soft + f'*BOUNDARY\n1, {word}\n4, {word}\n' + pull)
        same = run_deck(soft + '*BOUNDARY\n1, 1, 2\n4, 1, 2\n' + pull)
        for i in range(1, 5):
            checks.close([run[f'history/node_{i}/U{k}'][-1] for k in (1, 2)],
                         [same[f'history/node_{i}/U{k}'][-1] for k in (1, 2)], 0.0,
                         f'{word}: node {i} as with 1, 2')


def check_lost_starts(checks):
    """An initial condition of a supported freedom is noted when it changes nothing, only then."""
    still, static = dynamic(''), step('STATIC, DIRECT', '1, 1', '')
    moved = '*AMPLITUDE, NAME=a\n0, 1, 9, 0\n*BOUNDARY, TYPE={}, AMPLITUDE=a\n2, 1, 1, 0.5\n'
    rate = '*BOUNDARY, TYPE=VELOCITY\n2, 1, 1, 0.5\n'
    push = dynamic('*BOUNDARY, TYPE=ACCELERATION\n2, 1, 1, 0.5\n')
    held = '*BOUNDARY\n2, 1\n'
    masses = MASSES[:MASSES.index('*BOUNDARY')]
    for kind, name, supports, steps in (
            ('VELOCITY', 'held', held, still), ('DISPLACEMENT', 'held', held, still),
            ('VELOCITY', 'held, static first', held, static + still),
            ('DISPLACEMENT', 'held, static first', held, static + still),
            ('DISPLACEMENT', 'moved, static first', moved.format('DISPLACEMENT'), static),
            ('VELOCITY', 'free', '', still), ('DISPLACEMENT', 'free', '', still),
            ('VELOCITY', 'dropped', held, dynamic('*BOUNDARY, OP=NEW\n')),
            ('VELOCITY', 'moved', moved.format('DISPLACEMENT'), still),
            ('VELOCITY', 'by rate', rate, still), ('DISPLACEMENT', 'by rate', rate, still),
            ('VELOCITY', 'by acceleration', moved.format('ACCELERATION'), still),
            ('VELOCITY', 'by rate, static first', '', step('STATIC, DIRECT', '1, 1', rate) + still),
            ('VELOCITY', 'by acceleration later', '*BOUNDARY\n1, 1\n', static + push)):
        start = f'*INITIAL CONDITIONS, TYPE={kind}\n2, 1, 0.25\n'
        run, without = (run_deck(masses + supports + text + steps) for text in (start, ''))
        same = all(np.array_equal(run[f'history/node_{i}/{q}1'], without[f'history/node_{i}/{q}1'])
                   for i in (1, 2) for q in 'UV')
        noted = 'from here on has no effect' in run.path.with_suffix('.log').read_text()
        checks.true(noted == same, f'initial {kind.lower()}, {name}: '
                    f'{"no effect" if same else "an effect"}, {"noted" if noted else "not noted"}')


checks = Checks()
check_masses(checks)
check_first_step(checks)
check_pressure(checks)
check_words(checks)
check_lost_starts(checks)
checks.finish()
