"""A run against the exact solution: compare_exact.py sdof|two_dof|bar|bars|block|ball RESULT.h5

sdof     one mass on a spring in front of a wall (--mass --stiffness --d0 --v0 --wall --e)
two_dof  two masses on two springs, the second in front of a wall (--wall --e)
bar      an elastic bar against a wall, its contact force: 300 from 0.5 to 0.5 + 2/3
bars     two bars head-on, their contact force (--lengths --speeds --begin)
block    a block that slides to rest on a rough plane, its U1 (--v0 --mu --gravity)
ball     a ball dropped on a plane (--height --gravity --e); its U2 is the height less the initial

Draws both and their difference, and prints the largest one. --columns names the columns of
/history to compare where the choice of the script is not right.
"""

import argparse
from dataclasses import dataclass

import numpy as np
from carom_plots import (
    BLACK, COLOURS, DASHES, deliver, head, label, legend_beside, make_parser, mark_events, plt,
    two_numbers,
)
from carom_results import Result
from carom_script import ScriptError, finite, run
from carom_tables import Computed, envelope
from contact_solutions import bars_head_on, sliding_distance, stopping
from exact_solutions import bar_contact_force, bouncing_ball, oscillator, two_dof


@dataclass
class Comparison:
    """What to compare: columns of the file with functions of time."""

    curves: dict        # name: (column, exact)
    quantity: str
    counted: object = None  # function of time: whether the difference counts there


def choose(result, patterns, default, count):
    """The columns to compare: as asked, else the first ones that end as given."""
    if patterns:
        chosen = result.history.select(patterns)
    else:
        known = result.history.names
        ending = next((e for e in default if any(n.endswith(e) for n in known)), default[0])
        chosen = [name for name in known if name.endswith(ending)][:count]
    if len(chosen) != count:
        raise ScriptError(
            f"'{result.path}': {count} column(s) like {default[0]} needed in /history, "
            f"{len(chosen)} found (--columns)"
        )
    if not len(result.history):
        raise ScriptError(f"'{result.path}': /history has no rows yet")
    return chosen


def fine_times(time, factor=10):
    """The times with more in between, for smooth exact curves."""
    return np.interp(np.arange(factor * (len(time) - 1) + 1) / factor, np.arange(len(time)), time)


def compare_sdof(result, given):
    """Displacement of the oscillator."""
    (name,) = choose(result, given.columns, ["/U1", "/U2"], 1)
    exact = oscillator(
        result.history["time"][-1], given.mass, given.stiffness, given.d0, given.v0, given.wall,
        given.e
    )
    print("exact impacts:", " ".join(f"{when:.9g}" for when in exact.impact_times[:12]))
    return Comparison({name: (result.history[name], lambda t: exact.at(t)[0])}, "displacement")


def compare_two_dof(result, given):
    """Displacements of both masses."""
    chosen = choose(result, given.columns, ["/U1"], 2)
    exact = two_dof(result.history["time"][-1], given.e, given.wall)
    print("exact impacts:", " ".join(f"{when:.9g}" for when in exact.impact_times[:12]))
    curves = {name: (result.history[name], lambda t, i=i: exact.at(t)[0][i])
              for i, name in enumerate(chosen)}
    return Comparison(curves, "displacement")


def compare_bar(result, given):
    """Contact force; no difference is taken within 10 % of its duration around both steps."""
    begin, end = bar_contact_force([0.0])[1:]
    height = bar_contact_force([0.5 * (begin + end)])[0][0]
    return compare_plateau(result, given, height, begin, end)


def compare_bars(result, given):
    """Contact force of two bars of E = 900 and density 1, width 1."""
    force, duration, *after = bars_head_on(*given.lengths, *given.speeds)
    print("exact mean velocities after: {:.6g} {:.6g}".format(*after))
    return compare_plateau(result, given, force, given.begin, given.begin + duration)


def compare_plateau(result, given, height, begin, end):
    """A contact force that is constant for a while."""
    (name,) = choose(result, given.columns, ["/CF1"], 1)
    table = result.history.arrays(["time", name])
    time, force = table["time"], np.abs(table[name])
    margin = 0.1 * (end - begin)

    def away(t):
        return (np.abs(t - begin) > margin) & (np.abs(t - end) > margin)

    inside = away(time) & (time > begin) & (time < end)
    if inside.any():
        print(f"plateau: exact {height:.6g}, mean {force[inside].mean():.6g}, "
              f"standard deviation {force[inside].std() / height:.2%}")
        impulse = result.history[name.replace("CF1", "impulse")][:].sum()
        print(f"impulse: exact {height * (end - begin):.6g}, carom {abs(impulse):.6g}")

    def exact(t):
        return np.where((t >= begin) & (t < end), height, 0.0)

    size = Computed(np.abs, result.history[name])
    return Comparison({name: (size, exact)}, "contact force", away)


def compare_block(result, given):
    """The way of a block."""
    (name,) = choose(result, given.columns, ["/U1"], 1)
    distance, stop = stopping(given.v0, given.mu, given.gravity)
    print(f"exact: stops after {distance:.9g} at time {stop:.9g}")

    def exact(t):
        return sliding_distance(t, given.v0, given.mu, given.gravity)

    return Comparison({name: (result.history[name], exact)}, "displacement")


def compare_ball(result, given):
    """Displacement of the ball, exact through the infinitely many impacts."""
    (name,) = choose(result, given.columns, ["/U2", "/U1", "/U3"], 1)
    rest = bouncing_ball(np.zeros(1), given.height, given.gravity, given.e)[2]
    print(f"exact: at rest from {rest:.9g}")

    def exact(t):
        return bouncing_ball(t, given.height, given.gravity, given.e)[0] - given.height

    return Comparison({name: (result.history[name], exact)}, "displacement")


CASES = {
    "sdof": compare_sdof, "two_dof": compare_two_dof, "bar": compare_bar, "bars": compare_bars,
    "block": compare_block, "ball": compare_ball,
}


def difference(column, exact, time, counted):
    """Column less exact solution, NaN where it does not count; computed by blocks."""
    def values(found, t):
        return np.where(counted(t) if counted else True, found - exact(t), np.nan)

    return Computed(values, column, time)


def largest(errors, time):
    """The largest absolute value and its time."""
    worst, when, begin = -1.0, np.nan, 0
    for block in errors.blocks():
        size = np.abs(np.nan_to_num(block, nan=-0.0))
        row = int(np.argmax(size))
        if np.isfinite(block[row]) and size[row] > worst:
            worst, when = size[row], time[begin + row]
        begin += len(block)
    return worst, when


def draw(result, comparison):
    """The figure: run and exact solution above, their difference below."""
    figure, (above, below) = plt.subplots(
        2, 1, sharex=True, figsize=(9.5, 7.4), height_ratios=(2, 1), layout="constrained"
    )
    time, worst = result.history["time"], 0.0
    for i, (name, (column, exact)) in enumerate(comparison.curves.items()):
        colour = COLOURS[i % len(COLOURS)]
        errors = difference(column, exact, time, comparison.counted)
        shown, (found, off) = envelope(time, [column, errors])
        fine = fine_times(shown) if len(shown) < 20000 else shown
        above.plot(shown, found, color=colour, lw=4.5, alpha=0.5, label=f"carom: {label(name)}")
        above.plot(fine, exact(fine), color=BLACK, lw=1.1, label=None if i else "exact")
        below.plot(shown, off, color=colour, lw=1.4, ls=DASHES[i % len(DASHES)])
        error, when = largest(errors, time)
        if error >= 0:
            worst = max(worst, error)
            print(f"max error of {name}: {error:.6e} at time {when:.6g}")
    mark_events(below, result.events, time[0], time[-1])
    above.set_ylabel(comparison.quantity)
    legend_beside(above)
    legend_beside(below, 1)
    below.set_ylabel(f"error of the\n{comparison.quantity}")
    below.set_xlabel("time")
    below.margins(x=0.01)
    below.ticklabel_format(axis="y", scilimits=(-3, 4))
    head(figure, result, f"largest error {worst:.2e}")
    return figure


def main():
    parser = make_parser(__doc__, first=("case", list(CASES)))
    parser.add_argument("--columns", default="", help="columns of /history, comma-separated")
    parser.add_argument("--e", type=restitution, help="restitution (default 1; ball 0.8)")
    parser.add_argument("--mass", type=finite, default=1.0)
    parser.add_argument("--stiffness", type=finite, default=1.0)
    parser.add_argument("--d0", type=finite, default=1.0, help="initial displacement (1)")
    parser.add_argument("--v0", type=finite, default=0.0, help="initial velocity (0)")
    parser.add_argument("--wall", type=finite, default=-0.5, help="displacement at the wall (-0.5)")
    parser.add_argument("--height", type=finite, default=1.0, help="initial height (1)")
    parser.add_argument("--gravity", type=finite, default=9.81, help="(9.81)")
    parser.add_argument("--lengths", type=two_numbers, default=(10.0, 10.0), help="of bars (10,10)")
    parser.add_argument("--speeds", type=two_numbers, default=(5.0, -5.0), help="of bars (5,-5)")
    parser.add_argument("--begin", type=finite, default=0.05, help="when the bars meet (0.05)")
    parser.add_argument("--mu", type=finite, default=0.3, help="friction of the block (0.3)")
    given = parser.parse_args()
    if given.e is None:
        given.e = 0.8 if given.case == "ball" else 1.0
    with Result(given.result) as result:
        figure = draw(result, CASES[given.case](result, given))
        deliver(figure, given, result, f"_{given.case}_exact.png")


def restitution(text):
    """A coefficient of restitution, 0 to 1."""
    value = finite(text)
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError("0 to 1")
    return value


if __name__ == "__main__":
    run(main)
