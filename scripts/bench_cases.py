"""The cases of bench.py: each returns its figures by name; a text stands for a figure that there is
not, and says why."""

import statistics
import sys
from pathlib import Path

import numpy as np
from bench_decks import FIELDS, explicit_block, implicit_block, parse_block
from bench_runs import Finished, last_line, step_seconds, step_size
from carom_results import Result
from carom_script import ScriptError
from exact_solutions import oscillator

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "input" / "block"))


# Words of the deck of the block, and those that stand for them
HOW = "METHOD=TRANSFORMATION"
BLOCK_IMPACTS = {
    "": (HOW, HOW + ", EVENTS=ANCHOR"),
    "_substep": None,
    "_penalty": (HOW, "METHOD=PENALTY, STIFFNESS=1800"),
}


def write(folder, name, text):
    """A deck in the folder of the benchmark."""
    path = folder / name
    path.write_text(text)
    return path


def machine(bench):
    """Rates of the machine alone."""
    found = bench.programs.kernels("machine", bench.threads)
    return {f"machine_{name}": value for name, value in found.items() if name.endswith("t")}


def matrix(bench, n, threads, seconds):
    """K* of n by n CPE8: raw figures of the driver, the skyline's and MUMPS's; kept."""
    if (n, threads) not in bench.matrices:
        deck = write(bench.work, f"q8_{n}.inp", implicit_block(n))
        found = bench.programs.kernels("matrix", deck, threads, max(0, round(seconds)))
        bench.matrices[n, threads] = {**found, **sparse(bench, n, deck, 0.5 * seconds)}
        deck.unlink()
    return bench.matrices[n, threads]


def sparse(bench, n, deck, seconds):
    """The same matrix with MUMPS; nothing in a build without it."""
    if n not in bench.sparse:
        bench.sparse[n] = bench.programs.kernels("sparse", deck, max(0, round(seconds)))
    return {k: v for k, v in bench.sparse[n].items() if k.startswith(("mumps", "direct"))}


def factor(bench, n):
    """Factor and solve of n by n CPE8 against dgemm and the memory."""
    found = matrix(bench, n, bench.threads, bench.seconds)
    bytes_read = 2 * 8 * found["profile_entries"]
    # operations as usually counted: the sum of the squared column heights
    rate = found["profile_cost"] / found["factor_seconds_1t"]
    keys = {
        f"factor_{n}_ratio_dgemm_1t": rate / found["dgemm_flops_1t"],
        f"factor_{n}_seconds_1t": found["factor_seconds_1t"],
        f"factor_{n}_gflops_1t": rate / 1e9,
        f"factor_{n}_least_operations": found["factor_operations"] / found["profile_cost"],
        f"solve_{n}_ratio_bandwidth_1t":
            bytes_read / found["solve_seconds_1t"] / found["read_bytes_1t"],
        f"solve_{n}_ms_1t": 1e3 * found["solve_seconds_1t"],
        f"assemble_{n}_seconds_1t": found["assemble_seconds_1t"],
        f"memory_{n}_ratio": found["stored_bytes"] / (8 * found["profile_entries"]),
        f"solution_{n}_error": found["solution_error_1t"],
    }
    more = f"_{bench.threads}t"
    if bench.threads > 1:
        for name in ("factor", "solve", "assemble"):
            keys[f"{name}_{n}{more}_speedup"] = (
                found[f"{name}_seconds_1t"] / found[f"{name}_seconds{more}"]
            )
        keys[f"dgemm_{n}{more}_speedup"] = found[f"dgemm_flops{more}"] / found["dgemm_flops_1t"]
        keys[f"read_{n}{more}_speedup"] = found[f"read_bytes{more}"] / found["read_bytes_1t"]
    if "mumps_factor_seconds" in found:
        own, direct = (
            found[f"{who}_factor_seconds"] + found[f"{who}_solve_seconds"]
            for who in ("mumps", "direct")
        )
        keys[f"mumps_{n}_ratio_direct"] = own / direct
        keys[f"mumps_{n}_difference"] = found["mumps_difference"]
        for name in ("analyse", "factor", "solve"):
            keys[f"mumps_{n}_{name}_seconds"] = found[f"mumps_{name}_seconds"]
            keys[f"mumps_{n}_{name}_ratio_direct"] = (
                found[f"mumps_{name}_seconds"] / found[f"direct_{name}_seconds"]
            )
    return keys


def growth(bench, sizes, memory_limit):
    """The same for many sizes, as rows of numbers; the skyline ends where its memory would not
    fit."""
    return [row_of_size(bench, n, memory_limit) for n in sizes]


def row_of_size(bench, n, memory_limit):
    """One size: what could be measured, and why the rest could not."""
    row = {"n": n, "equations": 6 * n**2 + 2 * n}
    need = 8.0 * row["equations"] * 5.2 * n     # columns are 5 n entries high and a little more
    if need > memory_limit:
        row["skipped"] = (f"the skyline needs about {need / 1e9:.0f} GB, "
                          f"{memory_limit / 1e9:.0f} GB may be used")
    elif bench.late(bench.expected_factor(n)):
        row["skipped"] = "no time left of --quick"
    else:
        row.update(bench.matrices.get((n, bench.threads)) or matrix(bench, n, 1, 0))
    if "skipped" in row and not bench.late(5.0):
        deck = write(bench.work, f"q8_{n}.inp", implicit_block(n))
        row.update(sparse(bench, n, deck, 0))
        deck.unlink()
    shown = ("factor_seconds_1t", "solve_seconds_1t", "stored_bytes", "mumps_factor_seconds",
             "mumps_solve_seconds", "mumps_bytes", "skipped")
    bench.say(f"{n} by {n}, {row['equations']:.0f} equations: " + ", ".join(
        f"{key} {row[key]:.3g}" if isinstance(row[key], float) else row[key]
        for key in shown if key in row))
    return row


def explicit(bench, n, plastic=False):
    """Element updates a second of n by n CPE4 by central differences."""
    name = "explicit_j2" if plastic else "explicit_q4"
    deck = write(bench.work, f"{name}.inp", explicit_block(n, plastic))
    threads = [1] if bench.threads == 1 else [1, bench.threads]
    times = step_seconds(bench.programs, deck, threads, bench.seconds, bench.rounds)
    keys = {f"{name}_updates_1t": n * n / times[1], f"{name}_elements": n * n,
            f"{name}_updates_cpu_1t": n * n / times[0]}
    if bench.threads > 1:
        speedup = "explicit_j2" if plastic else "explicit"
        keys[f"{speedup}_{bench.threads}t_speedup"] = times[1] / times[bench.threads]
    return keys


def output_share(bench, n):
    """Part of the time that a frame every ten steps takes, explicit n by n CPE4."""
    bare = write(bench.work, "frames_none.inp", explicit_block(n))
    full = write(bench.work, "frames.inp", explicit_block(n, requests=FIELDS))
    without = step_seconds(bench.programs, bare, [1], 0.5 * bench.seconds, bench.rounds)
    with_frames = step_seconds(bench.programs, full, [1], 0.5 * bench.seconds, bench.rounds)
    return {"output_share": 1.0 - without[1] / with_frames[1]}


def block(bench, n=40):
    """A step of n by n CPE8 that meet a wall: the deck of input/block, contact included, less its
    first steps; with steps of one size, as it is kept there, and with a penalty."""
    keys = {}
    for name, impact in BLOCK_IMPACTS.items():
        try:
            keys.update(block_with(bench, n, name, impact))
        except ScriptError as error:
            keys[f"block{name}_step_ms"] = str(error)
    return keys


def block_with(bench, n, name, impact):
    """One way to treat the impact. A run that takes too long is ended: its steps so far count."""
    from make_block import texts

    folder = bench.work / f"block{name}"
    folder.mkdir(exist_ok=True)
    for file, text in texts(n).items():
        (folder / file).write_text(text.replace(*impact) if impact else text)
    deck = folder / "block.inp"
    dt = step_size(deck)
    limit = 6.0 if bench.quick else 120.0
    keys = {}
    for threads in [1] if name or bench.quick or bench.threads == 1 else [1, bench.threads]:
        rounds = []
        for _ in range(bench.rounds):
            short = bench.programs.run(deck, threads, end=repr(2 * dt))
            long = bench.programs.run(deck, threads, limit=limit, late=True)
            rounds.append([(long[what] - short[what]) / (long["increments"] - 2)
                           for what in ("seconds", "cpu")])
            if long["late"]:
                break
        ending = "" if threads == 1 else f"_{threads}t"
        keys[f"block{name}_step_ms{ending}"] = 1e3 * min(seconds for seconds, _ in rounds)
        if threads == 1:
            keys[f"block{name}_step_cpu_ms"] = 1e3 * min(cpu for _, cpu in rounds)
    keys[f"block{name}_steps"] = long["increments"]
    if not long["late"]:
        keys[f"block{name}_solves_per_step"] = long["solves"] / long["increments"]
        keys[f"block{name}_factorizations"] = long["factorizations"]
        with Result(str(long["output"])) as results:
            keys[f"block{name}_balance_error"] = relative_balance(results)
    return keys


def relative_balance(results):
    """Largest error of the energy balance, relative to the largest kinetic energy."""
    table = results.energy.arrays(["balance_error", "kinetic"])
    return float(np.abs(table["balance_error"]).max() / table["kinetic"].max())


def sdof_text(**changes):
    """input/sdof/sdof.inp with other words."""
    text = (ROOT / "input/sdof/sdof.inp").read_text()
    for old, new in changes.values():
        if old not in text:
            raise ScriptError(f"input/sdof/sdof.inp has no '{old}' any more")
        text = text.replace(old, new)
    return text


ANCHOR = ("RESTITUTION=<e>, BETA=1/6", "RESTITUTION=<e>, EVENTS=ANCHOR")
LINEAR = ("*DYNAMIC, DIRECT", "*DYNAMIC, DIRECT, BETA=0.16666666666666667")
FAR = ("-0.5, 0, 0", "-50, 0, 0")


def sdof_error(results):
    """Largest difference to the exact displacement."""
    table = results.history.arrays(["time", "node_1/U1"])
    exact = oscillator(table["time"][-1]).at(table["time"])[0]
    return float(np.abs(table["node_1/U1"] - exact).max())


def sdof(bench, dt=0.08):
    """The whole process of the oscillator to t = 20 in 250 steps, the acceleration linear in each:
    the median of 20."""
    deck = write(bench.work, "sdof.inp", sdof_text(linear=LINEAR))
    runs = [bench.programs.run(deck, log=False, dt=dt) for _ in range(20)]
    done = [run["seconds"] for run in runs]
    with Result(str(deck.with_suffix(".h5"))) as results:
        error = sdof_error(results)
    return {"sdof_process_ms": 1e3 * statistics.median(done),
            "sdof_process_best_ms": 1e3 * min(done),
            "sdof_cpu_ms": 1e3 * min(run["cpu"] for run in runs), "sdof_error": error}


def event_solves(bench):
    """Solves that an impact adds with EVENTS=ANCHOR: the oscillator with its wall and without."""
    deck = write(bench.work, "sdof_anchor.inp", sdof_text(events=ANCHOR))
    free = write(bench.work, "sdof_free.inp", sdof_text(events=ANCHOR, wall=FAR))
    try:
        hit, alone = bench.programs.run(deck), bench.programs.run(free)
    except ScriptError as error:
        return {"event_solves": f"EVENTS=ANCHOR: {error}"}
    with Result(str(hit["output"])) as results:
        error = sdof_error(results)
    return {"event_solves": (hit["solves"] - alone["solves"]) / hit["impacts"],
            "event_factorizations": hit["factorizations"] - alone["factorizations"],
            "sdof_anchor_error": error}


def parse(bench, n):
    """Reading a deck of (n + 1)^2 nodes, and the way to its first step."""
    deck = write(bench.work, "large.inp", parse_block(n))
    size = deck.stat().st_size
    seconds = min(
        bench.programs.kernels("read", deck)["read_seconds"] for _ in range(bench.rounds)
    )
    keys = {"parse_mb_s": 1e-6 * size / seconds, "parse_nodes": (n + 1) ** 2}
    keys["parse_seconds"] = seconds
    if not bench.late(5 * seconds):
        run = bench.programs.run(deck, end=step_of(deck))
        keys["startup_1e6_s"] = run["seconds"] * 1e6 / keys["parse_nodes"]
        keys["startup_1e6_cpu_s"] = run["cpu"] * 1e6 / keys["parse_nodes"]
        keys["startup_bytes_per_node"] = run["memory"] / keys["parse_nodes"]
    deck.unlink()
    return keys


def step_of(deck):
    """The step size of a large deck, from its first lines."""
    with open(deck) as file:
        return next(line.split("=")[1].strip() for line in file if line.startswith("dt ="))


def peer(bench, script, *words, limit=60.0, python=None):
    """What a peer's script prints as `figure name value`, or why it did not."""
    path = ROOT / "tests/benchmark/peers" / f"{script}.py"
    done = Finished([python or sys.executable, "-B", path, *words], limit)
    if done.late:
        return f"stopped after {limit:.0f} s"
    if done.status == 3:
        return "not installed"
    if done.status != 0:
        return f"failed: {done.errors.strip().splitlines()[-1:] or done.status}"
    found = {}
    for line in done.output.splitlines():
        words = line.split(maxsplit=2)
        if len(words) == 3 and words[0] == "figure":
            found[words[1]] = words[2] if words[1] == "version" else float(words[2])
    return found or f"failed: {last_line(done.output)}"
