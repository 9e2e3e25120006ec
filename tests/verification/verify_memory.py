"""`check` states the memory that a run takes: within 10 % of the largest resident size."""
import os
import re
import subprocess
import sys

from carom_case import INPUT, Checks, scratch_folder
from square_deck import rectangle

ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1')


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
            100, 'CPE8', '*DYNAMIC, DIRECT, SOLVER=SKYLINE', frames),
        '20 modes of 7000 equations': rectangle(60, 'CPE4', '', []).split('*STEP')[0]
        + '*STEP\n*FREQUENCY\n20\n*NODE FILE\nU\n*END STEP\n'}
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
