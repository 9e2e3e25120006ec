"""Bodies so thin, or steps so long, that a node could pass through in one step unseen."""
import sys

import numpy as np

from extreme_case import Case, Group, main
from impact_decks import PointDeck, slug, worst_balance


def with_circle(deck, radius):
    """The first node of a deck may touch a rigid circle around the origin."""
    deck.lines += ['*SURFACE, NAME=B, TYPE=NODE', '1', '*RIGID SURFACE, NAME=C, TYPE=CIRCLE',
                   '0, 0', repr(float(radius)), '*CONTACT PAIR, INTERACTION=HIT', 'B, C']
    return deck


def path(run, place):
    """Where node 1 is at all times, (2, n)."""
    return np.array([place[i] + run[f'history/node_1/U{i + 1}'] for i in range(2)])


def around(place, speed, radius, e, times):
    """Exact places of a point that bounces outside (or, with radius < 0, inside) of a circle."""
    x, v, t, places = np.array(place, float), np.array(speed, float), 0.0, []
    for time in times:
        while True:
            b, c = x @ v, x @ x - radius**2
            root = b**2 - c*(v @ v)
            flight = np.inf
            if root > 0:
                flight = (-b + np.sign(-radius)*np.sqrt(root))/(v @ v)
            if flight <= 1e-12 or t + flight > time:
                break
            x, t = x + flight*v, t + flight
            normal = np.sign(radius)*x/np.abs(radius)
            v = v - (1 + e)*(normal @ v)*normal
        places.append(x + v*(time - t))
    return np.array(places).T


def circle(place, speed, radius, e, dt, steps=8):
    """A point against a circle, from outside or inside; straight between impacts for any step."""
    deck = PointDeck([place], [speed]).impact(f'RESTITUTION={e}, BETA=1/4')

    def check(run, findings):
        x = path(run, place)
        exact = around(place, speed, radius, e, run['history/time'])
        findings.close(x, exact, 1e-7*max(1.0, np.abs(exact).max()), 'place')
        outward = np.sign(radius)*(np.hypot(*x) - np.abs(radius))
        findings.at_least(outward.min(), -1e-9, 'smallest distance')
        findings.at_most(worst_balance(run), 1e-11, 'energy balance')
        if e == 1:
            energy = run['energy/total']
            findings.at_most(np.abs(energy/energy[0] - 1).max(), 1e-11, 'energy')

    return Case(f'thin_circle_{radius}_{e}_{dt}', '', with_circle(deck, radius).text(dt, steps*dt),
                '', check)


def plate(parameters, dt, moves):
    """A mass at speed 10 against a plate of 0.05, of elements, held or free."""
    n = 8
    lines = ['*NODE, NSET=FLYING', '1, -1, 0.13', '*NODE, NSET=PLATE']
    lines += [f'{10 + 2*j + i}, {0.05*i}, {-1 + 2*j/n}' for j in range(n + 1) for i in (0, 1)]
    lines += ['*ELEMENT, TYPE=MASS, ELSET=M', '100, 1', '*MASS, ELSET=M', '1',
              '*ELEMENT, TYPE=CPS4, ELSET=P']
    lines += [f'{j + 1}, {10 + 2*j}, {11 + 2*j}, {13 + 2*j}, {12 + 2*j}' for j in range(n)]
    lines += ['*MATERIAL, NAME=S', '*ELASTIC', '1e4, 0', '*DENSITY', '10',
              '*SOLID SECTION, ELSET=P, MATERIAL=S', '1']
    lines += [] if moves else ['*BOUNDARY', 'PLATE, 1, 2']
    lines += ['*SURFACE, NAME=B, TYPE=NODE', '1', '*SURFACE, NAME=W', 'P, S4', 'P, S2',
              '*SURFACE INTERACTION, NAME=HIT', f'*IMPACT, {parameters}',
              '*CONTACT PAIR, INTERACTION=HIT', 'B, W', '*INITIAL CONDITIONS, TYPE=VELOCITY',
              '1, 1, 10', '*STEP', '*DYNAMIC, DIRECT', f'{dt}, {6*dt}', '*NODE PRINT', 'U, V',
              '*CONTACT PRINT', 'CF, CDIS', '*ENERGY PRINT', '*END STEP']

    def check(run, findings):
        speed, total = run['history/node_1/V1'][-1], run['energy/total']
        findings.at_most(worst_balance(run), 1e-9, 'energy balance')
        findings.true('impact' in [kind.decode() for kind in run['events/kind']], 'an impact')
        if not moves:
            place = -1 + run['history/node_1/U1']
            findings.at_most(place.max(), 1e-10, 'never through the plate')
            findings.close(speed, -10.0 if 'RESTITUTION=1' in parameters else 0.0, 1e-9, 'speed')
            return
        # 1 of mass against the 1 of the plate: hands over a part, and nothing is behind it
        findings.at_most(total.max()/total[0], 1 + 1e-8, 'largest energy, relative')
        momentum = speed + sum(run['model/mass'][1:, 0]*[run[f'history/node_{10 + k}/V1'][-1]
                                                         for k in range(2*n + 2)])
        # forces are found from displacements of up to 150: K d dt times round-off
        findings.close(momentum, 10.0, 1e-9 + 3e-8*dt, 'momentum')

    return Case(f'thin_plate_{slug(parameters)}_{dt}_{moves}', '', '\n'.join(lines) + '\n', '',
                check)


if __name__ == '__main__':
    DTS = (0.1, 0.5, 1.5, 3.0, 10.0, 100.0)
    sys.exit(main([
        Group('thin_circle', 'steps of 0.05 to 100 diameters past a circle', 'places to 1e-7',
              [circle((-3.0, 0.1), (2.0, 0.0), 1.0, e, dt) for e in (1, 0.5) for dt in DTS]),
        Group('thin_ring', 'the same inside a circle: many impacts a step', 'places to 1e-7',
              [circle((0.5, 0.1), (2.0, 0.3), -4.0, 1, dt, 30 if dt < 1 else 4)
               for dt in DTS[:-1]]),
        Group('thin_plate', 'a mass that goes 3 to 600 thicknesses of a plate in a step',
              'never through what is held; momentum of what is free',
              [plate(words, dt, moves) for words, moves in
               (('RESTITUTION=1, BETA=1/4', False), ('BETA=1/4', False),
                ('METHOD=LAGRANGE', False), ('RESTITUTION=1, BETA=1/4', True),
                ('BETA=1/4', True)) for dt in (0.02, 0.3, 3.0)])]))
