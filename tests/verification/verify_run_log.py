"""The log and the status file of a run: what they hold stays, whatever ends the run.

Runs that go on with the files of an earlier one are killed at the worst moment, before they have
written a line of their own.
"""
import fcntl
import os
import signal
import time

from carom_case import Checks
from fault_case import Place, Started, endless

RECORDED = 0.5         # seconds of a run that writes some hundred lines at least
PIPE_SIZE = 1031       # fcntl's F_SETPIPE_SZ, which Python has from 3.10 on


def interrupted(checks):
    """A run that was interrupted, and its log and status file."""
    place = Place(endless())
    run = place.start()
    run.wait_for('deck.h5.part')
    time.sleep(RECORDED)
    run.process.send_signal(signal.SIGINT)
    checks.true(run.finish().status == 5, f'a run is interrupted: {run.text[:200]}')
    return place, place.read('deck.log'), place.read('deck.sta')


def settled(status):
    """A status file without its last line if that one stands for fewer increments than the others there:
    the run that goes on writes it anew."""
    last = int(status.split()[-6])
    stride = 1
    while last > 10000*stride:
        stride *= 10
    return status if last % stride == 0 else status[:status.rstrip().rindex(b'\n') + 1]


def full_pipe():
    """A pipe that takes no more: who writes to it waits."""
    reader, writer = os.pipe()
    fcntl.fcntl(writer, PIPE_SIZE, 4096)
    os.set_blocking(writer, False)
    try:
        while True:
            os.write(writer, b'x'*4096)
    except BlockingIOError:
        os.set_blocking(writer, True)
    return reader, writer


def check_killed_at_once(checks):
    """Taken up again and killed when it wants to say its first word: no line is lost."""
    for name in ('deck.h5', './deck.h5'):
        place, log, status = interrupted(checks)
        reader, writer = full_pipe()
        run = Started(place, ['run', 'deck.inp', '-o', 'deck.h5', '--restart', name], None, stdout=writer)
        run.wait_for('deck.h5.part')
        time.sleep(RECORDED)
        going = run.process.poll() is None
        run.kill()
        for end in (reader, writer):
            os.close(end)
        checks.true(going and 'deck.h5.part' in place.names(), f'--restart {name} had begun when it was killed')
        now = place.read('deck.sta')
        checks.true(now == settled(status),
                    f'--restart {name}: all {len(settled(status))} bytes of the status file stay: {len(now)}')
        checks.true(place.read('deck.log').startswith(log), f'--restart {name}: so does the log')


def check_chain(checks):
    """Interrupted, taken up again and killed, with a line cut off, taken up and interrupted: each increment once."""
    place, _, status = interrupted(checks)
    with open(place.folder / 'deck.sta', 'ab') as lines:
        lines.write(status.splitlines()[-1][:16])
    run = place.start('--restart', 'deck.h5')
    run.wait_for('deck.h5.part')
    time.sleep(RECORDED)
    run.process.send_signal(signal.SIGTERM)
    checks.true(run.finish().status == 5, f'a run taken up again is interrupted: {run.text[:200]}')
    rows = [line.split() for line in place.read('deck.sta').decode().splitlines() if line[0] != '#']
    counts = [int(row[1]) for row in rows]
    strides = {after - before for before, after in zip(counts, counts[1:]) if before < 10000}
    checks.true(place.read('deck.sta').startswith(settled(status)) and strides == {1} and {len(row) for row in rows} == {7},
                f'a line cut off is written anew: {len(counts)} lines, strides {strides}')


def main():
    checks = Checks()
    check_killed_at_once(checks)
    check_chain(checks)
    checks.finish()


if __name__ == '__main__':
    main()
