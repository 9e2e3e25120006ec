"""Numbers that are none, or hardly any: everywhere in a deck where a number may stand.

In the decks below {1.5} marks a place of a number that is replaced by another. What is no finite
number, or so small that it would become zero, is refused with its line and its spelling; huge and
tiny numbers give finite results or an error that says what to do.
"""
import re
import sys

import numpy as np

from extreme_case import Case, Group, main
from point_decks import CONTACT_PRINTS, PRINTS, Points, step

NO_NUMBERS = ('inf', 'nan', '1e400', '-1e-400', 'Infinity', '-NaN', '1e309', '2e-324', '0x1p3', '1.#INF')
EXTREME = ('1e300', '1e150', '1e-310', '-1e150', '-1e-310', '-1e300', '1e-200', '4.94e-324')

POINTS = """*PARAMETER
h = {0.05}
*NODE
1, {0.}, {0.5}
2, {1.}, {0.}, {0.}
3, {2.}, 0.
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
2, 2
*ELEMENT, TYPE=SPRING1, ELSET=ground
3, 1
*ELEMENT, TYPE=SPRING2, ELSET=link
4, 1, 2
*ELEMENT, TYPE=SPRINGA, ELSET=law
5, 2, 3
*ELEMENT, TYPE=DASHPOT1, ELSET=damp
6, 1
*ELEMENT, TYPE=GAPUNI, ELSET=gap
7, 1, 2
*MASS, ELSET=mass
{1.}
*SPRING, ELSET=ground
1
{4.}
*SPRING, ELSET=link
1, 1
{4.}
*SPRING, ELSET=law, NONLINEAR
{-1.}, {-1.}
{1.}, {1.}
*DASHPOT, ELSET=damp
1
{0.1}
*SURFACE, NAME=body, TYPE=NODE
1
*AMPLITUDE, NAME=ramp
{0.}, {0.}, {1.}, {0.1}
*RIGID SURFACE, NAME=wall, TYPE=PLANE, AMPLITUDE=ramp
{-0.5}, {0.}, {0.}
{1.}, {0.}, {0.}
{0.1}, {0.}, {0.}, {1.}
*SURFACE INTERACTION, NAME=hit
*IMPACT, METHOD=TRANSFORMATION, RESTITUTION={0.5}, BETA={0.25}, CAPTURE={1e-6}
*GAP, ELSET=gap, INTERACTION=hit
{0.5}, {1.}, {0.}, {0.}
*CONTACT PAIR, INTERACTION=hit
body, wall
*BOUNDARY
3, 1, 2, {0.}
1, 2, 2, 0
2, 2, 2, 0
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
1, 1, {0.2}
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, {-1.}
*STEP
*DYNAMIC, DIRECT, GAMMA={0.6}, BETA={0.35}
<h>, {1.}
*BASE MOTION, AMPLITUDE=ramp, DOF=1
{1.}
*CLOAD, AMPLITUDE=ramp
1, 1, {0.5}
*DLOAD
, GRAV, {1.}, {-1.}, {0.}, {0.}
*NODE PRINT
U, V, A, RF
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT, LIMIT={0.5}
*NODE FILE
U, V
*END STEP
*STEP
*DYNAMIC, TOLERANCE={1e-2}, ALPHA={-0.1}
{0.05}, {1.}, {1e-4}, {0.2}
*END STEP
"""

SOLIDS = """*NODE
1, {0.}, {0.}
2, {1.}, {0.}
3, {1.}, {1.}
4, {0.}, {1.}
5, 0., {-0.3}
6, 1., {-0.3}
7, 1., -1.3
8, 0., -1.3
9, {2.}, {-1.3}
*ELEMENT, TYPE=CPE4, ELSET=upper
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPE4, ELSET=lower
2, 8, 7, 6, 5
*ELEMENT, TYPE=T2D2, ELSET=rod
3, 7, 9
*MATERIAL, NAME=soft
*ELASTIC
{100.}, {0.3}
*DENSITY
{1.}
*DAMPING, ALPHA={0.1}, BETA={0.001}
*MATERIAL, NAME=yielding
*ELASTIC
{100.}, {0.3}
*PLASTIC
{5.}, {0.}
{6.}, {0.1}
*DENSITY
{1.}
*SOLID SECTION, ELSET=upper, MATERIAL=soft
{1.}
*SOLID SECTION, ELSET=lower, MATERIAL=yielding
{1.}
*SOLID SECTION, ELSET=rod, MATERIAL=soft
{0.1}
*SURFACE, NAME=bottom
1, S1
*SURFACE, NAME=top
2, S3
*SURFACE INTERACTION, NAME=hit
*IMPACT, METHOD=TRANSFORMATION, BETA=1/4
*FRICTION
{0.2}
*CONTACT PAIR, INTERACTION=hit
bottom, top
*NSET, NSET=flying
1, 2, 3, 4
*BOUNDARY
7, 1, 2
8, 1, 2
9, 1, 2
*EQUATION
2
5, 2, {1.}, 6, 2, {-1.}
*INITIAL CONDITIONS, TYPE=VELOCITY
flying, 2, {-2.}
*STEP
*DYNAMIC, DIRECT
{0.01}, {0.4}
*DLOAD
upper, P3, {1.}
upper, BY, {-1.}
upper, CENTRIF, {0.01}, {0.}, {0.}, {0.}, {0.}, {0.}, {1.}
*NODE PRINT
U, V, A, RF
*EL PRINT
S, E, PEEQ, ENER
*CONTACT PRINT
CF, CDIS, CPRESS
*ENERGY PRINT
*NODE FILE
U, RF
*EL FILE
S, ENER
*END STEP
"""

CIRCLE = """*NODE
1, {0.}, {0.}
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*MASS, ELSET=mass
{1.}
*SURFACE, NAME=body, TYPE=NODE
1
*RIGID SURFACE, NAME=ring, TYPE=CIRCLE
{-0.5}, {0.}
{-1.}
*SURFACE INTERACTION, NAME=hit
*IMPACT, METHOD=%s
*CONTACT PAIR, INTERACTION=hit
body, ring
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, {1.}
1, 2, 0
*STEP
*DYNAMIC, DIRECT
{0.01}, {2.}
*NODE PRINT
U, V, A
*CONTACT PRINT
CF, CDIS
*ENERGY PRINT
*END STEP
"""

DECKS = {'points': POINTS, 'solids': SOLIDS,
         'penalty': CIRCLE % 'PENALTY, STIFFNESS={1000.}',
         'fictitious': CIRCLE % 'FICTITIOUS FORCE, RETURN={0.3}, RESTITUTION={0.5}'}
PLACE = re.compile(r'\{([^}]*)\}')


def places(deck):
    """Of every marked place: its line, and the deck with another number there."""
    found = list(PLACE.finditer(deck))
    for place in found:
        def with_number(number, place=place):
            return PLACE.sub(lambda match: number if match.start() == place.start()
                             else match.group(1), deck)
        yield deck[:place.start()].count('\n') + 1, with_number


def refused(numbers_at):
    """What is no number is refused at every place; numbers_at(i) are those tried at the i-th."""
    for name, deck in DECKS.items():
        for i, (line, with_number) in enumerate(places(deck)):
            for number in numbers_at(i):
                yield Case(f'{name}:{line}:{number}', '', with_number(number), '', status=2,
                           words=[f'deck.inp:{line}:', f"'{number}"], command='check')


def finite_or_refused(numbers_at):
    """Huge and tiny numbers: finite results, or an error of the deck or of the numbers."""
    for name, deck in DECKS.items():
        for i, (line, with_number) in enumerate(places(deck)):
            for number in numbers_at(i):
                yield Case(f'{name}:{line}:{number}', '', with_number(number), '', status=(0, 2, 4),
                           seconds=60)


def in_turn(numbers, n):
    """n of the numbers at each place, others at the next."""
    return lambda i: [numbers[(i + k) % len(numbers)] for k in range(n)]


def oscillator(mass, stiffness, size, wall=False):
    """An oscillator that starts from rest at `size`; its wall is at -size/2."""
    points = Points([mass], [0.0]).ground(1, stiffness).start({1: size})
    if wall:
        points.impact().wall(1, -0.5*size)
    return points.deck(step('DYNAMIC, DIRECT', (0.05, 5.0),
                            prints=CONTACT_PRINTS if wall else PRINTS))


def check_oscillator(mass, stiffness, size, energy=True):
    """The motion of the trapezoidal rule, before the impact at 2 pi/3 as after it mirrored."""
    def check(run, findings):
        t = run['history/time']
        angle = 2*np.arctan(0.025*np.sqrt(stiffness/mass))*np.arange(t.size)
        until = slice(0, 40 if 'events' in run.file and run['events/time'].size else None)
        error = np.abs(run['history/node_1/U1']/size - np.cos(angle))[until].max()
        findings.at_most(error, 1e-11, 'displacement')
        if energy:
            exact = 0.5*stiffness*size*size
            findings.at_most(np.abs(run['energy/total']/exact - 1).max(), 1e-11, 'energy')
    return check


def scaled(mass, stiffness, size, wall=False, energy=True):
    """A case of an oscillator in odd units."""
    name = f'm{mass:g}_k{stiffness:g}_d{size:g}' + ('_wall' if wall else '')
    return Case(name, '', oscillator(mass, stiffness, size, wall), '',
                check_oscillator(mass, stiffness, size, energy))


UNITS = [scaled(1e-310, 1e-310, 1.0), scaled(1e-300, 1e-300, 1.0, wall=True),
         scaled(1e300, 1e300, 1.0, wall=True), scaled(1.0, 1.0, 1e150, wall=True),
         # the energies of these are below the smallest number
         scaled(1.0, 1.0, 1e-310, energy=False), scaled(1.0, 1.0, 1e-200, wall=True, energy=False)]


def overflow(name, deck, status, *words):
    """A case that must stop."""
    return Case(name, '', deck, '', status=status, words=words)


def square(size, modulus):
    """A square that is pressed from above by 1/10 of its modulus."""
    s = float(size)
    return f"""*NODE
1, 0, 0
2, {s!r}, 0
3, {s!r}, {s!r}
4, 0, {s!r}
*ELEMENT, TYPE=CPS4, ELSET=body
1, 1, 2, 3, 4
*MATERIAL, NAME=m
*ELASTIC
{modulus!r}, 0
*SOLID SECTION, ELSET=body, MATERIAL=m
1
*BOUNDARY
1, 1, 2
2, 2
*STEP
*STATIC, DIRECT
1, 1
*DLOAD
body, P3, {0.1*modulus!r}
*NODE PRINT
U
*EL PRINT
S, E
*ENERGY PRINT
*END STEP
"""


def check_square(size, modulus):
    """Strain 1/10, stress as the pressure."""
    def check(run, findings):
        findings.close(run['history/node_3/U2'][-1]/size, -0.1, 1e-12, 'shortening')
        findings.close(run['history/element_1/S22'][-1]/modulus, -0.1, 1e-12, 'stress')
    return check


SQUARES = [Case(f'square_{size:g}_{modulus:g}', '', square(size, modulus), '',
                check_square(size, modulus))
           for size, modulus in ((1e-150, 1.0), (1e150, 1.0), (1.0, 1e300), (1.0, 1e-300),
                                 (1e-100, 1e200), (1e100, 1e-100))]

STOPS = [
    overflow('frequency', oscillator(1e-300, 1e300, 1.0), 2, 'highest frequency is not finite'),
    overflow('energy', oscillator(1.0, 1.0, 1e160), 4, 'the energies are not finite at time 0'),
    overflow('force', oscillator(1e300, 1e300, 1e10), 4, 'not finite', 'at time 0'),
    overflow('wide', square(1e200, 1.0), 2, 'deck.inp:', 'element 1', 'its area is no number'),
    overflow('narrow', square(1e-200, 1.0), 2, 'deck.inp:', 'element 1', 'its area is no number'),
    overflow('stiffness', square(1e100, 1e-250), 2, 'node 2, freedom 1 has neither stiffness'),
    overflow('speed', Points([1.0], [0.0]).start({}, {1: 1e300}).deck(
        step('DYNAMIC, DIRECT', (0.1, 1.0))), 4, 'the energies are not finite'),
    overflow('light_at_wall', oscillator(1e-310, 1e-310, 1.0, wall=True), 4, 'has no answer',
             'node 1', 'mass')]


def groups(n_refused, n_finite):
    """The lines of the table, with so many numbers at each place."""
    return [
        Group('no_number', 'inf, nan, 1e400, 1e-400 and others at each place of a number',
              'refused with line and word', refused(in_turn(NO_NUMBERS, n_refused))),
        Group('huge_and_tiny', '1e300, 1e150, 1e-200, 1e-310, 5e-324 at each place of a number',
              'finite results, or a clear error', finite_or_refused(in_turn(EXTREME, n_finite)))]


CASES = [Group('units', 'masses, stiffnesses, lengths 1e-310 to 1e300', 'motion to 1e-11', UNITS),
         Group('unit_squares', 'elements 1e-150 to 1e150 wide, moduli 1e-300 to 1e300',
               'strain and stress to 1e-12', SQUARES),
         Group('overflows', 'products that overflow, areas that vanish', 'a clear stop', STOPS)]

if __name__ == '__main__':
    SHORT = [*groups(2, 1), *CASES]
    sys.exit(main(SHORT, groups(len(NO_NUMBERS), len(EXTREME))))
