"""A run that is interrupted and taken up again ends with the same file, bit for bit.

Runs are interrupted by --time-limit at places that depend on the machine, and go on until they are
complete: what is compared does not depend on the places. Then decks that have changed, records that
have changed, and files that are damaged.
"""
import shutil
import subprocess
import sys
import time

import h5py
import numpy as np

from carom_case import INPUT, Checks, scratch_folder
from same_results import differences

from carom_deck import Card, Deck

PROGRAM = sys.argv[1]
FOLDER = scratch_folder()
checks = Checks()


def carom(deck, *words, status=0):
    """Runs a deck; its text for the terminal, and the seconds taken. Another end fails the test."""
    start = time.monotonic()
    done = subprocess.run([PROGRAM, 'run', str(deck), *map(str, words), '--quiet'],
                          capture_output=True, text=True, timeout=600)
    if status is not None and done.returncode != status:
        sys.exit(f'FAILED: {deck} {words} ended with {done.returncode}, not {status}:\n'
                 + done.stdout + done.stderr)
    return done.returncode, done.stdout + done.stderr, time.monotonic() - start


def write(name, deck):
    """A deck, or its text, as a file in the scratch folder."""
    path = FOLDER / f'{name}.inp'
    if isinstance(deck, str):
        path.write_text(deck)
    else:
        deck.write(path)
    return path


def edited(name, *cards, dynamic=None, **interaction):
    """A deck of input/ with parameters of *DYNAMIC and *IMPACT set, and cards put into its steps."""
    deck = Deck.read(INPUT / name)
    if dynamic:
        deck.set('DYNAMIC', **dynamic)
    if interaction:
        deck.set('IMPACT', **interaction)
    for card in cards:
        deck.add_before('END STEP', *card.split('\n'))
    return deck


def bent_then(*cards):
    """A beam bent in many static increments, and a step behind that."""
    deck = edited('cantilever/cantilever.inp')
    deck.cards('STATIC')[0].set_data(0, '0.01, 1')
    deck.items.append(Card(['*STEP'], [*cards, '*END STEP']))
    return deck


def finer(deck, dt, end=None):
    """The deck with other increments."""
    deck.set_time_step(dt, end)
    return deck


CASES = {
    'impacts': lambda: finer(edited('sdof/sdof.inp'), 4e-4),
    'impacts, compressed': lambda: finer(edited('sdof/sdof.inp', '*OUTPUT, COMPRESS=3'), 4e-4),
    'fourth order': lambda: finer(edited('sdof/sdof.inp', dynamic={'ORDER': 4},
                                          BETA=None), 2e-3),
    'fictitious force': lambda: edited('sdof/sdof_fictitious.inp'),
    'tolerance': lambda: finer(edited('two_dof/two_dof.inp', dynamic={
        'DIRECT': None, 'TOLERANCE': '1e-6'}), 0.02),
    'capture': lambda: finer(edited('ball/ball.inp'), 2e-4),
    'implicit bar': lambda: edited('bar/bar_implicit.inp'),
    'implicit and explicit bar': lambda: edited('bar/bar_mixed.inp'),
    'penalty': lambda: edited('bar/bar_implicit.inp', METHOD='PENALTY', STIFFNESS=1000, BETA=None),
    'Lagrange': lambda: edited('bar/bar_implicit.inp', METHOD='LAGRANGE', BETA=None),
    'base motion': lambda: edited('buildings/buildings.inp'),
    'plasticity, automatic': lambda: edited('thick_cylinder/plastic_cax4.inp'),
    'at rest, then in motion': lambda: bent_then('*DYNAMIC, DIRECT', '0.0005, 0.05'),
    'at rest, then modes': lambda: bent_then('*FREQUENCY', '4', '*NODE FILE', 'U'),
    'friction': lambda: edited('sliding_block/sliding.inp'),
    'friction of an elastic ball': lambda: edited('oblique_ball/elastic.inp'),
    'massless contact nodes': lambda: edited('elastic_strip/q4_massless.inp'),
    'sliding bodies': lambda: edited('hertz/nonmatching.inp'),
}


def go_on(deck, result, *words, limit):
    """Restarts until the run is complete; how often."""
    for n in range(1, 40):
        if carom(deck, '--restart', result, *words, '--time-limit', f'{limit:.4f}', status=None)[0] == 0:
            return n
        limit *= 1.5
    sys.exit(f'FAILED: {deck} does not come to its end')


def check_case(name, deck, number):
    """One case, whole and in parts; the parts with two threads where it is the other way round."""
    path = write(f'case{number}', deck)
    whole, parts = FOLDER / f'whole{number}.h5', FOLDER / f'parts{number}.h5'
    carom(path, '-o', whole)
    _, _, seconds = carom(path, '-o', whole, '--overwrite')
    limit, status = 0.5 * seconds, 0
    for _ in range(5):
        status, text, _ = carom(path, '-o', parts, '--overwrite', '--time-limit', f'{limit:.4f}',
                                status=None)
        if status == 5:
            break
        limit *= 0.6
    checks.true(status == 5 and 'interrupted' in text, f'{name}: interrupted')
    if status != 5:
        return
    words = ['--threads', '2'] if number % 3 == 0 else []
    n = go_on(path, parts, *words, limit=1.5 * limit)
    found = differences(whole, parts)
    checks.true(not found, f'{name}: the same file after {n} restarts ' + '; '.join(found[:3]))
    checks.true(whole.with_suffix('.sta').read_text() == parts.with_suffix('.sta').read_text(),
                f'{name}: the same status lines')
    with h5py.File(whole) as file:
        checks.true('restart' not in file, f'{name}: no state is left where none was asked for')
    for file in FOLDER.glob(f'*{number}.h5'):
        file.unlink()


def check_cases():
    """All cases."""
    for number, (name, make) in enumerate(CASES.items()):
        check_case(name, make(), number)


SMALL = """*HEADING
a mass on a spring
*PARAMETER
k = 4
*NODE, NSET=all
1, 0, 0
2, 1, 0
*ELEMENT, TYPE=SPRINGA, ELSET=spring
1, 1, 2
*ELEMENT, TYPE=MASS, ELSET=mass
2, 2
*SPRING, ELSET=spring

<k>
*MASS, ELSET=mass
1
*BOUNDARY
1, 1
*INITIAL CONDITIONS, TYPE=VELOCITY
2, 1, 1.5
*STEP, INC=1000
*DYNAMIC, DIRECT
0.1, 2
*NODE PRINT, NSET=all
U, V
*NODE FILE
U
*ENERGY PRINT
*RESTART, WRITE, FREQUENCY=5
*END STEP
"""


def changed(*pairs):
    """The small deck with texts replaced."""
    text = SMALL
    for old, new in pairs:
        if old not in text:
            sys.exit(f'FAILED: the deck has no {old!r}')
        text = text.replace(old, new)
    return text


def restart_small(text, *words, status=0, old='small'):
    """Runs the small deck, then goes on from a copy of its results with another; text and file."""
    small = FOLDER / f'{old}.h5'
    if not small.exists():
        carom(write('small', SMALL), '-o', small)
    copy = FOLDER / 'copy.h5'
    for ending in ('.h5', '.log', '.sta'):
        shutil.copy(small.with_suffix(ending), copy.with_suffix(ending))
    _, said, _ = carom(write('later', text), '--restart', copy, *words, status=status)
    return said, copy


def same_as_whole(text, result, sentence):
    """The result is that of the whole deck."""
    whole = FOLDER / 'whole.h5'
    carom(write('later', text), '-o', whole, '--overwrite')
    found = differences(whole, result)
    checks.true(not found, sentence + ': ' + ('the same file' if not found else '; '.join(found[:3])))
    checks.true(whole.with_suffix('.sta').read_text() == result.with_suffix('.sta').read_text(),
                sentence + ': the same status lines')


SECOND = '*STEP\n*DYNAMIC, DIRECT\n0.05, 1\n*CLOAD\n2, 1, 0.5\n*END STEP\n'


def check_allowed():
    """Changes with which a run goes on."""
    longer = changed(('0.1, 2', '0.1, 4'))
    said, copy = restart_small(longer)
    same_as_whole(longer, copy, 'T raised')
    log = copy.with_suffix('.log').read_text()
    checks.true(log.count('completed') == 2 and 'step 1, increment 20, time 2' in log,
                'the log goes on and says from where')
    same = changed(('k = 4', 'k = 4.0'), ('2, 1, 1.5', ' 2, 1, 1.50E0'),
                   ('*MASS, ELSET=mass', '** m\n*mass,elset = MASS'),
                   ('a mass', 'one mass'), ('INC=1000', 'INC=2000'), ('FREQUENCY=5', 'FREQUENCY=1'),
                   ('0.1, 2', '.1, 3'))
    _, copy = restart_small(same)
    same_as_whole(same, copy, 'the same deck in other words, another heading, INC and *RESTART')
    _, copy = restart_small(SMALL + SECOND)
    same_as_whole(SMALL + SECOND, copy, 'a step added')
    before = (FOLDER / 'small.h5').read_bytes()
    said, copy = restart_small(SMALL)
    aloud = subprocess.run([PROGRAM, 'run', FOLDER / 'later.inp', '--restart', copy],
                           capture_output=True, text=True)
    checks.true('nothing is left to do' in aloud.stdout and said == '' and aloud.returncode == 0
                and copy.read_bytes() == before, 'a run that is complete is left alone')
    new = FOLDER / 'new.h5'
    restart_small(longer, '-o', new)
    same_as_whole(longer, new, 'in a new file')
    checks.true((FOLDER / 'copy.h5').read_bytes() == before, 'the earlier file stays as it was')
    said, _ = restart_small(longer, '-o', new, status=3)
    checks.true('it exists' in said and '--overwrite' in said, 'a new file that exists is not replaced')


def check_records():
    """Other records go into a new file, the first row of which is the state."""
    others = changed(('0.1, 2', '0.1, 4'), ('U, V\n', 'U\n'), ('*NODE FILE', '*NODE FILE, FREQUENCY=4'))
    said, copy = restart_small(others, status=2)
    checks.true('records something else than before: *NODE PRINT at ' in said and '-o NEW.h5' in said,
                'other columns in the same file are refused')
    checks.true(copy.read_bytes() == (FOLDER / 'small.h5').read_bytes(), 'which leaves it as it was')
    new = FOLDER / 'others.h5'
    restart_small(others, '-o', new)
    whole = FOLDER / 'whole.h5'
    carom(write('later', others), '-o', whole, '--overwrite')
    with h5py.File(new) as part, h5py.File(whole) as all_:
        checks.close(part['history/time'][0], 2.0, 1e-15, 'its first row is the state')
        checks.true('V1' not in part['history/node_2'], 'it has the columns asked for now')
        checks.true(np.array_equal(part['history/node_2/U1'][:], all_['history/node_2/U1'][20:]),
                    'and the rows of the whole run from there on')
        checks.true(np.array_equal(part['energy/total'][:], all_['energy/total'][20:]),
                    'energies too')
        checks.close(part['VTKHDF/Steps/Values'][:], [2.0, 2.4, 2.8, 3.2, 3.6, 4.0], 1e-15, 'frames too')
    later = SMALL + SECOND.replace('*END STEP', '*NODE PRINT, NSET=all\nU, V, A\n*END STEP')
    said, _ = restart_small(later, status=3)
    checks.true('/A1 is missing' in said and '-o NEW.h5' in said, 'columns of a later step are refused too')
    restart_small(later, '-o', new, '--overwrite')
    with h5py.File(new) as part:
        checks.true(part['history/node_2/A1'].shape == (21,), 'and found in a new file')


def check_refused():
    """Changes that are refused, with the card and what it was."""
    cases = [
        ('a parameter', [('k = 4', 'k = 5')], 2, ["later.inp:14", "this line was '4'"]),
        ('a value', [('2, 1, 1.5', '2, 1, 1.6')], 2, ['later.inp:20', "this line was '2, 1, 1.5'"]),
        ('dt', [('0.1, 2', '0.05, 4')], 2, ["this line was '0.1, 2'"]),
        ('a shorter step', [('0.1, 2', '0.1, 1')], 2, ['ends before 2, the step time reached']),
        ('a condition more', [('*STEP', '*BOUNDARY\n2, 2\n*STEP')], 2,
         ["here was '*STEP, INC=1000' (", 'small.inp:21 then)']),
        ('a card less', [('*BOUNDARY\n1, 1\n', '')], 2, ["here was '*BOUNDARY' ("]),
        ('a line more', [('1, 1\n*INITIAL', '1, 1\n2, 2\n*INITIAL')], 2, ['this line was not there']),
        ('a parameter of a card', [('*DYNAMIC, DIRECT', '*DYNAMIC, DIRECT, ALPHA=-0.1')], 2,
         ["this card was '*DYNAMIC, DIRECT' ("]),
        ('the order of cards', [('*MASS, ELSET=mass\n1\n*BOUNDARY\n1, 1\n', '*BOUNDARY\n1, 1\n*MASS, ELSET=mass\n1\n')],
         2, ["here was '*MASS, ELSET=mass' ("]),
    ]
    for name, pairs, status, words in cases:
        said, copy = restart_small(changed(*pairs), status=status)
        for word in words:
            checks.true(word in said, f'refused: {name}: {word}')
        checks.true('cure: ' in said and copy.read_bytes() == (FOLDER / 'small.h5').read_bytes(),
                    f'refused: {name}: with a cure, the file untouched')
    static = SMALL.replace('*DYNAMIC, DIRECT', '*STATIC, DIRECT').replace('TYPE=VELOCITY', 'TYPE=DISPLACEMENT')
    static = static.replace('*NODE PRINT', '*CLOAD\n2, 1, 1\n*NODE PRINT').replace('U, V\n', 'U\n')
    carom(write('static', static), '-o', FOLDER / 'static.h5')
    said, _ = restart_small(static.replace('0.1, 2', '0.1, 4'), status=2, old='static')
    checks.true('the loads of a static step grow over its whole length' in said,
                'refused: another T of a static step')


def check_damaged():
    """Files that hold no sound state."""
    good = FOLDER / 'small.h5'
    path = FOLDER / 'damaged.h5'
    longer = write('later', changed(('0.1, 2', '0.1, 4')))

    def refused(sentence, *words):
        """The file is refused with these words, and left alone."""
        before = path.read_bytes() if path.exists() else None
        _, said, _ = carom(longer, '--restart', path, status=3)
        checks.true(all(word in said for word in words), f'{sentence}: {said.splitlines()[0]}')
        checks.true(before is None or path.read_bytes() == before, f'{sentence}: left alone')

    path.unlink(missing_ok=True)
    refused('no file', 'no such file')
    path.write_text('not a result\n')
    refused('a text', 'no HDF5 file')
    path.write_bytes(good.read_bytes()[:-1000])
    refused('cut short', 'cut short')
    with h5py.File(path, 'w') as file:
        file['x'] = 1
    refused('another HDF5 file', 'no result file of carom')
    carom(write('plain', SMALL.replace('*RESTART, WRITE, FREQUENCY=5\n', '')), '-o', path, '--overwrite')
    refused('no state', 'no state to go on from', '*RESTART, WRITE')
    edits = {
        'another format': lambda group: group['index/format'].write_direct(np.array([99])),
        'a number changed': lambda group: group['motion/d'].write_direct(group['motion/d'][:] + 1e-9),
        'an entry missing': lambda group: group.pop('motion/v'),
        'the list missing': lambda group: group.pop('index/entries'),
        'the deck cut': lambda group: group['deck/lines'].write_direct(np.array([3])),
    }
    words = ['another format', 'is damaged', 'is damaged', 'is damaged', 'is damaged']
    for (name, edit), word in zip(edits.items(), words):
        shutil.copy(good, path)
        with h5py.File(path, 'r+') as file:
            edit(file['restart'])
        refused(name, word)
    shutil.copy(good, path)
    with h5py.File(path, 'r+') as file:
        file['history/node_2/U1'].resize((15,))
    refused('rows missing', 'node_2/U1')


def check_states():
    """States kept in mid-run: the file does not grow with their number; times add up."""
    text = SMALL.replace('0.1, 2', '1e-4, 3').replace('INC=1000', 'INC=100000')
    sizes = []
    for name, card in (('every', 'FREQUENCY=1'), ('seldom', 'FREQUENCY=1000000')):
        path = FOLDER / f'{name}.h5'
        carom(write(name, text.replace('FREQUENCY=5', card)), '-o', path)
        sizes.append(path.stat().st_size)
    checks.at_most(abs(sizes[0] - sizes[1]), 30000, 'states in every increment: the file grows by no more, bytes')
    found = differences(FOLDER / 'every.h5', FOLDER / 'seldom.h5', ['/model', '/restart/deck'])
    checks.true(not found, 'and holds the same results ' + '; '.join(found[:3]))
    with h5py.File(FOLDER / 'every.h5') as file:
        before = file['cost/elapsed_seconds'][0]
        checks.true(file['restart/course/increment'][0] == 30000, 'its state is that of the end')
        names = [name.decode().split(' ', 1)[1] for name in file['restart/index/entries'][:]]
        checks.true(all(f'restart/{name}' in file for name in names), 'all entries are listed')
        checks.true('description' in file['restart/motion/d'].attrs, 'and described')
    longer = text.replace('1e-4, 3', '1e-4, 3.01').replace('FREQUENCY=5', 'FREQUENCY=1')
    carom(write('every', longer), '--restart', FOLDER / 'every.h5')
    with h5py.File(FOLDER / 'every.h5') as file:
        phases = sum(file[f'cost/{name}'][0] for name in file['cost'] if name.startswith('seconds_'))
        checks.at_least(file['cost/elapsed_seconds'][0], before, 'times add up')
        checks.close(phases, file['cost/elapsed_seconds'][0], 1e-9, 'those of the phases too')
        checks.true(file['cost/increments'][0] == 30100, 'increments are counted on')


def check_step_end():
    """An error at the beginning of a step: the state is that of the end of the step before, however fast it was."""
    text = SMALL.replace('0.1, 2', '0.01, 2').replace('FREQUENCY=5', 'FREQUENCY=1')
    last = SECOND.replace('*END STEP', '*ENERGY PRINT\n*RESTART, WRITE\n*END STEP')
    path = FOLDER / 'failed.h5'
    fails = write('failed', text + last.replace('*ENERGY PRINT', '*ENERGY PRINT, LIMIT=1e-300'))
    _, said, _ = carom(fails, '-o', path, status=4)
    with h5py.File(path) as file:
        place = [int(file[f'restart/course/{name}'][0]) for name in ('step', 'increment')]
    checks.true('at time 2.05 exceeds LIMIT' in said and place == [1, 200],
                f'an error in the first increment of step 2: the state is that of step, increment {place}')
    carom(write('later', text + last), '--restart', path)
    same_as_whole(text + last, path, 'gone on from there')


check_step_end()
check_allowed()
check_records()
check_refused()
check_damaged()
check_states()
check_cases()
checks.finish()
