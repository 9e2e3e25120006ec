"""Very many impacts of one mass: no impact is lost, and round-off does not add up to energy."""
import sys

import numpy as np

from extreme_case import Case, main
from impact_decks import PointDeck, is_capped, kinds, smallest_gap

FLIGHT = 'RESTITUTION=1, BETA=1/4, CAPTURE=0, MAX EVENTS=100000'
ENERGY = 1e-9


def between_walls(n, per_step=97.3):
    """A free mass between two walls one apart, n impacts, about a hundred in a step."""
    deck = PointDeck([0.3], [1.0]).impact(FLIGHT).wall(0, 1).wall(1, -1)
    steps = round(n/per_step)

    def check(run, findings):
        end = per_step*steps
        expected = int(np.floor(0.3 + end))
        findings.close(kinds(run)['impact'], expected, 0, 'impacts')
        place = np.mod(0.3 + run['history/time'], 2.0)
        place = np.minimum(place, 2.0 - place)
        # each impact is found to 1e-12 of the way of a step
        findings.close(0.3 + run['history/node_1/U1'], place, 1e-12*per_step*expected, 'place')
        findings.at_most(np.abs(run['energy/total']/0.5 - 1).max(), ENERGY, 'energy')
        findings.true(not is_capped(run), 'MAX EVENTS is not reached')
        findings.measured(f'{expected} impacts, place {np.abs(0.3 + run["history/node_1/U1"] - place).max():.1e}'
                          f', energy {np.abs(run["energy/total"]/0.5 - 1).max():.1e}')

    return Case(f'many_between_walls_{n:.0e}'.replace('e+0', 'e'), 'a free mass between two walls',
                deck.text(per_step, per_step*steps), 'every impact, energy to 1e-9', check,
                seconds=20 + n/2000)


def sprung(n):
    """An oscillator between two walls, about three impacts in each step of a third of a radian."""
    deck = PointDeck([0.0], [3.0]).ground(1, 1.0).impact(FLIGHT).wall(-0.5, 1).wall(0.5, -1)
    # from wall to wall it takes 2 asin(0.5/3), speed at the walls sqrt(9 - 0.25)
    flight = 2*np.arcsin(0.5/3)
    steps = round(n*flight)

    def check(run, findings):
        impacts, energy = kinds(run)['impact'], np.abs(run['energy/total']/4.5 - 1).max()
        findings.close(impacts/n, 1, 0.02, 'impacts, in parts of those of the exact motion')
        findings.at_most(energy, ENERGY, 'energy')
        speeds = run.events()['gap_rate_before']
        findings.close(speeds, np.full(impacts, -np.sqrt(8.75)), 1e-9, 'speed at every impact')
        findings.at_least(smallest_gap(run), -1e-11, 'smallest gap')
        findings.measured(f'{impacts} impacts, energy {energy:.1e}')

    return Case(f'many_sprung_{n:.0e}'.replace('e+0', 'e'), 'an oscillator between two walls',
                deck.text(1.0, steps), 'energy and speed at every impact to 1e-9', check,
                seconds=20 + n/2000)


def juggled(n):
    """A ball that bounces for ever, five times in a step."""
    deck = PointDeck([0.0], [1.0]).impact(FLIGHT).wall(0, 1)

    def check(run, findings):
        u, v = run['history/node_1/U1'], run['history/node_1/V1']
        impacts = kinds(run)['impact']
        energy = np.abs((v**2/2 + 10*u)/0.5 - 1).max()
        findings.true(abs(impacts - n) <= 1, f'{impacts} impacts of {n}')
        findings.at_most(energy, ENERGY, 'energy of motion and height')
        findings.at_least(smallest_gap(run), -1e-11, 'smallest gap')
        findings.measured(f'{impacts} impacts, energy {energy:.1e}')

    return Case(f'many_juggled_{n:.0e}'.replace('e+0', 'e'), 'a ball that bounces for ever, e = 1',
                deck.text(1.0, n//5, gravity=-10), 'every bounce, energy to 1e-9', check,
                seconds=20 + n/2000)


if __name__ == '__main__':
    sys.exit(main([between_walls(10**5), sprung(10**5), juggled(3*10**4)],
                  [between_walls(10**7), sprung(10**7), juggled(10**7)]))
