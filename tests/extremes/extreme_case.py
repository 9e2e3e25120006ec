"""Cases at the extremes: how one is declared, run, judged and written into a table.

A script makes a list of `Case` (one deck) and `Group` (many decks, one line) and ends with

    sys.exit(main(cases))

    python3 SCRIPT.py CAROM [--long] [--only WORD...] [--table FILE.csv] [--write FOLDER] [--jobs N]

A case expects one of two things: status 0, and results that its `check` finds right; or another
status, with words that the message must hold. Whatever it expects, it fails if the program hangs
(more than `seconds` of processor time), dies by a signal, prints a backtrace or ends with an
internal error; if an error says no cure; and if status 0 comes with an infinite number or one
that is none in the results or without `completed` in the log.

`check(run, findings)` gets the finished run (carom_case.Run and more, see `ExtremeRun`) and says
what it finds by `findings.at_most(value, limit, sentence)`, `close`, `true` (carom_case.Checks);
`findings.measured('...')` puts a figure into the table in place of those sentences.
"""
import argparse
import csv
import fcntl
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'verification'))
from carom_case import Checks, Run                                           # noqa: E402

STATUS_INTERNAL = 6
COLUMNS = ['name', 'what', 'expected', 'measured', 'status', 'seconds', 'outcome']
BACKTRACE = re.compile(r'[Bb]acktrace|Fortran runtime error|Program received signal|'
                       r'SIGSEGV|SIGFPE|SIGABRT|AddressSanitizer|runtime error:')
# A gap is no number where no partner is near, as the README says.
NAN_ALLOWED = re.compile(r'CDIS$')
CHUNK = 1 << 20


class Case:
    """One deck at an extreme, and what it must bring about.

    name      one word
    what      a phrase: what is extreme here
    deck      its text, or a procedure that makes the text (for long ones)
    expected  a phrase for the table
    check     procedure (run, findings), for status 0; None: that it ends well and finite is all
    status    exit status of the program, or several that are right
    words     what the message of another status than 0 must hold
    seconds   limit of processor time
    options   more words for the command line: ['--define', 'dt=1e-3']
    command   run or check
    memory    limit of the address space in GB
    """

    def __init__(self, name, what, deck, expected, check=None, status=0, words=(), seconds=20.0,
                 options=(), command='run', memory=None):
        self.name, self.what, self.deck, self.expected = name, what, deck, expected
        self.check, self.words = check, words
        self.seconds, self.options, self.command = seconds, list(options), command
        self.memory = memory
        self.statuses = (status,) if isinstance(status, int) else tuple(status)
        if self.statuses == (0,) and words:
            raise ValueError(f'{name}: words are for messages; read run.log in check')

    def text(self):
        """The deck."""
        return self.deck() if callable(self.deck) else self.deck


class Group:
    """Many cases that are one line of the table; it fails if one of them does."""

    def __init__(self, name, what, expected, cases):
        self.name, self.what, self.expected, self.cases = name, what, expected, list(cases)


class Findings(Checks):
    """What a check finds: sentences, good and bad, and a figure for the table."""

    def __init__(self):
        self.lines = {True: [], False: []}
        self.figures = []

    def measured(self, text):
        """A figure that stands in the table for the sentences of the check."""
        self.figures.append(text)

    def bad(self, sentence):
        """Something is wrong."""
        self.true(False, sentence)

    @property
    def faults(self):
        """The sentences of what is wrong."""
        return [line.split(None, 1)[1] for line in self.lines[False]]

    @property
    def summary(self):
        """What the table shows: faults first, else figures, else the sentences of the check."""
        good = self.figures or [line.split(None, 1)[1] for line in self.lines[True]]
        return '; '.join(self.faults + good if self.faults else good)


class ExtremeRun(Run):
    """A finished run: also its log, its time, its memory, and the way to run another deck."""

    def __init__(self, program, case, folder):
        self.program = program
        path, result = folder / 'deck.inp', folder / 'deck.h5'
        path.write_text(case.text())
        words = [program.path, case.command, str(path)]
        if case.command == 'run':
            words += ['-o', str(result), '--quiet', '--overwrite']
        began = time.monotonic()
        status, text = self._execute(words + case.options, case, folder)
        self.elapsed = time.monotonic() - began
        super().__init__(status, text, result)
        log = folder / 'deck.log'
        self.log = log.read_text() if log.exists() else ''

    def _execute(self, words, case, folder):
        """Runs the program, limited in processor time and ten times that on the clock."""
        with open(folder / 'terminal.txt', 'w') as terminal:
            process = subprocess.Popen(words, stdout=terminal, stderr=subprocess.STDOUT, cwd=folder,
                                       env={**os.environ, 'OPENBLAS_NUM_THREADS': '1'})
            limit = int(np.ceil(case.seconds))
            resource.prlimit(process.pid, resource.RLIMIT_CPU, (limit, limit + 1))
            if case.memory:
                size = int(case.memory*2**30)
                resource.prlimit(process.pid, resource.RLIMIT_AS, (size, size))
            usage = self._wait(process, time.monotonic() + 10*limit)
        self.cpu_seconds = usage.ru_utime + usage.ru_stime
        self.hung = self.hung or (process.returncode < 0 and self.cpu_seconds > 0.95*limit)
        return process.returncode, (folder / 'terminal.txt').read_text(errors='replace')

    def _wait(self, process, deadline):
        """Waits for the end, kills at the deadline; what was used up by then."""
        self.hung, pause = False, 0.001
        #: most memory it held, in bytes (ru_maxrss counts this script's too, from before the exec)
        self.memory = 0
        while True:
            self.memory = max(self.memory, most_resident(process.pid))
            done, state, usage = os.wait4(process.pid, os.WNOHANG)
            if done:
                process.returncode = os.waitstatus_to_exitcode(state)
                return usage
            if time.monotonic() > deadline and not self.hung:
                self.hung = True
                process.kill()
            time.sleep(pause)
            pause = min(0.05, 1.5*pause)

    def again(self, deck, **keywords):
        """Another deck by the same program, expected to end well."""
        keywords.setdefault('seconds', 60.0)
        case = Case('again', '', deck, '', **keywords)
        run = self.program.run(case)
        if run.status not in case.statuses:
            raise AssertionError(f'the run compared with ended with {run.status}: {run.text[:200]}')
        return run

    def not_finite(self):
        """Names of datasets that hold a number they must not hold."""
        names = []

        def look(name, item):
            if isinstance(item, h5py.Dataset) and item.dtype.kind == 'f' and not _is_sound(item):
                names.append(name)
        if self.file:
            self.file.visititems(look)
        return names


def most_resident(process):
    """The largest resident size of a running process so far, in bytes; 0 if it has ended."""
    try:
        status = Path(f'/proc/{process}/status').read_text()
    except OSError:
        return 0
    found = re.search(r'^VmHWM:\s*(\d+) kB', status, re.M)
    return 1024*int(found.group(1)) if found else 0


def _is_sound(data):
    """Whether all numbers of a dataset are finite (or no numbers, where that is allowed)."""
    may_be_nan = bool(NAN_ALLOWED.search(data.name))
    for start in range(0, data.shape[0] if data.shape else 0, CHUNK):
        part = data[start:start + CHUNK]
        if np.any(np.isinf(part)) or (not may_be_nan and np.any(np.isnan(part))):
            return False
    return True


class Program:
    """The program under test; each run has a folder of its own that goes when the script ends."""

    def __init__(self, path, scratch):
        self.path, self.scratch = str(Path(path).resolve()), scratch

    def run(self, case):
        """Runs a case."""
        return ExtremeRun(self, case, Path(tempfile.mkdtemp(dir=self.scratch)))


def find_end(run, case, findings):
    """What is wrong with the way a run ended."""
    if run.hung:
        findings.bad(f'still running after {run.cpu_seconds:.0f} s of processor time')
    elif run.status < 0:
        findings.bad(f'ended by signal {-run.status}')
    elif run.status not in case.statuses:
        wanted = ' or '.join(map(str, case.statuses))
        findings.bad(f'status {run.status}, not {wanted}: {run.text.strip()[:300]}')
    if BACKTRACE.search(run.text) or run.status == STATUS_INTERNAL:
        findings.bad(f'an error inside: {run.text.strip()[:300]}')
    if findings.faults:
        return
    if run.status:
        find_message(run, case, findings)
    elif case.command == 'run':
        names = run.not_finite()
        if names:
            findings.bad(f'not finite: {", ".join(names[:5])}')
        if not run.log.rstrip().endswith('completed'):
            findings.bad('the log does not end with "completed"')


def find_message(run, case, findings):
    """What is wrong with the message of a stop."""
    flat = ' '.join(run.text.split())
    for word in case.words:
        if ' '.join(word.split()).lower() not in flat.lower():
            findings.bad(f'the message lacks "{word}": {run.text.strip()[:300]}')
    for word in ('error: ', 'cure: '):
        if word not in run.text:
            findings.bad(f'the message has no "{word.strip()}": {run.text.strip()[:300]}')
    findings.measured(flat.split(' card: ')[0].split(' cure: ')[0].replace('error: ', '', 1)[:160])


def judge(case, program):
    """Runs a case: its findings, the status of the program, and seconds of processor time."""
    findings = Findings()
    run = program.run(case)
    find_end(run, case, findings)
    if not findings.faults and case.check and (run.status == 0 or 0 not in case.statuses):
        try:
            case.check(run, findings)
        except (AssertionError, KeyError, TypeError, ValueError, IndexError) as problem:
            findings.bad(f'{type(problem).__name__}: {problem}')
        if not (findings.lines[True] or findings.lines[False]):
            findings.bad('the check asserts nothing')
    if run.file:
        run.file.close()
    return findings, run


def run_entry(entry, program):
    """Runs a case or a group: its row of the table and its faults."""
    cases = entry.cases if isinstance(entry, Group) else [entry]
    faults, summaries, statuses, seconds, failed = [], [], set(), 0.0, 0
    for case in cases:
        findings, run = judge(case, program)
        place = f'{case.name}: ' if isinstance(entry, Group) else ''
        faults += [place + fault for fault in findings.faults]
        failed += bool(findings.faults)
        summaries.append(findings.summary)
        statuses.add(run.status)
        seconds += run.cpu_seconds
        shutil.rmtree(Path(run.path).parent, ignore_errors=True)
    measured = summaries[0] if cases else ''
    if isinstance(entry, Group):
        measured = f'{len(cases) - failed} of {len(cases)} as expected'
        measured += f'; {faults[0]}' if faults else ''
    row = [entry.name, entry.what, entry.expected, measured,
           ' '.join(str(status) for status in sorted(statuses)), f'{seconds:.2f}',
           'FAILED' if faults else 'ok']
    return row, faults


def append_rows(path, rows):
    """Adds rows to a table that other scripts may write at the same time."""
    with open(path, 'a', newline='') as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.seek(0, os.SEEK_END)
        writer = csv.writer(file)
        if file.tell() == 0:
            writer.writerow(COLUMNS)
        writer.writerows(rows)


def write_decks(entries, folder):
    """Writes the decks of the entries, to look at."""
    folder.mkdir(parents=True, exist_ok=True)
    for entry in entries:
        for case in entry.cases if isinstance(entry, Group) else [entry]:
            (folder / f'{case.name}.inp').write_text(case.text())


def read_arguments(words):
    """The command line."""
    parser = argparse.ArgumentParser(description='Cases at the extremes.')
    parser.add_argument('carom', help='the program')
    parser.add_argument('--long', action='store_true', help='the long variants too')
    parser.add_argument('--only', nargs='+', metavar='WORD', help='cases whose name holds a word')
    parser.add_argument('--table', type=Path, metavar='FILE.csv', help='adds a row a case')
    parser.add_argument('--write', type=Path, metavar='FOLDER', help='writes the decks, runs none')
    parser.add_argument('--jobs', type=int, default=1, metavar='N', help='cases at a time')
    return parser.parse_args(words)


def main(cases, long_cases=(), words=None):
    """Runs the cases (and with --long the long ones), prints a line each: the exit status."""
    arguments = read_arguments(words)
    entries = [*cases, *(long_cases if arguments.long else ())]
    if arguments.only:
        entries = [entry for entry in entries if any(word in entry.name for word in arguments.only)]
    if arguments.write:
        write_decks(entries, arguments.write)
        return 0
    rows, all_faults = [], []
    with tempfile.TemporaryDirectory(prefix='carom_') as scratch:
        program = Program(arguments.carom, Path(scratch))
        with ThreadPoolExecutor(arguments.jobs) as pool:
            for row, faults in pool.map(lambda entry: run_entry(entry, program), entries):
                print(f'{row[-1]:7} {row[0]}: {row[3]}  [{row[2]}; status {row[4]}, {row[5]} s]',
                      flush=True)
                for fault in faults:
                    print(f'        {row[0]}: {fault}', flush=True)
                rows.append(row)
                all_faults += faults
    if arguments.table:
        append_rows(arguments.table, rows)
    failed = sum(row[-1] == 'FAILED' for row in rows)
    print(f'{len(rows) - failed} of {len(rows)} extreme cases as expected, '
          f'{sum(float(row[5]) for row in rows):.1f} s')
    return 0 if rows and not failed else 1
