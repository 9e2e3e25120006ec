"""A thousand impacts at one instant: rows of masses, the side of a strip, Newton's cradle."""
import sys

import numpy as np

from extreme_case import Case, Group, main
from impact_decks import TRANSFORMATIONS, PointDeck, slug, smallest_gap, worst_balance

# Arrival that differs by so much is one instant.
JITTER = 1e-12


def row(n, e, method, jitter):
    """n masses beside each other that fly at one wall; all hit at t = 1/2."""
    deck = (PointDeck([(0, i) for i in range(n)], -1.0).impact(f'{method}, RESTITUTION={e}')
            .wall(-0.5, 1, range(1, n + 1)))
    if jitter:
        deck.moved(jitter*np.sin(np.arange(n)))

    def check(run, findings):
        events, t = run.events(), run['history/time']
        findings.close(len(events['time']), n, 0, 'impacts')
        findings.close(len(set(events['time'])), 1, 0, 'instants')
        findings.close(events['time'], np.full(n, 0.5), 2*jitter + 1e-15, 'impact time')
        findings.close(events['impulse'], np.full(n, 1 + e), 1e-13, 'impulses')
        exact = np.where(t < 0.5, -t, -0.5 + e*(t - 0.5))
        worst = max(np.abs(run[f'history/node_{i + 1}/U1'] - exact).max() for i in range(n))
        findings.at_most(worst, 3*jitter + 1e-14, 'places')
        findings.close(run['energy/impact_loss'][-1], n*(1 - e**2)/2, 1e-11, 'energy taken')
        findings.at_least(smallest_gap(run), -2*jitter, 'smallest gap')

    return Case(f'together_row_{e}_{slug(method)}_{jitter:g}', '', deck.text(0.3, 1.2), '', check)


def strip(n, parameters, dt=0.004):
    """The long side of an elastic strip, two elements thick, hits a wall flat."""
    across, length, thickness, gap = 2, 10.0, 0.05, 0.1
    node = lambda i, j: j*(across + 1) + i + 1                               # noqa: E731
    lines = ['*NODE'] + [f'{node(i, j)}, {i*thickness/across!r}, {j*length/(n - 1)!r}'
                         for j in range(n) for i in range(across + 1)]
    lines += ['*ELEMENT, TYPE=CPS4, ELSET=STRIP']
    lines += [f'{j*across + i + 1}, {node(i, j)}, {node(i + 1, j)}, {node(i + 1, j + 1)}, '
              f'{node(i, j + 1)}' for j in range(n - 1) for i in range(across)]
    last = node(across, n - 1)
    lines += ['*MATERIAL, NAME=STUFF', '*ELASTIC', '100, 0', '*DENSITY', '1',
              '*SOLID SECTION, ELSET=STRIP, MATERIAL=STUFF', '1',
              '*ELEMENT GROUP, ELSET=STRIP, SCHEME=IMPLICIT, MASS=LUMPED',
              '*NSET, NSET=ALL, GENERATE', f'1, {last}',
              '*NSET, NSET=SIDE, GENERATE', f'1, {node(0, n - 1)}, {across + 1}',
              '*ELSET, ELSET=FIRST, GENERATE', f'1, {(n - 2)*across + 1}, {across}',
              '*SURFACE, NAME=SIDE', 'FIRST, S4', '*RIGID SURFACE, NAME=WALL, TYPE=PLANE',
              f'{-gap}, 0, 0', '1, 0, 0', '*SURFACE INTERACTION, NAME=HIT',
              f'*IMPACT, {parameters}', '*CONTACT PAIR, INTERACTION=HIT', 'SIDE, WALL',
              '*INITIAL CONDITIONS, TYPE=VELOCITY', 'ALL, 1, -1', '*STEP', '*DYNAMIC, DIRECT',
              f'{dt}, 0.2', '*NODE PRINT, NSET=SIDE', 'U, V', '*CONTACT PRINT', 'CF, CDIS',
              '*ENERGY PRINT', '*END STEP']

    def check(run, findings):
        speeds = np.array([run[f'history/node_{node(0, j)}/V1'] for j in range(n)])
        findings.at_most(np.ptp(speeds, axis=0).max(), 1e-11, 'speeds along the side differ by')
        findings.at_most(worst_balance(run), 1e-11, 'energy balance')
        total = run['energy/total']
        if 'FICTITIOUS' in parameters:
            findings.at_most(total.max(), 1.02*total[0], 'largest energy')
            findings.at_least(smallest_gap(run), -2*dt, 'smallest gap')
            return
        findings.at_least(smallest_gap(run), -1e-12, 'smallest gap')
        findings.at_most(total.max(), total[0]*(1 + 1e-11), 'largest energy')
        first = run.events()['time']
        findings.close(np.sum(first == first[0]), n, 0, 'nodes that hit at the first instant')
        findings.close(first[0], gap, 1.01*dt if 'LAGRANGE' in parameters else 1e-11,
                       'first instant')
        if 'RESTITUTION=1' in parameters:
            findings.close(total[-1], total[0], 1e-11, 'energy')
        else:
            # what stops is a quarter of the mass, in nodes on the side; where rows let go at the
            # ends of steps only, the release gives some of it back
            e = 0.5 if 'RESTITUTION=0.5' in parameters else 0.0
            loss = run['energy/impact_loss']/total[0]
            findings.close(loss.max(), 0.25, 1e-10 if e == 0 else 0.07, 'energy taken, relative')

    return Case(f'together_strip_{n}_{slug(parameters)}', '', '\n'.join(lines) + '\n', '', check,
                seconds=60)


def cradle(n, e, gap, limit=100000):
    """n balls in a row, the first one flies at the others; the row is one apart but for the gaps."""
    deck = PointDeck(range(n), [1.0] + (n - 1)*[0.0])
    deck.impact(f'RESTITUTION={e}, MAX EVENTS={limit}')
    for i in range(1, n):
        deck.gap(i, i + 1, gap)
    text = deck.text(0.5, 1 + n*gap, requests='*NODE PRINT\nU, V\n*ENERGY PRINT')

    def check(run, findings):
        u = np.array([run[f'history/node_{i + 1}/U1'] for i in range(n)])
        v = np.array([run[f'history/node_{i + 1}/V1'][-1] for i in range(n)])
        findings.close(v.sum(), 1.0, 1e-12, 'momentum')
        findings.at_least(np.diff(u, axis=0).min(), -gap - 1e-11, 'smallest gap')
        if e == 1:
            # one after the other hands its speed on
            findings.close(v, np.eye(n)[-1], 1e-9/n**-1, 'speeds')
            findings.close(np.sum(run['energy/kinetic'][-1]), 0.5, 1e-11, 'energy')
        elif gap == 0:
            findings.close(v, np.full(n, 1/n), 1e-9, 'speeds')
        findings.at_most(worst_balance(run), 1e-11, 'energy balance')

    return Case(f'together_cradle_{n}_{e}_{gap:g}_{limit}', '', text, '', check, seconds=60)


if __name__ == '__main__':
    sys.exit(main([
        Group('together_row', 'a thousand masses hit a wall at one instant, also 1e-12 apart',
              'one instant, impulse 1 + e each',
              [row(1000, e, method, jitter) for e, method, jitter in
               ((0.0, 'BETA=1/4', 0), (0.5, 'BETA=1/4', JITTER),
                (1.0, 'EVENTS=ANCHOR', JITTER))]),
        Group('together_strip', 'the side of a strip hits flat, up to 1000 nodes at once',
              'all at one instant, alike to 1e-11, e = 1 keeps the energy',
              [strip(1000, 'BETA=1/4, RESTITUTION=1'), strip(300, 'BETA=1/4, RESTITUTION=0'),
               strip(300, 'BETA=1/4, RESTITUTION=0.5')]
              + [strip(100, words) for words in (*TRANSFORMATIONS, 'METHOD=LAGRANGE',
                                                 'METHOD=FICTITIOUS FORCE')]),
        Group('together_cradle', 'a row of balls in touch, or nearly, is hit at its end',
              'e = 1: only the last one goes on; e < 1: all together', [
                  cradle(1000, 1.0, 0.0), cradle(300, 1.0, 1e-13), cradle(300, 1.0, 0.01),
                  cradle(500, 0.0, 0.0), cradle(30, 0.5, 0.0), cradle(300, 0.5, 0.0, 100)])],
        [Group('together_cradle_long', 'a row of 100 balls in touch, e = 0.5',
               'half a million impacts at one instant', [cradle(100, 0.5, 0.0)])]))
