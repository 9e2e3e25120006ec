"""Errors for tradeoff.py: what is kept of a run, and how far it is from the truth.

The truth is an exact solution, or the limit of the deck's own finest runs by Richardson's
extrapolation; then every error has a bar, the uncertainty of that limit.

displacement  largest difference over all times and columns, over the largest displacement
force         mean difference of the contact force, over its mean: the time integral of both
impulse       difference of the contact impulse at the end, over the largest impulse
energy        difference of kinetic and strain energy at the end, over their largest sum
"""

import warnings
from dataclasses import dataclass

import numpy as np

from carom_results import Result
from carom_script import ScriptError

ERRORS = ["displacement", "force", "impulse", "energy"]
MOST_ROWS = 20000
MOST_COLUMNS = 40
LEAST_ORDER = 0.3           # below, differences of successive runs show no limit
ROUND_OFF = 1e-12           # runs that differ by no more agree
LEAST_COMMON = 8            # times that runs must share to be compared


@dataclass
class Trace:
    """What is kept of a run: a row a time.

    u, v (columns, n) displacements and velocities; impulse (n) contact impulse so far;
    energy (n) kinetic and strain energy; jumps: when velocities jumped.
    """

    time: np.ndarray
    u: np.ndarray
    v: np.ndarray
    impulse: np.ndarray
    energy: np.ndarray
    jumps: np.ndarray
    columns: list

    @classmethod
    def of_result(cls, path, patterns="", every=1):
        """Reads a result file; `every` thins the rows where there are too many."""
        with Result(path) as results:
            time = results.time
            names = displacement_columns(results, patterns)
            known = results.history.names
            speeds = [name.replace("/U", "/V") for name in names]
            impulses = [name for name in known if name.endswith("/impulse")]
            rows = thinned(len(time), every)
            u = [results.history[name][:][rows] for name in names]
            v = [results.history[n][:][rows] if n in known else 0.0 * time[rows] + np.nan
                 for n in speeds]
            parts = [results.history[name][:] for name in impulses]
            total = np.cumsum(np.sum(parts, axis=0)) if parts else np.zeros(len(time))
            energy = results.energy.total
            jumps = np.unique(results.events.time)
            return cls(time[rows], table(u, time[rows]), table(v, time[rows]), total[rows], energy[rows],
                       jumps, names)

    @classmethod
    def load(cls, path):
        """What `save` wrote."""
        with np.load(path) as kept:
            parts = {name: kept[name] for name in kept.files}
        parts["columns"] = [str(name) for name in parts["columns"]]
        return cls(**parts)

    def save(self, path):
        """Writes the trace as a compressed file."""
        with open(path, "wb") as file:
            np.savez_compressed(file, **{**vars(self), "columns": np.array(self.columns, dtype=str)})

    @property
    def finite(self):
        """Whether all numbers are."""
        return all(np.isfinite(part).all() for part in (self.u, self.impulse, self.energy))


def displacement_columns(results, patterns):
    """The columns of /history to compare: as asked, else all displacements, evenly chosen if many."""
    if patterns:
        return results.history.select(patterns)
    names = [n for n in results.history.names if n.split("/")[-1] in ("U1", "U2", "U3")]
    every = -(-len(names) // MOST_COLUMNS) or 1
    return names[::every]


def table(columns, time):
    """A list of columns as an array (columns, n), also where there is none."""
    return np.array(columns) if columns else np.zeros((0, len(time)))


def thinned(n, every):
    """Which rows to keep: all, or every so many, a divisor of `every` if one is enough."""
    least = -(-n // MOST_ROWS)
    if least <= 1:
        return slice(None)
    fitting = [d for d in range(least, min(every, 4 * least) + 1) if every % d == 0]
    return slice(None, None, fitting[0] if fitting else least)


def exact_errors(path, exact, patterns=""):
    """The errors of a result file against an exact solution, by all its increments."""
    with Result(path) as results, np.errstate(all="ignore"):
        time = results.time
        found = {}
        if exact.motion:
            u = np.array([results.history[name][:] for name in exact.columns])
            truth = exact.motion(time)
            if patterns:
                chosen = [exact.columns.index(n) for n in results.history.select(patterns)
                          if n in exact.columns]
                u, truth = u[chosen], truth[chosen]
            found["displacement"] = np.max(np.abs(u - truth)) / np.max(np.abs(truth))
        names = [n for n in results.history.names if n.endswith("/impulse")]
        if exact.impulse and names:
            parts = np.sum([results.history[name][:] for name in names], axis=0)
            found.update(impulse_errors(np.cumsum(parts), exact.impulse(time)))
        if exact.energy:
            energy = results.energy.total
            truth = exact.energy(time[[0, -1]])
            found["energy"] = abs(energy[-1] - truth[-1]) / max(truth)
        return {name: float(value) for name, value in found.items()}


def impulse_errors(impulse, truth):
    """Errors of force and impulse from the impulses so far at the same times."""
    whole = np.max(np.abs(truth))
    if not whole > 0.0:
        return {}
    return {
        "force": np.sum(np.abs(np.diff(impulse) - np.diff(truth))) / np.sum(np.abs(np.diff(truth))),
        "impulse": abs(impulse[-1] - truth[-1]) / whole,
    }


@dataclass
class Reference:
    """The limit of a series: a trace at common times, how uncertain each error is, how it was found."""

    trace: Trace
    bars: dict
    text: str
    order: float = np.nan
    convergent: bool = False


def errors_against(trace, reference):
    """The errors of a trace against a reference: at the times of both where there are enough (between
    the times of the reference a velocity may jump), else at all times of the trace."""
    truth = reference.trace
    inside = trace.time <= truth.time[-1] * (1 + 1e-9)
    shared = inside & has_times(truth, trace.time)
    if np.count_nonzero(shared) >= LEAST_COMMON:
        inside = shared
    times = trace.time[inside]
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        u = at_times(truth, times)
        found = {}
        if len(u) and len(times):
            size = np.max(np.abs(truth.u))
            found["displacement"] = np.max(np.abs(trace.u[:, inside] - u)) / size if size else 0.0
        impulse = np.interp(times, truth.time, truth.impulse)
        found.update(impulse_errors(trace.impulse[inside], impulse))
        size = np.max(truth.energy)
        end = np.interp(times[-1:], truth.time, truth.energy)
        if size > 0.0:
            found["energy"] = abs(trace.energy[inside][-1] - end[0]) / size
    return {name: float(value) for name, value in found.items()}


def at_times(trace, times):
    """Displacements at other times: those of the rows where times agree, else by Hermite's cubic; in
    an interval in which the velocity jumps, from its end on the same side of the jump."""
    t = trace.time
    near = np.clip(np.searchsorted(t, times), 1, len(t) - 1)
    left, right = near - 1, near
    h = t[right] - t[left]
    x = np.clip((times - t[left]) / h, 0.0, 1.0)
    a, b = trace.u[:, left], trace.u[:, right]
    va, vb = trace.v[:, left], trace.v[:, right]
    cubic = (
        (1 + 2 * x) * (1 - x) ** 2 * a + x**2 * (3 - 2 * x) * b
        + h * (x * (1 - x) ** 2 * va - x**2 * (1 - x) * vb)
    )
    straight = a + x * (b - a)
    first = np.searchsorted(trace.jumps, t[left])
    jump = first != np.searchsorted(trace.jumps, t[right])
    when = np.append(trace.jumps, np.inf)[first]
    side = np.where(times < when, a + x * h * va, b - (1 - x) * h * vb)
    found = np.where(jump, side, cubic)
    found = np.where(np.isfinite(found), found, straight)
    found = np.where(x < 1e-7, a, found)
    return np.where(x > 1.0 - 1e-7, b, found)


def extrapolate(traces):
    """The limit of a series by Richardson from its finest runs.

    traces: (dt, Trace) from coarse to fine, three at least, the finest of which decide. The order is
    the observed one of the displacements. The bar is how far the limit moves if the finest run is left
    out; where differences do not shrink it is the spread of the three.
    """
    (h1, coarse), (h2, middle), (h3, fine) = traces[-3:]
    times = common_times(coarse, middle, fine)
    runs = [at_common(trace, times) for trace in (coarse, middle, fine)]
    first = largest_difference(runs[0], runs[1])
    second = largest_difference(runs[1], runs[2])
    order = observed_order(first, second, h1, h2, h3)
    names = f"dt = {h1:.3g}, {h2:.3g}, {h3:.3g}"
    if max(first, second) <= ROUND_OFF * largest(runs[2]):
        return Reference(fine, spread_of(runs), f"the finest run; all agree ({names})", order, True)
    if not order > LEAST_ORDER:
        spread = spread_of(runs)
        return Reference(fine, spread, f"the finest run; no convergence seen ({names})", order)
    order = min(order, 8.0)
    limit = richardson(fine, runs[1], runs[2], order, h2, h3)
    earlier = richardson(middle, runs[0], runs[1], order, h1, h2)
    bars = errors_against(at_common(earlier, times), Reference(limit, {}, ""))
    text = f"Richardson's limit of {names}, observed order {order:.2f}"
    return Reference(limit, bars, text, order, True)


def common_times(*traces):
    """The times that all traces have."""
    times = traces[0].time
    for trace in traces[1:]:
        times = times[has_times(trace, times)]
    if len(times) < LEAST_COMMON:
        raise ScriptError(
            f"the finest runs share {len(times)} times only: give --dt as first:last:count, whose "
            "steps have times in common"
        )
    return times


def has_times(trace, times):
    """Which of the times a trace has."""
    place = np.clip(np.searchsorted(trace.time, times), 1, len(trace.time) - 1)
    gap = np.minimum(abs(trace.time[place] - times), abs(trace.time[place - 1] - times))
    return gap <= 1e-9 * max(trace.time[-1], 1e-300)


def at_common(trace, times):
    """The rows of a trace at times that it has."""
    place = np.clip(np.searchsorted(trace.time, times), 1, len(trace.time) - 1)
    place -= abs(trace.time[place - 1] - times) < abs(trace.time[place] - times)
    return Trace(times, trace.u[:, place], trace.v[:, place], trace.impulse[place],
                 trace.energy[place], trace.jumps, trace.columns)


def largest_difference(one, other):
    """Of the displacements, or of the impulse where none is printed."""
    if len(one.u):
        return float(np.max(np.abs(one.u - other.u)))
    return float(np.max(np.abs(one.impulse - other.impulse)))


def largest(trace):
    """The largest displacement, or impulse where no displacement is printed."""
    return float(np.max(np.abs(trace.u if len(trace.u) else trace.impulse)))


def observed_order(first, second, h1, h2, h3):
    """p of u(h) = u + C h^p from the differences of three runs with steps h1 > h2 > h3."""
    if second == 0.0:
        return 8.0 if first > 0.0 else np.nan
    if not (np.isfinite(first) and np.isfinite(second)):
        return np.nan
    orders = np.linspace(0.01, 8.0, 1600)
    ratio = (h1**orders - h2**orders) / (h2**orders - h3**orders)
    if first / second <= ratio[0]:
        return 0.0
    return float(np.interp(first / second, ratio, orders))


def richardson(base, coarse, fine, order, h_coarse, h_fine):
    """The limit, from two runs at common times; times between keep the correction of `base` there."""
    weight = 1.0 / ((h_coarse / h_fine) ** order - 1.0)

    def corrected(name):
        change = weight * (getattr(fine, name) - getattr(coarse, name))
        old = getattr(base, name)
        if old.ndim == 1:
            return old + np.interp(base.time, fine.time, change)
        return old + np.array([np.interp(base.time, fine.time, row) for row in change]).reshape(
            old.shape)

    return Trace(base.time, corrected("u"), corrected("v"), corrected("impulse"),
                 corrected("energy"), base.jumps, base.columns)


def spread_of(runs):
    """The largest errors of the runs against each other."""
    found = {}
    for one in runs:
        for other in runs:
            if one is not other:
                for name, value in errors_against(one, Reference(other, {}, "")).items():
                    found[name] = max(found.get(name, 0.0), value)
    return found
