"""What a scene does not ask for costs nothing: counted by the counters of /cost, not by seconds.
What it asks for is listed with its share, and advice comes only where it is true."""
import re

import numpy as np

from carom_case import INPUT, Checks, run_deck
from solid_mesh import Mesh, material, node_set

PHASES = ('read', 'build', 'factor', 'solve', 'elements', 'contact', 'output', 'other')
COUNTS = ('increments', 'iterations', 'solves', 'factorizations', 'element_updates',
          'energy_updates', 'stress_updates', 'contact_searches', 'contact_rows')
NX, NY, INCREMENTS = 8, 4, 60
ELEMENTS = NX*NY
LUMPED = '*ELEMENT GROUP, ELSET=solid, SCHEME=IMPLICIT, MASS=LUMPED\n'


def body(nx=NX, ny=NY, cards='', more=''):
    """A block of CPE4 that flies along x with the wave speed 1.1, held nowhere."""
    mesh = Mesh(nx, ny, 4, lambda s, t: (nx*s, ny*t))
    tip = mesh.at(s=1)
    ends = node_set('rest', np.setdiff1d(np.arange(len(mesh.x)), tip)) + node_set('tip', tip)
    return (mesh.text('CPE4') + ends + material(1.0, 0.2, thickness=1.0, more=more) + cards
            + '*INITIAL CONDITIONS, TYPE=VELOCITY\nrest, 1, 0.01\ntip, 1, 0.02\n')


def step(card='DYNAMIC, DIRECT', dt=0.5, increments=INCREMENTS, requests=''):
    """A dynamic step."""
    return f'*STEP\n*{card}\n{dt!r}, {dt*increments!r}\n{requests}*END STEP\n'


def wall(distance, cards='*SURFACE INTERACTION, NAME=hit\n*IMPACT, RESTITUTION=1\n'):
    """A rigid plane in front of the tip."""
    return ('*SURFACE, NAME=front, TYPE=NODE\ntip\n*RIGID SURFACE, NAME=wall, TYPE=PLANE\n'
            f'{NX + distance!r}, 0, 0\n-1, 0, 0\n' + cards
            + '*CONTACT PAIR, INTERACTION=hit\nfront, wall\n')


def cost_of(run):
    """The counters of a run by their names."""
    return {name: int(run[f'cost/{name}'][0]) for name in COUNTS}


def check_group(checks):
    """The group /cost is whole, its phases add up, and the log says the same."""
    run = run_deck(INPUT / 'sdof/sdof.inp')
    group = run.file['cost']
    names = COUNTS + ('cpu_seconds', 'elapsed_seconds') + tuple(f'seconds_{p}' for p in PHASES)
    checks.true(sorted(group) == sorted(names), '/cost has the datasets promised')
    checks.true(all(data.shape == (1,) and data.attrs['description'] for data in group.values()),
                'each has one element and a description')
    elapsed = group['elapsed_seconds'][0]
    checks.close(sum(group[f'seconds_{p}'][0] for p in PHASES), elapsed, 1e-9*max(1.0, elapsed),
                 'the phases add up to the seconds elapsed')
    checks.true(all(group[f'seconds_{p}'][0] >= -1e-9 for p in PHASES), 'no phase is negative')
    count = cost_of(run)
    checks.true(count['increments'] == 500, 'increments are counted')
    log = run.path.with_suffix('.log').read_text()
    said = re.search(r'^  1 dynamic +(\d+) +(\d+) +(\d+) +(\d+) ', log, re.M).groups()
    names = ('increments', 'iterations', 'factorizations', 'solves')
    checks.true([int(n) for n in said] == [count[name] for name in names],
                'the log has the same counts')
    updates = int(re.search(r'element updates (\d+),', log)[1])
    checks.true(updates == count['element_updates'], 'and those of element updates')


def check_bare(checks):
    """An implicit linear model that asks for nothing."""
    for name, cards, factored in (('consistent', '', 2), ('lumped', LUMPED, 1)):
        run = run_deck(body(cards=cards) + step())
        count = cost_of(run)
        checks.true(count['factorizations'] == factored,
                    f'{name} mass, fixed steps: factorized {factored} times')
        checks.true(count['solves'] == INCREMENTS + 1,
                    f'{name}: a solution an increment, one at first')
        # the forces of each increment and of the start; K once, a consistent mass in K* and alone
        assembled = ELEMENTS + 2*(factored - 1)*ELEMENTS
        checks.true(count['element_updates'] == (INCREMENTS + 1)*ELEMENTS + assembled,
                    f'{name}: each element\'s force once an increment')
        checks.true(count['energy_updates'] == 3*ELEMENTS,
                    f'{name}: energies at the start and the end, not between')
        checks.true(count['contact_searches'] == count['contact_rows'] == 0,
                    f'{name}: no contact pair, no search and no rows')
        checks.true(count['stress_updates'] == 0, f'{name}: no stresses')
        checks.true(count['iterations'] == 0, f'{name}: no iterations')
        checks.true(run['history/time'].size == 0 and 'energy' not in run.file,
                    f'{name}: neither histories nor energies')
        checks.true(run['VTKHDF/Steps/Values'].size == 2, f'{name}: the first and the last frame')


def check_explicit(checks):
    """Explicit elements: nothing is factorized or solved, with contact or without."""
    for name, cards in (('alone', ''), ('far wall', wall(100.0)), ('wall', wall(0.1))):
        count = cost_of(run_deck(body(cards=cards) + step('DYNAMIC, DIRECT, EXPLICIT')))
        checks.true(count['factorizations'] == count['solves'] == 0,
                    f'explicit, {name}: no factorization, no solution')
        checks.true(count['stress_updates'] == 0, f'explicit, {name}: no stresses')
        if name != 'wall':
            checks.true(count['element_updates'] == (INCREMENTS + 1)*ELEMENTS,
                        f'explicit, {name}: each element\'s force once an increment')
    deck = body() + step('DYNAMIC, DIRECT, EXPLICIT', requests='*ENERGY PRINT\n')
    count = cost_of(run_deck(deck))
    checks.true(count['energy_updates'] <= 2*ELEMENTS,
                'explicit: energies come with the forces, even if printed')


def check_requests(checks):
    """What is asked for every n increments is worked out n times more seldom."""
    every = '*EL PRINT, ELSET={0}, FREQUENCY={1}\nS, E\n'
    cards = '*ELSET, ELSET=three\n1, 2, 3\n'
    for n in (1, 10):
        count = cost_of(run_deck(body(cards=cards) + step(requests=every.format('three', n))))
        checks.true(count['stress_updates'] == 3*(INCREMENTS//n + 1),
                    f'EL PRINT, FREQUENCY={n}: stresses of three elements, each once a row')
        count = cost_of(run_deck(body() + step(requests=f'*EL FILE, FREQUENCY={n}\nS\n')))
        checks.true(count['stress_updates'] == ELEMENTS*(INCREMENTS//n + 1),
                    f'EL FILE, FREQUENCY={n}: stresses of all, once a frame')
        run = run_deck(body() + step(requests=f'*ENERGY PRINT, FREQUENCY={n}\n'))
        # at the start twice: the account is opened, and closed once the first step has begun
        due = INCREMENTS//n + 2
        checks.true(cost_of(run)['energy_updates'] == due*ELEMENTS,
                    f'ENERGY PRINT, FREQUENCY={n}: energies when they are printed')
        checks.true(run['energy/time'].size == INCREMENTS//n + 1,
                    f'ENERGY PRINT, FREQUENCY={n}: so many rows')


def check_far_pairs(checks):
    """Pairs that stay apart: rows are not solved for, planes and GAPUNI not searched for."""
    plain = cost_of(run_deck(body() + step()))
    far = run_deck(body(cards=wall(100.0)) + step())
    count = cost_of(far)
    checks.true(count['contact_rows'] == 0, 'a plane far away: no row is solved for')
    checks.true(count['contact_searches'] == 0, 'a plane needs no search')
    checks.true(count['solves'] == plain['solves'], 'a plane far away: no more solutions')
    checks.true(count['element_updates'] == plain['element_updates'],
                'a plane far away: no more element updates')
    checks.true('contact FRONT-WALL has not met' in far.path.with_suffix('.log').read_text(),
                'the log says that they have not met')
    near = run_deck(body(cards=wall(0.1)) + step())
    checks.at_least(cost_of(near)['contact_rows'], NY + 1, 'a near plane: rows are solved for')
    checks.true('has not met' not in near.path.with_suffix('.log').read_text(),
                'the log does not say that of those that have')


def check_status(checks):
    """Very many increments have few status lines, and all their iterations and events."""
    run = run_deck(INPUT / 'sdof/sdof.inp', dt=0.001, end=30.0, e=0.9)
    rows = np.loadtxt(run.path.with_suffix('.sta'), comments='#')
    checks.true(len(rows) == 10000 + 2000, '30000 increments: 12000 status lines')
    checks.true(np.array_equal(rows[:10000, 1], np.arange(1, 10001)) and rows[-1, 1] == 30000,
                'the first 10000 increments and the last have a line each')
    checks.true(rows[:, 6].sum() == len(run['events/time']), 'no event is lost')
    run = run_deck(INPUT / 'sdof/sdof.inp', dt=0.001, end=10.005)
    rows = np.loadtxt(run.path.with_suffix('.sta'), comments='#')
    checks.true(rows[-1, 1] == 10005, 'the last increment has a line, whatever its number')


def shares(text, name):
    """A column of the table of features, in per cent."""
    lines = text[text.index('features of step'):].splitlines()
    end = lines[0].index(name) + len(name)
    return [float(line[:end].split()[-2]) for line in lines[1:] if line[:end].endswith('%')
            and not line[end - 5:end].startswith('<')]


def check_features(checks):
    """The list of features: what is switched on, with shares that add up."""
    text = run_deck(INPUT / 'bar/bar_mixed.inp', command='check').text
    for words in ('50 implicit T2D2', '50 explicit T2D2', 'contact END-WALL',
                  '1 row, transformation', 'history', 'frames', 'energies', 'solution'):
        checks.true(words in text, f'mixed bar: the features have: {words}')
    for name in ('memory', 'time'):
        checks.close(sum(shares(text, name)), 100.0, 4.0, f'the shares of {name} add up')
    text = run_deck(INPUT / 'crack/slap.inp', command='check').text
    checks.true('partners searched for' in text, 'crack: faces that slide are searched for')
    text = run_deck(INPUT / 'sliding_block/sliding.inp', command='check').text
    checks.true('friction' in text[text.index('features'):], 'sliding block: friction')
    text = run_deck(body() + step('DYNAMIC, DIRECT, EXPLICIT'), command='check').text
    text = re.split(r'\n(?:note|warning):', text[text.index('features'):])[0]
    checks.true('no matrix is factorized' in text and not re.search(
        'contact|history|energies|supports|implicit', text), 'what is absent is not listed')


def check_no_advice(checks):
    """The decks of input/ get no advice."""
    for deck in sorted(INPUT.glob('*/*.inp')):
        if '*STEP' not in deck.read_text().upper():   # a mesh
            continue
        text = run_deck(deck, command='check').text
        checks.true('advice:' not in text, f'{deck.parent.name}/{deck.name}: no advice')


def advised(checks, deck, words, sentence):
    """`check` advises so."""
    text = run_deck(deck, command='check').text
    found = [line for line in text.splitlines() if line.startswith('advice:')]
    checks.true(any(re.search(words, line) for line in found), f'{sentence}: {found}')


def check_advice(checks):
    """Each advice where it is true, and its cure cures."""
    large = body(40, 40, LUMPED)
    advised(checks, large + step(dt=0.3), r'all 1600 .* critical step is .*EXPLICIT',
            'implicit elements below their critical step')
    count = cost_of(run_deck(large + step('DYNAMIC, DIRECT, EXPLICIT', dt=0.3, increments=5)))
    checks.true(count['solves'] == 0, 'the cure: explicit at that step')
    text = run_deck(large + step(dt=3.0), command='check').text
    checks.true('advice:' not in text, 'not above the critical step')
    text = run_deck(body(40, 40) + step(dt=0.3), command='check').text
    checks.true('advice:' not in text, 'not with a consistent mass')
    check_mixing(checks)
    advised(checks, body(60, 60) + step(increments=20000, requests='*NODE FILE\nU, V, A\n'),
            r'20001 frames of .* FREQUENCY=100 ', 'frames that nobody reads')
    cured = step(increments=20000, requests='*NODE FILE, FREQUENCY=100\nU, V, A\n')
    text = run_deck(body(60, 60) + cured, command='check').text
    checks.true('advice:' not in text, 'no word of frames with that FREQUENCY')
    advised(checks, body(60, 60) + step(increments=40000, requests='*NODE PRINT\nU\n'),
            r'columns of the history', 'a history of everything')
    held = '*BOUNDARY\ntip, 1\n'
    advised(checks, body(cards=wall(1.0)) + held + step(), 'FRONT-WALL can never meet',
            'a pair that is held')
    checks.true('never meet' not in run_deck(body(cards=wall(1.0)) + step(), command='check').text,
                'not of a pair that is free')


def check_mixing(checks):
    """A few stiff elements among explicit ones."""
    n, stiff = 100, 3
    nodes = '*NODE\n' + ''.join(f'{i + 1}, {i}, 0\n' for i in range(n + 1))
    bars = '*ELEMENT, TYPE=T2D2, ELSET=soft\n' + ''.join(
        f'{i}, {i}, {i + 1}\n' for i in range(1, n + 1 - stiff))
    bars += '*ELEMENT, TYPE=T2D2, ELSET=stiff\n' + ''.join(
        f'{i}, {i}, {i + 1}\n' for i in range(n + 1 - stiff, n + 1))
    cards = '*BOUNDARY\n1, 1\n*INITIAL CONDITIONS, TYPE=VELOCITY\n50, 1, 1\n'
    for name, young in (('soft', 1.0), ('stiff', 100.0)):
        cards += (f'*MATERIAL, NAME={name}\n*ELASTIC\n{young}\n*DENSITY\n1\n'
                  f'*SOLID SECTION, ELSET={name}, MATERIAL={name}\n1\n')
    deck = nodes + bars + cards + step('DYNAMIC, DIRECT, EXPLICIT', dt=0.09)
    advised(checks, deck,
            r'3 of 100 explicit elements, as element 98, keep the step at 0\.09.*0\.95',
            'few stiff elements keep the step small')
    groups = ('*ELEMENT GROUP, ELSET=soft, SCHEME=AUTO\n*ELEMENT GROUP, ELSET=stiff, SCHEME=AUTO\n')
    text = run_deck(nodes + bars + cards + groups + step(dt=0.94), command='check').text
    checks.true('97 of 100 elements explicit' in text and 'advice:' not in text,
                'the cure: SCHEME=AUTO takes such a step')


def check_yielding(checks):
    """A plastic material that does not yield is found out, one that does is not."""
    for stress, words in ((1.0, True), (1.0e-4, False)):
        run = run_deck(body(more=f'*PLASTIC\n{stress!r}, 0\n') + step(increments=10))
        log = run.path.with_suffix('.log').read_text()
        checks.true(('nothing has yielded' in log) == words, f'yield stress {stress}: {words}')


def main():
    """All checks."""
    checks = Checks()
    for check in (check_group, check_bare, check_explicit, check_requests, check_far_pairs,
                  check_status, check_features, check_no_advice, check_advice, check_yielding):
        check(checks)
    checks.finish()


if __name__ == '__main__':
    main()
