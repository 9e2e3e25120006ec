"""Processes that bench.py times: carom itself, the driver of its kernels, and who else computes."""

import os
import re
import subprocess
import tempfile
import time
from pathlib import Path

from carom_deck import read_costs
from carom_script import ScriptError

FEWEST_STEPS = 10
RUN_LIMIT = 600.0         # seconds that a run may take


class Finished:
    """A process that has ended: seconds, processor time, output, largest memory in bytes."""

    def __init__(self, command, limit=None, env=None):
        started = time.perf_counter()
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            process = subprocess.Popen(
                [str(word) for word in command], stdout=out, stderr=err, env=env,
                stdin=subprocess.DEVNULL,
            )
            self.late, usage = wait(process, None if limit is None else started + limit)
            self.seconds = time.perf_counter() - started
            self.status = process.returncode
            self.cpu = usage.ru_utime + usage.ru_stime
            self.memory = 1024 * usage.ru_maxrss
            out.seek(0)
            err.seek(0)
            self.output = out.read().decode("utf-8", "replace")
            self.errors = err.read().decode("utf-8", "replace")


def wait(process, deadline):
    """Waits for a process, to a deadline at most: whether it was stopped there, and its usage."""
    late = False
    while True:
        pid, status, usage = os.wait4(process.pid, 0 if deadline is None else os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return late, usage
        if time.perf_counter() > deadline and not late:
            late = True
            process.terminate()      # carom ends its increment and its files
        time.sleep(0.001)


def figures(text):
    """The lines `name number` of a text."""
    found = {}
    for line in text.splitlines():
        words = line.split()
        if len(words) == 2:
            try:
                found[words[0]] = float(words[1])
            except ValueError:
                continue
    return found


class Programs:
    """The programs of a build."""

    def __init__(self, build):
        self.carom = Path(build) / "carom"
        self.driver = Path(build) / "carom_kernels"
        for program in (self.carom, self.driver):
            if not program.is_file():
                raise ScriptError(f"no program '{program}' (scripts/bench.sh builds it)")

    def kernels(self, *words):
        """The figures that the driver of the kernels prints."""
        done = Finished([self.driver, *words])
        if done.status != 0:
            raise ScriptError(f"carom_kernels {words[0]}: {last_line(done.errors)}")
        return {**figures(done.output), "seconds": done.seconds, "memory": done.memory}

    def run(self, deck, threads=1, log=True, limit=RUN_LIMIT, late=False, **definitions):
        """A run of a deck: its seconds and memory, and what its log counts. With `late` one that is
        stopped at the limit counts up to there."""
        output = deck.with_suffix(".h5")
        command = [self.carom, "run", deck, "-o", output, "--quiet", "--overwrite",
                   "--threads", threads]
        for name, value in definitions.items():
            command += ["--define", f"{name}={value}"]
        done = Finished(command, limit)
        if done.late and not late:
            raise ScriptError(f"carom run {deck.name}: stopped after {limit:.0f} s")
        if done.status != 0 and not done.late:
            raise ScriptError(f"carom run {deck.name}: {last_line(done.errors)}")
        found = {"seconds": done.seconds, "cpu": done.cpu, "memory": done.memory, "output": output,
                 "late": done.late}
        if log:
            found["increments"] = increments(output.with_suffix(".sta"))
            found.update(counts(output))
        return found


def last_line(text):
    """What a program said last."""
    return (text.strip().splitlines() or ["ended without a word"])[0]


def increments(path):
    """Increments by the last line of a status file, which has not every one of very many."""
    return int(path.read_text().splitlines()[-1].split()[1])


def counts(result):
    """What a run has counted, from its results and its log."""
    log = result.with_suffix(".log").read_text()
    patterns = {"impacts": r"(\d+) impacts", "equations": r"(\d+) equations?, profile"}
    costs = read_costs(result)
    found = {name: costs[name] for name in ("factorizations", "solves") if name in costs}
    for name, pattern in patterns.items():
        match = re.findall(pattern, log)
        if match:
            found[name] = float(match[-1])
    return found


def step_size(deck):
    """The parameter dt of a deck."""
    return float(re.search(r"^dt = (\S+)", deck.read_text(), re.M).group(1))


def step_seconds(programs, deck, threads, seconds, rounds=2):
    """The time of a step for each number of threads, from the difference of a short and a long run
    of about so many seconds: starting and ending drop out. Under 0 the processor time of a step with
    the first number of threads: what the time would be if nobody else used the core."""
    dt = step_size(deck)

    def run(n, t):
        done = programs.run(deck, t, end=repr(n * dt))
        return [done["seconds"], done["cpu"]]

    more = FEWEST_STEPS
    short = run(FEWEST_STEPS, 1)[1]
    while True:  # how many steps are needed to see their time, whatever others do
        spent = run(FEWEST_STEPS + more, 1)[1] - short
        if spent > 0.2 * seconds or more >= 1000000:
            break
        more *= 4
    more = max(more, int(more * seconds / spent))
    best = {t: [[1e9, 1e9], [1e9, 1e9]] for t in threads}
    for _ in range(rounds):
        for t in threads:
            for i, n in enumerate((FEWEST_STEPS, FEWEST_STEPS + more)):
                best[t][i] = [min(pair) for pair in zip(best[t][i], run(n, t))]
    times = {t: (long[0] - short[0]) / more for t, (short, long) in best.items()}
    short, long = best[threads[0]]
    return {0: (long[1] - short[1]) / more, **times}


class Watch:
    """How many cores others use while our own processes compute."""

    def __init__(self):
        self.restart()

    def restart(self):
        self.time, self.all, self.own = time.perf_counter(), busy_seconds(), own_seconds()

    def others(self):
        """Cores in use by others since the start, on average; None where that is not known."""
        now = busy_seconds()
        if now is None or self.all is None:
            return None
        used = now - self.all - (own_seconds() - self.own)
        return max(0.0, used / max(1e-3, time.perf_counter() - self.time))


def own_seconds():
    """Processor time of this process and those it has waited for."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def busy_seconds():
    """Processor time of all cores since the machine started, stolen time with it."""
    try:
        words = Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:9]
    except OSError:
        return None
    user, nice, system, _, _, irq, soft, steal = map(int, words)
    return (user + nice + system + irq + soft + steal) / os.sysconf("SC_CLK_TCK")
