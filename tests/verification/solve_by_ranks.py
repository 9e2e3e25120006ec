"""One, two and three processes find the same motion, with one log and one result; an error of the
first ends all of them with its status.

    python3 solve_by_ranks.py PATH_TO_CAROM MPIRUN
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from carom_case import INPUT, Checks, Run, run_deck
from verify_solvers import ROUND_OFF, block, difference, with_solver

DECKS = {'dropped_disc/q8.inp': ['dt=0.01', 'end=0.5'], 'bar/bar_mixed.inp': []}


def run_ranks(text, n_ranks, definitions=()):
    """Runs a deck by several processes, more than there are processors if need be."""
    folder = Path(tempfile.mkdtemp(prefix='carom_'))
    (folder / 'deck.inp').write_text(text)
    words = [sys.argv[2], '-n', str(n_ranks), str(Path(sys.argv[1]).resolve()), 'run',
             str(folder / 'deck.inp')]
    for definition in definitions:
        words += ['--define', definition]
    allowed = {'OMPI_ALLOW_RUN_AS_ROOT': '1', 'OMPI_ALLOW_RUN_AS_ROOT_CONFIRM': '1',
               'OMPI_MCA_rmaps_base_oversubscribe': '1', 'OPENBLAS_NUM_THREADS': '1'}
    done = subprocess.run(words, capture_output=True, text=True, timeout=300,
                          env={**os.environ, **allowed})
    return Run(done.returncode, done.stdout + done.stderr, folder / 'deck.h5')


def main():
    checks = Checks()
    for deck, definitions in DECKS.items():
        text = with_solver((INPUT / deck).read_text(), (INPUT / deck).parent, 'MUMPS')
        alone = run_deck(text, **dict(pair.split('=') for pair in definitions))
        for n_ranks in (1, 2, 3):
            run = run_ranks(text, n_ranks, definitions)
            checks.true(run.status == 0, f'{deck}: {n_ranks} ranks end well')
            checks.true(run.text.count('completed') == 1, 'one of them writes the log')
            checks.at_most(difference(alone, run), ROUND_OFF, 'they differ from a run alone by')
    loose = run_ranks(block(4, 'STATIC, DIRECT, SOLVER=MUMPS', loose=True), 2)
    checks.true(loose.status == 4, 'a singular system ends all ranks with status 4')
    checks.true(loose.text.count('error: singular system: node') == 1, 'and is reported once')
    faulty = run_ranks('*NODE\n1, x\n', 3)
    checks.true(faulty.status == 2, 'a faulty deck ends all ranks with status 2')
    checks.finish()


main()
