"""Every state of a run taken up again leads to the same bits.

Each case is a deck with features that have a state of their own. `resume_states` keeps states of its
run, goes on from each in a simulation built anew, and compares all entries of all later states.
"""
import re
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'verification'))

from carom_case import INPUT, Checks, scratch_folder  # noqa: E402
from plane_bodies import Deck, block  # noqa: E402

ALL = 1000000
WITHOUT_MUMPS = 'built without MUMPS'


# --- decks of input/, some with other words ---------------------------------------------------

def changed(deck, *changes):
    """The text of a deck of input/ with words replaced, each of which must be there."""
    path = INPUT / deck
    text = re.sub(r'INPUT=(\S+)', lambda found: f'INPUT={path.parent / found[1]}', path.read_text())
    for old, new in changes:
        if old not in text:
            sys.exit(f'FAILED: {deck} has no {old!r}')
        text = text.replace(old, new)
    return text


def input_cases():
    """Name, deck, states, increments at most, definitions."""
    yield 'mass at a wall', INPUT / 'sdof/sdof.inp', 8, 0, {}
    yield 'mass at a wall, every state', INPUT / 'sdof/sdof.inp', ALL, 0, {'dt': 0.2, 'e': 0.8}
    yield 'mass at a wall, fictitious force', INPUT / 'sdof/sdof_fictitious.inp', 4, 1500, {}
    yield 'two masses', INPUT / 'two_dof/two_dof.inp', 4, 0, {}
    yield 'bouncing ball', INPUT / 'ball/ball.inp', 8, 0, {}
    yield 'bouncing ball, fictitious force', INPUT / 'ball/ball_fictitious.inp', 8, 0, {}
    yield 'cradle', INPUT / 'cradle/cradle.inp', ALL, 0, {}
    yield 'colliding masses', INPUT / 'colliding_masses/colliding_masses.inp', ALL, 0, {}
    for kind in ('implicit', 'explicit', 'mixed', 'fictitious'):
        yield f'bar, {kind}', INPUT / f'bar/bar_{kind}.inp', 4, 0, {}
    yield 'base motion', INPUT / 'buildings/buildings.inp', 2, 1500, {}
    yield 'ball on a circle', INPUT / 'oblique_ball/point.inp', 6, 0, {}
    yield 'elastic ball', INPUT / 'oblique_ball/elastic.inp', 1, 60, {}
    yield 'plastic cylinder', INPUT / 'thick_cylinder/plastic_cax4.inp', ALL, 0, {}
    yield 'friction', INPUT / 'sliding_block/sliding.inp', 2, 200, {}
    yield 'friction on a slope', INPUT / 'sliding_block/slope.inp', 2, 200, {}
    for kind in ('q4', 'q4_fictitious', 'q4_massless', 'q8'):
        yield f'strip, {kind}', INPUT / f'elastic_strip/{kind}.inp', 1, 80, {}
    yield 'crack against itself', INPUT / 'crack/slap.inp', 1, 25, {}


def changed_cases():
    sdof, bar = 'sdof/sdof.inp', 'bar/bar_implicit.inp'
    yield 'EVENTS=ANCHOR', changed(sdof, ('BETA=1/6', 'EVENTS=ANCHOR')), 8, 0, {'e': 0.7}
    yield 'EVENTS=ANCHOR, every state', changed(sdof, ('BETA=1/6', 'EVENTS=ANCHOR')), ALL, 0, {'dt': 0.3}
    yield 'EVENTS=ANCHOR, bar', changed(bar, ('BETA=1/4', 'EVENTS=ANCHOR')), 4, 0, {}
    fourth = (('DIRECT', 'DIRECT, ORDER=4'), (', BETA=1/6', ''))
    yield 'ORDER=4', changed(sdof, *fourth), 8, 0, {'e': 0.6}
    yield 'ORDER=4, bar', changed(bar, fourth[0], (', BETA=1/4', '')), 2, 100, {'dt': 2e-2}
    tolerance = ('DYNAMIC, DIRECT', 'DYNAMIC, TOLERANCE=1e-3')
    yield 'TOLERANCE', changed(sdof, tolerance), 8, 0, {'e': 0.6}
    yield 'TOLERANCE, every state', changed(sdof, tolerance), ALL, 0, {'end': 3.0}
    yield 'HHT', changed(bar, ('DYNAMIC, DIRECT', 'DYNAMIC, DIRECT, ALPHA=-0.1')), 4, 0, {}
    yield 'MUMPS', changed('elastic_strip/q4.inp', ('DYNAMIC, DIRECT', 'DYNAMIC, DIRECT, SOLVER=MUMPS')), 1, 60, {}


# --- two blocks --------------------------------------------------------------------------------

PLASTIC = '*PLASTIC, HARDENING=KINEMATIC\n5.0, 0.0\n12.0, 0.5\n'


def blocks(more='', young=1e3, options='', impact='METHOD=TRANSFORMATION', friction=None, speed=(1.0, -2.0),
           gap=0.003, kind='CPE'):
    """A block falls aslant on a larger one that is held at its bottom."""
    deck = Deck()
    deck.body('low', block(5, 3, 4, (0.0, 0.0), (1.5, 0.5)), young=young, poisson=0.2, kind=kind, more=more)
    deck.body('top', block(3, 3, 4, (0.4, 0.5 + gap), (0.9, 0.9)), young=young, kind=kind, more=more)
    deck.add('*BOUNDARY\n' + '\n'.join(f'{deck.node("low", k)}, 1, 2' for k in range(6)))
    deck.surface('FLOOR', ('low', 3)).surface('SOLE', ('top', 1))
    deck.speed('top', *speed)
    deck.pair('SOLE', 'FLOOR', options, impact, friction)
    return deck


def block_cases():
    dt, end = 1e-3, 0.06
    yield 'nodes on sides', blocks(friction=0.3).text(dt, end), 8, 0, {}
    yield 'weighted rows', blocks(options='TYPE=SURFACE TO SURFACE', friction=0.3).text(dt, end), 6, 0, {}
    yield 'two passes', blocks(options='PASSES=2').text(dt, end), 4, 0, {}
    yield 'small sliding', blocks(options='SMALL SLIDING', friction=0.2).text(dt, end), 4, 0, {}
    yield 'mass redistributed', blocks(options='MASS=REDISTRIBUTED').text(dt, end), 4, 0, {}
    yield 'restitution', blocks(impact='METHOD=TRANSFORMATION, RESTITUTION=0.5').text(dt, end), 4, 0, {}
    yield 'penalty', blocks(impact='METHOD=PENALTY, STIFFNESS=1e3', friction=0.3).text(dt, end), 4, 0, {}
    yield 'Lagrange', blocks(impact='METHOD=LAGRANGE', friction=0.3).text(dt, end), 4, 0, {}
    for solution in ('ITERATION', 'DIRECT'):
        yield (f'fictitious force, {solution}',
               blocks(impact=f'METHOD=FICTITIOUS FORCE, SOLUTION={solution}').text(dt, end), 4, 0, {})
    yield ('fictitious force, restitution',
           blocks(impact='METHOD=FICTITIOUS FORCE, RESTITUTION=0.7').text(dt, end), 4, 0, {})
    yield 'damping', blocks(more='*DAMPING, ALPHA=1, BETA=1e-3\n', friction=0.1).text(dt, end), 4, 0, {}
    yield 'plastic', blocks(more=PLASTIC, friction=0.2, speed=(1.0, -4.0)).text(dt, 0.04), 6, 0, {}
    yield 'plastic, ADJUST', blocks(more=PLASTIC, gap=-0.004, options='ADJUST').text(dt, 0.03), 3, 0, {}
    explicit = '*ELEMENT GROUP, ELSET=low, SCHEME=EXPLICIT\n*ELEMENT GROUP, ELSET=top, SCHEME=EXPLICIT\n'
    yield 'plastic, explicit', blocks(more=PLASTIC).add(explicit).text(dt, end), 6, 0, {}
    mixed = '*ELEMENT GROUP, ELSET=low, SCHEME=EXPLICIT\n'
    yield 'plastic, mixed', blocks(more=PLASTIC).add(mixed).text(dt, end), 4, 0, {}
    yield 'adaptive blocks', blocks(friction=0.2).text(dt, 0.03, options='TOLERANCE=1e-2'), 4, 0, {}


def flying_case():
    """A plastic block that is wholly explicit and meets nothing, loaded and damped."""
    deck = Deck()
    deck.body('fly', block(4, 3, 4, (0.0, 0.0), (1.0, 0.6)), more=PLASTIC + '*DAMPING, ALPHA=0.5\n')
    deck.add('*ELEMENT GROUP, ELSET=fly, SCHEME=EXPLICIT\n*AMPLITUDE, NAME=pulse\n0, 0, 0.02, 1, 0.07, 0.2\n'
             f'*BOUNDARY\n{deck.node("fly", 0)}, 1, 2\n')
    loads = f'*CLOAD, AMPLITUDE=pulse\n{deck.node("fly", 19)}, 1, 3.0\n*DLOAD\nGRAV, 9.81, 0, -1, 0\n'
    return 'explicit without contact', deck.text(1e-3, 0.1, cards=loads.replace('GRAV', 'fly, GRAV')), 8, 0, {}


# --- steps after steps -------------------------------------------------------------------------

CHAIN = """*NODE
1, 0, 0
2, 1, 0
3, 2, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
2, 2
3, 3
*ELEMENT, TYPE=SPRING2, ELSET=spring
4, 1, 2
5, 2, 3
*ELEMENT, TYPE=DASHPOT2, ELSET=dashpot
6, 1, 2
*MASS, ELSET=mass
2
*SPRING, ELSET=spring
1, 1
40
*DASHPOT, ELSET=dashpot
1, 1
0.3
*AMPLITUDE, NAME=swing, TIME=TOTAL TIME
0, 0, 0.4, 1, 1.1, -0.6, 2, 0.3
*AMPLITUDE, NAME=pulse
0, 0, 0.15, 1, 0.3, 0
*SURFACE, NAME=tip, TYPE=NODE
3
*RIGID SURFACE, NAME=wall, TYPE=PLANE, AMPLITUDE=swing
2.06, 0, 0
-1, 0, 0
-1, 0, 0, 0.05
*SURFACE INTERACTION, NAME=hit
*IMPACT<IMPACT>
*CONTACT PAIR, INTERACTION=hit
tip, wall
*BOUNDARY
1, 1
"""

HISTORY = (('STATIC, DIRECT', '0.1, 0.35', '*CLOAD\n3, 1, 6\n'),
           ('STATIC', '0.02, 0.4', '*BOUNDARY\n1, 1, 1, 0.01\n*CLOAD\n2, 1, -1\n'),
           ('DYNAMIC, DIRECT', '0.02, 0.45', '*CLOAD, OP=NEW, AMPLITUDE=pulse\n3, 1, 4\n'),
           ('DYNAMIC, DIRECT', '0.01, 0.205', '*BOUNDARY, TYPE=VELOCITY, AMPLITUDE=pulse\n1, 1, 1, 0.3\n'),
           ('DYNAMIC, DIRECT', '0.02, 0.3', '*BOUNDARY, OP=NEW\n2, 1\n*DLOAD\nmass, GRAV, 9.81, 1, 0, 0\n'),
           ('DYNAMIC, TOLERANCE=1e-3', '0.02, 0.3',
            '*BOUNDARY, OP=NEW, TYPE=ACCELERATION\n1, 1, 1, 2\n*INITIAL CONDITIONS, TYPE=VELOCITY\n3, 1, 1\n'))


LET_GO = (('STATIC, DIRECT', '0.1, 0.3', '*BOUNDARY\n3, 1, 1, -0.04\n*CLOAD\n2, 1, 3\n'),
          ('STATIC, DIRECT', '0.1, 0.5', '*BOUNDARY, OP=NEW\n1, 1\n*CLOAD, OP=NEW\n3, 1, 1\n'),
          ('STATIC', '0.1, 0.3', '*CLOAD, OP=NEW\n'),
          ('DYNAMIC, DIRECT', '0.02, 0.1', ''))


def steps(history):
    return ''.join(f'*STEP\n*{procedure}\n{times}\n{cards}*NODE PRINT\nU, V, A\n*ENERGY PRINT\n*END STEP\n'
                   for procedure, times, cards in history)


def chain(history, impact='', walls=True):
    """Three masses, the last one before a wall that moves."""
    text = CHAIN.replace('<IMPACT>', impact)
    if not walls:
        text = text.replace(', AMPLITUDE=swing\n2.06', '\n2.06').replace('-1, 0, 0, 0.05\n', '')
    return text + steps(history)


def step_cases():
    yield 'six steps', chain(HISTORY), ALL, 0, {}
    yield 'six steps, restitution', chain(HISTORY, ', RESTITUTION=0.6'), 12, 0, {}
    direct = HISTORY[:5]
    yield 'five steps, penalty', chain(direct, ', METHOD=PENALTY, STIFFNESS=500'), 12, 0, {}
    yield 'five steps, Lagrange', chain(direct, ', METHOD=LAGRANGE'), 12, 0, {}
    yield 'five steps, fictitious force', chain(direct, ', METHOD=FICTITIOUS FORCE, RESTITUTION=0.5'), 12, 0, {}
    yield 'five steps, EVENTS=ANCHOR', chain(direct, ', EVENTS=ANCHOR, RESTITUTION=0.4', False), ALL, 0, {}
    yield 'loads and a support let go at rest', chain(LET_GO), ALL, 0, {}
    deck = blocks(more=PLASTIC, friction=0.4, gap=0.0, speed=(0.0, 0.0))
    upper = [deck.node('top', 12 + k) for k in range(4)]
    static = [('STATIC', '0.02, 1, 1e-6, 0.1', '*BOUNDARY\n' + ''.join(
        f'{node}, 1, 1, {slid}\n{node}, 2, 2, {-depth}\n' for node in upper))
        for depth, slid in ((0.003, 0.0), (0.008, 0.004), (0.004, 0.001))]
    yield 'pressed and released, plastic', ''.join(deck.lines) + steps(static), 8, 0, {}


def cases():
    yield from input_cases()
    yield from changed_cases()
    yield from block_cases()
    yield flying_case()
    yield from step_cases()


def check(checks, program, folder, case):
    name, deck, states, most, definitions = case
    if isinstance(deck, str):
        path = folder / (re.sub(r'\W+', '_', name) + '.inp')
        path.write_text(deck)
        deck = path
    words = [program, str(deck), str(states), str(most), *(f'{key}={value}' for key, value in definitions.items())]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300)
    if WITHOUT_MUMPS in done.stdout:
        checks.true(True, f'{name}: this program has no MUMPS')
        return
    told = done.stdout.strip().splitlines() or ['nothing said']
    checks.true(done.returncode == 0 and told[-1].endswith(' 0 differences'),
                f'{name}: ' + (told[-1] if done.returncode == 0 else done.stdout + done.stderr))


def main():
    checks, folder = Checks(), scratch_folder()
    for case in cases():
        check(checks, str(Path(sys.argv[1]).resolve()), folder, case)
    checks.finish()


if __name__ == '__main__':
    main()
