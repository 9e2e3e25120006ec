"""The order of a deck's cards and lines changes no result beyond round-off.

Every deck of `input/`, and one with several cards of every kind, is run as it is and shuffled
(`card_order.py`). What both give is compared node by node and element by element, by ids, all frames and all
increments; events are compared in their order in time, those of one instant by node.

How far round-off grows is a property of the deck: stiff frames lose digits in their matrix, motions that
part exponentially lose all of them. It is measured, not guessed: where the results of a shuffled deck are off
by more than 1e-11 of their size, the deck runs a third time with its nodes moved by some 1e-16 of their
coordinates, and the order may matter by GROWTH times what that does.
"""
import re
import zlib

import h5py
import numpy as np

from card_order import moved, shuffled
from carom_case import INPUT, Checks, run_deck, scratch_folder, whole
from carom_deck import Deck

SHORTER = {'block/block': 0.0075, 'two_discs/equal': 0.3, 'two_discs/oblique': 0.4,
           'pounding_frame/frames': 0.15, 'crack/slap': 1.0, 'crack/slap_fictitious': 1.0}
ALLOWED = 1e-11
# One push tells the size of the growth, not more: a defect met here grew a million times as far
GROWTH = 1000.0
# Round-off itself, and counts of work done
LEFT_OUT = {'residual', 'solves', 'factorizations', 'beta'}
# Gaps and slips are lengths as displacements are, and may all be round-off
LENGTHS = {'U', 'CDIS', 'CSLIP'}


def quantity(name):
    """What a column or field is: U of `history/node_1/U2`; all energies are one."""
    kind = re.sub(r'\d+$', '', name.rsplit('/', 1)[-1])
    if name.startswith('energy/') and kind != 'time':
        return 'energy'
    if kind.startswith('gap_rate'):
        return 'rate of gaps'
    return 'length' if kind in LENGTHS else f'{name.split("/", maxsplit=1)[0]} {kind}'


def fields_of(file):
    """Frames as (frame, node or element, components), in the order of ids."""
    found = {}
    for group, ids in (('PointData', 'node_id'), ('CellData', 'element_id')):
        order = np.argsort(file[f'model/{ids}'][()])
        for name in file.get(f'VTKHDF/{group}', {}):
            rows = whole(file, f'VTKHDF/{group}/{name}')
            found[f'{group}/{name}'] = rows.reshape(len(rows) // len(order), len(order), -1)[:, order]
    return found


def columns_of(file):
    """All columns of numbers of tables; the groups of elements, which are numbered in the deck's order, sorted."""
    found = {}

    def take(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind in 'fi':
            found[item.name[1:]] = item[()].astype(float)

    for group in ('history', 'energy', 'frequency'):
        if group in file:
            file[group].visititems(take)
    for kind in ('kinetic', 'strain'):
        names = sorted(name for name in found if re.fullmatch(rf'energy/group_\d+/{kind}', name))
        for name, values in zip(names, sorted((found[name] for name in names), key=np.max)):
            found[name] = values
    return found


def events_of(file):
    """Events as columns; those of one instant (to 1e-9 of the run) in the order of kinds, pairs, nodes."""
    if 'events' not in file or not file['events/time'].shape[0]:
        return {}
    events = {name: item[()] for name, item in file['events'].items()}
    instant = np.cumsum(np.diff(events['time'], prepend=0.0) > 1e-9 * events['time'][-1])
    order = np.lexsort((events['node'], events['pair'], events['kind'], instant))
    return {f'events/{name}': values[order] for name, values in events.items()}


def results_of(run):
    """Everything that is compared, by name."""
    found = {**fields_of(run.file), **columns_of(run.file), **events_of(run.file)}
    return {name: values for name, values in found.items() if name.rsplit('/', 1)[-1] not in LEFT_OUT}


def error_of(one, other, size):
    """Largest difference of two arrays over the size of the quantity; shapes and words must be the same."""
    if one.shape != other.shape:
        return np.inf
    if one.dtype.kind == 'S':
        return 0.0 if np.array_equal(one, other) else np.inf
    if not np.array_equal(np.isnan(one), np.isnan(other)):
        return np.inf
    return float(np.nanmax(np.abs(one - other), initial=0.0)) / size if one.size else 0.0


def errors(one, other):
    """The largest error of each quantity; infinite where something is missing or has another shape."""
    sizes, found = {}, {}
    for name, values in one.items():
        if values.dtype.kind != 'S':
            what = quantity(name)
            sizes[what] = max(sizes.get(what, 0.0), float(np.nanmax(np.abs(values), initial=0.0)))
    for name in {*one, *other}:
        what = quantity(name)
        error = np.inf
        if name in one and name in other:
            error = error_of(one[name], other[name], sizes.get(what) or 1.0)
        found[what] = max(found.get(what, 0.0), error)
    return found


def check_deck(checks, name, deck, **definitions):
    """Runs a deck as it is, shuffled, and if that makes a difference with its nodes moved."""
    text = deck.text()
    as_is = results_of(run_deck(text, **definitions))
    other = errors(as_is, results_of(run_deck(shuffled(deck, zlib.crc32(name.encode())), **definitions)))
    worst = max(other, key=other.get)
    if other[worst] <= ALLOWED:
        checks.at_most(other[worst], ALLOWED, f'{name}: {worst}')
        return
    grown = errors(as_is, results_of(run_deck(moved(deck, 1), **definitions)))
    for what in sorted(other):
        if other[what] <= ALLOWED:
            continue
        checks.at_most(other[what], max(ALLOWED, GROWTH * grown.get(what, 0.0)), f'{name}: {what}')


def block(first, name, low, n=3):
    """Nodes, elements and surfaces of a square of n by n elements with its lower left corner at `low`."""
    x, y = low
    node = [[first + i + (n + 1) * j for i in range(n + 1)] for j in range(n + 1)]
    lines = [f'*NODE, NSET={name}']
    lines += [f'{node[j][i]}, {x + i / n!r}, {y + j / n!r}' for j in range(n + 1) for i in range(n + 1)]
    lines += [f'*ELEMENT, TYPE=CPE4, ELSET={name}']
    lines += [f'{first + i + n * j}, {node[j][i]}, {node[j][i + 1]}, {node[j + 1][i + 1]}, {node[j + 1][i]}'
              for j in range(n) for i in range(n)]
    lines += [f'*SURFACE, NAME={name} below', *(f'{first + i}, S1' for i in range(n))]
    lines += [f'*SURFACE, NAME={name} above', *(f'{first + i + n * (n - 1)}, S3' for i in range(n))]
    return '\n'.join(lines)


# Several cards of every kind, several lines in each: two blocks fall on each other and on a wall, a
# chain of masses beside them hits a wall of its own
MANY_CARDS = f"""*HEADING
Several cards of every kind
{block(1, 'lower', (0.0, 0.003))}
{block(101, 'upper', (0.05, 1.01))}
*NODE, NSET=chain
201, 3., 0.
202, 4., 0.
*NODE, NSET=chain
203, 5., 0.
*ELEMENT, TYPE=MASS, ELSET=light
201, 201
202, 202
*ELEMENT, TYPE=MASS, ELSET=heavy
203, 203
*ELEMENT, TYPE=SPRING2, ELSET=springs
211, 201, 202
212, 202, 203
*ELEMENT, TYPE=DASHPOT2, ELSET=dashpots
221, 201, 202
222, 202, 203
*NSET, NSET=ends
201, 203
*NSET, NSET=sides
5, 9
ends
*ELSET, ELSET=blocks
lower, upper
*MASS, ELSET=light
1.
*MASS, ELSET=heavy
2.5
*SPRING, ELSET=springs
1, 1
80.
*DASHPOT, ELSET=dashpots
1, 1
0.2
*MATERIAL, NAME=soft
*ELASTIC
200., 0.3
*DENSITY
1.
*MATERIAL, NAME=stiff
*DENSITY
2.
*DAMPING, BETA=1e-3
*ELASTIC
900., 0.2
*SOLID SECTION, ELSET=lower, MATERIAL=soft
1.
*SOLID SECTION, ELSET=upper, MATERIAL=stiff
0.7
*AMPLITUDE, NAME=rise
0., 0., 0.05, 1., 0.3, 0.5
*AMPLITUDE, NAME=fall, TIME=TOTAL TIME
0., 1., 0.1, 0.2
*SURFACE, NAME=tip, TYPE=NODE
203
*RIGID SURFACE, NAME=floor, TYPE=PLANE
0., 0.
0., 1.
*RIGID SURFACE, NAME=stop, TYPE=PLANE
5.01, 0.
-1., 0.
*SURFACE INTERACTION, NAME=plain
*IMPACT
*SURFACE INTERACTION, NAME=rough
*IMPACT
*FRICTION
0.3
*SURFACE INTERACTION, NAME=bouncing
*IMPACT, RESTITUTION=0.6
*CONTACT PAIR, INTERACTION=rough
lower below, floor
*CONTACT PAIR, INTERACTION=plain
upper below, lower above
*CONTACT PAIR, INTERACTION=bouncing
tip, stop
*EQUATION
2
6, 1, 1., 7, 1, -1.
2
10, 2, 1., 11, 2, -1.
*INITIAL CONDITIONS, TYPE=VELOCITY
upper, 2, -0.4
upper, 1, 0.1
lower, 2, -0.1
*INITIAL CONDITIONS, TYPE=VELOCITY
chain, 1, 0.5
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
201, 1, -0.01
*BOUNDARY
chain, 2
*STEP
*DYNAMIC, DIRECT
1e-3, 0.1
*DLOAD
lower, GRAV, 9.81, 0., -1.
upper, GRAV, 9.81, 0., -1.
*DLOAD, AMPLITUDE=fall
107, P3, 0.3
109, P3, 0.4
*CLOAD, AMPLITUDE=rise
201, 1, 1.5
202, 1, -0.5
*CLOAD
203, 1, 0.25
*NODE PRINT, NSET=sides
U, V
*NODE PRINT, NSET=chain
RF, A
*EL PRINT, ELSET=blocks
S, E
*NODE FILE, FREQUENCY=5
U, V
*EL FILE, FREQUENCY=5
S, ENER
*CONTACT PRINT
CF, CDIS
*CONTACT FILE, FREQUENCY=5
CF, CDIS
*ENERGY PRINT
*END STEP
*STEP
*DYNAMIC, DIRECT
1e-3, 0.05
*CLOAD, OP=NEW
203, 1, -2.
201, 1, -1.
*BOUNDARY, TYPE=VELOCITY
202, 1, 1, 0.1
*END STEP
"""

checks = Checks()
many = scratch_folder() / 'many_cards.inp'
many.write_text(MANY_CARDS)
for seed in range(3):
    check_deck(checks, f'many cards of each kind, order {seed}', Deck.read(many))
for path in sorted(INPUT.glob('*/*.inp')):
    name = f'{path.parent.name}/{path.stem}'
    check_deck(checks, name, Deck.read(path), **({'end': SHORTER[name]} if name in SHORTER else {}))
checks.finish()
