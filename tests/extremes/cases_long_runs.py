"""Long runs: round-off must not pile up, and the phase must be that of the scheme.

The trapezoidal rule keeps the energy of a free oscillator, and turns it by 2 atan(omega h/2) a
step instead of omega h.
"""
import sys

import numpy as np

from extreme_case import Case, main

OMEGA, STEP, ROWS = 2.0, 0.05, 1000


def oscillator(steps):
    """A free oscillator, omega = 2, from rest at 1."""
    return f"""*NODE
1, 0, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*ELEMENT, TYPE=SPRING1, ELSET=spring
2, 1
*MASS, ELSET=mass
1
*SPRING, ELSET=spring
1
{OMEGA**2!r}
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
1, 1, 1
*STEP, INC={steps}
*DYNAMIC, DIRECT
{STEP!r}, {STEP*steps!r}
*NODE PRINT, FREQUENCY={steps//ROWS}
U, V
*ENERGY PRINT, FREQUENCY={steps//ROWS}
*END STEP
"""


def check_oscillator(steps):
    """Displacement after every so many steps, energy."""
    def check(run, findings):
        n = np.arange(ROWS + 1)*(steps//ROWS)
        angle = 2*np.arctan(OMEGA*STEP/2)*n
        # the angle itself has its round-off: 1e-16 of it
        findings.close(run['history/node_1/U1'], np.cos(angle), 1e-8, 'displacement')
        findings.at_most(np.abs(run['energy/total']/(OMEGA**2/2) - 1).max(), 1e-10, 'energy')
        findings.close(run['history/time'], STEP*n, 1e-9*STEP*steps, 'time')
    return check


def free_oscillator(steps):
    """A case of so many steps."""
    return Case(f'free_oscillator_{steps:.0e}'.replace('e+0', 'e'), f'{steps} steps',
                oscillator(steps),
                'phase of the trapezoidal rule to 1e-8, energy to 1e-10', check_oscillator(steps),
                seconds=max(20, steps/20000))


if __name__ == '__main__':
    sys.exit(main([free_oscillator(10**6)], [free_oscillator(10**7)]))
