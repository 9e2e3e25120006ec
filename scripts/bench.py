"""Times carom against the machine and against others: bench.py [--quick] [--output DIR]

scripts/bench.sh builds what is needed and calls this. Writes bench.json (README.md, Benchmarks,
says what the keys mean), bench.png (time and memory against size) and shows a table. Figures with
two threads count only on an idle machine; whether it was idle is in the file.
"""

import argparse
import json
import os
import platform
import re
import time
from pathlib import Path

import bench_cases as cases
from bench_picture import draw, exponents
from bench_runs import Programs, Watch
from carom_script import ScriptError, run

# Elements along each side of the squares: 6 n^2 equations
SIZES = {
    "full": [13, 18, 29, 40, 57, 100, 130, 200, 288, 408],
    "quick": [13, 18, 29, 40, 57, 100],
    "small": [13, 18, 29],
}
QUICK_LIMIT = 100.0       # seconds after which --quick begins nothing more
IDLE = 0.15               # cores that others may use

# What is asked: (key, text, limit, whether a larger figure is better)
ASKED = [
    ("factor_100_ratio_dgemm_1t", "factor 100 x 100, part of dgemm", 0.60, True),
    ("factor_200_ratio_dgemm_1t", "factor 200 x 200, part of dgemm", 0.60, True),
    ("factor_2t_speedup", "factor, 2 threads", 1.7, True),
    ("solve_ratio_bandwidth_1t", "solve, part of the read bandwidth", 0.80, True),
    ("solve_2t_speedup", "solve, 2 threads", 1.6, True),
    ("mumps_ratio_direct", "sparse backend, time over MUMPS alone", 1.2, False),
    ("block_step_ms", "block of 40 x 40 Q8 on a wall, ms a step", 6.0, False),
    ("explicit_q4_updates_1t", "explicit Q4 updates a second", 2.0e7, True),
    ("explicit_2t_speedup", "explicit, 2 threads", 1.7, True),
    ("explicit_j2_updates_1t", "the same with J2 plasticity", 3.0e6, True),
    ("sdof_process_ms", "oscillator in 250 steps, ms", 30.0, False),
    ("sdof_error", "its largest error", 1.0e-2, False),
    ("event_solves", "solves an impact, EVENTS=ANCHOR", 3.0, False),
    ("memory_ratio", "memory over the profile's", 1.15, False),
    ("parse_mb_s", "deck read, MB/s", 50.0, True),
    ("startup_1e6_s", "start of 1e6 nodes, s", 10.0, False),
    ("output_share", "a frame in ten steps, part of the time", 0.10, False),
]
PEERS = [
    ("opensees_block", "OpenSees", "step_ms"),
    ("opensees_explicit", "OpenSees", "updates_1t"), ("akantu_explicit", "Akantu", "updates_1t"),
    ("opensees_sdof", "OpenSees", "seconds"), ("mujoco_sdof", "MuJoCo", "seconds"),
    ("exudyn_sdof", "Exudyn", "seconds"), ("calculix_block", "CalculiX", "step_ms"),
]


class Bench:
    """What the cases need, and the figures so far."""

    def __init__(self, given):
        self.quick = given.quick
        self.programs = Programs(given.build)
        self.threads = min(2, os.cpu_count() or 1)
        self.seconds = 1.0 if given.quick else 5.0        # for each figure, about
        self.rounds = 1 if given.quick else 3
        if given.sizes == "small":
            self.seconds = 0.1
        self.work = Path(given.output) / "work"
        self.work.mkdir(parents=True, exist_ok=True)
        self.matrices = {}
        self.sparse = {}
        self.figures = {}
        self.others = {}
        self.watch = Watch()
        self.started = time.perf_counter()

    def say(self, text):
        print(f"[{time.perf_counter() - self.started:5.0f} s] {text}", flush=True)

    def late(self, seconds=0.0):
        """Whether --quick has no time left for something of so many seconds."""
        return self.quick and time.perf_counter() - self.started + seconds > QUICK_LIMIT

    def expected_factor(self, n):
        """Seconds of a factorization with all that surrounds it, from the largest one so far."""
        known = [(key[0], value["seconds"]) for key, value in self.matrices.items()]
        if not known:
            return 0.0
        largest, seconds = max(known)
        return seconds * max(0.1, (n / largest) ** 3.5)

    def measure(self, name, case, *words, seconds=0.0):
        """Runs a case; one that fails leaves its reason and does not stop the others."""
        if self.late(seconds):
            self.say(f"{name}: no time left")
            self.figures[name] = "no time left of --quick"
            return
        self.watch.restart()
        try:
            found = case(self, *words)
        except ScriptError as error:
            found = {name: str(error)}
        self.others[name] = self.watch.others()
        self.figures.update(found)
        self.say(f"{name}: " + ", ".join(
            f"{key} {value:.4g}" if isinstance(value, (int, float)) else f"{key} {value}"
            for key, value in found.items()))


def read_arguments():
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", default="bench", help="folder to write (bench)")
    parser.add_argument("--build", default="build", help="the build with carom and carom_kernels")
    parser.add_argument("--quick", action="store_true", help="ends within two minutes")
    parser.add_argument("--peers", action="store_true", default=None, help="run other programs too")
    parser.add_argument("--no-peers", action="store_false", dest="peers", help="carom alone")
    parser.add_argument("--sizes", help=f"elements a side, or one of {', '.join(SIZES)}")
    parser.add_argument("--only", help="cases to run, comma-separated; all the others are left out")
    return parser.parse_args()


def chosen_sizes(given):
    """The sizes of the picture."""
    name = given.sizes or ("quick" if given.quick else "full")
    if name in SIZES:
        return SIZES[name]
    try:
        return sorted({int(word) for word in name.split(",")})
    except ValueError:
        raise ScriptError(f"--sizes {name}: numbers, or one of {', '.join(SIZES)}") from None


def free_memory():
    """Bytes that may be used."""
    try:
        text = Path("/proc/meminfo").read_text()
        return 1024.0 * int(re.search(r"MemAvailable: +(\d+)", text).group(1))
    except (OSError, AttributeError):
        return 4e9


def describe_machine():
    """Processor, cores, load, libraries."""
    try:
        model = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text()).group(1)
    except (OSError, AttributeError):
        model = platform.processor()
    return {"cpu": model, "cores": os.cpu_count(), "system": platform.platform(),
            "memory_gb": round(free_memory() / 1e9, 1), "load_average": os.getloadavg(),
            "openblas_coretype": os.environ.get("OPENBLAS_CORETYPE", "as found"),
            "date": time.strftime("%Y-%m-%d %H:%M:%S")}


def blas_of(program):
    """The BLAS a program is linked to, as the loader finds it."""
    text = cases.Finished(["ldd", program]).output
    match = re.search(r"(lib\S*blas\S*) => (\S+)", text)
    return os.path.realpath(match.group(2)) if match else "unknown"


def all_cases(small, quick):
    """(name, seconds that it may take, function, words)"""
    side = 30 if small else 200
    plastic_side = 100 if quick and not small else side
    listed = [
        ("machine", 3, cases.machine), ("sdof", 2, cases.sdof),
        ("event_solves", 1, cases.event_solves),
        ("factor", 8, cases.factor, 29 if small else 100),
        ("explicit_q4", 10, cases.explicit, side),
        ("parse", 10, cases.parse, 99 if small else 999),
        ("block", 20, cases.block, 10 if small else 40),
        ("explicit_j2", 10, cases.explicit, plastic_side, True),
    ]
    if not small:
        listed.append(("factor_200", 30, cases.factor, 200))
    listed.append(("output", 10, cases.output_share, side))
    return listed


def measure_peers(bench):
    """The other programs, each in a process of its own."""
    found = {}
    limit = 40.0 if bench.quick else 300.0
    for script, name, _ in PEERS:
        if bench.late(5.0):
            found[script] = "no time left of --quick"
            continue
        words = ["--quick"] if bench.quick else []
        answer = cases.peer(bench, script, "--work", str(bench.work), *words, limit=limit)
        found[script] = {"name": name, **answer} if isinstance(answer, dict) else answer
        bench.say(f"{script}: {found[script]}")
    return found


def headline(figures, threads):
    """The keys under the names that the README explains."""
    more = f"_{threads}t"
    largest = next((n for n in (200, 100, 29) if f"factor_{n}_seconds_1t" in figures), None)
    renamed = {"solve_ratio_bandwidth_1t": f"solve_{largest}_ratio_bandwidth_1t",
               "factor_2t_speedup": f"factor_{largest}{more}_speedup",
               "solve_2t_speedup": f"solve_{largest}{more}_speedup",
               "assemble_2t_speedup": f"assemble_{largest}{more}_speedup",
               "mumps_ratio_direct": f"mumps_{largest}_ratio_direct",
               "memory_ratio": f"memory_{largest}_ratio"}
    return {new: figures[old] for new, old in renamed.items() if old in figures}


def split_reasons(figures):
    """Figures, with null for those that are not there, and why."""
    reasons = {key: value for key, value in figures.items() if isinstance(value, str)}
    numbers = {key: value for key, value in figures.items() if not isinstance(value, str)}
    for key, *_ in ASKED:
        if key not in numbers:
            numbers[key] = None
            reasons.setdefault(key, "not measured")
    return numbers, reasons


def cpu_note(report, key):
    """The figure by processor time, where there is one: what others do counts less there."""
    for end, cpu in (("_1t", "_cpu_1t"), ("_step_ms", "_step_cpu_ms"), ("_process_ms", "_cpu_ms"),
                     ("_s", "_cpu_s")):
        value = report.get(key.removesuffix(end) + cpu) if key.endswith(end) else None
        if value is not None:
            return f"  ({value:.4g} by processor time)"
    return ""


def table(report):
    """The figures beside what is asked, as lines of text."""
    lines = [f"{'':44}{'measured':>12}{'asked':>14}"]
    for key, text, limit, larger in ASKED:
        value = report[key]
        asked = (">= " if larger else "<= ") + f"{limit:g}"
        if value is None:
            lines.append(f"{text:44}{'-':>12}{asked:>14}  {report['reasons'].get(key, '')}"[:150])
            continue
        good = value >= limit if larger else value <= limit
        note = "" if good else "  not met"
        if "2t" not in key and report["busy"]:
            note += cpu_note(report, key)
        if "2t" in key and report["busy"]:
            note = "  not counted: others use the cores"
        lines.append(f"{text:44}{value:12.4g}{asked:>14}{note}")
    for script, name, key in PEERS:
        answer = report["peers"].get(script, "left out")
        known = isinstance(answer, dict) and key in answer
        shown = f"{answer[key]:12.4g}" if known else f"{'-':>12}  {answer}"[:60]
        error = f"  error {answer['error']:.2g}" if known and "error" in answer else ""
        lines.append(f"{name + ': ' + script.split('_')[1] + ', ' + key:44}{shown}{error}")
    return "\n".join(lines)


def main():
    given = read_arguments()
    machine = describe_machine()
    sizes = chosen_sizes(given)
    limit = 0.8 * free_memory()
    bench = Bench(given)
    machine["blas"] = blas_of(bench.programs.driver)
    whole = Watch()
    only = given.only.split(",") if given.only else None
    for name, seconds, case, *words in all_cases(given.sizes == "small", given.quick):
        if only is None or name in only:
            if name == "factor_200":
                seconds = 2.5 * bench.expected_factor(200)
            bench.measure(name, case, *words, seconds=seconds)
    rows = []
    if only is None or "sizes" in only:
        rows = cases.growth(bench, sizes, limit)
        bench.figures.update(exponents(rows))
    peers = given.peers if given.peers is not None else only is None
    answers = measure_peers(bench) if peers else {}
    bench.figures.update(headline(bench.figures, bench.threads))
    numbers, reasons = split_reasons(bench.figures)
    others = whole.others()
    report = {**numbers, "peers": answers, "reasons": reasons, "sizes": rows, "machine": machine,
              "cores_used_by_others": others, "others_by_case": bench.others,
              "busy": any(used is None or used > IDLE for used in bench.others.values()),
              "quick": given.quick, "seconds": time.perf_counter() - bench.started}
    folder = Path(given.output)
    (folder / "bench.json").write_text(json.dumps(report, indent=1) + "\n")
    if len([row for row in rows if "skipped" not in row]) > 1:
        draw(rows, str(folder / "bench.png"), f"n by n CPE8, one thread, {machine['cpu']}")
    text = table(report)
    (folder / "bench.txt").write_text(text + "\n")
    print(text)
    print(folder / "bench.json")


if __name__ == "__main__":
    run(main)
