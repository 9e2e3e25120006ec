"""Steps far from any that one would choose: Omega = omega h from 1e-12 to 1e8, one step for all.

Free motion is compared with the trapezoidal rule in 60 digits. The return parameter of the
fictitious force is taken to both its ends; its reference is the equation of one step.
"""
import sys
from decimal import Decimal, getcontext

import numpy as np

from extreme_case import Case, Group, main
from point_decks import CONTACT_PRINTS, Points, step

getcontext().prec = 60
PERIOD = 2*np.pi
DYNAMIC = 'DYNAMIC, DIRECT'
SUBSTEP = 'METHOD=TRANSFORMATION, RESTITUTION=1, BETA=1/4'
METHODS = (SUBSTEP, 'METHOD=TRANSFORMATION, RESTITUTION=0.6', 'METHOD=TRANSFORMATION',
           'METHOD=TRANSFORMATION, RESTITUTION=1, EVENTS=ANCHOR', 'METHOD=FICTITIOUS FORCE',
           'METHOD=FICTITIOUS FORCE, RESTITUTION=1', 'METHOD=LAGRANGE',
           'METHOD=PENALTY, STIFFNESS=100')
WALL = -0.5


def short(method):
    """A method as part of a name."""
    return method[7:].replace(', ', '_').replace('=', '').replace(' ', '_').lower()


# Free motion ------------------------------------------------------------------------------------

def trapezoidal(omega2, h, d, v, steps):
    """Displacements and velocities of an oscillator with 60 digits."""
    omega2, h, d, v = (Decimal(x) for x in (omega2, h, d, v))
    b, a, rows = h*h/4, -omega2*d, [(d, v)]
    for _ in range(steps):
        ahead = d + h*v + b*a
        new = -omega2*ahead/(1 + b*omega2)
        d, v, a = ahead + b*new, v + h/2*(a + new), new
        rows.append((d, v))
    return np.array(rows, dtype=float).T


def free(big_omega, d0, v0, steps=300):
    """An oscillator of unit amplitude at Omega = omega h."""
    omega = 1.3 if big_omega < 1 else big_omega
    h = big_omega/omega
    deck = Points([1.0]).ground(1, omega**2).start({1: d0}, {1: v0*omega}).deck(
        step(DYNAMIC, (h, steps*h)))

    def check(run, findings):
        d, v = trapezoidal(omega**2, h, d0, v0*omega, steps)
        findings.at_most(np.abs(run['history/node_1/U1'] - d).max(), 1e-12, 'displacement')
        findings.at_most(np.abs(run['history/node_1/V1'] - v).max()/omega, 1e-12, 'velocity')
        energy = run['energy/total']
        findings.at_most(np.abs(energy/energy[0] - 1).max(), 1e-12, 'energy')
    return Case(f'free_{big_omega:g}_{d0:g}_{v0:g}', '', deck, '', check)


FREE = [free(big_omega, d0, v0) for big_omega in (1e-12, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e8)
        for d0, v0 in ((1.0, 0.0), (0.0, 1.0), (0.6, -0.8))]


# With a wall ------------------------------------------------------------------------------------

def oscillator(method, start, *steps):
    """m = k = 1 with a wall at -0.5."""
    return Points([1.0], [0.0]).ground(1, 1).impact(method).wall(1, WALL).start(*start).deck(*steps)


def tiny(method):
    """h = 1e-12 periods: the wall is three steps away; after the hit the speed is e v."""
    h = 1e-12*PERIOD
    deck = oscillator(method, ({1: WALL + 3*h}, {1: -1.0}),
                      step(DYNAMIC, (h, 100*h), prints=CONTACT_PRINTS))

    def check(run, findings):
        v, d = run['history/node_1/V1'], run['history/node_1/U1']
        # places are known to 1e-16, speeds from them to 1e-16/h
        rounding = 4*2.0**-54/h
        if 'PENALTY' in method:
            findings.close(v[-1], -1.0, 1e-6, 'a soft spring has had no time to work')
            return
        e = 0.6 if '0.6' in method else 1.0 if 'RESTITUTION' in method else 0.0
        if method == 'METHOD=FICTITIOUS FORCE':
            findings.close(abs(v[-1]), 1.0, 0.1, 'speed after, which scatters')
        else:
            findings.close(v[-1], e, rounding + 1e-9, 'speed after')
        lowest = -0.02*h if 'TRANS' in method or 'LAGR' in method else -1.1*h
        findings.at_least(d.min() - WALL, lowest - 2e-16, 'overlap')
        work = 0 if 'TRANS' in method else rounding
        findings.at_most(np.abs(run['energy/balance_error']).max(), 1e-13 + work, 'balance')
    return Case(f'tiny_{short(method)}', '', deck, '', check)


def huge(method, steps, factor=1e6):
    """h = 1e6 periods: the trapezoidal rule turns the phase by half a period a step."""
    h = factor*PERIOD
    deck = oscillator(method, ({1: 0.3}, {1: -1.0}),
                      step(DYNAMIC, (h, steps*h), prints=CONTACT_PRINTS))
    if 'ANCHOR' in method:
        return Case(f'huge_{short(method)}_{steps}', '', deck, '', status=4,
                    words=('EVENTS=ANCHOR has made the energy', 'until time', 'step is too long'))

    def check(run, findings):
        d, v = trapezoidal(1, h, 0.3, -1.0, steps)
        findings.close(run['history/node_1/U1'], d, 1e-8, 'displacement')
        findings.close(run['history/node_1/V1'], v, 1e-12, 'velocity')
        findings.at_most(np.abs(run['energy/total']/0.545 - 1).max(), 1e-12, 'energy')
    return Case(f'huge_{short(method)}_{steps}', '', deck, '', check)


def stiff_at_wall(big_omega, method=SUBSTEP):
    """A stiff mode at Omega beside the soft one that hits the wall: two masses, node 2 hits.

    The impact leaves the stiff spring strained by 4 h v/Omega^2, and round-off of the places, eps d,
    is a part of that: such a part of the energy may come and go in every step.
    """
    h = 0.02
    stiff = (big_omega/h)**2/2
    deck = Points([1.0, 1.0], [0.0, 0.0]).ground(1, 1.0).link(1, 2, stiff).impact(method).wall(
        2, WALL).start({1: 1.0, 2: 1.0}).deck(step(DYNAMIC, (h, 6.0), prints=CONTACT_PRINTS))

    def check(run, findings):
        energy = run['energy/total']
        part = 2.0**-53*0.5*big_omega**2/(4*h*0.87)
        findings.at_most(np.abs(energy/energy[0] - 1).max(), 10*part*np.sqrt(6.0/h), 'energy')
        findings.at_least(run['history/node_2/U1'].min() - WALL, -1e-9, 'gap')
    return Case(f'stiff_{big_omega:g}_{short(method)}', '', deck, '', check)


# Ends of the return parameter -------------------------------------------------------------------

def pulled_back(alpha, h, end):
    """Displacements by the pure fictitious force: d = (d_free + alpha r)/(1 + alpha) in overlap."""
    d, v, a, rows = 1.0, 0.0, -1.0, [1.0]
    for _ in range(round(end/h)):
        ahead = d + h*v + h*h/4*a
        at = ahead/(1 + h*h/4)
        if at < WALL:
            at = (at + alpha*WALL)/(1 + alpha)
        new = (at - ahead)/(h*h/4)
        d, v, a = at, v + h/2*(a + new), new
        rows.append(d)
    return np.array(rows)


def returned(alpha, solution, h, end):
    """The pure iteration, and its fixed point solved for at once."""
    method = f'METHOD=FICTITIOUS FORCE, RETURN={alpha!r}, SOLUTION={solution}'
    deck = oscillator(method, ({1: 1.0},), step(DYNAMIC, (h, end), prints=CONTACT_PRINTS))

    def check(run, findings):
        exact = pulled_back(alpha, h, end)
        # round-off of the reference, which divides by h^2, and the tolerance of the iteration
        findings.close(run['history/node_1/U1'], exact, 1e-8, 'displacement')
        findings.at_most(np.abs(run['energy/balance_error']).max(), 1e-10, 'balance')
    return Case(f'return_{alpha:g}_{solution.lower()}_{h:g}', '', deck, '', check, seconds=30)


def returned_with_e(alpha, solution, e):
    """With restitution: the energy is never more than the first order of the method allows."""
    method = f'METHOD=FICTITIOUS FORCE, RETURN={alpha!r}, SOLUTION={solution}, RESTITUTION={e}'
    h = 0.002
    deck = oscillator(method, ({1: 1.0},), step(DYNAMIC, (h, 20.0), prints=CONTACT_PRINTS))

    def check(run, findings):
        energy = run['energy/total']
        findings.at_most(energy.max()/0.5, 1 + 2*h, 'largest energy')
        if alpha > 0.9:
            t = run['history/time']
            between = energy[(t > 3.0) & (t < 5.0)]
            # what is left: k r^2/2 at the wall and e^2 of the kinetic energy there
            left = 0.125 + e*e*0.375
            findings.at_most(np.abs(between/left - 1).max(), 4*h, 'energy after the first hit')
            findings.at_least(run['history/node_1/U1'].min() - WALL, -2*h, 'overlap')
    return Case(f'return_{alpha:g}_{solution.lower()}_e{e:g}', '', deck, '', check, seconds=30)


RETURN = [returned(alpha, solution, h, 8.0) for alpha in (1e-6, 1 - 1e-6)
          for solution in ('ITERATION', 'DIRECT') for h in (0.01, 0.1)]
RETURN += [returned_with_e(alpha, solution, e) for alpha in (1e-6, 1 - 1e-6)
           for solution in ('ITERATION', 'DIRECT') for e in (1, 0.5)]


# Few steps --------------------------------------------------------------------------------------

TIMES = {'one': ((1.0, 1.0), [1.0]), 'long': ((20.0, 20.0), [20.0]),
         'last_shorter': ((0.3, 1.0), [0.3, 0.6, 0.9, 1.0]),
         'hair_longer': ((1.0, 1.0 + 1e-12), [1.0 + 1e-12]),
         'hair_left': ((1.0, 1.0 + 1e-6), [1.0, 1.0 + 1e-6]),
         'hair_short': ((0.1, 0.3 - 1e-15), [0.1, 0.2, 0.3 - 1e-15])}


def check_times(run, findings, times, at):
    """The increments end where they should, the last at T."""
    findings.close(run['history/time'], [0.0, *times], 1e-15*times[-1], at)


def few_free(name):
    """Free motion in a few steps, the last perhaps shorter."""
    (dt, end), times = TIMES[name]
    deck = Points([1.0]).ground(1, 1).start({1: 0.3}, {1: -1.0}).deck(step(DYNAMIC, (dt, end)))

    def check(run, findings):
        check_times(run, findings, times, 'times')
        d, v, t = 0.3, -1.0, 0.0
        for time in times:
            found = trapezoidal(1, time - t, d, v, 1)
            d, v, t = found[0, 1], found[1, 1], time
        findings.close([run['history/node_1/U1'][-1], run['history/node_1/V1'][-1]], [d, v], 1e-12,
                       'motion')
    return Case(f'free_{name}', '', deck, '', check)


def few_at_wall(name, method):
    """The same in front of a wall that is hit at 0.52 unless the only step jumps over that."""
    (dt, end), times = TIMES[name]
    deck = oscillator(method, ({1: 0.0}, {1: -1.0}),
                      step(DYNAMIC, (dt, end), prints=CONTACT_PRINTS))
    if method == 'METHOD=FICTITIOUS FORCE' and name in ('last_shorter', 'hair_left'):
        return Case(f'{short(method)}_{name}', '', deck, '', status=2,
                    words=['deck.inp:', 'a last increment of', 'T as a multiple of dt'])

    def check(run, findings):
        check_times(run, findings, times, 'times')
        energy = run['energy/total']
        findings.at_most(energy.max(), 0.5*(1.8 if 'ANCHOR' in method or 'FICT' in method
                                            else 1.002), 'energy')
        if 'TRANS' in method or 'LAGR' in method:
            findings.at_least(run['history/node_1/U1'].min() - WALL, -1e-12, 'gap')
        if 'BETA=1/4' in method and end > 0.6 and dt < 2:
            findings.true(run['history/node_1/V1'][-1] > 0.9, 'it has come back')
    return Case(f'{short(method)}_{name}', '', deck, '', check)


def few_static(name, method, procedure='STATIC, DIRECT'):
    """A force of twice what the spring takes at the wall, ramped."""
    (dt, end), times = TIMES[name]
    points = Points([1.0], [0.0]).ground(1, 1)
    if method:
        points.impact(method).wall(1, WALL)
    deck = points.deck(step(procedure, (dt, end), '*CLOAD', '1, 1, -2',
                            prints=CONTACT_PRINTS if method else '*NODE PRINT\nU\n'))

    def check(run, findings):
        if 'DIRECT' in procedure:
            check_times(run, findings, times, 'times')
        t = run['history/time']/end
        exact = -2*t
        if method:
            stiffness = 100 if 'PENALTY' in method else np.inf
            exact = np.where(-2*t < WALL, -(2*t - 0.5)/(1 + stiffness) + WALL, exact)
            findings.close(run['history/contact_S1-W1/CF1'][-1],
                           1.5 if stiffness == np.inf else 1.5*100/101, 1e-11, 'contact force')
        # T of 1e-12 over dt is taken in one increment of dt
        findings.close(run['history/node_1/U1'], exact, 1e-11, 'displacement')
    return Case(f'static_{short(method or "-free")}_{name}_{procedure[-4:]}', '', deck, '', check)


FEW = [few_free(name) for name in TIMES]
FEW += [few_at_wall(name, method) for name in TIMES for method in METHODS
        if not ('ANCHOR' in method and name == 'long')]
FEW += [few_static(name, method, procedure) for name in TIMES
        for method in (None, 'METHOD=TRANSFORMATION', 'METHOD=LAGRANGE',
                       'METHOD=PENALTY, STIFFNESS=100')
        for procedure in ('STATIC, DIRECT', 'STATIC')]

CASES = [
    Group('omega_h', 'free, omega h from 1e-12 to 1e8', 'trapezoidal rule and energy to 1e-12', FREE),
    Group('step_1e-12_periods', 'a wall, h = 1e-12 periods', 'speed after as e says',
          [tiny(method) for method in METHODS]),
    Group('step_1e6_periods', 'a wall, h = 1e6 periods',
          'trapezoidal rule; EVENTS=ANCHOR: a clear stop',
          [huge(method, steps) for method in METHODS for steps in (1, 7)]),
    Group('stiff_mode_at_wall', 'omega h of a stiff mode 1e2 to 1e6, a wall', 'energy kept within what round-off is of the strain',
          [stiff_at_wall(10.0**k) for k in (2, 4, 6)]),
    Group('return_parameter', 'RETURN = 1e-6 and 1 - 1e-6, ITERATION and DIRECT',
          'fixed point of the iteration to 1e-8; first order with e', RETURN),
    Group('few_steps', 'one step for all, a last step shorter, T no multiple of dt',
          'one step by the rule; times exact; contact closed', FEW)]

if __name__ == '__main__':
    sys.exit(main(CASES))
