"""Rows that stick get slip by a jump of velocity, and slide by Coulomb's law from then on.

A mass at rest on a floor is hit sideways; a belt starts and stops; a slab is set in motion in a later
step, or by a table with corners; masses slide to rest at the very end of an increment; a table shakes.
All with the exact answers.
"""
import numpy as np

from carom_case import Checks, run_deck
from plane_bodies import Deck, block

MU, G, M = 0.3, 10.0, 2.0
WEIGHT = f'*DLOAD\nm, GRAV, {G!r}, 0., -1.\n'
EXPLICIT = '*ELEMENT GROUP, SCHEME=EXPLICIT, ELSET={}\n'
PRINTS = '*NODE PRINT, NSET=m_N\nU, V, A\n'
FLOOR = '*RIGID SURFACE, NAME=F, TYPE=PLANE\n0., 0.\n0., 1.\n'
BALANCE = 1e-12


def mass_on_floor(speed=0.0):
    return Deck().point('m', (0.0, 0.0), M).add(FLOOR).speed('m', speed)


def finish(deck, impact, dt, end, cards='', explicit='m', options='DIRECT'):
    """Puts the pair m on F into a deck, with elements `explicit` where that is asked for, and runs it."""
    scheme = impact.endswith('explicit')
    if scheme:
        deck.add(EXPLICIT.format(explicit))
    deck.pair('m_S', 'F', '', impact.replace(' explicit', ''), MU)
    return run_deck(deck.text(dt, end, WEIGHT + cards, prints=PRINTS, node_file='U', every=10**6, options=options))


def friction_of(run):
    return run['history/contact_M_S-F/CF1']


def slides(checks, name, run, start, speed, pull=0.0):
    """From `start` on the mass slides at `speed` until friction has stopped it (with a pull, slower).
    Steps that begin at events are interpolated at the deck's times."""
    time, braking = run['history/time'], MU * G - pull / M
    gone = np.clip(time - start, 0.0, speed / braking)
    dt = np.max(np.diff(time))
    work = MU * M * G * (speed * gone[-1] - braking * gone[-1]**2 / 2)
    exact = np.where((time <= start) & (start > 0.0), 0.0, speed - braking * gone)
    between = braking * dt**2 if 'ANCHOR' in name and dt < 0.01 else 0.0
    moving = (time > start + dt / 2) & (time < start + speed / braking - dt / 2)
    checks.close(run['history/node_1/V1'], exact, 1e-12 + between, f'{name}: velocity')
    checks.close(run['history/node_1/U1'], speed * gone - braking * gone**2 / 2, braking * dt**2 / 4,
                 f'{name}: displacement')
    checks.close(friction_of(run)[moving], -MU * M * G + 0.0 * time[moving], 1e-10, f'{name}: friction force')
    checks.close(run['energy/friction'][-1], work, 1e-10 + between / 10 + pull * braking * dt**2,
                 f'{name}: friction work')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), BALANCE + between / 10, f'{name}: balance error')


def check_hits(checks):
    """A mass of e M hits it with 1 at t = 0.1 and stops there: it gets the speed e."""
    def start(e, events=''):
        deck = mass_on_floor().point('hammer', (-1.0, 0.0), e * M).speed('hammer', 1.0)
        return deck.add('*ELEMENT, TYPE=GAPUNI, ELSET=HIT\n7, 2, 1\n*SURFACE INTERACTION, NAME=BLOW\n'
                        f'*IMPACT, {events}RESTITUTION={e}\n*GAP, ELSET=HIT, INTERACTION=BLOW\n0.1, 1., 0., 0.\n'
                        '*BOUNDARY\nhammer_N, 2\n')

    for e in (0.5, 1.0):
        for impact in ('METHOD=TRANSFORMATION', 'EVENTS=ANCHOR', 'METHOD=TRANSFORMATION explicit'):
            for dt in (0.01, 0.0037):
                deck = start(e, 'EVENTS=ANCHOR, ' * ('ANCHOR' in impact))
                run = finish(deck, impact, dt, 0.9, explicit='m\n*ELEMENT GROUP, SCHEME=EXPLICIT, ELSET=hammer')
                name = f'hit, e = {e}, {impact}, dt = {dt}'
                slides(checks, name, run, 0.1, e)
                checks.close(run['energy/impact_loss'][-1], e * (1.0 - e) * M / 2, 1e-12, f'{name}: impact loss')
    slides(checks, 'hit, with a pull', finish(start(1.0), 'METHOD=TRANSFORMATION', 0.01, 0.9, '*CLOAD\n1, 1, 4.\n'),
           0.1, 1.0, 4.0)
    run = finish(start(1.0), 'METHOD=TRANSFORMATION', 0.01, 0.9, options='')
    for name, value in (('kinetic', 0.0), ('friction', M / 2)):
        checks.close(run[f'energy/{name}'][-1], value, 1e-10, f'hit, automatic increments: {name}')


def dragged(checks, name, run, start, stop, tolerance=1e-11):
    """What carries the mass moves at 1 from `start` to `stop`: it follows, and slides on thereafter."""
    time, takes = run['history/time'], 1.0 / (MU * G)
    up = np.clip(time - start, 0.0, takes)
    down = np.clip(time - stop, 0.0, takes)
    speed = MU * G * (up - down)
    place = MU * G * up**2 / 2 + np.clip(time - start - takes, 0.0, None) - np.clip(time - stop, 0.0, None)
    place += down - MU * G * down**2 / 2
    dt = np.max(np.diff(time))
    stops = 1 + int(time[-1] > stop)
    checks.close(run['history/node_1/V1'], speed, tolerance, f'{name}: velocity')
    checks.close(run['history/node_1/U1'], place, stops * MU * G * dt**2 / 4, f'{name}: displacement')
    checks.close(run['energy/friction'][-1], stops * M / 2, tolerance, f'{name}: friction work')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 10 * BALANCE, f'{name}: balance error')


METHODS = [f'METHOD={method}{scheme}' for method in ('TRANSFORMATION', 'LAGRANGE') for scheme in ('', ' explicit')]


def check_belts(checks):
    """A rigid belt that starts, or stops, or both."""
    for start, stop, table in ((0.0, 1.0, '0., 0., 1., 1.'), (0.2, 1.0, '0., 0., 0.2, 0., 1., 0.8')):
        for impact in METHODS:
            deck = Deck().point('m', (0.0, 0.0), M).add(
                f'*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n{table}\n'
                '*RIGID SURFACE, NAME=F, TYPE=PLANE, AMPLITUDE=A\n0., 0.\n0., 1.\n1., 0., 0., 1.')
            run = finish(deck, impact, 0.01, 1.6)
            dragged(checks, f'belt from {start} to {stop}, {impact}', run, start, stop)


def slab():
    deck = Deck().point('m', (0.0, 1.0), M).body('slab', block(1, 1, 4, (-3, 0), (3, 1)), 1e6, 0.3)
    return deck.surface('F', ('slab', 3)).add('*BOUNDARY\nslab_N, 2\n')


def check_slabs(checks):
    """A slab of elements whose support moves: by a table of displacements, or from a second step on."""
    for impact in METHODS:
        deck = slab().add('*AMPLITUDE, NAME=A\n0., 0., 0.2, 0., 1., 0.8\n')
        moved = '*BOUNDARY, TYPE=DISPLACEMENT, AMPLITUDE=A\nslab_N, 1, 1, 1.\n'
        run = finish(deck, impact, 0.01, 1.6, moved, 'm\n*ELEMENT GROUP, SCHEME=EXPLICIT, ELSET=slab')
        dragged(checks, f'slab moved by a table, {impact}', run, 0.2, 1.0)
        later = ('*BOUNDARY\nslab_N, 1\n*END STEP\n*STEP\n*DYNAMIC, DIRECT\n0.01, 1.\n'
                 '*BOUNDARY, TYPE=VELOCITY\nslab_N, 1, 1, 1.\n')
        run = finish(slab(), impact, 0.01, 0.5, later, 'm\n*ELEMENT GROUP, SCHEME=EXPLICIT, ELSET=slab')
        dragged(checks, f'slab moved in a later step, {impact}', run, 0.5, 9.0)


def check_stops(checks):
    """Sliding to rest at the very end of an increment: no friction is left, and it stays there."""
    for speed in (0.6, 0.63, 0.9):
        for impact in METHODS:
            run = finish(mass_on_floor(speed), impact, 0.01, 1.0)
            name = f'stops from {speed}, {impact}'
            slides(checks, name, run, 0.0, speed)
            still = run['history/time'] > speed / (MU * G) + 0.005
            for value, what in ((friction_of(run), 'friction force'), (run['history/node_1/A1'], 'acceleration')):
                checks.at_most(np.max(np.abs(value[still])), 1e-9, f'{name}: {what} at rest')


def check_shaking(checks):
    """A table that shakes by a table of velocities carries the mass along without slip."""
    time = np.linspace(0.0, 1.0, 21)
    speed = 0.1 * np.sin(4.0 * np.pi * time)
    pairs = '\n'.join(f'{t:.6f}, {v:.9f}' for t, v in zip(time, speed))
    for impact in METHODS:
        deck = slab().add(f'*AMPLITUDE, NAME=A\n{pairs}\n')
        run = finish(deck, impact, 0.01, 1.0, '*BOUNDARY, TYPE=VELOCITY, AMPLITUDE=A\nslab_N, 1, 1, 1.\n',
                     'm\n*ELEMENT GROUP, SCHEME=EXPLICIT, ELSET=slab')
        name = f'shaking, {impact}'
        largest = np.max(np.abs(np.diff(speed))) / 0.05
        checks.close(run['history/node_1/V1'], np.interp(run['history/time'], time, speed), 0.01 * largest / 2,
                     f'{name}: velocity')
        checks.close(run['history/node_1/U1'][-1], 0.0, 1e-4, f'{name}: displacement in the end')
        checks.at_most(np.max(np.abs(friction_of(run))), M * largest * (1.0 + 1e-6), f'{name}: largest friction force')
        checks.at_most(np.max(np.abs(run['energy/friction'])), 1e-4, f'{name}: friction work')


checks = Checks()
check_hits(checks)
check_belts(checks)
check_slabs(checks)
check_stops(checks)
check_shaking(checks)
checks.finish()
