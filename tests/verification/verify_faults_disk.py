"""Disks that fill up or fail while a run writes: what was recorded up to then can be read.

A limit of the size of files, a small file system (where one can be mounted), and, with a library put
before that of C, a disk that fails at a chosen write.
"""
import contextlib
import subprocess
import time

from carom_case import Checks, scratch_folder
from fault_case import PUBLISHED, Place, endless, limited, rows_of, said, saved
from square_deck import rectangle

FAILING = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Whether this write to a file OUT.h5.part fails: all do from the one on that FAIL_AT counts to, or as
   soon as there is the file FAIL_WITH. */
static int fails(int descriptor)
{
   static long left = -1;
   char link[40], path[4096];
   ssize_t length;
   snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
   length = readlink(link, path, sizeof path);
   if (length < 5 || memcmp(path + length - 5, ".part", 5) != 0) return 0;
   if (getenv("FAIL_WITH")) {
      if (access(getenv("FAIL_WITH"), F_OK) != 0) return 0;
   } else {
      if (left < 0) left = atol(getenv("FAIL_AT"));
      if (left > 1) { left--; return 0; }
      left = 1;
   }
   errno = EIO;
   return 1;
}

ssize_t pwrite64(int descriptor, const void *bytes, size_t n, off64_t place)
{
   ssize_t (*real)(int, const void *, size_t, off64_t) = dlsym(RTLD_NEXT, "pwrite64");
   return fails(descriptor) ? -1 : real(descriptor, bytes, n, place);
}

ssize_t pwrite(int descriptor, const void *bytes, size_t n, off_t place)
{
   return pwrite64(descriptor, bytes, n, place);
}

ssize_t write(int descriptor, const void *bytes, size_t n)
{
   ssize_t (*real)(int, const void *, size_t) = dlsym(RTLD_NEXT, "write");
   return fails(descriptor) ? -1 : real(descriptor, bytes, n);
}
"""


def check_full_disk(checks):
    """A limit of the size of files, met in mid-run: nothing that was recorded is lost."""
    for size, every in ((400000, 1), (1000000, 1), (1000000, 40), (4000000, 7)):
        what = f'files of {size} bytes at most, a row in {every} increments'
        place = Place(endless(every))
        run = place.run(prepare=limited(size))
        said(checks, run, 3, ["'deck.h5'", 'limit of the size of a file (ulimit -f)', 'cure:'], what)
        saved(checks, place, (100*(size > 400000), 100, size > 400000), what, vtk=size == 1000000 and every == 1)
        checks.at_most((place.folder / 'deck.h5').stat().st_size, size, f'{what}: bytes')
    place = Place(endless(3).replace('*STEP\n', '*OUTPUT, COMPRESS=1\n*STEP\n', 1))
    run = place.run(prepare=limited(600000))
    said(checks, run, 3, ['limit of the size of a file'], 'compressed results, a limit')
    saved(checks, place, (1000, 1000, 1), 'compressed results, a limit', vtk=True)


def check_full_disk_restarted(checks):
    """A limit of the size of files, met by a run that goes on from a state: neither that state nor a
    row of before is lost. A new state takes the place of that one, for which there is room."""
    stopped = ['to go on: carom run deck.inp --restart deck.h5']
    records = ['*NODE PRINT, NSET=left, FREQUENCY={}', 'U', '*ENERGY PRINT, FREQUENCY={}',
               '*NODE FILE, FREQUENCY=1000000', 'U', '*RESTART, WRITE, FREQUENCY=100']
    square = rectangle(40, 'CPE4', '*DYNAMIC, DIRECT, EXPLICIT', records).replace('0.01, 0.1', '0.01, 1000')
    for every, status, words in ((1, 3, ['limit of the size of a file']), (10**6, 5, stopped)):
        place = Place(square.replace('{}', str(every)))
        what = f'a row in {every} increments'
        said(checks, place.run('--time-limit', '0.3'), 5, stopped, f'a run that is stopped, {what}')
        for more in (20000, 40000, 80000):
            what = f'a row in {every} increments, room for {more} bytes beyond the margin'
            rows = rows_of(place.folder / 'deck.h5')
            size = (place.folder / 'deck.h5').stat().st_size
            run = place.run('--restart', 'deck.h5', '--time-limit', '0.5' if status == 5 else '50',
                            prepare=limited(size + 2**18 + more))
            said(checks, run, status, words, f'restarted, {what}')
            saved(checks, place, rows, f'restarted, {what}')
            run = place.run('--restart', 'deck.h5', '--time-limit', '0.1')
            said(checks, run, 5, stopped, f'restarted again without a limit, {what}')


def mounted(folder, size):
    """Puts a small file system at a folder; the reason if that is not possible."""
    done = subprocess.run(['mount', '-t', 'tmpfs', '-o', f'size={size}', 'tmpfs', str(folder)],
                          capture_output=True, text=True, check=False)
    return '' if done.returncode == 0 else (done.stderr.strip() or 'mount failed')


def check_small_disk(checks):
    """A file system of a few megabytes, where a test may make one: full in mid-run, and full when
    the results are copied to be published."""
    folder = scratch_folder()
    reason = mounted(folder, 3000000)
    if reason:
        checks.skip(f'a small disk, which cannot be made here ({reason}); the limit of sizes is tested')
        return
    try:
        place = Place(endless(3), folder=folder)
        run = place.run()
        said(checks, run, 3, ["'deck.h5'", 'No space left on device', 'cure:'], 'a full disk')
        saved(checks, place, (1000, 1000, 1), 'a full disk', vtk=True)
        with open(folder / 'filler', 'wb', buffering=0) as filler:
            with contextlib.suppress(OSError):
                while filler.write(bytes(4096)):
                    pass
        run = place.run('-o', 'second.h5')
        said(checks, run, 3, ["'second.h5", 'No space left on device'],
             'a disk that is full from the beginning')
        checks.true(not any(name.startswith('second.h5') for name in place.names()),
                    'a disk that is full from the beginning: no results are left')
        for name in ('deck.h5', 'deck.log', 'deck.sta', 'second.log', 'second.sta', 'filler'):
            (folder / name).unlink(missing_ok=True)
        for every in (3, 30, 300):      # slower where the disk was full before the run was halted
            (folder / 'deck.inp').write_text(endless(every))
            run = place.start('--overwrite')
            part = folder / 'deck.h5.part'
            run.wait_for('deck.h5.part')
            with contextlib.suppress(FileNotFoundError):
                while part.stat().st_size < 1600000:      # twice that has no room
                    time.sleep(0.0005)
                run.halt()
                if part.stat().st_size < 2400000:
                    break
            run.kill()
        run.until(PUBLISHED)
        run.go_on()
        said(checks, run.finish(), 3, ["'deck.h5'", 'No space left on device'],
             'a disk without space for a copy')
        saved(checks, place, (1000, 1000, 1), 'a disk without space for a copy')
        checks.at_most((folder / 'deck.h5').stat().st_size, 2500000,
                       'a disk without space for a copy: bytes when the copy was due')
    finally:
        subprocess.run(['umount', '-l', str(folder)], check=False)


def failing_library():
    """A library with which writes fail; None where there is no compiler for C."""
    folder = scratch_folder()
    (folder / 'failing.c').write_text(FAILING)
    for compiler in ('cc', 'gcc', 'gcc-12', 'gcc-13', 'gcc-14'):
        with contextlib.suppress(OSError):
            subprocess.run([compiler, '-shared', '-fPIC', '-o', 'failing.so', 'failing.c', '-ldl'],
                           cwd=folder, check=True)
            return folder / 'failing.so'
    return None


def check_failing_disk(checks):
    """The disk fails at the n-th write of the results: the results of before stay, nothing crashes."""
    library = failing_library()
    checks.true(library is not None, 'there is a compiler for the library with which writes fail')
    if library is None:
        return
    place = Place()
    place.run()
    old = place.read()
    total = failed = 0
    for n in (*range(1, 12), *range(12, 60, 6), *range(60, 2000, 150), 10**6):
        run = place.run('--overwrite', env={'LD_PRELOAD': str(library), 'FAIL_AT': str(n)})
        total += 1
        if run.status == 0:
            break
        failed += 1
        words = ['cannot write', "'deck.h5'", 'cure:']
        good = (run.status == 3 and all(word in ' '.join(run.text.split()) for word in words)
                and place.read() == old
                and (n < 40 or "'deck.h5' is still that of an earlier run" in run.text)
                and place.names() == ['deck.h5', 'deck.inp', 'deck.log', 'deck.sta'])
        if not good:
            said(checks, run, 3, words, f'write {n} fails: {place.names()}')
    checks.true(failed >= 10, f'writes that fail: {failed} of {total} runs ended with status 3, the '
                              'message, and the results of before')
    # after a publication
    place = Place(endless(10))
    run = place.start(env={'LD_PRELOAD': str(library), 'FAIL_WITH': 'deck.h5'})
    run.wait_for('deck.h5.part')
    run.until_it_computes(0.3)
    run.halt()
    run.until(PUBLISHED)
    run.go_on()
    run.finish()
    said(checks, run, 3, ["'deck.h5' has the results up to when they were last saved", 'cure:'],
         'writes fail after a publication')
    saved(checks, place, (10, 10, 2), 'writes fail after a publication', vtk=True)


def main():
    checks = Checks()
    check_full_disk(checks)
    check_full_disk_restarted(checks)
    check_small_disk(checks)
    check_failing_disk(checks)
    checks.finish()


if __name__ == '__main__':
    main()
