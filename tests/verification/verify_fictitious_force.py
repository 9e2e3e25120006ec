"""The fictitious-force method: reference values, restitution, iteration against direct solution."""
import numpy as np

from carom_case import INPUT, Checks, run_deck
from exact_solutions import oscillator

SDOF = (INPUT / 'sdof' / 'sdof.inp').read_text()
IMPACT = 'METHOD=TRANSFORMATION, RESTITUTION=<e>, BETA=1/6'
SOLUTIONS = ('ITERATION', 'DIRECT')

# d and v of the pure method at alpha = 0.3, beta = 1/4: the recurrence d1 = d~/(1 + h^2/4), below
# the wall (d1 - 0.5 alpha)/(1 + alpha), a1 = 4 (d1 - d~)/h^2, carried out with 40 digits.
REFERENCES = {
    0.01: {2.2: (-0.43416295437672, 0.90113110144985),
           4.0: (0.97620384982401, 0.21808433355499),
           8.0: (0.90977626197406, 0.42515589336732)},
    0.001: {4.0: (0.9868587997235, 0.18894026663868),
            8.0: (0.88711282553397, 0.37556013362839)}}

# five masses in a row on springs of their own and between each other, thrown at one wall
BLOCK = """*PARAMETER
alpha = 0.3
mid = 1
dt = 0.01
*NODE
1, 0, 1
2, 0, 2
3, 0, 3
4, 0, 4
5, 0, 5
*ELEMENT, TYPE=MASS, ELSET=masses
1, 1
2, 2
3, 3
4, 4
5, 5
*ELEMENT, TYPE=SPRING1, ELSET=ground
11, 1
12, 2
13, 3
14, 4
15, 5
*ELEMENT, TYPE=SPRING2, ELSET=between
21, 1, 2
22, 2, 3
23, 3, 4
24, 4, 5
*MASS, ELSET=masses
1
*SPRING, ELSET=ground
1
1
*SPRING, ELSET=between
1, 1
3
*SURFACE, NAME=block, TYPE=NODE
1, 2, 3, 4, 5
*RIGID SURFACE, NAME=wall, TYPE=PLANE
-0.5, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, METHOD=FICTITIOUS FORCE, RETURN=<alpha>, SOLUTION=WAY
*CONTACT PAIR, INTERACTION=hit
block, wall
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
1, 1, 1
2, 1, 1
3, 1, <mid>
4, 1, 1
5, 1, 1
*STEP
*DYNAMIC, DIRECT
<dt>, 8
*NODE PRINT
U, V
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
"""


def check_references(checks):
    for solution in SOLUTIONS:
        text = SDOF.replace(IMPACT, f'METHOD=FICTITIOUS FORCE, RETURN=0.3, SOLUTION={solution}')
        for h, values in REFERENCES.items():
            run = run_deck(text, dt=h, end=8.0)
            for t, (d, v) in values.items():
                i = round(t / h)
                checks.close([run['history/node_1/U1'][i], run['history/node_1/V1'][i]], [d, v],
                             1e-9, f'{solution}, h = {h}: d and v at t = {t}')
            if h == 0.01:
                release = run.events('release')['time']
                checks.true(len(release) == 2, f'{solution}: the contact ends twice, at {release}')


def check_restitution(checks):
    steps = 0.04 / 2.0 ** np.arange(6)
    for e in (0.0, 0.2, 0.6, 1.0):
        exact = oscillator(8.0, restitution=e)
        for alpha in (0.1, 0.3, 0.9):
            text = SDOF.replace(
                IMPACT,
                f'METHOD=FICTITIOUS FORCE, RETURN={alpha}, RESTITUTION=<e>, SOLUTION=DIRECT')
            errors, energies = [], []
            for h in steps:
                run = run_deck(text, e=e, dt=float(h), end=8.0)
                d, _ = exact.at(run['history/time'])
                errors.append(np.max(np.abs(run['history/node_1/U1'] - d)))
                if h <= 0.01:
                    total = run['energy/total']
                    energies.append(np.max(total) / total[0])
            order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
            name = f'e = {e}, alpha = {alpha}'
            checks.at_least(order, 0.7, f'{name}: order of the error {errors[-1]:.3g}')
            checks.at_most(max(energies), 1.01, f'{name}: energy over the initial one')
            checks.close(len(run.events()['time']), len(exact.impact_times), 0,
                         f'{name}, h = 0.00125: number of impacts')
            if (e, alpha) == (1.0, 0.3):
                checks.close(errors[-1], 7.6e-3, 5e-5, f'{name}: error at h = 0.00125')


def check_solutions(checks):
    """Same answer both ways; from 1 all masses hit at once, with one from 1.2 they do not."""
    for mid in (1.0, 1.2):
        for alpha in (0.1, 0.3, 0.9):
            runs = [run_deck(BLOCK.replace('WAY', way), mid=mid, alpha=alpha, dt=0.01)
                    for way in SOLUTIONS]
            for column in ('U1', 'V1'):
                values = [np.array([run[f'history/node_{i}/{column}'] for i in range(1, 6)])
                          for run in runs]
                checks.close(values[0], values[1], 1e-10,
                             f'five masses, one from {mid}, alpha = {alpha}: {column} both ways')
            rows = len(set(runs[0].events('contact')['node']))
            checks.true(rows == 5, f'five masses, one from {mid}: {rows} of them touch the wall')
            if mid == 1.0:
                one = run_deck(SDOF.replace(IMPACT, f'METHOD=FICTITIOUS FORCE, RETURN={alpha}'),
                               dt=0.01, end=8.0)
                checks.close(runs[1]['history/node_4/U1'], one['history/node_1/U1'], 1e-10,
                             f'five masses together, alpha = {alpha}: each as one alone')


checks = Checks()
check_references(checks)
check_restitution(checks)
check_solutions(checks)
checks.finish()
