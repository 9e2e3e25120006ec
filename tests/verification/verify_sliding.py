"""Bodies that slide on each other, with METHOD=TRANSFORMATION.

A particle inside and outside circles and rings of straight and curved sides: gap over 10^4 steps, energy, the
loss at kinks, where it leaves; thrown at them from anywhere with steps of any size; blocks with friction on
inclines, belts and springs; oblique impacts; two deformable bodies in all ways of pairing.
"""
import numpy as np

from carom_case import Checks, run_deck
from plane_bodies import Deck, arch, block, frames, ring

GRAVITY = 10.0
NODE = '*NODE PRINT, NSET=m_N\nU, V\n'


def particle(place, speed, target, impact='METHOD=TRANSFORMATION', friction=None):
    """A point mass and what it meets: ('circle', radius), or ('ring', elements, nodes, side)."""
    deck = Deck().point('m', place)
    if target[0] == 'circle':
        deck.add(f'*RIGID SURFACE, NAME=R, TYPE=CIRCLE\n0., 0.\n{target[1]!r}')
    else:
        _, n, nodes, side = target
        radii = (1.0, 1.5) if side == 1 else (0.5, 1.0)
        deck.body('r', ring(n, 1, nodes, *radii)).fix('r').surface('R', ('r', side))
    return deck.speed('m', *speed).pair('m_S', 'R', '', impact, friction)


def fly(deck, dt, end, place, gravity=False):
    """Runs it: time, position (2, n), velocity (2, n), the run."""
    cards = f'*DLOAD\nm, GRAV, {GRAVITY!r}, 0., -1.\n' if gravity else ''
    run = run_deck(deck.text(dt, end, cards, prints=NODE, every=10**6))
    x = np.array([place[i] + run[f'history/node_1/U{i + 1}'] for i in range(2)])
    v = np.array([run[f'history/node_1/V{i + 1}'] for i in range(2)])
    return run['history/time'], x, v, run


def check_loops(checks):
    """Inside a circle, fast enough for the top: 10^4 steps, some ten turns."""
    place, speed = (0.0, -1.0), (np.sqrt(6.0 * GRAVITY), 0.0)
    for target, loss in ((('circle', -1.0), 1e-4), (('ring', 16, 8, 1), 1e-2), (('ring', 32, 8, 1), 1e-3)):
        name = f'loops in {target}'
        _, x, v, run = fly(particle(place, speed, target), 0.001, 10.0, place, True)
        energy = np.sum(v**2, axis=0) / 2 + GRAVITY * (x[1] + 1.0)
        gap = run['history/contact_M_S-R/CDIS']
        turns = np.unwrap(np.arctan2(x[1], x[0]))
        checks.at_most(np.max(np.abs(gap)), 1e-13, f'{name}: gap over 10^4 steps')
        checks.at_least(turns[-1] - turns[0], 9.0 * 2 * np.pi, f'{name}: angle')
        checks.at_most(np.max(energy) / energy[0] - 1.0, 2e-5, f'{name}: energy above the first')
        checks.at_most(1.0 - energy[-1] / energy[0], loss, f'{name}: energy lost')
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-11, f'{name}: balance error')


def check_kinks(checks):
    """Straight sides take sin^2 of the kink's angle at every kink."""
    n, place = 32, (0.0, -1.0)
    _, x, v, run = fly(particle(place, (2.0, 0.0), ('ring', n, 4, 1)), 0.003, 3.3, place)
    angle = 2.0 * np.pi / n
    turned = np.arctan2(x[1], x[0]) % (2.0 * np.pi) - 1.5 * np.pi
    kinks = np.floor(turned[-1] % (2.0 * np.pi) / angle)
    exact = np.cos(angle / 2)**2 * np.cos(angle)**(2.0 * kinks)
    energy = np.sum(v**2, axis=0)
    checks.at_least(kinks, 20, 'kinks met')
    checks.close(energy[-1] / energy[0], exact, 1e-12, 'energy behind the kinks')
    checks.close(run['energy/impact_loss'][-1], (energy[0] - energy[-1]) / 2, 1e-12, 'kinks: impact loss')


def check_leaving(checks):
    """From the top of a circle: it leaves where the height is (2 + v0^2/g)/3."""
    place, speed, errors = (0.0, 1.0), (1e-2, 0.0), []
    steps = (0.02, 0.01, 0.005, 0.0025)
    for dt in steps:
        time, x, _, run = fly(particle(place, speed, ('circle', 1.0)), dt, 2.2, place, True)
        release = run.events('release')['time']
        checks.close(len(release), 1, 0, f'falls off a circle, dt = {dt}: releases')
        errors.append(abs(np.interp(release[0], time, x[1]) - (2.0 + speed[0]**2 / GRAVITY) / 3.0))
        checks.at_least(np.min(np.hypot(*x)) - 1.0, -1e-13, f'falls off a circle, dt = {dt}: smallest gap')
    checks.at_most(errors[0], 1e-3, f'falls off a circle, dt = {steps[0]}: height')
    checks.at_most(errors[-1], 2e-5, f'falls off a circle, dt = {steps[-1]}: height')


def check_throws(checks):
    """Thrown at a circle from anywhere: hit where it is, whatever the step, never flown through."""
    random = np.random.default_rng(1)
    for k in range(40):
        angle, offset = random.uniform(0.0, 2.0 * np.pi), random.uniform(-0.99, 0.99)
        e = (0.0, 0.5, 1.0, None)[k % 4]
        along = np.array([np.cos(angle), np.sin(angle)])
        across = np.array([-along[1], along[0]])
        far = random.uniform(1.5, 4.0)
        place, dt = -far * along + offset * across, 10.0**random.uniform(-2.0, 0.6)
        impact = 'METHOD=TRANSFORMATION' + ('' if e is None else f', RESTITUTION={e}')
        target = ('circle', 1.0) if k % 3 else ('ring', 32, 8, 3)
        _, x, v, run = fly(particle(tuple(place), along, target, impact), dt, max(3 * dt, 6.0), place)
        depth = np.sqrt(1.0 - offset**2)
        normal = -depth * along + offset * across
        out = along - (1.0 + (e or 0.0)) * (along @ normal) * normal
        name = f'throw {k} at {target[0]}, e = {e}, dt = {dt:.3f}'
        exact = target[0] == 'circle'
        checks.close(run['events/time'][0], far - depth, 1e-9 if exact else 2e-2, f'{name}: time of the hit')
        if exact:
            checks.close(v[:, -1], out, 1e-9, f'{name}: velocity')
            checks.at_least(np.min(np.hypot(*x)) - 1.0, -1e-12, f'{name}: smallest gap')
        else:
            checks.at_most(np.max(np.hypot(*v)), 1.0 + 1e-12, f'{name}: largest speed')


def check_oblique(checks):
    """Newton's restitution along the normal, Coulomb's cone on the impulse."""
    random = np.random.default_rng(2)
    worst = balance = 0.0
    for k in range(24):
        e, mu = random.choice([0.0, 0.3, 0.7, 1.0]), random.choice([0.05, 0.2, 0.5])
        angle, fast, slip = random.uniform(0, 2 * np.pi), random.uniform(0.2, 2), random.uniform(-2, 2)
        along = np.array([np.cos(angle), np.sin(angle)])
        normal = np.array([-along[1], along[0]])
        place = 0.37 * normal
        deck = Deck().point('m', place)
        if k % 2:
            bed = block(15, 1, (4, 8)[k // 2 % 2], (-6.0, -1.0), (6.0, 0.0))
            bed.x = bed.x @ np.array([along, normal])
            deck.body('bed', bed).fix('bed').surface('R', ('bed', 3))
        else:
            deck.add(f'*RIGID SURFACE, NAME=R, TYPE=PLANE\n0., 0.\n{float(normal[0])!r}, {float(normal[1])!r}')
        deck.speed('m', *(slip * along - fast * normal))
        deck.pair('m_S', 'R', '', f'METHOD=TRANSFORMATION, RESTITUTION={e}, CAPTURE=0', mu)
        end = 0.37 / fast * 1.4
        _, _, v, run = fly(deck, end / 23.3, end, place)
        left = slip - np.sign(slip) * min(abs(slip), mu * (1.0 + e) * fast)
        worst = max(worst, abs(v[:, -1] @ normal - e * fast), abs(v[:, -1] @ along - left))
        balance = max(balance, np.max(np.abs(run['energy/balance_error'])))
    checks.at_most(worst, 1e-11, 'oblique impacts: velocities')
    checks.at_most(balance, 1e-12, 'oblique impacts: balance error')


def check_belt(checks):
    """A belt drags a particle to its own speed; with a spring it sticks, slips and swings."""
    speed, mu, g = 1.5, 0.2, 9.81
    belt = ('*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n0., 0., 100., 100.\n'
            '*RIGID SURFACE, NAME=R, TYPE=PLANE, AMPLITUDE=A\n0., 0.\n0., 1.\n1., 0., 0., {}')
    deck = Deck().add(belt.format(speed)).point('m', (0.0, 0.0)).pair('m_S', 'R', friction=mu)
    cards = f'*DLOAD\nm, GRAV, {g}, 0., -1.\n'
    run = run_deck(deck.text(0.004, 2.0, cards, prints=NODE))
    time, caught = run['history/time'], speed / (mu * g)
    exact = np.where(time < caught, mu * g * time**2 / 2, speed * (time - caught / 2))
    checks.close(run['history/node_1/U1'], exact, 1e-5, 'belt: place of the particle')
    for name, value in (('kinetic', 1.125), ('friction', 1.125), ('external_work', 2.25), ('impact_loss', 0.0)):
        checks.close(run[f'energy/{name}'][-1], value, 1e-12, f'belt: {name}')
    slow, stiff, rough = 0.5, 25.0, 0.3
    deck = Deck().add(belt.format(slow)).point('m', (0.0, 0.0))
    deck.add(f'*ELEMENT, TYPE=SPRING1, ELSET=K\n2, 1\n*SPRING, ELSET=K\n1\n{stiff}')
    deck.speed('m', slow, 0.0).pair('m_S', 'R', friction=rough)
    errors, steps = [], (0.01, 0.005, 0.0025)
    for dt in steps:
        run = run_deck(deck.text(dt, 6.0, cards, prints=NODE))
        time, stuck, omega = run['history/time'], rough * g / stiff, np.sqrt(stiff)
        swing = stuck + slow / omega * np.sin(omega * (time - stuck / slow))
        errors.append(np.max(np.abs(run['history/node_1/U1'] - np.where(time * slow < stuck, slow * time, swing))))
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-11, f'stick and slip, dt = {dt}: balance')
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    checks.at_least(order, 1.9, f'stick and slip: order of the error {errors[-1]:.3g}')


def lumped(deck):
    """Lumped masses of all nodes of four-node bodies of density 1."""
    mass = np.zeros(deck.nodes)
    at = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
    for name, mesh in deck.mesh.items():
        for nodes in mesh.elements:
            for a, b in at / np.sqrt(3.0):
                slope = np.array([at[:, 0] * (1 + at[:, 1] * b), at[:, 1] * (1 + at[:, 0] * a)]) / 4
                shape = (1 + at[:, 0] * a) * (1 + at[:, 1] * b) / 4
                mass[deck.first[name][0] + nodes] += shape * np.linalg.det(slope @ mesh.x[nodes])
    return mass


def two_bodies(kind):
    """A block that slides on another, one that falls on its corner, a ring that rolls along a ring."""
    deck = Deck()
    if kind == 'block on block':
        deck.body('low', block(12, 2, 4, (0, 0), (6, 1)), 2e3, 0.3).body('top', block(3, 2, 4, (0.3, 1), (1.7, 1.7)), 1e3, 0.3)
        return deck.surface('F', ('low', 3)).surface('S', ('top', 1)).speed('top', 1.5, -0.3)
    if kind == 'corner on block':
        top = block(4, 4, 4, (-0.7, -0.7), (0.7, 0.7))
        top.x = top.x @ np.array([[np.cos(0.6), np.sin(0.6)], [-np.sin(0.6), np.cos(0.6)]]) + (1.9, 3.1)
        deck.body('low', block(4, 4, 4, (0, 0), (2, 2)), 2e3, 0.3).body('top', top, 1e3, 0.3)
        deck.surface('F', ('low', 3), ('low', 2), ('low', 4)).surface('S', ('top', 1), ('top', 2), ('top', 4))
        return deck.speed('top', -0.2, -1.5)
    deck.body('low', arch(12, 2, 4, 0.5, 1.0, (170.0, -170.0)), 2e3, 0.3)
    deck.body('top', arch(9, 2, 4, 0.4, 0.8, (350.0, 10.0), (1.9, 0.35)), 1e3, 0.3)
    return deck.surface('F', ('low', 3)).surface('S', ('top', 3)).speed('top', -1.0).speed('low', 0.5)


def check_two_bodies(checks):
    for kind in ('block on block', 'corner on block', 'ring on ring'):
        for options in ('', 'PASSES=2', 'TYPE=SURFACE TO SURFACE'):
            for friction in (None, 0.3):
                if kind != 'block on block' and 'TYPE' in options and friction:
                    continue
                deck = two_bodies(kind)
                deck.add('*ELSET, ELSET=EVERY\nlow, top\n*ELEMENT GROUP, ELSET=EVERY, SCHEME=IMPLICIT, MASS=LUMPED')
                deck.pair('S', 'F', options, friction=friction)
                run = run_deck(deck.text(0.004, 1.0))
                name = f'{kind}, {options or "node rows"}, friction {friction}'
                v, mass = frames(run, 'V')[:, :, :2], lumped(deck)
                momentum = np.einsum('n,fni->fi', mass, v)
                size = np.max(np.einsum('n,fni->f', mass, np.abs(v)))
                checks.at_most(np.max(np.abs(momentum - momentum[0])) / size, 1e-11, f'{name}: momentum')
                total = run['energy/total']
                checks.at_most(np.max(total) / total[0] - 1.0, 1e-6, f'{name}: energy above the first')
                if not options.startswith('TYPE'):
                    checks.at_least(np.min(run['history/contact_S-F/CDIS']), -1e-12, f'{name}: smallest gap')
                    checks.at_most(np.max(np.abs(run['energy/balance_error'])) / total[0], 1e-5, f'{name}: balance error')


def check_sliding_off(checks):
    """A block slides off the end of a fixed one, tips over and falls: damped, so energy only falls."""
    for nodes in (4, 8):
        for friction in (None, 0.1):
            deck = Deck().body('low', block(6, 1, nodes, (0, -1), (3, 0)), 1e4, 0.3).fix('low')
            deck.body('top', block(2, 1, nodes, (1.2, 0), (2.2, 0.5)), 1e3, 0.3, more='*DAMPING, BETA=0.005\n')
            deck.surface('F', ('low', 3), ('low', 2)).surface('S', *[('top', side) for side in (1, 2, 4, 3)])
            deck.speed('top', 3.0 if friction else 1.5).pair('S', 'F', 'TYPE=SURFACE TO SURFACE', friction=friction)
            run = run_deck(deck.text(0.0025, 1.6, '*DLOAD\ntop, GRAV, 9.81, 0., -1.\n'))
            name = f'slides off the end, {nodes} nodes, friction {friction}'
            total = run['energy/total'] - run['energy/external_work']
            checks.at_most(np.max(np.diff(total)) / total[0], 1e-3, f'{name}: largest rise of energy')
            checks.at_most(np.max(np.abs(run['energy/balance_error'])) / total[0], 1e-3, f'{name}: balance error')
            checks.at_most(np.mean(frames(run, 'U')[-1, deck.first['top'][0]:, 1]), -0.2, f'{name}: falls')


def check_closing_ring(checks):
    """The ends of an open ring are thrown at each other: one surface that touches itself."""
    for layers in (1, 2, 4):
        for friction in (None, 0.3):
            deck = Deck().body('c', arch(16, layers, 4, 0.8, 1.0, (350.0, 10.0)), 2e3, 0.3)
            deck.surface('S', *[('c', side) for side in (1, 2, 3, 4)]).pair('S', 'S', friction=friction)
            for end, speed in ((1, -6.0), (0, 5.0)):
                for k in deck.mesh['c'].at(s=end):
                    deck.add(f'*INITIAL CONDITIONS, TYPE=VELOCITY\n{deck.node("c", k)}, 2, {speed!r}')
            deck.add('*ELEMENT GROUP, ELSET=c, SCHEME=IMPLICIT, MASS=LUMPED')
            run = run_deck(deck.text(0.002, 1.0))
            name = f'closing ring of {layers} layers, friction {friction}'
            v, mass, total = frames(run, 'V')[:, :, :2], lumped(deck), run['energy/total']
            momentum = np.einsum('n,fni->fi', mass, v)
            size = np.max(np.einsum('n,fni->f', mass, np.abs(v)))
            checks.at_most(np.max(np.abs(momentum - momentum[0])) / size, 1e-11, f'{name}: momentum')
            checks.at_most(np.max(total) / total[0] - 1.0, 1e-6, f'{name}: energy above the first')
            checks.at_least(run['energy/impact_loss'][-1] / total[0], 0.01, f'{name}: energy lost in impacts')
            checks.at_least(np.nanmin(run['history/contact_S-S/CDIS']), -1e-8, f'{name}: smallest gap')


checks = Checks()
check_loops(checks)
check_kinks(checks)
check_leaving(checks)
check_throws(checks)
check_oblique(checks)
check_belt(checks)
check_two_bodies(checks)
check_sliding_off(checks)
check_closing_ring(checks)
checks.finish()
