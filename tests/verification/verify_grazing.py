"""Impacts at the edge of being one: grazing, resting, simultaneous, moving walls, limits."""
import numpy as np

from carom_case import Checks, run_deck

# one mass on a spring, wall at -w; stiffness, load and speed by parameter
SPRING_MASS = """*HEADING
mass and wall
*PARAMETER
dt = 0.1
end = 10
wall = -0.5
d0 = 1
v0 = 0
k = 1
g = 0
e = 1
*NODE
1, 0, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*ELEMENT, TYPE=SPRING1, ELSET=spring
2, 1
*MASS, ELSET=mass
2
*SPRING, ELSET=spring
1
<k>
*SURFACE, NAME=body, TYPE=NODE
1
*RIGID SURFACE, NAME=wall, TYPE=PLANE
<wall>, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, RESTITUTION=<e>, BETA=1/4
*CONTACT PAIR, INTERACTION=hit
body, wall
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
1, 1, <d0>
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, <v0>
*STEP
*DYNAMIC, DIRECT
<dt>, <end>
*DLOAD
mass, GRAV, <g>, -1, 0, 0
*NODE PRINT
U, V, A
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
"""
SUSTAINED = SPRING_MASS.replace('RESTITUTION=<e>, ', '')
U, V, CF = 'history/node_1/U1', 'history/node_1/V1', 'history/contact_BODY-WALL/CF1'


def check_dip(checks):
    """Under the wall and back within one step: thrown masses, exact for any step, and a spring."""
    for depth in (1e-1, 1e-4, 1e-8):
        # up against gravity from below the wall... the wall is above: thrown at v0, top at v0^2/2g
        v0, g = 3.0, 10.0
        top = v0**2 / (2.0 * g)
        text = SPRING_MASS.replace('1, 0, 0\n*SURFACE INT', '-1, 0, 0\n*SURFACE INT')
        run = run_deck(text, dt=0.7, end=0.7, wall=top - depth, d0=0.0, v0=v0, k=0.0, g=g)
        tau = (v0 - np.sqrt(2.0 * g * depth)) / g
        speed = np.sqrt(2.0 * g * depth)
        events = run.events()
        # the gap is closed to 1e-12 of its size, here about 4
        late = 4e-12 / speed
        checks.close(events['time'], [tau], late, f'thrown, {depth:g} over the wall: impact time')
        checks.close(events['impulse'], [4.0 * speed], 4.0 * g * late,
                     f'thrown, {depth:g}: impulse')
        rest = 0.7 - tau
        checks.close(run[U][-1], top - depth - speed * rest - 0.5 * g * rest**2, 1e-8,
                     f'thrown, {depth:g}: place after it')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-12,
                       f'thrown, {depth:g}: balance error')
    run = run_deck(text, dt=0.7, end=0.7, wall=top * (1.0 + 1e-10), d0=0.0, v0=3.0, k=0.0, g=10.0)
    checks.close(len(run.events()['time']), 0, 0, 'thrown, not quite to the wall: impacts')
    # m = 2, k = 2: omega = 1, h = 1.3: the bottom at pi lies inside the step from 2.6 to 3.9
    free = run_deck(SPRING_MASS, dt=1.3, end=5.2, wall=-2.0, k=2.0)
    lowest = np.min(free[U])
    for wall in (lowest + 1e-2, lowest - 1e-4, lowest - 1e-3):
        run = run_deck(SPRING_MASS, dt=1.3, end=5.2, wall=float(wall), k=2.0)
        times = run.events()['time']
        checks.true(len(times) >= 1 and 2.6 < times[0] < 3.9,
                    f'spring, h = 1.3, wall at {wall:.4f}, d at the steps from {lowest:.4f}: '
                    f'impact at {times[:1]}')
        checks.at_least(np.min(run[U]), wall - 1e-12, 'spring, h = 1.3: smallest displacement')
        checks.at_most(np.max(np.abs(run['energy/total'] - 1.0)), 1e-13,
                       'spring, h = 1.3, beta = 1/4: energy error')


def check_resting(checks):
    for e in (1.0, 0.5, 0.0):
        run = run_deck(SPRING_MASS, d0=0.0, wall=0.0, k=0.0, g=9.81, e=e)
        checks.at_most(np.max(np.abs(run[U])) + np.max(np.abs(run[V])), 1e-30,
                       f'resting under gravity, e = {e}: motion')
        checks.close(run[CF], np.full(101, 2.0 * 9.81), 1e-13, f'resting, e = {e}: contact force')
        checks.close(np.sum(run['history/contact_BODY-WALL/impulse']), 196.2, 1e-11,
                     f'resting, e = {e}: impulse of ten seconds')
    run = run_deck(SPRING_MASS, d0=0.0, wall=0.0, k=0.0, g=-9.81)
    t = run['history/time']
    checks.close(run[U], 0.5 * 9.81 * t**2, 1e-11, 'at the wall, pulled away: falls off freely')
    checks.close(run[CF], np.zeros(101), 0.0, 'at the wall, pulled away: contact force')
    run = run_deck(SPRING_MASS, d0=0.0, wall=0.0, k=0.0)
    checks.close(run[U], np.zeros(101), 0.0, 'at the wall, no load: stays')
    run = run_deck(SPRING_MASS, d0=0.0, wall=0.0, k=0.0, v0=1.5)
    checks.close(run[U], 1.5 * run['history/time'], 1e-13, 'at the wall, moving off: goes freely')
    checks.close(len(run['events/time']), 0, 0, 'at the wall, moving off: events')
    for e in (1.0, 0.4):
        run = run_deck(SPRING_MASS, d0=0.0, wall=0.0, k=0.0, v0=-1.5, e=e)
        checks.close(run.events()['time'], [0.0], 0.0, f'into the wall, e = {e}: impact at once')
        checks.close(run[U], 1.5 * e * run['history/time'], 1e-13,
                     f'into the wall, e = {e}: motion')
        checks.close(run['energy/impact_loss'][-1], 2.25 * (1.0 - e**2), 1e-14,
                     f'into the wall, e = {e}: energy taken')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-14,
                       f'into the wall, e = {e}: balance error')
    check_lifted(checks)


def check_lifted(checks):
    """A spring presses the mass against the wall until a growing load lifts it, inside a step."""
    text = SUSTAINED.replace('*DLOAD', '*CLOAD, AMPLITUDE=lift\n1, 1, 4\n*DLOAD').replace(
        '*STEP', '*AMPLITUDE, NAME=lift\n0, 0, 10, 1\n*STEP')
    start, errors, steps = 5.0325, [], (0.1, 0.05, 0.025, 0.0125)
    for h in steps:
        run = run_deck(text, d0=0.1 * start, wall=0.1 * start, k=4.0, dt=h)
        t = run['history/time']
        checks.close(run[CF], np.maximum(0.4 * (start - t), 0.0), 1e-12,
                     f'pressed by a spring, lifted, h = {h}: force')
        checks.close(run.events('release')['time'], [start], 1e-9, f'lifted, h = {h}: lifts off')
        checks.close(len(run.events()['time']), 0, 0, f'lifted, h = {h}: impacts')
        s, omega = np.maximum(t - start, 0.0), np.sqrt(2.0)
        exact = 0.1 * start + 0.1 * (s - np.sin(omega * s) / omega)
        errors.append(np.max(np.abs(run[U] - exact)))
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    checks.at_least(order, 1.95, f'lifted: order of the motion error {errors[-1]:.3g}')


def check_ball(checks):
    """A ball that bounces ever faster comes to rest: capture at once, then its weight for ever."""
    for dt in (0.1, 0.01):
        run = run_deck(SPRING_MASS, d0=1.0, wall=0.0, k=0.0, g=10.0, e=0.5, dt=dt, end=3.0)
        rest = np.sqrt(0.2) * 3.0
        capture = run.events('capture')['time']
        checks.close(capture, [rest], dt, f'ball, dt = {dt}: comes to rest at {rest:.4f}')
        checks.close(run[CF][-1], 20.0, 1e-12, f'ball, dt = {dt}: weight at the end')
        total = np.sum(run['history/contact_BODY-WALL/impulse'])
        checks.close(total, 20.0 * 3.0, 1e-10, f'ball, dt = {dt}: impulse of all contact')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-12,
                       f'ball, dt = {dt}: balance error')


def two_nodes(shift=0.0):
    """Two masses joined by a spring across the motion and along it, thrown at one wall."""
    return f"""*NODE
1, 0, 0
2, 0, 1
*ELEMENT, TYPE=MASS, ELSET=masses
1, 1
2, 2
*ELEMENT, TYPE=SPRING2, ELSET=between
3, 1, 2
*MASS, ELSET=masses
1
*SPRING, ELSET=between
1, 1
5
*SURFACE, NAME=body, TYPE=NODE
1, 2
*RIGID SURFACE, NAME=wall, TYPE=PLANE
-1, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, RESTITUTION=0.8
*CONTACT PAIR, INTERACTION=hit
body, wall
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
2, 1, {shift!r}
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, -1
2, 1, -1
*STEP
*DYNAMIC, DIRECT
0.3, 3
*NODE PRINT
U, V
*ENERGY PRINT
*END STEP
"""


def check_together(checks):
    for shift, tolerance in ((0.0, 0.0), (1e-12, 1e-11)):
        run = run_deck(two_nodes(shift))
        events = run.events()
        checks.true(len(set(events['time'])) == 1 and sorted(events['node']) == [1, 2],
                    f'two nodes together, {shift:g} apart: both hit at {events["time"]}')
        checks.close(run['history/node_1/U1'], run['history/node_2/U1'], tolerance,
                     f'two nodes together, {shift:g} apart: displacements')
        checks.close(run['history/node_1/V1'], run['history/node_2/V1'], tolerance,
                     f'two nodes together, {shift:g} apart: velocities')
        checks.close(run['history/node_1/V1'][-1], 0.8, 1e-11, 'two nodes together: rebound')


def moving(text, points, lines='1, 0, 0, 1'):
    """The wall moves along x by an amplitude."""
    text = text.replace('NAME=wall, TYPE=PLANE', 'NAME=wall, TYPE=PLANE, AMPLITUDE=push')
    text = text.replace('1, 0, 0\n*SURFACE INT', f'1, 0, 0\n{lines}\n*SURFACE INT')
    return text.replace('*SURFACE, NAME', f'*AMPLITUDE, NAME=push\n{points}\n*SURFACE, NAME')


def check_moving_wall(checks):
    """A wall that comes at 0.5 from -1 at t = 0 reaches the mass at rest at t = 2."""
    for e in (1.0, 0.6, 0.0):
        run = run_deck(moving(SPRING_MASS, '0, 0, 20, 10'), d0=0.0, wall=-1.0, k=0.0, e=e)
        name = f'wall into a mass at rest, e = {e}'
        checks.close(run.events()['time'], [2.0], 1e-12, f'{name}: impact time')
        checks.close(run[V][-1], (1.0 + e) * 0.5, 1e-14, f'{name}: velocity after')
        checks.close(run['energy/kinetic'][-1], ((1.0 + e) * 0.5)**2, 1e-14, f'{name}: energy')
        checks.close(run['energy/external_work'][-1], 2.0 * (1.0 + e) * 0.5 * 0.5, 1e-14,
                     f'{name}: work of the wall')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-14, f'{name}: balance error')
    # gravity pulls the mass back into the wall, which carries it on at last
    run = run_deck(moving(SPRING_MASS, '0, 0, 100, 50'), d0=0.0, wall=-1.0, k=0.0, g=1.0, e=0.5,
                   end=20.0)
    first = -0.5 + np.sqrt(0.25 + 2.0)
    events = run.events()
    checks.close(events['time'][0], first, 1e-12, 'wall and gravity: first impact')
    # in the wall's frame a ball: bounces of e^k 2 u / g
    u = -events['gap_rate_before'][0]
    checks.close(u, first + 0.5, 1e-12, 'wall and gravity: approach speed')
    checks.close(events['time'][1:4] - first, 2.0 * u * np.cumsum([0.5, 0.25, 0.125]), 1e-10,
                 'wall and gravity: catches up again')
    checks.close(run[V][-1], 0.5, 1e-12, 'wall and gravity: carried on in the end')
    checks.close(run[U][-1], -1.0 + 10.0, 1e-11, 'wall and gravity: place at the end')
    checks.close(run[CF][-1], 2.0, 1e-11, 'wall and gravity: contact force')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-11,
                   'wall and gravity: balance error')
    # a spring: hit, swings back into the wall that still comes
    for h in (0.02, 0.01):
        run = run_deck(moving(SPRING_MASS, '0, 0, 20, 10'), d0=0.0, wall=-1.0, k=2.0, e=1.0, dt=h,
                       end=4.5)
        # after t = 2: d = sin(t - 2), wall at (t - 2)/2: they meet at s = 1.895494267033981
        late = 1.895494267033981
        checks.close(run.events()['time'][:2], [2.0, 2.0 + late], 0.2 * h**2,
                     f'wall and spring, h = {h}: impact times')
        checks.close(run.events()['gap_rate_before'][1], np.cos(late) - 0.5, 0.2 * h**2,
                     f'wall and spring, h = {h}: second approach')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-13,
                       f'wall and spring, h = {h}: balance error')
    # the wall stops: the captured mass flies on with the wall's last speed
    run = run_deck(moving(SUSTAINED, '0, 0, 3.97, 1.985'), d0=-1.0, wall=-1.0, k=0.0)
    t = run['history/time']
    checks.close(run[U], -1.0 + 0.5 * t, 1e-12, 'wall that pushes and stops: mass flies on')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-13,
                   'wall that pushes and stops: balance error')
    # the wall turns round by -0.5 to +0.5 while the mass rests on it, pressed by gravity
    run = run_deck(moving(SUSTAINED, '0, 0, 2, -1, 10, 3'), d0=-1.0, wall=-1.0, k=0.0, g=9.81,
                   v0=-0.5)
    t = run['history/time']
    checks.close(run[U], -1.0 + np.where(t < 2.0, -0.5 * t, -1.0 + 0.5 * (t - 2.0)), 1e-10,
                 'wall that turns round under a resting mass: place')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-11,
                   'wall that turns round under a resting mass: balance error')


PIECE = 5e-5


def shaken(w, h):
    """A mass lies on a table that shakes by 0.5 sin(w t), given in points PIECE apart; g = 8."""
    t = np.arange(0.0, 2.1, PIECE)
    points = '\n'.join(f'{a:.15g}, {b:.15g}' for a, b in zip(t, 0.5 * np.sin(w * t)))
    return run_deck(moving(SUSTAINED, points), d0=0.0, wall=0.0, k=0.0, g=8.0, v0=0.5 * w, dt=h,
                    end=2.0)


def check_table(checks):
    """A table at w = 3 slows down by 4.5 at most and keeps the mass; at 6 by 18: it throws it."""
    for h in (0.02, 0.01, 0.005):
        run = shaken(3.0, h)
        time, name = run['history/time'], f'table shaken gently, h = {h}'
        checks.close(len(run.events('release')['time']), 0, 0, f'{name}: releases')
        checks.close(run[U], 0.5 * np.sin(3.0 * time), 1e-12, f'{name}: place')
        impulse = np.cumsum(run['history/contact_BODY-WALL/impulse'])
        exact = 2.0 * (8.0 * time + 1.5 * np.cos(3.0 * time) - 1.5)
        # the table's speed is that of a whole piece
        checks.close(impulse, exact, 2.0 * 4.5 * PIECE, f'{name}: impulse')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-11, f'{name}: balance error')
    first = np.arcsin(8.0 / 18.0) / 6.0
    errors, steps = [], (0.04, 0.02, 0.01)
    for h in steps:
        run = shaken(6.0, h)
        time, name = run['history/time'], f'table shaken hard, h = {h}'
        checks.close(run.events('release')['time'][0], first, 2.0 * h, f'{name}: throws the mass')
        table, s = 0.5 * np.sin(6.0 * time), np.maximum(time - first, 0.0)
        flight = 0.5 * np.sin(6.0 * first) + 3.0 * np.cos(6.0 * first) * s - 4.0 * s**2
        early = time < first + 0.5
        exact = np.where(s > 0.0, flight, table)
        errors.append(np.max(np.abs(run[U] - exact)[early]))
        checks.at_least(np.min(run[U] - table), -1e-6, f'{name}: smallest gap')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-11, f'{name}: balance error')
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    checks.at_least(order, 1.9, f'table shaken hard: order of the flight {errors[-1]:.3g}')
    checks.at_most(errors[1], 2e-3, 'table shaken hard, h = 0.02: error of the flight')


def check_errors(checks):
    run = run_deck(SPRING_MASS, expect_status=2, d0=-0.75)
    checks.true('node 1 overlaps' in run.text and '0.25' in run.text,
                'overlap at the start: ' + run.text.splitlines()[0])
    # a ball between two walls that close: ever more impacts a step
    text = SPRING_MASS.replace('RESTITUTION=<e>', 'RESTITUTION=<e>, CAPTURE=0, MAX EVENTS=7')
    run = run_deck(text, d0=1.0, wall=0.0, k=0.0, g=10.0, e=0.9, dt=5.0, end=20.0)
    times = run.events()['time']
    checks.close(len(run.events('limit')['time']), 1, 0, 'limit of events: rows of it')
    checks.at_most(np.sum(times <= 5.0), 7 + 1, 'limit of events: impacts in the first step')
    log = run.path.with_suffix('.log').read_text()
    checks.true('MAX EVENTS' in log or 'limit' in log, 'limit of events: the log says so')
    checks.at_least(np.min(run[U]), -1e-12, 'limit of events: no overlap')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-11, 'limit: balance error')


def bar(mass, n=10):
    """A bar of trusses that flies against a wall."""
    nodes = '\n'.join(f'{i + 1}, {i / n!r}, 0' for i in range(n + 1))
    elements = '\n'.join(f'{i + 1}, {i + 1}, {i + 2}' for i in range(n))
    speeds = '\n'.join(f'{i + 1}, 1, -1' for i in range(n + 1))
    return f"""*NODE
{nodes}
*ELEMENT, TYPE=T2D2, ELSET=bar
{elements}
*MATERIAL, NAME=stuff
*ELASTIC
100, 0
*DENSITY
1
*SOLID SECTION, ELSET=bar, MATERIAL=stuff
1
*ELEMENT GROUP, ELSET=bar, SCHEME=IMPLICIT, MASS={mass}
*SURFACE, NAME=tip, TYPE=NODE
1
*RIGID SURFACE, NAME=wall, TYPE=PLANE
-0.1037, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, RESTITUTION=1, BETA=1/4
*CONTACT PAIR, INTERACTION=hit
tip, wall
*INITIAL CONDITIONS, TYPE=VELOCITY
{speeds}
*STEP
*DYNAMIC, DIRECT
0.005, 0.6
*NODE PRINT
U, V
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
"""


def check_bar(checks):
    """The tip bounces many times; the inverse of the whole mass matrix makes the impulse."""
    n = 10
    for mass in ('CONSISTENT', 'LUMPED'):
        run = run_deck(bar(mass, n))
        total, events = run['energy/total'], run.events()
        checks.at_least(len(events['time']), 5, f'bar, {mass}: impacts')
        checks.at_most(np.max(np.abs(total / total[0] - 1.0)), 1e-12, f'bar, {mass}: energy error')
        matrix = np.zeros((n + 1, n + 1))
        for i in range(n):
            matrix[i:i + 2, i:i + 2] += np.array([[2.0, 1.0], [1.0, 2.0]]) / (6.0 * n)
        if mass == 'LUMPED':
            matrix = np.diag(matrix.sum(axis=1))
        compliance = np.linalg.inv(matrix)[0, 0]
        checks.close(events['impulse'], -2.0 * events['gap_rate_before'] / compliance, 1e-12,
                     f'bar, {mass}: impulse is 2 v / (G M^-1 Gt)')
        v = np.array([run[f'history/node_{i + 1}/V1'] for i in range(n + 1)])
        momentum = matrix.sum(axis=0) @ v
        given = np.cumsum(run['history/contact_TIP-WALL/impulse'])
        checks.close(momentum + 1.0, given, 1e-12, f'bar, {mass}: momentum is the impulse')


checks = Checks()
check_dip(checks)
check_resting(checks)
check_ball(checks)
check_together(checks)
check_moving_wall(checks)
check_table(checks)
check_errors(checks)
check_bar(checks)
checks.finish()
