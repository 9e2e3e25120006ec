"""Grazing impacts: tails of bouncing balls, turning points that just reach a wall, slow approach."""
import sys

import numpy as np

from extreme_case import Case, Group, main
from impact_decks import PointDeck, kinds, smallest_gap, worst_balance


def tail(e, speed, dt, every=1):
    """A ball thrown up from the floor at a speed; it rests after 2 v/(g (1 - e))."""
    g, rest = 10.0, 2*speed/(10.0*(1 - e))
    end = dt*np.ceil(1.05*rest/dt)
    parameters = f'RESTITUTION={e!r}, BETA=1/4, CAPTURE=0, MAX EVENTS=1000000'
    requests = f'*NODE PRINT, FREQUENCY={every}\nU, V, A\n*CONTACT PRINT\nCF, CDIS\n*ENERGY PRINT'
    deck = PointDeck([0.0], [speed]).impact(parameters).wall(0, 1)

    def check(run, findings):
        events = run.events()
        before = -events['gap_rate_before']
        n = len(before)
        exact = speed*e**np.arange(n)
        # the last bounces come within the round-off of a step's gaps
        seen = exact > 1e-6*g*dt
        findings.close(before[seen]/exact[seen], np.ones(seen.sum()), 1e-6, 'speeds, relative')
        times = 2*speed/g*np.cumsum(e**np.arange(n))
        findings.close(events['time'], times, 1e-7*rest + 1e-11*dt, 'impact times')
        findings.close(run.events('capture')['time'], [rest], 1e-6*rest, 'time of rest')
        findings.at_most(np.abs(run['history/node_1/U1'][-1]), 0.0, 'place at the end')
        findings.close(run['history/contact_B1-W1/CF1'][-1], g, 1e-12*g, 'weight at the end')
        findings.at_least(smallest_gap(run), -1e-11*g*dt**2, 'smallest gap')
        findings.at_most(worst_balance(run), 1e-11, 'energy balance')
        findings.measured(f'{n} impacts, slowest {before[before > 0].min():.1e}, at rest at '
                          f'{run.events("capture")["time"][0]:.9g} (exact {rest:.9g})')

    return Case(f'graze_tail_{1 - e:.0e}_{speed:.0e}', f'tail of a ball, e = {e}, thrown at {speed}',
                deck.text(dt, end, gravity=-g, requests=requests),
                'speeds and times by e^k, comes to rest in time', check, seconds=60)


def ceiling(depth):
    """A ball between a floor and a ceiling that is lower than it would fly by a depth; e = 1."""
    g, speed, n = 10.0, 1.0, 1000
    top = speed**2/(2*g)
    deck = (PointDeck([0.0], [speed]).impact('RESTITUTION=1, BETA=1/4, CAPTURE=0').wall(0, 1)
            .wall(top - depth, -1))
    touch = np.sqrt(2*g*depth)
    period = 2*(speed - touch)/g

    def check(run, findings):
        u, v = run['history/node_1/U1'], run['history/node_1/V1']
        walls = run['events/pair']
        findings.at_most(np.abs((v**2/2 + g*u)/0.5 - 1).max(), 1e-11, 'energy')
        findings.close(np.sum(walls == walls[0]), np.sum(walls != walls[0]), 1, 'by turns')
        # the speed there is uncertain by the round-off of the gap, 1e-12, over itself
        slack = 1 + n*2*1e-12/touch/period
        findings.close(len(walls), 2*n, 2*slack, 'impacts')
        findings.at_least(smallest_gap(run), -1e-12, 'smallest gap')
        speeds = np.abs(run['events/gap_rate_before'])
        speeds = speeds[speeds < 0.5] if touch < 0.5 else speeds[walls == walls[0]]
        findings.close(speeds/touch, np.ones(len(speeds)), 1e-10/touch**2 + 1e-9,
                       'speeds at the ceiling, relative')

    return Case(f'graze_ceiling_{depth:.0e}', '', deck.text(0.0137, 0.0137*np.floor(n*period/0.0137),
                                                            gravity=-g), '', check)


def brushing(depth, parameters):
    """An oscillator that the trapezoidal rule turns just inside the wall, or just outside."""
    deck = PointDeck([0.0]).moved([1.0]).ground(1, 1.0).impact(parameters).wall(-1 + depth, 1)

    def check(run, findings):
        findings.at_most(np.abs(run['energy/total']/0.5 - 1).max(), 1e-4, 'energy')
        findings.at_most(worst_balance(run), 1e-11, 'energy balance')
        findings.at_least(smallest_gap(run), -1e-11, 'smallest gap')
        findings.at_most(kinds(run).get('impact', 0), 40, 'impacts in 32 periods')

    return Case(f'graze_brushing_{depth:.0e}', '', deck.text(0.1, 200.0), '', check)


def slow(speed, e):
    """Masses that creep to a wall while another is fast: less than 1e-12 of its speed is rest."""
    deck = (PointDeck([0.0, 0.0], [-speed, -1.0]).impact(f'RESTITUTION={e!r}, BETA=1/4, CAPTURE=0')
            .wall(-3*speed, 1).wall(-3.0, 1, (2,)))

    def check(run, findings):
        t = run['history/time']
        for node, size in ((1, speed), (2, 1.0)):
            exact = np.where(t < 3, -size*t, -3*size + e*size*(t - 3))
            findings.close(run[f'history/node_{node}/U1'], exact, 2e-11, f'place of node {node}')
        findings.at_least(smallest_gap(run), -1e-11, 'smallest gap')
        findings.at_most(np.abs(run['history/node_1/V1']).max(), speed, 'speed of the slow one')

    return Case(f'graze_slow_{speed:.0e}_{e}', '', deck.text(0.1, 10.0), '', check)


DEPTHS = (1e-28, 1e-16, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6)

if __name__ == '__main__':
    sys.exit(main([
        tail(0.9998, 1.0, 10.0),
        Group('graze_tails', 'tails of balls, slow from the start', 'speeds and times by e^k',
              [tail(0.99, 1.0, 1.0), tail(0.9, 1e-3, 1e-3), tail(0.5, 1e-4, 1.0),
               tail(0.5, 1e-14, 1e-16)]),
        Group('graze_ceiling', 'a ball that reaches a ceiling with hardly any speed, 1000 times',
              'both walls by turns, energy to 1e-11',
              [ceiling(depth) for depth in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10)]),
        Group('graze_brushing', 'an oscillator whose amplitude just reaches the wall',
              'no overlap, no energy', [brushing(depth, f'BETA=1/4{words}') for depth in DEPTHS
                                        for words in ('', ', RESTITUTION=1', ', RESTITUTION=0.5',
                                                      ', RESTITUTION=1, CAPTURE=0')]),
        Group('graze_slow', 'speeds down to 1e-14 beside one of 1', 'places to 2e-11',
              [slow(speed, e) for speed in (1e-6, 1e-10, 1e-12, 1e-13, 1e-14)
               for e in (1.0, 0.5, 0.0)])]))
