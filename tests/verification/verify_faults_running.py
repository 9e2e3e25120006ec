"""Files that others touch while a run writes: what was recorded up to then stays readable.

Results, directories and decks removed or replaced, two runs on one output, a kill. Runs are halted for
a while, so that their clock, by which results are published, goes on without work being done.
"""
import contextlib
import re
import shutil
import time

import h5py

from carom_case import Checks
from fault_case import (PUBLISHED, SDOF, Place, endless, refused, rows_of, said, saved, vtk_reads)

TWICE = 2*PUBLISHED    # seconds of a run after which it has published for the second time
MADE = 0.3             # seconds of the processor after which it has recorded something


def begin(*options, every=1, **more):
    """A place with a run that goes on, some time after it has begun to record."""
    place = Place(endless(every))
    run = place.start(*options, **more)
    run.place = place
    return run


def halted(runs, seconds):
    """Lets the runs record a little, halts them, waits until they are so old."""
    for run in runs:
        run.wait_for('deck.sta')
        run.until_it_computes(MADE)
        run.halt()
    for run in runs:
        run.until(seconds)


def check_removed(checks):
    """Results, part file or directory removed: found at the next publication, and saved again."""
    part, again, both, folder, new = runs = [begin(every=20) for _ in range(5)]
    halted(runs, PUBLISHED)
    (part.place.folder / 'deck.h5.part').unlink()
    shutil.rmtree(folder.place.folder)
    new.place.folder.joinpath('deck.h5.next').mkdir()
    for run in runs:
        run.go_on()
    words = ["'deck.h5'", 'removed while the run was writing it', 'saved there again', 'cure:']
    said(checks, part.finish(), 3, words, 'the part file removed')
    saved(checks, part.place, (10, 10, 1), 'the part file removed', vtk=True)
    said(checks, folder.finish(), 3, words, 'the directory removed')
    rows = rows_of(folder.place.folder / 'deck.h5')
    checks.true(min(rows) > 0 and folder.place.names() == ['deck.h5'],
                f'the directory removed: {rows} rows, {folder.place.names()}')
    said(checks, new.finish(), 3, ["'deck.h5.next': it is a directory", 'remove it'], 'a directory for the copy')
    saved(checks, new.place, (10, 10, 1), 'a directory for the copy', beside=['deck.h5.next'])
    for run in (again, both):
        checks.true(run.wait_for('deck.h5'), 'results are published after five seconds')
    halted([again, both], TWICE)
    checks.true(vtk_reads(again.place.folder / 'deck.h5'),
                'vtkHDFReader reads results that are published')
    (again.place.folder / 'deck.h5').unlink()
    for name in ('deck.h5', 'deck.h5.part'):
        (both.place.folder / name).unlink()
    for run in (again, both):
        run.go_on()
    for run, what in ((again, 'the results removed'), (both, 'results and part file removed')):
        said(checks, run.finish(), 3, words, what)
        saved(checks, run.place, (10, 10, 1), what)


def short_runs():
    """Step lengths and decks of runs of a second, and of longer ones: for a test that has to act while the
    first of them goes on, where that was over before."""
    for dt in ('4e-4', '1e-4', '2e-5'):
        yield float(dt), SDOF.replace('dt = 0.04', f'dt = {dt}')


def check_end(checks):
    """A directory that takes the place of the results just before they come there."""
    for dt, text in short_runs():
        place = Place(text)
        run = place.start()
        run.wait_for('deck.sta')
        with contextlib.suppress(FileExistsError):
            (place.folder / 'deck.h5').mkdir()
            break
        run.finish()
    said(checks, run.finish(), 3, ["'deck.h5'", "complete in 'deck.h5.part'"],
         'a directory in place of the results at the end')
    # a slow run meets the directory when it publishes in mid-run
    reached = float(re.search(r'^summary of the run up to time (\S+)', (place.folder / 'deck.log').read_text(),
                              re.MULTILINE).group(1))
    rows = rows_of(place.folder / 'deck.h5.part')[0]
    checks.true(rows > 1 and abs(rows - 1 - reached/dt) <= 1,
                f'a directory in place of the results at the end: {rows} rows can be read, up to '
                f'the time reached, {reached}')


def check_two_runs(checks):
    """Two runs on one output; what a run needs of its files is that of its beginning."""
    for dt, text in short_runs():
        head, tail = text.split('*SURFACE, NAME=body', 1)
        place = Place(f'*INCLUDE, INPUT=model.inc\n*SURFACE, NAME=body{tail}')
        (place.folder / 'model.inc').write_text(head)
        first = place.start()
        first.wait_for('deck.sta')
        first.halt()
        if not (place.folder / 'deck.h5').exists():
            break
        first.go_on()
        first.finish()
    for options in ((), ('--overwrite',), ('-o', './deck.h5'), ('-o', str(place.folder / 'deck.h5'))):
        second = place.run(*options)
        refused(checks, second, ['another run is writing to it', str(first.process.pid)],
                ['deck.h5.part', 'deck.inp', 'deck.log', 'deck.sta', 'model.inc'],
                f'a second run {" ".join(options)}')
    (place.folder / 'deck.inp').write_text('*NODE\n')
    (place.folder / 'model.inc').unlink()
    first.go_on()
    said(checks, first.finish(), 0, [], 'the first run, its deck replaced and an included file removed')
    saved(checks, place, [round(20/dt) + 1]*3, 'the first run')
    reference = Place(text)
    reference.run()
    with h5py.File(place.folder / 'deck.h5') as ours, \
            h5py.File(reference.folder / 'deck.h5') as theirs:
        checks.true((ours['history/node_1/U1'][()] == theirs['history/node_1/U1'][()]).all(),
                    'the first run: the results are those of a run alone')
        deck = ours['model/deck'][()].decode()
        checks.true('*INCLUDE, INPUT=model.inc' in deck and 'SPRING1' in deck,
                    'the first run: /model/deck is what was read')


def check_kill(checks):
    """Killed after a publication: the published results are complete; the next run cleans up."""
    run = begin(every=20)
    halted([run], PUBLISHED)
    run.go_on()
    checks.true(run.wait_for('deck.h5'), 'a killed run had published its results')
    time.sleep(0.1)
    run.kill()
    place = run.place
    checks.true(min(rows_of(place.folder / 'deck.h5')) > 0 and vtk_reads(place.folder / 'deck.h5'),
                f'a killed run: its results can be read: {rows_of(place.folder / "deck.h5")}')
    checks.true('deck.h5.part' in place.names(), f'a killed run leaves {place.names()}')
    (place.folder / 'deck.h5.next').write_text('torn')
    (place.folder / 'deck.inp').write_text(SDOF)
    left = place.names()
    refused(checks, place.run(), ["'deck.h5'", 'it exists'], left, 'after a kill')
    said(checks, place.run('--overwrite'), 0, [], 'after a kill, --overwrite')
    saved(checks, place, (501, 501, 501), 'after a kill, --overwrite')


def main():
    checks = Checks()
    check_removed(checks)
    check_end(checks)
    check_two_runs(checks)
    check_kill(checks)
    checks.finish()


if __name__ == '__main__':
    main()
