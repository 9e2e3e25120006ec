"""How long a hit lasts by `carom check --explain`, against runs: bars of other impedances (density
times wave speed) and lengths, the second free or held at its far end. Times of a wave to and fro, 2 L / c:
1 in the bar that hits, `time` in the other; `ratio` is the other's impedance by that of the first."""
import re
import subprocess
import sys

import numpy as np
from carom_case import Checks, run_deck, scratch_folder

checks = Checks()
N = 50


def bars(ratio, time, held):
    """A deck of two bars, each of unit length, that touch from the start on."""
    lines = ['*NODE', *(f'{1 + i}, {i/N - 1.0!r}, 0.' for i in range(N + 1)),
             *(f'{101 + i}, {0.001 + i/N!r}, 0.' for i in range(N + 1))]
    for name, first, impedance, span in (('A', 1, 1.0, 1.0), ('B', 101, ratio, time)):
        speed = 2.0/span
        lines += [f'*ELEMENT, TYPE=T2D2, ELSET={name}',
                  *(f'{first + i}, {first + i}, {first + i + 1}' for i in range(N)),
                  f'*MATERIAL, NAME={name}\n*ELASTIC\n{impedance*speed!r}, 0.\n*DENSITY\n{impedance/speed!r}',
                  f'*SOLID SECTION, ELSET={name}, MATERIAL={name}\n1.',
                  f'*NSET, NSET={name}, GENERATE\n{first}, {first + N}\n*BOUNDARY\n{name}, 2']
    return '\n'.join([
        *lines, f'*BOUNDARY\n{101 + N}, 1' if held else '**',
        f'*ELEMENT, TYPE=GAPUNI, ELSET=G\n500, {N + 1}, 101',
        '*SURFACE INTERACTION, NAME=I\n*IMPACT\n*GAP, ELSET=G, INTERACTION=I\n0., 1., 0.',
        '*INITIAL CONDITIONS, TYPE=VELOCITY\nA, 1, 0.01',
        f'*STEP, INC=100000\n*DYNAMIC, DIRECT\n{0.5*min(1.0, time)/N!r}, {2.0*max(5.0, time)!r}',
        '*CONTACT PRINT\nCF\n*END STEP\n'])


def explained(deck):
    """What `carom check --explain` says of a deck, as one line."""
    path = scratch_folder() / 'deck.inp'
    path.write_text(deck)
    done = subprocess.run([sys.argv[1], 'check', str(path), '--explain'], capture_output=True, text=True,
                          timeout=60)
    return ' '.join(done.stdout.split())


def measured(run):
    """Time until contact has given 98 % of its impulse, by 0.98."""
    name = next(name for name in run.file['history'] if name != 'time')
    group = run.file['history'][name]
    history = np.asarray(group[next(key for key in group if key.startswith('CF'))])
    impulse = np.cumsum(np.abs(history))
    return run['history/time'][np.searchsorted(impulse, 0.98*impulse[-1])]/0.98


for ratio, time, held in ((1.0, 1.0, False), (10.0, 1.0, False), (0.1, 1.0, False), (1.0, 0.1, False),
                          (10.0, 10.0, False), (0.1, 0.1, False), (0.1, 10.0, False), (10.0, 1.0, True),
                          (0.1, 1.0, True), (0.1, 0.1, True)):
    deck = bars(ratio, time, held)
    text = explained(deck)
    found = re.search(r'a hit lasts about (2 L / c = )?([-.0-9e]+)', text)
    name = f'impedance {ratio}, time {time}, {"held" if held else "free"}'
    checks.true(found, f'{name}: said')
    if not found:
        continue
    said, true = float(found.group(2)), measured(run_deck(deck))
    print(f'{name}: said {said:.4g}, measured {true:.4g}')
    # meshes spread the ends of waves; what swings fades: from the figure on up to about twice as long
    low, high = (0.97, 1.1) if found.group(1) else (0.97, 2.0)
    checks.true(low <= true/said <= high, f'{name}: measured by said {true/said:.3f}, from {low} to {high}')
checks.finish()
