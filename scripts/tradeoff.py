"""Speed against accuracy: runs a deck over a grid of methods and steps and says which to use.

    tradeoff.py input/sdof/sdof.inp --build build/carom --define e=1,0.6 --dt 0.2:0.001:8 --for 1e-3
    tradeoff.py input/bar/bar_implicit.inp --method TRANS,FICT,LAGR,PENALTY --stiffness 1e3,1e5

Errors are taken against the exact solution, which most decks of input/ have, or against the limit
of the finest runs. Writes tradeoff.h5, tradeoff.csv, tradeoff.png and recommended.inp into the folder
-o; points that have run are kept there and not run again. Values of an option are separated by
commas; `none` leaves a parameter out, steps and tolerances may also be first:last:count in equal
ratios.

On a farm: --emit writes one command a line (for GNU parallel, or one a task of a Slurm array), and
the same line with --collect instead gathers what they have done.
"""

import argparse
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from carom_deck import Deck, find_carom, number_text, parse_number, run_deck
from carom_plots import save
from carom_script import ScriptError
from tradeoff_advice import Row, advise, choose_cost, cost_at, fit_series, series_of
from tradeoff_errors import ERRORS, Trace, errors_against, exact_errors
from tradeoff_exact import CASES, exact_solution, recognise
from tradeoff_grid import (
    AXES, Point, complete_requests, default_axes, edited_deck, make_grid, parse_definitions, parse_steps,
    parse_values,
)
from tradeoff_output import print_table, write_csv, write_h5
from tradeoff_picture import draw
from tradeoff_reference import find_references, finer_reference, parse_reference
from tradeoff_runs import Interrupted, commands, load_trace, outcomes, prepare, run_all, run_point


def make_parser():
    """All options."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    add("deck", nargs="?", help="the deck")
    add("-o", "--output", help="folder for results (DECK's name with _tradeoff)")
    add("--carom", "--build", help="the program (build/carom of this checkout)")
    grid = parser.add_argument_group("the grid; without any of these a choice that fits the deck")
    grid.add_argument("--dt", help="steps: 0.1:0.001:8, or 0.1,0.05")
    grid.add_argument("--tolerance", help="runs with *DYNAMIC, TOLERANCE=: 1e-2:1e-6:5")
    grid.add_argument("--define", action="append", default=[], metavar="NAME=V,V",
                      help="problems: values of a *PARAMETER, as e=1,0.6; may be given again")
    grid.add_argument("--quick", action="store_true", help="fewer steps where none are given")
    for name, (_, _, _, words) in AXES.items():
        grid.add_argument(f"--{name}", metavar="V,V", dest=f"axis_{name}", help=words)
    judged = parser.add_argument_group("how it is judged")
    judged.add_argument("--error", help=f"{', '.join(ERRORS)}: which are shown; the first decides")
    judged.add_argument("--exact", help="exact solution: none, or one of " + ", ".join(CASES)
                        + "; its values as sdof:wall=-0.4 (default: known decks are recognised)")
    judged.add_argument("--reference", default="", metavar="NAME=V,…",
                        help="settings whose limit is the truth, as method=LAGRANGE")
    judged.add_argument("--columns", default="", help="columns of /history that are compared")
    judged.add_argument("--cost", help="solves, factorizations, element_updates, cpu_seconds, …")
    judged.add_argument("--for", "--tolerance-wanted", dest="wanted", default="1e-3",
                        help="the error that is wanted (1e-3)")
    judged.add_argument("--verify", action="store_true",
                        help="runs the recommendation again and checks its error")
    work = parser.add_argument_group("how it is run")
    work.add_argument("--jobs", type=int, default=cores(), help="runs side by side (all cores)")
    work.add_argument("--limit", type=float, help="seconds that a run may take")
    work.add_argument("--emit", action="store_true", help="print commands instead of running")
    work.add_argument("--collect", action="store_true", help="gather what has run, run nothing")
    work.add_argument("--point", metavar="SPEC", help="run one point: what --emit's commands do")
    return parser


def cores():
    """The cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def complete(given):
    """Checks the options and fills in what was left out: deck, grid, exact solution."""
    if not given.deck:
        raise ScriptError("name a deck")
    given.wanted_error = parse_number(given.wanted)
    if given.wanted_error is None or not given.wanted_error > 0.0:
        raise ScriptError(f"--for {given.wanted}: a number above 0")
    if given.jobs < 1 or (given.limit is not None and not given.limit > 0.0):
        raise ScriptError("--jobs must be 1 or more, --limit above 0")
    given.deck = Path(given.deck)
    deck = Deck.read(given.deck)
    given.carom = find_carom(given.carom)
    given.folder = Path(given.output or f"{given.deck.stem}_tradeoff")
    given.errors = given.error.split(",") if given.error else []
    for name in given.errors:
        if name not in ERRORS:
            raise ScriptError(f"--error {name}: there are: {', '.join(ERRORS)}")
    if given.exact is None:
        given.exact = recognise(deck) or ""
    given.exact = "" if given.exact == "none" else given.exact
    return deck


def accepted(given, settings):
    """Whether the program takes the deck with these settings."""
    deck = edited_deck(given.deck, Point(settings=settings, dt=Deck.read(given.deck).time_step()[0]))
    with tempfile.TemporaryDirectory() as work:
        deck.write(f"{work}/deck.inp")
        words = [str(given.carom), "check", f"{work}/deck.inp"]
        return subprocess.run(words, capture_output=True, check=False).returncode == 0


def grid_of(deck, given):
    """The points that the options ask for."""
    axes = {name: parse_values(getattr(given, f"axis_{name}"), name) for name in AXES
            if getattr(given, f"axis_{name}") is not None}
    steps = parse_steps(given.dt) if given.dt else None
    tolerances = []
    if given.tolerance:
        tolerances = [number_text(float(f"{t:.6g}"))
                      for t in parse_steps(given.tolerance, "--tolerance")[0]]
    if not axes and not tolerances:
        axes = default_axes(deck, lambda settings: accepted(given, settings))
    points = make_grid(deck, axes, parse_definitions(given.define), steps, tolerances, given.quick)
    for point in points:      # a case may have no exact solution for these parameters
        values = {"end": deck.time_step(point.problem)[1], **point.problem}
        if given.exact and exact_solution(given.exact, deck, values) is None:
            given.exact = ""
    if given.exact and not given.errors:
        values = {"end": deck.time_step(points[0].problem)[1], **points[0].problem}
        given.errors = list(exact_solution(given.exact, deck, values).errors)
    given.errors = given.errors or ["displacement"]
    return points


def judge(points, given):
    """Rows of all points with their errors, and how the truth was found."""
    folder = given.folder / "points"
    found = outcomes(points, folder)
    rows = []
    for point in points:
        kept = found[point.key]
        rows.append(Row(point, kept["state"], kept["say"], kept["costs"], kept["errors"]))
    if given.exact:
        return rows, {row.point.problem_text: f"the exact solution '{given.exact}'" for row in rows}
    references = find_references(rows, folder, parse_reference(given.reference))
    for row in rows:
        reference = references.get(row.point.problem_text)
        trace = load_trace(folder, row.point.key)
        able = reference and trace is not None and trace.finite
        if able and row.state in ("good", "capped", "diverged"):
            row.errors = errors_against(trace, reference)
            row.bars = dict(reference.bars)
    given.references = references
    return rows, {problem: reference.text for problem, reference in references.items()}


def report(points, given):
    """Table, sentence and files; the choice for --verify."""
    rows, truth = judge(points, given)
    groups = series_of(rows)
    rows = [row for members in groups.values() for row in members]
    cost = given.cost or choose_cost(rows)
    if given.cost and not any(cost in row.costs for row in rows):
        known = sorted({name for row in rows for name in row.costs})
        raise ScriptError(f"no run has the cost '{cost}'; there are: {', '.join(known) or 'none'}")
    fits = {(*key, error): fit_series(members, error, cost)
            for key, members in groups.items() for error in given.errors}
    spent = {key: cost_at(fit, groups[key[:2]], key[2], cost, given.wanted_error)
             for key, fit in fits.items()}
    print_table(rows, given.errors, cost, fits, spent, given.wanted_error)
    print()
    for problem, text in truth.items():
        print(f"errors{' for ' + problem if problem else ''} against {text}")
    advice = advise(rows, given.errors[0], cost, given.wanted_error)
    unknown = {row.point.problem_text for row in rows} - set(truth)
    if unknown:
        raise ScriptError(
            "no exact solution is known, and no series has three good runs whose limit could stand for "
            "one: give more steps (--dt), or other settings (--reference)"
        )
    print(f"\n{advice.sentence}")
    write_csv(given.folder / "tradeoff.csv", rows)
    write_h5(given.folder / "tradeoff.h5", rows, fits, spent, {
        "deck": str(given.deck), "recommendation": advice.sentence, "cost": cost,
        "errors": ",".join(given.errors), "truth": "; ".join(truth.values()),
    })
    figure = draw(rows, given.errors, cost, fits, given.wanted_error, advice.choice,
                  given.deck.name)
    save(figure, given.folder / "tradeoff.png")
    if advice.choice:
        path = given.folder / "recommended.inp"
        edited_deck(given.deck, advice.choice.point, own_requests=True).write(path)
        print(path)
    return advice.choice


def verify(choice, points, given):
    """Runs the recommendation again, from the deck written for it, and looks at its error."""
    if choice is None:
        raise ScriptError("nothing to verify: no run is good enough")
    deck = Deck.read(given.folder / "recommended.inp")
    complete_requests(deck)
    error, worst = given.errors[0], 0.0
    with tempfile.TemporaryDirectory(dir=given.folder) as work:
        deck.write(f"{work}/deck.inp")
        for row in choice.rows:
            done = run_deck(given.carom, f"{work}/deck.inp", f"{work}/out.h5", row.point.problem)
            if not done.good:
                raise ScriptError(f"the recommended run ended with {done.status}: {done.last_line}")
            if given.exact:
                values = {"end": deck.time_step(row.point.problem)[1], **row.point.problem}
                exact = exact_solution(given.exact, deck, values)
                errors = exact_errors(done.result, exact, given.columns)
            else:
                reference = finer_reference(row.point, points, given, work)
                trace = Trace.of_result(done.result, given.columns)
                errors = errors_against(trace, reference)
            worst = max(worst, errors[error])
    truth = "" if given.exact else " against a run twice as fine as all before"
    if worst > given.wanted_error:
        raise ScriptError(f"the recommendation fails: run again it is off by {worst:.3g}{truth}")
    print(f"verified: run again it is off by {worst:.3g}{truth}, at most {given.wanted} was wanted")


def main(arguments=None):
    """What the options ask for."""
    given = make_parser().parse_args(arguments)
    if given.point:
        print(run_point(given.point)["state"])
        return
    deck = complete(given)
    points = grid_of(deck, given)
    folder = given.folder / "points"
    prepare(points, given, folder)
    if given.emit:
        print("\n".join(commands(points, folder)))
        return
    if not given.collect:
        fresh = run_all(points, folder, given.jobs)
        print(f"{len(points)} points, {fresh} of them run now, the others kept from before")
    choice = report(points, given)
    if given.verify:
        verify(choice, points, given)


def ended(*_):
    """A signal to end counts as Ctrl-C."""
    raise KeyboardInterrupt


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, ended)
    try:
        main()
    except ScriptError as problem:
        print(f"error: {problem}", file=sys.stderr)
        sys.exit(2)
    except (Interrupted, KeyboardInterrupt) as problem:
        print(f"interrupted. {problem}", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:
        sys.exit(1)
