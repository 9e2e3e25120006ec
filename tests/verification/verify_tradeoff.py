"""tradeoff.py on small grids: fitted orders, kept points, bad points, farms, and true advice.

The oscillator in front of a wall (input/sdof) to t = 8: the transformation is of second order, the
fictitious force with a coefficient of restitution of first, without one of none.
"""
import contextlib
import csv
import io
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np

from carom_case import INPUT, ROOT, Checks, scratch_folder
import tradeoff as script
from carom_deck import Deck, run_deck
from carom_script import ScriptError
from exact_solutions import masses_in_line, oscillator

CAROM = Path(sys.argv[1]).resolve()
SCRIPT = ROOT / 'scripts' / 'tradeoff.py'
SDOF = INPUT / 'sdof' / 'sdof.inp'
END = 8
GRID = ('--define', 'e=1,0.6', '--define', f'end={END}', '--dt', '0.16:0.00125:8')


def words_of(deck, folder, *options):
    """The words after the script's name."""
    return [str(deck), '--carom', str(CAROM), '-o', str(folder), *options]


def tradeoff(deck, folder, *options):
    """What the script prints, called as a function."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        script.main(words_of(deck, folder, *options))
    return said.getvalue()


def table(folder):
    """The rows of the CSV file as dictionaries."""
    with open(folder / 'tradeoff.csv', newline='') as file:
        return list(csv.DictReader(file))


def fits(folder):
    """Order, verdict and cost by problem, settings and error."""
    with h5py.File(folder / 'tradeoff.h5') as file:
        columns = {name: item[()] for name, item in file['fits'].items()}
    words = {name: [w.decode() for w in columns[name]] for name in ('problem', 'settings', 'verdict',
                                                                     'error')}
    return {key: (order, verdict, cost) for *key, order, verdict, cost in zip(
        words['problem'], words['settings'], words['error'], columns['order'], words['verdict'],
        columns['cost_at_wanted']) for key in [tuple(key)]}


def check_orders(checks, work):
    """Orders, the ratio of costs, and that a second call runs nothing."""
    options = (*GRID, '--method', 'trans,fict', '--restitution', '<e>,none', '--verify')
    said = tradeoff(SDOF, work / 'a', *options)
    checks.true('verified: ' in said, 'the recommendation holds when it is run again')
    found = fits(work / 'a')
    cost = {}
    for e in ('1', '0.6'):
        problem = f'e = {e}, end = {END}'
        exact = (problem, 'METHOD=TRANSFORMATION, RESTITUTION=<e>', 'displacement')
        checks.close(found[exact][0], 2.0, 0.05, f'e = {e}: order of the transformation')
        force = (problem, 'METHOD=FICTITIOUS FORCE, RESTITUTION=<e>', 'displacement')
        checks.close(found[force][0], 1.0, 0.2, f'e = {e}: order of the fictitious force')
        checks.at_least(found[force][2] / found[exact][2], 50.0,
                        f'e = {e}: solutions for 1e-3, fictitious force over transformation')
        cost[e] = found[exact][2]
        without = (problem, 'METHOD=FICTITIOUS FORCE, no RESTITUTION', 'displacement')
        checks.true('no convergence' in found[without][1],
                    f'e = {e}: the fictitious force without restitution: {found[without][1]}')
    rows = table(work / 'a')
    checks.true(len(rows) == 2 * 4 * 8, f'{len(rows)} points')
    before = {path: path.stat().st_mtime_ns for path in (work / 'a/points').glob('*.json')}
    again = tradeoff(SDOF, work / 'a', *options[:-1])
    after = {path: path.stat().st_mtime_ns for path in (work / 'a/points').glob('*.json')}
    checks.true(', 0 of them run now' in again and before == after, 'a second call runs nothing')
    checks.true((work / 'a/tradeoff.png').stat().st_size > 20000, 'there is a picture')
    check_advice(checks, work / 'a', said, rows)


def check_advice(checks, folder, said, rows):
    """The sentence: its step delivers in all problems, the next coarser one of the grid does not."""
    sentence = next(line for line in said.splitlines() if line.startswith('For an error'))
    dt = float(sentence.split('dt = ')[1].split(':')[0])
    deck = folder / 'recommended.inp'
    worst = 0.0
    for e in (1.0, 0.6):
        done = run_deck(CAROM, deck, folder / 'check.h5', {'e': e, 'end': END})
        with h5py.File(folder / 'check.h5') as file:
            t, u = file['history/time'][()], file['history/node_1/U1'][()]
        worst = max(worst, np.max(np.abs(u - oscillator(END, restitution=e).at(t)[0])))
        checks.true(done.good and np.isclose(t[1], dt, rtol=1e-3), f'e = {e}: recommended dt {dt}')
    checks.at_most(worst, 1e-3, 'error of the recommended deck, run by itself')
    own = [row for row in rows if row['settings'] == 'METHOD=TRANSFORMATION, RESTITUTION=<e>']
    coarser = {}
    for row in sorted(own, key=lambda row: -float(row['dt'])):
        if float(row['dt']) > 1.01 * dt:
            coarser[row['problem']] = float(row['displacement'])
    checks.true(len(coarser) == 2, f'there are coarser steps than the recommended one, {dt:g}')
    checks.at_least(max(coarser.values()), 1e-3, 'the next coarser step does not deliver')


def check_bad_points(checks, work):
    """Runs that fail stay in table and picture: a refused deck, and impacts beyond MAX EVENTS."""
    said = tradeoff(SDOF, work / 'b', '--dt', '0.2,0.1', '--events', 'ANCHOR,SUBSTEP', '--alpha',
                    'none,-0.9', '--error', 'displacement')
    states = {(row['settings'], row['state']) for row in table(work / 'b')}
    checks.true({state for _, state in states} == {'good', 'refused'},
                f'a refused deck is shown as such: {sorted({state for _, state in states})}')
    checks.true('refused: ' in said and 'ALPHA' in said, 'the table says why')
    chatter = (
        '*NODE\n1, 0, 0\n*ELEMENT, TYPE=MASS, ELSET=m\n1, 1\n*MASS, ELSET=m\n1\n'
        '*SURFACE, NAME=body, TYPE=NODE\n1\n*RIGID SURFACE, NAME=low, TYPE=PLANE\n-0.01, 0, 0\n'
        '1, 0, 0\n*RIGID SURFACE, NAME=high, TYPE=PLANE\n0.01, 0, 0\n-1, 0, 0\n'
        '*SURFACE INTERACTION, NAME=hit\n*IMPACT, RESTITUTION=1, MAX EVENTS=7\n'
        '*CONTACT PAIR, INTERACTION=hit\nbody, low\nbody, high\n'
        '*INITIAL CONDITIONS, TYPE=VELOCITY\n1, 1, 1\n*STEP\n*DYNAMIC, DIRECT\n0.1, 1\n'
        '*NODE PRINT\nU, V\n*END STEP\n')
    deck = work / 'chatter.inp'
    deck.write_text(chatter)
    tradeoff(deck, work / 'c', '--method', 'trans', '--dt', '0.4,0.1,0.05,0.025')
    states = {float(row['dt']): row['state'] for row in table(work / 'c')}
    checks.true(states == {0.4: 'capped', 0.1: 'good', 0.05: 'good', 0.025: 'good'},
                f'impacts beyond MAX EVENTS are shown: {states}')


def check_farm(checks, work):
    """Commands run one by one, gathered, give what a direct call gives."""
    grid = ('--dt', '0.16,0.08', '--define', 'end=4', '--method', 'trans,fict')
    tradeoff(SDOF, work / 'direct', *grid)
    lines = tradeoff(SDOF, work / 'farm', *grid, '--emit').splitlines()
    checks.true(len(lines) == 4, f'{len(lines)} commands')
    subprocess.run('\n'.join(lines[1:]), shell=True, check=True, capture_output=True)
    tradeoff(SDOF, work / 'farm', *grid, '--collect')
    missing = [row['state'] for row in table(work / 'farm')].count('missing')
    checks.true(missing == 1, 'what has not run yet is shown as missing')
    subprocess.run(lines[0], shell=True, check=True, capture_output=True)
    tradeoff(SDOF, work / 'farm', *grid, '--collect')
    names = ('problem', 'settings', 'dt', 'state', 'displacement', 'solves', 'key')
    direct, farm = ([[row[name] for name in names] for row in table(work / folder)]
                    for folder in ('direct', 'farm'))
    checks.true(direct == farm, 'gathered and direct results are the same')


def check_interrupt(checks, work):
    """Ctrl-C keeps what is done and records nothing that was cut short."""
    words = words_of(SDOF, work / 'stop', '--dt', '0.1:0.00001:12', '--define', 'end=20',
                     '--method', 'trans', '--jobs', '1')
    process = subprocess.Popen([sys.executable, str(SCRIPT), *words], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    deadline = time.time() + 300
    while not list((work / 'stop/points').glob('*.json')) and time.time() < deadline:
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGINT)
    said = process.communicate(timeout=300)[1]
    kept = list((work / 'stop/points').glob('*.json'))
    checks.true(process.returncode == 130 and 'the same command goes on' in said,
                f'interrupted: status {process.returncode}')
    checks.true(0 < len(kept) < 12 and not any('good' not in p.read_text() for p in kept),
                f'{len(kept)} points are kept, all of them whole')


def check_own_reference(checks, work):
    """Errors against the limit of the finest runs are those against the exact solution."""
    grid = ('--dt', '0.16:0.01:5', '--define', f'end={END}', '--method', 'trans')
    tradeoff(SDOF, work / 'known', *grid)
    said = tradeoff(SDOF, work / 'own', *grid, '--exact', 'none', '--verify')
    checks.true('verified: ' in said, 'own reference: the recommendation holds')
    known, own = table(work / 'known'), table(work / 'own')
    for one, other in zip(known, own):
        error, bar = float(other['displacement']), float(other['displacement_bar'])
        checks.at_most(abs(error - float(one['displacement'])), bar + 0.02 * float(one['displacement']),
                       f'dt = {one["dt"][:6]}: own error {error:.3e} ± {bar:.0e} is the true one')
    without = tradeoff(SDOF, work / 'none', '--exact', 'none', '--dt', '0.16:0.01:5', '--define',
                       f'end={END}', '--method', 'fict', '--restitution', 'none')
    checks.true('no convergence seen' in without, 'a series without a limit is said to have none')
    bars = [float(row['displacement_bar']) for row in table(work / 'none')]
    checks.at_least(min(bars), 0.02, 'its spread is the bar')


def check_messages(checks, work):
    """Bad input is answered by a sentence and status 2."""
    for options, words in (
        (('--dt', '0.1:x:3'), 'first:last:count'), (('--method', 'magic'), 'no such method'),
        (('--method', 'penalty'), '--stiffness'), (('--define', 'f=1'), 'no such *PARAMETER'),
        (('--exact', 'moon'), 'no exact solution'), (('--for', '0'), 'above 0'),
        (('--error', 'colour'), 'there are: displacement'), (('--scheme', 'fast,'), 'empty value'),
    ):
        try:
            tradeoff(SDOF, work / 'e', *options)
            said = 'nothing'
        except ScriptError as error:
            said = str(error)
        checks.true(words in said, f'{options}: {said}')
    done = subprocess.run([sys.executable, str(SCRIPT), *words_of(work / 'none.inp', work / 'e')],
                          capture_output=True, text=True, timeout=60)
    checks.true(done.returncode == 2 and done.stderr.startswith('error: cannot read the deck'),
                done.stderr.strip())


def check_cards(checks):
    """Decks come back as they were; edits reach cards of included files."""
    deck = Deck.read(INPUT / 'bar' / 'bar_implicit.inp')
    checks.true(not deck.changed and len(deck.cards('NODE')) == 1, 'included cards are seen')
    deck.set('CONTACT PAIR', SMALL_SLIDING=True)
    deck.set('IMPACT', BETA=None, METHOD='PENALTY', STIFFNESS=1e3)
    deck.set_time_step(0.25)
    text = deck.text()
    checks.true('*CONTACT PAIR, INTERACTION=hit, SMALL SLIDING' in text
                and '*IMPACT, METHOD=PENALTY, STIFFNESS=1000.0\n' in text and '0.25, <end>' in text,
                'parameters and data are replaced')
    checks.true('bar_mesh.inc\n' in text and text.count('bar_model.inc') == 0,
                'files that were edited are written out, others included')
    checks.close(deck.time_step(), [0.25, 1.4], 0.0, 'step and length')
    flights, impulses = masses_in_line(10.0, [1, 1, 1], [1, 1], [1, 0, 0])
    checks.close(flights.at([10.0])[1][:, 0], [0, 0, 1], 0.0, 'equal masses hand the speed on')
    checks.close(impulses, [1, 1], 0.0, 'and the impulse')


def main():
    checks, work = Checks(), scratch_folder()
    check_cards(checks)
    check_orders(checks, work)
    check_bad_points(checks, work)
    check_farm(checks, work)
    check_interrupt(checks, work)
    check_own_reference(checks, work)
    check_messages(checks, work)
    checks.finish()


if __name__ == '__main__':
    main()
