"""Walls that close in on what is between them: chatter without bound, and no room at last."""
import sys

import numpy as np

from extreme_case import Case, Group, main
from impact_decks import (METHODS, PointDeck, is_capped, kinds, slug, smallest_gap, worst_balance)

# both walls come at a half and meet at 1
CURVE = '0, 0, 10, 5'
STOPPED = ('no room', 'pressed from opposite sides', 'an overlap of')


def add_walls(deck, left=1, right=1):
    """Walls from 0 and 1 towards each other."""
    return (deck.wall(0, 1, (left,), push=1, curve=CURVE)
            .wall(1, -1, (right,), push=-1, curve=CURVE))


def exact_place(times, place, speed, e):
    """A mass between the walls, from impact to impact."""
    t, places, going, walls = 0.0, np.empty(len(times)), speed, (0.0, 0.0)
    done = 0
    while done < len(times):
        # from where it is at t: when it meets the wall it flies at
        gap = place - 0.5*t if going < 0.5 else 1 - 0.5*t - place
        closing = 0.5 - going if going < 0.5 else going + 0.5
        if walls[0] and closing < 1e-14:
            break
        later = t + gap/closing
        while done < len(times) and times[done] <= later + 1e-12:
            places[done] = place + going*(times[done] - t)
            done += 1
        place += going*(later - t)
        going = (1 + e)*0.5 - e*going if going < 0.5 else -(1 + e)*0.5 - e*going
        t = later
    return places


def before(e, dt):
    """A free mass until the walls are a tenth apart."""
    deck = add_walls(PointDeck([0.4], [1.3]).impact(f'BETA=1/4, RESTITUTION={e}'))

    def check(run, findings):
        t = run['history/time']
        findings.close(run['history/node_1/U1'] + 0.4, exact_place(t, 0.4, 1.3, e), 1e-10, 'place')
        findings.at_least(smallest_gap(run), -1e-12, 'smallest gap')
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')

    return Case(f'closing_exact_{e}_{dt}', '', deck.text(dt, 0.9), '', check)


def until_they_meet(e, limit, dt):
    """A free mass up to the instant at which the walls meet: impacts without end."""
    words = '' if e is None else f', RESTITUTION={e}'
    deck = add_walls(PointDeck([0.4], [1.3]).impact(f'BETA=1/4, MAX EVENTS={limit}{words}'))

    def check(run, findings):
        findings.at_least(smallest_gap(run), -1e-11, 'smallest gap')
        findings.at_most(worst_balance(run), 1e-8, 'energy balance')
        findings.true(is_capped(run) == ('limit' in kinds(run)), 'the log speaks of MAX EVENTS')
        findings.true(is_capped(run) or e != 1.0, 'e = 1: MAX EVENTS is reached')
        findings.at_most(len(run['events/time']), (limit + 2)*np.ceil(1/dt) + 2, 'events')
        findings.close(run['history/node_1/U1'][-1] + 0.4, 0.5, 1e-9, 'where it ends')

    return Case(f'closing_meet_{e}_{limit}_{dt}', '', deck.text(dt, 1.0), '', check)


def no_room(parameters, masses, friction=None):
    """Rigid balls between walls that go on when there is no room any more."""
    if masses == 1:
        deck = PointDeck([0.4], [(1.3, 0.1)]).impact(parameters, friction=friction)
    else:
        deck = PointDeck([0.3, 0.5, 0.7], [1.3, -0.3, 0.2]).impact(parameters)
        deck.gap(1, 2, 0.15).gap(2, 3, 0.15)
    add_walls(deck, 1, masses)
    name = f'closing_no_room_{masses}_{slug(parameters)}' + ('_rough' if friction else '')
    if 'PENALTY' not in parameters:
        return Case(name, '', deck.text(0.01, 1.5), '', status=4, words=STOPPED)

    def check(run, findings):
        # the springs yield, one at least by half of what the walls overlap
        findings.at_most(worst_balance(run), 1e-11, 'energy balance')
        findings.at_most(smallest_gap(run), -0.25 if masses == 1 else -0.15, 'smallest gap')
        findings.at_least(smallest_gap(run), -0.8, 'smallest gap')

    return Case(name, '', deck.text(0.01, 1.5), '', check)


def squeezed(parameters):
    """Two masses with a spring between them: it yields, and then carries what the walls give."""
    deck = add_walls(PointDeck([0.3, 0.7], [1.3, -0.3]).impact(parameters), 1, 2).spring(1, 2, 100.)
    soft = 'FICTITIOUS' in parameters or 'PENALTY' in parameters

    def check(run, findings):
        findings.at_most(worst_balance(run), 1e-11, 'energy balance')
        if soft or 'RESTITUTION=1' in parameters:
            findings.at_least(smallest_gap(run), -0.5, 'smallest gap')
            return
        # caught at last: both stand on their walls, a tenth past each other
        findings.at_least(smallest_gap(run), -1e-11, 'smallest gap')
        findings.close(run['history/node_1/U1'][-1], 0.25, 1e-10, 'place of the left one')
        findings.close(run['history/node_2/U1'][-1], -0.25, 1e-10, 'place of the right one')
        findings.close(run['history/contact_B1-W1/CF1'][-1], 50.0, 1e-8, 'force of the wall')

    return Case(f'closing_squeezed_{slug(parameters)}', '', deck.text(0.01, 1.1), '', check)


def narrow(width, parameters, dt=0.05):
    """A mass between two fixed walls a hair apart, in the middle of them."""
    deck = PointDeck([0.0], [1.0]).impact(parameters).wall(-width/2, 1).wall(width/2, -1)

    def check(run, findings):
        energy = run['energy/total']
        if 'FICTITIOUS' in parameters or 'PENALTY' in parameters:
            findings.at_least(smallest_gap(run), -0.11, 'smallest gap')
            findings.at_most(energy.max(), 0.5*1.6, 'largest energy')
        else:
            findings.at_least(smallest_gap(run), -1e-12, 'smallest gap')
            findings.at_most(energy.max(), 0.5*(1 + 1e-12), 'largest energy')
            findings.true(is_capped(run) == ('limit' in kinds(run)), 'the log speaks of MAX EVENTS')
            if 'RESTITUTION=1' in parameters and not is_capped(run):
                findings.close(energy, np.full(len(energy), energy[0]), 1e-12, 'energy')
                findings.close(kinds(run).get('impact', 0), round(1.0/width), 1, 'impacts')
        findings.at_most(worst_balance(run), 1e-11, 'energy balance')

    return Case(f'closing_narrow_{width:.0e}_{slug(parameters)}', '', deck.text(dt, 1.0), '', check)


if __name__ == '__main__':
    MANY = 'BETA=1/4, RESTITUTION=1'
    sys.exit(main([
        Group('closing_exact', 'walls close in on a free mass', 'every impact, place to 1e-10',
              [before(e, dt) for e in (1.0, 0.5) for dt in (0.01, 0.1, 0.9)]),
        Group('closing_meet', 'walls until they meet, impacts without end',
              'finite, no overlap, balance to 1e-8, the log tells of MAX EVENTS',
              [until_they_meet(e, limit, dt) for e in (1.0, 0.5, 0.0, None)
               for limit in (1, 100, 1000) for dt in (0.01, 0.1, 1.0)]),
        Group('closing_no_room', 'the walls go on when there is no room for rigid balls',
              'status 4 (springs of PENALTY yield)',
              [no_room(words, n) for n in (1, 3) for words in
               (*METHODS[:1], *METHODS[2:], MANY, 'BETA=1/4, RESTITUTION=0.5',
                'METHOD=FICTITIOUS FORCE, RESTITUTION=1')]
              + [no_room(words, 1, 0.3) for words in (*METHODS[:1], *METHODS[3:], MANY)]),
        Group('closing_squeezed', 'what is between the walls can yield', 'force of its spring',
              [squeezed(words) for words in (*METHODS[:1], *METHODS[2:], MANY,
                                             'BETA=1/4, RESTITUTION=0.5')]),
        Group('closing_narrow', 'two fixed walls a hair apart', 'no overlap, no energy, or capped',
              [narrow(width, words) for width in (1e-2, 1e-3, 1e-6, 1e-9, 1e-12)
               for words in (*METHODS, MANY, 'EVENTS=ANCHOR, RESTITUTION=1')])]))
