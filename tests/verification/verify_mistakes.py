"""Typical mistakes that are legal decks: each gets a warning that names the cure, in `carom check`, on
the terminal of `carom run` and in its log; with the cure the warning goes. Mistakes that are errors are
in tests/deck_errors. The decks of input/ get no such warning."""
import math
import subprocess
import sys
from pathlib import Path

from carom_case import INPUT, Checks, scratch_folder
from solid_mesh import Mesh

CAROM = str(Path(sys.argv[1]).resolve())
checks = Checks()


def answers(deck, *options):
    """What check, the terminal of a run, and its log say of a deck (a text or a path), one line each."""
    folder = scratch_folder()
    path = Path(deck) if isinstance(deck, Path) else folder / 'deck.inp'
    if path.parent == folder:
        path.write_text(deck)
    result = folder / 'result.h5'
    texts = [subprocess.run([CAROM, *words, *options], capture_output=True, text=True, timeout=60).stdout
             for words in (('check', str(path)), ('run', str(path), '-o', str(result)))]
    log = folder / 'result.log'
    texts.append(log.read_text() if log.exists() else '')
    return [' '.join(text.split()) for text in texts]


def mistake(name, deck, cured, *words, options=()):
    """A deck brings a warning that holds all words, a cure among them; the cured deck brings none."""
    for place, text in zip(('check', 'run', 'log'), answers(deck, *options)):
        at = text.find('warning: ')
        found = text[at:] if at >= 0 else ''
        for word in ('warning: ', 'cure: ', *words):
            checks.true(word in found, f"{name}, {place}: '{word}'")
    if cured is not None:
        for place, text in zip(('check', 'run', 'log'), answers(cured)):
            checks.true('warning: ' not in text and text, f'{name}, {place}: no warning with the cure')


def block(number, x, y, nx, ny, kind='CPE4'):
    """Nodes and elements of a block, named BODY<number>, its sides as surfaces LOW<number>, TOP<number>."""
    nodes = {'3': 3, '4': 4, '6': 6, '8': 8}[kind[3]]
    mesh = Mesh(nx, ny, nodes, lambda s, t: (x[0] + s*(x[1] - x[0]), y[0] + t*(y[1] - y[0])))
    first = 1000*number
    lines = [f'*NODE, NSET=BODY{number}']
    lines += [f'{first + i}, {a!r}, {b!r}' for i, (a, b) in enumerate(mesh.x.tolist())]
    lines += [f'*ELEMENT, TYPE={kind}, ELSET=BODY{number}']
    lines += [f'{first + i}, ' + ', '.join(str(first + n) for n in element)
              for i, element in enumerate(mesh.elements.tolist())]
    if nodes == 4:
        for name, side, e in (('LOW', 'S1', range(nx)), ('TOP', 'S3', range(nx*ny - nx, nx*ny))):
            lines += [f'*SURFACE, NAME={name}{number}', *(f'{first + i}, {side}' for i in e)]
    return '\n'.join(lines) + '\n'


def section(number=1, material='200., 0.3', density='1.', extra='', parameters=''):
    """Material and section of a block."""
    return (f'*MATERIAL, NAME=STUFF{number}\n*ELASTIC\n{material}\n*DENSITY\n{density}\n{extra}'
            f'*SOLID SECTION, ELSET=BODY{number}, MATERIAL=STUFF{number}{parameters}\n')


def step(loads='', dt='1e-4', end='2e-4', output='*NODE PRINT\nU\n'):
    """A short dynamic step."""
    return f'*STEP\n*DYNAMIC, DIRECT\n{dt}, {end}\n{loads}{output}*END STEP\n'


def pair(slave, master, impact='', options=''):
    """A contact pair."""
    return (f'*SURFACE INTERACTION, NAME=HIT\n{impact}'
            f'*CONTACT PAIR, INTERACTION=HIT{options}\n{slave}, {master}\n')


def plane(normal='0., 1.'):
    """A plane below the blocks."""
    return f'*RIGID SURFACE, NAME=FLOOR, TYPE=PLANE\n0., -0.1\n{normal}\n'


ONE = block(1, (0., 2.), (0., 1.), 4, 2)
TWO = ONE + block(2, (0., 2.), (1.1, 2.1), 4, 2) + section() + section(2)

# 1: other sides of the bodies than those that meet
mistake('sides that face away', TWO + pair('LOW1', 'TOP2') + step(), TWO + pair('TOP1', 'LOW2') + step(),
        'no side of LOW1 faces a side of TOP2', 'name the sides on which they meet')
mistake('one side that faces away', TWO + pair('TOP1', 'TOP2') + step(), None,
        'no side of TOP1 faces a side of TOP2', 'name the sides on which they meet')
mistake('sides that face away from a wall', ONE + section() + plane() + pair('TOP1', 'FLOOR') + step(),
        ONE + section() + plane() + pair('LOW1', 'FLOOR') + step(),
        'all sides of TOP1 face away from FLOOR', 'name the sides on which the body meets it on *SURFACE')

# 2: units mixed
SHORT = step(dt='1e-9', end='2e-9')
GRAVITY = '*DLOAD\nBODY1, GRAV, {}, 0., -1.\n'
mistake('N/mm2 with kg/m3', ONE + section(1, '210000., 0.3', '7850.') + SHORT,
        ONE + section(1, '210000., 0.3', '7.85e-9') + SHORT,
        'the units of STUFF1 do not go together', 'steel in N/mm2', 'write the density 7.85e-9 t/mm3')
mistake('N/mm2 with kg/mm3', ONE + section(1, '210000., 0.3', '7.85e-6') + SHORT, None,
        'the density 7.85e-6 that in kg/mm3', 'write the density 7.85e-9 t/mm3')
mistake('N/m2 with t/mm3', ONE + section(1, '7e10, 0.3', '2.7e-9') + SHORT,
        ONE + section(1, '7e10, 0.3', '2700.') + SHORT, 'aluminium in N/m2', 'density 2700 kg/m3',
        'E = 70000 N/mm2')
mistake('gravity in m/s2 with N/mm2', ONE + section(1, '210000., 0.3', '7.85e-9')
        + step(dt='1e-9', end='2e-9', loads=GRAVITY.format('9.81')), ONE + section(1, '210000., 0.3', '7.85e-9')
        + step(dt='1e-9', end='2e-9', loads=GRAVITY.format('9810.')), 'gravity 9.81 with a material in N/mm2', 'write 9810 mm/s2')
mistake('gravity in mm/s2 with N/m2', ONE + section(1, '2.1e11, 0.3', '7850.')
        + step(dt='1e-9', end='2e-9', loads=GRAVITY.format('9810.')), None, 'gravity 9810 with a material in N/m2', 'write 9.81 m/s2')
for name, elastic, density in (('an example', '1., 0.3', '1.'), ('kN, m, t', '3e7, 0.2', '2.5'),
                               ('GPa, kg, mm, ms', '210., 0.3', '7.85e-6'),
                               ('nylon in N, mm, t, s', '2000., 0.4', '1.15e-9'),
                               ('no known substance', '900., 0.3', '7.')):
    checks.true('warning: ' not in answers(ONE + section(1, elastic, density) + SHORT)[0],
                f'consistent units are free: {name}')

# 4: a step ten times too large
mistake('a step of 16 increments a period', INPUT/'sdof'/'sdof.inp', INPUT/'sdof'/'sdof.inp',
        'the step 0.4 is too large for the longest period, 6.28: that is 16 increments',
        'take a step of about 0.13', options=('--define', 'dt=0.4'))
mistake('a step of 9.5 increments a contact', INPUT/'bar'/'bar_implicit.inp', INPUT/'bar'/'bar_implicit.inp',
        'the step 0.07 is too large for a contact that lasts about 2 L / c = 0.667: that is 9.5 increments',
        'take a step of about 0.013', options=('--define', 'dt=0.07'))

# a mass of 2 falls on a spring of 1e6: its period there is 2 pi sqrt(2/1e6) = 0.00889
BOUNCE = ('*NODE\n1, 0., 1.\n*ELEMENT, TYPE=MASS, ELSET=A\n1, 1\n*MASS, ELSET=A\n2.\n'
          '*SURFACE, NAME=B, TYPE=NODE\n1\n*RIGID SURFACE, NAME=F, TYPE=PLANE\n0., 0.\n0., 1.\n'
          + pair('B', 'F', '*IMPACT, METHOD=PENALTY, STIFFNESS=1e6\n')
          + step(dt='{}', end='2.', loads='*DLOAD\n, GRAV, 9.81, 0., -1.\n'))
mistake('a step that skips a penalty spring', BOUNCE.format('0.01'), BOUNCE.format('4.4e-4'),
        'the mass 2 there has the period 0.00889 on STIFFNESS=1e6, 0.89 increments',
        'a step of about 0.00044', 'METHOD=TRANSFORMATION')

# 6: slave and master exchanged
FINE = ONE + block(2, (0., 2.), (1.1, 2.1), 12, 2) + section() + section(2)
mistake('the coarse surface is the slave', FINE + pair('TOP1', 'LOW2') + step(),
        FINE + pair('LOW2', 'TOP1') + step(), '3 times as far apart as those of the master LOW2',
        'exchange them, LOW2, TOP1', 'TYPE=SURFACE TO SURFACE', 'PASSES=2')
for option in (', TYPE=SURFACE TO SURFACE', ', PASSES=2'):
    checks.true('warning: ' not in answers(FINE + pair('TOP1', 'LOW2', options=option) + step())[0],
                f'a coarse slave is harmless with{option}')

# 8: triangles that lock
mistake('a slender body of CPE3', block(1, (0., 10.), (0., 1.), 20, 2, 'CPE3') + section() + step(),
        block(1, (0., 10.), (0., 1.), 20, 2, 'CPE6') + section() + step(),
        'CPE3 are far too stiff in bending', 'mesh with CPE6 or CPE8')
mistake('yielding CPE3', block(1, (0., 2.), (0., 1.), 4, 2, 'CPE3')
        + section(extra='*PLASTIC\n1., 0.\n') + step(), None, 'CPE3 lock', 'where STUFF1 yields', 'CPE6',
        'CPE4 with BBAR=YES')
mistake('nearly incompressible CPE4', ONE + section(1, '200., 0.499') + step(),
        ONE + section(1, '200., 0.499', parameters=', BBAR=YES') + step(),
        "CPE4 lock, they are far too stiff, with a Poisson's ratio of 0.499", 'BBAR=YES on *SOLID SECTION')

# 9: a restitution on a body that deforms
mistake('a restitution on a continuum', ONE + section() + plane()
        + pair('LOW1', 'FLOOR', '*IMPACT, RESTITUTION=0.8\n') + step(),
        ONE + section() + plane() + pair('LOW1', 'FLOOR', '*IMPACT\n') + step(),
        'RESTITUTION=0.8 acts on 5 nodes of a body that deforms (LOW1)', 'leave RESTITUTION away')

# a mass of 2 moved along 1 - cos 2t, by points: its reaction has no inertia, that of a velocity has
CURVE = ''.join(f'{0.05*i!r}, {1.0 - math.cos(0.1*i)!r}\n' for i in range(41))
RAMP = '0., 0.\n1., 1.\n2., 1.\n'
MOVED = ('*NODE, NSET=N\n1, 0., 0.\n2, 1., 0.\n*ELEMENT, TYPE=MASS, ELSET=A\n1, 1\n2, 2\n*MASS, ELSET=A\n2.\n'
         '*ELEMENT, TYPE=SPRING2, ELSET=S\n3, 1, 2\n*SPRING, ELSET=S\n1, 1\n1.\n*AMPLITUDE, NAME=WAY\n{}')
DRIVEN = step(dt='0.01', end='2.', loads='*BOUNDARY, AMPLITUDE=WAY{}\n1, 1, 1, 1.\n', output='*NODE PRINT\nU, RF\n')
mistake('the reaction of a displacement by points', MOVED.format(CURVE) + DRIVEN.format(''),
        MOVED.format(CURVE) + DRIVEN.format(', TYPE=VELOCITY'), 'goes straight from point to point of WAY',
        'RF lacks the inertia of the mass 2 there', 'TYPE=VELOCITY or TYPE=ACCELERATION')
checks.true('warning: ' not in answers(MOVED.format(RAMP) + DRIVEN.format(''))[0], 'a ramp has no inertia to miss')
checks.true('warning: ' not in answers((MOVED.format(CURVE) + DRIVEN.format('')).replace('U, RF', 'U'))[0],
            'no warning where RF is not asked for')

# 10: no output
mistake('no output', ONE + section() + step(output=''), ONE + section() + step(),
        'no output is asked for', '*NODE PRINT', '*NODE FILE', '*EL FILE', '*CONTACT PRINT',
        '*ENERGY PRINT')
# modes are written unasked, also those after a static step
MODES = '*STEP\n*FREQUENCY\n3\n*END STEP\n'
for before in ('', '*STEP\n*STATIC\n*END STEP\n'):
    for place, text in zip(('check', 'run', 'log'),
                           answers(ONE + section() + '*BOUNDARY\n1000, 1, 2\n1001, 2\n'
                                   + before + MODES)):
        checks.true('warning: ' not in text and ('frequency, 3 modes' in text),
                    f'modes {"after a static step" if before else "alone"}, no output asked for: {place}')

for deck in sorted(INPUT.glob('*/*.inp')):
    if '*STEP' not in deck.read_text().upper():   # a mesh
        continue
    said = subprocess.run([CAROM, 'check', str(deck)], capture_output=True, text=True, timeout=60).stdout
    checks.true('the deck is sound' in said and 'warning: ' not in said,
                f'{deck.parent.name}/{deck.name} gets no warning')
checks.finish()
