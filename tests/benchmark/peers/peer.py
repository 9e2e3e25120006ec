"""What the peers' scripts share: arguments, the common problems, how figures are handed back."""
import argparse
import importlib
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
for folder in ('scripts', 'input', 'input/block'):
    sys.path.insert(0, str(ROOT / folder))

NOT_INSTALLED = 3


def arguments():
    """--quick, and a folder to work in."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--work', type=Path, default=Path('.'))
    parser.add_argument('--side', type=int, default=0, help='elements a side')
    return parser.parse_args()


def need(name):
    """A module, or the end of the script with the status that says it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        print(error, file=sys.stderr)
        sys.exit(NOT_INSTALLED)


def figure(name, value):
    """Hands a figure back."""
    print(f'figure {name} {value}', flush=True)


def version(package):
    """Hands back the version of a Python package."""
    from importlib import metadata
    figure('version', f'{package} {metadata.version(package)}')


class Clock:
    """Seconds since it was made."""

    def __init__(self):
        self.started = time.perf_counter()

    def __call__(self):
        return time.perf_counter() - self.started


def slope(cost, few, many):
    """Time of one step from the costs of few and of many."""
    low, high = cost(few), cost(many)
    return (high - low) / (many - few)


def oscillator_error(times, displacements):
    """Largest difference to the exact motion of the oscillator in front of its wall."""
    import numpy as np
    from exact_solutions import oscillator
    exact = oscillator(times[-1]).at(times)[0]
    return float(np.abs(np.asarray(displacements) - exact).max())


def penalty_oscillator(module, run, steps):
    """Prints the best of some penalty stiffnesses; `run` gives seconds and error for one of them."""
    quick = arguments().quick
    version(module)
    trials = [1e6] if quick else [2.5e5, 1e6, 4e6]
    seconds, error = min(map(run, trials), key=lambda pair: pair[1])
    figure('seconds', seconds)
    figure('error', error)
    figure('steps', steps)


def block(n):
    """The block of input/block, n by n elements of 8 nodes: points, elements (from 0), face, dt."""
    from make_block import SIDE, wave_speed
    from mesh_tools import rectangle
    body = rectangle(0, 0, SIDE, SIDE, n, n).quadratic()
    face = body.points(lambda x: x[0] < 1e-9 * SIDE)
    return body.x, body.elements, face, SIDE / n / wave_speed()


def plane_wave_force():
    """Force on a wall of unit side that a plane wave brings to rest: density, wave and speed."""
    from make_block import DENSITY, SPEED, wave_speed
    return DENSITY * wave_speed() * SPEED
