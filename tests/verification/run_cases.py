"""Every deck of input/ to its end, in the build with run-time checks: completed, and all numbers finite.

What the numbers must be the verification scripts say; this finds what the checks of the language find.
"""
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from carom_case import INPUT, Checks, run_deck

NO_NUMBER_MEANT = ('CDIS',)      # NaN where no partner is near


def numbers(run):
    """Names and values of all columns that must be finite."""
    for group in ('history', 'energy', 'events', 'frequency'):
        found = []
        if group in run.file:
            run.file[group].visititems(lambda name, item: found.append((name, item)))
        for name, item in found:
            if getattr(item, 'dtype', np.dtype('S')).kind in 'fi' \
                    and not name.endswith(NO_NUMBER_MEANT):
                yield f'{group}/{name}', item[()]


def run_case(path):
    """The run of a deck, and the columns that are not finite."""
    run = run_deck(path)
    bad = [name for name, values in numbers(run) if not np.all(np.isfinite(values))]
    return path, run, bad


checks = Checks()
decks = sorted(INPUT.glob('*/*.inp'))
checks.true(len(decks) >= 40, f'{len(decks)} decks found')
with ThreadPoolExecutor(int(sys.argv[2]) if len(sys.argv) > 2 else 1) as pool:
    for path, run, bad in pool.map(run_case, decks):
        name = path.relative_to(INPUT)
        checks.true(run.status == 0 and run.file is not None, f'{name}: status {run.status}')
        checks.true(not bad, f'{name}: finite, but for {bad}' if bad else f'{name}: finite')
        rows = len(run['history/time']) if 'history/time' in run.file else 0
        checks.true(rows > 1 or 'frequency' in run.file, f'{name}: {rows} rows of history')
checks.finish()
