"""Random chains of masses between two walls: they must run, keep apart and keep their energy.

Masses with springs and dashpots at random, gaps between all neighbours (some closed at first),
walls at both ends, restitution from none to 1, sometimes gravity, all kinds of step sizes. The
seeds are fixed. A failing chain prints one line with its number; `random_chains.py carom 17` writes
chain 17 to chain_17.inp.
"""
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'verification'))
from carom_case import Checks, Run                                           # noqa: E402

# Chains 106 and 39 step far above 2 over their highest frequency: paths dip more than once and
# contact forces are bent in a step.
TRANSFORMATION, FICTITIOUS = [*range(80), 106], range(80, 106)
# Chains with so few events a step that many rows are captured by the limit.
LIMITED = [*range(107, 140), 161, 252, 271, 289, 298]
# Chains with ORDER=4; in the first two contact rows depend on each other.
FOURTH_ORDER = [147, 294, *range(400, 430)]
STEPS = 300
# Most that energy may grow in one increment, in parts of the scale.
GAIN = 1e-4


def make_chain(seed):
    """Deck of a chain, and what its energies are measured by: kinetic energy and a weight."""
    rng = np.random.default_rng(seed)
    n = rng.integers(2, 7)
    fictitious = seed in FICTITIOUS
    mass, speed = rng.uniform(0.5, 3, n), rng.normal(size=n)
    restitution = rng.choice(['', ', RESTITUTION=0', ', RESTITUTION=0.3', ', RESTITUTION=0.7',
                              ', RESTITUTION=1'])
    lines = ['*NODE'] + [f'{i + 1}, {i}., 0.' for i in range(n)]
    element = 0

    def add(kind, name, nodes, section):
        nonlocal element
        element += 1
        lines.extend([f'*ELEMENT, TYPE={kind}, ELSET={name}',
                      f'{element}, ' + ', '.join(str(node) for node in nodes), *section])

    for i in range(n):
        add('MASS', f'M{i}', [i + 1], [f'*MASS, ELSET=M{i}', repr(float(mass[i]))])
    for i in range(n):
        if rng.random() < 0.6:
            add('SPRING1', f'G{i}', [i + 1],
                [f'*SPRING, ELSET=G{i}', '1', f'{10**rng.uniform(-1, 3):.4f}'])
        if i + 1 < n and rng.random() < 0.5:
            add('SPRING2', f'S{i}', [i + 1, i + 2],
                [f'*SPRING, ELSET=S{i}', '1, 1', f'{10**rng.uniform(-1, 3):.4f}'])
        if rng.random() < 0.3:
            add('DASHPOT1', f'D{i}', [i + 1],
                [f'*DASHPOT, ELSET=D{i}', '1', f'{10**rng.uniform(-2, 0):.4f}'])
    method = 'FICTITIOUS FORCE' if fictitious else 'TRANSFORMATION, BETA=1/4'
    if seed in FOURTH_ORDER:
        method = 'TRANSFORMATION'
    if seed in LIMITED:
        method += f', MAX EVENTS={1 + seed % 4}'
    lines += ['*SURFACE INTERACTION, NAME=I', f'*IMPACT, METHOD={method}{restitution}']
    for i in range(n - 1):
        add('GAPUNI', f'P{i}', [i + 1, i + 2],
            [f'*GAP, ELSET=P{i}, INTERACTION=I', f'{rng.choice([0, 0.01, 0.1, 0.3])}, 1, 0, 0'])
    left, right = -rng.choice([0, 0.05, 0.2]), n - 1 + rng.choice([0, 0.05, 0.2])
    lines += ['*SURFACE, NAME=A, TYPE=NODE', '1', '*SURFACE, NAME=B, TYPE=NODE', f'{n}',
              '*RIGID SURFACE, NAME=W1, TYPE=PLANE', f'{left}, 0, 0', '1, 0, 0',
              '*RIGID SURFACE, NAME=W2, TYPE=PLANE', f'{right}, 0, 0', '-1, 0, 0',
              '*CONTACT PAIR, INTERACTION=I', 'A, W1', 'B, W2',
              '*INITIAL CONDITIONS, TYPE=VELOCITY']
    lines += [f'{i + 1}, 1, {float(speed[i])!r}' for i in range(n)]
    step = float(f'{10**rng.uniform(-3, -0.7):.4e}')
    lines += ['*STEP', '*DYNAMIC, DIRECT' + ', ORDER=4'*(seed in FOURTH_ORDER),
              f'{step!r}, {STEPS*step!r}']
    weight = 0.0
    if rng.random() < 0.4:
        gravity = rng.uniform(1, 10)
        weight = gravity*mass.sum()
        lines += ['*DLOAD', f', GRAV, {gravity!r}, {rng.choice([-1, 1])}, 0, 0']
    lines += ['*NODE PRINT', 'U, V', '*CONTACT PRINT', 'CF, CDIS', '*ENERGY PRINT', '*END STEP']
    return '\n'.join(lines) + '\n', fictitious, mass @ speed**2/2, weight


def find_faults(seed, folder):
    """What is wrong with a chain, in words; empty if nothing is."""
    deck, fictitious, kinetic, weight = make_chain(seed)
    path, result = folder / f'chain_{seed}.inp', folder / f'chain_{seed}.h5'
    path.write_text(deck)
    words = [sys.argv[1], 'run', str(path), '-o', str(result), '--quiet']
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    except subprocess.TimeoutExpired:
        return ['still running after 60 s']
    if done.returncode:
        return [f'status {done.returncode}: {done.stderr.strip()[:200]}']
    return judge(Run(0, '', result), fictitious, kinetic, weight)


def judge(run, fictitious, kinetic, weight):
    """Checks of a finished chain."""
    faults = []
    contacts = [name for name in run.file['history'] if name.startswith('contact')]
    gaps = np.concatenate([np.ravel(run[f'history/{name}/CDIS']) for name in contacts])
    travel = np.ptp([run[f'history/{name}/U1'] for name in run.file['history']
                     if name.startswith('node')])
    scale = kinetic + weight*travel
    energy = run['energy/total'] + run['energy/damping'] - run['energy/external_work']
    balance = np.abs(run['energy/balance_error']).max()/scale
    if not (np.all(np.isfinite(gaps)) and np.all(np.isfinite(energy))):
        return ['not finite']
    if not balance < 1e-8:
        faults.append(f'energy balance off by {balance:.2e}')
    if fictitious:
        return faults
    if gaps.min() < -1e-9:
        faults.append(f'penetration {gaps.min():.2e}')
    gain = np.diff(energy).max()/scale
    if not gain < GAIN:
        faults.append(f'energy gain {gain:.2e} in one increment')
    return faults


def main():
    """Runs all chains, or writes the deck of one."""
    if len(sys.argv) > 2:
        Path(f'chain_{sys.argv[2]}.inp').write_text(make_chain(int(sys.argv[2]))[0])
        return
    checks = Checks()
    seeds = [*TRANSFORMATION, *FICTITIOUS, *LIMITED, *FOURTH_ORDER]
    with tempfile.TemporaryDirectory(prefix='carom_') as name, ThreadPoolExecutor(2) as pool:
        faults = dict(zip(seeds, pool.map(lambda seed: find_faults(seed, Path(name)), seeds)))
    for seed in seeds:
        if faults[seed]:
            print(f'chain {seed}: {"; ".join(faults[seed])}')
    checks.at_most(sum(bool(faults[seed]) for seed in TRANSFORMATION), 0,
                   f'failing chains of {len(TRANSFORMATION)} by transformation')
    checks.at_most(sum(bool(faults[seed]) for seed in FICTITIOUS), 0,
                   f'failing chains of {len(FICTITIOUS)} by fictitious force')
    checks.at_most(sum(bool(faults[seed]) for seed in LIMITED), 0,
                   f'failing chains of {len(LIMITED)} at MAX EVENTS')
    checks.at_most(sum(bool(faults[seed]) for seed in FOURTH_ORDER), 0,
                   f'failing chains of {len(FOURTH_ORDER)} with ORDER=4')
    checks.finish()


if __name__ == '__main__':
    main()
