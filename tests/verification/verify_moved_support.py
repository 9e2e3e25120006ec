"""A chain that hits its own support, which a table of accelerations moves: explicit steps follow the table less
exactly than the support does, so that what lets go may seem to come back at once. Nothing is to be hit for ever."""
import numpy as np

from carom_case import Checks, run_deck

CHAIN = """*NODE
1, 0, 0
2, 1, 0
3, 2, 0
9, -1, 0
*ELEMENT, TYPE=MASS, ELSET=masses
1, 1
2, 2
3, 3
*ELEMENT, TYPE=MASS, ELSET=support
4, 9
*MASS, ELSET=masses
2
*MASS, ELSET=support
0.5
*ELEMENT, TYPE=SPRING2, ELSET=springs
5, 9, 1
6, 1, 2
7, 2, 3
*SPRING, ELSET=springs
1, 1
300
*ELEMENT, TYPE=DASHPOT2, ELSET=dampers
8, 9, 1
9, 1, 2
*DASHPOT, ELSET=dampers
1, 1
3
*ELEMENT, TYPE=GAPUNI, ELSET=far
10, 3, 9
*ELEMENT, TYPE=GAPUNI, ELSET=near
11, 1, 2
*SURFACE INTERACTION, NAME=hit
*IMPACT
*GAP, ELSET=far, INTERACTION=hit
0.02, 1, 0, 0
*GAP, ELSET=near, INTERACTION=hit
0.03, 1, 0, 0
*AMPLITUDE, NAME=shake
0, 0, 0.13, 1, 0.37, -1.4, 0.61, 0.8
0.9, -0.3, 1.2, 0
*STEP
*DYNAMIC, DIRECT{}
0.005, 2
*BOUNDARY, TYPE=ACCELERATION, AMPLITUDE=shake
9, 1, 1, 4
*NODE PRINT
U
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
"""


def displacements(run):
    return np.array([run[f'history/node_{node}/U1'] for node in (1, 2, 3)])


checks = Checks()
exact = run_deck(CHAIN.format('').replace('0.005, 2', '0.0005, 2'))
scale = np.max(np.abs(displacements(exact)))
for name, options, limit in (('implicit', '', 4e-3), ('explicit', ', EXPLICIT', 8e-3)):
    run = run_deck(CHAIN.format(options))
    times = run['events/time']
    checks.at_most(np.max(np.unique(np.round(times, 9), return_counts=True)[1]), 6, f'{name}: events at one time')
    checks.at_most(len(run.events()['time']), 10, f'{name}: impacts')
    for pair in ('FAR', 'NEAR'):
        checks.at_least(np.min(run[f'history/contact_{pair}/CDIS']), -1e-12, f'{name}: smallest gap {pair}')
    checks.close(displacements(run) / scale, displacements(exact)[:, ::10] / scale, limit, f'{name}: motion')
checks.finish()
