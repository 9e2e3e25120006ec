"""What happens between steps: supports that go, bodies already pressed, motions that go on, energy
that a static step takes, modes about a plastic state; sums of impulses over skipped rows."""
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from carom_case import Checks, run_deck, scratch_folder

MASSES = """*PARAMETER
h = 0.01
*NODE
1, 0, 0
2, {x}, 0
*ELEMENT, TYPE=MASS, ELSET=masses
1, 1
2, 2
*ELEMENT, TYPE=SPRING1, ELSET=spring
3, {sprung}
*MASS, ELSET=masses
1
*SPRING, ELSET=spring
1
1
"""
GAP = """*ELEMENT, TYPE=GAPUNI, ELSET=stop
6, 1, 2
*SURFACE INTERACTION, NAME=hit
*IMPACT
*GAP, ELSET=stop, INTERACTION=hit
0.1, 1, 0, 0
"""
SQUARE = """*HEADING
A square pulled beyond its yield stress, and its modes then
*NODE
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
*ELEMENT, TYPE=CPE4, ELSET=square
1, 1, 2, 3, 4
*MATERIAL, NAME=metal
*ELASTIC
1000, 0.3
*DENSITY
1
*PLASTIC
10, 0
20, 0.1
*SOLID SECTION, ELSET=square, MATERIAL=metal
1
*BOUNDARY
1, 1, 2
4, 1
2, 2
*STEP
*STATIC
0.1, 1
*CLOAD
2, 1, 10
3, 1, 10
*EL PRINT
PEEQ
*END STEP
*STEP
*FREQUENCY
2
*NODE FILE
U
*EL FILE
S
*END STEP
"""
PRINTS = '*NODE PRINT\nU, V, A\n*CONTACT PRINT\nCF, CDIS\n*ENERGY PRINT\n'


def step(procedure, length, cards='', prints='', first='<h>'):
    return f'*STEP\n*{procedure}\n{first}, {length}\n{cards}{prints}*END STEP\n'


def check_pressed(checks):
    """A node pushed into another one by more than the gap was at the start, step after step."""
    push = '*AMPLITUDE, NAME=push, TIME=TOTAL TIME\n0, 0, 1, 1, 2, 1\n'
    held = '*BOUNDARY, AMPLITUDE=push\n1, 1, 1, 0.5\n'
    deck = (MASSES.format(x=0.5, sprung=2) + GAP + push + held
            + step('DYNAMIC, DIRECT', 1, prints=PRINTS) + step('DYNAMIC, DIRECT', 1))
    run = run_deck(deck)
    gap = run['history/contact_STOP/CDIS']
    checks.at_least(gap.min(), -1e-12, 'pushed over two steps: no overlap')
    checks.at_least(run['history/node_2/U1'].max(), 0.4, 'pushed over two steps: it is pushed')
    checks.true('sound' in run_deck(deck, command='check').text, 'pushed over two steps: check')
    run = run_deck(MASSES.format(x=0.5, sprung=2) + GAP
                   + step('STATIC', 1, '*BOUNDARY\n1, 1, 1, 0.5\n', PRINTS, first=0.25)
                   + step('DYNAMIC, DIRECT', 1))
    t, u = run['history/time'], run['history/node_2/U1']
    force = run['history/contact_STOP/CF1']
    checks.at_most(np.abs(u[t >= 1] - 0.4).max(), 1e-12, 'pressed at rest, then in motion: it stays')
    checks.at_most(np.abs(np.abs(force[t >= 1]) - 0.4).max(), 1e-12, 'and so does the force')


def check_jump(checks):
    """A node that a later step moves at once into another one stops the run where it happens."""
    deck = (MASSES.format(x=0.5, sprung=2) + GAP + '*BOUNDARY\n1, 1\n'
            + step('DYNAMIC, DIRECT', 1, prints=PRINTS)
            + step('DYNAMIC, DIRECT', 1, '*BOUNDARY\n1, 1, 1, 0.5\n'))
    run = run_deck(deck, expect_status=2)
    checks.true('overlaps its contact partner by 0.4' in run.text, 'a jump into a partner')


def check_release(checks):
    """A mass held at 1 and let go: cos t to second order, no momentum missing."""
    errors = []
    for h in (0.04, 0.02, 0.01):
        run = run_deck(MASSES.format(x=5, sprung=1)
                       + '*INITIAL CONDITIONS, TYPE=DISPLACEMENT\n1, 1, 1\n'
                       + step('DYNAMIC, DIRECT', 1, '*BOUNDARY\n1, 1, 1, 1\n2, 1\n', PRINTS)
                       + step('DYNAMIC, DIRECT', 2, '*BOUNDARY, OP=NEW\n2, 1\n'), h=h)
        t, u = run['history/time'], run['history/node_1/U1']
        errors.append(np.max(np.abs(u - np.where(t > 1, np.cos(t - 1), 1))))
        checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-12, 'let go: balance')
    for coarse, fine in zip(errors, errors[1:]):
        checks.at_least(np.log2(coarse/fine), 1.95, 'let go: order of the error')


def check_goes_on(checks):
    """A velocity and an acceleration go on in the next step; OP=NEW in the first step drops what
    the deck holds before the steps."""
    for kind, exact in (('VELOCITY', lambda t: 0.4*t), ('ACCELERATION', lambda t: 0.2*t**2)):
        run = run_deck(MASSES.format(x=5, sprung=2)
                       + step('DYNAMIC, DIRECT', 1, f'*BOUNDARY, TYPE={kind}\n1, 1, 1, 0.4\n', PRINTS)
                       + step('DYNAMIC, DIRECT', 1))
        checks.close(run['history/node_1/U1'], exact(run['history/time']), 1e-12, f'{kind} goes on')
    run = run_deck(MASSES.format(x=5, sprung=1) + '*BOUNDARY\n1, 1\n'
                   + step('DYNAMIC, DIRECT', 1, '*BOUNDARY, OP=NEW\n2, 1\n*CLOAD\n1, 1, 1\n', PRINTS))
    t = run['history/time']
    checks.close(run['history/node_1/U1'], 1 - np.cos(t), 1e-4, 'OP=NEW in the first step')


def check_static_after(checks):
    """A static step stops what moves: its kinetic energy goes out, and is no error."""
    run = run_deck(MASSES.format(x=5, sprung=2) + '*INITIAL CONDITIONS, TYPE=VELOCITY\n1, 1, 1\n'
                   + '*BOUNDARY\n2, 1\n' + step('DYNAMIC, DIRECT', 1, prints=PRINTS)
                   + step('STATIC', 1, '*BOUNDARY\n1, 1, 1, 1\n', first=1))
    checks.close(run['energy/external_work'][-1], -0.5, 1e-12, 'static after motion: work')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-12, 'static after motion: balance')


def check_dropped(checks):
    """What OP=NEW drops in a static step goes down over it, loads and supports alike, and each
    increment's work is known: u = 1 - s, energy (1 - s)^2/2 on a spring of 1."""
    spring = MASSES.format(x=5, sprung=1) + '*AMPLITUDE, NAME=up, TIME=TOTAL TIME\n0, 0, 1, 1\n'
    held = '*BOUNDARY\n2, 1\n'
    again = '*BOUNDARY, OP=NEW\n2, 1\n'
    cases = {'a force': (held, '*CLOAD\n1, 1, 1\n', '*CLOAD, OP=NEW\n'),
             'a force by total time': (held, '*CLOAD, AMPLITUDE=up\n1, 1, 1\n', '*CLOAD, OP=NEW\n'),
             'gravity': (held, '*DLOAD\nmasses, GRAV, 1, 1, 0, 0\n', '*DLOAD, OP=NEW\n'),
             'a support': (held, '*BOUNDARY\n1, 1, 1, 1\n', again),
             'a support by an equation': ('*EQUATION\n2\n2, 1, 1, 1, 1, -1\n',
                                          '*BOUNDARY\n1, 1, 1, 1\n', '*BOUNDARY, OP=NEW\n')}
    for name, (before, push, drop) in cases.items():
        if 'equation' in name:
            text = spring.replace('3, 1\n', '3, 2\n')
        else:
            text = spring
        run = run_deck(text + before + step('STATIC, DIRECT', 1, push, PRINTS, first=0.25)
                       + step('STATIC, DIRECT', 2, drop, PRINTS, first=0.5)
                       + step('STATIC, DIRECT', 1, '', PRINTS, first=0.5))
        t, label = run['history/time'], f'OP=NEW drops {name}'
        left = np.where(t <= 1, t, np.maximum(0, 1 - (t - 1)/2))
        checks.close(run['history/node_1/U1'], left, 1e-12, label + ': displacement')
        checks.close(run['energy/external_work'], left**2/2, 1e-12, label + ': work')
        checks.at_most(np.abs(run['energy/balance_error']).max(), 1e-12, label + ': balance')


def check_replaced(checks):
    """A force that OP=NEW drops and gives anew goes from the old value to the new one; a support
    that is dropped after motion leaves what it held as a load."""
    spring = MASSES.format(x=5, sprung=1) + '*BOUNDARY\n2, 1\n'
    run = run_deck(spring + step('STATIC, DIRECT', 1, '*CLOAD\n1, 1, 1\n', PRINTS, first=0.25)
                   + step('STATIC, DIRECT', 1, '*CLOAD, OP=NEW\n1, 1, 3\n', first=0.25))
    t = run['history/time']
    checks.close(run['history/node_1/U1'], np.where(t <= 1, t, 2*t - 1), 1e-12, 'OP=NEW, a new value')
    checks.at_most(np.abs(run['energy/balance_error']).max(), 1e-12, 'OP=NEW, a new value: balance')
    run = run_deck(spring + step('DYNAMIC, DIRECT', 1, '*BOUNDARY\n1, 1, 1, 1\n', PRINTS)
                   + step('STATIC, DIRECT', 1, '*BOUNDARY, OP=NEW\n2, 1\n', first=0.25))
    t = run['history/time']
    checks.close(run['history/node_1/U1'][t > 1], 2 - t[t > 1], 1e-12, 'a support goes after motion')
    checks.at_most(np.abs(run['energy/balance_error']).max(), 1e-12, 'and its work is known')


def check_unloading(checks):
    """A yielded square whose load OP=NEW drops springs back elastically, increment by increment."""
    load = SQUARE[:SQUARE.index('*STEP')] + (
        '*STEP\n*STATIC, DIRECT\n0.05, 1\n*CLOAD\n2, 1, 10\n3, 1, 10\n*NODE PRINT\nU\n*EL PRINT\n'
        'PEEQ\n*ENERGY PRINT\n*END STEP\n')
    run = run_deck(load + '*STEP\n*STATIC, DIRECT\n0.25, 1\n*CLOAD, OP=NEW\n*END STEP\n')
    t, u, work = (run[name] for name in ('history/time', 'history/node_2/U1', 'energy/external_work'))
    force = np.where(t <= 1, 20*t, 20*(2 - t))
    back = u[t >= 1]
    checks.close(back - back[0], (t[t >= 1] - 1)*(back[-1] - back[0]), 1e-9, 'springs back in proportion')
    checks.close((back[0] - back[-1])*1000/(1 - 0.3**2)/20, 1, 1e-9, 'by its plane strain stiffness')
    peeq = run['history/element_1/PEEQ'][t >= 1]
    checks.close(peeq, peeq[0] + 0*peeq, 1e-12, 'and yields no more')
    trapezoids = np.append(0, np.cumsum(np.diff(u)*(force[1:] + force[:-1])/2))
    checks.close(work, trapezoids, 1e-9, 'with the work of its load')
    checks.at_most(np.abs(run['energy/balance_error']).max(), 1e-6*work.max(), 'and in balance')


def check_resting(checks):
    """What only contact would hold cannot be found at rest; the message says why."""
    run = run_deck('*NODE\n1, 0, 0\n*ELEMENT, TYPE=MASS, ELSET=m\n1, 1\n*MASS, ELSET=m\n2\n'
                   '*SURFACE, NAME=ball, TYPE=NODE\n1\n*RIGID SURFACE, NAME=floor, TYPE=PLANE\n'
                   '0, 0\n0, 1\n*SURFACE INTERACTION, NAME=hit\n*IMPACT\n'
                   '*CONTACT PAIR, INTERACTION=hit\nball, floor\n*BOUNDARY\n1, 1\n1, 3\n'
                   '*STEP\n*STATIC\n1, 1\n*CLOAD\n1, 2, -1\n*END STEP\n', expect_status=4)
    checks.true('singular system: node 1, freedom 2' in run.text
                and 'contact does not hold a body at rest' in run.text, 'at rest on a floor alone')


def check_modes(checks):
    """Modes about a plastic state have the stresses of their shapes, as those of an elastic one."""
    plastic, elastic = run_deck(SQUARE), run_deck(SQUARE.replace('10, 0\n20, 0.1', '1e9, 0\n2e9, 0.1'))
    checks.at_least(plastic['history/element_1/PEEQ'][-1], 1e-3, 'plastic before its modes')
    checks.close(plastic['frequency/eigenvalue'], elastic['frequency/eigenvalue'], 1e-6,
                 'modes about a plastic state')
    for name, scale in (('PointData/U', 1.0), ('CellData/S', 1e3)):
        ours, theirs = (np.abs(run[f'VTKHDF/{name}']) for run in (plastic, elastic))
        checks.close(ours, theirs, 1e-6*scale, f'modes about a plastic state: {name}')


def check_impulses(checks):
    """Impulses add up whatever the rows leave out."""
    sums = []
    for every in (1, 7):
        run = run_deck('*NODE\n1, 0, 0\n*ELEMENT, TYPE=MASS, ELSET=m\n1, 1\n*MASS, ELSET=m\n2\n'
                       '*SURFACE, NAME=ball, TYPE=NODE\n1\n*RIGID SURFACE, NAME=floor, TYPE=PLANE\n'
                       '0, -1\n0, 1\n*SURFACE INTERACTION, NAME=hit\n'
                       '*IMPACT, RESTITUTION=0.8\n*CONTACT PAIR, INTERACTION=hit\nball, floor\n*STEP\n'
                       '*DYNAMIC, DIRECT\n0.01, 5\n*DLOAD\n, GRAV, 10, 0, -1, 0\n*NODE PRINT\nV\n'
                       f'*CONTACT PRINT, FREQUENCY={every}\nCF\n*END STEP\n')
        sums.append(run['history/contact_BALL-FLOOR/impulse'].sum())
        momentum = 2*run['history/node_1/V2'][-1] + 2*10*5
        checks.close(sums[-1], momentum, 1e-9, f'impulse by rows of every {every}. increment')


def check_kept(checks):
    """Stopped between a static step and the modes, nothing recorded yet: it can go on."""
    program, folder = str(Path(sys.argv[1]).resolve()), scratch_folder()
    deck = folder / 'two words.inp'
    deck.write_text('*NODE\n1, 0, 0\n2, 1, 0\n*ELEMENT, TYPE=T2D2, ELSET=b\n1, 1, 2\n*MATERIAL, NAME=s\n'
                    '*ELASTIC\n1\n*DENSITY\n1\n*SOLID SECTION, ELSET=b, MATERIAL=s\n1\n*BOUNDARY\n1, 1\n'
                    '*STEP\n*STATIC\n0.1, 1\n*CLOAD\n2, 1, 1\n*END STEP\n'
                    '*STEP\n*FREQUENCY\n1\n*NODE FILE\nU\n*END STEP\n')
    deck.with_suffix('.stop').touch()
    done = subprocess.run([program, 'run', deck], capture_output=True, text=True, cwd=folder)
    command = [line for line in done.stderr.splitlines() if 'to go on: ' in line]
    checks.true(done.returncode == 5 and len(command) == 1, f'stopped before the modes: {command}')
    done = subprocess.run(command[0].split('to go on: carom ')[1].join(['"$CAROM" ', '']), shell=True,
                          capture_output=True, text=True, cwd=folder,
                          env={**os.environ, 'CAROM': program})
    checks.true(done.returncode == 0 and 'mode ' in done.stdout,
                f'the command that it names goes on: {done.stderr}')


def check_tolerance(checks):
    """A step with TOLERANCE cannot be made longer; another one may follow."""
    program, folder = str(Path(sys.argv[1]).resolve()), scratch_folder()
    deck = folder / 'deck.inp'

    def run(*words):
        return subprocess.run([program, 'run', deck, *words], capture_output=True, text=True)

    text = (MASSES.format(x=5, sprung=1) + '*BOUNDARY\n2, 1\n'
            + '*INITIAL CONDITIONS, TYPE=DISPLACEMENT\n1, 1, 1\n'
            + step('DYNAMIC, TOLERANCE=1e-3', '{end}', prints=PRINTS + '*RESTART, WRITE\n'))
    deck.write_text(text.format(end=1))
    run()
    deck.write_text(text.format(end=20))
    done = run('--restart', folder / 'deck.h5')
    checks.true(done.returncode == 2 and 'cannot last longer' in done.stderr, 'longer with TOLERANCE')
    deck.write_text(text.format(end=1) + step('DYNAMIC, TOLERANCE=1e-3', 19))
    done = run('--restart', folder / 'deck.h5')
    checks.true(done.returncode == 0, f'one more step with TOLERANCE: {done.stderr}')


def main():
    checks = Checks()
    for check in (check_pressed, check_jump, check_release, check_goes_on, check_static_after,
                  check_dropped, check_replaced, check_unloading, check_resting, check_modes, check_impulses, check_kept, check_tolerance):
        check(checks)
    checks.finish()


main()
