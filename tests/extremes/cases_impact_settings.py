"""RESTITUTION, CAPTURE, MAX EVENTS and RETURN at their ends, and restitutions mixed in one model."""
import sys

import numpy as np

from extreme_case import Case, Group, main
from impact_decks import (FICTITIOUS, METHODS, TRANSFORMATIONS, PointDeck, is_capped, kinds,
                          one_mass, slug, smallest_gap, worst_balance)


def restitution(parameters, e):
    """One impact at an e so near to 0 or 1 that round-off could swallow it."""
    def check(run, findings):
        events, v = run.events(), run['history/node_1/V1'][-1]
        findings.close(v, e, 1e-15 + 1e-3*min(e, 1 - e), 'speed after it')
        findings.close(run['energy/impact_loss'][-1] + run['energy/total'][-1], 0.5, 1e-13,
                       'energy left and taken')
        findings.at_least(len(events['time']), 1, 'impacts')
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')
        findings.at_least(smallest_gap(run), -0.09 if 'FICTITIOUS' in parameters else -1e-12,
                          'smallest gap')

    return Case(f'setting_e_{slug(parameters)}_{e!r}', '',
                one_mass(f'{parameters}, RESTITUTION={e!r}').text(0.1, 3), '', check)


def capture(parameters, limit, pull):
    """A ball with e = 0.7 and a CAPTURE far above all its speeds, or below what can be computed."""
    def check(run, findings):
        u, v = run['history/node_1/U1'], run['history/node_1/V1']
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')
        if 'FICTITIOUS' in parameters:
            findings.at_least(smallest_gap(run), -0.4, 'smallest gap')
            findings.at_most(np.abs(v[-1]), 1.0, 'speed at last')
            return
        findings.at_least(smallest_gap(run), -1e-12, 'smallest gap')
        impacts = kinds(run)['impact']
        if limit >= 10 or pull:
            findings.close([u[-1], v[-1]], [-0.5, 0.0], 1e-12, 'lies on the wall at last')
            findings.close(kinds(run)['capture'], 1, 0, 'captures')
            findings.true(impacts == 1 if limit >= 10 else impacts > 20, f'{impacts} impacts')
        else:
            findings.close([u[-1], v[-1]], [-0.5 + 0.7*2.5, 0.7], 1e-12, 'flies off')

    words = f'{parameters}, RESTITUTION=0.7, CAPTURE={limit!r}'
    return Case(f'setting_capture_{slug(parameters)}_{limit!r}_{pull}', '',
                one_mass(words).text(0.1, 3, gravity=-pull), '', check)


def few_events(parameters, limit, words):
    """Three masses with springs, gaps and walls, steps far too long for MAX EVENTS."""
    deck = PointDeck([0.0, 1.0, 2.0], [-1.0, -2.0, -3.0])
    deck.impact(f'{parameters}, MAX EVENTS={limit}{words}').gap(1, 2, 0.3).gap(2, 3, 0.4)
    deck.wall(-0.5, 1).wall(2.5, -1, (3,)).ground(1, 3.0).ground(2, 1.0).ground(3, 2.0)

    def check(run, findings):
        total = run['energy/total']
        findings.true(is_capped(run) == ('limit' in kinds(run)), 'the log speaks of MAX EVENTS')
        if 'FICTITIOUS' in parameters:
            findings.at_most(worst_balance(run), 1e-12, 'energy balance')
            findings.at_least(smallest_gap(run), -4.0, 'smallest gap')
            return
        findings.true(is_capped(run), 'MAX EVENTS is reached')
        findings.at_most(total.max(), 7.0*(1 + 1e-12), 'largest energy')
        findings.at_least(smallest_gap(run), -1e-11, 'smallest gap')
        # each row is caught once a step at most
        findings.at_most(len(run['events/time']), 10*(limit*3 + 12), 'events')
        if 'ANCHOR' not in parameters:
            findings.at_most(worst_balance(run), 1e-11, 'energy balance')

    return Case(f'setting_events_{slug(parameters)}_{limit}{slug(words)}', '',
                deck.text(1.7, 17), '', check)


def corner(one, other, e, directions):
    """A mass flies into the corner of two walls of different e; each turns its own speed."""
    normals = {'square': ((1, 0), (0, 1)), 'same': ((1, 0), (1, 0)),
               'wedge': ((0.8, 0.6), (0.8, -0.6))}[directions]
    start = (-1.0, -1.0) if directions == 'square' else (-1.0, 0.25)
    deck = PointDeck([(0.0, 0.0)], [start]).impact(one, 'ONE').impact(other, 'OTHER')
    for normal, name in zip(normals, ('ONE', 'OTHER')):
        distance = 0.5*np.abs(np.dot(normal, start))
        deck.wall(tuple(-distance*np.array(normal)), normal, (1,), name)

    def check(run, findings):
        v = np.array([run['history/node_1/V1'][-1], run['history/node_1/V2'][-1]])
        before = np.array([np.dot(normal, start) for normal in normals])
        rates = np.array([np.dot(normal, v) for normal in normals])
        findings.close(len(set(run.events()['time'])), 1, 0, 'instants')
        if directions == 'same':
            findings.close(rates, np.full(2, max(e)), 1e-13, 'speed after it')
        else:
            findings.close(rates, -np.array(e)*before, 1e-13, 'speeds across the walls')
        findings.at_least(smallest_gap(run), -1e-12, 'smallest gap')
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')

    return Case(f'setting_corner_{directions}_{slug(one)}_{slug(other)}', '', deck.text(0.05, 3),
                '', check)


def apart(method, walls):
    """Two masses without a tie, one at a wall with e = 0, one with e = 1; and a third at both."""
    deck = PointDeck([(0.0, 0.0), (0.0, 1.0), (0.0, 2.0)], [-1.0, -1.0, -1.0])
    deck.impact(f'{method}, RESTITUTION=0', 'DEAD').impact(f'{method}, RESTITUTION=1', 'LIVELY')
    deck.wall(-0.5, 1, (1, 3), 'DEAD').wall(walls, 1, (2, 3), 'LIVELY')

    def check(run, findings):
        v = [run[f'history/node_{node}/V1'][-1] for node in (1, 2, 3)]
        # the third meets the nearer wall first
        third = 1.0 if walls >= -0.5 else 0.0
        findings.close(v, [0.0, 1.0, third], 1e-13, 'speeds')
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')
        findings.at_least(smallest_gap(run), -1e-12, 'smallest gap')

    return Case(f'setting_apart_{slug(method)}_{walls}', '', deck.text(0.05, 3), '', check)


def piled(method, wall_e, gap_e):
    """Two masses in touch fly at a wall: e of the wall and of the gap between them differ."""
    deck = PointDeck([0.0, 1.0], -1.0).impact(f'{method}, RESTITUTION={wall_e}', 'WALL')
    deck.impact(f'{method}, RESTITUTION={gap_e}', 'GAP').wall(-0.5, 1, (1,), 'WALL')
    deck.gap(1, 2, 0.0, 'GAP')

    def check(run, findings):
        u, v = ([run[f'history/node_{node}/{name}1'] for node in (1, 2)] for name in 'UV')
        findings.at_least(np.min(u[1] - u[0]), -1e-11, 'smallest gap between them')
        findings.at_least(v[0][-1], -1e-12, 'the first one stays or leaves')
        findings.at_least(v[1][-1] - v[0][-1], -1e-12, 'the second one is no slower')
        findings.at_most(run['energy/total'].max(), 1 + 1e-12, 'largest energy')
        if wall_e == gap_e == 1:
            findings.close([v[0][-1], v[1][-1]], [1.0, 1.0], 1e-12, 'both turn round')
        if wall_e == gap_e == 0:
            findings.close([v[0][-1], v[1][-1]], [0.0, 0.0], 1e-12, 'both stay')
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')

    return Case(f'setting_piled_{slug(method)}_{wall_e}_{gap_e}', '', deck.text(0.05, 3), '', check)


def returned(alpha, solution):
    """The fictitious force with RETURN near 0 and near 1: overlap free/(1 + alpha) at first."""
    parameters = f'METHOD=FICTITIOUS FORCE, RETURN={alpha!r}{solution}'
    dt = 0.1

    def check(run, findings):
        gap = run['history/node_1/U1'] + 0.45
        first = np.argmax(gap < -1e-9)
        free = gap[first - 1] - dt
        findings.close(gap[first], free/(1 + alpha), 1e-9, 'overlap of the first step')
        # a spring of alpha/(beta dt^2) lets it in by 1/omega, and a step before it starts
        omega = np.sqrt(alpha/0.25)/dt
        findings.at_least(gap.min(), -(1/omega + dt), 'smallest gap')
        findings.close(run['history/node_1/V1'][-1], 1.0, 0.25, 'speed after it')
        findings.at_most(worst_balance(run), 1e-9, 'energy balance')

    end = 4 + np.ceil(20*np.pi/np.sqrt(4*alpha))/10
    return Case(f'setting_return_{alpha!r}{slug(solution)}', '',
                one_mass(parameters, wall=-0.45).text(dt, end), '', check)


def thrown_at(parameters, dt):
    """A mass on a spring that is thrown at a wall over and over: it never gets through."""
    deck = PointDeck([0.0]).moved([1.0]).ground(1, 1.0).impact(parameters).wall(-0.5, 1)

    def check(run, findings):
        total, soft = run['energy/total'], 'FICTITIOUS' in parameters or 'PENALTY' in parameters
        findings.at_least(smallest_gap(run), -1.2*dt - 0.06 if soft else -1e-11, 'smallest gap')
        # the springs of PENALTY gain up to 5 % in each of 24 contacts, as k dt^2 is 3 masses
        most = 1.05**24 if 'PENALTY' in parameters and dt > 0.05 else 1.3
        findings.at_most(total.max()/total[0], most if soft else 1.002, 'largest energy, relative')
        if 'ANCHOR' not in parameters:
            findings.at_most(worst_balance(run), 1e-11, 'energy balance')

    return Case(f'setting_thrown_{slug(parameters)}_{dt}', '', deck.text(dt, 1000*dt), '', check)


if __name__ == '__main__':
    SMALL = (1e-12, 1e-300, 1 - 1e-15, 1 - 2.0**-53)
    MIXED = tuple((one, other) for one in (0, 0.5, 1) for other in (0, 0.5, 1) if one != other)
    SUBSTEP, ANCHOR = 'METHOD=TRANSFORMATION', 'EVENTS=ANCHOR'
    sys.exit(main([
        Group('setting_e', 'e = 1e-12, 1e-300, 1 - 1e-15, 1 - 1e-16', 'speed after it',
              [restitution(words, e) for words in (*TRANSFORMATIONS, *FICTITIOUS) for e in SMALL]),
        Group('setting_capture', 'CAPTURE = 1e300, 10, 1e-300, 0', 'caught at once, or at rest',
              [capture(words, limit, pull) for words in (*TRANSFORMATIONS, *FICTITIOUS)
               for limit in (1e300, 10, 1e-300, 0) for pull in (0, 10)]),
        Group('setting_events', 'MAX EVENTS = 1 to 5', 'no overlap, no gain, the log tells',
              [few_events(words, limit, e) for words in (*TRANSFORMATIONS, *FICTITIOUS)
               for limit in (1, 2, 5) for e in ('', ', RESTITUTION=0.7')
               if limit == 1 or 'FICTITIOUS' not in words and e]),
        Group('setting_mixed_corner', 'one node at two walls, e of each 0, 0.5 or 1',
              'each by its own e',
              [corner(f'{method}, RESTITUTION={one}', f'{method}, RESTITUTION={other}',
                      (one, other), directions) for method in (SUBSTEP, ANCHOR)
               for directions in ('square', 'same') for one, other in MIXED]),
        Group('setting_mixed_bodies', 'e = 0 and 1 in one model', 'each by its own e',
              [apart(method, walls) for method in (SUBSTEP, ANCHOR) for walls in (-0.4, -0.6)]
              + [piled(method, one, other) for method in (SUBSTEP, ANCHOR)
                 for one in (0, 0.5, 1) for other in (0, 0.5, 1)]),
        Group('setting_return', 'RETURN = 1e-6, 1e-3, 0.999, 1 - 1e-6', 'overlap free/(1 + alpha)',
              [returned(alpha, solution) for alpha in (1e-3, 0.999, 1 - 1e-6)
               for solution in ('', ', SOLUTION=DIRECT')]),
        Group('setting_thrown', 'every method, steps of 0.01 to 1', 'never through the wall',
              [thrown_at(words, dt) for words in METHODS + ('BETA=1/4, RESTITUTION=1',
               'EVENTS=ANCHOR, RESTITUTION=0.5', 'METHOD=FICTITIOUS FORCE, RESTITUTION=1')
               for dt in (0.01, 0.1)])]))
