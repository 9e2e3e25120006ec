"""More memory than there is is refused before it is taken, with the figure and the cure; where it is
taken all the same, as when the system has lied, the program ends with a message and its own status."""
import os
import re
import resource
import subprocess
import sys

from carom_case import INPUT, Checks, scratch_folder
from square_deck import rectangle

# One thread, so that the libraries take few addresses
ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1')
STATUS_MEMORY = 4
MEGABYTE = 1000000
# OpenBLAS with a thread of its own beside the one that calls it, as on a machine of two cores
POOL = {name: value for name, value in os.environ.items() if not name.endswith('_NUM_THREADS')}
POOL['OPENBLAS_NUM_THREADS'] = '2'
# What OpenBLAS takes of the address space, and a little more
WORK_SPACE = 140 * MEGABYTE


def carom(*words, addresses=None, environment=None):
    """Status, output and error text of a command, with so many bytes of addresses."""
    limit = None
    if addresses is not None:
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (int(addresses), int(addresses)))
    done = subprocess.run([sys.argv[1], *map(str, words)], capture_output=True, text=True,
                          env=environment or ENVIRONMENT, preexec_fn=limit, timeout=60)
    return done.returncode, done.stdout, done.stderr


def figure(pattern, text):
    """The number of megabytes in a text, not a number where there is none."""
    found = re.search(pattern, text)
    return float(found.group(1)) if found else float('nan')


def check_refusal(checks, name, words, folder):
    """--memory below the need is refused with the figure that `check` states, of more is enough."""
    status, text, _ = carom('check', *words)
    need = figure(r'(?m)^memory: (\S+) MB', text)
    too_little = f'{int(900 * need)}K'
    checks.true(status == 0 and re.search(r'(?m)^memory limit: \S+ MB \(', text),
                f'{name}: check states need and limit')
    for command, more in (('run', ['-o', folder / 'refused.h5']), ('check', [])):
        status, _, text = carom(command, *words, *more, '--memory', too_little)
        checks.true(status == STATUS_MEMORY, f'{name}: {command} with 9/10 of the need is refused')
        checks.close(figure(r'error: the run takes (\S+) MB \(model', text) / need, 1.0, 0.02,
                     f'{name}: the figure of the refused {command} over that of check')
        checks.close(figure(r'more than the limit of (\S+) MB \(--memory\)', text) / need,
                     0.9, 0.02, f'{name}: the limit that {command} names')
        checks.true('\n  cure: fewer elements' in text and '--memory SIZE' in text,
                    f'{name}: {command} names the cure')
    checks.true(not list(folder.glob('refused*')), f'{name}: the refused run leaves no file')
    status, _, text = carom('run', *words, '-o', folder / 'enough.h5', '--quiet', '--overwrite',
                            '--memory', f'{int(1100 * need)}K')
    checks.true(status == 0 and not text, f'{name}: a tenth more than the need is enough')
    return need * MEGABYTE


def check_addresses(checks, name, words, need, floor, folder):
    """Under limits of the address space, from what loads the program to plenty, every run ends with
    a status of the program; with and without its own estimate before."""
    ends, texts = [], []
    low, high = floor + WORK_SPACE, floor + WORK_SPACE + 1.3 * need
    limits = [floor, 0.5 * (floor + low), *(low + (high - low) * k / 10 for k in range(11))]
    for more in ([], ['--memory', '1T']):
        for limit in limits:
            status, _, text = carom('run', *words, '-o', folder / 'limited.h5', '--quiet',
                                    '--overwrite', *more, addresses=limit)
            good = status == 0 and not text
            good = good or (status == STATUS_MEMORY and text.startswith('error: ')
                            and '\n  cure: ' in text and 'acktrace' not in text)
            if not good:
                checks.true(False, f'{name}: {limit / MEGABYTE:.0f} MB of addresses {more}: '
                                   f'status {status}: {text[:300]!r}')
            ends.append(good)
            texts.append(text)
    checks.true(all(ends), f'{name}: {len(ends)} runs with too few addresses or enough end in order')
    n = len(limits)
    checks.true(any('more than the limit of' in text and 'ulimit -v' in text for text in texts[:n])
                and not any('out of memory' in text for text in texts[:n]),
                f'{name}: the estimate refuses before memory is asked for in vain')
    checks.true(any('error: out of memory: ' in text for text in texts[n:]),
                f'{name}: without it the allocations do')
    checks.true(not texts[n - 1] and not texts[-1], f'{name}: the largest limit is enough')


def find_floor():
    """Bytes of addresses with which the program is loaded at all."""
    floor = 40 * MEGABYTE
    while carom('--version', addresses=floor)[0] != 0:
        floor += 10 * MEGABYTE
    return floor + 10 * MEGABYTE


def check_threads_of_libraries(checks, floor, folder):
    """Where OpenBLAS makes threads as it is loaded every command ends under every limit of addresses,
    and what is enough for one thread is enough; `check` says so too."""
    deck = INPUT / 'sdof' / 'sdof.inp'
    enough = floor + WORK_SPACE + 60 * MEGABYTE
    ends = []
    for limit in (*(floor + k * (enough - floor) / 4 for k in range(4)), *3 * [enough], 1.5 * enough):
        for words in (['run', deck, '-o', folder / 'threads.h5', '--quiet', '--overwrite'], ['check', deck],
                      ['--version']):
            what = f'{limit / MEGABYTE:.0f} MB of addresses, OpenBLAS with threads: {words[0]}'
            try:
                status, said, text = carom(*words, addresses=limit, environment=POOL)
            except subprocess.TimeoutExpired:
                checks.true(False, f'{what} hangs')
                return
            good = status == 0 and not text and 'refused' not in said
            refused = (status == STATUS_MEMORY and text.startswith('error: ') and '\n  cure: ' in text
                       or words[0] == 'check' and status == 0 and 'would be refused here' in said)
            ends.append(good or refused and limit < enough)
            if not ends[-1]:
                checks.true(False, f'{what}: status {status}: {(said + text)[-300:]!r}')
    checks.true(all(ends), f'{len(ends)} commands end in order where OpenBLAS has threads')


def check_early_stages(checks, deck):
    """Reading a deck and building its model are refused before they are begun."""
    status, _, text = carom('run', deck, '--memory', '6M')
    checks.true(status == STATUS_MEMORY and 'error: to read ' in text, 'reading the deck is refused')
    enough = float(re.search(r' takes ([\d.]+) MB', text)[1])
    status, _, text = carom('run', deck, '--memory', f'{1.1 * enough:.1f}M')
    checks.true(status == STATUS_MEMORY and 'error: to build a model of 25921 nodes takes' in text,
                'building the model is refused')


def check_counts(checks, folder):
    """A few lines that ask for very much are refused, not begun."""
    text = (INPUT / 'sdof' / 'sdof.inp').read_text()
    square = rectangle(70, 'CPE4', '', []).split('*STEP')[0]
    cases = {
        'a set of 2e9 nodes': (2, 'no such node: 2', text.replace(
            '*MASS,', '*NSET, NSET=all, GENERATE\n1, 2000000000\n*MASS,')),
        '1e12 increments': (2, 'too many steps', text.replace('dt = 0.04', 'dt = 2e-11')),
        '2e9 modes': (STATUS_MEMORY, 'error: the run takes', square
                      + '*STEP\n*FREQUENCY\n2000000000\n*END STEP\n')}
    deck = folder / 'counts.inp'
    for name, (expected, words, deck_text) in cases.items():
        deck.write_text(deck_text)
        status, _, said = carom('run', deck, '-o', folder / 'counts.h5', '--quiet',
                                addresses=600 * MEGABYTE)
        checks.true(status == expected and words in said, f'{name}: status {status}, {words!r}')
    deck.write_text(text.replace('\n1, 0, 0', '\n2147483647, 0, 0').replace(
        '\n2, 1\n', '\n2147483646, 2147483647\n').replace('TYPE=NODE\n1', 'TYPE=NODE\n2147483647')
        .replace('\n1, 1\n*MASS', '\n1, 2147483647\n*MASS').replace(
            'ELSET=mass\n1, 1', 'ELSET=mass\n1, 2147483647').replace(
                'DISPLACEMENT\n1,', 'DISPLACEMENT\n2147483647,'))
    status, _, said = carom('run', deck, '-o', folder / 'counts.h5', '--quiet',
                            addresses=600 * MEGABYTE)
    checks.true(status == 0, f'ids of 2147483647 need no more than others: {status} {said}')


def main():
    checks = Checks()
    folder = scratch_folder()
    frames = ['*NODE FILE, FREQUENCY=5', 'U, V']
    floor = find_floor()
    decks = {'explicit': rectangle(160, 'CPE4', '*DYNAMIC, DIRECT, EXPLICIT', frames),
             'implicit': rectangle(25, 'CPE8', '*DYNAMIC, DIRECT, SOLVER=SKYLINE', frames),
             'contact': None}
    # so long that the contact has begun
    brief = ['--define', 'end=0.01']
    for name, text in decks.items():
        words = [INPUT / 'block' / 'block.inp', *brief]
        if text:
            words = [folder / f'{name}.inp']
            words[0].write_text(text)
        need = check_refusal(checks, name, words, folder)
        check_addresses(checks, name, words, need, floor, folder)
    check_threads_of_libraries(checks, floor, folder)
    check_early_stages(checks, folder / 'explicit.inp')
    check_counts(checks, folder)
    checks.finish()


main()
