"""Two masses on two springs, the second in front of a wall: only the node that hits may jump.

M = I, K = [2 -1; -1 1], from (1, 1) at rest, wall for node 2 at -0.5 (input/two_dof/two_dof.inp).
"""
import numpy as np

from carom_case import INPUT, Checks, run_deck
from exact_solutions import two_dof

DECK = (INPUT / 'two_dof' / 'two_dof.inp').read_text()
STEPS = (0.04, 0.02, 0.01, 0.005)
TIMES = np.array([3.156462749645909, 9.471026916723341, 15.785097629177535, 22.098172724846872,
                  28.413036088929456])


def order(steps, errors):
    """Exponent of the step in the error, fitted through all of them."""
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


def motion(run):
    """Displacements and velocities of both nodes."""
    return (np.array([run['history/node_1/U1'], run['history/node_2/U1']]),
            np.array([run['history/node_1/V1'], run['history/node_2/V1']]))


def check_times(checks):
    errors = []
    for h in (0.004, 0.002, 0.001):
        times = run_deck(DECK, dt=h).events()['time']
        checks.true(len(times) == 5, f'h = {h}: {len(times)} impacts to t = 30')
        errors.append(np.abs(times - TIMES))
    checks.at_most(np.max(errors[-1]), 3e-6, 'h = 0.001: impact times')
    for k in range(5):
        checks.at_least(order((4, 2, 1), [error[k] for error in errors]), 1.95,
                        f'order of the time of impact {k + 1}')


def check_displacements(checks):
    for e in (1.0, 0.7):
        exact = two_dof(20.0, restitution=e)
        errors, first = [], []
        for h in STEPS:
            run = run_deck(DECK, dt=h, end=20.0, e=e)
            d, _ = motion(run)
            errors.append(np.max(np.abs(d - exact.at(run['history/time'])[0])))
            event = run.events()
            checks.close(len(event['time']), len(exact.impact_times), 0,
                         f'e = {e}, h = {h}: number of impacts')
            first.append(abs(event['gap_rate_before'][0] + 0.92710998))
        checks.at_least(order(STEPS, errors), 1.95,
                        f'e = {e}: order of the displacement error {errors[-1]:.3g} to t = 20')
        checks.at_most(first[-1], 1e-5, f'e = {e}: approach speed of the first impact')


def check_jump(checks):
    """Only node 2 jumps. The velocity of node 1 goes through the impact as it comes: one impact at
    the very end of a step gives both sides of it."""
    h = 0.01
    run = run_deck(DECK, dt=h, end=20.0)
    events = run.events()
    checks.close(events['impulse'], 2.0 * np.abs(events['gap_rate_before']), 1e-14,
                 'impulse is 2 m2 |v2|')
    checks.true(set(events['node']) == {2}, 'node 2 alone has impacts')
    tau = float(events['time'][0])
    # 315 steps to the first impact: the run that ends a hair before it, and the one a hair after it
    before, after = (motion(run_deck(DECK, dt=tau * scale / 315, end=tau * scale))
                     for scale in (1.0 - 1e-5, 1.0 + 1e-5))
    accelerated = 2.0 * 1e-5 * tau * abs(2.0 * -0.1620774 + 0.5)
    checks.close(after[1][0, -1], before[1][0, -1], 1.1 * accelerated,
                 'velocity of node 1 through the first impact')
    checks.close(before[1][0, -1], -0.00251252, 3e-4, 'which is')
    checks.close(after[1][1, -1], -before[1][1, -1], 1e-4, 'velocity of node 2 is turned')
    checks.close(after[0][:, -1], [-0.1620774, -0.5], 1e-4, 'displacements at the first impact')
    errors = []
    for step in STEPS:
        run = run_deck(DECK, dt=step, end=20.0)
        exact = two_dof(20.0).at(run['history/time'])[1]
        errors.append(np.max(np.abs(motion(run)[1][0] - exact[0])))
    checks.at_least(order(STEPS, errors), 1.95, f'order of the velocity of node 1 {errors[-1]:.3g}')


def check_energy(checks):
    run = run_deck(DECK.replace('BETA=1/6', 'BETA=1/4'), dt=0.04, end=1000.0)
    total = run['energy/total']
    checks.at_least(len(run.events()['time']), 150, 'beta = 1/4, to t = 1000: impacts')
    checks.at_most(np.max(np.abs(total / total[0] - 1.0)), 1e-12, 'beta = 1/4: energy error')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-12, 'beta = 1/4: balance error')
    run = run_deck(DECK.replace('BETA=1/6', 'BETA=1/4'), dt=0.04, end=1000.0, e=0.8)
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-12,
                   'beta = 1/4, e = 0.8: balance error')
    checks.at_least(run['energy/impact_loss'][-1], 0.1, 'beta = 1/4, e = 0.8: energy taken')


checks = Checks()
check_times(checks)
check_displacements(checks)
check_jump(checks)
check_energy(checks)
checks.finish()
