"""Stiffnesses 1 to 1e14 and masses 1e-12 to 1e12 in one model.

Where a soft spring holds what a stiff one connects, the sum of both on the diagonal of the matrix
keeps the soft one to no more digits than round-off leaves: 2.2e-16 times the ratio. That is what
answers are held to, and beyond 1e13 the run stops. All else is as exact as any number: soft
behind stiff, light against heavy, bodies side by side, and elements of any stiffness in contact.
"""
import sys
from decimal import Decimal, getcontext

import numpy as np

from extreme_case import Case, Group, main
from point_decks import CONTACT_PRINTS, Points, step

getcontext().prec = 60
RATIOS = [10.0**k for k in (0, 2, 4, 6, 8, 10, 12, 13, 14)]
MASSES = [10.0**k for k in range(-12, 13, 3)]
EPSILON = 2.0**-52
#: a stop, where the digits of the soft spring are gone
LOST = ('singular system', 'node 2, freedom 1', 'lost in the round-off', '*EQUATION')


def allowed(ratio, times=4.0):
    """Relative error that the conditioning leaves."""
    return times*EPSILON*max(ratio, 10.0)


# Two springs in a row, pulled statically --------------------------------------------------------

def pulled(first, second):
    """Ground, spring `first`, node 1, spring `second`, node 2, force 0.7."""
    deck = Points([1, 1]).ground(1, first).link(1, 2, second).deck(
        step('STATIC, DIRECT', (1, 1), '*CLOAD', '2, 1, 0.7'))
    ratio = second/first

    def check(run, findings):
        exact = np.array([0.7/first, 0.7/first + 0.7/second])
        found = np.array([run['history/node_1/U1'][-1], run['history/node_2/U1'][-1]])
        findings.at_most(np.abs(found/exact - 1).max(), allowed(ratio), 'displacements')
    name = f'{first:g}_{second:g}'
    if ratio > 3e12:
        return Case(name, '', deck, '', status=4, words=LOST)
    return Case(name, '', deck, '', check)


# Two masses in motion ---------------------------------------------------------------------------

def two_masses(masses, stiffness, start, h, steps):
    """Displacements by the trapezoidal rule, with 60 digits; ground spring 1.3 at node 1."""
    mass = [Decimal(m) for m in masses]
    soft, stiff, h = Decimal('1.3'), Decimal(stiffness), Decimal(h)
    d, v = [Decimal(start), Decimal(start)], [Decimal(0), Decimal(0)]

    def force(d):
        link = stiff*(d[1] - d[0])
        return [link - soft*d[0], -link]
    a = [f/m for f, m in zip(force(d), mass)]
    b = h*h/4
    matrix = [[mass[0] + b*(soft + stiff), -b*stiff], [-b*stiff, mass[1] + b*stiff]]
    det = matrix[0][0]*matrix[1][1] - matrix[0][1]**2
    rows = [d]
    for _ in range(steps):
        ahead = [d[i] + h*v[i] + b*a[i] for i in (0, 1)]
        f = force(ahead)
        new = [(f[0]*matrix[1][1] - matrix[0][1]*f[1])/det,
               (matrix[0][0]*f[1] - matrix[1][0]*f[0])/det]
        d = [ahead[i] + b*new[i] for i in (0, 1)]
        v = [v[i] + h/2*(a[i] + new[i]) for i in (0, 1)]
        a = new
        rows.append(d)
    return np.array(rows, dtype=float)


def moving(masses, ratio):
    """Both let go at 0.3."""
    stiffness, h, steps = 3.7*ratio, 0.05, 100
    deck = Points(masses).ground(1, 1.3).link(1, 2, stiffness).start({1: 0.3, 2: 0.3}).deck(
        step('DYNAMIC, DIRECT', (h, h*steps)))
    # what h^2 K/4 is to the mass that moves: how many digits the matrix keeps of the latter
    lost = min(h*h*stiffness/4/(sum(masses) + h*h*1.3/4), stiffness/1.3)

    def check(run, findings):
        exact = two_masses(masses, stiffness, 0.3, h, steps)
        for i in (0, 1):
            error = np.abs(run[f'history/node_{i + 1}/U1'] - exact[:, i]).max()/0.3
            findings.at_most(error, allowed(lost, 3.0*steps), f'node {i + 1}')
        energy = run['energy/total']
        findings.at_most(np.abs(energy/energy[0] - 1).max(), allowed(lost, 3.0*steps), 'energy')
    return Case(f'{masses[0]:g}_{masses[1]:g}_{ratio:g}', '', deck, '', check)


# Impacts ----------------------------------------------------------------------------------------

def collision(first, second, e, method):
    """A mass of speed 1 hits one that comes at 1/4."""
    deck = Points([first, second]).impact(method.format(e)).gap(1, 2, 0.5).start(
        {}, {1: 1.0, 2: -0.25}).deck(step('DYNAMIC, DIRECT', (0.03, 1), prints=CONTACT_PRINTS))

    def check(run, findings):
        mean = (first - 0.25*second)/(first + second)
        findings.close(run['history/node_1/V1'][-1], mean - 1.25*e*second/(first + second), 1e-14,
                       'speed 1')
        findings.close(run['history/node_2/V1'][-1], mean + 1.25*e*first/(first + second), 1e-14,
                       'speed 2')
        before = 0.5*(first + 0.0625*second)
        findings.at_most(np.abs(run['energy/balance_error']).max()/before, 1e-13, 'balance')
    return Case(f'{first:g}_{second:g}_{e:g}_{method[7:10]}', '', deck, '', check)


METHODS = ('METHOD=TRANSFORMATION, RESTITUTION={}, BETA=1/4', 'METHOD=FICTITIOUS FORCE, RESTITUTION={}',
           'METHOD=TRANSFORMATION, EVENTS=ANCHOR, RESTITUTION={}')


def side_by_side(method, e):
    """Masses 1e-12 to 1e12, each in front of a wall of its own, hit in the same step."""
    points = Points(MASSES).impact(method.format(e))
    for i in range(len(MASSES)):
        points.wall(i + 1, i - 0.5)
    points.start({}, {i + 1: -1.0 for i in range(len(MASSES))})

    def check(run, findings):
        speeds = [run[f'history/node_{i + 1}/V1'][-1] for i in range(len(MASSES))]
        findings.close(speeds, np.full(len(MASSES), e), 1e-14, 'speeds')
        lowest = min(run[f'history/node_{i + 1}/U1'][-1] for i in range(len(MASSES)))
        # by fictitious force a node may stay where it came to rest, within the way of one step
        within = 0.03 if 'FICTITIOUS' in method else 1e-14
        findings.at_least(lowest, -0.5 - within, 'lowest place in the end')
    return Case(f'{method[7:]}_{e:g}', '', points.deck(
        step('DYNAMIC, DIRECT', (0.03, 1.5), prints=CONTACT_PRINTS)), '', check)


def pressed(method):
    """Springs 1e-7 to 1e7 that press their nodes on walls by half of their stiffness."""
    stiffness = [10.0**k for k in range(-7, 8)]
    points = Points([1.0]*15).impact(method)
    for i, k in enumerate(stiffness):
        points.ground(i + 1, k).wall(i + 1, i - 0.5)
    loads = [f'{i + 1}, 1, {-k!r}' for i, k in enumerate(stiffness)]

    def check(run, findings):
        for i, k in enumerate(stiffness):
            findings.close(run[f'history/node_{i + 1}/U1'][-1], -0.5, 1e-15, f'node {i + 1}')
            force = run[f'history/contact_S{i + 1}-W{i + 1}/CF1'][-1]
            findings.at_most(abs(force/(k/2) - 1), 1e-15, f'force {i + 1}')
    return Case(method[7:], '', points.deck(
        step('STATIC, DIRECT', (1, 1), '*CLOAD', *loads, prints=CONTACT_PRINTS)), '', check)


# Solids -----------------------------------------------------------------------------------------

def column(first, y0, n, name):
    """Nodes, elements of a column of n squares above y0; nodes from `first`, two a row."""
    nodes = [f'{first + 2*j + i}, {i}, {y0 + j/n!r}' for j in range(n + 1) for i in (0, 1)]
    corners = [first + 2*j for j in range(n)]
    elements = [f'{first + j}, {a}, {a + 1}, {a + 3}, {a + 2}' for j, a in enumerate(corners)]
    return nodes, [f'*ELEMENT, TYPE=CPS4, ELSET={name}', *elements]


def stack(lower, upper, bonded, method='METHOD=TRANSFORMATION'):
    """Two columns of moduli `lower`, `upper`, pressed together by 0.01 of their height."""
    n = 3
    nodes1, elements1 = column(1, 0.0, n, 'lower')
    nodes2, elements2 = column(101, 1.0, n, 'upper')
    lines = ['*NODE', *nodes1, *nodes2, *elements1, *elements2]
    for name, modulus in (('lower', lower), ('upper', upper)):
        lines += [f'*MATERIAL, NAME={name}', '*ELASTIC', f'{modulus!r}, 0',
                  f'*SOLID SECTION, ELSET={name}, MATERIAL={name}', '1']
    if bonded:
        for i in (0, 1):
            lines += ['*EQUATION', '2', f'{101 + i}, 2, 1., {2*n + 1 + i}, 2, -1.']
    else:
        lines += ['*SURFACE, NAME=A', '101, S1', '*SURFACE, NAME=B', f'{n}, S3',
                  '*SURFACE INTERACTION, NAME=I', f'*IMPACT, {method}',
                  '*CONTACT PAIR, INTERACTION=I', 'A, B']
    every = [*range(1, 2*n + 3), *range(101, 103 + 2*n)]
    lines += ['*BOUNDARY', *[f'{k}, 1' for k in every], '1, 2', '2, 2']
    top = 101 + 2*n
    lines += ['*STEP', '*STATIC, DIRECT', '1, 1', '*BOUNDARY', f'{top}, 2, 2, -0.01',
              f'{top + 1}, 2, 2, -0.01', '*NODE PRINT', 'U', '*EL PRINT', 'S', '*ENERGY PRINT',
              '*END STEP']

    def check(run, findings):
        stress = -0.01/(1/lower + 1/upper)
        exact = stress/lower
        for node in (2*n + 1, 101):
            found = run[f'history/node_{node}/U2'][-1]
            findings.at_most(abs(found - exact)/0.01, 1e-13, f'node {node}')
        soft = 1 if lower <= upper else 101
        found = run[f'history/element_{soft}/S22'][-1]
        findings.at_most(abs(found/stress - 1), 1e-12, 'stress of the softer')
    name = f'{lower:g}_{upper:g}_' + ('bonded' if bonded else method[7:])
    return Case(name, '', '\n'.join(lines) + '\n', '', check)


def pairs():
    """Soft below stiff and stiff below soft."""
    for ratio in RATIOS:
        yield 1.0, ratio
        if ratio > 1:
            yield ratio, 1.0


TWO = [(1.0, 1.0), (1e-12, 1e12), (1e12, 1e-12), (1.0, 1e-12), (1e12, 1.0), (1e-6, 1.0)]
CASES = [
    Group('springs_in_a_row', 'stiffness ratios 1 to 1e14, static',
          '4 eps x ratio where soft holds stiff, else round-off; over 1e13 status 4',
          [pulled(1.3*a, 3.7*b) for a, b in pairs()]),
    Group('two_masses', 'stiffness ratios 1 to 1e14 with mass ratios 1e-12 to 1e12, in motion',
          'trapezoidal rule within 3 eps x lost digits a step',
          [moving(masses, ratio) for masses in TWO for ratio in RATIOS]),
    Group('collisions', 'masses 1e-12 to 1e12 hit each other', 'speeds to 1e-14',
          [collision(a, b, e, method) for a, b in TWO[:5] for e in (0, 0.5, 1)
           for method in METHODS]),
    Group('masses_at_walls', 'masses 1e-12 to 1e12 hit walls in one step', 'speeds to 1e-14',
          [side_by_side(method, e) for method in METHODS for e in (0.0, 0.5, 1.0)]),
    Group('pressed_on_walls', 'springs 1e-7 to 1e7 press on walls in one model',
          'places and forces to 1e-15',
          [pressed('METHOD=TRANSFORMATION'), pressed('METHOD=LAGRANGE')]),
    Group('bonded_blocks', 'solids of moduli 1 to 1e14, tied by equations', 'stress to 1e-12',
          [stack(a, b, True) for a, b in pairs()]),
    Group('blocks_in_contact', 'solids of moduli 1 to 1e14 pressed on each other',
          'stress to 1e-12',
          [stack(a, b, False, method) for a, b in pairs()
           for method in ('METHOD=TRANSFORMATION', 'METHOD=LAGRANGE')])]

if __name__ == '__main__':
    sys.exit(main(CASES))
