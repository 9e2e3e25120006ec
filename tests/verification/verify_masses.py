"""Free masses that collide: exact final velocities and momentum.

Decks: input/colliding_masses/colliding_masses.inp, input/cradle/cradle.inp.
"""
import numpy as np

from carom_case import INPUT, Checks, run_deck

TWO = INPUT / 'colliding_masses' / 'colliding_masses.inp'
CRADLE = INPUT / 'cradle' / 'cradle.inp'


def velocities(run, n):
    """Velocities of nodes 1 to n at all times, (n, times)."""
    return np.array([run[f'history/node_{i}/V1'] for i in range(1, n + 1)])


def after_collision(m, v, e):
    """Velocities of two masses after they have collided."""
    p = (1.0 + e) * (v[0] - v[1]) * m[0] * m[1] / (m[0] + m[1])
    return np.array([v[0] - p / m[0], v[1] + p / m[1]])


def check_two(checks, m, v, e, dt, end=2.0, clearance=1.0):
    run = run_deck(TWO, m1=float(m[0]), m2=float(m[1]), v1=float(v[0]), v2=float(v[1]), e=e, dt=dt,
                   end=end, clearance=clearance)
    name = f'masses {m[0]:g} and {m[1]:g}, e = {e:g}, dt = {dt:g}'
    final = velocities(run, 2)
    speed = np.max(np.abs(v))
    checks.close(final[:, -1], after_collision(m, v, e), 1e-13 * speed, f'{name}: final velocities')
    momentum = m @ final
    checks.close(momentum, np.full(momentum.size, m @ v), 1e-14 * (m @ np.abs(v)),
                 f'{name}: momentum')
    events = run.events()
    tau = clearance / (v[0] - v[1])
    checks.close(events['time'], [tau], 1e-12 * tau, f'{name}: time of the impact')
    d = np.array([run['history/node_1/U1'][-1], run['history/node_2/U1'][-1]])
    checks.close(d, v * tau + after_collision(m, v, e) * (run['history/time'][-1] - tau),
                 1e-12 * speed * end, f'{name}: final places')
    loss = 0.5 * m @ v**2 - 0.5 * m @ after_collision(m, v, e)**2
    checks.close(run['energy/impact_loss'][-1], loss, 1e-13 * (m @ v**2), f'{name}: energy taken')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-13 * (m @ v**2),
                   f'{name}: balance error')


def check_pairs(checks):
    m, v = np.array([3.0, 1.0]), np.array([2.0, -1.0])
    for dt in (2.0, 1.0, 0.1, 0.03, 1e-3):
        check_two(checks, m, v, 0.7, dt)
    check_two(checks, m, v, 0.7, 500.0, end=1000.0)
    for ratio in (1e-6, 0.1, 1.0, 10.0, 1e6):
        for e in (1.0, 0.3, 0.0):
            check_two(checks, np.array([1.0, ratio]), v, e, 0.1)


def check_joined(checks):
    """e = 0: both go on together, gap and its rate at zero, whatever the step."""
    for text, name in ((TWO.read_text(), 'e = 0'),
                       (TWO.read_text().replace(', RESTITUTION=<e>', ''), 'e absent')):
        run = run_deck(text, e=0.0, dt=0.07, end=20.0)
        v = velocities(run, 2)
        late = run['history/time'] > 1.0 / 3.0
        checks.close(v[:, late], np.full((2, np.sum(late)), 1.25), 1e-13, f'{name}: joint velocity')
        gap = 1.0 + run['history/node_2/U1'] - run['history/node_1/U1']
        checks.at_most(np.max(np.abs(gap[late])), 1e-13, f'{name}: gap afterwards')
        checks.close(run['energy/impact_loss'][-1], 0.5 * 0.75 * 9.0, 1e-13,
                     f'{name}: energy taken')
        checks.close(len(run.events()['time']), 1, 0, f'{name}: impacts')


def check_cradle(checks):
    for gap in (0.1, 1e-3, 1e-6, 0.0):
        for dt in (2.0, 0.1, 0.013):
            run = run_deck(CRADLE, gap=gap, dt=dt)
            v = velocities(run, 4)
            name = f'cradle, gaps {gap:g}, dt = {dt:g}'
            checks.close(v[:, -1], [0.0, 0.0, 0.0, 1.0], 1e-13, f'{name}: final velocities')
            checks.close(v.sum(axis=0), np.ones(v.shape[1]), 1e-14, f'{name}: momentum')
            times = run.events()['time']
            checks.close(times[[0, -1]], [0.5, 0.5 + 2.0 * gap], 1e-12,
                         f'{name}: first and last impact')
            checks.at_most(np.max(np.abs(run['energy/total'] - 0.5)), 1e-14,
                           f'{name}: energy error')
    for e in (0.5, 0.9):
        run = run_deck(CRADLE, gap=0.1, e=e, end=0.85, dt=0.1)
        # the first chain of impacts: each gives (1 + e)/2 of its speed on and keeps (1 - e)/2
        give, keep = (1.0 + e) / 2.0, (1.0 - e) / 2.0
        first = run.events()
        checks.close(first['gap_rate_after'][:2] / first['gap_rate_before'][:2], [-e, -e], 1e-14,
                     f'cradle, e = {e}: rebounds')
        late = np.array([0.0, 0.1 / give, 0.1 / give + 0.1 / give**2])
        checks.close(first['time'][:3], 0.5 + late, 1e-12,
                     f'cradle, e = {e}: times of the first chain of impacts')
        early = run_deck(CRADLE, gap=0.1, e=e, end=float(first['time'][2]) + 1e-3, dt=0.01)
        checks.close(velocities(early, 4)[:, -1],
                     [keep, keep * give, keep * give**2, give**3], 1e-13,
                     f'cradle, e = {e}: velocities after the first chain of impacts')


checks = Checks()
check_pairs(checks)
check_joined(checks)
check_cradle(checks)
checks.finish()
