"""The number of threads changes no bit of a run, explicit or implicit, however large the model."""
import os

import h5py
import numpy as np

from carom_case import INPUT, Checks, run_deck
from bench_decks import explicit_block, implicit_block   # from scripts, where carom_case looks

REQUESTS = '*NODE FILE, FREQUENCY=5\nU, V\n'


def values(run):
    """Every array of numbers of the results but times."""
    found = {}

    def take(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind in 'fiu' and 'seconds' not in name:
            found[name] = item[()]

    run.file.visititems(take)
    return found


def check_threads(checks, name, deck):
    runs = []
    for threads in ('1', '2', '3'):
        os.environ['OMP_NUM_THREADS'] = threads
        runs.append(values(run_deck(deck)))
    moved = max(np.nanmax(np.abs(data)) for name, data in runs[0].items() if name.endswith('/PointData/V'))
    checks.at_least(moved, 0.1, f'{name}: it moves')
    for threads, run in zip((2, 3), runs[1:]):
        same = run.keys() == runs[0].keys() and all(
            data.tobytes() == runs[0][name].tobytes() for name, data in run.items())
        checks.true(same, f'{name}: every bit with {threads} threads as with one')


checks = Checks()
for plastic in (False, True):
    kind = 'plastic' if plastic else 'elastic'
    check_threads(checks, f'explicit, {kind}', explicit_block(80, plastic, REQUESTS))
check_threads(checks, 'implicit, 9600 equations',
              implicit_block(40).replace('*END STEP', REQUESTS + '*END STEP'))
check_threads(checks, 'implicit, contact', INPUT / 'dropped_disc' / 'q8.inp')
checks.finish()
