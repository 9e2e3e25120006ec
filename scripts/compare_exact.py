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

import numpy as np
from carom_results import (
    BLACK, COLOURS, Results, ScriptError, label, make_parser, mark_events, plt, run, save,
)
from contact_solutions import bars_head_on, sliding_distance, stopping
from exact_solutions import bar_contact_force, bouncing_ball, oscillator, two_dof


def choose(results, patterns, default, count):
    """The columns to compare: as asked, else the first ones that end as given."""
    if patterns:
        chosen = results.select("history", patterns)
    else:
        known = results.columns("history")
        ending = next((e for e in default if any(n.endswith(e) for n in known)), default[0])
        chosen = [name for name in known if name.endswith(ending)][:count]
    if len(chosen) != count:
        raise ScriptError(
            f"'{results.path}': {count} column(s) like {default[0]} needed in /history, "
            f"{len(chosen)} found (--columns)"
        )
    return chosen


def fine_times(time, factor=10):
    """The times with more in between, for smooth exact curves."""
    return np.interp(np.arange(factor * (len(time) - 1) + 1) / factor, np.arange(len(time)), time)


def compare_sdof(results, given):
    """Displacement of the oscillator."""
    chosen = choose(results, given.columns, ["/U1", "/U2"], 1)
    table = results.table("history", ["time", *chosen])
    exact = oscillator(
        table["time"][-1], given.mass, given.stiffness, given.d0, given.v0, given.wall, given.e
    )
    print("exact impacts:", " ".join(f"{when:.9g}" for when in exact.impact_times[:12]))
    return table, {chosen[0]: lambda t: exact.at(t)[0]}, "displacement", None


def compare_two_dof(results, given):
    """Displacements of both masses."""
    chosen = choose(results, given.columns, ["/U1"], 2)
    table = results.table("history", ["time", *chosen])
    exact = two_dof(table["time"][-1], given.e, given.wall)
    print("exact impacts:", " ".join(f"{when:.9g}" for when in exact.impact_times[:12]))
    curves = {name: (lambda t, i=i: exact.at(t)[0][i]) for i, name in enumerate(chosen)}
    return table, curves, "displacement", None


def compare_bar(results, given):
    """Contact force; no difference is taken within 10 % of its duration around both steps."""
    begin, end = bar_contact_force([0.0])[1:]
    height = bar_contact_force([0.5 * (begin + end)])[0][0]
    return compare_plateau(results, given, height, begin, end)


def compare_bars(results, given):
    """Contact force of two bars of E = 900 and density 1, width 1."""
    force, duration, *after = bars_head_on(*given.lengths, *given.speeds)
    print("exact mean velocities after: {:.6g} {:.6g}".format(*after))
    return compare_plateau(results, given, force, given.begin, given.begin + duration)


def compare_plateau(results, given, height, begin, end):
    """A contact force that is constant for a while."""
    chosen = choose(results, given.columns, ["/CF1"], 1)
    table = results.table("history", ["time", *chosen])
    time, force = table["time"], np.abs(table[chosen[0]])
    table[chosen[0]] = force
    margin = 0.1 * (end - begin)
    away = (np.abs(time - begin) > margin) & (np.abs(time - end) > margin)
    inside = away & (time > begin) & (time < end)
    if inside.any():
        print(f"plateau: exact {height:.6g}, mean {force[inside].mean():.6g}, "
              f"standard deviation {force[inside].std() / height:.2%}")
        impulse = results.column("history", chosen[0].replace("CF1", "impulse")).sum()
        print(f"impulse: exact {height * (end - begin):.6g}, carom {abs(impulse):.6g}")

    def exact(t):
        return np.where((t >= begin) & (t < end), height, 0.0)

    return table, {chosen[0]: exact}, "contact force", away


def compare_block(results, given):
    """The way of a block."""
    chosen = choose(results, given.columns, ["/U1"], 1)
    table = results.table("history", ["time", *chosen])
    distance, stop = stopping(given.v0, given.mu, given.gravity)
    print(f"exact: stops after {distance:.9g} at time {stop:.9g}")

    def exact(t):
        return sliding_distance(t, given.v0, given.mu, given.gravity)

    return table, {chosen[0]: exact}, "displacement", None


def compare_ball(results, given):
    """Displacement of the ball, exact through the infinitely many impacts."""
    chosen = choose(results, given.columns, ["/U2", "/U1", "/U3"], 1)
    table = results.table("history", ["time", *chosen])
    rest = bouncing_ball(table["time"], given.height, given.gravity, given.e)[2]
    print(f"exact: at rest from {rest:.9g}")

    def exact(t):
        return bouncing_ball(t, given.height, given.gravity, given.e)[0] - given.height

    return table, {chosen[0]: exact}, "displacement", None


CASES = {
    "sdof": compare_sdof, "two_dof": compare_two_dof, "bar": compare_bar, "bars": compare_bars,
    "block": compare_block, "ball": compare_ball,
}


def draw(results, table, curves, quantity, counted):
    """The figure: run and exact solution above, their difference below."""
    figure, (above, below) = plt.subplots(
        2, 1, sharex=True, figsize=(9, 7), height_ratios=(2, 1), layout="constrained"
    )
    time = table["time"]
    counted = np.full(len(time), True) if counted is None else counted
    fine = fine_times(time) if len(time) < 20000 else time
    worst = 0.0
    for i, (name, exact) in enumerate(curves.items()):
        colour = COLOURS[i % len(COLOURS)]
        name_shown = f"carom: {label(name)}"
        above.plot(time, table[name], color=colour, lw=4.5, alpha=0.5, label=name_shown)
        above.plot(fine, exact(fine), color=BLACK, lw=1.1, label=None if i else "exact")
        difference = np.where(counted, table[name] - exact(time), np.nan)
        below.plot(time, difference, color=colour, lw=1.2)
        if counted.any():
            row = np.nanargmax(np.abs(difference))
            worst = max(worst, abs(difference[row]))
            print(f"max error of {name}: {abs(difference[row]):.6e} at time {time[row]:.6g}")
    mark_events(below, results.events(), time[0], time[-1])
    above.set_ylabel(quantity)
    above.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    below.set_ylabel(f"error of the\n{quantity}")
    below.set_xlabel("time")
    below.margins(x=0.01)
    below.ticklabel_format(axis="y", scilimits=(-3, 4))
    below.set_title(f"largest error {worst:.2e}", loc="right", fontsize=11)
    return figure


def main():
    parser = make_parser(__doc__)
    parser.add_argument("case", choices=list(CASES))
    parser.add_argument("result", help="result file of carom")
    parser.add_argument("--columns", default="", help="columns of /history, comma-separated")
    parser.add_argument("--e", type=restitution, help="restitution (default 1; ball 0.8)")
    parser.add_argument("--mass", type=float, default=1.0)
    parser.add_argument("--stiffness", type=float, default=1.0)
    parser.add_argument("--d0", type=float, default=1.0, help="initial displacement (1)")
    parser.add_argument("--v0", type=float, default=0.0, help="initial velocity (0)")
    parser.add_argument("--wall", type=float, default=-0.5, help="displacement at the wall (-0.5)")
    parser.add_argument("--height", type=float, default=1.0, help="initial height (1)")
    parser.add_argument("--gravity", type=float, default=9.81, help="(9.81)")
    parser.add_argument("--lengths", type=two_numbers, default=(10.0, 10.0), help="of bars (10,10)")
    parser.add_argument("--speeds", type=two_numbers, default=(5.0, -5.0), help="of bars (5,-5)")
    parser.add_argument("--begin", type=float, default=0.05, help="when the bars meet (0.05)")
    parser.add_argument("--mu", type=float, default=0.3, help="friction of the block (0.3)")
    given = parser.parse_args()
    if given.e is None:
        given.e = 0.8 if given.case == "ball" else 1.0
    with Results(given.result) as results:
        table, curves, quantity, counted = CASES[given.case](results, given)
        figure = draw(results, table, curves, quantity, counted)
        save(figure, results.output(given.output, f"_{given.case}_exact.png"))


def two_numbers(text):
    """Two numbers with a comma."""
    try:
        first, second = (float(word) for word in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError("two numbers with a comma") from None
    return first, second


def restitution(text):
    """A coefficient of restitution, 0 to 1."""
    value = float(text)
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError("0 to 1")
    return value


if __name__ == "__main__":
    run(main)
