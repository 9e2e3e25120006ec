"""Result files, log, status file and exit status are as the manual has them."""
import os
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

from carom_case import ROOT, Checks, run_deck, scratch_folder, whole

PROGRAM = str(Path(sys.argv[1]).resolve())
HERE = Path(__file__).parent
ENERGIES = ['time', 'kinetic', 'strain', 'damping', 'plastic', 'friction', 'impact_loss',
            'external_work', 'total', 'balance_error']
EVENTS = ['time', 'pair', 'node', 'gap_rate_before', 'gap_rate_after', 'impulse', 'beta', 'kind',
          'solves', 'factorizations']

# a mass on a spring and a short bar, side by side in front of a wall
DECK = """*HEADING
a small deck with everything that can be recorded
*PARAMETER
every = 1
limit = 1
dt = 0.01
*NODE
1, 0, 0
11, 0, 1
12, 1, 1
13, 2, 1
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*ELEMENT, TYPE=SPRING1, ELSET=spring
2, 1
*ELEMENT, TYPE=T2D2, ELSET=bar
3, 11, 12
4, 12, 13
*MASS, ELSET=mass
1
*SPRING, ELSET=spring
1
1
*MATERIAL, NAME=m
*ELASTIC
100, 0
*DENSITY
1
*SOLID SECTION, ELSET=bar, MATERIAL=m
1
*ELEMENT GROUP, ELSET=bar, SCHEME=EXPLICIT, MASS=LUMPED
*SURFACE, NAME=body, TYPE=NODE
1, 11
*RIGID SURFACE, NAME=wall, TYPE=PLANE
-0.5, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, BETA=1/4
*CONTACT PAIR, INTERACTION=hit
body, wall
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, -1
11, 1, -1
12, 1, -1
13, 1, -1
*STEP
*DYNAMIC, DIRECT
<dt>, 2
*NODE PRINT, FREQUENCY=<every>
U, V, A, RF
*EL PRINT, FREQUENCY=<every>
S, E, ENER
*CONTACT PRINT, FREQUENCY=<every>
CF, CDIS
*ENERGY PRINT, FREQUENCY=<every>, LIMIT=<limit>
*NODE FILE, FREQUENCY=<every>
U, V, A, RF
*EL FILE, FREQUENCY=<every>
S, E, ENER
*CONTACT FILE, FREQUENCY=<every>
CF, CDIS
*END STEP
"""

# beta = 1/100 is stable up to h = 1.443 here: at 2 the masses swing against each other until they
# overflow (and no frequency of a single mass is over its limit, which would be an error)
UNSTABLE = """*NODE
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
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
1, 1, 1
*STEP
*DYNAMIC, DIRECT, BETA=0.01
2, 30000
*NODE PRINT
U
*NODE FILE
U
*ENERGY PRINT
*END STEP
"""

SINGULAR = """*NODE
7, 0, 0
8, 1, 0
*ELEMENT, TYPE=SPRING2, ELSET=spring
1, 7, 8
*SPRING, ELSET=spring
1, 1
5
*STEP
*STATIC
1, 1
*CLOAD
8, 1, 1
*NODE PRINT
U
*END STEP
"""


def carom(*words, deck=None):
    """Runs the program in a new folder, with `deck` there as deck.inp; the run and the folder."""
    folder = scratch_folder()
    if deck is not None:
        (folder/'deck.inp').write_text(deck)
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, cwd=folder,
                          timeout=100, env={**os.environ, 'OPENBLAS_NUM_THREADS': '1'})
    return done, folder


def last_line(path):
    return path.read_text().rstrip().splitlines()[-1]


def columns(group):
    """The datasets of a group and below, by name."""
    found = {}
    group.visititems(lambda name, item: found.update({name: item})
                     if isinstance(item, h5py.Dataset) else None)
    return found


def check_tables(checks, file, rows):
    """/history, /energy and /events: their columns, of one length each."""
    history = columns(file['history'])
    checks.true({len(data) for data in history.values()} == {rows},
                f'history: {rows} rows everywhere')
    expected = {'time', *(f'node_{n}/{q}1' for n in (1, 11, 12, 13) for q in ('U', 'V', 'A', 'RF')),
                *(f'element_{n}/{q}' for n in (3, 4) for q in ('S11', 'E11', 'ENER')),
                *(f'contact_BODY-WALL/{q}' for q in ('CF1', 'CF2', 'CF3', 'impulse', 'CNUM', 'CDIS',
                                                  'CSLIP'))}
    checks.true(set(history) == expected, f'history: {len(expected)} columns '
                f'{sorted(set(history) ^ expected)}')
    energy = columns(file['energy'])
    groups = {name for name in energy if name.startswith('group_')}
    checks.true(set(energy) - groups == set(ENERGIES), 'energy: its columns')
    for kind in ('kinetic', 'strain'):
        parts = sum(data[:] for name, data in energy.items()
                    if name in groups and name.endswith(kind))
        checks.close(parts, energy[kind][:], 1e-12 * np.max(energy['total'][:]),
                     f'energy: the groups make up the {kind} energy')
    checks.true({len(data) for data in energy.values()} == {rows},
                f'energy: {rows} rows everywhere')
    events = columns(file['events'])
    checks.true(set(events) == set(EVENTS), 'events: their columns')
    lengths = {len(data) for data in events.values()}
    checks.true(len(lengths) == 1 and min(lengths) > 0, f'events: {lengths} rows')
    checks.true(events['node'].dtype.kind == 'i' and events['kind'].dtype.kind == 'S'
                and events['pair'].dtype.kind == 'S', 'events: types')
    reals = [data for table in (history, energy, events) for data in table.values()
             if data.dtype.kind == 'f']
    checks.true({data.dtype for data in reals} == {np.dtype('f8')}, 'tables: reals of 64 bits')
    checks.true(all(np.isfinite(data[()]).all() for data in reals), 'tables: all finite')
    for name in ('history', 'energy'):
        time = file[name]['time'][()]
        checks.true(time[0] == 0 and (np.diff(time) > 0).all() and abs(time[-1] - 2) < 1e-12,
                    f'{name}: from 0 to 2, rising')
    model = file['model']
    checks.true(b'everything that can be recorded' in model['deck'][()], 'model: holds the deck')
    checks.true({'version', 'n_eq'} <= set(model.attrs) and int(model.attrs['n_eq']) == 4,
                'model: version and equations')
    checks.true(len(model['profile']) == 4 and (model['profile'][()] == 1).all(),
                'model: profile of four explicit or single columns')
    missing = [data.name for data in columns(file).values() if 'description' not in data.attrs]
    checks.true(not missing, f'every dataset has a description {missing}')


def check_grid(checks, file, frames):
    """/VTKHDF by the specification."""
    grid = file['VTKHDF']
    kind = grid.attrs.get_id('Type')
    text = grid.attrs['Type']
    checks.true(bytes(text) == b'UnstructuredGrid' and kind.dtype == np.dtype('S16')
                and kind.get_type().get_cset() == h5py.h5t.CSET_ASCII,
                'Type is the fixed ASCII text UnstructuredGrid')
    checks.true(list(grid.attrs['Version']) == [2, 0], 'Version is 2 0')
    n, m = 4, 4
    for name, value in (('Points', n), ('Cells', m), ('ConnectivityIds', 6)):
        data = grid[f'NumberOf{name}']
        checks.true(data.shape == (1,) and data.dtype.kind == 'i' and data[0] == value,
                    f'NumberOf{name} is {value}')
    checks.true(grid['Types'].dtype == np.uint8 and list(grid['Types']) == [1, 1, 3, 3],
                'Types are unsigned bytes: two vertices, two lines')
    checks.true(list(grid['Offsets']) == [0, 1, 2, 4, 6] and
                list(grid['Connectivity']) == [0, 0, 1, 2, 2, 3], 'Offsets and Connectivity')
    checks.true(grid['Points'].shape == (n, 3) and grid['Points'].dtype.kind == 'f',
                'Points: (n,3) real')
    steps = grid['Steps']
    checks.true(int(steps.attrs['NSteps']) == frames, f'NSteps is {frames}')
    zeros = {'PartOffsets': (frames,), 'PointOffsets': (frames,), 'CellOffsets': (frames, 1),
             'ConnectivityIdOffsets': (frames, 1)}
    for name, shape in zeros.items():
        checks.true(steps[name].shape == shape and not steps[name][()].any(),
                    f'{name}: zeros {shape}')
    parts = steps['NumberOfParts'][()]
    checks.true(parts.shape == (frames,) and (parts == 1).all(), 'NumberOfParts: ones')
    still = {}
    for kind, count in (('Point', n), ('Cell', m)):
        fields = grid[f'{kind}Data']
        for name, data in fields.items():
            begins = steps[f'{kind}DataOffsets/{name}'][()]
            rows = whole(file, f'VTKHDF/{kind}Data/{name}').reshape(frames, -1)
            changes = (rows[1:] != rows[:-1]).any(axis=1)
            checks.true(len(data) == (1 + changes.sum())*count and data.chunks is not None
                        and np.array_equal(begins, count*np.append(0, np.cumsum(changes))),
                        f'{kind}Data/{name}: {1 + changes.sum()} of {frames} frames, chunked, '
                        f'offsets {count} apart where it changes')
            still[name] = not changes.any()
    checks.true(still['RF'] and not still['U'], 'RF, nothing but zeros, is there once')
    checks.true({'U', 'V', 'A', 'RF', 'CF', 'CDIS'} <= set(grid['PointData']),
                'PointData: its fields')
    checks.true({'S', 'E', 'ENER'} <= set(grid['CellData']), 'CellData: its fields')


def check_same(checks, file):
    """Frames and histories of one run agree."""
    history = file['history']
    for i, node in enumerate((1, 11, 12, 13)):
        for name in ('U', 'V', 'A', 'RF'):
            field = whole(file, f'VTKHDF/PointData/{name}').reshape(-1, 4, 3)[:, i, 0]
            if not np.array_equal(field, history[f'node_{node}/{name}1'][()]):
                checks.true(False, f'{name} of node {node} in grid and history')
    stress = whole(file, 'VTKHDF/CellData/S').reshape(-1, 4, 6)[:, 2, 0]
    checks.true(np.array_equal(stress, history['element_3/S11'][()]), 'stress in grid and history')
    force = whole(file, 'VTKHDF/PointData/CF').reshape(-1, 4, 3)[:, :, 0].sum(axis=1)
    checks.close(force, history['contact_BODY-WALL/CF1'][()], 1e-13,
                 'contact force in grid and history')


def check_vtk(checks, path):
    """VTK reads all frames and times."""
    try:
        import vtkmodules  # noqa: F401
    except ImportError:
        checks.true(False, 'the Python package vtk is not installed (pip install -r '
                    'tests/requirements.txt): the result file was not opened with VTK')
        return
    sys.path.insert(0, str(HERE))
    from read_with_vtk import check
    complaints, frames = check(str(path))
    checks.true(not complaints and frames == 201, f'VTK reads {frames} frames {complaints[:3]}')


def check_frequency(checks):
    """FREQUENCY: every n-th increment, the first state and the last."""
    run = run_deck(DECK, every=7)
    expected = np.append(np.arange(0, 200, 7)*0.01, 2.0)
    for name in ('history/time', 'energy/time', 'VTKHDF/Steps/Values'):
        checks.close(run[name], expected, 1e-12, f'FREQUENCY=7: {len(expected)} rows of {name}')
    full = run_deck(DECK)
    chosen = np.append(np.arange(0, 200, 7), 200)
    checks.true(np.array_equal(run['history/node_1/U1'], full['history/node_1/U1'][chosen]),
                'FREQUENCY=7: the same numbers')
    lines = run.path.with_suffix('.sta').read_text().splitlines()
    checks.true(sum(not line.startswith('#') for line in lines) == 200,
                '.sta: a line an increment, whatever FREQUENCY')


def check_command_line(checks):
    """Exit status, what is printed, which files there are."""
    done, folder = carom('run', 'deck.inp', '--quiet', deck=DECK)
    checks.true((done.returncode, done.stdout, done.stderr) == (0, '', ''),
                '--quiet prints nothing')
    files = sorted(path.name for path in folder.iterdir())
    checks.true(files == ['deck.h5', 'deck.inp', 'deck.log', 'deck.sta'],
                f'files beside the deck: {files}')
    checks.true(last_line(folder/'deck.log') == 'completed', 'the log ends with: completed')
    done, _ = carom('run', 'deck.inp', deck=DECK)
    checks.true(done.returncode == 0 and 'completed' in done.stdout,
                'without --quiet the log is shown')
    for words in ((['frobnicate'],), (['run'],), (['run', 'deck.inp', '--define', 'x'],),
                  (['run', 'deck.inp', '--threads', 'many'],), (['run', 'a.inp', 'b.inp'],)):
        done, _ = carom(*words[0], deck=DECK)
        checks.true(done.returncode == 1 and 'usage' in done.stderr,
                    f'carom {" ".join(words[0])}: status 1')
    done, folder = carom('run', 'missing.inp')
    checks.true(done.returncode == 3 and 'missing.inp' in done.stderr
                and not list(folder.iterdir()),
                f'missing deck: status {done.returncode}, no files')
    done, _ = carom('run', 'deck.inp', '-o', 'nowhere/out.h5', deck=DECK)
    checks.true(done.returncode == 3 and 'nowhere' in done.stderr,
                f'folder of the result does not exist: status {done.returncode}')
    done, _ = carom('run', 'deck.inp', '-o', '/proc/out.h5', deck=DECK)
    checks.true(done.returncode == 3, f'result cannot be written: status {done.returncode}')
    done, folder = carom('run', 'deck.inp', deck='*NODES\n1, 0, 0\n')
    checks.true(done.returncode == 2 and not (folder/'deck.h5').exists(),
                f'error in the deck: status {done.returncode}, no result')


def check_stops(checks):
    """Runs that end in trouble: status 4, a reason, and what was good is kept."""
    done, folder = carom('run', 'deck.inp', '--quiet', deck=UNSTABLE)
    checks.true(done.returncode == 4, f'unstable run: status {done.returncode}')
    line = last_line(folder/'deck.log')
    text = (folder/'deck.log').read_text()
    good = re.search(r'last good increment is at (\S+)', text)
    checks.true('stopped: ' in text and good is not None,
                'unstable run: the log says stopped, and the '
                'last good time')
    checks.true(line.startswith('stopped: '), f'unstable run: last line of the log: {line}')
    with h5py.File(folder/'deck.h5') as file:
        u, time = file['history/node_1/U1'][()], file['history/time'][()]
        checks.true(np.isfinite(u).all() and len(u) == len(time) > 100,
                    f'unstable run: {len(u)} good rows can be read, up to {np.abs(u).max():.3g}')
        if good:
            checks.close(time[-1], float(good[1]), 1e-4*time[-1],
                         'unstable run: the last row is the '
                         'last good time')
        frames = file['VTKHDF/Steps'].attrs['NSteps']
        checks.true(frames == len(file['VTKHDF/Steps/Values']) == len(u),
                    f'unstable run: {frames} frames')
    done, folder = carom('run', 'deck.inp', '--quiet', deck=SINGULAR)
    checks.true(done.returncode == 4 and re.search(r'node\s+[78]\b', done.stderr) is not None
                and re.search(r'(freedom|direction|dof)\s+1\b', done.stderr) is not None,
                f'singular system: status {done.returncode}: {" ".join(done.stderr.split())}')
    # explicit elements do not keep the energy exactly
    done, folder = carom('run', 'deck.inp', '--quiet', '--define', 'limit=1e-9', deck=DECK)
    checks.true(done.returncode == 4 and 'LIMIT' in done.stderr,
                f'energy limit: status {done.returncode}: {done.stderr.splitlines()[0]}')
    checks.true(last_line(folder/'deck.log').startswith('stopped: '),
                f'energy limit: last line of the log: {last_line(folder/"deck.log")}')
    with h5py.File(folder/'deck.h5') as file:
        checks.true(len(file['energy/time']) > 0, 'energy limit: results can be read')


def check_check(checks):
    """`carom check`: what a run would do, and no files."""
    done, folder = carom('check', 'deck.inp', deck=DECK)
    text = done.stdout
    checks.true(done.returncode == 0 and [p.name for p in folder.iterdir()] == ['deck.inp'],
                'check: status 0, no files')
    for words in ('4 equations', 'profile 4 entries', 'critical step', '2 contact rows',
                  'explicit'):
        checks.true(words in text, f'check: prints "{words}"')
    step = float(re.search(r'critical step (\S+)', text)[1])
    checks.close(step, 0.1, 1e-6, f'check: critical step {step}')
    done, _ = carom('check', 'deck.inp', deck=SINGULAR)
    checks.true(done.returncode == 0 and '2 equations' in done.stdout and 'the deck is sound' in done.stdout,
                f'check: factorizes nothing, so that a singular system is left to the run: {done.returncode}')


def check_cost(checks):
    """No factorization when every group is explicit, and the status file."""
    deck = (ROOT/'input/bar/bar_explicit.inp').read_text().replace('INPUT=',
                                                                   f'INPUT={ROOT}/input/bar/')
    run = run_deck(deck)
    log = run.path.with_suffix('.log').read_text()
    checks.true(run['cost/factorizations'][0] == 0, 'explicit: no factorization')
    checks.true(log.rstrip().endswith('completed'), 'explicit: the log ends with: completed')
    rows = np.loadtxt(run.path.with_suffix('.sta'), comments='#')
    checks.close(rows[:, 1], np.arange(1, 841), 0.0, '.sta: 840 increments')
    checks.close(rows[:, 3], run['history/time'][1:], 1e-6, '.sta: total times')
    checks.true(rows[:, 6].sum() == len(run['events/time']), '.sta: events')


def main():
    checks = Checks()
    run = run_deck(DECK)
    check_tables(checks, run.file, 201)
    check_grid(checks, run.file, 201)
    check_same(checks, run.file)
    run.file.close()
    check_vtk(checks, run.path)
    check_frequency(checks)
    check_command_line(checks)
    check_stops(checks)
    check_check(checks)
    check_cost(checks)
    checks.finish()


if __name__ == '__main__':
    main()
