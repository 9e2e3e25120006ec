"""Blocks on rough planes, balls that bounce obliquely: input/sliding_block, input/oblique_ball."""
import math

import numpy as np

from carom_case import Checks, run_deck
from contact_case import Folder
from contact_solutions import oblique_bounce, slope_acceleration, stopping

block, ball = Folder('sliding_block', 'make_block'), Folder('oblique_ball', 'make_ball')
GRAVITY = 9.81


def centre(contact, name='U'):
    """Mean displacement or velocity (frames, 2)."""
    mass = contact.masses()
    return np.einsum('n,fnx->fx', mass, contact.frames(name)[..., :2]) / mass.sum()


def check_stop(checks):
    """A block slides to rest after v0^2 / (2 mu g)."""
    for friction in (0.3, 0.5):
        contact = block.run('sliding.inp', mu=friction)
        distance, stop = stopping(5.0, friction, GRAVITY)
        path = centre(contact)[:, 0]
        speed = centre(contact, 'V')[-1, 0]
        print(f'        mu = {friction}: stops after {path[-1]:.6f} (exact {distance:.6f}), left '
              f'speed {speed:.2g}, energy dissipated {contact.run["energy/friction"][-1]:.5f} '
              f'(exact {2 * 12.5:.5f})')
        checks.close(path[-1] / distance, 1.0, 5e-4, f'mu = {friction}: stopping distance')
        checks.at_most(abs(speed), 1e-3, f'mu = {friction}: speed after the stop')
        checks.at_most(contact.balance / 25, 1e-6, f'mu = {friction}: balance of energy')


def check_slope(checks):
    """Below arctan mu a block sticks, above it slides with g (sin - mu cos)."""
    angle = math.radians(block.make.ANGLE)
    limit = math.tan(angle)
    down = np.array([math.cos(angle), -math.sin(angle)])
    for friction in (0.3, 0.5, 1.05 * limit, 2.0 * limit):
        contact = block.run('slope.inp', mu=float(friction))
        path, speed = centre(contact) @ down, centre(contact, 'V') @ down
        exact = slope_acceleration(angle, friction, GRAVITY)
        times = contact.run['VTKHDF/Steps/Values']
        late = times >= 0.5
        if exact > 0:
            found = np.polyfit(times[late], speed[late], 1)[0]
            print(f'        slope, mu = {friction:.4f}: acceleration {found:.6f}, exact {exact:.6f}')
            checks.close(found / exact, 1.0, 5e-4, f'slope, mu = {friction:.4f}: acceleration')
        else:
            print(f'        slope, mu = {friction:.4f}: moves by {path[-1]:.3g}, speed '
                  f'{np.abs(speed[late]).max():.3g}')
            checks.at_most(np.abs(speed[-1]), 1e-3, f'slope, mu = {friction:.4f}: it sticks')
            checks.at_most(np.abs(path[-1] - path[late][0]), 1e-4,
                           f'slope, mu = {friction:.4f}: it stays')


def check_flutter(checks):
    """Without damping an elastic block flutters: the force swings more and more."""
    make = block.make
    swing = []
    for damping in (0.0, 0.3):
        deck = make.deck('flutter', '*INCLUDE, INPUT=flat.inc\n',
                         'mu = 0.3\ndt = 1e-3\nend = 0.6\nspeed = 5\n', damping=damping,
                         velocity='*INITIAL CONDITIONS, TYPE=VELOCITY\nblock, 1, <speed>\n')
        contact = block.run(deck)
        late = contact.time > 0.3
        swing.append(contact.force[late, 1].std() / (2 * GRAVITY))
    print(f'        deviation of the normal force: {swing[0]:.3%} undamped, {swing[1]:.3%} damped')
    checks.at_least(swing[0], 0.1, 'without damping the block flutters')
    checks.at_most(swing[1], 0.01, 'with damping it does not')


def check_point(checks):
    """One mass with restitution: velocities after the blow, sliding and stopped."""
    for across in (2.0, 0.3):
        contact = ball.run('point.inp', across=across)
        v = [contact.run[f'history/node_1/V{i}'] for i in (1, 2)]
        exact = oblique_bounce(across, -1.0, 0.3, 0.8)
        checks.close([v[0][-1], v[1][-1]], exact, 1e-12, f'point, {across} across: velocities after')
        impulse = 2 * (np.array([v[0][-1], v[1][-1]]) - (across, -1.0))
        checks.at_most(abs(impulse[0]), 0.3 * impulse[1] * (1 + 1e-12),
                       f'point, {across} across: tangential impulse in the cone')


def check_ball(checks):
    """An elastic ball: its tangential impulse is at most mu times the normal one, equal to it while
    it slides; it spins as that impulse times its radius demands."""
    for friction in (0.1, 0.2, 0.8):
        contact = ball.run('elastic.inp', mu=friction)
        total = contact.momentum()[0]
        gained = total[-1] - total[0]
        print(f'        ball, mu = {friction}: impulses {gained[0]:.6f} {gained[1]:.6f}, ratio '
              f'{abs(gained[0]) / gained[1]:.6f}, energy {contact.energy[-1] / contact.energy[0]:.5f}')
        # a node that is captured is held for an instant also where it pulls: what it pulls counts in
        # the normal impulse (some 1e-5 of it) and has no friction
        checks.at_most(abs(gained[0]), friction * gained[1] * (1 + 1e-4),
                       f'ball, mu = {friction}: tangential impulse at most mu times the normal one')
        if friction < 0.2:
            checks.close(abs(gained[0]) / gained[1], friction, 1e-5,
                         f'ball, mu = {friction}: it slides all the time')
        checks.at_most(contact.energy.max() / contact.energy[0], 1 + 1e-9,
                       f'ball, mu = {friction}: largest energy')
        force = contact.force
        checks.at_most(np.max(np.abs(force[:, 0]) - friction * force[:, 1]),
                       1e-9 * force[:, 1].max(), f'ball, mu = {friction}: forces in the cone')


def check_oscillator(checks):
    """A mass alone on a spring and a rough plane: every half swing is shorter by 2 mu m g / k."""
    run = run_deck('*NODE\n1, 1, 0\n*ELEMENT, TYPE=MASS, ELSET=m\n1, 1\n*MASS, ELSET=m\n2\n'
                   '*ELEMENT, TYPE=SPRING1, ELSET=s\n2, 1\n*SPRING, ELSET=s\n1\n100\n'
                   '*SURFACE, NAME=b, TYPE=NODE\n1\n*RIGID SURFACE, NAME=f, TYPE=PLANE\n0, 0\n0, 1\n'
                   '*SURFACE INTERACTION, NAME=i\n*IMPACT\n*FRICTION\n0.1\n'
                   '*CONTACT PAIR, INTERACTION=i\nb, f\n'
                   '*INITIAL CONDITIONS, TYPE=DISPLACEMENT\n1, 1, 0.215\n*STEP\n*DYNAMIC, DIRECT\n'
                   '0.005, 8\n*DLOAD\n, GRAV, 9.81, 0, -1, 0\n*NODE PRINT\nU, V\n*END STEP\n')
    t, u = run['history/time'], run['history/node_1/U1']
    shift, half = 0.1*2*9.81/100, np.pi/np.sqrt(50)
    n = np.floor(t/half)
    centre, size = shift*(-1)**n, 0.215 - (2*n + 1)*shift
    exact = centre + (-1)**n*size*np.cos(np.sqrt(50)*(t - n*half))
    moving = size > shift
    checks.close(u[moving], exact[moving], 2e-3, 'an oscillator on a rough plane: displacement')
    rest = 0.215 - 2*np.ceil((0.215 - shift)/(2*shift))*shift
    checks.close(np.abs(u[-1]), abs(rest), 1e-3, 'an oscillator on a rough plane: where it stops')


checks = Checks()
block.check(checks)
ball.check(checks)
check_stop(checks)
check_slope(checks)
check_flutter(checks)
check_point(checks)
check_ball(checks)
check_oscillator(checks)
checks.finish()
