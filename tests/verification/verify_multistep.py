"""Steps after steps, loads and prescribed motion over time, springs, dampers, constraints.

Most checks know two answers: the exact one, met to second order in the step h, and the one that
the trapezoidal rule gives for free vibration, cos(n theta) with tan(theta/2) = omega h/2, met to
round-off.
"""
import numpy as np

from carom_case import INPUT, Checks, run_deck

STEPS = (0.08, 0.04, 0.02, 0.01)


HELD = '*BOUNDARY\n2, 1\n'


def mass_deck(history, mass=1.0, stiffness=4.0, held=HELD, model='', v0=None):
    """One mass (node 1) on a spring to node 2, which is held at rest unless told otherwise."""
    start = '' if v0 is None else f'*INITIAL CONDITIONS, TYPE=VELOCITY\n1, 1, {v0!r}\n'
    return f"""*PARAMETER
h = 0.01
*NODE
1, 0, 0
2, 1, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*ELEMENT, TYPE=SPRING2, ELSET=spring
2, 1, 2
*MASS, ELSET=mass
{mass!r}
*SPRING, ELSET=spring
1, 1
{stiffness!r}
{model}{held}{start}{history}"""


PRINTS = '*NODE PRINT\nU, V, A, RF\n*ENERGY PRINT\n'


def step(procedure, dt, end, cards='', prints=PRINTS):
    """A step with its times, cards and requests."""
    return f'*STEP\n*{procedure}\n{dt}, {end}\n{cards}{prints}*END STEP\n'


def u1(run):
    """Time and displacement of node 1."""
    return run['history/time'], run['history/node_1/U1']


def discrete(omega, h, n):
    """Angle of n steps of the trapezoidal rule."""
    return 2.0 * np.arctan(0.5 * omega * h) * n


def check_order(checks, name, text, exact, steps=STEPS, order=1.95, start=0.0, **definitions):
    """The error against exact(t - start) from `start` on falls by the order."""
    errors = []
    for h in steps:
        t, d = u1(run_deck(text, h=h, **definitions))
        after = t >= start - 1e-9
        errors.append(np.max(np.abs(d - exact(t - start))[after]))
    fit = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    checks.at_least(fit, order, f'{name}: order of the error {errors[-1]:.3g}')


def balance(run):
    """Largest balance error over the largest energy."""
    return np.max(np.abs(run['energy/balance_error'])) / np.max(run['energy/total'])


def check_preload(checks):
    text = mass_deck(step('STATIC, DIRECT', 0.25, 1, '*CLOAD\n1, 1, 2\n')
                     + step('DYNAMIC, DIRECT', '<h>', 4, '*CLOAD, OP=NEW\n1, 1, 0\n'))
    run = run_deck(text, h=0.02)
    t, d = u1(run)
    checks.close(t[:6], [0, 0.25, 0.5, 0.75, 1, 1.02], 1e-15, 'preload: times of both steps')
    checks.close(d[:5], 0.125 * np.arange(5), 1e-15, 'preload: ramp of the static step')
    n = np.arange(len(t) - 4)
    checks.close(d[4:], 0.5 * np.cos(discrete(2.0, 0.02, n)), 1e-13, 'preload, released: vibration')
    checks.close(run['history/node_2/RF1'][4:], -4.0 * d[4:], 1e-13, 'preload, released: reaction')
    checks.close(run['energy/external_work'][4:], np.full(len(n), 0.5), 1e-14, 'preload: work')
    checks.at_most(balance(run), 1e-13, 'preload, released: balance error')
    check_order(checks, 'preload, released', text, lambda s: 0.5 * np.cos(2.0 * s), start=1.0)

    velocity = '*INITIAL CONDITIONS, TYPE=VELOCITY\n1, 1, 3\n'
    text = mass_deck(step('STATIC, DIRECT', 1, 1, '*CLOAD\n1, 1, 2\n')
                     + step('DYNAMIC, DIRECT', '<h>', 4, velocity))
    run = run_deck(text)
    t, d = u1(run)
    n = np.arange(len(t) - 1)
    checks.close(d[1:], 0.5 + 1.5 * np.sin(discrete(2.0, 0.01, n)), 1e-13,
                 'velocity given after a preload that stays: vibration')
    checks.at_most(balance(run), 1e-13, 'velocity after a preload: balance error')
    check_order(checks, 'velocity after a preload', text, lambda s: 0.5 + 1.5 * np.sin(2.0 * s),
                start=1.0)

    text = mass_deck(step('DYNAMIC, DIRECT', '<h>', 1) + step('DYNAMIC, DIRECT', '<h>', 4,
                                                              '*CLOAD\n1, 1, 2\n'))
    check_order(checks, 'load that comes on at once in a second dynamic step', text,
                lambda s: 0.5 - 0.5 * np.cos(2.0 * s), steps=(0.1, 0.05, 0.02, 0.01), start=1.0)

    text = mass_deck(step('STATIC, DIRECT', 1, 1, '*CLOAD\n1, 1, 2\n') + step('DYNAMIC, DIRECT', 0.01, 4),
                     v0=3.0)
    checks.close(u1(run_deck(text))[1][1:], d[1:], 1e-13,
                 'initial velocity kept through a static step: same vibration')


WALL = """*SURFACE, NAME=body, TYPE=NODE
1
*RIGID SURFACE, NAME=wall, TYPE=PLANE
-0.1, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT
*CONTACT PAIR, INTERACTION=hit
body, wall
"""
FORCE = 'history/contact_BODY-WALL/CF1'


def check_static_contact(checks):
    prints = PRINTS + '*CONTACT PRINT\nCF, CDIS\n'
    text = mass_deck(step('STATIC, DIRECT', 0.1, 1, '*CLOAD\n1, 1, -2\n', prints)
                     + step('DYNAMIC, DIRECT', 0.05, 5, '', prints)
                     + step('DYNAMIC, DIRECT', 0.05, 5, '*CLOAD, OP=NEW\n1, 1, 0\n', prints),
                     model=WALL)
    run = run_deck(text)
    t, d = u1(run)
    ramp = np.linspace(0.0, 1.0, 11)
    checks.close(d[:11], -np.minimum(0.5 * ramp, 0.1), 1e-15, 'pressed statically: displacement')
    checks.close(run[FORCE][:11], np.maximum(2.0 * ramp - 0.4, 0.0), 1e-14,
                 'pressed: contact force')
    checks.close(run['history/contact_BODY-WALL/CDIS'][10], 0.0, 1e-16, 'pressed: gap')
    checks.close(d[11:111], np.full(100, -0.1), 1e-14, 'pressed, then dynamic: stays')
    checks.close(run[FORCE][11:111], np.full(100, 1.6), 1e-13,
                 'pressed, then dynamic: contact force')
    checks.close(run['history/node_2/RF1'][11:111], np.full(100, 0.4), 1e-13,
                 'pressed, then dynamic: reaction of the spring')
    checks.close(len(run.events()['time']), 0, 0, 'pressed: impacts until the mass comes back')
    n = np.arange(1, 101)
    checks.close(d[111:], -0.1 * np.cos(discrete(2.0, 0.05, n)), 1e-12,
                 'load taken off: swings free')
    checks.at_most(balance(run), 1e-13, 'pressed: balance error')

    gravity = '*DLOAD\nmass, GRAV, 10, -1, 0, 0\n'
    run = run_deck(mass_deck(step('STATIC, DIRECT', 1, 1, gravity, prints), mass=3.0, model=WALL))
    checks.close(u1(run)[1], [0.0, -0.1], 1e-15, 'pressed by gravity: displacement')
    checks.close(run[FORCE], [0.0, 30.0 - 0.4], 1e-13, 'pressed by gravity: contact force')


def check_one_or_two(checks):
    """Two dynamic steps and one long one, impacts among them."""
    deck = (INPUT / 'sdof' / 'sdof.inp').read_text()
    begin = deck.index('*STEP')
    model, one = deck[:begin], deck[begin:]
    two = one.replace('<end>', '8') + one.replace('<end>', '12')
    for e in (1.0, 0.8):
        long, pair = run_deck(model + one, e=e, dt=0.04), run_deck(model + two, e=e, dt=0.04)
        for name in ('history/time', 'history/node_1/U1', 'history/node_1/V1', 'energy/total',
                     'energy/balance_error', 'events/time'):
            checks.close(pair[name], long[name], 1e-12, f'two steps as one, e = {e}: {name}')


def ramps(points):
    """Times and changes of the slope of a piecewise linear curve."""
    t, a = np.array(points).T
    slopes = np.concatenate(([0.0], np.diff(a) / np.diff(t), [0.0]))
    return list(zip(t, np.diff(slopes)))


def check_base(checks):
    """The base moves by an amplitude; omega = 2. The response is a sum over the ends of its pieces:
    to a base motion s, s^2/2, s^3/6 from rest, s as the time since then."""
    omega = 2.0
    points = [(0.0, 0.0), (0.8, 0.4), (1.6, -0.2), (2.4, 0.0), (4.0, 0.0)]
    lag = {'DISPLACEMENT': lambda s: s - np.sin(omega * s) / omega,
           'VELOCITY': lambda s: s**2 / 2.0 - (1.0 - np.cos(omega * s)) / omega**2,
           'ACCELERATION': lambda s: s**3 / 6.0 - s / omega**2 + np.sin(omega * s) / omega**3}
    amplitude = '*AMPLITUDE, NAME=shake\n' + ''.join(f'{t!r}, {a!r}\n' for t, a in points)
    for kind, response in lag.items():
        def exact(t, response=response):
            return sum(3.0 * slope * response(np.maximum(t - begin, 0.0))
                       for begin, slope in ramps(points))
        base = f'*BOUNDARY, TYPE={kind}, AMPLITUDE=shake\n2, 1, 1, 3\n'
        text = mass_deck(step('DYNAMIC, DIRECT', '<h>', 4, base), model=amplitude, held='')
        check_order(checks, f'base driven by {kind}', text, exact)
        run = run_deck(text, h=0.02)
        checks.at_most(balance(run), 1e-13, f'base driven by {kind}: balance error')
        checks.at_least(np.max(run['energy/external_work']), 0.1, f'base driven by {kind}: work')
        t, force = run['history/time'], run['history/node_2/RF1']
        spring = 4.0 * (run['history/node_2/U1'] - run['history/node_1/U1'])
        checks.close(force, spring, 1e-12, f'base driven by {kind}: reaction')
        if kind == 'VELOCITY':
            moved = np.interp(t, *np.array(points).T)
            checks.close(run['history/node_2/V1'], 3.0 * moved, 1e-14, 'base velocity')
            area = 0.5 * (0.4 * 0.8 + 0.2 * 0.8 - 0.2 * 0.8)
            checks.close(run['history/node_2/U1'][-1], 3.0 * area, 1e-14, 'base displacement')


DRIVEN = """*NODE
1, 0, 0
2, 1, 0
3, 2, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
2, 2
3, 3
*ELEMENT, TYPE=T2D2, ELSET=bar
4, 1, 2
5, 2, 3
*MASS, ELSET=mass
1.5
*MATERIAL, NAME=soft
*ELASTIC
40, 0
*DENSITY
2
*SOLID SECTION, ELSET=bar, MATERIAL=soft
1
*ELEMENT GROUP, ELSET=bar, SCHEME=IMPLICIT, MASS=<mass>
*AMPLITUDE, NAME=push
0, 0, 0.372, 1, 0.9, -0.5, 1.213, 0.2
"""


def check_driven_mass(checks):
    """A node with mass is driven, its velocity jumps inside increments: the work of that is booked.
    Neighbours with consistent mass do not feel the jumps, of which the log warns."""
    for kind in ('DISPLACEMENT', 'VELOCITY', 'ACCELERATION'):
        push = f'*BOUNDARY, TYPE={kind}, AMPLITUDE=push\n1, 1, 1, 0.1\n'
        text = DRIVEN + step('DYNAMIC, DIRECT', 0.01, 2, push)
        run = run_deck(text.replace('<mass>', 'LUMPED'))
        checks.at_most(balance(run), 1e-13, f'mass driven by {kind}: balance error')
        checks.at_least(np.max(run['energy/external_work']), 1e-3, f'mass driven by {kind}: work')
        for mass, warned in (('LUMPED', False), ('CONSISTENT', kind != 'ACCELERATION')):
            log = run_deck(text.replace('<mass>', mass)).path.with_suffix('.log').read_text()
            checks.true(('miss its inertia' in log) == warned,
                        f'{mass}, driven by {kind}: warning {warned}')


def check_base_motion(checks):
    """Ground acceleration sin(3 t) in points 0.001 apart, omega = 2, relative displacement."""
    t = np.linspace(0.0, 4.0, 4001)
    amplitude = '*AMPLITUDE, NAME=quake\n' + ''.join(
        f'{a:.15g}, {b:.15g}\n' for a, b in zip(t, np.sin(3.0 * t)))
    text = mass_deck(step('DYNAMIC, DIRECT', '<h>', 4, '*BASE MOTION, AMPLITUDE=quake, DOF=1\n2\n'),
                     mass=5.0, stiffness=20.0, model=amplitude)

    def exact(s):
        return -2.0 * (np.sin(3.0 * s) - 1.5 * np.sin(2.0 * s)) / (4.0 - 9.0)

    check_order(checks, 'ground acceleration sin(3 t)', text, exact)


def check_equation(checks):
    """u2 = -u1/2 by an equation: the two masses are one with m = m1 + m2/4, k = k1 + k2/4."""
    text = """*PARAMETER
h = 0.01
*NODE
1, 0, 0
2, 1, 0
*ELEMENT, TYPE=MASS, ELSET=first
1, 1
*ELEMENT, TYPE=MASS, ELSET=second
2, 2
*ELEMENT, TYPE=SPRING1, ELSET=left
3, 1
*ELEMENT, TYPE=SPRING1, ELSET=right
4, 2
*MASS, ELSET=first
1
*MASS, ELSET=second
4
*SPRING, ELSET=left
1
3
*SPRING, ELSET=right
1
20
*EQUATION
2
2, 1, 2, 1, 1, 1
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
1, 1, 1
2, 1, -0.5
""" + step('DYNAMIC, DIRECT', '<h>', 4)
    run = run_deck(text)
    t, d = u1(run)
    checks.close(run['history/node_2/U1'], -0.5 * d, 1e-15, 'masses tied: the equation')
    checks.close(d, np.cos(discrete(2.0, 0.01, np.arange(len(t)))), 1e-12, 'masses tied: vibration')
    checks.at_most(balance(run), 1e-13, 'masses tied: balance error')
    check_order(checks, 'masses tied', text, lambda s: np.cos(2.0 * s))


def check_nonlinear(checks):
    """A spring of stiffness 1 one way, 9 the other: half waves of omega = 1 and 3."""
    law = '*SPRING, ELSET=spring, NONLINEAR\n1, 1\n-100, -100\n0, 0\n900, 100'
    linear = '*SPRING, ELSET=spring\n1, 1\n4.0'
    # the elongation is u1 - u2
    text = mass_deck(step('DYNAMIC, DIRECT', '<h>', 8), v0=1.0).replace(linear, law)

    def exact(t):
        s = np.mod(t, np.pi + np.pi / 3.0)
        return np.where(s < np.pi / 3.0, np.sin(3.0 * s) / 3.0, -np.sin(s - np.pi / 3.0))

    check_order(checks, 'spring with a kink', text, exact, steps=(0.02, 0.01, 0.005, 0.0025))
    run = run_deck(text, h=0.01)
    checks.at_most(np.max(np.abs(run['energy/total'] - 0.5)), 1e-3, 'spring with a kink: energy')
    text = mass_deck(step('STATIC, DIRECT', 0.5, 1, '*CLOAD\n1, 1, -18\n')
                     + step('STATIC, DIRECT', 1, 1, '*CLOAD\n1, 1, 5\n')).replace(linear, law)
    checks.close(u1(run_deck(text))[1], [0.0, -9.0, -18.0, 5.0 / 9.0], 1e-9,
                 'spring with a kink, statically')


def check_dissipation(checks):
    # HHT
    text = mass_deck(step('DYNAMIC, DIRECT, ALPHA=-0.1', '<h>', 8), v0=2.0)
    check_order(checks, 'alpha = -0.1', text, lambda s: np.sin(2.0 * s), start=0.0)
    total = run_deck(text, h=0.05)['energy/total']
    checks.true(0.9 < total[-1] / total[0] < 1.0 - 1e-4,
                f'alpha = -0.1, h = 0.05: {total[-1] / total[0]:.6f} of the energy at the end')
    stiff = mass_deck(step('DYNAMIC, DIRECT, ALPHA=-0.1', 1, 100), stiffness=1e8, v0=2.0)
    total = run_deck(stiff)['energy/total']
    # the fastest motion dies by 0.9/1.1 a step
    checks.at_most(total[-1] / np.max(total), 1e-14, 'alpha = -0.1, omega h = 1e4: energy left')

    # a dashpot alone and with the spring
    dashpot = '*ELEMENT, TYPE=DASHPOT2, ELSET=damper\n9, 1, 2\n*DASHPOT, ELSET=damper\n1, 1\n0.6\n'
    text = mass_deck(step('DYNAMIC, DIRECT', '<h>', 8), mass=2.0, stiffness=0.0, model=dashpot,
                     v0=3.0)
    run = run_deck(text, h=0.05)
    ratio = (1.0 - 0.6 * 0.05 / 4.0) / (1.0 + 0.6 * 0.05 / 4.0)
    checks.close(run['history/node_1/V1'], 3.0 * ratio**np.arange(161), 1e-13, 'dashpot: decay')
    checks.at_most(balance(run), 1e-13, 'dashpot: balance error')
    checks.close(run['energy/damping'][-1], 9.0 - run['energy/total'][-1], 1e-13, 'dashpot: energy')
    check_order(checks, 'dashpot', text, lambda s: 10.0 * (1.0 - np.exp(-0.3 * s)))
    text = mass_deck(step('DYNAMIC, DIRECT', '<h>', 8), mass=2.0, stiffness=8.0, model=dashpot,
                     v0=3.0)
    check_order(checks, 'spring and dashpot', text, damped(0.15, 2.0, 3.0))
    checks.at_most(balance(run_deck(text, h=0.05)), 1e-13, 'spring and dashpot: balance error')

    # Rayleigh: C = alpha M + beta K on one truss, m = rho A L/2 = 2, k = E A/L = 8, omega = 2
    text = """*PARAMETER
h = 0.01
*NODE
1, 2, 0
2, 0, 0
*ELEMENT, TYPE=T2D2, ELSET=bar
1, 2, 1
*MATERIAL, NAME=stuff
*ELASTIC
32
*DENSITY
4
*DAMPING, ALPHA=0.2, BETA=0.05
*SOLID SECTION, ELSET=bar, MATERIAL=stuff
0.5
*ELEMENT GROUP, ELSET=bar, SCHEME=IMPLICIT, MASS=LUMPED
*BOUNDARY
2, 1
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, 3
""" + step('DYNAMIC, DIRECT', '<h>', 8)
    check_order(checks, 'Rayleigh damping', text, damped(0.5 * (0.2 + 0.05 * 4.0), 2.0, 3.0))
    checks.at_most(balance(run_deck(text, h=0.05)), 1e-13, 'Rayleigh damping: balance error')


def damped(decay, omega, v0):
    """exp(-decay t) v0 sin(omega_d t)/omega_d."""
    omega_d = np.sqrt(omega**2 - decay**2)
    return lambda s: np.exp(-decay * s) * v0 * np.sin(omega_d * s) / omega_d


def check_amplitude_time(checks):
    """A load that goes on by the total time through a second step, and one that begins again."""
    amplitude = '*AMPLITUDE, NAME=wave, TIME={} TIME\n0, 0, 1, 1, 3, -1, 4, 0\n'
    load = '*CLOAD, AMPLITUDE=wave\n1, 1, 5\n'
    total = amplitude.format('TOTAL')
    long = run_deck(mass_deck(step('DYNAMIC, DIRECT', '<h>', 4, load), model=total))
    for again, name in (('', 'goes on by itself'), (load, 'given again')):
        pair = run_deck(mass_deck(step('DYNAMIC, DIRECT', '<h>', 1.5, load)
                                  + step('DYNAMIC, DIRECT', '<h>', 2.5, again), model=total))
        checks.close(u1(pair)[1], u1(long)[1], 1e-12, f'amplitude on total time, {name}')
    anew = run_deck(mass_deck(step('DYNAMIC, DIRECT', '<h>', 2, load)
                              + step('DYNAMIC, DIRECT', '<h>', 2, load),
                              model=amplitude.format('STEP')))
    same = run_deck(mass_deck(step('DYNAMIC, DIRECT', '<h>', 4, load), model=
                              '*AMPLITUDE, NAME=wave\n0, 0, 1, 1, 2, 0, 3, 1\n4, 0\n'))
    checks.close(u1(anew)[1], u1(same)[1], 1e-12, 'amplitude on step time begins again')
    response = [(b, s) for b, s in ramps([(0.0, 0.0), (1.0, 1.0), (3.0, -1.0), (4.0, 0.0)])]
    check_order(checks, 'load by an amplitude',
                mass_deck(step('DYNAMIC, DIRECT', '<h>', 4, load), model=total),
                lambda t: sum(5.0 / 4.0 * s * (np.maximum(t - b, 0.0)
                                               - np.sin(2.0 * np.maximum(t - b, 0.0)) / 2.0)
                              for b, s in response), steps=(0.1, 0.05, 0.025, 0.0125))
    # the base moves by total time through both steps
    base = '*BOUNDARY, AMPLITUDE=wave\n2, 1, 1, 1\n'
    model = mass_deck('', model=total, held='')
    long = run_deck(model + step('DYNAMIC, DIRECT', '<h>', 4, base))
    pair = run_deck(model + step('DYNAMIC, DIRECT', '<h>', 1.5, base)
                    + step('DYNAMIC, DIRECT', '<h>', 2.5))
    checks.close(u1(pair)[1], u1(long)[1], 1e-12, 'base by an amplitude on total time, two steps')


checks = Checks()
check_preload(checks)
check_static_contact(checks)
check_one_or_two(checks)
check_base(checks)
check_driven_mass(checks)
check_base_motion(checks)
check_equation(checks)
check_nonlinear(checks)
check_dissipation(checks)
check_amplitude_time(checks)
checks.finish()
