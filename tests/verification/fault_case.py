"""Runs in folders of their own that meet with faults: what verify_faults_*.py share.

A `Place` is a folder with a deck; `start` begins a run there, `Started.finish` waits for its end. The
checks `refused` and `saved` look at status, message, what is left and what can be read.
"""
import ctypes
import os
import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np

from background_run import processor_time
from carom_case import INPUT, scratch_folder, whole

PROGRAM = str(Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else ''
SDOF = (INPUT / 'sdof/sdof.inp').read_text()
CRASHED = re.compile(r'HDF5-DIAG|[Bb]acktrace|Segmentation|runtime error|signal|core dumped|'
                     r'corrupt|free\(\)')
LIMIT = 240.0      # seconds: a run that takes longer hangs
PUBLISHED = 5.3    # seconds of a run after which it has published for the first time


def endless(every=1):
    """A deck whose run takes hours; a row in so many increments."""
    text = SDOF.replace('dt = 0.04', 'dt = 1e-4').replace('end = 20', 'end = 2e4')
    for card in ('NODE PRINT', 'CONTACT PRINT', 'ENERGY PRINT'):
        text = text.replace(f'*{card}', f'*{card}, FREQUENCY={every}')
    return text.replace('*NODE FILE', f'*NODE FILE, FREQUENCY={100*every}')


def limited(size):
    """For `start`: files of the run may have so many bytes."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def without_privileges():
    """For `start`: modes of files hold for root, too."""
    if os.geteuid() == 0:
        libc = ctypes.CDLL(None, use_errno=True)
        for capability in (1, 2):      # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH
            if libc.prctl(24, capability, 0, 0, 0) != 0:      # PR_CAPBSET_DROP
                raise OSError(ctypes.get_errno(), 'prctl')


class Started:
    """A run that goes on."""

    def __init__(self, place, words, prepare, env=None, **streams):
        streams = {'stdout': subprocess.PIPE, 'stderr': subprocess.PIPE, **streams}
        self.place = place
        self.process = subprocess.Popen(
            [PROGRAM, *words], cwd=place.folder, stdin=subprocess.DEVNULL, text=True,
            errors='replace', preexec_fn=prepare,
            env={**os.environ, 'OMP_NUM_THREADS': '1', 'OPENBLAS_NUM_THREADS': '1', **(env or {})},
            **streams)
        self.began = time.monotonic()
        self.status, self.text = None, ''

    def wait_for(self, path, seconds=LIMIT):
        """Until there is such a file; False if the run ends or time is up before."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if Path(self.place.folder, path).exists():
                return True
            if self.process.poll() is not None:
                return False
            time.sleep(0.005)
        return False

    def until_it_computes(self, seconds):
        """Waits until the run has taken so much time of the processor, or has ended."""
        while self.process.poll() is None and processor_time(self.process.pid) < seconds:
            time.sleep(0.005)

    def halt(self):
        """Holds the run for a while: its clock goes on."""
        self.process.send_signal(signal.SIGSTOP)

    def go_on(self):
        self.process.send_signal(signal.SIGCONT)

    def until(self, seconds):
        """Waits until the run is so old."""
        time.sleep(max(0.0, self.began + seconds - time.monotonic()))

    def kill(self):
        self.process.kill()
        self.process.wait()

    def finish(self):
        """Its status; 'hangs' if it does not end."""
        try:
            output, errors = self.process.communicate(timeout=LIMIT)
            self.status = self.process.returncode
        except subprocess.TimeoutExpired:
            self.process.kill()
            output, errors = self.process.communicate()
            self.status = 'hangs'
        self.text = (output or '') + (errors or '')
        return self


class Place:
    """A folder with a deck in it, deck.inp unless it is named otherwise."""

    def __init__(self, deck=SDOF, name='deck.inp', folder=None):
        self.folder = folder or scratch_folder()
        self.deck = name
        (self.folder / name).write_text(deck)

    def start(self, *options, deck=None, prepare=None, **streams):
        """Begins a run; results go to deck.h5 unless the options say otherwise."""
        return Started(self, ['run', deck or self.deck, '--quiet', *options], prepare, **streams)

    def run(self, *options, **more):
        """A whole run."""
        return self.start(*options, **more).finish()

    def names(self):
        """The files there, sorted."""
        return sorted(path.name for path in self.folder.iterdir())

    def read(self, name='deck.h5'):
        return (self.folder / name).read_bytes()


def said(checks, run, status, words, what):
    """The run ended with a status, said certain words, and did not crash on the way."""
    text = ' '.join(run.text.split())
    good = run.status == status and all(word in text for word in words)
    checks.true(good and not CRASHED.search(run.text),
                f'{what}: status {run.status}, {text[:200] or "no message"}'
                + ('' if good else f' (expected status {status} and {words})'))


def refused(checks, run, words, left, what, status=3):
    """A run that ends before it has made anything: `left` are the names in its folder."""
    said(checks, run, status, [*words, 'cure:'] if status == 3 else words, what)
    names = run.place.names()
    checks.true(names == sorted(left), f'{what}: there is nothing new: {names}')


def rows_of(path):
    """Rows of the histories, the energies and frames; their columns are of one length each."""
    with h5py.File(path, 'r') as file:
        counts = []
        for group in ('history', 'energy'):
            sizes = set()
            file[group].visititems(lambda name, item: sizes.add(len(item))
                                   if isinstance(item, h5py.Dataset) else None)
            counts.append(sizes.pop() if len(sizes) == 1 else -1)
        frames = int(file['VTKHDF/Steps'].attrs['NSteps'])
        lists = {len(file[f'VTKHDF/Steps/{name}']) for name in ('Values', 'PartOffsets')}
        points = len(file['VTKHDF/Points'])
        u = whole(file, 'VTKHDF/PointData/U')
        sound = lists == {frames} and len(u) == frames*points and np.isfinite(u).all()
        return counts[0], counts[1], frames if sound else -1


def vtk_reads(path):
    """Whether vtkHDFReader finds in all frames what h5py finds."""
    script = Path(__file__).with_name('read_with_vtk.py')
    done = subprocess.run([sys.executable, str(script), str(path)], capture_output=True, text=True,
                          check=False)
    return done.returncode == 0


def saved(checks, place, at_least, what, vtk=False, name='deck.h5', beside=()):
    """The results can be read, with so many rows and frames at least; nothing else is left."""
    rows = rows_of(place.folder / name) if (place.folder / name).exists() else (0, 0, 0)
    checks.true(all(found >= wanted for found, wanted in zip(rows, at_least)),
                f'{what}: rows of history and energy and frames that can be read: {rows} '
                f'(at least {at_least})')
    if vtk:
        checks.true(vtk_reads(place.folder / name), f'{what}: vtkHDFReader reads all frames')
    stem = name.removesuffix('.h5')
    expected = sorted({name, f'{stem}.log', f'{stem}.sta', place.deck, *beside})
    checks.true(place.names() == expected, f'{what}: files that are left: {place.names()}')
