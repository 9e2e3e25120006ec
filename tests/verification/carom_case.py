"""Runs decks and compares figures: what every verification script shares.

A script makes one `Checks` object, calls its `at_most`, `close`, `true` with a sentence each, and
ends with `checks.finish()`, which prints a line a check and exits 1 if one failed.
"""
import atexit
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
INPUT = ROOT / 'input'
sys.path.insert(0, str(ROOT / 'scripts'))
from carom_frames import all_frames


def whole(file, name):
    """A dataset as an array; a field 'VTKHDF/PointData/U' as the rows of all its frames."""
    group, _, field = name.strip('/').rpartition('/')
    if group not in ('VTKHDF/PointData', 'VTKHDF/CellData'):
        return np.asarray(file[name])
    frames = all_frames(file['VTKHDF'], group[7:-4], field)
    return frames.reshape(-1, *frames.shape[2:])


class Run:
    """A finished run: exit status, output text, and the result file if there is one."""

    def __init__(self, status, text, path):
        self.status, self.text, self.path = status, text, path
        self.file = h5py.File(path, 'r') if path.exists() else None

    def __getitem__(self, name):
        """A dataset as an array: 'history/node_1/U1', 'energy/total'; of fields all frames, one
        behind the other."""
        return whole(self.file, name)

    def events(self, kind='impact'):
        """The rows of /events of one kind as a dictionary of arrays."""
        kinds = np.array([text.decode() for text in self['events/kind']], dtype=object)
        return {name: np.asarray(data)[kinds == kind]
                for name, data in self.file['events'].items()}


def scratch_folder():
    """A new folder that goes when the script ends."""
    folder = Path(tempfile.mkdtemp(prefix='carom_'))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def run_deck(deck, command='run', expect_status=0, **definitions):
    """Runs `carom` (given as the first argument of the script) on a deck: a path, or the text of one."""
    folder = scratch_folder()
    if '\n' in str(deck):
        path = folder / 'deck.inp'
        path.write_text(deck)
    else:
        path = Path(deck)
    result = folder / 'result.h5'
    words = [str(Path(sys.argv[1]).resolve()), command, str(path)]
    if command == 'run':
        words += ['-o', str(result), '--quiet']
    for name, value in definitions.items():
        words += ['--define', f'{name}={float(value)!r}' if isinstance(value, float)
                  else f'{name}={value}']
    done = subprocess.run(words, capture_output=True, text=True, timeout=600,
                          env={**os.environ, 'OPENBLAS_NUM_THREADS': '1'})
    if done.returncode != expect_status:
        sys.exit(f'FAILED: {" ".join(words)} ended with {done.returncode}, not {expect_status}:\n'
                 + done.stdout + done.stderr)
    return Run(done.returncode, done.stdout + done.stderr, result)


class Checks:
    """Collects what was checked; in the end each check prints its figure, the failed ones first."""

    def __init__(self):
        self.lines = {True: [], False: []}
        atexit.register(self._print)

    def _say(self, good, sentence):
        self.lines[bool(good)].append(('ok      ' if good else 'FAILED  ') + sentence)

    def _print(self):
        failed, passed = self.lines[False], self.lines[True]
        print('\n'.join([*failed, *passed,
                         f'{len(passed)} of {len(passed) + len(failed)} checks passed']))

    def at_most(self, value, limit, sentence):
        """value <= limit; NaN fails."""
        self._say(bool(value <= limit), f'{sentence}: {value:.6g} <= {limit:.6g}')

    def at_least(self, value, limit, sentence):
        """value >= limit; NaN fails."""
        self._say(bool(value >= limit), f'{sentence}: {value:.6g} >= {limit:.6g}')

    def close(self, value, expected, tolerance, sentence):
        """|value - expected| <= tolerance (absolute), for numbers and arrays of one shape."""
        value, expected = np.atleast_1d(value), np.atleast_1d(expected)
        if value.shape != expected.shape:
            self._say(False, f'{sentence}: {value.shape} values instead of {expected.shape}')
            return
        if not value.size:
            self._say(False, f'{sentence}: no values to compare')
            return
        error = float(np.max(np.abs(value - expected)))
        self._say(error <= tolerance, f'{sentence}: off by {error:.3g} <= {tolerance:.3g}')

    def true(self, condition, sentence):
        """The condition holds."""
        self._say(bool(condition), sentence)

    def skip(self, sentence, installed=False):
        """Says what cannot be checked on this machine. Where .ci/run, which sets CAROM_CI, installs what it
        takes, that is a failure there."""
        if installed and os.environ.get('CAROM_CI'):
            self._say(False, f'not checked: {sentence}')
        else:
            print(f'skipped: {sentence}')

    def finish(self):
        """Ends the script: status 1 if a check failed or none was made."""
        sys.exit(0 if self.lines[True] and not self.lines[False] else 1)
