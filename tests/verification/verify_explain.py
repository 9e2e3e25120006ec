"""`carom check DECK --explain`: its figures are those of closed solutions and of the program's own
frequency steps; every deck of input/ is explained in one screen of at most 30 lines of 100 columns."""
import math
import re
import subprocess
import sys
from pathlib import Path

from carom_case import INPUT, Checks, run_deck, scratch_folder

CAROM = str(Path(sys.argv[1]).resolve())
checks = Checks()


def explain(path, *options):
    """The explanation of a deck: its lines, and all of it as one line."""
    done = subprocess.run([CAROM, 'check', str(path), '--explain', *options], capture_output=True,
                          text=True, timeout=60)
    if done.returncode != 0:
        sys.exit(f'FAILED: {path}: {done.stdout}{done.stderr}')
    return done.stdout.splitlines(), ' '.join(done.stdout.split())


def figure(text, words):
    """The number behind some words."""
    found = re.search(re.escape(words) + r'\s*([-+.0-9e]*[0-9])', text)
    return float(found.group(1)) if found else math.nan


def shows(text, name, words, value, digits=4):
    """A figure is the expected one but for the digits that are printed."""
    checks.at_most(abs(figure(text, words)/value - 1.0), 0.6*10.0**(1 - digits),
                   f"{name}: '{words}' {value:.6g}, relative error")


def modes(deck, n):
    """Frequencies of a deck whose steps are replaced by a frequency step."""
    text = deck.read_text()
    for name in re.findall(r'INPUT=(\S+)', text):
        text = text.replace(f'INPUT={name}', f'INPUT={deck.parent/name}')
    return run_deck(text[:text.index('*STEP')] + f'*STEP\n*FREQUENCY\n{n}\n*NODE FILE\nU\n*END STEP\n')


# one mass on a spring: period 2 pi, critical step 2
_, text = explain(INPUT/'sdof'/'sdof.inp')
shows(text, 'sdof', 'longest period', 2.0*math.pi)
shows(text, 'sdof', 'shortest', 2.0*math.pi)
shows(text, 'sdof', 'critical step if all were explicit', 2.0)
shows(text, 'sdof', 'recommended step:', 2.0*math.pi/20.0, 3)
shows(text, 'sdof', 'strain energy', 0.5)
shows(text, 'sdof', 'mass', 1.0)
shows(text, 'sdof', 'smallest gap', 1.5)
checks.true('157 increments' in text, 'sdof: a period is 157 increments')

# a free bar of length 10 with wave speed 30, 100 elements, hits a wall at distance 5 with speed 10
for name, step in (('bar_implicit', 1/300), ('bar_explicit', 1/600), ('bar_mixed', 1/600)):
    _, text = explain(INPUT/'bar'/f'{name}.inp')
    shows(text, name, 'wave speed', 30.0)
    shows(text, name, 'a wave takes', 1.0/3.0)
    shows(text, name, 'through the body (10),', 1.0/300.0)
    shows(text, name, 'longest period', 2.0/3.0, 3)
    shows(text, name, 'shortest', math.pi/300.0)
    shows(text, name, 'touches after', 0.5)
    shows(text, name, '2 L / c =', 2.0/3.0)
    shows(text, name, 'Courant number', step*300.0, 3)
    shows(text, name, 'critical step if all were explicit' if name == 'bar_implicit'
          else 'critical step', 1.0/300.0)
    shows(text, name, 'recommended step:', 1/300 if name == 'bar_implicit' else 0.9/300, 3)
    shows(text, name, 'kinetic energy', 500.0)

# a cantilever: its first bending period is that of the frequency step, and near Euler and Bernoulli's
_, text = explain(INPUT/'cantilever'/'modes.inp')
own = run_deck(INPUT/'cantilever'/'modes.inp')['frequency/frequency'][0]
shows(text, 'cantilever', 'longest period', 1.0/own)
beam = 2.0*math.pi/(1.8751041**2*math.sqrt(210e9*0.1**2/12.0/7800.0))
checks.at_most(abs(figure(text, 'longest period')/beam - 1.0), 0.01,
               'cantilever: longest period and that of the slender beam, relative difference')
shows(text, 'cantilever', 'wave speed', math.sqrt(210e9/(1.0 - 0.09)/7800.0))
shows(text, 'cantilever', 'shear', math.sqrt(210e9/2.6/7800.0))
shows(text, 'cantilever', 'mass', 780.0)

# two discs of radius 1 fly at each other with 0.5 each, 0.02 apart
_, text = explain(INPUT/'two_discs'/'equal.inp')
speed = math.sqrt(100.0*0.7/(1.3*0.4))
shows(text, 'two_discs', 'wave speed', speed)
shows(text, 'two_discs', 'smallest gap', 0.02)
shows(text, 'two_discs', 'with speed', 1.0)
shows(text, 'two_discs', 'touches after', 0.02)
shows(text, 'two_discs', '2 L / c =', 4.0/speed)
shows(text, 'two_discs', 'spacing slave / master', 1.0)
checks.at_most(abs(figure(text, 'kinetic energy')/(math.pi*0.25) - 1.0), 0.01,
               'two_discs: kinetic energy, relative difference from that of true circles')
frequencies = modes(INPUT/'two_discs'/'equal.inp', 7)['frequency/frequency']
checks.at_most(abs(frequencies[:6]).max(), 1e-4, 'two_discs: six rigid motions')
shows(text, 'two_discs', 'longest period', 1.0/frequencies[6])
few = modes(INPUT/'two_discs'/'equal.inp', 4)['frequency/frequency']
checks.at_most(abs(few).max(), 1e-4, 'two_discs: a frequency step of four modes finds rigid motions')

# a ball falls by 1 with gravity 10: it touches after sqrt(2/10)
_, text = explain(INPUT/'ball'/'ball.inp')
shows(text, 'ball', 'touches after', math.sqrt(0.2))
shows(text, 'ball', 'with speed', math.sqrt(20.0))

# a mass of 2 on a penalty spring of 1e6
deck = scratch_folder() / 'penalty.inp'
deck.write_text('*NODE\n1, 0., 1.\n*ELEMENT, TYPE=MASS, ELSET=A\n1, 1\n*MASS, ELSET=A\n2.\n'
                '*SURFACE, NAME=B, TYPE=NODE\n1\n*RIGID SURFACE, NAME=F, TYPE=PLANE\n0., 0.\n0., 1.\n'
                '*SURFACE INTERACTION, NAME=I\n*IMPACT, METHOD=PENALTY, STIFFNESS=1e6\n'
                '*CONTACT PAIR, INTERACTION=I\nB, F\n*STEP\n*DYNAMIC, DIRECT\n0.01, 2.\n'
                '*DLOAD\n, GRAV, 9.81, 0., -1.\n*NODE PRINT\nU\n*END STEP\n')
_, text = explain(deck)
period = 2.0*math.pi*math.sqrt(2.0/1e6)
shows(text, 'penalty', 'has the period', period)
shows(text, 'penalty', 'recommended step:', period/20.0, 3)
checks.true('nothing here vibrates' not in text, 'penalty: a step is recommended')

# a mass of 2 with a spring of 200 to a contact node without mass: it swings while the node touches
deck = scratch_folder() / 'tip.inp'
deck.write_text('*NODE\n1, 0., 1.\n2, 0., 0.5\n*ELEMENT, TYPE=MASS, ELSET=A\n1, 1\n*MASS, ELSET=A\n2.\n'
                '*ELEMENT, TYPE=SPRINGA, ELSET=S\n2, 1, 2\n*SPRING, ELSET=S\n200.\n*BOUNDARY\n1, 1\n2, 1\n'
                '*SURFACE, NAME=B, TYPE=NODE\n2\n*RIGID SURFACE, NAME=F, TYPE=PLANE\n0., 0.\n0., 1.\n'
                '*SURFACE INTERACTION, NAME=I\n*IMPACT\n*CONTACT PAIR, INTERACTION=I\nB, F\n'
                '*INITIAL CONDITIONS, TYPE=VELOCITY\n1, 2, -1.\n2, 2, -1.\n*STEP\n*DYNAMIC, DIRECT\n'
                '0.005, 1.5\n*NODE PRINT\nU\n*END STEP\n')
_, text = explain(deck)
period = 2.0*math.pi*math.sqrt(2.0/200.0)
checks.true('longest period: none while all gaps are open' in text, 'massless tip: no period while it is free')
checks.true('nothing' not in text, 'massless tip: something vibrates')
shows(text, 'massless tip', 'shortest', period)
shows(text, 'massless tip', 'recommended step:', period/20.0, 3)

# what a base motion does to a gap is not foreseen, and that is said
for speed, words in ((0.0, 'not closing at the start; *BASE MOTION moves it later'),
                     (0.5, 'touches after 2 (200 increments) with speed 0.5, without *BASE MOTION, which moves it too')):
    deck = scratch_folder() / 'base.inp'
    deck.write_text('*NODE\n1, 0., 0.\n*ELEMENT, TYPE=MASS, ELSET=A\n1, 1\n*MASS, ELSET=A\n2.\n'
                    '*AMPLITUDE, NAME=G\n0., 1.\n*SURFACE, NAME=B, TYPE=NODE\n1\n'
                    '*RIGID SURFACE, NAME=F, TYPE=PLANE\n-1., 0.\n1., 0.\n*SURFACE INTERACTION, NAME=I\n*IMPACT\n'
                    f'*CONTACT PAIR, INTERACTION=I\nB, F\n*INITIAL CONDITIONS, TYPE=VELOCITY\n1, 1, -{speed}\n'
                    '*STEP\n*DYNAMIC, DIRECT\n0.01, 1.5\n*BASE MOTION, AMPLITUDE=G, DOF=1\n2.\n'
                    '*NODE PRINT\nU\n*END STEP\n')
    checks.true(words in explain(deck)[1], f'base motion, speed {speed}: said')

# masses that nothing holds have no period
_, text = explain(INPUT/'cradle'/'cradle.inp')
checks.true('longest period: none' in text, 'cradle: no period')

for deck in sorted(INPUT.glob('*/*.inp')):
    # ten thousand freedoms take some seconds; meshes are no decks
    if deck.parent.name == 'block' or '*STEP' not in deck.read_text().upper():
        continue
    lines, text = explain(deck)
    checks.true(len(lines) <= 30 and max(map(len, lines)) <= 100 and 'step 1' in text,
                f'{deck.parent.name}/{deck.name}: one screen')

# many steps are explained to the last
text = (INPUT/'sdof'/'sdof.inp').read_text()
many = scratch_folder()/'many.inp'
many.write_text(text + 14*text[text.index('*STEP'):])
_, text = explain(many)
checks.true('step 15 ' in text, 'fifteen steps are all explained')

scratch = scratch_folder()
for words in (['run', str(INPUT/'sdof'/'sdof.inp'), '--explain', '-o', str(scratch/'x.h5')],):
    done = subprocess.run([CAROM, *words], capture_output=True, text=True, timeout=60)
    checks.true(done.returncode == 1 and '--explain goes with check' in done.stderr,
                '--explain with run is an error of the command line')
checks.finish()
