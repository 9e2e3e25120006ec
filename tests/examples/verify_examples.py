"""Decks with the new names of src/README.md's examples, run by a program that has them."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'verification'))
from carom_case import INPUT, Checks, run_deck

CABLE = """*HEADING
A mass thrown against its cable, and away from it
*NODE
1, 0, 0
2, 1, 0
*ELEMENT, TYPE=CABLE, ELSET=rope
1, 1, 2
*SPRING, ELSET=rope{more}
{law}
*ELEMENT, TYPE=MASS, ELSET=mass
2, 2
*MASS, ELSET=mass
2
*BOUNDARY
1, 1
*INITIAL CONDITIONS, TYPE=VELOCITY
2, 1, 1.5
*STEP
*DYNAMIC, DIRECT{explicit}
{dt}, 1
*NODE PRINT
U, V
*ENERGY PRINT
*END STEP
"""
DAMAGE = """*HEADING
A square pulled at one side, back and further
*NODE
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
*ELEMENT, TYPE={type}, ELSET=square
1, 1, 2, 3, 4
*SOLID SECTION, ELSET=square, MATERIAL=brittle
1
*MATERIAL, NAME=brittle
*ELASTIC
20, 0.3
{cards}
*AMPLITUDE, NAME=path
0, 0, 1, 0.015, 2, 0.0075, 3, 0.025
*BOUNDARY
1, 1, 2
2, 2
4, 1
*STEP
*STATIC, DIRECT
0.05, 3
*BOUNDARY, AMPLITUDE=path
3, 2, 2, 1
4, 2, 2, 1
*NODE PRINT
U, RF
*EL PRINT
S, E
*ENERGY PRINT
*END STEP
"""
IMPULSE = (INPUT / 'sdof/sdof.inp').read_text().replace(
    'METHOD=TRANSFORMATION, RESTITUTION=<e>, BETA=1/6', 'METHOD=IMPULSE, RESTITUTION=<e>').replace(
    'end = 20', 'end = 3')


def check_cable(checks):
    """Half a sine while it is stretched, then free flight."""
    omega = 5.0
    for name, explicit, dt in (('implicit', '', 0.001), ('explicit', ', EXPLICIT', 0.0005)):
        run = run_deck(CABLE.format(more='', law='50', explicit=explicit, dt=dt))
        t = run['history/time']
        half = np.pi / omega
        exact = np.where(t < half, 1.5 / omega * np.sin(omega * t), -1.5 * (t - half))
        checks.close(run['history/node_2/U1'], exact, 1e-5, f'cable, {name}: displacement')
        checks.close(run['energy/total'], 2.25 + 0 * t, 5e-5, f'cable, {name}: energy')
    run = run_deck(CABLE.format(more=', NONLINEAR', law='0, 0\n1, 1', explicit='', dt=0.1),
                   expect_status=2)
    checks.true('a cable has a stiffness, not a table' in run.text, 'cable: a table is refused')


def check_damage(checks):
    """Two slopes, E and (1 - D1) E, and straight lines to the origin; plane stress."""
    for kind in ('CPS4', 'CPS4R'):
        run = run_deck(DAMAGE.format(type=kind, cards='*DAMAGE\n0.1, 0.8'))
        strain = run['history/node_3/U2']
        largest = np.maximum.accumulate(strain)
        secant = np.where(largest > 0.005, (0.1 + 4 * (largest - 0.005)) / np.maximum(largest, 1e-9),
                          20)
        checks.close(run['history/element_1/S22'], secant * strain, 1e-9, f'damage, {kind}: stress')
        checks.close(run['energy/plastic'][-1], 8e-4, 2e-5, f'damage, {kind}: energy lost')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-12,
                       f'damage, {kind}: balance error')
    for cards, message in (('*DAMAGE\n0.1, 1.2', 'limit of damage is out of range'),
                           ('*DAMAGE\n0.1, 0.5\n*PLASTIC\n1, 0', 'has *DAMAGE already')):
        run = run_deck(DAMAGE.format(type='CPS4', cards=cards), expect_status=2)
        checks.true(message in run.text, f'damage: {message}')


def check_impulse(checks):
    """First order: half the step, half the error, more or less; the error is of the size of h."""
    shift = 3 - 4 * np.pi / 3
    errors = []
    for dt in (0.004, 0.001):
        run = run_deck(IMPULSE, dt=dt)
        errors.append(abs(run['history/node_1/U1'][-1] - np.cos(shift)))
        checks.at_most(errors[-1], 3 * dt, f'impulse, h = {dt}: displacement error at t = 3')
        checks.true(len(run.events()['time']) == 1, f'impulse, h = {dt}: one impact')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-10,
                       f'impulse, h = {dt}: balance error')
    run = run_deck(IMPULSE.replace('RESTITUTION=<e>', 'RETURN=0.3'), expect_status=2)
    checks.true('RETURN means nothing with METHOD=IMPULSE' in run.text, 'impulse: RETURN is refused')


def main():
    checks = Checks()
    check_cable(checks)
    check_damage(checks)
    check_impulse(checks)
    checks.finish()


if __name__ == '__main__':
    main()
