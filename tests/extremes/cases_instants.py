"""Impacts at the start, at the end of a step, within round-off of it, and at the end of the run."""
import sys

import numpy as np

from extreme_case import Case, Group, main
from impact_decks import (FICTITIOUS, METHODS, TRANSFORMATIONS, kinds, one_mass, slug, smallest_gap,
                          worst_balance)

# a power of two: places and times of a free flight at speed 1 have no round-off
H = 1/16
# where the wall is, in parts of a step, beside the place that is reached at the end of a step
OFFSETS = (0.0, 1e-15, -1e-15, 4e-15, -4e-15, 1e-13, -1e-13, 1e-11, -1e-11, 1e-9, -1e-9, 1e-6,
           -1e-6)
# merged within 1e-12 of the size of the gap's numbers, which are about one
ONE_INSTANT = 3e-12
# EVENTS=ANCHOR takes times within 1e-9 of a step for one
ANCHOR_INSTANT = 2.5e-9


def slack(parameters, step=H):
    """How far a place may be off."""
    return ONE_INSTANT + ('ANCHOR' in parameters)*ANCHOR_INSTANT*step


def at_step_end(parameters, e, offset):
    """A free mass reaches the wall at t = 1 + offset*H, when the 16th step ends."""
    wall = -1 - offset*H

    def check(run, findings):
        t = run['history/time']
        exact = np.where(t < -wall, -t, wall + e*(t + wall))
        findings.close(run['history/node_1/U1'], exact, slack(parameters)*(1 + e), 'place')
        findings.close(run['history/node_1/V1'][-1], e, 1e-14, 'speed after it')
        findings.close(run.events()['time'], [-wall], slack(parameters), 'impact time')
        findings.close(np.sum(run['history/contact_B1-W1/impulse']), 1 + e, 1e-13, 'impulse')
        findings.at_least(smallest_gap(run), -slack(parameters), 'smallest gap')
        findings.at_most(worst_balance(run), 1e-13, 'energy balance')

    deck = one_mass(f'{parameters}, RESTITUTION={e}', wall)
    return Case(f'instant_step_{slug(parameters)}_{e}_{offset:g}', '', deck.text(H, 2), '', check)


def at_step_end_otherwise(parameters, offset):
    """The same by methods that find an impact at the end of the step after it."""
    wall = -1 - offset*H

    def check(run, findings):
        findings.at_least(smallest_gap(run), -1.5*H, 'smallest gap')
        findings.close(run['history/node_1/V1'][-1], 0.0 if 'LAGRANGE' in parameters else 1.0,
                       0.1, 'speed after it')
        findings.at_most(worst_balance(run), 1e-13, 'energy balance')
        u = run['history/node_1/U1']
        findings.close(u[:16], -run['history/time'][:16], 1e-14, 'place before it')

    deck = one_mass(parameters, wall)
    return Case(f'instant_step_{slug(parameters)}_{offset:g}', '', deck.text(H, 2), '', check)


def at_the_end(parameters, e, offset, steps):
    """The wall is reached where the run, or its first *STEP, ends."""
    wall = -1 - offset*H

    def check(run, findings):
        t = run['history/time']
        exact = np.where(t < -wall, -t, wall + e*(t + wall))
        findings.close(run['history/node_1/U1'], exact, 2*slack(parameters), 'place')
        speed = run['history/node_1/V1'][-1]
        if steps == 2:
            findings.close(speed, e, 1e-14, 'speed after it')
            findings.close(kinds(run)['impact'], 1, 0, 'impacts')
        else:
            # within round-off the last state is that before the impact or that after it
            findings.true(min(abs(speed + 1), abs(speed - e)) < 1e-14, f'speed at the end {speed}')
            findings.true(offset >= -1e-9 or abs(speed - e) < 1e-14, 'after an earlier impact')
        findings.at_least(smallest_gap(run), -slack(parameters), 'smallest gap')
        findings.at_most(worst_balance(run), 1e-13, 'energy balance')

    deck = one_mass(f'{parameters}, RESTITUTION={e}', wall)
    return Case(f'instant_end_{slug(parameters)}_{e}_{offset:g}_{steps}', '',
                deck.text(H, 1, steps=steps), '', check)


# speed, pull towards the wall, and what happens
STARTS = {'closing': (-1.0, 0.0), 'opening': (1.0, 0.0), 'at_rest': (0.0, 0.0),
          'pressed': (0.0, 10.0), 'lifted': (0.0, -10.0), 'closing_pressed': (-1.0, 10.0),
          'closing_lifted': (-1.0, -10.0), 'opening_pressed': (0.1, 10.0)}


def start_place(start, e, t):
    """Exact place, up to the second impact."""
    speed, pull = STARTS[start]
    speed = -e*speed if speed < 0 else speed
    if speed == 0 and pull > 0:
        return 0.0*t
    return np.where((pull > 0) & (t > 2*speed/max(pull, 1e-9)), np.nan, speed*t - pull*t**2/2)


def at_the_start(start, parameters, e):
    """A mass that touches the wall at t = 0."""
    speed, pull = STARTS[start]
    words = parameters if e is None else f'{parameters}, RESTITUTION={e}'
    soft = 'FICTITIOUS' in parameters or 'PENALTY' in parameters

    def check(run, findings):
        t, u = run['history/time'], run['history/node_1/U1']
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')
        # the deepest a spring of 300 lets it in at speed 1, or two steps of free fall
        findings.at_least(smallest_gap(run), -0.11 if soft else -1e-12, 'smallest gap')
        if soft and start in ('closing', 'pressed', 'closing_pressed', 'closing_lifted',
                              'opening_pressed'):
            findings.at_least(u[-1], -0.11, 'never through the wall')
            return
        exact = start_place(start, e or 0.0, t)
        known = np.isfinite(exact)
        if start == 'closing_lifted' and not e and ('ANCHOR' in words or 'LAGRANGE' in words):
            # what is caught is let go at the end of a step only
            late = start_place(start, 0.0, np.maximum(t - H, 0.0))
            findings.true(np.all((u <= exact + 1e-12) & (u >= late - 1e-12)), 'a step late at most')
        else:
            findings.close(u[known], exact[known], 1e-11, 'place')
        if start in ('at_rest', 'pressed', 'opening', 'lifted'):
            findings.close(len(run['events/time']), 0, 0, 'events')
        if start == 'pressed':
            findings.close(run['history/contact_B1-W1/CF1'], np.full(len(t), pull), 1e-12, 'weight')
        if start.startswith('closing'):
            findings.close(run.events()['time'][0], 0.0, 0.0, 'first impact')

    deck = one_mass(words, 0.0, speed)
    return Case(f'instant_start_{start}_{slug(words)}', '', deck.text(H, 1, gravity=-pull), '',
                check)


def single_step(parameters, e):
    """A run of one increment with an impact in the middle, one near its start, one near its end."""
    cases = []
    for wall in (-0.5, -1e-9, -1 + 1e-9, -2.0):
        def check(run, findings, wall=wall):
            exact = wall + e*(1 + wall) if wall > -1 else -1.0
            findings.close(run['history/node_1/U1'][-1], exact, 2*slack(parameters, 1), 'place')
            findings.at_most(worst_balance(run), 1e-13, 'energy balance')
        deck = one_mass(f'{parameters}, RESTITUTION={e}', wall)
        cases.append(Case(f'instant_single_{slug(parameters)}_{e}_{wall:g}', '', deck.text(1, 1),
                          '', check))
    return cases


if __name__ == '__main__':
    ES = (1.0, 0.5, 0.0)
    sys.exit(main([
        Group('instant_step', 'impact at the end of a step, or by 1e-15 to 1e-6 steps beside it',
              'one impact, place to 3e-12, with EVENTS=ANCHOR to 2.5e-9 steps',
              [at_step_end(words, e, offset) for words in TRANSFORMATIONS for e in ES
               for offset in OFFSETS]),
        Group('instant_step_others', 'the same by the other methods', 'found by the next step',
              [at_step_end_otherwise(words, offset) for words in (*FICTITIOUS, *METHODS[4:])
               for offset in OFFSETS]),
        Group('instant_end', 'impact at the end of the run or of a *STEP', 'before it or after it',
              [at_the_end(words, e, offset, steps) for words in TRANSFORMATIONS for e in ES
               for offset in OFFSETS[:6] for steps in (1, 2)]),
        Group('instant_start', 'touching at t = 0: closing, opening, at rest, pressed, lifted',
              'impact at once, or none',
              [at_the_start(start, words, e) for start in STARTS for words in METHODS
               for e in (None, *ES) if e is None or 'PENALTY' not in words
               and 'LAGRANGE' not in words]),
        Group('instant_single', 'runs of a single step', 'place to 6e-12, with EVENTS=ANCHOR to 5e-9',
              [case for words in TRANSFORMATIONS for e in ES for case in single_step(words, e)])]))
