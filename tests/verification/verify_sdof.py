"""One mass on a spring in front of a wall, transformation method, against the exact solution.

m = k = 1, from d = 1 at rest, wall at -0.5 (input/sdof/sdof.inp). Between impacts the motion is
harmonic with omega = 1; an impact turns the velocity v into -e v.
"""
import numpy as np

from carom_case import INPUT, Checks, run_deck
from exact_solutions import oscillator

DECK = INPUT / 'sdof' / 'sdof.inp'
STEPS = (0.08, 0.04, 0.02, 0.01)
END = 20.0


def deck(beta='1/6', restitution=True):
    """The deck with another beta in the impact step, or without a restitution coefficient."""
    text = DECK.read_text().replace('BETA=1/6', f'BETA={beta}')
    return text if restitution else text.replace(' RESTITUTION=<e>,', '')


def error_of(run, exact):
    """Largest displacement error over all increments."""
    return np.max(np.abs(run['history/node_1/U1'] - exact.at(run['history/time'])[0]))


def order(steps, errors):
    """Exponent of the step in the error, fitted through all of them."""
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


def check_elastic(checks):
    exact = oscillator(END)
    limits = (1.1e-2, 2.7e-3, 6.6e-4, 1.7e-4)
    energies = (2.4e-5, 4.2e-6, 4.9e-7, 1.2e-7)
    errors = []
    for h, limit, energy in zip(STEPS, limits, energies):
        run = run_deck(deck(), e=1, dt=h, end=END)
        errors.append(error_of(run, exact))
        checks.at_most(errors[-1], limit, f'e = 1, h = {h}: displacement error to t = 20')
        times = run.events()['time']
        checks.true(len(times) == 5, f'e = 1, h = {h}: {len(times)} impacts')
        late = np.max((times - exact.impact_times) / exact.impact_times)
        # the trapezoidal rule lengthens the period by (omega h)^2 / 12
        checks.close(late, h**2 / 12.0, 0.1 * h**2 / 12.0, f'e = 1, h = {h}: lateness of impacts')
        total = run['energy/total']
        change = np.max(np.abs(total - total[0])) / total[0]
        checks.close(change, energy, 0.1 * energy, f'e = 1, h = {h}: energy error {change:.3g}')
        checks.close(run['energy/balance_error'], total - total[0], 1e-14,
                     f'e = 1, h = {h}: balance error says so')
    checks.at_least(order(STEPS, errors), 1.95, 'e = 1: order of the displacement error')


def check_restitution(checks):
    exact = oscillator(END, restitution=0.6)
    errors, late, speeds = [], [], []
    for h in STEPS:
        run = run_deck(deck(), e=0.6, dt=h, end=END)
        errors.append(error_of(run, exact))
        events = run.events()
        k = np.arange(1, len(events['time']) + 1)
        checks.close(len(k), 4, 0, f'e = 0.6, h = {h}: number of impacts')
        late.append(np.max(np.abs(events['time'] - exact.impact_times)))
        speeds.append(np.max(np.abs(events['gap_rate_after'] - 0.6**k * np.sqrt(0.75))))
        checks.close(events['gap_rate_after'], -0.6 * events['gap_rate_before'], 1e-15,
                     f'e = 0.6, h = {h}: rebound speeds over approach speeds')
        if h == 0.04:
            checks.close(run['history/node_1/U1'][-1], 0.46642692788, 1e-10,
                         'e = 0.6, h = 0.04: d(20)')
    checks.at_least(order(STEPS, errors), 1.95, f'e = 0.6: order of the error {errors[-1]:.3g}')
    checks.at_least(order(STEPS, late), 1.95, f'e = 0.6: order of the impact times {late[-1]:.3g}')
    checks.at_least(order(STEPS, speeds), 1.9, f'e = 0.6: order of the speeds {speeds[-1]:.3g}')
    run = run_deck(deck(), e=0.6, dt=0.001, end=END)
    checks.close(run['history/node_1/U1'][-1], 0.46698858280, 1e-10, 'e = 0.6, h = 0.001: d(20)')
    checks.close(run.events()['time'],
                 [2.0943951023932, 6.7683130553706, 11.936403346617606, 17.503585554736194],
                 1.1 * 17.5e-6 / 12.0, 'e = 0.6, h = 0.001: impact times')
    k = np.arange(1, 5)
    checks.close(run.events()['gap_rate_after'], 0.6**k * np.sqrt(0.75), 1e-6,
                 'e = 0.6, h = 0.001: velocity after the k-th impact')


def check_plastic(checks):
    """After an impact with e = 0 at -0.5 the spring pulls the mass off at once."""
    exact = oscillator(END, restitution=0.0)
    for name, text in (('e = 0', deck()), ('e absent', deck(restitution=False))):
        errors = []
        for h in STEPS:
            run = run_deck(text, e=0, dt=h, end=END)
            errors.append(error_of(run, exact))
            checks.true(len(run.events()['time']) == 1, f'{name}, h = {h}: one impact')
            checks.at_least(np.min(run['history/node_1/U1']), -0.5 - 1e-12,
                            f'{name}, h = {h}: smallest displacement')
            checks.close(run['energy/impact_loss'][-1], 0.375, 0.5 * h**2,
                         f'{name}, h = {h}: energy taken by the impact')
        checks.at_least(order(STEPS, errors), 1.95, f'{name}: order of the error {errors[-1]:.3g}')


def check_ten_thousand(checks):
    """At h = 0.25 an impact comes every 4 pi / 3: 42 300 time units hold over 10 000 of them."""
    run = run_deck(deck(beta='1/4'), e=1, dt=0.25, end=42300)
    total = run['energy/total']
    n = len(run.events()['time'])
    checks.at_least(n, 10001, 'beta = 1/4: impacts')
    checks.at_most(np.max(np.abs(total / total[0] - 1.0)), 1e-12,
                   f'beta = 1/4: energy error over {n} impacts')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])), 1e-12, 'beta = 1/4: balance error')


checks = Checks()
check_elastic(checks)
check_restitution(checks)
check_plastic(checks)
check_ten_thousand(checks)
checks.finish()
