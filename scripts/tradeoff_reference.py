"""The truth of tradeoff.py where no exact solution is known: the limit of the finest runs."""

from dataclasses import replace

from carom_deck import run_deck
from carom_script import ScriptError, folded
from tradeoff_advice import grouped, series_of
from tradeoff_errors import Reference, Trace, extrapolate
from tradeoff_grid import edited_deck
from tradeoff_runs import load_trace

# Whose limit is believed first: schemes that tend to the model's own motion as the step goes to zero
TRUST = ["TRANSFORMATION", "LAGRANGE", "FICTITIOUSFORCE", "PENALTY"]


def parse_reference(text):
    """`method=LAGRANGE,beta=1/4` as a dictionary."""
    wanted = {}
    for item in filter(None, text.split(",")):
        name, equals, value = item.partition("=")
        if not equals:
            raise ScriptError(f"--reference {text}: write NAME=VALUE of the settings")
        wanted[name.strip().lower()] = folded(value)
    return wanted


def find_references(rows, folder, wanted):
    """For each problem the limit of one series: the first convergent one in the order of trust. A
    problem without three good runs of any series has none."""
    found = {}
    for problem, members in grouped(rows, lambda row: row.point.problem_text).items():
        candidates = []
        for series in series_of(members).values():
            fixed = [r for r in series if r.state == "good" and r.point.tolerance is None]
            if len(fixed) >= 3 and fits(series[0].point, wanted):
                candidates.append(fixed)
        if candidates:
            found[problem] = best_reference(candidates, folder)
    return found


def fits(point, wanted):
    """Whether a point has the settings asked for."""
    return all(folded(str(point.settings.get(n, ""))).startswith(v) for n, v in wanted.items())


def trust(point):
    """Smaller for series whose limit is believed first."""
    method = folded(point.settings.get("method", TRUST[0]))
    order = point.settings.get("order") == "4"
    restitution = point.settings.get("restitution") == "none"
    return (not order, TRUST.index(method) if method in TRUST else len(TRUST), restitution)


def best_reference(candidates, folder):
    """The limit of the most trusted series that converges, else of the most trusted one."""
    first = None
    for series in sorted(candidates, key=lambda rows: trust(rows[0].point)):
        reference = limit_of([row.point for row in series],
                             [load_trace(folder, row.point.key) for row in series[-3:]])
        if reference.convergent:
            return reference
        first = first or reference
    return first


def limit_of(points, traces):
    """The limit of the last three points, which knows whose it is."""
    reference = extrapolate([(p.dt, t) for p, t in zip(points[-3:], traces)])
    reference.text += f" of {points[-1].series}"
    reference.finest = points[-1]
    return reference


def finer_reference(point, points, given, work):
    """A truth that no point has seen: the reference's finest run once more with half its step."""
    finest = given.references[point.problem_text].finest
    finer = replace(finest, dt=0.5 * finest.dt)
    edited_deck(given.deck, finer).write(f"{work}/finer.inp")
    done = run_deck(given.carom, f"{work}/finer.inp", f"{work}/finer.h5", point.problem)
    if not done.good:
        raise ScriptError(f"the run that was to verify ended with {done.status}: {done.last_line}")
    trace = Trace.of_result(done.result, given.columns, 2 * (finest.ratio or 1))
    return Reference(trace, {}, "")
