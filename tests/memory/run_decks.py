"""Runs the program on small decks of all its features, in a build with sanitizers or under valgrind.

    python3 run_decks.py PATH_TO_CAROM [--valgrind VALGRIND OPTION...]

A finding of either ends the program with status 99, which no run may end with; each must end as it should.
Decks of `input/` come with other parameters; of `deck_errors/` some fail in every reader; the command line
has its ways out too. Everything after --valgrind is put before the program.
"""
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
INPUT = TESTS.parent / 'input'
sys.path.insert(0, str(TESTS / 'verification'))
from feature_decks import write_decks   # noqa: E402  (from verification)

FOUND = 99
ENVIRONMENT = {**os.environ, 'OPENBLAS_NUM_THREADS': '1',
               'ASAN_OPTIONS': f'exitcode={FOUND}:detect_leaks=1',
               'UBSAN_OPTIONS': f'exitcode={FOUND}:print_stacktrace=1'}
# Every which of the wrong decks is run
STRIDE = 8

def featured_decks(folder):
    """(feature, words of the command line, status) of every feature; its deck is written."""
    for feature, path in write_decks(folder):
        yield feature, ['run', str(path), '--quiet', '--threads', '2'], 0
    yield 'check', ['check', str(INPUT / 'pounding_frame' / 'frames.inp')], 0


def wrong_decks():
    """Wrong decks of all readers, with the status that each expects."""
    for path in sorted((TESTS / 'deck_errors').glob('*.inp'))[::STRIDE]:
        status = [line.split(':')[1] for line in path.read_text(errors='replace').splitlines()
                  if line.replace(' ', '').startswith('**expect-status:')]
        yield path.stem, ['run', str(path)], int(status[0]) if status else 2


def command_lines(folder):
    """Ways out of the command line, and a file that cannot be written."""
    deck = str(INPUT / 'sdof' / 'sdof.inp')
    yield 'help', ['--help'], 0
    yield 'version', ['--version'], 0
    yield 'help on a card', ['help', '*CONTACT PAIR'], 0
    yield 'help on nothing', ['help', 'kontact pear'], 1
    yield 'unknown option', ['run', deck, '--fast'], 1
    yield 'no deck', ['run', str(folder / 'none.inp')], 3
    for path in (deck, str(folder / 'sparse_solver.inp')):
        yield 'no folder', ['run', path, '-o', str(folder / 'none' / 'result.h5')], 3


def main():
    """Runs all; says what ended otherwise than it should."""
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    before = sys.argv[3:] if sys.argv[2:3] == ['--valgrind'] else []
    words = [*before, str(Path(sys.argv[1]).resolve())]
    folder = Path(tempfile.mkdtemp(prefix='carom_memory_'))
    runs = failed = 0
    try:
        for name, more, status in [*featured_decks(folder), *wrong_decks(), *command_lines(folder)]:
            done = subprocess.run([*words, *more], cwd=folder, capture_output=True, text=True,
                                  errors='replace', timeout=900, env=ENVIRONMENT)
            runs += 1
            if done.returncode != status:
                failed += 1
                print(f'FAILED {name}: ended with {done.returncode}, not {status}\n'
                      + (done.stdout + done.stderr)[-6000:])
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print(f'{runs} runs, {failed} failed')
    sys.exit(1 if failed or not runs else 0)


if __name__ == '__main__':
    main()
