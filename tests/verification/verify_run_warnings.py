"""What a run itself shows to be doubtful brings a warning with the figure and the cure at its end:
rotations and strains too large for small displacements, contact that adds energy, inertia that the
reactions at a driven node lack. Below the limits there is none."""
import math
import re

from carom_case import INPUT, Checks, run_deck

checks = Checks()

PENDULUM = """*NODE
1, 0., 0.
2, 1., 0.
*ELEMENT, TYPE={kind}, ELSET=ROD
1, 1, 2
*ELEMENT, TYPE=MASS, ELSET=BOB
2, 2
*MASS, ELSET=BOB
2.
{section}
*BOUNDARY
1, 1, 2
*STEP
*DYNAMIC, DIRECT
0.001, {end}
*DLOAD
, GRAV, 9.81, 0., -1.
*NODE PRINT
U
*END STEP
"""
TRUSS = ('*MATERIAL, NAME=M\n*ELASTIC\n1e6\n*DENSITY\n0.1\n'
         '*SOLID SECTION, ELSET=ROD, MATERIAL=M\n0.01')
SPRING = '*SPRING, ELSET=ROD\n1e4'

BLOCK = """*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE=CPE4, ELSET=B
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1e6, 0.3
*DENSITY
1.
*SOLID SECTION, ELSET=B, MATERIAL=M
1.
{support}
*INITIAL CONDITIONS, TYPE=VELOCITY
{speeds}
*STEP
*DYNAMIC, DIRECT
1e-5, {end}
*NODE PRINT
U
*END STEP
"""
SPIN = '2, 2, 1.\n3, 1, -1.\n3, 2, 1.\n4, 1, -1.'   # one rad in a time of one, about node 1

BALL = """*NODE
1, 0., 1.
*ELEMENT, TYPE=MASS, ELSET=A
1, 1
*MASS, ELSET=A
2.
*SURFACE, NAME=B, TYPE=NODE
1
*RIGID SURFACE, NAME=F, TYPE=PLANE
0., 0.
0., 1.
*SURFACE INTERACTION, NAME=I
*IMPACT, METHOD=PENALTY, STIFFNESS=1e6
*CONTACT PAIR, INTERACTION=I
B, F
*STEP
*DYNAMIC, DIRECT
{dt}, 2.
*DLOAD
, GRAV, 9.81, 0., -1.
*NODE PRINT
U
*ENERGY PRINT
*END STEP
"""


def warned(deck, start):
    """The warnings of a run that hold some words, each with its time and its cure."""
    run = run_deck(deck)
    log = run.path.with_suffix('.log').read_text()
    found = re.findall(r'^warning \(at t = (\S+)\): (.*)\n  (cure: .*)$', log, re.MULTILINE)
    return [one for one in found if start in one[1]], run


# a rod held at one end falls from the horizontal: by g t^2/2 of its length, pi/8 of a turn is enough
for kind, section in (('T2D2', TRUSS), ('SPRINGA', SPRING)):
    found, _ = warned(PENDULUM.format(kind=kind, section=section, end=1.0), 'turns by up to')
    checks.true(len(found) == 1 and 'element 1' in found[0][1] and 'large rotations' in found[0][2],
                f'{kind}: a pendulum is warned of')
    if found:
        checks.close(float(found[0][1].split('up to ')[1].split(' rad')[0]), 9.81/2.0, 0.05,
                     f'{kind}: rotation, the fall by the length')
        checks.close(float(found[0][0]), math.sqrt(0.5/9.81), 0.022, f'{kind}: time of a rotation of 1/4')
    found, _ = warned(PENDULUM.format(kind=kind, section=section, end=0.2), 'turns by up to')
    checks.true(not found, f'{kind}: no warning of a rotation of 0.196')

# a block that spins: on a support from 1/4 on, in free flight from 1 on
for support, end, expected in (('*BOUNDARY\n1, 1, 2', 0.3, True), ('*BOUNDARY\n1, 1, 2', 0.2, False),
                               ('', 0.3, False), ('', 1.1, True)):
    found, _ = warned(BLOCK.format(support=support, end=end, speeds=SPIN), 'turns by up to')
    checks.true(bool(found) == expected,
                f'a block {"held at a corner" if support else "that flies"} turns by {end}')
    if found:
        checks.close(float(found[0][1].split('up to ')[1].split(' rad')[0]), end, 0.03*end,
                     f'a block that turns by {end}: the figure')

# a block pressed together
for speed, expected in ((1400.0, True), (300.0, False)):
    found, run = warned(BLOCK.format(support='*BOUNDARY\n1, 1\n4, 1\nALL, 2', end=0.01,
                                     speeds=f'2, 1, -{speed}\n3, 1, -{speed}'), 'the strain of')
    largest = abs(run['history/node_2/U1']).max()
    checks.true(bool(found) == expected == (largest > 0.5), f'a strain of {largest:.2f}')

# penalty: energy from nothing
found, run = warned(BALL.format(dt=0.01), 'contact has added')
checks.true(len(found) == 1 and 'smaller step' in found[0][2] and 'TRANSFORMATION' in found[0][2],
            'penalty with a large step: warned of')
if found:
    figure = float(found[0][1].split('energy ')[1].split(',')[0])
    checks.close(figure, -run['energy/impact_loss'][-1], 0.005*figure, 'penalty: the energy added')
found, _ = warned(BALL.format(dt=4e-4), 'contact has added')
checks.true(not found, 'penalty that is resolved: no warning')

# the decks that turn and strain most are within the limits
for name in ('dropped_disc/q4', 'bar/bar_explicit', 'bar/bar_fictitious'):
    log = run_deck(INPUT/f'{name}.inp').path.with_suffix('.log').read_text()
    checks.true('warning' not in log and 'completed' in log, f'{name}: no warning in its run')
checks.finish()
