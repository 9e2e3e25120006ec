"""Runs the points of tradeoff.py: side by side, each once, kept in a folder under its content key.

KEY.inp   the deck of the point
KEY.spec  how to run it (JSON): what `tradeoff.py --point` reads on another machine
KEY.json  how it went: status, costs, errors against the exact solution
KEY.npz   its trace
A point whose KEY.json is there is done. Files appear under their names when they are complete.
"""

import concurrent.futures
import hashlib
import json
import os
import shlex
import shutil
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path

from carom_deck import Deck, run_deck
from carom_results import Result
from carom_script import ScriptError
from tradeoff_errors import Trace, exact_errors
from tradeoff_exact import exact_solution
from tradeoff_grid import content_key, edited_deck

STATUS_WORDS = {
    1: "refused", 2: "refused", 3: "file", 4: "stopped", 5: "interrupted", 6: "internal error",
}
# The largest energy, over that at the start or the work done, that a run may have
MOST_ENERGY = 1.5
JUDGED = "2"              # another number when outcomes are judged in another way


class Interrupted(Exception):
    """Ctrl-C, or a signal to end."""


def program_digest(carom):
    """What tells this build of the program from another."""
    return hashlib.sha256(Path(carom).read_bytes()).hexdigest()


def prepare(points, given, folder):
    """Writes deck and specification of every point, sets its key; what is done stays."""
    folder.mkdir(parents=True, exist_ok=True)
    program = program_digest(given.carom)
    for point in points:
        deck = edited_deck(given.deck, point)
        point.key = content_key(deck, point, program, f"{JUDGED}|{given.exact}|{given.columns}")
        _, end = deck.time_step(point.problem)
        path = folder / f"{point.key}.inp"
        if not path.is_file():
            write_whole(path, deck.text())
        spec = {
            "key": point.key, "deck": path.name, "define": point.problem, "carom": str(given.carom),
            "exact": given.exact, "columns": given.columns, "limit": given.limit,
            "every": point.ratio or 1, "end": end,
        }
        write_whole(folder / f"{point.key}.spec", json.dumps(spec, indent=1))
        forget_late(folder / f"{point.key}.json", given.limit)


def forget_late(path, limit):
    """A run that was stopped for its time may have another try with another limit."""
    if path.is_file():
        outcome = json.loads(path.read_text())
        if outcome["state"] == "late" and outcome["limit"] != limit:
            path.unlink()


def write_whole(path, text):
    """Writes a file so that it is there completely or not at all."""
    part = path.with_name(f"{path.name}.{os.getpid()}.{threading.get_ident()}.part")
    part.write_text(text, encoding="utf-8", errors="surrogateescape")
    part.replace(path)


def is_done(folder, key):
    """Whether the outcome of a point is kept."""
    return (folder / f"{key}.json").is_file()


class Under:
    """The processes under way, so that all can be ended."""

    def __init__(self):
        self.processes, self.stopping, self.lock = set(), False, threading.Lock()

    def add(self, process):
        """Takes up a process that has begun."""
        with self.lock:
            self.processes.add(process)
            if self.stopping:
                process.kill()

    def stop(self):
        """Ends all; none is judged any more."""
        with self.lock:
            self.stopping = True
            for process in self.processes:
                process.kill()


def run_point(spec_path, under=None):
    """Runs one point by its specification and keeps its outcome, which it returns."""
    under = under or Under()
    spec_path = Path(spec_path)
    folder = spec_path.parent
    try:
        spec = json.loads(spec_path.read_text())
        key, deck = spec["key"], folder / spec["deck"]
    except (OSError, ValueError, KeyError) as error:
        raise ScriptError(f"'{spec_path}' is no specification of a point: {error}") from None
    if is_done(folder, key):
        return json.loads((folder / f"{key}.json").read_text())
    work = Path(tempfile.mkdtemp(prefix=f"{key}_", dir=folder))
    try:
        done = run_deck(spec["carom"], deck, work / "result.h5", spec["define"],
                        limit=spec["limit"], begun=under.add)
        if under.stopping or done.status in (5, -signal.SIGINT, -signal.SIGTERM):
            raise Interrupted
        outcome = judge(done, spec, deck, folder)
        write_whole(folder / f"{key}.json", json.dumps(outcome, indent=1))
        return outcome
    finally:
        shutil.rmtree(work, ignore_errors=True)


def judge(done, spec, deck, folder):
    """What is kept of a run: how it ended, what it cost, its trace and its errors."""
    outcome = {"status": done.status, "state": state_of(done), "say": reason_of(done),
               "costs": done.costs, "seconds": done.seconds, "errors": {}, "limit": spec["limit"]}
    if outcome["state"] == "refused" or not Path(done.result).is_file():
        return outcome
    try:
        trace = Trace.of_result(done.result, spec["columns"], spec["every"])
        outcome.update(look_at(trace, done))
        trace.save(folder / f"{spec['key']}.part")
        (folder / f"{spec['key']}.part").replace(folder / f"{spec['key']}.npz")
        if spec["exact"] and done.status == 0:
            values = {"end": spec["end"], **spec["define"]}
            exact = exact_solution(spec["exact"], Deck.read(deck), values)
            if exact:
                outcome["errors"] = exact_errors(done.result, exact, spec["columns"])
                outcome["exact"] = True
    except ScriptError as error:
        if outcome["state"] == "good":
            raise
        outcome["say"] += f" ({error})"
    return outcome


def state_of(done):
    """good, or what went wrong in a word."""
    if done.late:
        return "late"
    if done.status != 0:
        return STATUS_WORDS.get(done.status, "killed")
    return "good" if done.good else "stopped"


def reason_of(done):
    """Why a run is not good, in a line."""
    if done.late:
        return f"stopped after {done.seconds:.0f} s (--limit)"
    if done.status == 0:
        return ""
    lines = [line for line in done.messages.splitlines() if line.strip()]
    said = next((line for line in lines if line.startswith("error:")), done.last_line)
    return said.removeprefix("error: ")


def look_at(trace, done):
    """Whether a run that ended well has diverged, or lost impacts to the cap of events."""
    with Result(done.result) as results:
        kinds = results.events.kind
        work = results.energy.external_work
    capped = int((kinds == "limit").sum())
    found = {"capped": capped}
    if done.status != 0:
        return found
    start = max(trace.energy[0], abs(work).max(), 1e-300)
    if not trace.finite:
        found.update(state="diverged", say="not finite")
    elif trace.energy.max() > MOST_ENERGY * start:
        found.update(state="diverged", say=f"energy grew {trace.energy.max() / start:.3g} times")
    elif capped:
        found.update(state="capped", say=f"{capped} rows captured at MAX EVENTS")
    return found


def run_all(points, folder, jobs):
    """Runs what is not done yet. Ctrl-C ends the runs under way and keeps what is done."""
    waiting = [p.key for p in points if not is_done(folder, p.key)]
    bar = ProgressBar(len(points), len(points) - len(waiting))
    under = Under()

    def work(key):
        if under.stopping:
            raise Interrupted
        return run_point(folder / f"{key}.spec", under)

    pool = concurrent.futures.ThreadPoolExecutor(jobs)
    tasks = [pool.submit(work, key) for key in dict.fromkeys(waiting)]
    try:
        for task in concurrent.futures.as_completed(tasks):
            task.result()
            bar.advance()
    except BaseException as error:
        under.stop()
        pool.shutdown(wait=True, cancel_futures=True)
        if isinstance(error, (KeyboardInterrupt, Interrupted)):
            kept = sum(is_done(folder, point.key) for point in points)
            raise Interrupted(f"{kept} of {len(points)} points are kept in '{folder}'; "
                              "the same command goes on from there") from None
        raise
    finally:
        bar.close()
    pool.shutdown()
    return len(waiting)


def outcomes(points, folder):
    """The kept outcomes by key; a point that has not run is `missing`."""
    found = {}
    for point in points:
        path = folder / f"{point.key}.json"
        if path.is_file():
            found[point.key] = json.loads(path.read_text())
        else:
            found[point.key] = {"status": None, "state": "missing", "say": "has not run",
                                "costs": {}, "seconds": 0.0, "errors": {}}
    return found


def load_trace(folder, key):
    """The trace of a point, None if it left none."""
    path = folder / f"{key}.npz"
    return Trace.load(path) if path.is_file() else None


def commands(points, folder):
    """One command a line that runs a point; for GNU parallel, or the lines of a Slurm array."""
    script = Path(__file__).resolve().with_name("tradeoff.py")
    todo = [p.key for p in points if not is_done(folder, p.key)]
    return [
        shlex.join([sys.executable, str(script), "--point", str(folder.resolve() / f"{key}.spec")])
        for key in dict.fromkeys(todo)
    ]


class ProgressBar:
    """How many points are done, on a terminal only."""

    def __init__(self, total, done):
        self.total, self.done, self.begun = total, done, done
        self.started = time.perf_counter()
        self.shown = sys.stderr.isatty()
        self.draw()

    def advance(self):
        """One more."""
        self.done += 1
        self.draw()

    def draw(self):
        """The line, over the old one."""
        if not self.shown:
            return
        width = 30
        full = width * self.done // max(1, self.total)
        passed, new = time.perf_counter() - self.started, self.done - self.begun
        left = f", {passed / new * (self.total - self.done):.0f} s left" if new else ""
        bar = "#" * full + "." * (width - full)
        sys.stderr.write(f"\r[{bar}] {self.done} of {self.total} runs{left}   ")
        sys.stderr.flush()

    def close(self):
        """Ends the line."""
        if self.shown:
            sys.stderr.write("\n")
