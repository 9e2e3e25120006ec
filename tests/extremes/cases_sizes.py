"""A bar of a million elements hits a wall.

What a step brings about depends on its Courant number alone: the same steps of a bar of a
thousand elements give the same contact forces, as long as no wave has come to the other end.
"""
import re
import sys

import numpy as np

from extreme_case import Case, main

LENGTH, MODULUS, SPEED, STEPS, SMALL = 10.0, 900.0, 10.0, 10, 1000
COURANT = {'IMPLICIT': 2.0, 'EXPLICIT': 0.9}


def bar(n, scheme, steps=STEPS):
    """A bar of n trusses that flies to a wall two and a half steps away."""
    size = LENGTH/n
    h = COURANT[scheme]*size/np.sqrt(MODULUS)
    nodes = '\n'.join(f'{i + 1}, {i*size!r}, 0' for i in range(n + 1))
    elements = '\n'.join(f'{i}, {i}, {i + 1}' for i in range(1, n + 1))
    return f"""*NODE, NSET=all
{nodes}
*ELEMENT, TYPE=T2D2, ELSET=bar
{elements}
*MATERIAL, NAME=m
*ELASTIC
{MODULUS!r}
*DENSITY
1.
*SOLID SECTION, ELSET=bar, MATERIAL=m
1.
*ELEMENT GROUP, ELSET=bar, SCHEME={scheme}, MASS=LUMPED
*NSET, NSET=ends
1, {n + 1}
*SURFACE, NAME=tip, TYPE=NODE
1
*RIGID SURFACE, NAME=wall, TYPE=PLANE
{float(-2.5*h*SPEED)!r}, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=I
*IMPACT, METHOD=TRANSFORMATION, BETA=1/4
*CONTACT PAIR, INTERACTION=I
tip, wall
*INITIAL CONDITIONS, TYPE=VELOCITY
all, 1, {-SPEED!r}
*STEP
*DYNAMIC, DIRECT
{float(h)!r}, {float(steps*h)!r}
*NODE PRINT, NSET=ends
U, V
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
"""


def check_bar(n, scheme):
    """Forces as those of the short bar, energy, the free end, memory as `check` says."""
    def check(run, findings):
        force = run['history/contact_TIP-WALL/CF1']
        short = run.again(bar(SMALL, scheme))['history/contact_TIP-WALL/CF1']
        # positions of 1e-16 of the bar's length, beside what a node moves in a step
        rounding = 10*2.0**-52*LENGTH/(2.5*COURANT[scheme]*LENGTH/n/np.sqrt(MODULUS)*SPEED)
        findings.at_most(np.abs(force - short).max()/300, 1e-10 + rounding, 'force')
        energy = run['energy/total']
        lost = 0.5*0.5*LENGTH/n*SPEED**2
        if scheme == 'IMPLICIT':
            findings.close(energy[-1]/(energy[0] - lost), 1.0, 1e-11, 'energy')
        findings.close(run[f'history/node_{n + 1}/V1'], np.full(STEPS + 1, -SPEED), 1e-10,
                       'the free end flies on')
        said = run.again(bar(n, scheme), command='check', seconds=60)
        stated = 1e6*float(re.search(r'^memory: (\S+) MB', said.text, re.M).group(1))
        findings.close(stated/run.memory, 1.0, 0.1, 'memory stated over taken')
        findings.measured(f'force within {np.abs(force - short).max()/300:.1e}, memory '
                          f'{run.memory/1e6:.0f} MB, stated {stated/1e6:.0f} MB')
    return check


def case(n, scheme):
    """A case of n elements."""
    return Case(f'bar_{n:.0e}_{scheme.lower()}'.replace('e+0', 'e'), f'{n} elements, {STEPS} steps',
                lambda: bar(n, scheme), 'forces of 1000 elements, memory as check says',
                check_bar(n, scheme), seconds=120)


if __name__ == '__main__':
    sys.exit(main([case(10**6, 'IMPLICIT'), case(10**5, 'EXPLICIT')], [case(10**6, 'EXPLICIT')]))
