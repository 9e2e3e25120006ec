"""Nothing at all: no time, no motion, no freedom, no element, no mass."""
import sys

import numpy as np

from extreme_case import Case, Group, main
from point_decks import CONTACT_PRINTS, Points, step

DYNAMIC, STATIC = 'DYNAMIC, DIRECT', 'STATIC, DIRECT'
METHODS = ('METHOD=TRANSFORMATION', 'METHOD=TRANSFORMATION, RESTITUTION=1',
           'METHOD=TRANSFORMATION, RESTITUTION=1, EVENTS=ANCHOR', 'METHOD=FICTITIOUS FORCE',
           'METHOD=FICTITIOUS FORCE, RESTITUTION=1', 'METHOD=LAGRANGE',
           'METHOD=PENALTY, STIFFNESS=10')


def one():
    """A mass on a spring."""
    return Points([1.0], [0.0]).ground(1, 1.0)


def refused(name, deck, *words, status=2):
    """An error with these words."""
    return Case(name, '', deck, '', status=status, words=words)


def still(name, deck, nodes=1, rows=11):
    """Runs, and nothing moves."""
    def check(run, findings):
        for node in range(1, nodes + 1):
            for column in ('U1', 'V1', 'A1'):
                findings.close(run[f'history/node_{node}/{column}'], np.zeros(rows), 0.0, column)
        for column in ('kinetic', 'strain', 'external_work', 'impact_loss', 'balance_error'):
            findings.close(run[f'energy/{column}'], np.zeros(rows), 0.0, column)
        if 'events' in run.file:
            findings.true(run['events/time'].size == 0, 'no event')
    return Case(name, '', deck, '', check)


def without_equations(name, deck, rows=11):
    """Runs over all its increments without an equation."""
    def check(run, findings):
        findings.true(run.file['model'].attrs['n_eq'] == 0, 'no equation')
        findings.close(run['energy/total'], np.zeros(rows), 0.0, 'energy')
        findings.close(run['energy/time'][-1], 1.0, 1e-15, 'end')
    return Case(name, '', deck, '', check)


def moved(name, deck, d, v, balance=True):
    """Ends at d with v; a jump without mass takes work that nothing stores."""
    def check(run, findings):
        findings.close(run['history/node_1/U1'][-1], d, 1e-13, 'displacement')
        findings.close(run['history/node_1/V1'][-1], v, 1e-13, 'velocity')
        if balance:
            findings.at_most(np.abs(run['energy/balance_error']).max(), 1e-13, 'balance')
    return Case(name, '', deck, '', check)


TIME = step(DYNAMIC, (0.1, 1.0))
NO_TIME = [
    refused('no_duration', one().deck(step(DYNAMIC, (0.1, 0))), 'deck.inp:', 'the duration must'),
    refused('no_step', one().deck(step(DYNAMIC, (0, 1))), 'the time step must be positive'),
    refused('neither', one().deck(step(DYNAMIC, (0, 0))), 'the time step must be positive'),
    refused('static_no_time', one().deck(step(STATIC, (0, 0))), 'the time step must be positive'),
    refused('back_in_time', one().deck(step(DYNAMIC, (0.1, -1))), 'the duration must'),
    refused('step_back', one().deck(step(DYNAMIC, (-0.1, 1))), 'the time step must be positive'),
    refused('automatic', one().deck(step('DYNAMIC', (0.1, 0))), 'the duration must'),
    refused('second', one().deck(TIME, step(DYNAMIC, (0.1, 0))), 'the duration must'),
    refused('no_steps', one().deck(), 'the deck has no step'),
    refused('no_cards', '** nothing\n\n', 'the deck is empty'),
    refused('no_nodes', TIME + '\n', 'the deck has no node'),
    refused('no_modes', one().deck('*STEP\n*FREQUENCY\n0\n*END STEP'), 'must be positive'),
    refused('no_mass', Points([0.0]).ground(1, 1.0).deck(TIME), 'the mass must be positive'),
    refused('negative_mass', Points([-1.0]).ground(1, 1.0).deck(TIME), 'the mass must be positive'),
    refused('no_direction', one().deck(
        step(DYNAMIC, (0.1, 1), '*DLOAD', ', GRAV, 9.81, 0, 0, 0')), 'has no length')]

FIXED = '*BOUNDARY\n1, 1'
REST = [
    still('initial_zeros', one().start({1: 0.0}, {1: 0.0}).deck(TIME)),
    still('gravity_zero', one().deck(step(DYNAMIC, (0.1, 1), '*DLOAD', ', GRAV, 0, 0, -1, 0'))),
    still('load_zero', one().deck(step(DYNAMIC, (0.1, 1), '*CLOAD', '1, 1, 0'))),
    still('static_load_zero', one().deck(step(STATIC, (0.1, 1), '*CLOAD', '1, 1, 0'))),
    still('damper_zero', one().element('DASHPOT1', [1], ['*DASHPOT, ELSET={}', '1', '0']).deck(
        TIME)),
    still('explicit', one().deck(step('DYNAMIC, DIRECT, EXPLICIT', (0.1, 1)))),
    still('gap_of_zero', Points([1.0, 1.0]).ground(1, 1).ground(2, 1).impact().gap(1, 2, 0).deck(
        step(DYNAMIC, (0.1, 1), prints=CONTACT_PRINTS)), nodes=2)]
REST += [still(f'at_wall_{method[7:]}', one().impact(method).wall(1, 0.0).deck(
    step(DYNAMIC, (0.1, 1), prints=CONTACT_PRINTS))) for method in METHODS]
REST += [still(f'fixed_at_wall_{method[7:]}', one().impact(method).wall(1, 0.0).add(FIXED).deck(
    step(DYNAMIC, (0.1, 1), prints=CONTACT_PRINTS))) for method in METHODS]

EMPTY = [
    without_equations('all_fixed', one().add(FIXED).deck(TIME)),
    without_equations('all_fixed_static', one().add(FIXED).deck(step(STATIC, (0.1, 1)))),
    without_equations('all_fixed_explicit', one().add(FIXED).deck(
        step('DYNAMIC, DIRECT, EXPLICIT', (0.1, 1)))),
    without_equations('single_node', '*NODE\n1, 0, 0\n' + TIME + '\n'),
    without_equations('single_node_static', '*NODE\n1, 0, 0\n' + step(STATIC, (0.1, 1)) + '\n'),
    without_equations('mass_alone', Points([1.0]).deck(TIME)),
    refused('no_modes', one().add(FIXED).deck('*STEP\n*FREQUENCY\n1\n*END STEP'),
            'there are no modes', status=4)]

LITTLE = [
    moved('free_mass', Points([1.0]).start({}, {1: 1.0}).deck(TIME), 1.0, 1.0),
    moved('pushed_mass', Points([1.0]).deck(step(DYNAMIC, (0.1, 1), '*CLOAD', '1, 1, 1')), 0.5, 1),
    moved('spring_of_zero', Points([1.0]).ground(1, 0).start({}, {1: 1.0}).deck(TIME), 1.0, 1.0),
    moved('spring_alone', Points([None]).ground(1, 1.0).deck(
        step(DYNAMIC, (0.1, 1), '*CLOAD', '1, 1, 2')), 2.0, 0.0, balance=False),
    refused('static_free_mass', Points([1.0]).deck(step(STATIC, (0.1, 1), '*CLOAD', '1, 1, 1')),
            'node 1, freedom 1 can move without resistance', status=4),
    refused('static_spring_of_zero', Points([1.0]).ground(1, 0).deck(
        step(STATIC, (0.1, 1), '*CLOAD', '1, 1, 1')), 'can move without resistance', status=4),
    refused('pushed_into_wall', one().impact().wall(1, -0.55).add(
        '*AMPLITUDE, NAME=A', '0, 0, 1, 1', '*BOUNDARY, AMPLITUDE=A', '1, 1, 1, -1').deck(
        step(DYNAMIC, (0.1, 1), prints=CONTACT_PRINTS)), 'at time 0.55', 'node 1', status=4)]

CASES = [
    Group('no_time', 'no duration, step, card, node, mass', 'refused with the place', NO_TIME),
    Group('at_rest', 'zero loads, gaps, velocities, all methods', 'exactly at rest', REST),
    Group('no_equation', 'all fixed, a single node, a mass without freedom', 'runs to the end',
          EMPTY),
    Group('hardly_anything', 'a mass alone, a spring alone, a spring of stiffness 0',
          'motion to 1e-13, or a clear stop', LITTLE)]

if __name__ == '__main__':
    sys.exit(main(CASES))
