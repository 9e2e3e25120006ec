"""Impacts between steps of one size (EVENTS=ANCHOR) against those with sub-steps and exact solutions.

One mass on a spring in front of a wall (input/sdof), an elastic bar against a wall (input/bar) and a
block of 8-node elements (input/block).
"""
import re

import numpy as np

from carom_case import INPUT, Checks, run_deck
from contact_case import Folder
from exact_solutions import oscillator

SDOF = INPUT / 'sdof' / 'sdof.inp'
ANCHOR = 'EVENTS=ANCHOR'
STEPS = (0.08, 0.04, 0.02, 0.01)
END = 20.0


def error_of(run, exact):
    """Largest displacement error over all increments."""
    return np.max(np.abs(run['history/node_1/U1'] - exact.at(run['history/time'])[0]))


def counts(run):
    """Factorizations and solutions of a run."""
    return [int(run[f'cost/{name}'][0]) for name in ('factorizations', 'solves')]


def change(run):
    """Largest change of the total energy, relative."""
    total = run['energy/total']
    return np.max(np.abs(total - total[0])) / total[0]


def check_oscillator(checks):
    anchored = SDOF.read_text().replace('BETA=1/6', ANCHOR)
    exact = oscillator(END)
    errors, ratios = [], []
    for h in STEPS:
        run = run_deck(anchored, e=1, dt=h, end=END)
        errors.append(error_of(run, exact))
        ratios.append(errors[-1] / error_of(run_deck(SDOF, e=1, dt=h, end=END), exact))
        checks.true(len(run.events()['time']) == 5, f'h = {h}: 5 impacts')
        checks.true(run['history/time'][-1] == END, f'h = {h}: the last frame is at {END}')
        checks.close(run['history/time'], h * np.arange(len(run['history/time'])), 1e-12,
                     f'h = {h}: frames at the times of the deck')
        speeds = np.abs(run.events()['gap_rate_before'])
        checks.close(speeds, np.full(5, np.sqrt(0.75)), 0.6 * h**2, f'h = {h}: approach speeds')
        # one solution a step and one for the first acceleration; no more than 3 an impact
        extra = counts(run)[1] - round(END / h) - 2
        checks.at_most(extra / 5, 3.0, f'h = {h}: solutions an impact')
        if h == 0.04:
            checks.at_most(change(run), 1.6e-3, 'h = 0.04: energy error')
            checks.close(errors[-1], 0.0044354798, 1e-9, 'h = 0.04: error as by hand')
    order = np.polyfit(np.log(STEPS), np.log(errors), 1)[0]
    checks.at_least(order, 1.95, 'order of the displacement error')
    checks.at_most(max(ratios), 1.85, 'error over that with sub-steps, all steps')
    checks.close(np.mean(ratios), 1.7, 0.1, 'error over that with sub-steps, on average')


def check_restitution_and_rest(checks):
    """A ball that bounces ever lower comes to rest: capture, and times of impacts."""
    text = (INPUT / 'ball' / 'ball.inp').read_text()
    card = re.search(r'\*IMPACT.*', text).group()
    anchored = text.replace(card, f'{card}, {ANCHOR}')
    sub, run = run_deck(text), run_deck(anchored)
    for kind in ('impact', 'capture', 'release'):
        checks.close(len(run.events(kind)['time']), len(sub.events(kind)['time']), 0,
                     f'ball: number of events, {kind}')
    checks.close(run.events()['time'], sub.events()['time'], 1e-9, 'ball: times of impacts')
    last = [name for name in run.file['history'] if name.startswith('node')][0]
    for name in run.file[f'history/{last}']:
        checks.close(run[f'history/{last}/{name}'], sub[f'history/{last}/{name}'], 1e-9,
                     f'ball: {name} as with sub-steps')


def check_bar(checks):
    """Sustained contact: the exact force is 300 from 0.5 on for 2/3."""
    folder = INPUT / 'bar'
    text = (folder / 'bar_implicit.inp').read_text().replace('INPUT=', f'INPUT={folder}/')
    anchored = text.replace('BETA=1/4', ANCHOR)
    sub, run = run_deck(text), run_deck(anchored)
    checks.true(len(run.events('release')['time']) == 1, 'bar: one release')
    checks.close(run.events('release')['time'], sub.events('release')['time'], 0.0034,
                 'bar: the release within a step of that with sub-steps')
    checks.close(np.sum(run.events()['impulse']), np.sum(sub.events()['impulse']), 1e-9,
                 'bar: impulse of the impact')
    before, after = sub['energy/total'], run['energy/total']
    checks.close(after[-1] / before[-1], 1.0, 5e-3, 'bar: energy after the contact')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])) / after[0], 5e-3,
                   'bar: balance error, of the energy')
    factorizations, solves = counts(run)
    checks.true(factorizations == 1, f'bar: {factorizations} factorization, of the step')
    increments = len(run['energy/time']) - 1
    # two more are the columns of the contact row, on the matrix and on the mass
    checks.at_most(solves - increments - 2 - 2, 3, 'bar: solutions beyond one a step')


def check_block(checks):
    """21 rows that are hit at once and let go one after the other; a consistent mass."""
    folder = Folder('block', 'make_block')
    n = 10
    decks = [folder.make.mesh(n) + folder.make.deck(n, impact).replace('*INCLUDE, INPUT=block.inc\n', '')
             for impact in ('*IMPACT', f'*IMPACT, {ANCHOR}')]
    sub, run = (run_deck(text) for text in decks)
    factorizations, solves = counts(run)
    checks.true(factorizations == 2, f'block: {factorizations} factorizations, of the step and the mass')
    increments = len(run['energy/time']) - 1
    rows = 21
    checks.at_most(solves - increments - 2 * rows - 2, 3, 'block: solutions beyond one a step')
    checks.at_least(counts(sub)[0], 50, 'block: factorizations with sub-steps')
    checks.close(np.sum(run.events()['impulse']), np.sum(sub.events()['impulse']), 1e-3,
                 'block: impulse of the impact')
    checks.close(run['energy/total'][-1] / sub['energy/total'][-1], 1.0, 0.02,
                 'block: energy after the contact')
    touching = [np.ptp(r.events('release')['time']) for r in (run, sub)]
    checks.close(touching[0], touching[1], 2 * run['energy/time'][1], 'block: how long letting go takes')


def check_two_steps(checks):
    """A step of the deck ends between two steps of the run; the next one goes on from there."""
    text = SDOF.read_text().replace('BETA=1/6', ANCHOR)
    step = text[text.index('*STEP'):]
    h = 0.04
    errors = []
    exact = oscillator(END)
    for first in (10.0, 10.01):
        two = text[:text.index('*STEP')] + step.replace('<end>', f'{first}') \
            + step.replace('<end>', f'{END - first}')
        run = run_deck(two, e=1, dt=h)
        errors.append(error_of(run, exact))
        checks.close(run['history/time'][-1], END, 1e-12, f'two steps, the first to {first}: end')
        checks.true(len(run.events()['time']) == 5, f'two steps, the first to {first}: 5 impacts')
    checks.at_most(max(errors), 0.0065, 'two steps: displacement error at h = 0.04')


def check_refusal(checks):
    folder = INPUT / 'elastic_strip'
    text = (folder / 'q4_massless.inp').read_text().replace('INPUT=', f'INPUT={folder}/')
    run = run_deck(text.replace('*IMPACT\n', f'*IMPACT, {ANCHOR}\n'), 'check', expect_status=2)
    checks.true('contact nodes without mass' in run.text, 'contact nodes without mass are refused')


checks = Checks()
check_oscillator(checks)
check_restitution_and_rest(checks)
check_bar(checks)
check_block(checks)
check_two_steps(checks)
check_refusal(checks)
checks.finish()
