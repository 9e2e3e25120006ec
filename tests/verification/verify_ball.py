"""A ball dropped on a plane: it must come to rest, and then weigh what it weighs (input/ball)."""
import numpy as np

from carom_case import INPUT, Checks, run_deck
from exact_solutions import bouncing_ball

DECK = INPUT / 'ball' / 'ball.inp'
FICTITIOUS = INPUT / 'ball' / 'ball_fictitious.inp'
GRAVITY, MASS, HEIGHT = 10.0, 2.0, 1.0
FORCE, GAP = 'history/contact_BODY-FLOOR/CF2', 'history/contact_BODY-FLOOR/CDIS'


def check_rest(checks, e, dt):
    """Bounces die out when they should; then the floor carries the weight."""
    name = f'e = {e}, dt = {dt}'
    expected = (1 + e)/(1 - e)*np.sqrt(2*HEIGHT/GRAVITY)
    run = run_deck(DECK, dt=dt, e=e, end=round(expected + 1.5))
    time, height = run['history/time'], HEIGHT + run['history/node_1/U2']
    exact = bouncing_ball(time, HEIGHT, GRAVITY, e)
    captures = run.events('capture')['time']
    checks.true(len(captures) == 1, f'{name}: one capture')
    checks.close(captures[-1], expected, dt, f'{name}: at rest from {captures[-1]:.6f}, '
                 f'exact {expected:.6f}')
    after = time > captures[-1] + dt
    checks.close(run[FORCE][after], np.full(after.sum(), MASS*GRAVITY), 1e-10,
                 f'{name}: contact force is the weight')
    checks.at_most(np.abs(run['history/node_1/V2'][after]).max(), 1e-12, f'{name}: speed at rest')
    checks.at_least(run[GAP].min(), -1e-12, f'{name}: smallest gap')
    checks.close(height, exact[0], dt**2*GRAVITY/2, f'{name}: height at all times')
    n = int(np.floor(np.log(1e-3)/np.log(e)))
    impacts = run.events('impact')
    fall = np.sqrt(2*HEIGHT/GRAVITY)
    times = fall*(1 + 2*np.cumsum(e**np.arange(1, n)))
    n = min(n, len(impacts['time']) - 1)       # the last one is already at rest
    checks.close(impacts['time'][1:n], times[:n - 1], 1e-9,
                 f'{name}: times of the first {n} impacts')
    checks.close(run['energy/balance_error'], np.zeros(len(time)), 1e-10, f'{name}: energy balance')
    checks.at_most(len(impacts['time']), 3 + np.log(0.1*dt)/np.log(e), f'{name}: number of impacts')


def check_for_ever(checks, dt):
    """e = 1: the same height again and again."""
    name = f'e = 1, dt = {dt}'
    fall = np.sqrt(2*HEIGHT/GRAVITY)
    run = run_deck(DECK, dt=dt, e=1, end=20)
    impacts = run.events('impact')['time']
    exact = fall*(1 + 2*np.arange(len(impacts)))
    checks.true(len(impacts) == int((20/fall + 1)/2), f'{name}: {len(impacts)} impacts in 20')
    checks.close(impacts, exact, 1e-9, f'{name}: times of the impacts')
    total = run['energy/total'] - run['energy/external_work']
    checks.close(total, np.zeros(len(total)), 1e-10, f'{name}: energy')
    height = HEIGHT + run['history/node_1/U2']
    checks.close(height, bouncing_ball(run['history/time'], HEIGHT, GRAVITY, 1.0)[0], 1e-8,
                 f'{name}: height at all times')
    checks.at_least(height[run['history/time'] > 18].max(), HEIGHT - GRAVITY*dt**2/2,
                    f'{name}: last height')
    checks.true(len(run.events('capture')['time']) == 0, f'{name}: never captured')


def check_fictitious(checks):
    """Fictitious force with restitution: at rest in the end, error in proportion to the step."""
    steps = 0.01*0.5**np.arange(8)
    errors, rests, overlaps = [], [], []
    rest = 3*np.sqrt(2*HEIGHT/GRAVITY)
    for dt in steps:
        run = run_deck(FICTITIOUS, dt=float(dt), e=0.5, end=2)
        time, height = run['history/time'], HEIGHT + run['history/node_1/U2']
        errors.append(np.abs(height - bouncing_ball(time, HEIGHT, GRAVITY, 0.5)[0]).max())
        captures = run.events('capture')['time']
        rests.append(captures[-1] if len(captures) else np.inf)
        overlaps.append(-run[GAP].min())
        after = time > 1.8
        checks.close(run[FORCE][after], np.full(after.sum(), MASS*GRAVITY), 1e-10,
                     f'fictitious force, dt = {dt:.3g}: contact force is the weight at the end')
        checks.at_most(overlaps[-1], 1.5*np.sqrt(2*GRAVITY*HEIGHT)*dt,
                       f'fictitious force, dt = {dt:.3g}: largest overlap')
        checks.close(rests[-1], rest, 15*dt, f'fictitious force, dt = {dt:.3g}: rest from '
                     f'{rests[-1]:.4f}, exact {rest:.4f}')
    rates = np.log2(np.array(errors[:-1])/errors[1:])
    print(f'        largest errors {np.array(errors)}, rates {rates}')
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    checks.close(slope, 1.0, 0.15, f'fictitious force: order of the error {slope:.3f}')


def check_always_at_rest(checks):
    """Fictitious force: no restitution and no step for which the bounces go on for ever."""
    still, lowest = [], 0.0
    for e in (0.0, 0.2, 0.45, 0.7, 0.9):
        for dt in (0.02, 0.0137, 0.0071, 0.0053, 0.0031):
            end = 1.1*(1 + e)/(1 - e)*np.sqrt(2*HEIGHT/GRAVITY) + 1
            run = run_deck(FICTITIOUS, dt=dt, e=e, end=float(end))
            still.append(abs(run[FORCE][-1] - MASS*GRAVITY) <= 1e-10)
            lowest = max(lowest, -run[GAP].min()/dt)
    checks.true(all(still), f'fictitious force: {sum(still)} of {len(still)} balls lie still')
    checks.at_most(lowest, 1.5*np.sqrt(2*GRAVITY*HEIGHT), 'fictitious force: largest overlap/dt')


def main():
    checks = Checks()
    for dt in (0.01, 0.001):
        for e in (0.5, 0.9):
            check_rest(checks, e, dt)
    for dt in (0.01, 0.007):
        check_for_ever(checks, dt)
    check_fictitious(checks)
    check_always_at_rest(checks)
    checks.finish()


if __name__ == '__main__':
    main()
