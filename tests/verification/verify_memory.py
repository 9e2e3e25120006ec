"""`check` states the memory that a run takes: within 10 % of the largest resident size."""
import os
import re
import subprocess
import sys

from carom_case import INPUT, Checks, scratch_folder

ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1')


def rectangle(n, kind, procedure, requests):
    """A square of n x n plane strain elements of 4 or 8 nodes, held at its left side."""
    step = 2 if kind == 'CPE8' else 1
    across = step * n + 1

    def node(i, j):
        return j * across + i + 1

    lines = ['*NODE']
    lines += [f'{node(i, j)}, {i / (step * n):.12g}, {j / (step * n):.12g}'
              for j in range(across) for i in range(across) if step == 1 or not (i % 2 and j % 2)]
    lines += [f'*ELEMENT, TYPE={kind}, ELSET=body']
    places = [(0, 0), (step, 0), (step, step), (0, step)]
    if step == 2:
        places += [(1, 0), (2, 1), (1, 2), (0, 1)]
    for e in range(n * n):
        i, j = step * (e % n), step * (e // n)
        nodes = ', '.join(str(node(i + a, j + b)) for a, b in places)
        lines.append(f'{e + 1}, {nodes}')
    lines += ['*NSET, NSET=left'] + [str(node(0, j)) for j in range(across)]
    lines += ['*MATERIAL, NAME=m', '*ELASTIC', '1, 0.3', '*DENSITY', '1',
              '*SOLID SECTION, ELSET=body, MATERIAL=m', '1', '*BOUNDARY', 'left, 1, 2',
              '*INITIAL CONDITIONS, TYPE=VELOCITY', f'{node(across - 1, 0)}, 1, 0.01',
              '*STEP', procedure, f'{0.4 / n}, {4.0 / n}', *requests, '*END STEP']
    return '\n'.join(lines) + '\n'


def stated(deck):
    """Bytes that `check` foresees."""
    text = subprocess.run([sys.argv[1], 'check', deck], capture_output=True, text=True, check=True,
                          env=ENVIRONMENT).stdout
    return 1e6 * float(re.search(r'^memory: (\S+) MB', text, re.M).group(1))


# A process starts with the size of that which made it as its largest: a small one makes the run.
SMALL_PARENT = """
import os, subprocess, sys
_, status, usage = os.wait4(subprocess.Popen(sys.argv[1:]).pid, 0)
print(usage.ru_maxrss, status)
"""


def taken(deck, folder):
    """The largest resident size of a run in bytes, and how it ended."""
    words = [sys.argv[1], 'run', deck, '-o', folder / 'out.h5', '--quiet', '--overwrite']
    text = subprocess.run([sys.executable, '-c', SMALL_PARENT, *words], capture_output=True,
                          text=True, check=True, env=ENVIRONMENT).stdout
    kilobytes, status = text.split()
    return 1024.0 * float(kilobytes), int(status)


def main():
    checks = Checks()
    folder = scratch_folder()
    frames = ['*NODE FILE, FREQUENCY=5', 'U, V']
    decks = {
        '90000 explicit elements': rectangle(300, 'CPE4', '*DYNAMIC, DIRECT, EXPLICIT',
                                             [*frames, '*EL FILE, FREQUENCY=5', 'S']),
        '22500 explicit elements to a TOLERANCE': rectangle(
            150, 'CPE4', '*DYNAMIC, TOLERANCE=1e-2', frames).replace(
                '*STEP', '*ELEMENT GROUP, ELSET=body, SCHEME=EXPLICIT\n*STEP'),
        'skyline of 60000 equations': rectangle(
            100, 'CPE8', '*DYNAMIC, DIRECT, SOLVER=SKYLINE', frames)}
    for name, text in decks.items():
        deck = folder / 'memory.inp'
        deck.write_text(text)
        truth, status = taken(deck, folder)
        checks.true(status == 0, f'{name}: runs')
        checks.close(stated(deck) / truth, 1.0, 0.1, f'{name}: stated memory over that taken')
    deck = INPUT / 'block' / 'block.inp'
    truth, status = taken(deck, folder)
    checks.true(status == 0, 'block with contact: runs')
    checks.close(stated(deck) / truth, 1.0, 0.1, 'block with contact: stated memory over that taken')
    checks.finish()


main()
