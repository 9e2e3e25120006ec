"""What a run tells: progress on a terminal, warnings with counts, the summary, and JSON.

The terminal is a pseudo-terminal; what it would show is compared with the results of the run.
"""
import json
import os
import pty
import re
import resource
import signal
import subprocess
import sys
from pathlib import Path

import h5py

from carom_case import INPUT, Checks, scratch_folder

PROGRAM = str(Path(sys.argv[1]).resolve())
SDOF = INPUT / 'sdof/sdof.inp'
FOLDER = scratch_folder()
LIVES = re.compile(r'^ *(\d+) %  step (\d+)(?:/(\d+))?(.*)$')
STEP = 0.04
# One thread: the libraries then take few addresses
ENVIRONMENT = {**os.environ, 'OMP_NUM_THREADS': '1', 'OPENBLAS_NUM_THREADS': '1'}

# The mass at a wall, its heading harder to print, its output one line in a hundred increments
OSCILLATOR = re.sub(r'(?s)\*NODE PRINT.*', '*NODE PRINT, FREQUENCY=100\nU\n*END STEP\n',
                    SDOF.read_text()).replace('One mass on a spring that hits a wall (m = k = 1)',
                                              'An oscillator at a wall, "quoted" \\ and \u00e4')
STATIC = """*STEP
*STATIC
1, 1
*CLOAD
1, 1, 1
*END STEP
"""
# A load lifts the mass off the wall three times; each time its bounces end beyond MAX EVENTS
LIMITED = OSCILLATOR.replace('RESTITUTION=<e>', 'RESTITUTION=0.2, CAPTURE=0, MAX EVENTS=2').replace(
    '-0.5, 0, 0', '0.3, 0, 0').replace('*STEP', """*AMPLITUDE, NAME=lift
0, 0, 6, 0, 7, 2, 8, 0
13, 0, 14, 2, 15, 0
*STEP""", 1).replace('*NODE PRINT', """*CLOAD, AMPLITUDE=lift
1, 1, 1
*NODE PRINT""")


def write(name, text):
    path = FOLDER / f'{name}.inp'
    path.write_text(text)
    return path


def on_terminal(*words, cut=None, **variables):
    """Status and output of a run on a terminal; `cut` seconds after its first line of progress it
    gets a SIGINT."""
    environment = {**ENVIRONMENT, 'TERM': 'xterm', **variables}
    if 'COLUMNS' not in variables:
        environment.pop('COLUMNS', None)
    pid, terminal = pty.fork()
    if pid == 0:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.execve(PROGRAM, [PROGRAM, *map(str, words)], environment)
    said = b''
    while True:
        try:
            piece = os.read(terminal, 65536)
        except OSError:
            break
        if not piece:
            break
        said += piece
        if cut and b'left' in said:
            os.kill(pid, signal.SIGINT)
            cut = None
    status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    os.close(terminal)
    return status, said.decode().replace('\r\n', '\n')


def shown(said):
    """The lines that stay on the terminal, and those of the progress in their order."""
    kept, drawn = [], []
    for line in said.split('\n'):
        parts = line.split('\r')
        drawn += [part.replace('\x1b[K', '') for part in parts[1:] if LIVES.match(
            part.replace('\x1b[K', ''))]
        kept.append(parts[-1].replace('\x1b[K', ''))
    return kept, drawn


def seconds(text):
    """`left 12 s`, `left 3:05` or `left 1:02:03` of a line of progress; None where it has none."""
    match = re.search(r'left (\d+) s|left ([\d:]+)', text)
    if not match:
        return None
    total = 0
    for part in (match[1] or match[2]).split(':'):
        total = 60*total + int(part)
    return total


def command(*words, cwd=FOLDER):
    """A finished process."""
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, cwd=cwd,
                          timeout=300, env=ENVIRONMENT)


def run_json(checks, *words, status=0):
    """The object that a command prints, its exit status checked."""
    done = command(*words, '--json')
    checks.true(done.returncode == status, f'--json {words[0]}: status {done.returncode} is {status}')
    found = json.loads(done.stdout, parse_constant=lambda word: sys.exit(f'FAILED: {word} in JSON'))
    checks.true(found['status'] == status, f'--json {words[0]}: says status {found["status"]}')
    checks.true(bool(done.stderr) == bool(status),
                f'--json {words[0]}: the error stands on stderr too: {done.stderr[:300]!r}')
    return found


def machine_speed():
    """Increments that the oscillator takes here in a second of the processor, by a run of its own: in a
    second of the clock there may be fewer, so that runs last as long as wanted, or longer."""
    increments = 50000
    done = command('run', write('speed', OSCILLATOR), '--json', '--define', end_after(increments))
    return increments/json.loads(done.stdout)['seconds']['processor']


def end_after(increments):
    """The word that makes a run so long."""
    return f'end={int(increments)*STEP:.10g}'


def drawn_enough(increments, wanted, *words, **variables):
    """A run on a terminal: its increments, status and output. It is repeated with more increments where
    it was over before what was wanted of its lines of progress could be drawn."""
    for longer in (1, 3, 9, 27):
        status, said = on_terminal(*words, '--overwrite', '--define', end_after(longer*increments), **variables)
        if wanted(shown(said)[1]):
            break
    return int(longer*increments), status, said


def check_progress(checks, speed):
    """Rate, time left, impacts; 100 % at the end; the log below it whole."""
    deck = write('long', OSCILLATOR)
    result = FOLDER / 'long.h5'
    increments, status, said = drawn_enough(2*speed, lambda drawn: len(drawn) >= 3, 'run', deck, '-o', result)
    kept, drawn = shown(said)
    checks.true(status == 0, f'on a terminal: status {status}')
    checks.at_least(len(drawn), 3, 'lines of progress')
    with h5py.File(result) as file:
        elapsed = file['cost/elapsed_seconds'][0]
    checks.at_most(len(drawn), 4*elapsed + 2, 'not more than four a second')
    percent = [int(LIVES.match(line)[1]) for line in drawn]
    checks.true(percent == sorted(percent) and percent[-1] == 100, f'per cent grow: {percent}')
    for line in drawn[:-1]:
        done, rate = map(int, re.search(r'increment (\d+)  (\d+)/s', line).groups())
        left, least, most = increments - done, rate - 0.5001, rate + 0.5001      # the rate is rounded
        checks.true(left/most <= seconds(line) < left/least + 1,
                    f'the time left is that of the increments left at this rate: "{line}"')
    checks.true(all(re.search(r'  increment \d+  \S+/s  left .*  impacts \d+  touching \d+$', line)
                    for line in drawn[:-1]), f'all of a line: "{drawn[0]}"')
    checks.at_most(max(map(len, drawn)), 79, 'its width')
    with h5py.File(result) as file:
        impacts = len(file['events/time'])
    checks.true(f'increment {increments}  ' in drawn[-1] and f'impacts {impacts} ' in drawn[-1],
                f'the last one: "{drawn[-1]}"')
    checks.true(drawn[-1] in kept and kept[-2] == 'completed' and kept[-1] == '',
                'it stays, and the last line is: completed')
    checks.true('\x1b' not in ''.join(kept), 'nothing else is left of the others')
    rate = int(re.search(r'(\d+)/s', drawn[-1])[1])
    checks.true(0.2 < rate*elapsed/increments < 5,
                f'the rate {rate}/s is that of {increments} increments in {elapsed:.3g} s')


def check_terminals(checks, speed):
    """Narrow ones, ones that cannot rewrite a line, none."""
    deck = write('short', OSCILLATOR)
    words = ('run', deck, '-o', FOLDER / 'short.h5')
    increments, _, said = drawn_enough(speed, bool, *words, COLUMNS='40')
    words = (*words, '--overwrite', '--define', end_after(increments))
    _, drawn = shown(said)
    checks.true(0 < max(map(len, drawn), default=0) < 40, f'40 columns: "{drawn[:1]}"')
    _, said = on_terminal(*words, TERM='dumb')
    checks.true(not shown(said)[1] and '\x1b' not in said, 'TERM=dumb: no progress')
    _, said = on_terminal(*words, '--quiet')
    checks.true(said == '', '--quiet: nothing')
    done = command(*words)
    checks.true('\r' not in done.stdout and '\x1b' not in done.stdout and ' %  step' not in
                done.stdout and done.stderr == '', 'a pipe: the log alone')


def check_endings(checks, speed):
    """An interruption and an error in mid-run leave the line, and stand on lines of their own."""
    deck = write('cut', OSCILLATOR)
    status, said = on_terminal('run', deck, '--define', end_after(100*speed), cut=True)
    kept, drawn = shown(said)
    last = [line for line in kept if LIVES.match(line)]
    checks.true(status == 5 and len(last) >= 1 and int(LIVES.match(last[-1])[1]) < 100,
                f'SIGINT: the line stays where the run has stopped: "{last[-1:]}"')
    stopped = [line for line in kept if 'interrupted by SIGINT' in line]
    checks.true(len(stopped) == 1 and stopped[0].startswith('stopped: interrupted by SIGINT after'),
                f'SIGINT: said once, on a line of its own: {stopped}')
    log = (FOLDER / 'cut.log').read_text().splitlines()
    checks.true(log[-1] == stopped[0], 'the log ends with the same line')
    deck = write('unstable', OSCILLATOR.replace('*END STEP', '*ENERGY PRINT, LIMIT=1e-30\n*END STEP'))
    both = FOLDER / 'both.txt'
    with both.open('w') as file:
        done = subprocess.run([PROGRAM, 'run', deck], stdout=file, stderr=file, check=False)
    lines = both.read_text().splitlines()
    errors = [i for i, line in enumerate(lines) if line.startswith('error: the energy balance')]
    checks.true(done.returncode == 4 and len(errors) == 1 and lines[errors[0] + 1].startswith(
        '  cure: ') and len(lines) == errors[0] + 2, 'output and errors in one file: the error comes '
        'last, on lines of its own')


def check_steps(checks, speed):
    """Two steps share the per cent by their increments; rehearsals are said to be such."""
    deck = write('steps', OSCILLATOR.replace('*STEP\n', STATIC + '*STEP\n', 1).replace(
        '*INITIAL CONDITIONS, TYPE=DISPLACEMENT\n1, 1, 1\n', ''))
    _, _, said = drawn_enough(speed, bool, 'run', deck)
    kept, drawn = shown(said)
    steps = [LIVES.match(line).groups()[1:3] for line in drawn]
    # on a busy machine there may be time for a line in the first step
    checks.true(steps and set(steps) <= {('1', '2'), ('2', '2')} and steps[-1] == ('2', '2') and drawn[-1].startswith('100 %'),
                f'two steps: "{drawn[-1:]}"')
    log = (FOLDER / 'steps.log').read_text()
    rows = re.findall(r'^  (1 static|2 dynamic|all) +(\d+) +(\d+) +(\d+) +(\d+) ', log, re.M)
    checks.true(len(rows) == 3 and [int(a) + int(b) for a, b in zip(rows[0][1:], rows[1][1:])]
                == [int(n) for n in rows[2][1:]], f'the summary adds up the steps: {rows}')
    deck = write('tolerance', OSCILLATOR.replace('DIRECT', 'TOLERANCE=1e-4').replace(
        '*STEP\n', '*STEP, INC=1000000000\n'))

    def rehearsing(drawn):
        return any(re.search(r'rehearsing \(\d\), \d+ %  inc', line) for line in drawn)

    # a rehearsal of this tolerance takes some ten increments where the deck's size takes one
    _, _, said = drawn_enough(0.1*speed, rehearsing, 'run', deck)
    kept, drawn = shown(said)
    checks.true(rehearsing(drawn), f'TOLERANCE: "{drawn[:1]}"')
    checks.true('\r' not in ''.join(kept) and any(line.startswith('  rehearsal: ') for line in kept),
                'TOLERANCE: what is said of rehearsals stands on lines of its own')


def check_warnings(checks):
    """The first time in the log at its time, all of them counted at the end, over a restart too."""
    deck = write('limit', LIMITED)
    found = run_json(checks, 'run', deck)
    log = (FOLDER / 'limit.log').read_text()
    first = re.findall(r'^warning \(at t = (\S+)\): MAX EVENTS', log, re.M)
    again = re.findall(r'^warning \((\d+) times, first at t = (\S+)\): MAX EVENTS', log, re.M)
    with h5py.File(FOLDER / 'limit.h5') as file:
        limits = [t for t, kind in zip(file['events/time'][()], file['events/kind'][()])
                  if kind == b'limit']
    checks.true(len(first) == 1 and len(again) == 1 and again[0] == (str(len(limits)), first[0])
                and len(limits) > 1, f'{len(limits)} times MAX EVENTS: {first}, {again}')
    checks.true(0.0 <= float(first[0]) - limits[0] <= 0.04 + 1e-6, 'first: in its increment')
    warning = found['warnings'][0]
    checks.true(len(found['warnings']) == 1 and warning['count'] == len(limits)
                and abs(warning['first_time'] - float(first[0])) < 1e-5, 'JSON says the same')
    checks.true(log.splitlines()[-1] == 'completed' and '  1 warning\n' in log, 'and how many')
    saved = write('parts', LIMITED.replace('*NODE PRINT', '*RESTART, WRITE, FREQUENCY=1\n'
                                           '*NODE PRINT'))
    half = command('run', saved, '--define', 'end=10')
    rest = run_json(checks, 'run', saved, '--restart', FOLDER / 'parts.h5')
    checks.true(half.returncode == 0 and rest['goes_on'], 'a run in two parts')
    for name in ('warnings', 'events', 'energies', 'balance_error', 'time', 'most_touching'):
        checks.true(rest[name] == found[name], f'in two parts: the same {name}')
    counts = [[step[name] for name in ('increments', 'iterations', 'solves', 'factorizations')]
              for step in (rest['steps'][0], found['steps'][0])]
    checks.true(counts[0] == counts[1], f'in two parts: the same counts {counts}')
    log = (FOLDER / 'parts.log').read_text()
    checks.true('counts and times are those of all its runs together' in log, 'and the log says so')


def check_summary(checks):
    """The table: at most 100 columns, what the results say."""
    done = command('run', SDOF, '-o', FOLDER / 'sdof.h5')
    log = (FOLDER / 'sdof.log').read_text()
    table = log[log.index('summary of the run'):].splitlines()
    checks.at_most(max(map(len, table)), 100, 'columns of the summary')
    with h5py.File(FOLDER / 'sdof.h5') as file:
        kinetic, work = file['energy/kinetic'][-1], file['energy/balance_error'][-1]
        solves = file['cost/solves'][0]
        impacts = len(file['events/time'])
    text = '\n'.join(table)
    end = re.search(r'^  end +(\S+) +(\S+)', text, re.M)
    checks.close(float(end[1]), kinetic, 1e-5, 'kinetic energy at the end')
    balance = re.search(r'^  balance error +(\S+), (\S+) of the largest energy', text, re.M)
    checks.close(float(balance[1]), work, 1e-2*abs(work), 'balance error')
    checks.close(float(balance[2]), abs(work)/0.5, 1e-1*abs(work), 'of the largest energy')
    row = re.search(r'^  1 dynamic +(\d+) +\d+ +\d+ +(\d+) ', text, re.M)
    checks.true((int(row[1]), int(row[2])) == (500, solves), 'increments and solves')
    checks.true(f'{impacts} impacts,' in text, 'impacts')
    memory = re.search(r'memory +at most (\S+) MB, estimated (\S+) MB', text)
    checks.true(0.5 < float(memory[1])/float(memory[2]) < 2, f'memory: {memory[0]}')
    checks.true(table[-1] == 'completed', 'the last line')
    checks.true('reached time 20 in 500 increments' in done.stdout
                and 'summary' not in done.stdout, 'the terminal has the short form')


def check_json(checks):
    """Runs, checks and errors of every kind; numbers as in the results."""
    deck = write('fine', OSCILLATOR)
    found = run_json(checks, 'run', deck)
    with h5py.File(FOLDER / 'fine.h5') as file:
        cost = {name: file[f'cost/{name}'][0] for name in ('increments', 'solves')}
        elapsed = file['cost/elapsed_seconds'][0]
    checks.true(found['heading'] == OSCILLATOR.splitlines()[1], f'heading: {found["heading"]}')
    checks.true(found['steps'][0]['increments'] == cost['increments'] == 500
                and found['steps'][0]['solves'] == cost['solves'], 'counts')
    checks.true(found['seconds']['elapsed'] == elapsed, 'numbers with all their digits')
    checks.true(found['output'] == str(FOLDER / 'fine.h5') and Path(found['log']).is_file()
                and found['ending'] == 'completed' and found['error'] is None, 'names, ending')
    phases = sum(value for name, value in found['seconds'].items()
                 if name not in ('elapsed', 'processor'))
    checks.close(phases, elapsed, 1e-9, 'phases add up')
    found = run_json(checks, 'check', deck)
    checks.true(found['steps'][0]['equations'] == 1 and found['steps'][0]['increments'] == 500
                and found['memory']['estimate'] > 1e6 and found['features']['items']
                and found['steps'][0]['critical_step'] is None, 'check: steps, memory, features')
    error = run_json(checks, 'run', deck, status=3)['error']
    checks.true('exists' in error['cause'] and '--overwrite' in error['cure']
                and error['file'] is None, f'results that exist: {error["cause"]}')
    bad = write('b\u00e4d"x', OSCILLATOR.replace('body, wall', 'body, wal'))
    bad_line = bad.read_text().splitlines().index('body, wal') + 1
    for word in ('run', 'check'):
        error = run_json(checks, word, bad, status=2)['error']
        checks.true(error['file'] == str(bad) and error['line'] == bad_line
                    and error['cause'] == 'no such surface: WAL' and 'WALL' in error['cure'],
                    f'{word}: {error["file"]}, {error["line"]}, {error["cause"]}')
    error = run_json(checks, 'run', status=1)['error']
    checks.true(error['message'] == 'no deck given', 'usage: without the help')
    error = run_json(checks, 'check', deck, '--thread', status=1)['error']
    checks.true('--thread' in error['cause'], f'usage: {error["cause"]}')
    deck = write('ends', OSCILLATOR.replace('*END STEP', '*ENERGY PRINT, LIMIT=1e-30\n*END STEP'))
    found = run_json(checks, 'run', deck, status=4)
    checks.true(found['ending'] == 'failed' and found['steps'][0]['increments'] > 0
                and 'LIMIT' in found['error']['cause'] and found['has_results'],
                'an error in mid-run: what has been done so far')


def check_no_memory(checks):
    """Where the system refuses memory, the object is there too."""
    words = [PROGRAM, 'run', INPUT / 'block/block.inp', '-o', FOLDER / 'none.h5', '--overwrite',
             '--memory', '1T', '--json']
    for megabytes in range(120, 600, 20):
        limit = megabytes*1000000
        done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60,
                              env=ENVIRONMENT,
                              preexec_fn=lambda most=limit: resource.setrlimit(
                                  resource.RLIMIT_AS, (most, most)))
        if 'error: out of memory: ' in done.stderr:
            break
    found = json.loads(done.stdout)
    checks.true(done.returncode == 4 and found['status'] == 4 and 'ulimit' in found['error']['cure']
                and found['error']['cause'] == 'out of memory', f'out of memory at {megabytes} MB')


def main():
    checks = Checks()
    check_no_memory(checks)
    speed = machine_speed()
    check_progress(checks, speed)
    check_terminals(checks, speed)
    check_endings(checks, speed)
    check_steps(checks, speed)
    check_warnings(checks)
    check_summary(checks)
    check_json(checks)
    checks.finish()


main()
