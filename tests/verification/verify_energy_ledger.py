"""Energies of contact where the time integration damps: what impacts and friction take is what the
kinetic energy loses, with every method, ALPHA and GAMMA, also where contact begins and ends."""
import numpy as np

from carom_case import Checks, run_deck

DECK = """*AMPLITUDE, NAME=comes, TIME=TOTAL TIME
0, 0, 2, 1
*NODE, NSET=all
1, 0, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*ELEMENT, TYPE=SPRING1, ELSET=loose
2, 1
3, 1
*MASS, ELSET=mass
2
*SPRING, ELSET=loose
1
0
*SURFACE, NAME=body, TYPE=NODE
1
*RIGID SURFACE, NAME=wall, TYPE=PLANE{wall}
-0.503, 0
1, 0
{moves}*SURFACE INTERACTION, NAME=hit
*IMPACT, METHOD={method}
{friction}*CONTACT PAIR, INTERACTION=hit
body, wall
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, -1
1, 2, {slide}
*STEP
*DYNAMIC, DIRECT{damped}
{h}, 1
*NODE PRINT
U, V
*CONTACT PRINT
CF
*ENERGY PRINT
*END STEP
"""
DAMPED = ('', ', ALPHA=-0.1', ', ALPHA=-0.3', ', GAMMA=0.7')
JUMPS = [('TRANSFORMATION, RESTITUTION=0.5', 0.5), ('TRANSFORMATION', 0), ('LAGRANGE', 0),
         ('FICTITIOUS FORCE, RESTITUTION=1', 1), ('FICTITIOUS FORCE, RESTITUTION=0.5', 0.5)]


def run(method, damped, h, **changes):
    """A mass of 2 that flies at 1 against a wall, without a spring behind it."""
    words = {'wall': '', 'moves': '', 'friction': '', 'slide': 0, **changes}
    return run_deck(DECK.format(method=method, damped=damped, h=h, **words))


def check_impact(checks):
    """The loss is (1 - e^2) m v^2/2 exactly, nothing is left over, and no warning says otherwise."""
    for method, e in JUMPS:
        for damped in DAMPED:
            for h in (0.01, 0.001):
                done = run(method, damped, h)
                label = f'{method}{damped}, h = {h}'
                checks.close(done['energy/impact_loss'][-1], 1 - e*e, 1e-11, label + ': loss')
                checks.at_most(np.abs(done['energy/balance_error']).max(), 1e-11,
                               label + ': balance')
                checks.true('has added' not in done.path.with_suffix('.log').read_text(),
                            label + ': no warning of a gain')


def check_springs(checks):
    """Springs of contact are elements: what ALPHA takes from them is left over, no loss of impacts.
    Where contact begins and ends inside an increment they give and take a little."""
    for damped in DAMPED:
        done = run('PENALTY, STIFFNESS=2000', damped, 0.002)
        taken = 1 - done['history/node_1/V1'][-1]**2
        checks.at_most(abs(done['energy/impact_loss'][-1]), 1e-3, 'PENALTY' + damped)
        checks.close(done['energy/balance_error'][-1] + taken, done['energy/impact_loss'][-1],
                     1e-11, f'PENALTY{damped}: the rest is left over')


def check_friction(checks):
    """A sliding hit: friction has mu times the impulse and takes what is lost along the wall,
    the impact what is lost across it."""
    for method in ('TRANSFORMATION', 'LAGRANGE', 'FICTITIOUS FORCE, RESTITUTION=0.5'):
        for damped in DAMPED:
            done = run(method, damped, 0.002, friction='*FRICTION\n0.2\n', slide=3)
            across, along = done['history/node_1/V1'][-1], done['history/node_1/V2'][-1]
            label = f'sliding hit, {method}{damped}'
            checks.close(done['energy/friction'][-1], 9 - along**2, 1e-11, label + ': friction')
            checks.close(done['energy/impact_loss'][-1], 1 - across**2, 1e-11, label + ': loss')
            if 'FICTITIOUS' not in method:   # whose jump at the end has no friction
                checks.close(along, 3 - 0.2*(1 + across), 1e-9, label + ': mu times the impulse')
            checks.at_most(np.abs(done['energy/balance_error']).max(), 1e-11, label + ': balance')


def check_wall(checks):
    """A wall that comes at 1/2: its work is its speed times the impulse 2 m (1 + 1/2)."""
    for damped in DAMPED:
        done = run('FICTITIOUS FORCE, RESTITUTION=1', damped, 0.002, wall=', AMPLITUDE=comes',
                   moves='1, 0, 0, 1\n')
        checks.close(done['energy/external_work'][-1], 3, 1e-9, f'moving wall{damped}: work')
        checks.at_most(np.abs(done['energy/balance_error']).max(), 1e-9, f'moving wall{damped}')


def main():
    checks = Checks()
    check_impact(checks)
    check_springs(checks)
    check_friction(checks)
    check_wall(checks)
    checks.finish()


if __name__ == '__main__':
    main()
