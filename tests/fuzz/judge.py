"""Runs a mutant and says what is wrong with how it ended."""
import os
import re
import resource
import signal
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np

TIME_LIMIT = 10             # seconds after which a run is asked to stop: it may well be a long one
CPU_LIMIT = 40.0            # seconds of processor time after which it hangs
WALL_LIMIT = 600.0          # likewise, if it only waits
MEMORY_LIMIT = 1500         # MB with what sanitizers need; the program is given half of it
FILE_LIMIT = 2**31          # bytes
SANITIZERS = {
    "ASAN_OPTIONS": f"hard_rss_limit_mb={MEMORY_LIMIT}:allocator_may_return_null=1:"
                    f"max_allocation_size_mb={MEMORY_LIMIT}:quarantine_size_mb=16:exitcode=99",
    "UBSAN_OPTIONS": "print_stacktrace=1",
    "LSAN_OPTIONS": "report_objects=0",
}
# What no output may hold: signs of an error that the program did not foresee
SIGNS = re.compile(r"Fortran runtime error|AddressSanitizer:(?! failed to allocate)|runtime error:|"
                   r"LeakSanitizer|Error termination|Backtrace|ERROR STOP|^STOP\b|"
                   r"Operating system error|Assertion|terminate called|HDF5-DIAG|Segmentation|"
                   r"internal error|MUMPS.*error",
                   re.IGNORECASE | re.MULTILINE)
PLACE = re.compile(r"^error: [^\n]*?:\d+: \S")
# Columns in which NaN says that there is no value (README, the result file)
NO_VALUE = ("CDIS",)
KINDS = {0: "done", 2: "deck", 3: "file", 4: "numbers", 5: "long"}


class Verdict:
    """How a mutant ended: what kind of end it was, and what is wrong with it (empty if nothing)."""

    def __init__(self, status, faults, text, seconds, megabytes):
        self.status, self.faults, self.text = status, faults, text
        self.seconds, self.megabytes = seconds, megabytes

    @property
    def kind(self):
        """The status as a word, or 'long' or 'failed'."""
        return "failed" if self.faults else KINDS[self.status]


def start(words, folder, output):
    """Starts the program on one thread."""
    environment = {**os.environ, **SANITIZERS, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(words, cwd=folder, stdin=subprocess.DEVNULL, stdout=output,
                            stderr=subprocess.STDOUT, env=environment)


def limit_files():
    """No core files and no huge ones, from this process and those that it starts."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_LIMIT, FILE_LIMIT))


def cpu_seconds(pid):
    """Processor time of a running process."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12]))/os.sysconf("SC_CLK_TCK")


def wait_for(process):
    """Waits for the end within the bounds: status (None if killed) and usage."""
    begun, pause = time.monotonic(), 0.002
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return process.returncode, usage
        time.sleep(pause)
        pause = min(0.02, 1.3*pause)
        wall = time.monotonic() - begun
        if wall > WALL_LIMIT or (wall > CPU_LIMIT and cpu_seconds(process.pid) > CPU_LIMIT):
            process.send_signal(signal.SIGKILL)
            _, _, usage = os.wait4(process.pid, 0)
            process.returncode = -signal.SIGKILL
            return None, usage


def judge(carom, folder, command, words=()):
    """Runs `carom run` or `carom check` on folder/deck.inp and judges it."""
    folder = Path(folder)
    line = [str(carom), command, "deck.inp", "--memory", f"{MEMORY_LIMIT//2}M", *words]
    if command == "run":
        line += ["-o", "out.h5", "--quiet", "--time-limit", str(TIME_LIMIT)]
    with open(folder / "terminal", "w+b") as output:
        process = start(line, folder, output)
        status, usage = wait_for(process)
        output.seek(0)
        text = output.read(200000).decode("utf-8", "replace")
    faults = find_faults(folder, command, status, text)
    megabytes = usage.ru_maxrss/1024
    if megabytes > MEMORY_LIMIT:
        faults.append(f"{megabytes:.0f} MB of memory")
    return Verdict(status, faults, text, usage.ru_utime + usage.ru_stime, megabytes)


def find_faults(folder, command, status, text):
    """What is wrong, in words."""
    faults = []
    if SIGNS.search(text):
        sign = SIGNS.search(text)
        faults.append("output: " + text[sign.start():sign.start() + 160].splitlines()[0])
    if status is None:
        return [*faults, "hangs"]
    if status not in KINDS or (status == 5 and command == "check"):
        return [*faults, f"status {status}"]
    if status not in (0, 5):
        faults += find_faults_of_message(status, text)
    finished = ("out.h5", "out.log", "out.sta") if command == "run" and status != 2 else ()
    left = [path.name for path in folder.glob("out*") if path.name not in finished]
    faults += [f"left behind: {', '.join(left)}"] if left else []
    if command == "run" and status in (0, 4, 5):
        faults += find_faults_of_results(folder, status)
    return faults


def find_faults_of_message(status, text):
    """A message must be there, and say where in the deck it is."""
    message = text[text.find("error: "):] if "error: " in text else ""
    if len(message.strip()) < 15:
        return ["no message"]
    if status == 2 and not PLACE.match(message) and "is empty" not in message:
        return ["no place in: " + message.splitlines()[0][:100]]
    return []


def find_faults_of_results(folder, status):
    """The log ends as it should, the results can be read and are numbers."""
    faults = []
    log = folder / "out.log"
    lines = log.read_text(errors="replace").split("\n") if log.is_file() else []
    last = [line for line in lines if line.strip()][-1:] or [""]
    if status == 0 and last != ["completed"]:
        faults.append(f"last line of the log: '{last[0]}'")
    if not (folder / "out.h5").is_file():
        return faults + (["no results"] if status == 0 else [])
    try:
        with h5py.File(folder / "out.h5", "r", locking=False) as file:
            if status == 0:
                faults += find_bad_numbers(file)
            else:
                file.visititems(lambda name, item: None)
    except OSError as error:
        faults.append(f"results cannot be read: {error}")
    return faults


def find_bad_numbers(file):
    """Names of datasets that are not finite, but for those that say so."""
    bad = []

    def look(name, item):
        if not isinstance(item, h5py.Dataset) or item.dtype.kind != "f":
            return
        if name.rpartition("/")[2] in NO_VALUE:
            bad.extend([f"infinite: {name}"] if np.isinf(item[()]).any() else [])
        elif not np.isfinite(item[()]).all():
            bad.append(f"not finite: {name}")

    file.visititems(look)
    return bad[:3]
