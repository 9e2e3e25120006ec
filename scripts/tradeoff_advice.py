"""What the runs of tradeoff.py say: fitted orders, the front, which settings to use."""

import math
from dataclasses import dataclass, field

import numpy as np

FEWEST = 3                # points that a fit needs
LARGEST = 0.5             # beyond it an error says nothing but that all is wrong
# Ways in which points lie on a line: rms of log10(error) about it, least slope (below, an error does
# not go down with the step), and whether the line must go down to the finest step
CLEAN, SCATTERED = (0.08, 0.5, False), (0.25, 0.7, True)
FLAT = 1.3                # largest over smallest error of steps that make no difference
ROUND_OFF = 1e-11         # errors as small as this are none


@dataclass
class Row:
    """A point with its outcome: errors and their bars by name, costs by name."""

    point: object
    state: str
    say: str = ""
    costs: dict = field(default_factory=dict)
    errors: dict = field(default_factory=dict)
    bars: dict = field(default_factory=dict)

    def good(self, error):
        """Whether the run is good and has this error as a number."""
        return self.state == "good" and math.isfinite(self.errors.get(error, math.nan))

    def at_most(self, error, wanted):
        """Whether the error is surely small enough, its bar included."""
        return self.good(error) and self.errors[error] + self.bars.get(error, 0.0) <= wanted


@dataclass
class Fit:
    """error = C dt^order over some of the points of a series, `slope` that over the cost."""

    order: float = math.nan
    deviation: float = math.nan
    slope: float = math.nan
    rows: list = field(default_factory=list)      # those on the line
    verdict: str = "too few points"
    floor: float = None                           # where finer steps gain nothing more
    of_tolerance: bool = False                    # the order is that in TOLERANCE

    @property
    def text(self):
        """In words, for legends."""
        if not self.rows:
            return self.verdict
        order = f"order {self.order:.2f}" + (" in TOLERANCE" if self.of_tolerance else "")
        return order if self.floor is None else f"{order}, floor {self.floor:.1e}"


def grouped(rows, key):
    """Rows by a key, in the order of their first appearance."""
    groups = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def series_of(rows):
    """The rows of each series of each problem, from coarse to fine: {(problem, series): rows}."""
    groups = grouped(rows, lambda row: (row.point.problem_text, row.point.series))
    for members in groups.values():
        members.sort(key=lambda row: -step_of(row))
    return groups


def step_of(row):
    """The step, or the tolerance that takes its place."""
    return row.point.dt if row.point.tolerance is None else float(row.point.tolerance)


def fit_series(rows, error, cost):
    """The order of a series, from the longest part of it that is a straight line (log-log)."""
    rows = [r for r in rows if r.good(error)]
    if len(rows) >= FEWEST and all(r.errors[error] <= ROUND_OFF for r in rows):
        return Fit(verdict="exact but for round-off")
    # what is not above its bar says nothing about the order
    rows = [r for r in rows if r.errors[error] > 2.0 * r.bars.get(error, 0.0)]
    small = [r for r in rows if r.errors[error] <= LARGEST]
    if len(small) < FEWEST:
        wrong = len(rows) >= FEWEST
        return Fit(verdict=f"no convergence (errors above {LARGEST})") if wrong else Fit()
    x = np.log10([step_of(r) for r in small])
    y = np.log10([r.errors[error] for r in small])
    flat = flat_tail(y)
    part = slice(0, len(y) - flat)
    window = asymptotic_part(x[part], y[part])
    floor = float(np.median(10.0 ** y[-flat:])) if flat else None
    if window is None:
        order, deviation, _ = line(x, y)
        falls = order >= CLEAN[1] and np.all(np.diff(y) < math.log10(FLAT))
        return Fit(order, deviation, verdict=f"levels off at {floor:.1e}" if flat else
                   "no clear order" if falls else f"no convergence (slope {order:.2f})")
    first, last, order, deviation = window
    end, after = 10.0 ** y[last - 1], 10.0 ** y[last:]
    if len(after) and end > 1e3 * ROUND_OFF:
        if after.max() > 1.5 * end:
            return Fit(order, deviation, verdict="no convergence (errors grow again)")
        if len(after) > 1 and after.max() > 2.0 * after.min():
            lowest = f"{after.min():.1e}"
            return Fit(order, deviation, verdict=f"no convergence (scatters down to {lowest})")
    if len(after) > 1 and floor is None:
        floor = float(np.median(after))
    chosen = small[first:last]
    return Fit(order, deviation, cost_slope(chosen, error, cost), chosen, "", floor,
               chosen[0].point.tolerance is not None)


def asymptotic_part(x, y):
    """Where the points are on a line, as `best_window` has it: a clean one unless one twice as long
    goes through scattered points."""
    clean, scattered = best_window(x, y, *CLEAN), best_window(x, y, *SCATTERED)
    if clean and scattered:
        lengths = [x[window[0]] - x[window[1] - 1] for window in (clean, scattered)]
        return clean if lengths[0] > 0.5 * lengths[1] else scattered
    return clean or scattered


def flat_tail(y):
    """How many of the finest points are at one level; 0 if that is less than a fit needs."""
    n = max((n for n in range(1, len(y) + 1) if np.ptp(y[-n:]) <= math.log10(FLAT)), default=0)
    return n if n >= FEWEST else 0


def best_window(x, y, scatter, least, to_the_end):
    """The longest row of points on a falling line: first, last + 1, slope, its standard error."""
    best, most = None, 0.0
    for first in range(len(x) - FEWEST + 1):
        for last in range(first + FEWEST, len(x) + 1):
            slope, deviation, rms = line(x[first:last], y[first:last])
            length = x[first] - x[last - 1]
            sure = slope >= least and slope > 3.0 * deviation and rms <= scatter
            sure = sure and (last == len(x) or not to_the_end)
            if sure and length > most + 1e-9 and length >= 0.34 * (x[0] - x[-1]):
                best, most = (first, last, slope, deviation), length
    return best


def line(x, y):
    """Slope, its standard error and the rms of the residuals of a straight line."""
    slope, start = np.polyfit(x, y, 1)
    rest = y - slope * x - start
    free = max(1, len(x) - 2)
    deviation = math.sqrt(np.sum(rest**2) / free / np.sum((x - x.mean()) ** 2))
    return float(slope), deviation, float(np.sqrt(np.mean(rest**2)))


def cost_at(fit, members, error, cost, wanted):
    """What a series costs at an error: between its points, or along its fitted line beyond them (then
    the second value is False); None where there is no line to go by."""
    rows = [r for r in members if r.good(error) and r.errors[error] > 0.0 and r.costs.get(cost)]
    for coarse, fine in zip(rows, rows[1:]):
        between = coarse.errors[error] >= wanted > fine.errors[error]
        if between and reaches(rows, fine, error, wanted):
            part = math.log(coarse.errors[error] / wanted) / math.log(
                coarse.errors[error] / fine.errors[error])
            return coarse.costs[cost] * (fine.costs[cost] / coarse.costs[cost]) ** part, True
    if not fit.rows or fit.floor is not None or not fit.slope < 0.0:
        return None
    last = fit.rows[-1]
    return last.costs[cost] * (wanted / last.errors[error]) ** (1.0 / fit.slope), False


def reaches(rows, first, error, wanted):
    """Whether a row and all finer ones are below an error."""
    return all(row.errors[error] <= wanted for row in rows[rows.index(first):])


def cost_slope(rows, error, cost):
    """The slope of the error over the cost."""
    spent = np.array([row.costs.get(cost, math.nan) for row in rows])
    if not (np.isfinite(spent).all() and (spent > 0).all()) or np.ptp(np.log(spent)) == 0.0:
        return math.nan
    return float(np.polyfit(np.log(spent), np.log([row.errors[error] for row in rows]), 1)[0])


def front(rows, error, cost):
    """The rows that no other one beats in both error and cost, from cheap to dear."""
    able = [row for row in rows if row.good(error) and row.costs.get(cost) is not None]
    best, kept = math.inf, []
    for row in sorted(able, key=lambda r: (r.costs[cost], r.errors[error])):
        if row.errors[error] < best:
            best = row.errors[error]
            kept.append(row)
    return kept


@dataclass
class Choice:
    """One setting with one step over all problems: the worst error, the largest cost."""

    rows: list
    error: float
    bar: float
    cost: float
    sure: bool        # good in all problems, and so are all finer steps of its series

    @property
    def point(self):
        return self.rows[0].point

    @property
    def text(self):
        """Settings and step in words."""
        plain = not self.point.settings and self.point.tolerance is None
        series = "the deck as it is" if plain else self.point.series
        if self.point.tolerance is not None:
            return series.removesuffix("TOLERANCE") + self.point.step_text
        return f"{series} with {self.point.step_text}"


def choices(rows, error, cost, wanted):
    """All settings and steps that were good in every problem."""
    problems = len({row.point.problem_text for row in rows})
    reliable = {id(row) for members in series_of(rows).values()
                for row in reliable_rows(members, error, wanted)}
    found = []
    for members in grouped(rows, lambda r: (r.point.series, r.point.step_text)).values():
        if len(members) < problems or not all(row.good(error) for row in members):
            continue
        worst = max(members, key=lambda row: row.errors[error] + row.bars.get(error, 0.0))
        found.append(Choice(
            members, worst.errors[error], worst.bars.get(error, 0.0),
            max(row.costs.get(cost, math.inf) for row in members),
            all(id(row) in reliable for row in members),
        ))
    return sorted(found, key=lambda choice: (choice.cost, choice.error))


def reliable_rows(members, error, wanted):
    """Of a series those that are good enough, as all finer ones are: no lucky hit."""
    kept = []
    for row in reversed(members):
        if not row.at_most(error, wanted):
            break
        kept.append(row)
    return kept


@dataclass
class Advice:
    """What to use for a tolerance, in a sentence; the choice is None where nothing serves."""

    sentence: str
    choice: Choice = None


def advise(rows, error, cost, wanted):
    """The cheapest settings that reach the wanted error, what they cost, what a cheaper one loses."""
    found = choices(rows, error, cost, wanted)
    sure = [choice for choice in found if choice.sure]
    if not sure:
        return Advice(nothing_serves(rows, found, error, cost, wanted))
    best = sure[0]
    words = (
        f"For an error of the {error} of at most {wanted:g} use {best.text}: it costs "
        f"{amount(best.cost, cost)} and is off by {off(best)}"
    )
    cheaper = [choice for choice in found if choice.cost < best.cost]
    if not cheaper:
        return Advice(words + "; nothing cheaper that was run ended well.", best)
    # the most accurate of the cheaper ones that were not a lucky hit, else of all
    honest = [c for c in cheaper if c.error + c.bar > wanted] or cheaper
    other = min(honest, key=lambda choice: choice.error)
    loss = f", {other.error / best.error:.3g} times as much" if best.error > ROUND_OFF else ""
    return Advice(
        words + f"; the next cheaper one, {other.text}, costs {amount(other.cost, cost)} and is off "
        f"by {off(other)}{loss}.", best,
    )


def nothing_serves(rows, found, error, cost, wanted):
    """The sentence where no run is good enough: the best one, and what its order promises."""
    if not found:
        return f"No settings ended well in all problems with an error of the {error}: see the table."
    best = min(found, key=lambda choice: choice.error + choice.bar)
    if best.error + best.bar <= wanted:
        return (
            f"Nothing run reaches an error of the {error} of {wanted:g} reliably: {best.text} is off "
            f"by {off(best)} only, but finer steps of it are worse."
        )
    words = (
        f"Nothing run reaches an error of the {error} of {wanted:g}: the best, {best.text}, is off by "
        f"{off(best)} and costs {amount(best.cost, cost)}"
    )
    fits = [fit_series(members, error, cost) for (_, series), members in series_of(rows).items()
            if series == best.point.series]
    if any(fit.verdict == Fit().verdict for fit in fits):
        return words + "; more steps of it would show whether smaller ones do."
    orders = [fit.order for fit in fits if fit.rows and fit.floor is None]
    if len(orders) < len(fits) or best.point.tolerance is not None or best.bar > best.error:
        return words + "; it does not get better with the step alone."
    ratio = (0.8 * wanted / best.error) ** (1.0 / min(orders))
    return words + (
        f"; by its order {min(orders):.2f} a step of about {best.point.dt * ratio:.2g} should do, at "
        f"{amount(best.cost / ratio, cost)} or so (not run)."
    )


def off(choice):
    """The error with its bar."""
    return f"{choice.error:.2g}" + (f" ± {choice.bar:.1g}" if choice.bar else "")


def amount(value, cost):
    """A cost in words."""
    if cost.endswith("seconds"):
        return f"{value:.3g} s" + (" of processor time" if cost.startswith("cpu") else "")
    return f"{value:.0f} {cost.replace('_', ' ')}"


def choose_cost(rows):
    """What to count: solutions, unless schemes without any or by elements alone are compared."""
    good = [row for row in rows if row.state == "good"]
    mixed = any({"scheme", "solver"} & set(row.point.settings) for row in good)
    if not mixed and all(row.costs.get("solves") for row in good):
        return "solves"
    known = all("cpu_seconds" in row.costs for row in good)
    return "cpu_seconds" if known else "elapsed_seconds"
