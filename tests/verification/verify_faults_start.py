"""Files that stand in the way of a run before it begins: each is refused with its reason and cure.

Names of results, directories that are missing or may not be written to, results and logs that
exist, decks that cannot be read or would be overwritten, leftovers of a crash, no space at all.
"""
import os
import subprocess

from carom_case import INPUT, Checks
from fault_case import (PROGRAM, SDOF, Place, limited, refused, rows_of, said, saved,
                        without_privileges)

# Nothing has mass: the run finds that out when its files are made, before its first record
MASSLESS = """*NODE
7, 0, 0
8, 1, 0
*ELEMENT, TYPE=SPRING2, ELSET=spring
1, 7, 8
*SPRING, ELSET=spring
1, 1
5
*BOUNDARY
7, 1
*STEP
*FREQUENCY
1
*NODE FILE
U
*END STEP
"""


def check_names(checks):
    """-o takes names of results alone."""
    for name in ('', 'results', 'deck.inp', 'out.log', 'out.sta', 'out.h5.part', '/dev/null', '.h5'):
        refused(checks, Place().run('-o', name), ['ends in .h5', 'usage:'], ['deck.inp'],
                f"-o '{name}'", status=1)
    for name in ('größer als 1.h5', 'a b.vtkhdf', 'x.y.hdf5', 'x.hdf'):
        place = Place()
        run = place.run('-o', name)
        stem = name.removesuffix('.h5')
        expected = sorted(['deck.inp', name, f'{stem}.log', f'{stem}.sta'])
        checks.true(run.status == 0 and place.names() == expected and rows_of(place.folder / name)[0],
                    f'-o {name}: {place.names()}')
    long = 'n'*251 + '.h5'
    refused(checks, Place().run('-o', long), ['File name too long'], ['deck.inp'],
            'a name of 254 characters')
    refused(checks, Place().run('-o', 'd/'*3000 + 'out.h5'), ['there is no directory'], ['deck.inp'],
            'a path of 6000 characters')
    place = Place()
    folder = place.folder / ('d'*200) / ('e'*200)
    folder.mkdir(parents=True)
    checks.true(place.run('-o', str(folder / 'out.h5')).status == 0
                and rows_of(folder / 'out.h5')[0] > 400, 'a path of 400 characters works')


def check_directories(checks):
    """The directory of the results."""
    refused(checks, Place().run('-o', 'no/out.h5'), ["'no/out.h5'", "there is no directory 'no'"],
            ['deck.inp'], 'a directory that is missing')
    refused(checks, Place().run('-o', 'deck.inp/out.h5'), ["there is no directory 'deck.inp'"],
            ['deck.inp'], 'a file in place of the directory')
    refused(checks, Place().run('-o', '/proc/out.h5'), ["'/proc/out.h5"], ['deck.inp'],
            'a directory that takes no files')
    place = Place()
    (place.folder / 'out.h5').mkdir()
    refused(checks, place.run('-o', 'out.h5', '--overwrite'), ['it is a directory'],
            ['deck.inp', 'out.h5'], 'a directory in place of the results')
    place = Place()
    os.mkfifo(place.folder / 'out.h5')
    refused(checks, place.run('-o', 'out.h5', '--overwrite'), ['not a file but a device, pipe'],
            ['deck.inp', 'out.h5'], 'a pipe in place of the results')
    place = Place()
    closed = place.folder / 'closed'
    closed.mkdir(mode=0o555)
    run = place.run('-o', 'closed/out.h5', prepare=without_privileges)
    refused(checks, run, ["nothing can be written in 'closed': Permission denied"],
            ['closed', 'deck.inp'], 'a read-only directory')
    checks.true(not list(closed.iterdir()), 'a read-only directory: nothing in it')


def check_existing(checks):
    """Results, logs and other files that are there."""
    place = Place()
    place.run()
    before = {name: place.read(name) for name in place.names()}
    run = place.run('--define', 'dt=0.02')
    refused(checks, run, ["'deck.h5'", 'it exists', '--overwrite', '-o'], before, 'results exist')
    checks.true(all(place.read(name) == text for name, text in before.items()),
                'results exist: results, log and status file are as they were')
    run = place.run('--define', 'dt=0.02', '--overwrite')
    said(checks, run, 0, [], '--overwrite')
    saved(checks, place, (1001, 1001, 1001), '--overwrite')
    run = place.run('--define', 'dt=0', '--overwrite')
    checks.true(run.status == 2 and rows_of(place.folder / 'deck.h5')[0] == 1001,
                f'--overwrite and a mistake in the deck: status {run.status}, the results stay')
    old = place.read()
    (place.folder / 'deck.inp').write_text(MASSLESS)
    run = place.run('--overwrite')
    said(checks, run, 4, ['there are no modes', "'deck.h5' is still that of an earlier run"],
         '--overwrite and a stop before the first record')
    checks.true(place.read() == old, 'a stop before the first record: the results stay')
    (place.folder / 'deck.h5').unlink()
    run = place.run()
    said(checks, run, 4, ['there are no modes', 'no results were saved'], 'a stop before the first record')
    checks.true(place.names() == ['deck.inp', 'deck.log', 'deck.sta'],
                f'a stop before the first record: {place.names()}')
    (place.folder / 'deck.inp').write_text(SDOF)
    said(checks, place.run(), 0, [], 'a log of ours without results is replaced')
    link = Place()
    (link.folder / 'far').mkdir()
    (link.folder / 'far/real.h5').write_text('old')
    (link.folder / 'deck.h5').symlink_to('far/real.h5')
    said(checks, link.run('--overwrite'), 0, [], 'a link in place of the results')
    checks.true((link.folder / 'deck.h5').is_symlink()
                and rows_of(link.folder / 'far/real.h5')[0] > 400
                and os.listdir(link.folder / 'far') == ['real.h5'],
                'a link in place of the results: it stays, what it leads to is replaced')


def check_logs(checks):
    """OUT.log and OUT.sta that no run has written; logs that cannot be written."""
    for ending in ('log', 'sta'):
        place = Place()
        mine = place.folder / f'deck.{ending}'
        mine.write_text('my notes, not those of a run\n')
        refused(checks, place.run(), [f"'deck.{ending}'", 'no run has written it'],
                ['deck.inp', f'deck.{ending}'], f'a strange .{ending}')
        checks.true('my notes' in mine.read_text(), f'a strange .{ending} stays')
        said(checks, place.run('--overwrite'), 0, [], f'a strange .{ending} and --overwrite')
        mine.unlink()
        mine.mkdir()
        (place.folder / 'deck.h5').unlink()
        run = place.run('--overwrite')
        said(checks, run, 3, [f"'deck.{ending}'", 'it is a directory'], f'.{ending} is a directory')
        mine.rmdir()
        os.mkfifo(mine)
        said(checks, place.run('--overwrite'), 3, [f"'deck.{ending}'", 'pipe'],
             f'.{ending} is a pipe')
        mine.unlink()
        mine.symlink_to('/dev/full')
        run = place.run('--overwrite')
        said(checks, run, 3, [f"cannot write 'deck.{ending}': No space left"],
             f'the disk is full for .{ending}')
        saved(checks, place, (501, 501, 501), f'the disk is full for .{ending}')
    place = Place()
    with open(place.folder / 'deck.log', 'w', encoding='ascii') as log:
        done = subprocess.run([PROGRAM, 'run', 'deck.inp'], cwd=place.folder, stdout=log, check=False)
    lines = (place.folder / 'deck.log').read_text().splitlines()
    checks.true(done.returncode == 0 and lines[-1] == 'completed'
                and lines.count('completed') == 1 and lines[0].startswith('carom '),
                f'output sent to deck.log: one log of {len(lines)} lines')
    for where in ('/dev/full', '/dev/null'):
        place = Place()
        with open(where, 'w', encoding='ascii') as full:
            done = subprocess.run([PROGRAM, 'run', 'deck.inp'], cwd=place.folder, stdout=full,
                                  stderr=subprocess.PIPE, check=False)
        checks.true(done.returncode == 0 and rows_of(place.folder / 'deck.h5')[0] == 501,
                    f'output sent to {where}: status {done.returncode}, all results')
    place = Place()
    process = subprocess.Popen([PROGRAM, 'run', 'deck.inp'], cwd=place.folder,
                               stdout=subprocess.PIPE)
    process.stdout.close()
    checks.true(process.wait() == 0 and rows_of(place.folder / 'deck.h5')[0] == 501,
                'nobody reads the output: the run ends all the same')


def check_decks(checks):
    """Decks that cannot be read, and results that would replace what the deck is read from."""
    refused(checks, Place().run('-o', 'out.h5', deck='no.inp'), ["cannot open 'no.inp'"],
            ['deck.inp'], 'no such deck')
    for deck, words in (('.', 'directory, pipe or device'), ('/dev/zero', 'pipe or device')):
        refused(checks, Place().run('-o', 'out.h5', deck=deck), [f"cannot read '{deck}'", words],
                ['deck.inp'], f"the deck is '{deck}'")
    place = Place()
    os.mkfifo(place.folder / 'pipe.inp')
    refused(checks, place.run(deck='pipe.inp'), ["cannot read 'pipe.inp'", 'save the deck in a file'],
            ['deck.inp', 'pipe.inp'], 'the deck is a pipe')
    place = Place('*INCLUDE, INPUT=pipe.inp\n')
    os.mkfifo(place.folder / 'pipe.inp')
    refused(checks, place.run(), ['deck.inp:1:', "cannot read 'pipe.inp'", 'pipe or device', 'cure:'],
            ['deck.inp', 'pipe.inp'], 'the deck includes a pipe', status=2)
    place = Place()
    (place.folder / 'deck.inp').chmod(0)
    refused(checks, place.run(prepare=without_privileges), ["cannot open 'deck.inp'",
            'Permission denied'], ['deck.inp'], 'a deck that may not be read')
    done = subprocess.run([PROGRAM, 'run', '/dev/stdin', '-o', 'out.h5', '--quiet'], text=True,
                          input=SDOF, cwd=place.folder, capture_output=True, check=False)
    checks.true(done.returncode == 3 and 'save the deck in a file' in done.stderr,
                f'the deck comes through a pipe: status {done.returncode}')
    with open(INPUT / 'sdof/sdof.inp', encoding='ascii') as deck:
        done = subprocess.run([PROGRAM, 'run', '/dev/stdin', '-o', 'out.h5', '--quiet'], stdin=deck,
                              cwd=place.folder, capture_output=True, check=False)
    checks.true(done.returncode == 0 and rows_of(place.folder / 'out.h5')[0] == 501,
                f'the deck is a file at standard input: status {done.returncode}')
    for name in ('deck.h5', 'deck.log', 'deck.sta', 'deck.h5.part', 'deck.h5.next'):
        for text, deck in ((SDOF, name), (f'*INCLUDE, INPUT={name}\n', 'main.inp')):
            place = Place(text, name=deck)
            (place.folder / name).write_text(SDOF)
            run = place.run('--overwrite', '-o', 'deck.h5')
            refused(checks, run, [f"'{name}'", 'the deck is read from it'], {name, deck},
                    f'the deck {deck} is read from {name}')
            checks.true((place.folder / name).read_text() == SDOF,
                        f'the deck {deck} is read from {name}: it stays')
    place = Place()
    os.link(place.folder / 'deck.inp', place.folder / 'twin.h5')
    refused(checks, place.run('--overwrite', '-o', 'twin.h5'), ['the deck is read from it'],
            ['deck.inp', 'twin.h5'], 'the results are a second name of the deck')


def check_restarts(checks):
    """--restart from what is no file, and beside a status file that is none: nothing waits for ever."""
    place = Place()
    os.mkfifo(place.folder / 'pipe.h5')
    (place.folder / 'folder.h5').mkdir()
    left = place.names()
    for name in ('pipe.h5', 'folder.h5', '.', '/dev/zero'):
        for options in ((), ('-o', 'new.h5')):
            refused(checks, place.run('--restart', name, *options),
                    [f"cannot read '{name}'", 'directory, pipe or device'], left,
                    f"--restart {' '.join((name, *options))}")
    place = Place(SDOF.replace('*END STEP', '*RESTART, WRITE\n*END STEP'))
    said(checks, place.run(), 0, [], 'a run to go on with')
    (place.folder / 'deck.sta').unlink()
    os.mkfifo(place.folder / 'deck.sta')
    longer = SDOF.replace('end = 20', 'end = 21').replace('*END STEP', '*RESTART, WRITE\n*END STEP')
    (place.folder / 'deck.inp').write_text(longer)
    said(checks, place.run('--restart', 'deck.h5', '-o', 'new.h5'), 0, [],
         'a pipe in place of the earlier status file')
    lines = (place.folder / 'new.sta').read_text().splitlines()
    checks.true(lines[0].startswith('# step') and len(lines) == 2 + 25,
                f'a pipe in place of the earlier status file: its {len(lines)} lines begin anew')


def check_leftovers(checks):
    """What a crash has left beside the results does not disturb the next run."""
    place = Place()
    for ending in ('.part', '.next'):
        (place.folder / f'deck.h5{ending}').write_bytes(b'\x89HDF\r\n\x1a\n torn')
    said(checks, place.run(), 0, [], 'leftovers of a crash')
    saved(checks, place, (501, 501, 501), 'leftovers of a crash')
    reference = Place()
    reference.run()
    checks.true(abs(len(place.read()) - len(reference.read())) < 100,
                'leftovers of a crash: nothing of them is in the results')
    for name in ('deck.h5.part', 'deck.h5.next'):
        for make in (os.mkfifo, os.mkdir):
            place = Place()
            make(place.folder / name)
            run = place.run()
            refused(checks, run, [f"cannot write '{name}': it is a directory, pipe or device",
                                  'remove it'], ['deck.inp', name], f'{make.__name__} {name}')


def check_no_space(checks):
    """A disk that is full from the beginning, as a limit of the size of files."""
    for size in (0, 1000, 30000, 100000):
        place = Place()
        run = place.run(prepare=limited(size))
        refused(checks, run, ["cannot write 'deck.h5'", 'limit of the size of a file'],
                ['deck.inp'], f'files of {size} bytes at most')


def main():
    checks = Checks()
    check_names(checks)
    check_directories(checks)
    check_existing(checks)
    check_logs(checks)
    check_decks(checks)
    check_restarts(checks)
    check_leftovers(checks)
    check_no_space(checks)
    checks.finish()


if __name__ == '__main__':
    main()
