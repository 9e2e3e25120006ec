"""CalculiX: the block of input/block against a wall, surface contact by penalty, implicit.

Initial velocities of plane elements have no effect there: a first step of one increment drives the
block up to its speed, at constant acceleration, and lets it go. In contact CalculiX's rules of impact
cut the increments as they see fit: what counts is the time of an increment, tried in vain or not.
"""
import os
import shutil
import subprocess
import sys

import peer

GAP = 1.0           # steps' way to the wall, half of one spent on the way to full speed


def deck(n, steps):
    """The problem in CalculiX's words; the wall is one element that is held."""
    from make_block import SPEED
    x, elements, face, dt = peer.block(n)
    sides = [e + 1 for e, ring in enumerate(elements) if ring[0] in face and ring[3] in face]
    first, wall = len(x) + 1, -GAP * SPEED * dt
    corners = [(wall - 1, -1), (wall, -1), (wall, 2), (wall - 1, 2)]
    text = '*NODE, NSET=block\n'
    text += ''.join(f'{i}, {p[0]:.12g}, {p[1]:.12g}, 0\n' for i, p in enumerate(x, 1))
    text += '*NODE, NSET=wall\n'
    text += ''.join(f'{first + i}, {p[0]:.12g}, {p[1]}, 0\n' for i, p in enumerate(corners))
    text += '*ELEMENT, TYPE=CPE8, ELSET=block\n'
    text += ''.join(f'{e}, ' + ', '.join(str(k + 1) for k in ring) + '\n'
                    for e, ring in enumerate(elements, 1))
    last = len(elements) + 1
    text += f'*ELEMENT, TYPE=CPE4, ELSET=anvil\n{last}, {first}, {first + 1}, {first + 2}, {first + 3}\n'
    text += '*SURFACE, NAME=front, TYPE=ELEMENT\n' + ''.join(f'{e}, S4\n' for e in sides)
    text += f'*SURFACE, NAME=anvil_face, TYPE=ELEMENT\n{last}, S2\n'
    return text + cards(n, dt, steps)


def cards(n, dt, steps):
    """All but the mesh. Without steps there is only the one that drives the block up to its speed."""
    from make_block import DENSITY, MODULUS, POISSON, SPEED
    text = f'''*MATERIAL, NAME=elastic
*ELASTIC
{MODULUS}, {POISSON}
*DENSITY
{DENSITY}
*SOLID SECTION, ELSET=block, MATERIAL=elastic
1
*SOLID SECTION, ELSET=anvil, MATERIAL=elastic
1
*BOUNDARY
wall, 1, 2
*SURFACE INTERACTION, NAME=touch
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{50 * MODULUS * n}, 1e-9
*CONTACT PAIR, INTERACTION=touch, TYPE=SURFACE TO SURFACE
front, anvil_face
*AMPLITUDE, NAME=start
0, 0, {dt:.12e}, {-0.5 * SPEED * dt:.12e}
*STEP, INC=10
*DYNAMIC, DIRECT
{dt:.12e}, {dt:.12e}
*BOUNDARY, AMPLITUDE=start
block, 1, 1, 1
*END STEP
'''
    if steps > 0:
        text += f'''*STEP, INC={steps}
*DYNAMIC
{dt:.12e}, {1000 * dt:.12e}, {1e-4 * dt:.12e}, {dt:.12e}
*BOUNDARY, OP=NEW
wall, 1, 2
*END STEP
'''
    return text


def run(n, steps, folder):
    """Seconds of a run, and the increments it has tried."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / 'block.inp').write_text(deck(n, steps))
    watch = peer.Clock()
    done = subprocess.run(['ccx', '-i', 'block'], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, 'OMP_NUM_THREADS': '1'})
    seconds = watch()
    rows = [line.split() for line in (folder / 'block.sta').read_text().splitlines()[2:]]
    rows = [row for row in rows if row and row[0] == '2']
    if sum(not row[2].endswith('U') for row in rows) < steps:
        sys.exit('ccx: ' + next((line for line in done.stdout.splitlines() if 'ERROR' in line),
                                f'status {done.returncode}'))
    return seconds, len(rows)


def main():
    given = peer.arguments()
    if shutil.which('ccx') is None:
        print('no ccx', file=sys.stderr)
        sys.exit(peer.NOT_INSTALLED)
    version = subprocess.run(['ccx', '-v'], capture_output=True, text=True).stdout
    peer.figure('version', 'CalculiX ' + version.split()[-1])
    folder = given.work / 'calculix'
    short = run(given.side or 40, 0, folder)
    long = run(given.side or 40, 1 if given.quick else 8, folder)
    peer.figure('step_ms', 1e3 * (long[0] - short[0]) / (long[1] - short[1]))
    peer.figure('increments', long[1])


main()
