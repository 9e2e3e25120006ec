"""Walls and bodies at odd speeds: along the wall only, with the wall, ten times as fast, far through it."""
import sys

import numpy as np

from extreme_case import Case, Group, main
from impact_decks import (FICTITIOUS, METHODS, TRANSFORMATIONS, PointDeck, one_mass, slug,
                          smallest_gap, worst_balance)

ALPHA = 0.3


def words_of(parameters, e):
    """Parameters of *IMPACT with a restitution, or without."""
    return parameters if e is None else f'{parameters}, RESTITUTION={e}'


def has_restitution(parameters):
    """Whether RESTITUTION may stand beside them."""
    return 'PENALTY' not in parameters and 'LAGRANGE' not in parameters


def along(parameters, friction, height):
    """A mass flies along a wall that leans, at a height above it or touching it; nothing happens."""
    normal, speed, end = np.array([0.8, 0.6]), 3.0, 100.0
    deck = PointDeck([(0.8*height, 0.6*height)], [(-0.6*speed, 0.8*speed)])
    deck.impact(parameters, friction=friction).wall(0, tuple(normal))

    def check(run, findings):
        u = np.array([run[f'history/node_1/U{i}'] for i in (1, 2)])
        v = np.array([run[f'history/node_1/V{i}'] for i in (1, 2)])
        findings.close(len(run['events/time']), 0, 0, 'events')
        findings.at_most(np.abs(normal @ u).max(), 1e-12*speed*end, 'way across the wall')
        findings.close(np.hypot(*v), np.full(u.shape[1], speed), 1e-14, 'speed')
        findings.close(np.hypot(*u), speed*run['history/time'], 1e-10, 'way')
        findings.at_most(np.abs(run['energy/total'] - 4.5).max(), 1e-13, 'energy')

    rough = '' if friction is None else f'_{friction}'
    return Case(f'speed_along_{slug(parameters)}{rough}_{height:g}', '', deck.text(0.1, end), '',
                check)


def wall_speed(parameters, wall, body, e, distance=1.0):
    """A wall and a body, each at its speed along x; the wall starts at a distance behind."""
    words = words_of(parameters, e)
    deck = PointDeck([0.0], [body]).impact(words)
    deck.wall(-distance, 1, push=1, curve=f'0, 0, 100, {100*wall!r}')
    dt = 0.03125

    def check(run, findings):
        t, u = run['history/time'], run['history/node_1/U1']
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')
        closing = wall - body
        if closing <= 1e-12 and distance >= 0:
            findings.close(u, body*t, 1e-11, 'place')
            findings.close(len(run['events/time']), 0, 0, 'events')
            return
        hit = distance/closing
        after = wall + (e or 0.0)*closing
        if has_restitution(parameters) and 'FICTITIOUS' not in parameters:
            exact = np.where(t < hit, body*t, body*hit + after*(t - hit))
            findings.close(u, exact, 1e-10, 'place')
            findings.at_least(smallest_gap(run), -1e-11, 'smallest gap')
        else:
            # found by the end of the next step, in which the gap closes by closing*dt, and driven
            # back a few steps later; a spring lets it in by closing/omega more
            depth = 1.7*dt if 'PENALTY' not in parameters else 1.05*(dt + 1/np.sqrt(300))
            findings.at_least(smallest_gap(run), -depth*closing, 'smallest gap')
            soft = e is None and 'LAGRANGE' not in parameters
            speed = run['history/node_1/V1'][-1]
            findings.close(speed, wall + (1.0 if soft else e or 0.0)*closing,
                           0.1*closing if soft else 1e-9, 'speed after it')

    return Case(f'speed_wall_{wall:g}_{body!r}_{slug(words)}_{distance:g}', '', deck.text(dt, 3),
                '', check)


def deep(parameters, e):
    """A body so fast that a step takes it a thousand times its distance behind the wall."""
    words = words_of(parameters, e)

    def check(run, findings):
        v, u = run['history/node_1/V1'], run['history/node_1/U1']
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')
        if 'FICTITIOUS' in parameters or 'PENALTY' in parameters:
            free, gap = -999.5, u + 0.5
            if 'FICTITIOUS' in parameters:
                findings.close(gap[1], free/(1 + ALPHA), 1e-9, 'overlap of the first step')
            findings.at_least(gap.min(), free, 'smallest gap')
            # caught, it is pulled out step by step; else it leaves
            last = 0.3*free if e == 0 else 0.0
            findings.at_least(gap[-1], last, 'gap at last')
            return
        findings.at_least(smallest_gap(run), -1e-9, 'smallest gap')
        findings.close(v[-1], 1000.0*(e or 0.0), 1e-6, 'speed after it')

    deck = one_mass(words, speed=-1000.0)
    return Case(f'speed_deep_{slug(words)}', '', deck.text(1.0, 12.0), '', check)


def slit(parameters, e):
    """The same between two walls a millionth apart: neither may be jumped over."""
    words = words_of(parameters + ', MAX EVENTS=5' if 'METHOD' not in parameters else parameters, e)
    deck = (PointDeck([0.0], [-1000.0]).impact(words).wall(-0.5e-6, 1).wall(0.5e-6, -1))

    def check(run, findings):
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')
        if 'FICTITIOUS' in parameters or 'PENALTY' in parameters:
            findings.at_least(smallest_gap(run), -1000.0, 'smallest gap')
            findings.at_most(run['energy/total'].max(), 5e5*1.6, 'largest energy')
            return
        findings.at_least(smallest_gap(run), -1e-9, 'smallest gap')
        findings.close(run['history/node_1/V1'][-1], 0.0, 1e-9, 'caught at MAX EVENTS')

    return Case(f'speed_slit_{slug(words)}', '', deck.text(0.05, 1.0), '', check)


PAIRS = ((10, 1), (10, -1), (-10, -1), (-10, 1), (1, 1), (-1, -1), (1e3, 1e-3), (1, 1 + 1e-13))

if __name__ == '__main__':
    ES = (None, 1.0, 0.5, 0.0)
    MOVING = tuple(words for words in METHODS if 'ANCHOR' not in words)
    sys.exit(main([
        Group('speed_along', 'velocity along the wall only, touching it or just above',
              'no event, no drift, no work', [along(words, friction, height) for words in METHODS
                                              for friction in (None, 0.0, 0.3)
                                              for height in (0.0, 1e-9)]),
        Group('speed_wall', 'walls ten and 1e6 times as fast as the body, towards it and away',
              'speed of the wall + e times the closing speed',
              [wall_speed(words, wall, body, e) for words in MOVING for wall, body in PAIRS
               for e in ES if e is None or has_restitution(words)]),
        Group('speed_with_wall', 'touching a wall that moves at the speed of the body',
              'no event', [wall_speed(words, wall, wall, e, 0.0) for words in MOVING
                           for wall in (1, -1, 1e3) for e in ES
                           if e is None or has_restitution(words)]),
        Group('speed_deep', 'a step that would lead a thousand times the distance behind the wall',
              'right answer, or the overlap that the method owes: free/(1 + alpha)',
              [deep(words, e) for words in METHODS for e in ES
               if e is None or has_restitution(words)]),
        Group('speed_slit', 'the same between walls a millionth apart', 'neither is jumped over',
              [slit(words, e) for words in (*TRANSFORMATIONS, *FICTITIOUS, *METHODS[4:])
               for e in ES[:2] if e is None or has_restitution(words)])]))
