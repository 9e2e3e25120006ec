"""Two runs of one deck give the same bytes, whatever the threads, the memory and the place they run in.

Every deck of `input/` is run twice, and one of every feature that those do not use. The second run has another number of threads, another working
directory with a relative path to the deck, a longer environment (which moves the stack, as the random
addresses of every process do), and memory that is filled with a pattern when it is taken and given back
(MALLOC_PERTURB_ of the C library), so that a number read before it was set does not stay 0.
"""
import os
import subprocess
import sys
from pathlib import Path

from carom_case import INPUT, Checks, scratch_folder
from feature_decks import write_decks
from same_results import differences

# Decks that would take seconds: they end sooner, after their first impacts
SHORTER = {'block/block': 0.0075, 'pounding_frame/frames': 0.15, 'crack/slap': 1.0,
           'crack/slap_fictitious': 1.0, 'two_discs/equal': 0.2, 'two_discs/oblique': 0.4}


def run(deck, result, folder, threads, **environment):
    """Runs a deck, named as seen from a folder; its messages if it fails."""
    end = SHORTER.get(f'{deck.parent.name}/{deck.stem}')
    words = [Path(sys.argv[1]).resolve(), 'run', os.path.relpath(deck, folder), '-o', result,
             '--quiet', '--threads', str(threads)]
    words += ['--define', f'end={end}'] if end else []
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=600,
                          env={**os.environ, 'OPENBLAS_NUM_THREADS': '1', **environment})
    return '' if done.returncode == 0 else f'status {done.returncode}: {done.stdout}{done.stderr}'


def check_deck(checks, name, deck):
    """Runs a deck twice and compares every byte of the results but how long things took."""
    folder = scratch_folder()
    (folder / 'one').mkdir()
    (folder / 'another').mkdir()
    one, other = folder / 'one' / 'result.h5', folder / 'another' / 'result.h5'
    wrong = run(deck, one, deck.parent, 1)
    wrong = wrong or run(deck, other, folder / 'another', 2, MALLOC_PERTURB_='165', LONG='x' * 5000)
    unlike = [wrong] if wrong else differences(one, other)
    checks.true(not unlike, f'{name}: the same bytes' + ''.join(
        f'\n        {line}' for line in unlike[:10]))


checks = Checks()
decks = sorted(INPUT.glob('*/*.inp'))
checks.at_least(len(decks), 40, 'decks')
for deck in decks:
    check_deck(checks, deck.relative_to(INPUT), deck)
for feature, deck in write_decks(scratch_folder()):
    check_deck(checks, feature, deck)
checks.finish()
