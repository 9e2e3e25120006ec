"""A run that is asked to stop finishes the increment, saves its state and can be taken up again.

Signals, stop files and the time limit, in steps with fixed and automatic increments, static, dynamic
and explicit, in rehearsals and before the first increment. The results so far are read by h5py and
VTK; `--restart` then ends with the results of a run that nobody stopped, bit for bit.
"""
import signal
import time
from pathlib import Path

import numpy as np

from background_run import Job, ignore_hang_up, processor_time, read_all
from carom_case import INPUT, Checks, scratch_folder
from read_with_vtk import check as check_with_vtk
from restart_cases import write_case
from same_results import differences
from solid_mesh import Mesh, material, step

INTERRUPTED = 5
# the parts of a moment, or of a length, that are tried until it lies within the run: earlier ones where the
# run was over by then, as happens when the machine has other work and times are uncertain
SHARES = (1.0, 0.9, 0.8, 0.7, 0.5, 0.3)


class Case:
    """A deck with the results of a run that is not stopped."""

    def __init__(self, checks, name, deck=None):
        self.checks, self.name = checks, name
        self.folder = scratch_folder()
        self.deck = self.folder / f'{name}.inp'
        if deck:
            self.deck.write_text(deck)
        else:
            write_case(name, self.deck)
        job = Job(self.deck, self.folder / 'full.h5').end()
        self.full, self.processor = job.result, job.processor
        checks.true(job.status == 0, f'{name}: runs to its end when nobody stops it {job.errors}')
        self.columns = read_all(self.full)

    def job(self, *options, **more):
        """A run of the deck into results of its own."""
        return Job(self.deck, self.folder / 'part.h5', '--overwrite', *options, **more)

    def signalled(self, part, *numbers):
        """A run that signals meet after a part of its processor time."""
        for share in SHARES:
            job = self.job().until_it_computes(share * part * self.processor)
            for number in numbers:
                job.send(number)
            if job.end().status != 0:
                break
        return job

    def limited(self, part):
        """A run whose time limit is a part of its processor time: that is the least that it takes, however
        busy the machine is. Again where it was over by then, or much earlier, after an increment that
        a busy machine made long."""
        for share in SHARES:
            limit = round(share * part * self.processor, 2)
            job = self.job('--time-limit', str(limit)).end()
            if job.status != 0 and job.seconds >= 0.5 * limit:
                break
        return job, limit

    def stopped(self, job, reason, rows=None):
        """Checks of a run that was stopped: the status, what it said, what it left."""
        job.end()
        name = f'{self.name}, {reason}'
        self.checks.true(job.status == INTERRUPTED, f'{name}: status {job.status} is 5')
        self.checks.true(job.last_line.startswith(f'stopped: interrupted by {reason}'),
                         f'{name}: the log ends with "{job.last_line}"')
        self.checks.true(f'--restart {job.result}' in job.said, f'{name}: the log says how to go on')
        self.checks.true(f'interrupted by {reason}' in job.errors, f'{name}: so does the terminal')
        columns = read_all(job.result)
        n = len(columns.get('history/time', ()))
        self.checks.true(n < len(self.columns['history/time']) and rows in (None, n),
                         f'{name}: {n} of {len(self.columns["history/time"])} rows')
        unlike = [path for path, data in columns.items() if path.startswith(('history/', 'energy/'))
                  and not np.array_equal(data, self.columns[path][:len(data)], equal_nan=True)]
        self.checks.true(not unlike, f'{name}: the rows are those of the whole run {unlike}')
        if not len(columns.get('VTKHDF/Steps/Values', ())):
            return job      # no frames so far
        complaints, frames = check_with_vtk(str(job.result))
        self.checks.true(not complaints, f'{name}: VTK reads {frames} frames {complaints[:3]}')
        return job

    def goes_on(self, job, reason='', rows=None):
        """Takes the run up again: to the end, or as far as `reason` lets it."""
        again = Job(self.deck, job.result, '--restart', str(job.result))
        if reason:
            return self.stopped(again, reason, rows)
        again.end()
        self.checks.true(again.status == 0, f'{self.name}: goes on to its end {again.errors}')
        unlike = differences(self.full, job.result)
        self.checks.true(not unlike, f'{self.name}: then has the same results, bit for bit {unlike[:3]}')
        return again


def check_signals(checks):
    """Each signal in another kind of step."""
    for name, number in (('wall', signal.SIGINT), ('bar', signal.SIGTERM), ('plastic', signal.SIGINT),
                         ('friction', signal.SIGHUP), ('explicit', signal.SIGTERM)):
        case = Case(checks, name)
        job = case.signalled(0.3, number)
        case.stopped(job, signal.Signals(number).name)
        checks.true('a second signal stops at once' in job.errors, f'{name}: says that it has heard')
        case.goes_on(job)


def check_stop_files(checks):
    """Both names; a file that is there before; one that comes again in the run that goes on."""
    for length in (2.5, 7.5, 25, 75):       # files are looked for once a second
        deck = write_case('wall', scratch_folder() / 'wall.inp', length=length).read_text()
        case = Case(checks, 'longer', deck)
        short, long = case.deck.with_suffix('.stop'), Path(f'{case.deck}.stop')
        if case.processor < 1.5:
            continue
        job = case.job().until_it_computes()
        short.touch()
        if job.end().status != 0:
            break
    case.stopped(job, f'the file {short}')
    checks.true(not short.exists(), 'a stop file that has been obeyed is removed')
    long.touch()
    again = case.goes_on(job, f'the file {long}')
    checks.true(not long.exists(), 'the stop file with the full name too')
    case.goes_on(again)
    short.touch()
    job = case.job()
    case.stopped(job, f'the file {short}', rows=1)
    case.goes_on(job)


def check_time_limit(checks):
    """The run ends within its limit, and not much before; one without time stops at the start."""
    case = Case(checks, 'plastic')
    job, limit = case.limited(0.4)
    case.stopped(job, f'the time limit of {limit:g} s')
    checks.at_most(job.processor, limit + 0.2, f'a limit of {limit} s: seconds of the processor')
    checks.at_least(job.seconds, 0.5 * limit, f'a limit of {limit} s: seconds taken')
    case.goes_on(job)
    job = case.job('--time-limit', '0.001')
    case.stopped(job, 'the time limit of 0.001 s', rows=1)
    case.goes_on(job)


def check_rehearsals(checks):
    """A step with TOLERANCE stops in its rehearsals and in its increments."""
    case = Case(checks, 'tolerance')
    job = case.signalled(0.05, signal.SIGTERM)
    case.stopped(job, 'SIGTERM', rows=1)
    case.goes_on(job)
    job = case.signalled(0.75, signal.SIGINT)
    case.stopped(job, 'SIGINT')
    checks.true('rehearsal' in job.said, 'tolerance: stopped after its rehearsals')
    case.goes_on(job)


def check_steps(checks):
    """A stop in the second of two steps, and one before a static step that a frequency step follows."""
    folder = scratch_folder()
    deck, longer = (write_case('wall', folder / 'wall.inp', length=x).read_text() for x in (0.05, 0.6))
    case = Case(checks, 'steps', deck + longer[longer.index('*STEP'):])
    job = case.signalled(0.4, signal.SIGTERM)
    case.stopped(job, 'SIGTERM')
    checks.true('of step 2' in job.last_line, f'steps: stopped in the second one, {job.last_line}')
    case.goes_on(job)
    modes = (INPUT / 'cantilever/modes.inp').read_text()
    steps = modes.index('*STEP')
    case = Case(checks, 'modes', modes[:steps]
                + step('STATIC, DIRECT', '0.1, 1', prints='*NODE PRINT, NSET=root\nU\n*NODE FILE\nU\n')
                + modes[steps:])
    case.deck.with_suffix('.stop').touch()
    job = case.job()
    case.stopped(job, f'the file {case.deck.with_suffix(".stop")}', rows=1)
    case.goes_on(job)


def check_second_signal(checks):
    """A second signal does not wait for what takes long."""
    for n in (60, 100, 160):                # larger where the modes were found in no time
        deck = scratch_folder() / 'modes.inp'
        deck.write_text(Mesh(n, n, 4).text('CPE4') + material(1000.0, 0.3) + '*BOUNDARY\n1, 1, 2\n2, 2\n'
                        + step('FREQUENCY', '200', prints='*NODE FILE\nU\n'))
        job = Job(deck, deck.with_suffix('.h5')).until_it_computes(0.3).send(signal.SIGINT)
        job.until_it_says('a second signal stops at once')
        time.sleep(0.15)                    # signals within a tenth of a second are one request
        computed = processor_time(job.process.pid)
        job.send(signal.SIGTERM).end()
        if 'stopped at once' in job.errors:
            break
    checks.true(job.status == INTERRUPTED, f'a second signal: status {job.status} is 5')
    checks.at_most(job.processor - computed, 0.5, 'a second signal: seconds of the processor to the end')
    checks.true('stopped at once' in job.errors, f'a second signal: said {job.errors!r}')


def check_harmless_signals(checks):
    """Two signals at once are one request; SIGHUP does nothing under nohup."""
    case = Case(checks, 'friction')
    job = case.signalled(0.3, signal.SIGSTOP, signal.SIGTERM, signal.SIGINT, signal.SIGCONT)
    checks.true(job.status == INTERRUPTED and 'stopped: interrupted by SIG' in job.last_line,
                f'two signals at once: the state is saved, {job.last_line}')
    case.goes_on(job)
    for share in SHARES:
        job = case.job(prepare=ignore_hang_up).until_it_computes(share * 0.3 * case.processor)
        goes_on = job.send(signal.SIGHUP).process.poll() is None
        job.end()
        if goes_on:
            break
    checks.true(goes_on, 'nohup: SIGHUP meets the run')
    checks.true(job.status == 0 and job.last_line == 'completed', 'nohup: SIGHUP does not stop a run')
    checks.true(not differences(case.full, job.result), 'nohup: nor does it change results')


def main():
    checks = Checks()
    check_signals(checks)
    check_stop_files(checks)
    check_time_limit(checks)
    check_rehearsals(checks)
    check_steps(checks)
    check_second_signal(checks)
    check_harmless_signals(checks)
    checks.finish()


if __name__ == '__main__':
    main()
