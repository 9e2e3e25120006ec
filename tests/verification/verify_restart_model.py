"""What a later step does to the model of a run that is taken up again: an error that points at it."""
import subprocess
import sys

from carom_case import Checks, scratch_folder

PROGRAM = sys.argv[1]
FOLDER = scratch_folder()
checks = Checks()

MASSES = """*NODE, NSET=all
1, 0, 0
2, 1, 0
3, 2, 0
*ELEMENT, TYPE=MASS, ELSET=masses
1, 1
2, 2
3, 3
*ELEMENT, TYPE=SPRING1, ELSET=springs
4, 1
5, 2
6, 3
*MASS, ELSET=masses
2
*SPRING, ELSET=springs
1
100
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, 1
"""
BAR = """*NODE, NSET=all
1, 0, 0
2, 1, 0
3, 2, 0
*ELEMENT, TYPE=T2D2, ELSET=bar
1, 1, 2
2, 2, 3
*MATERIAL, NAME=m
*ELASTIC
100
*DENSITY
1
*SOLID SECTION, ELSET=bar, MATERIAL=m
1
*BOUNDARY
1, 1, 2
all, 2
*INITIAL CONDITIONS, TYPE=VELOCITY
3, 1, 1
"""
FIRST = '*STEP\n*DYNAMIC, DIRECT\n0.01, 1\n*NODE PRINT\nU\n*RESTART, WRITE\n*END STEP\n'
SCHEME = '*ELEMENT GROUP, ELSET=bar, SCHEME=AUTO\n'


def later(cards, options=', DIRECT', times='0.01, 1'):
    """A second step."""
    return f'*STEP\n*DYNAMIC{options}\n{times}\n{cards}*END STEP\n'


def run(name, text, *words):
    """Exit status and what was said of a run of a deck."""
    path = FOLDER / f'{name}.inp'
    path.write_text(text)
    done = subprocess.run([PROGRAM, 'run', str(path), *map(str, words), '--quiet'],
                          capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout + done.stderr


def taken_up(sentence, deck, changed, *expected, end=0):
    """A run of a deck, then of another from its state: refused with these words, or not at all."""
    state = FOLDER / 'state.h5'
    status, said = run('first', deck, '-o', state, '--overwrite')
    checks.true(status == end, f'{sentence}: the first run ends with {status}')
    status, said = run('second', changed, '--restart', state, '-o', FOLDER / 'new.h5', '--overwrite')
    line = changed[:changed.index(expected[0])].count('\n') + 1 if expected else 0
    checks.true(status == (2 if expected else 0), f'{sentence}: status {status}')
    if expected:
        checks.true(f'second.inp:{line}:' in said, f'{sentence}: line {line} in {said!r}')
    for words in expected[1:]:
        checks.true(words in said, f'{sentence}: "{words}" in {said!r}')


# the same number of freedoms, others; the second step ends with its first increment
two = MASSES + FIRST + later('*ENERGY PRINT, LIMIT=1e-30\n*RESTART, WRITE, FREQUENCY=1000\n'
                             '*CLOAD\n2, 2, 0.1\n')
taken_up('load on another freedom', two, two.replace('2, 2, 0.1', '3, 2, 0.1'),
         '*STEP\n*DYNAMIC, DIRECT\n0.01, 1\n*ENERGY', 'the state has a freedom 2 of node 2',
         'no later step names', end=4)
one = MASSES + FIRST
for card, what in (('*CLOAD\n2, 2, 1\n', '2, 2, 1'), ('*BOUNDARY\n2, 2\n', '2, 2\n*END'),
                   ('*INITIAL CONDITIONS, TYPE=VELOCITY\n2, 2, 3\n', '2, 2, 3')):
    taken_up(f'{card.split()[0]} on a new freedom', one, one + later(card), what,
             'the state has no freedom 2 of node 2', 'from its start')
shaken = MASSES + '*AMPLITUDE, NAME=a\n0, 0, 9, 1\n' + FIRST
taken_up('base motion along a new direction', shaken,
         shaken + later('*BASE MOTION, DOF=2, AMPLITUDE=a\n'), '*STEP\n*DYNAMIC, DIRECT\n0.01, 1\n*BASE',
         'the state has no freedom 2 of node 1')
taken_up('load on a freedom that is there', one, one + later('*CLOAD\n3, 1, 1\n'))
taken_up('explicit step', BAR + FIRST, BAR + FIRST + later('', ', DIRECT, EXPLICIT'),
         '*STEP\n*DYNAMIC, DIRECT, EXPLICIT', 'element 1 is implicit with lumped mass throughout',
         'in the state it is implicit with consistent mass')
limited = MASSES + FIRST.replace('*RESTART', '*ENERGY PRINT, LIMIT=1\n*RESTART')
taken_up('name, limit of the balance and end of the step', limited, limited.replace('LIMIT=1', 'LIMIT=0.5')
         .replace('*STEP', '*STEP, NAME=shake').replace('0.01, 1', '0.01, 2'))
status, said = run('second', limited.replace('LIMIT=1', 'LIMIT=0.2').replace('0.01, 1', '0.01, 3'),
                   '--restart', FOLDER / 'new.h5', '-o', FOLDER / 'new.h5')
checks.true(status == 0, f'another limit, in the same file: {said!r}')
automatic = BAR + SCHEME + FIRST
taken_up('longer increments with SCHEME=AUTO', automatic, automatic + later('', times='0.5, 1'),
         '*STEP\n*DYNAMIC, DIRECT\n0.5', 'element 1 is implicit', 'in the state it is explicit')
checks.finish()
