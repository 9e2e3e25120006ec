"""Two buildings that pound in an earthquake: input/buildings against integration by SciPy."""
import importlib.util
import re

import numpy as np
from scipy.integrate import solve_ivp

from carom_case import INPUT, Checks, run_deck

FOLDER = INPUT / 'buildings'
DECK = FOLDER / 'buildings.inp'
NODES = [11, 12, 13, 21, 22, 23, 24, 25]
MASS, E, CLEARANCE = 3e5, 0.65, 0.03
STIFFNESS, DAMPING = (3.74e8, 1.80e8), (2.38e6, 2.58e6)
PAIRS = [(0, 3), (1, 4), (2, 5)]
GAP = 'history/contact_FLOORS/CDIS'


def chain(n, k):
    """The stiffness of n storeys with springs k, the first on the ground."""
    above = np.diag(np.full(n - 1, k), 1)
    matrix = 2*np.diag(np.full(n, k)) - above - above.T
    matrix[-1, -1] = k
    return matrix


def both(values):
    """The matrix of both buildings."""
    matrix = np.zeros((8, 8))
    matrix[:3, :3], matrix[3:, 3:] = chain(3, values[0]), chain(5, values[1])
    return matrix


def ground():
    """Times and accelerations of the ground, read from the deck's file."""
    text = (FOLDER/'ground.inc').read_text().split('NAME=ground\n')[1]
    values = np.array([float(word) for word in re.split(r'[,\s]+', text) if word])
    return values[::2], values[1::2]


def integrate(end):
    """Displacements at multiples of 0.02 up to `end`, and the impacts, by SciPy."""
    k, c = both(STIFFNESS)/MASS, both(DAMPING)/MASS
    times, accelerations = ground()

    def slope(t, y, t0, a0, rise):
        a = -(a0 + (t - t0)*rise) - k @ y[:8] - c @ y[8:]
        return np.concatenate((y[8:], a))

    def gap_of(left, right):
        def gap(t, y, *_):
            return CLEARANCE + y[right] - y[left]
        gap.terminal, gap.direction = True, -1
        return gap

    gaps = [gap_of(*pair) for pair in PAIRS]
    y, history, impacts = np.zeros(16), [np.zeros(8)], []
    for i in range(int(round(end/0.02))):
        t, rise = times[i], (accelerations[i + 1] - accelerations[i])/0.02
        while t < times[i + 1]:
            found = solve_ivp(slope, (t, times[i + 1]), y, method='DOP853', rtol=1e-10, atol=1e-13,
                              events=gaps, args=(times[i], accelerations[i], rise), max_step=0.005)
            t, y = found.t[-1], found.y[:, -1]
            for (left, right), hit in zip(PAIRS, found.t_events):
                if not len(hit):
                    continue
                rate = y[8 + right] - y[8 + left]
                impacts.append((t, NODES[right], rate))
                y[8 + left] += (1 + E)*rate/2
                y[8 + right] -= (1 + E)*rate/2
                y[right] = y[left] - CLEARANCE + 1e-15    # open by round-off: no second event
        history.append(y[:8].copy())
    return np.array(history), impacts


def peak(u):
    """The largest size of a curve, of the parabola through the three points around it."""
    i = np.abs(u).argmax()
    if i in (0, len(u) - 1):
        return np.abs(u[i])
    before, middle, after = np.abs(u[i - 1:i + 2])
    bend = before - 2*middle + after
    return middle - (after - before)**2/(8*bend) if bend < 0 else middle


def displacements(run):
    return np.array([run[f'history/node_{node}/U1'] for node in NODES]).T


def check_balance(checks, run):
    """Energy, gaps, the law of restitution and the impulse of every impact."""
    scale = max(run['energy/total'].max(), run['energy/external_work'].max())
    checks.at_most(np.abs(run['energy/balance_error']).max()/scale, 1e-9,
                   'energy balance error, of the largest energy')
    checks.at_least(run[GAP].min(), -1e-9, 'smallest gap')
    impacts, captures = run.events('impact'), run.events('capture')
    count = len(impacts['time'])
    checks.at_least(count, 4, 'impacts')
    print(f'        floors hit: {dict(zip(*np.unique(impacts["node"], return_counts=True)))}, '
          f'captures {len(captures["time"])}')
    checks.true(len(np.unique(impacts['node'])) >= 2, 'more than one floor is hit')
    captured = np.isin(impacts['time'], captures['time'])
    before, after = impacts['gap_rate_before'], impacts['gap_rate_after']
    checks.true((before < 0).all(), 'gaps close before every impact')
    checks.close(after[~captured], -E*before[~captured], 1e-12,
                 f'rate after is -e times rate before in {np.sum(~captured)} impacts')
    checks.close(after[captured], np.zeros(captured.sum()), 1e-12, 'rate after is 0 in captures')
    checks.close(impacts['impulse'], MASS/2*(after - before), 1e-6,
                 'impulse is half the mass times the change of rate')
    loss = MASS/4*(before**2 - after**2)
    checks.close(run['energy/impact_loss'][-1]/loss.sum(), 1.0, 1e-7,
                 'energy lost in impacts is that of the events')


def check_momentum(checks):
    """Two storeys that fly freely into each other, one three times as heavy."""
    run = run_deck("""*NODE
1, 0, 0
2, 1, 0
*ELEMENT, TYPE=MASS, ELSET=light
1, 1
*ELEMENT, TYPE=MASS, ELSET=heavy
2, 2
*ELEMENT, TYPE=GAPUNI, ELSET=gap
3, 1, 2
*MASS, ELSET=light
3e5
*MASS, ELSET=heavy
9e5
*SURFACE INTERACTION, NAME=pounding
*IMPACT, RESTITUTION=0.65, BETA=1/4
*GAP, ELSET=gap, INTERACTION=pounding
0.03
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, 0.5
2, 1, -0.25
*STEP
*DYNAMIC, DIRECT
0.007, 0.1
*NODE PRINT
U, V
*END STEP
""")
    light, heavy = run['history/node_1/V1'], run['history/node_2/V1']
    exchanged = 3e5*(light[-1] - light[0]), 9e5*(heavy[-1] - heavy[0])
    checks.close(exchanged[0], -exchanged[1], 1e-10*3e5, 'momentum goes over equal and opposite')
    checks.close(heavy[-1] - light[-1], 0.65*0.75, 1e-12, 'and they part with e times their speed')
    checks.close(exchanged[0], -1.65*0.75*3e5*0.75, 1e-6, 'momentum that the light one loses')
    checks.close(run.events()['time'], 0.04, 1e-12, 'time of the impact')


def check_convergence(checks):
    """Displacements and impact times against SciPy: of second order in the step."""
    end = 2.6
    exact, impacts = integrate(end)
    times = np.array([impact[0] for impact in impacts])
    print(f'        impacts by SciPy: {times}')
    checks.at_least(len(impacts), 3, 'impacts compared')
    steps = np.array([0.005, 0.0025, 0.00125, 0.000625])
    errors, time_errors, peaks = [], [], []
    for dt in steps:
        run = run_deck(DECK, dt=float(dt), end=end)
        stride = int(round(0.02/dt))
        errors.append(np.abs(displacements(run)[::stride] - exact).max())
        mine = run.events('impact')
        same = list(mine['node'][:3]) == [impact[1] for impact in impacts[:3]]
        checks.true(same, f'dt = {dt}: the first three impacts are at the same floors')
        time_errors.append(np.abs(mine['time'][:3] - times[:3]).max())
        flight = run['history/time'] < 1.8 + 1e-9
        peaks.append([peak(u) for u in displacements(run)[flight].T])
    rates = np.log2(np.array(errors[:-1])/errors[1:])
    print(f'        largest errors of displacement {np.array(errors)}, rates {rates}')
    print(f'        largest errors of impact time {np.array(time_errors)}')
    checks.close(rates[-1], 2.0, 0.2, f'order of the displacements {rates[-1]:.3f}')
    order = np.log2(time_errors[-2]/time_errors[-1])
    checks.close(order, 2.0, 0.3, f'order of the impact times {order:.3f}')
    checks.at_most(errors[0], 0.02*np.abs(exact).max(), 'dt = 0.005: error of the displacements')
    change = np.abs(np.diff(peaks, axis=0)).max(axis=1)
    rates = np.log2(change[:-1]/change[1:])
    print(f'        changes of the peaks {change}, rates {rates}')
    checks.close(rates, np.full(2, 2.0), 0.2,
                 'order of the peak displacements before the first impact')


def check_record(checks):
    """ground.inc is what make_ground.py writes."""
    spec = importlib.util.spec_from_file_location('make_ground', FOLDER/'make_ground.py')
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    t, a = script.record(4)
    times, accelerations = ground()
    checks.close(times, t, 1e-9, 'times of the ground record')
    checks.close(accelerations, a, 1e-6, 'ground record, made again')
    checks.close(np.abs(accelerations).max(), 0.35*9.81, 1e-5, 'largest ground acceleration')


def check_periods(checks):
    """The buildings have the periods and damping that the deck states."""
    for n, k, c, period in ((3, STIFFNESS[0], DAMPING[0], 0.4), (5, STIFFNESS[1], DAMPING[1], 0.9)):
        omega = np.sqrt(np.linalg.eigvalsh(chain(n, k))[0]/MASS)
        checks.close(2*np.pi/omega, period, 0.005, f'{n} storeys: period {2*np.pi/omega:.4f}')
        checks.close(c/k*omega/2, 0.05, 0.001, f'{n} storeys: damping {c/k*omega/2:.4f}')


def main():
    checks = Checks()
    check_periods(checks)
    check_record(checks)
    check_balance(checks, run_deck(DECK))
    check_momentum(checks)
    check_convergence(checks)
    checks.finish()


if __name__ == '__main__':
    main()
