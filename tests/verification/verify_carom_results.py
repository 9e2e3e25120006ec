"""scripts/carom_results.py reads what h5py reads, by slices and blocks, says which card is missing, and
reads the file of a run that goes on; conversions to pandas, meshio and pyvista, each with the package
(or with a stand-in) and without it. Plots are looked at by verify_plots.py."""
import importlib.util
import signal
import subprocess
import sys
import time
import types

import h5py
import numpy as np
from carom_case import INPUT, Checks, run_deck, scratch_folder
from result_decks import BARE, STRIP

from carom_results import Result            # noqa: E402  (from scripts, where carom_case looks)
from carom_script import ScriptError        # noqa: E402
from carom_tables import Computed, Table, envelope, minmax, natural_key   # noqa: E402

CHECKS = Checks()


def message(function, *words):
    """The message of the ScriptError that a function ends with; none if it does not."""
    try:
        function(*words)
    except ScriptError as error:
        return str(error)
    return ''


def same(found, expected, sentence):
    """Two arrays are equal to the last bit."""
    CHECKS.true(np.shape(found) == np.shape(expected) and np.array_equal(found, expected), sentence)


def read_columns(run, result):
    """Histories, energies, costs, deck."""
    same(result.time, run['history/time'], 'time')
    same(result.node(3).U1, run['history/node_3/U1'], 'node(3).U1')
    same(result.node(3).time, run['history/time'], 'node(3).time')
    same(result.element(7).S11, run['history/element_7/S11'], 'element(7).S11')
    same(result.contact('front-Wall').CF1, run['history/contact_FRONT-WALL/CF1'], 'contact().CF1')
    same(result.history['node_3/U1'][5:9], run['history/node_3/U1'][5:9], 'rows of a column')
    same(result.energy.kinetic, run['energy/kinetic'], 'energy.kinetic')
    CHECKS.true(result.nodes == [1, 2, 3, 11, 12, 13] and result.elements == [7, 8]
                and result.contacts == ['FRONT-WALL'], 'ids and names, in natural order')
    CHECKS.true(result.node(3).names == ['U1', 'U2', 'V1', 'V2', 'time'], 'names of a node\'s columns')
    CHECKS.true(result.history.select('node_1?/U1, element_7/S11')
                == ['node_11/U1', 'node_12/U1', 'node_13/U1', 'element_7/S11'], 'columns by pattern')
    CHECKS.true(result.cost.solves == run['cost/solves'][0] > 0, 'cost.solves')
    CHECKS.true(result.heading == 'Two elements fly against a wall' == result.title, 'heading')
    CHECKS.true(result.deck.startswith('*HEADING\n') and '*END STEP' in result.deck, 'deck')
    CHECKS.true(result.energy['kinetic'].description == 'kinetic energy', 'description')


def names():
    """Names of any letters and figures are sorted; only 0 to 9 count as numbers."""
    odd = ['node_10/U1', 'gap²/CF1', 'node_2/U1', 'gap①', 'gap٣', 'gap 2', 'node_2/U2']
    found = sorted(odd, key=natural_key)
    CHECKS.true(found.index('node_2/U1') < found.index('node_2/U2') < found.index('node_10/U1'),
                f'in natural order: {found}')


def read_slices(result):
    """Slices, blocks, computed columns, extremes, envelopes."""
    column = result.node(3)['U1']
    whole = np.asarray(column)
    for rows in (slice(3, 20, 4), slice(-5, None), slice(None, None, -1), 7, -1):
        same(column[rows], whole[rows], f'column[{rows}]')
    blocks = list(column.blocks(40))
    CHECKS.true([len(block) for block in blocks] == [40, 40, 21], '101 rows in blocks of 40')
    same(np.concatenate(blocks), whole, 'blocks in order')
    speed = Computed(np.hypot, result.node(3)['V1'], result.node(3)['V2'])
    same(speed[10:30], np.hypot(result.node(3).V1, result.node(3).V2)[10:30], 'computed column')
    low, high = minmax(column, 4)
    CHECKS.true(low.min() == whole.min() and high.max() == whole.max()
                and low[0] == whole[:26].min(), 'extremes of parts')
    time = np.sort(np.random.default_rng(5).random(50000)) ** 3    # rows crowd at the start
    values = np.sin(40 * time) + (time > 0.5)
    values[123] = np.nan
    x, (y,) = envelope(time, [values], 100)
    spans = [values[np.floor((time - time[0]) / (time[-1] - time[0]) * 100).clip(0, 99) == k]
             for k in range(100)]
    same(y.reshape(-1, 4)[:, 1], [np.nanmin(s) for s in spans], 'least of each span')
    same(y.reshape(-1, 4)[:, 2], [np.nanmax(s) for s in spans], 'largest of each span')
    same(y.reshape(-1, 4)[:, [0, 3]], [(s[0], s[-1]) for s in spans], 'first and last of each span')
    CHECKS.true(np.all(np.diff(x) >= 0) and x[0] == time[0] and x[-1] == time[-1], 'their times')
    x, (y,) = envelope(time[:300], [values[:300]], 100)
    CHECKS.true(len(x) == 300 and np.array_equal(y, values[:300], equal_nan=True), 'few rows as they are')


def read_events(run, result):
    """Events as rows and columns."""
    events = result.events
    rows = list(events)
    CHECKS.at_least(len(rows), 2, 'events')
    same([row.impulse for row in rows], run['events/impulse'], 'impulses row by row')
    CHECKS.true(rows[0].kind == 'impact' and rows[0].pair == 'FRONT-WALL', 'kind and pair are text')
    CHECKS.true(events[0] == rows[0] and events[np.int64(-1)] == rows[-1] and events[1:3] == rows[1:3]
                and events[::-1] == rows[::-1], 'events by their numbers')
    try:
        events[len(rows)]
        CHECKS.true(False, 'an event beyond the last')
    except IndexError as error:
        CHECKS.true(f'{len(rows)} events' in str(error), f'an event beyond the last: {error}')
    hits = events.filter(kind='impact', node=1)
    theirs = run.events('impact')
    same(hits.time, theirs['time'][theirs['node'] == 1], 'events of a kind and a node')
    CHECKS.true(len(hits) == len(list(hits)) > 0, 'as many rows as times')


def read_frames(run, result):
    """Frames: a sequence with points, cells and fields."""
    frames, n = result.frames, len(run['VTKHDF/Points'])
    same([frame.time for frame in frames], run['VTKHDF/Steps/Values'], 'times of the frames')
    CHECKS.true(len(frames) == 11 and frames[-1].number == 10 and len(frames[2:5]) == 3, 'a sequence')
    CHECKS.true(frames.at(0.063).number == 3, 'the frame nearest to a time')
    same(frames[4].U, run['VTKHDF/PointData/U'][4 * n:5 * n], 'U of a frame')
    same(frames[4].S, run['VTKHDF/PointData/S'][4 * n:5 * n], 'S is that at the points')
    same(frames[4].cell_data['S'], run['VTKHDF/CellData/S'][12:15], 'S in the cells')
    same(frames[4].points, run['VTKHDF/Points'], 'points')
    CHECKS.true({kind: cells.tolist() for kind, (cells, _) in frames[0].cells.items()}
                == {1: [2], 9: [0, 1]}, 'cells by type')
    CHECKS.true(set(frames[0].names) == {'U', 'V', 'S', 'MISES'}, 'names of the fields')
    CHECKS.true('MISES' in frames[0].point_data and 'X' not in frames[0].cell_data
                and getattr(frames[0], 'X', None) is None, 'what is there and what is not')
    try:
        frames[11]
        CHECKS.true(False, 'an index beyond the last frame')
    except IndexError as error:
        CHECKS.true('11 frames' in str(error), 'an index beyond the last frame')


def without_tables(path):
    """A copy of a result file without histories, frames and deck."""
    other = scratch_folder() / 'empty.h5'
    with h5py.File(other, 'w') as file, h5py.File(path) as whole:
        whole.copy('cost', file)
    return other


def missing(result):
    """What is not there: the message names the card."""
    def says(words, function):
        text = message(function)
        CHECKS.true(all(word in text for word in words), f'"{text}" names {words}')

    says(('node 4', '*NODE PRINT', '1, 2, 3'), lambda: result.node(4))
    says(('A1', 'node 3', '*NODE PRINT', 'U1'), lambda: result.node(3).A1)
    says(('E11', '*EL PRINT'), lambda: result.element(7).E11)
    says(('*CONTACT PRINT', 'FRONT-WALL'), lambda: result.contact('FRONT-BACK'))
    says(('*FREQUENCY',), lambda: result.frequencies)
    says(('CF', '*CONTACT FILE'), lambda: result.frames[0].CF)
    says(('heat', '/energy', 'kinetic'), lambda: result.energy.heat)
    bare = Result(run_deck(BARE).path)
    says(('node 1', '*NODE PRINT'), lambda: bare.node(1))
    says(('*EL PRINT writes it',), lambda: bare.element(1))
    says(('/energy', '*ENERGY PRINT'), lambda: bare.energy)
    CHECKS.true(len(bare.events) == 0 and list(bare.events) == [] and len(bare.events.time) == 0
                and len(bare.events.filter(kind='impact')) == 0 and bare.events[:] == [], 'no events are an empty table')
    CHECKS.true(bare.heading == '' and bare.title == 'result.h5', 'no heading: the name of the file')
    CHECKS.true(bare.nodes == [] and bare.contacts == [], 'nothing recorded: no names')
    empty = Result(without_tables(run_deck(BARE).path))
    says(('/history', '*NODE PRINT'), lambda: empty.time)
    says(('/VTKHDF', '*NODE FILE'), lambda: empty.frames)
    says(('/model/deck',), lambda: empty.deck)
    CHECKS.true(empty.heading == '' and empty.nodes == [], 'a file without deck and history')
    says(('no result file', 'none.h5'), lambda: Result('none.h5'))
    text = scratch_folder() / 'text.h5'
    text.write_text('no HDF5')
    says(('text.h5', 'HDF5'), lambda: Result(text))


def stand_in(name, **classes):
    """A module that keeps what its classes are made with."""
    module = types.ModuleType(name)
    for key in classes:
        setattr(module, key, lambda *words, **named: (words, named))
    return module


def without(name, function):
    """The message where a package is not installed."""
    kept = {key: sys.modules.pop(key) for key in list(sys.modules) if key.split('.')[0] == name}
    sys.modules[name] = None
    text = message(function)
    del sys.modules[name]
    sys.modules.update(kept)
    CHECKS.true(f'pip install {name}' in text, f'without {name}: "{text}"')


class Columns(dict):
    """What is needed here of pandas.DataFrame: columns, all of one length and one dimension."""

    def __init__(self, columns):
        super().__init__({name: np.asarray(values) for name, values in columns.items()})
        shapes = {values.shape for values in self.values()}
        CHECKS.true(len(shapes) == 1 and len(shapes.pop()) == 1, f'a table of {len(self)} columns')

    def set_index(self, name):
        """The table without the column."""
        return Columns({key: values for key, values in self.items() if key != name})


def with_pandas(function):
    """Calls a function with the package or a stand-in for its table."""
    if importlib.util.find_spec('pandas'):
        return function()
    sys.modules['pandas'] = types.ModuleType('pandas')
    sys.modules['pandas'].DataFrame = Columns
    found = function()
    del sys.modules['pandas']
    return found


def tables(result):
    """The tables of a file."""
    same(np.asarray(result.to_pandas('history')['node_3/U1']), result.node(3).U1, 'pandas: history')
    same(np.asarray(result.to_pandas('energy')['total']), result.energy.total, 'pandas: energies')
    same(np.asarray(result.to_pandas('events')['impulse']), result.events.impulse, 'pandas: events')
    same(np.asarray(result.to_pandas('cost')['solves']), [result.cost.solves], 'pandas: cost')
    text = message(result.to_pandas, 'model')
    CHECKS.true('/model is no table' in text and 'array("model/NAME")' in text, f'no table: {text}')
    CHECKS.true('/heat' in message(result.to_pandas, 'heat'), 'a group that is not there')


def convert(result):
    """To pandas, meshio and pyvista."""
    frame = result.frames[4]
    without('pandas', lambda: result.to_pandas('history'))
    without('meshio', frame.to_meshio)
    without('pyvista', frame.to_pyvista)
    if importlib.util.find_spec('pandas'):
        table = result.to_pandas('history')
        same(table['node_3/U1'].to_numpy(), result.node(3).U1, 'pandas: a column')
        same(table.index.to_numpy(), result.time, 'pandas: the index is the time')
    with_pandas(lambda: tables(result))
    real = importlib.util.find_spec('meshio') is not None
    if not real:
        sys.modules['meshio'] = stand_in('meshio', Mesh=None)
        (points, blocks), data = frame.to_meshio()
        del sys.modules['meshio']
    else:
        mesh = frame.to_meshio()
        mesh.write(scratch_folder() / 'mesh.vtu')
        points, data = mesh.points, {'point_data': mesh.point_data, 'cell_data': mesh.cell_data}
        blocks = [(block.type, block.data) for block in mesh.cells]
    same(points, frame.points, 'meshio: points')
    same(data['point_data']['U'], frame.U, 'meshio: U')
    same(np.concatenate(data['cell_data']['S']), frame.cell_data['S'][[2, 0, 1]], 'meshio: S by block')
    CHECKS.true([(kind, np.asarray(cells).tolist()) for kind, cells in blocks]
                == [('vertex', [[5]]), ('quad', [[0, 1, 4, 3], [1, 2, 5, 4]])], 'meshio: cells')
    convert_to_pyvista(frame)


def convert_to_pyvista(frame):
    """With the package or a stand-in for its grid."""
    class Grid:
        def __init__(self, cells, kinds, points):
            self.cells, self.celltypes, self.points = cells, kinds, points
            self.point_data, self.cell_data, self.field_data = {}, {}, {}

    real = importlib.util.find_spec('pyvista') is not None
    if not real:
        sys.modules['pyvista'] = types.ModuleType('pyvista')
        sys.modules['pyvista'].UnstructuredGrid = Grid
    mesh = frame.to_pyvista()
    same(mesh.cells, [4, 0, 1, 4, 3, 4, 1, 2, 5, 4, 1, 5], 'pyvista: cells')
    same(mesh.celltypes, [9, 9, 1], 'pyvista: their types')
    same(np.asarray(mesh.point_data['U']), frame.U, 'pyvista: U')
    same(np.asarray(mesh.cell_data['S']), frame.cell_data['S'], 'pyvista: S')
    if real:
        same(mesh.warp_by_vector('U').points, (frame.points + frame.U), 'pyvista: warped')
    else:
        del sys.modules['pyvista']


def read_headings():
    """The heading wherever it stands: behind many lines, across the first block that is read, in any case,
    and not what a comment or a longer word says."""
    cards, filler = STRIP.split('*NODE,', 1), '** *HEADING of a comment\n' * 4000
    for what, head, wanted in (
            ('far down', filler + cards[0], 'Two elements fly against a wall'),
            ('in any case', ' * heading \n** no\n  a, b*c\n\n ½ $\n', 'a, b*c ½ $'),
            ('long', '*HEADING\n' + 'word\n' * 20000, ' '.join(['word'] * 20000)),
            ('none', filler, '')):
        with Result(run_deck(head + '*NODE,' + cards[1]).path) as result:
            CHECKS.true(result.heading == wanted, f'heading {what}: "{result.heading[:40]}"')


def read_names():
    """Contacts go by the names that the deck has: carom folds a to z and no other letter."""
    deck = STRIP.replace('NAME=FRONT', 'NAME=flöor * Ss²').replace('\nFRONT,', '\nFLöor* ss²,')
    with Result(run_deck(deck).path) as result:
        CHECKS.true(result.contacts == ['FLöOR*SS²-WALL'], f'as carom folds it: {result.contacts}')
        for name in ('FLöOR*SS²-WALL', 'flöor * Ss²-Wall', ' FLöor* ss² - wall'):
            same(result.contact(name).CF1, result.history['contact_FLöOR*SS²-WALL/CF1'], f'contact("{name}")')
        own = 'contact_FLöOR*SS²-WALL/CF'
        CHECKS.true(result.history.select(own + '1') == [own + '1'] and result.history.select(own + '?')
                    == [own + '1', own + '2', own + '3'], 'names with * of their own are found by pattern')
        CHECKS.true('FLÖOR' in message(result.contact, 'FLÖOR*SS²-WALL'), 'another letter is another name')


def read_brackets():
    """Columns whose names have brackets and stars: these are themselves, and * and ? patterns too."""
    table = Table({name: [] for name in ('contact_A[1]/CF1', 'contact_A[2]/CF1', 'contact_A1/CF1', 'a*/U', 'ab/U')},
                  lambda name, known: f'no {name}')
    for pattern, wanted in (('contact_A[1]/CF1', ['contact_A[1]/CF1']), ('a*/U', ['a*/U']), ('a?/U', ['a*/U', 'ab/U']),
                            ('contact_A[*', ['contact_A[1]/CF1', 'contact_A[2]/CF1'])):
        CHECKS.true(table.select(pattern) == wanted, f'{pattern} selects {table.select(pattern)}')
    CHECKS.true(message(table.select, 'contact_A[12]/CF1') == 'no contact_A[12]/CF1', '[12] is no pattern')


def read_modes():
    """Frequencies and modes."""
    run = run_deck(INPUT / 'cantilever' / 'modes.inp')
    with Result(run.path) as result:
        same(result.frequencies, run['frequency/frequency'], 'frequencies')
        same(result.modes.effective_mass, run['frequency/effective_mass'], 'effective masses')
        same(result.frames.times, result.frequencies, 'a frame a mode')
        table = with_pandas(lambda: result.to_pandas('frequency'))
        same(np.asarray(table['frequency']), result.frequencies, 'pandas: a row a mode')
        for k, axis in enumerate('xyz'):
            same(np.asarray(table[f'effective_mass_{axis}']), result.modes.effective_mass[:, k],
                 f'pandas: effective masses along {axis}')
        CHECKS.true('moving_mass' not in set(table), 'pandas: no column without a row a mode')
        CHECKS.true(result.heading.startswith('Cantilever'), 'heading of an example')


def read_in_mid_run():
    """The file of a run that goes on."""
    folder = scratch_folder()
    deck = folder / 'long.inp'
    text = (INPUT / 'sdof' / 'sdof.inp').read_text()
    for card in ('*NODE PRINT', '*CONTACT PRINT', '*ENERGY PRINT', '*NODE FILE'):
        text = text.replace(card, card + ', FREQUENCY=1000')
    deck.write_text(text)
    run = subprocess.Popen([sys.argv[1], 'run', str(deck), '--quiet', '--define', 'end=1e7'])
    path, late = folder / 'long.h5', time.monotonic() + 120
    while not path.exists() and time.monotonic() < late and run.poll() is None:
        time.sleep(0.05)
    going = run.poll() is None
    try:
        with Result(path) as result:
            u, t = result.node(1).U1, result.time
            CHECKS.true(going and len(u) == len(t) == len(result.energy.total) > 1
                        and np.isfinite(u).all(), f'{len(t)} rows of a run that goes on')
            CHECKS.true(len(result.frames) > 0 and result.frames[-1].U.shape == (1, 3), 'and frames')
    finally:
        run.send_signal(signal.SIGKILL)
        run.wait()


def main():
    names()
    run = run_deck(STRIP)
    with Result(run.path) as result:
        read_columns(run, result)
        read_slices(result)
        read_events(run, result)
        read_frames(run, result)
        missing(result)
        convert(result)
    read_headings()
    read_names()
    read_brackets()
    read_modes()
    read_in_mid_run()
    CHECKS.finish()


if __name__ == '__main__':
    main()
