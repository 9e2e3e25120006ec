"""The scripts that draw: each makes a picture of the expected size that is not blank, with the deck's
heading; --save takes png, pdf and svg, --show opens a window or says why not; a history of eight
million rows is drawn in a few seconds and with memory well below the size of its file."""
import contextlib
import importlib
import io
import os
import subprocess
import sys

import h5py
import numpy as np
from carom_case import INPUT, ROOT, Checks, run_deck, scratch_folder
from result_decks import BARE, STRIP

for name in ('MPLBACKEND', 'DISPLAY', 'WAYLAND_DISPLAY'):
    os.environ.pop(name, None)
from carom_plots import BINS_OF_TICKS, COLOURS, event_times, plt   # noqa: E402  (scripts)

CHECKS = Checks()
FOLDER = scratch_folder()
ROWS = 8_000_000
MEASURE = """import importlib, sys, time
folder, result, pictures, *scripts = sys.argv[1:]
sys.path.insert(0, folder)
for script in scripts:
    begun = time.process_time()
    sys.argv = [script, result, '--save', f'{pictures}/{script}.png']
    importlib.import_module(script).main()
    lines = open('/proc/self/status').read().splitlines()
    memory = next(int(line.split()[1]) for line in lines if line.startswith('VmHWM'))
    print('used', time.process_time() - begun, memory / 1024)
"""
WINDOW = """from matplotlib.backends.backend_agg import FigureCanvasAgg as FigureCanvas
def show(*, block=None):
    print('a window opens')
"""


def call(script, *words):
    """Runs a script's main() here: what it prints, and the message it ends with."""
    module, kept, said = importlib.import_module(script), sys.argv, io.StringIO()
    sys.argv = [script + '.py', *map(str, words)]
    plt.close('all')
    try:
        with contextlib.redirect_stdout(said):
            module.run(module.main)
    except SystemExit as end:
        return said.getvalue(), str(end)
    finally:
        sys.argv = kept
    return said.getvalue(), ''


def start(script, *words):
    """Runs a script as a process of its own: status and output."""
    done = subprocess.run([sys.executable, '-B', ROOT / 'scripts' / f'{script}.py', *words], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return done.returncode, done.stdout


def measure(path, *scripts):
    """Draws a result by some scripts in one new process: seconds of the processor and peak memory in MB
    after each of them."""
    (FOLDER / 'measure.py').write_text(MEASURE)
    words = [sys.executable, '-B', FOLDER / 'measure.py', ROOT / 'scripts', path, FOLDER, *scripts]
    done = subprocess.run(words, capture_output=True, text=True)
    CHECKS.true(done.returncode == 0, f'{scripts} of {path.name}: {done.stderr or "drawn"}')
    return [tuple(map(float, line.split()[1:])) for line in done.stdout.splitlines()
            if line.startswith('used ')]


def look(path, name, width=None):
    """A picture: its size, something on it, and nothing cut off at its rim."""
    pixels = plt.imread(path)[..., :3]
    pixels = pixels / 255.0 if pixels.dtype == np.uint8 else pixels
    CHECKS.true(0.003 < pixels.std(axis=2).mean() + pixels.std() and pixels.std() > 0.05,
                f'{name} is not blank')
    CHECKS.true(400 <= pixels.shape[0] <= 2600 and 500 <= pixels.shape[1] <= 1500
                and width in (None, pixels.shape[1]), f'{name} has {pixels.shape[:2]} pixels')
    rim = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
    CHECKS.true((rim > 0.99).mean() > 0.99, f'{name}: nothing is cut off at its rim')


def draw_all(sdof, strip):
    """Every script on a small case."""
    two_dof = run_deck(INPUT / 'two_dof' / 'two_dof.inp', end=4).path
    cases = [
        ('plot_history', [sdof, '--events', '--columns', 'node_1/U1,node_1/V1'], 1235),
        ('plot_history', [strip], 1235),
        ('plot_energy', [sdof], 1235),
        ('plot_energy', [strip, '--lines', '--events'], 1235),
        ('plot_phase', [sdof, '--wall', '-0.5'], 975),
        ('plot_profile', [strip], 975),
        ('plot_mesh', [strip, '--field', 'S11', '--groups'][:3], None),
        ('plot_mesh', [strip, '--groups', '--supports'], None),
        ('compare_exact', ['two_dof', two_dof], 1235),
        ('plot_contact', [strip], 1105),
    ]
    for number, (script, words, width) in enumerate(cases):
        path = FOLDER / f'{number}.png'
        said, error = call(script, *words, '--save', path)
        CHECKS.true(not error and said.endswith(f'{path}\n'), f'{script} {words[-1]}: {error or "drawn"}')
        look(path, f'{script} {number}', width)
    said, error = call('animate', strip, '--field', 'MISES', '-o', FOLDER / 'film.gif')
    CHECKS.true(not error and '11 frames' in said, f'animate: {error or said}')
    look(FOLDER / 'film.gif', 'animate', None)


def options(sdof):
    """--save in other formats, beside the result, wrong names; --show with and without a window."""
    for ending, head in (('pdf', b'%PDF'), ('svg', b'<?xml')):
        path = FOLDER / f'picture.{ending}'
        call('plot_history', sdof, '--save', path)
        CHECKS.true(path.read_bytes().startswith(head), f'--save of a .{ending}')
    CHECKS.true('One mass on a spring that hits a wall' in call_title(sdof), 'the heading is the title')
    call('plot_energy', sdof)
    CHECKS.true(sdof.with_name('result_energy.png').exists(), 'without --save beside the result')
    CHECKS.true('.png, .pdf or .svg' in call('plot_energy', sdof, '-o', 'x.bmp')[1], 'wrong ending')
    CHECKS.true('cannot write' in call('plot_energy', sdof, '-o', '/no/x.png')[1], 'no such folder')
    CHECKS.true('DISPLAY' in call('plot_history', sdof, '--show')[1], '--show without a display')
    (FOLDER / 'window.py').write_text(WINDOW)
    sys.path.append(str(FOLDER))
    os.environ['MPLBACKEND'] = 'module://window'
    said, error = call('plot_history', sdof, '--show')
    CHECKS.true(not error and said == 'a window opens\n', f'--show: {said} {error}')
    said, error = call('plot_history', sdof, '--show', '--save', FOLDER / 'both.png')
    CHECKS.true(said == f'{FOLDER}/both.png\na window opens\n', '--show and --save')
    del os.environ['MPLBACKEND']
    plt.switch_backend('Agg')
    status, said = start('plot_history', 'none.h5')
    CHECKS.true(status == 1 and said == "error: no result file 'none.h5'\n", f'status {status}: {said}')
    os.environ['MPLBACKEND'] = 'foo'
    status, said = start('plot_energy', sdof, '-o', FOLDER / 'foo.png')
    CHECKS.true(status == 0 and 'foo.png' in said, f'MPLBACKEND=foo without --show: {said}')
    status, said = start('plot_energy', sdof, '--show')
    CHECKS.true(status == 1 and said.startswith('error: --show: no window with foo'), f'with it: {said}')
    del os.environ['MPLBACKEND']
    bare = run_deck(BARE).path
    for script, card in (('plot_energy', '*ENERGY PRINT'), ('plot_phase', '*NODE PRINT'),
                         ('plot_history', '*NODE PRINT')):
        error = call(script, bare)[1]
        CHECKS.true(card in error and '--columns' not in error, f'{script}: {error}')
    CHECKS.true(len(set(COLOURS)) == len(COLOURS) == 7, 'seven colours')


def freedoms(strip):
    """plot_phase draws the freedom that the history has, or says which it has."""
    up = BARE.replace('*SPRING, ELSET=S\n1\n', '*SPRING, ELSET=S\n2\n').replace('\n1, 1, 1\n', '\n1, 2, 1\n')
    one = run_deck(up.replace('*END', '*NODE PRINT\nU, V\n*END')).path
    for path, words, wanted in ((strip, [], 'U1, node 1'), (strip, ['--dof', 2], 'U2, node 1'),
                                (strip, ['--node', 12], 'U1, node 12'), (one, [], 'U2, node 1'),
                                (one, ['--node', 1], 'U2, node 1')):
        with plt.rc_context({'svg.fonttype': 'none'}):
            error = call('plot_phase', path, '--save', FOLDER / 'phase.svg', *words)[1]
        CHECKS.true(not error and f'displacement {wanted}<' in (FOLDER / 'phase.svg').read_text(),
                    f'plot_phase {words} draws {wanted}: {error}')
    error = call('plot_phase', one, '--dof', 1)[1]
    CHECKS.true('both U1 and V1' in error and 'there is --dof 2' in error, f'the wrong freedom: {error}')
    CHECKS.true('no history of node 4' in call('plot_phase', strip, '--node', 4)[1], 'no such node')


def legends_below(sdof):
    """A legend at the foot of a figure hides nothing of its axes."""
    module = importlib.import_module('plot_phase')
    with module.Result(sdof) as result:
        figure = module.draw(result, 1, 1, -0.5)
    figure.draw_without_rendering()
    legend, axes = figure.legends[0].get_window_extent(), figure.axes[0].get_tightbbox()
    CHECKS.true(0 < legend.y0 < legend.y1 < axes.y0, f'the legend is below the axes: {legend.y1:.0f}, {axes.y0:.0f}')


def modes():
    """animate lets one mode swing through a period: its displacements, its colours, its title."""
    body = STRIP.split('*SURFACE')[0]
    path = run_deck(body + '*BOUNDARY\n1, 1, 2\n11, 1, 2\n*STEP\n*FREQUENCY\n4\n*NODE FILE\nU\n'
                    '*EL FILE\nS\n*END STEP\n').path
    module = importlib.import_module('animate')
    with module.Result(path) as result:
        film, frame = module.Swing(result, 2, 3.0), result.frames[1]
        quarter = film.n_frames // 4
        for picture, part in ((0, 0), (quarter, 1), (2 * quarter, 0), (3 * quarter, -1)):
            away = film.place(picture) - (frame.points + 3.0 * part * frame.U)[:, :2]
            CHECKS.true(np.abs(away).max() < 1e-12, f'picture {picture} of mode 2 is {part} times its shape')
            s11, whole = film.field('S11', picture)[0], film.field('S11', quarter)[0]
            CHECKS.true(np.abs(s11 - part * whole).max() < 1e-12 * np.abs(whole).max()
                        and film.field('MISES', picture)[0].min() >= 0, f'picture {picture}: its stresses')
        CHECKS.true(film.title(0, set()) == f'mode 2, frequency {frame.time:.5g}', film.title(0, set()))
    module.SWING = 8    # for the sake of time
    for words, wanted in ((['--mode', 4, '--field', 'MISES'], '8 frames'),
                          (['--mode', 5], 'the modes 1 to 4, not 5'), (['--every', 2], 'a mode has none')):
        said, error = call('animate', path, '-o', FOLDER / 'mode.gif', *words)
        CHECKS.true(wanted in said + error, f'animate {words} of modes: {error or said}')


def numbers(path):
    """Arguments that are no finite numbers are refused, and nothing is drawn."""
    picture = FOLDER / 'number.png'
    for script, word in (('plot_mesh', '--scale=nan'), ('animate', '--scale=-inf'), ('animate', '--fps=nan'),
                         ('plot_phase', '--wall=1e999'), ('plot_contact', '--range=0,nan'),
                         ('plot_contact', '--hertz=1,inf'), ('plot_contact', '--centre=x')):
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            _, status = call(script, path, word, '-o', picture)
        CHECKS.true(status == '2' and word.split('=')[0] in said.getvalue() and not picture.exists(),
                    f'{script} {word}: {said.getvalue().splitlines()[-1]}')


def words_of_the_user():
    """Headings and names with $, ² and the like are drawn as they are, not as mathematics."""
    deck = STRIP.replace('Two elements fly', r'$5 and $7, $\foo$').replace('FRONT', 'fr$o$nt²')
    path = run_deck(deck).path
    title = r'$5 and $7, $\foo$ against a wall'
    with plt.rc_context({'svg.fonttype': 'none'}):
        for script, words, wanted in (
                ('plot_history', ['--columns', 'contact*/CF?'], [title, 'contact FR$O$NT²-WALL']),
                ('plot_energy', [], [title]), ('plot_mesh', [], [title])):
            picture = FOLDER / 'words.svg'
            error = call(script, path, '--save', picture, *words)[1]
            drawn = picture.read_text()
            CHECKS.true(not error and all(f'>{text}<' in drawn for text in wanted),
                        f'{script} draws {wanted}: {error}')
    said, error = call('animate', path, '--every', 5, '-o', FOLDER / 'words.gif')
    CHECKS.true('3 frames' in said, f'animate with such a heading: {error or said}')


def call_title(path):
    """The title of the history's figure."""
    module = importlib.import_module('plot_history')
    with module.Result(path) as result:
        return module.draw(result, ['node_1/U1'], False)._suptitle.get_text()


def large_file():
    """Histories and energies of so many rows; columns that are the same share their place."""
    path = FOLDER / 'large.h5'
    with h5py.File(path, 'w') as file:
        for name in ('history/time', 'history/node_1/U1', 'history/node_1/V1'):
            file.create_dataset(name, (ROWS,), float, chunks=(512,))
        file.create_dataset('zero', (ROWS,), float, chunks=(512,))
        for begin in range(0, ROWS, 500_000):
            t = 1e-6 * np.arange(begin, begin + 500_000)
            rows = slice(begin, begin + 500_000)
            file['history/time'][rows] = t
            file['history/node_1/U1'][rows] = 1.5 + np.sin(3000.0 * t) * np.exp(-t)
            file['history/node_1/V1'][rows] = 1.5 + np.cos(3000.0 * t) * np.exp(-t)
        file['history/node_1/U1'][ROWS - 321_098] = 4.0     # one row stands out
        for name, of in (('time', 'time'), ('kinetic', 'node_1/U1'), ('strain', 'node_1/V1'),
                         ('total', 'node_1/U1')):
            file[f'energy/{name}'] = file[f'history/{of}']
        for name in ('external_work', 'balance_error'):
            file[f'energy/{name}'] = file['zero']
    return path


def streams(small):
    """Time and memory of large histories, beside those of a small one."""
    path = large_file()
    size = path.stat().st_size / 2**20
    CHECKS.at_least(size, 100.0, 'MB of the large file')
    scripts = 'plot_history', 'plot_energy', 'plot_phase'
    (_, least), *_ = measure(small, scripts[0])
    found = measure(path, *scripts[:2]) + measure(path, scripts[2])
    for script, (seconds, most) in zip(scripts, found):
        CHECKS.at_most(most - least, 0.4 * size, f'{script}: MB more than for a small file')
        CHECKS.at_most(seconds, 10.0, f'{script} of {ROWS} rows: seconds of the processor')
        look(FOLDER / f'{script}.png', f'{script} of {ROWS} rows')
    module = importlib.import_module('plot_history')
    with module.Result(path) as result:
        figure = module.draw(result, ['node_1/U1'], False)
        drawn = figure.axes[0].lines[0].get_xydata()
        CHECKS.at_most(len(drawn), 8000, 'points of the path')
        CHECKS.true(drawn[:, 1].max() == 4.0, 'the row that stands out is drawn')
    events = {'time': np.linspace(0, 1, 100_000), 'kind': np.full(100_000, 'impact')}
    count, times = event_times(Rows(events), 0.0, 1.0)['impact']
    CHECKS.true(count == 100_000 and len(times) <= BINS_OF_TICKS + 1, 'many events are few ticks')
    events = {'time': np.array([0.1, 0.1, 0.2, 0.2, 0.2, 0.9]),
              'kind': np.array(['impact'] * 5 + ['release'])}
    found = event_times(Rows(events), 0.0, 0.5)
    CHECKS.true(found.keys() == {'impact'} and found['impact'][0] == 5
                and found['impact'][1].tolist() == [0.1, 0.2], 'events at one time are counted each')


class Rows(dict):
    """Columns with a length of rows."""

    def __len__(self):
        return len(self['time'])


def main():
    sdof = run_deck(INPUT / 'sdof' / 'sdof.inp').path
    strip = run_deck(STRIP.replace('*CONTACT PRINT', '*CONTACT FILE, FREQUENCY=10\nCF\n*CONTACT PRINT')
                     ).path
    draw_all(sdof, strip)
    options(sdof)
    freedoms(strip)
    legends_below(sdof)
    numbers(strip)
    modes()
    CHECKS.true('no modes' in call('animate', sdof, '--mode', 1)[1], 'animate --mode without modes')
    words_of_the_user()
    streams(sdof)
    CHECKS.finish()


if __name__ == '__main__':
    main()
