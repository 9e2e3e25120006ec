"""Runs of the program in the background, for scripts that stop or kill them."""
import contextlib
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
PROGRAM = str(Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else ''


def default_signals():
    """In the child: signals act as they do in a shell, whatever started this script."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)


def ignore_hang_up():
    """In the child: as `nohup` starts it."""
    default_signals()
    signal.signal(signal.SIGHUP, signal.SIG_IGN)


def processor_time(process):
    """Seconds that a process has computed so far: unlike the time elapsed they do not depend on
    what else the machine does."""
    try:
        fields = Path(f'/proc/{process}/stat').read_text().rpartition(')')[2].split()
    except OSError:
        return float('inf')
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


class Job:
    """A run of the program in the background. It has one thread, so that its processor time says how
    far it is."""

    def __init__(self, deck, result, *options, prepare=default_signals):
        self.deck, self.result = Path(deck), Path(result)
        self.log = self.result.with_suffix('.log')
        self.part = Path(f'{result}.part')
        self.status, self.heard = None, ''
        self.began = time.perf_counter()
        self.process = subprocess.Popen(
            [PROGRAM, 'run', str(deck), '-o', str(result), '--quiet', *options], text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=prepare,
            env={**os.environ, 'OMP_NUM_THREADS': '1', 'OPENBLAS_NUM_THREADS': '1'})

    def until_it_computes(self, seconds=0.0):
        """Waits until the run has begun its results and taken so much time of the processor."""
        while self.process.poll() is None and not (
                self.part.exists() and processor_time(self.process.pid) >= seconds):
            time.sleep(0.002)
        return self

    def send(self, number):
        """A signal, unless the run is over already."""
        with contextlib.suppress(ProcessLookupError):
            self.process.send_signal(number)
        return self

    def until_it_says(self, words):
        """Waits until the run has said something on the terminal, or has ended."""
        while words not in self.heard:
            piece = os.read(self.process.stderr.fileno(), 4096)
            if not piece:
                break
            self.heard += piece.decode()
        return self

    def kill(self):
        """Ends the run at once, by SIGKILL."""
        self.process.kill()
        return self.end()

    def end(self):
        """Waits for the end; from here on there are a status, an output and times."""
        if self.status is not None:
            return self
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.output, self.errors = self.process.communicate(timeout=300)
        self.errors = self.heard + self.errors
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        self.seconds = time.perf_counter() - self.began
        self.status = self.process.returncode
        lines = (self.log.read_text() if self.log.exists() else '').splitlines() or ['']
        self.said, self.last_line = '\n'.join(lines), lines[-1]
        return self


def read_all(path):
    """Every dataset of a result file."""
    found = {}
    with h5py.File(path, 'r') as file:
        file.visititems(lambda name, item: found.update({name: item[()]})
                        if isinstance(item, h5py.Dataset) else None)
    return found
