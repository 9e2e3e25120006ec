"""Contact nodes without mass: the tip of a spring gives way to what it meets, and nothing jumps."""
import sys

import numpy as np

from extreme_case import Case, Group, main
from impact_decks import FICTITIOUS, METHODS, OTHERS, PointDeck, slug, smallest_gap, worst_balance

K = 10.0
SOFT = 300.0     # stiffness of PENALTY in METHODS


def buffered(parameters, wall=-0.5):
    """A mass at 1 with a buffer: a spring whose tip, at 0, has no mass. It flies at a wall."""
    return (PointDeck([1.0, 0.0], -1.0, [1.0, 0.0]).impact(parameters).wall(wall, 1, (2,))
            .spring(1, 2, K))


def flight(t, stiffness):
    """Displacement of the mass: half a swing on the buffer from t = 1/2, then back."""
    omega = np.sqrt(stiffness)
    s = t - 0.5
    back = np.pi/omega
    return np.where(s < 0, -t, np.where(s < back, -0.5 - np.sin(omega*np.minimum(s, back))/omega,
                                        -0.5 + s - back))


def stiffness_of(parameters):
    """Of a buffer on a wall: that of a penalty is a spring behind it."""
    return K*SOFT/(K + SOFT) if 'PENALTY' in parameters else K


def tip(parameters):
    """The buffer hits a wall; errors at two steps."""
    penalty, stiffness = 'PENALTY' in parameters, stiffness_of(parameters)

    def check(run, findings):
        errors = []
        for one in (run, run.again(buffered(parameters).text(0.025, 3))):
            t, u = one['history/time'], one['history/node_1/U1']
            errors.append(np.abs(u - flight(t, stiffness)).max())
            findings.at_least(smallest_gap(one), -0.0105 if penalty else -1e-12, 'smallest gap')
            findings.at_most(worst_balance(one), 1e-12, 'energy balance')
            findings.close(one['history/contact_B1-W1/CF1'].max(), np.sqrt(stiffness), 5e-3,
                           'largest force')
        findings.at_most(errors[0], 3e-3, 'place of the mass at h = 0.05')
        findings.at_least(np.log2(errors[0]/errors[1]), 1.5 if penalty else 1.8, 'order')

    return Case(f'massless_tip_{slug(parameters)}', '', buffered(parameters).text(0.05, 3), '',
                check)


def between(parameters, light):
    """Two masses with a spring at one of them, whose tip meets the other: an elastic impact."""
    places, masses = [0.0, 1.0, 2.0], [2.0, 0.0, 1.0]
    # the tip belongs to the left mass, or to the right one
    if light == 1:
        deck = PointDeck(places, [1.0, 1.0, -1.0], masses).impact(parameters)
        deck.spring(1, 2, K).gap(2, 3, 0.5)
        exact = [1 - 4/3, -1 + 8/3]
    else:
        deck = PointDeck(places, [0.0, -1.0, -1.0], masses).impact(parameters)
        deck.spring(2, 3, K).gap(1, 2, 0.5)
        exact = [-2/3, 1/3]

    def check(run, findings):
        v = [run[f'history/node_{node}/V1'][-1] for node in (1, 3)]
        findings.close(v, exact, 1e-3, 'speeds after it')
        findings.close(2*v[0] + v[1], 2*exact[0] + exact[1], 1e-12, 'momentum')
        findings.at_most(worst_balance(run), 1e-12, 'energy balance')

    return Case(f'massless_between_{light}_{slug(parameters)}', '', deck.text(0.01, 4), '', check)


def trapped(parameters):
    """Buffers on both sides of a mass between walls that are as far apart as they are long."""
    deck = (PointDeck([1.0, 0.0, 2.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]).impact(parameters)
            .wall(0, 1, (2,)).wall(2, -1, (3,)).spring(1, 2, K).spring(1, 3, K))

    def check(run, findings):
        t, omega = run['history/time'], np.sqrt(stiffness_of(parameters))
        # one buffer at a time pushes, the other one hangs free
        findings.close(run['history/node_1/U1'], np.sin(omega*t)/omega, 2e-3, 'place of the mass')
        findings.at_least(smallest_gap(run), -0.0105 if 'PENALTY' in parameters else -1e-12,
                          'smallest gap')
        findings.at_most(worst_balance(run), 1e-11, 'energy balance')

    return Case(f'massless_trapped_{slug(parameters)}', '', deck.text(0.01, 5), '', check)


def redistributed(parameters):
    """A strip of plane elements whose face on the wall has given its mass away: E v/c = 300."""
    n, length = 50, 10.0
    nodes = [f'{2*i + j + 1}, {i*length/n!r}, {j*0.2!r}' for i in range(n + 1) for j in (0, 1)]
    elements = [f'{i + 1}, {2*i + 1}, {2*i + 3}, {2*i + 4}, {2*i + 2}' for i in range(n)]
    deck = '\n'.join(['*NODE, NSET=ALL', *nodes, '*ELEMENT, TYPE=CPS4, ELSET=BAR', *elements,
                      '*MATERIAL, NAME=STUFF', '*ELASTIC', '900, 0', '*DENSITY', '1',
                      '*SOLID SECTION, ELSET=BAR, MATERIAL=STUFF', '5',
                      '*SURFACE, NAME=END', '1, S4', '*RIGID SURFACE, NAME=WALL, TYPE=PLANE',
                      '-0.5, 0, 0', '1, 0, 0', '*SURFACE INTERACTION, NAME=HIT',
                      f'*IMPACT, {parameters}', '*CONTACT PAIR, INTERACTION=HIT, '
                      'MASS=REDISTRIBUTED', 'END, WALL', '*INITIAL CONDITIONS, TYPE=VELOCITY',
                      'ALL, 1, -10', '*STEP', '*DYNAMIC, DIRECT', '0.004, 1',
                      '*CONTACT PRINT', 'CF, CDIS', '*ENERGY PRINT', '*END STEP']) + '\n'

    def check(run, findings):
        t, force = run['history/time'], run['history/contact_END-WALL/CF1']
        inside = (t > 0.05 + 0.1*2/3) & (t < 0.05 + 0.9*2/3)
        findings.close(np.mean(force[inside]), 300.0, 1.5, 'mean force')
        findings.at_most(np.std(force[inside]), 4.0, 'its standard deviation')
        total = run['energy/total']
        findings.close(total[-1]/total[0], 1.0, 2e-3, 'energy, relative')
        findings.at_least(smallest_gap(run), -1e-11, 'smallest gap')

    return Case(f'massless_face_{slug(parameters)}', '', deck, '', check)


def refused(name, parameters, words):
    """What means nothing without mass is an error."""
    return Case(f'massless_refused_{name}', '', buffered(parameters).text(0.05, 3), '', status=2,
                words=words)


ALL = ('BETA=1/4', 'RESTITUTION=0', *FICTITIOUS, *OTHERS)

if __name__ == '__main__':
    sys.exit(main([
        Group('massless_tip', 'the tip of a spring without mass hits a wall',
              'half a swing, second order', [tip(words) for words in ALL]),
        Group('massless_between', 'the tip of a spring on one mass hits another mass',
              'speeds of an elastic impact', [between(words, light) for light in (1, 2)
                                              for words in ('BETA=1/4', 'METHOD=LAGRANGE',
                                                            'METHOD=FICTITIOUS FORCE')]),
        Group('massless_trapped', 'two such tips that just touch two walls',
              'an oscillator', [trapped(words) for words in ALL]),
        Group('massless_face', 'MASS=REDISTRIBUTED on the end of a bar',
              'force of the wave, energy kept', [redistributed(words) for words in METHODS[:1]
                                                 + FICTITIOUS[:1] + OTHERS[1:]]),
        Group('massless_refused', 'what means nothing without mass', 'an error of the deck', [
            refused('restitution', 'RESTITUTION=0.5', ('node 2 has no mass', 'RESTITUTION')),
            refused('fictitious', 'METHOD=FICTITIOUS FORCE, RESTITUTION=1', ('no mass',)),
            refused('anchor', 'EVENTS=ANCHOR', ('contact nodes without mass',))])]))
