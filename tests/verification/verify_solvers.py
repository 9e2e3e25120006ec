"""Every solver finds the same motion: a static body, plasticity, impacts of implicit bodies, implicit
and explicit elements side by side. SOLVER=MUMPS is skipped where it is not built in."""
import re

import h5py
import numpy as np

from carom_case import INPUT, Checks, run_deck
from solid_mesh import Mesh, material, node_set, step

# of the largest value of a quantity: what the order of the operations may change; where Newton's
# method stops at residuals of 1e-10, so much is left of the stresses, too
ROUND_OFF = 1e-10
NEWTON = 1e-9
DECKS = {
    'thick_cylinder/elastic_cpe8.inp': {},
    'thick_cylinder/plastic_cax4.inp': {},
    'pounding_frame/frames.inp': {'end': 0.5},
    'elastic_strip/q8.inp': {'dt': 0.01},
    'dropped_disc/q8.inp': {'dt': 0.01, 'end': 1.0},
    'bar/bar_mixed.inp': {},
}


def with_solver(text, folder, solver):
    """The deck with SOLVER on its procedure cards; includes are found from anywhere."""
    text = re.sub(r'(?mi)^(\*(?:STATIC|DYNAMIC)[^\n]*)', rf'\1, SOLVER={solver}', text)
    return re.sub(r'(?mi)^(\*INCLUDE, *INPUT=)', lambda found: found.group(1) + f'{folder}/', text)


def fields(run):
    """All real data of a result but what it has cost, by name."""
    found = {}

    def take(name, item):
        if name.startswith('cost/'):
            return
        if isinstance(item, h5py.Dataset) and item.dtype.kind == 'f' and item.size:
            found[name] = item[...]
    run.file.visititems(take)
    return found


def quantity(name):
    """What a dataset holds, whatever the direction or the place: U of U1, energy of energy/strain."""
    if name.startswith('energy/') and not name.endswith('time'):
        return 'energy'
    return re.sub(r'(_before|_after|\d)$', '', name.split('/')[-1])


def size_of(data):
    """The largest absolute value of those that there are."""
    return np.max(np.abs(data[~np.isnan(data)]), initial=0.0)


def difference(one, other):
    """The largest difference of two results, relative to the largest value of that quantity; infinite where
    they do not have the same columns, or no value (NaN) in other places."""
    one, other = fields(one), fields(other)
    if one.keys() != other.keys() or any(data.shape != other[name].shape for name, data in one.items()):
        return np.inf
    if any((np.isnan(data) != np.isnan(other[name])).any() for name, data in one.items()):
        return np.inf
    largest = {}
    for name, data in one.items():
        largest[quantity(name)] = max(largest.get(quantity(name), 0.0), size_of(data))
    return np.max([size_of(data - other[name]) / (largest[quantity(name)] or 1.0)
                   for name, data in one.items()])


def block(n, card, loose=False):
    """A square block of n by n quadratic elements held on the left and pulled on the right."""
    mesh = Mesh(n, n, 8)
    text = mesh.text('CPE8') + node_set('held', mesh.at(s=0)) + node_set('pulled', mesh.at(s=1))
    text += material(200.0, 0.3, thickness=1.0)
    if not loose:
        text += '*BOUNDARY\nheld, 1, 2\n'
    lines = {'STATIC': '1, 1', 'DYNAMIC': '0.01, 4', 'FREQUENCY': '3'}
    load = '' if card.startswith('FREQ') else '*CLOAD\npulled, 2, 0.001\n'
    return text + step(card, lines[card.split(',')[0]], load, '*NODE FILE, FREQUENCY=1000\nU\n')


def compare(checks, solvers):
    """The same results from all solvers on all decks."""
    for deck, definitions in DECKS.items():
        text, folder = (INPUT / deck).read_text(), (INPUT / deck).parent
        runs = {solver: run_deck(with_solver(text, folder, solver), **definitions)
                for solver in solvers}
        for solver in solvers[1:]:
            limit = NEWTON if 'plastic' in deck else ROUND_OFF
            checks.at_most(difference(runs['SKYLINE'], runs[solver]), limit,
                           f'{deck}: SKYLINE and {solver} differ by')


def check_choice(checks, built):
    """What AUTO says of its choice, and what it leaves alone."""
    for n, card, chosen in ((4, 'STATIC, DIRECT', 'skyline'),
                            (60, 'DYNAMIC, DIRECT', 'MUMPS' if built else 'skyline')):
        text = run_deck(block(n, card), command='check').text
        checks.true(f'SOLVER=AUTO: {chosen}' in text, f'{n} x {n} elements: AUTO takes {chosen}')
    checks.true(built == ('not built in' not in text), 'AUTO says if MUMPS is missing')
    text = run_deck(block(4, 'STATIC, DIRECT, SOLVER=SKYLINE'), command='check').text
    checks.true('SOLVER=' not in text, 'SOLVER=SKYLINE needs no reason')
    run_deck(block(2, 'FREQUENCY, SOLVER=SKYLINE'))


def check_loose(checks):
    """What can move is named by each solver; both may name another freedom of the body."""
    for solver in ('SKYLINE', 'MUMPS'):
        text = run_deck(block(4, f'STATIC, DIRECT, SOLVER={solver}', loose=True), expect_status=4).text
        checks.true(re.search(r'singular system: node \d+, freedom [12] can move', text) is not None,
                    f'{solver} names what can move')


def check_missing(checks):
    """Without MUMPS it is an error to ask for it."""
    text = run_deck(block(2, 'STATIC, DIRECT, SOLVER=MUMPS'), expect_status=2).text
    checks.true('built without MUMPS' in text and 'cure:' in text, 'MUMPS is missing, and said to be')


def main():
    checks = Checks()
    built = 'not built in' not in run_deck(block(60, 'DYNAMIC, DIRECT'), command='check').text
    check_choice(checks, built)
    if built:
        compare(checks, ['SKYLINE', 'AUTO', 'MUMPS'])
        check_loose(checks)
    else:
        checks.skip('MUMPS, which is not built in', installed=True)
        compare(checks, ['SKYLINE', 'AUTO'])
        check_missing(checks)
    checks.finish()


if __name__ == '__main__':
    main()
