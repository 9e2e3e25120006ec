"""Stability of the program's own steps: scripts/stability.py in its quick form, limits, damping
ratios, what is refused and what is warned of."""
import csv
import subprocess
import sys
from dataclasses import replace

import h5py
import numpy as np

from carom_case import ROOT, Checks, run_deck, scratch_folder
from stability_decks import bouncing, oscillators
from stability_measures import amplification
from stability_theory import SCHEMES, Scheme

CAROM = sys.argv[1]


def check_script(checks):
    """All that the script measures is as theory has it; its files hold the figures."""
    folder = scratch_folder()
    done = subprocess.run([sys.executable, ROOT / 'scripts' / 'stability.py', '--quick', '--carom', CAROM,
                           '-o', folder], capture_output=True, text=True)
    for line in done.stdout.splitlines():
        if line.startswith(('ok', 'FAILED')):
            checks.true(line.startswith('ok'), line.split(maxsplit=1)[1])
    checks.true(done.returncode == 0, f'stability.py --quick ends with status {done.returncode}'
                + done.stderr[-300:])
    with open(folder / 'limits.csv', newline='') as file:
        rows = {row['scheme']: row for row in csv.DictReader(file)}
    for name, limit in (('β = 0 (central differences)', 2.0), ('β = 1/12 (Fox-Goodwin)', 6.0**0.5),
                        ('β = 1/6 (linear acceleration)', 12.0**0.5), ('γ = 0.6, β = 1/4', 20.0**0.5),
                        ('γ = 0.6, β = 0', (2.0 / 0.6)**0.5)):
        for what in ('measured', 'refused_from'):
            checks.close(float(rows[name][what]), limit, 1e-3 * limit, f'{name}: limit {what}')
    for name in ('β = 1/4 (trapezoidal)', 'γ = 0.6, default β', 'HHT α = -0.1', 'HHT α = -0.3'):
        checks.true(rows[name]['measured'] == rows[name]['refused_from'] == 'inf',
                    f'{name}: no limit, nothing refused')
    with h5py.File(folder / 'stability.h5') as file:
        omega, growth = file['recurring/omega'][:], file['recurring/0'][:, 1]
        name = file['recurring/0'].attrs['description']
    checks.true('1/6' in name, f'stability.h5 says what it holds: {name}')
    checks.at_least(growth[omega == 1.0][0], 1e-3,
                    'wall at rest, 1/6 at impacts, 1/4 between: growth of energy an impact at ωh = 1')


def principal(matrix):
    """The eigenvalue of the oscillation."""
    values = np.linalg.eigvals(matrix)
    return max(values, key=lambda value: abs(value.imag))


def damping_ratio(matrix):
    """-ln|λ| / √(ln²|λ| + arg²λ) of the oscillation."""
    rate = np.log(principal(matrix))
    return -rate.real / abs(rate)


def check_damping(checks):
    """Numerical damping is that of the closed-form amplification matrix, and of the textbook."""
    omega = np.array([0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0])
    for scheme in (*(s for s in SCHEMES if s.alpha and not s.explicit),
                   Scheme('γ = 0.6, β = 0.3025', beta=0.3025, gamma=0.6), Scheme('ξ = 0.05', xi=0.05)):
        inside = omega[omega < scheme.limit()]
        matrices = amplification(CAROM, scheme, inside)[1]
        ratios = np.array([damping_ratio(matrix) for matrix in matrices])
        theory = np.array([damping_ratio(scheme.matrix(w)) for w in inside])
        checks.close(ratios, theory, 1e-9, f'{scheme.name}: damping ratios, the largest {ratios.max():.4f}')
        if scheme.name.startswith('γ'):
            checks.close(ratios[:2] / inside[:2], np.full(2, 0.05), 1e-4,
                         f'{scheme.name}: damping ratio over ωh is (γ - 1/2)/2 where ωh is small')
        if scheme.xi:
            checks.close(ratios[0], 0.05, 1e-5, 'a dashpot of 5 % damps by 5 %')


TWO_MASSES = """*PARAMETER
h = 1
*NODE
1, 0, 0
2, 1, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
2, 2
*ELEMENT, TYPE=SPRING2, ELSET=spring
3, 1, 2
*MASS, ELSET=mass
1
*SPRING, ELSET=spring
1
1
*STEP
*DYNAMIC, DIRECT, BETA=1/12
<h>, 100
*END STEP
"""


def check_words(checks):
    """What is certainly over the limit is an error, what may be a warning; the step that works is
    named. The masses swing against each other with ω = √2, each alone would with 1."""
    for h, status, word in ((1.7, 0, None), (1.8, 0, 'warning'), (2.5, 2, 'over the limit')):
        done = run_deck(TWO_MASSES, 'check', status, h=h)
        said = [line for line in done.text.splitlines() if 'limit of beta' in line]
        checks.true(len(said) == (word is not None) and all(word in line for line in said),
                    f'two masses, β = 1/12, h = {h}: status {status}, {said}')
        checks.true(status > 0 or 'stable up to a step of 1.73205' in done.text,
                    f'two masses, β = 1/12, h = {h}: check names the longest step')
        checks.true(word is None or '1.73205' in done.text, f'h = {h}: the step that works is named')
    for omega, warned in ((3.4, False), (3.5, True)):
        done = run_deck(bouncing(omega, 0.0, 10, '1/6'), 'check')
        checks.true(('energy may grow at impacts' in done.text) == warned,
                    f'β = 1/6 at impacts, ωh = {omega}: ' + ('warned of' if warned else 'no warning'))
    table = oscillators(replace(SCHEMES[1]), [4.0], [1.0], [0.0], 2, table=True)
    done = run_deck(table, 'check')
    checks.true('warning' in done.text and 'limit of beta' in done.text,
                'β = 1/6, a spring by a table at ωh = 4: its tangent may be less, so a warning')


checks = Checks()
check_script(checks)
check_damping(checks)
check_words(checks)
checks.finish()
