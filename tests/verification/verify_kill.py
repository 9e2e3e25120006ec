"""Nothing is lost when a run is killed: kill -9 at random moments, restart, the same results.

    verify_kill.py CAROM [--kills N] [--seed S] [--case NAME]...

Each case keeps a state every few increments. A run is killed at a random moment; what it has left is
read by h5py and by vtkHDFReader; the run is taken up again from its last state (from the start, where
there is none yet), perhaps killed again, and so on. In the end all bits of the results are those of
a run that was not killed, but for the times it took. Moments: uniformly over the time of the run;
some are aimed at the start, at a publication of the results and at the end. Other runs fail to write
beyond a random size of their files.
"""
import argparse
import random
import resource
import signal
import time
from collections import Counter

from background_run import Job, default_signals, processor_time, read_all
from carom_case import Checks, scratch_folder
from read_with_vtk import check as check_with_vtk
from restart_cases import write_case
from same_results import differences

# the increments between two states of each case
CASES = {'wall': 500, 'bar': 100, 'plastic': 3, 'friction': 20, 'tolerance': 200, 'explicit': 500}
AIMS = ('uniform', 'uniform', 'uniform', 'start', 'publication', 'end')
KILL_AGAIN = 0.4         # the chance that a run taken up again is killed too
LENGTH = 0.25            # of the runs: a quarter of a second
FILE_ERROR = 3


def has_state(path):
    """Whether there is a result file with a state to go on from."""
    return path.exists() and 'restart/index/entries' in read_all(path)


class Victim:
    """A case, the results of its whole run, and what has been done to its other runs."""

    def __init__(self, checks, name, random_numbers):
        self.checks, self.name, self.random = checks, name, random_numbers
        self.folder = scratch_folder()
        self.deck = write_case(name, self.folder / f'{name}.inp', CASES[name], LENGTH)
        self.part, self.next = self.folder / 'part.h5', self.folder / 'part.h5.next'
        job = Job(self.deck, self.folder / 'full.h5').end()
        self.full, self.processor = job.result, job.processor
        self.size = self.full.stat().st_size
        self.counts = Counter()
        checks.true(job.status == 0, f'{name}: runs to its end {job.errors}')

    def clear(self):
        """Removes what earlier runs have left."""
        for path in self.folder.glob('part.*'):
            path.unlink()

    def begin(self, prepare=default_signals):
        """A run from the last state, or from the start where there is none."""
        if has_state(self.part):
            self.counts['restarts'] += 1
            return Job(self.deck, self.part, '--restart', str(self.part), prepare=prepare)
        return Job(self.deck, self.part, '--overwrite', prepare=prepare)

    def wait_for(self, job, aim, share):
        """Waits for the moment to kill: so much of the whole run's work, or what it is aimed at."""
        if aim != 'start':
            while job.process.poll() is None and \
                    processor_time(job.process.pid) < share * self.processor:
                time.sleep(0.0005)
        # the clock of the processor ticks in hundredths
        time.sleep(0.01 * self.random.random())
        if aim == 'publication':
            while not self.next.exists() and job.process.poll() is None:
                pass
        elif aim == 'end':
            while job.part.exists() and job.process.poll() is None:
                pass

    def kill(self, aim):
        """One run that is killed, unless it comes to its end before."""
        again = has_state(self.part)
        job = self.begin()
        self.wait_for(job, aim, self.random.random())
        publishing = self.next.exists()
        job.kill()
        if job.status == -signal.SIGKILL:
            self.count(aim, again, publishing)
        else:
            self.checks.true(job.status == 0, f'{self.name}: ends with {job.status} {job.errors}')
            self.counts['over before the kill'] += 1
        self.read()

    def count(self, aim, again, publishing):
        """Where a kill has hit."""
        self.counts['kills'] += 1
        self.counts[f'aimed: {aim}'] += 1
        self.counts['in a run taken up again'] += again
        self.counts['within a publication'] += publishing
        if not self.part.exists():
            self.counts['before the first publication'] += 1
        elif not has_state(self.part):
            self.counts['before the first state'] += 1
        elif self.is_complete():
            self.counts['after the results were complete'] += 1

    def is_complete(self):
        """Whether the results have all their rows."""
        rows = [len(read_all(path)['history/time']) for path in (self.part, self.full)]
        return rows[0] == rows[1]

    def fail_to_write(self):
        """One run that cannot write beyond a random size of its files."""
        limit = self.random.randrange(1, self.size)

        def limited():
            default_signals()
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        job = self.begin(limited).end()
        self.checks.true(job.status == 0 or (job.status == FILE_ERROR and 'error: ' in job.errors),
                         f'{self.name}, files of at most {limit} bytes: status {job.status}, '
                         f'{job.errors.splitlines()[:1]}')
        self.counts['writes that failed'] += 1
        # where there is no room for the first frame there is nothing for VTK to show
        if self.part.exists() and not len(read_all(self.part)['VTKHDF/Steps/Values']):
            self.counts['before the first frame'] += 1
        else:
            self.read()

    def read(self):
        """What a run has left is read by h5py and VTK."""
        if not self.part.exists():
            return
        read_all(self.part)
        complaints, _ = check_with_vtk(str(self.part))
        self.checks.true(not complaints, f'{self.name}: VTK reads what is left {complaints[:3]}')
        self.counts['files read'] += 1

    def finish(self, sentence, with_lines=False):
        """The last run goes on to the end: its results are those of the whole run, as are the lines of
        the status file, unless they could not be written."""
        job = self.begin().end()
        unlike = differences(self.full, self.part) if job.status == 0 else [job.errors]
        self.checks.true(not unlike, f'{self.name}, {sentence}: the same results {unlike[:3]}')
        if with_lines:
            lines = [path.with_suffix('.sta').read_text() for path in (self.part, self.full)]
            self.checks.true(lines[0] == lines[1], f'{self.name}, {sentence}: the same status lines')
        self.clear()

    def chain(self, kills):
        """Kills in a row, at most so many, then the rest of the run. Returns how many were made."""
        before = self.counts['kills']
        self.kill(self.random.choice(AIMS))
        while self.counts['kills'] - before < kills and self.random.random() < KILL_AGAIN:
            self.kill(self.random.choice(AIMS))
        made = self.counts['kills'] - before
        self.counts['chains'] += made > 1
        self.finish(f'killed {made} times', with_lines=True)
        return made


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n', maxsplit=1)[0])
    parser.add_argument('carom')
    parser.add_argument('--kills', type=int, default=25, help='of all cases together')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--case', action='append', choices=list(CASES), help='default: all')
    arguments = parser.parse_args()
    checks = Checks()
    restarts = 0
    names = arguments.case or list(CASES)
    for i, name in enumerate(names):
        victim = Victim(checks, name, random.Random(f'{arguments.seed} {name}'))
        left = (arguments.kills + i) // len(names)
        victim.fail_to_write()
        victim.finish('writes failed')
        while left > 0:
            left -= victim.chain(left)
        restarts += victim.counts['restarts']
        print(f'{name} ({victim.processor:.2f} s of processor time): '
              + ', '.join(f'{n} {what}' for what, n in sorted(victim.counts.items())))
    # else states are not found where they are looked for
    checks.at_least(restarts, 0.5 * arguments.kills, 'runs that went on from a state')
    checks.finish()


if __name__ == '__main__':
    main()
