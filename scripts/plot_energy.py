"""Energies over time and the error of their balance: plot_energy.py RESULT.h5 [--lines]

The energies are stacked; drawn as lines with --lines, or where one of them is negative. The total
is a line. The lower panel shows the balance error.
"""

import numpy as np
from carom_plots import (
    BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, YELLOW, curve_style, deliver, head, legend_beside,
    make_parser, mark_events, plt,
)
from carom_results import Result
from carom_script import ScriptError, run
from carom_tables import Computed, envelope, minmax
from matplotlib.colors import to_rgb

PARTS = {
    "kinetic": BLUE, "strain": ORANGE, "damping": GREEN, "plastic": YELLOW, "friction": PURPLE,
    "impact_loss": RED,
}


def largest(column):
    """The largest absolute value of a column."""
    low, high = minmax(column, 1)
    return max(abs(low[0]), abs(high[0]))


def first_sums(count):
    """The sum of the first so many columns, as a function of them."""
    return lambda *columns: np.sum(columns[:count], axis=0)


def draw_stack(axes, time, sums, parts, envelope_drawn):
    """Areas below the sums of the energies so far, the highest first: each hides a part of those
    before. Of an envelope the largest value in each span of time counts."""
    if envelope_drawn:
        time = time.reshape(-1, 4).mean(axis=1)
        sums = [top.reshape(-1, 4).max(axis=1) for top in sums]
    for name, top in reversed(list(zip(parts, sums))):
        colour = 0.6 * np.array(to_rgb(PARTS[name])) + 0.4
        axes.fill_between(time, 0.0, top, color=colour, lw=0, label=name.replace("_", " "))


def draw(result, lines, with_events):
    """The figure: energies above, balance error below."""
    energy = result.energy
    if not len(energy):
        raise ScriptError(f"'{result.path}': /energy has no rows yet")
    known = [name for name in PARTS if name in energy]
    size = {name: largest(energy[name]) for name in ["total", "external_work", *known]}
    scale = max(*(size[name] for name in ["total", *known]), 1e-300)
    parts = [name for name in known if size[name] > 1e-9 * scale]
    columns = [energy[name] for name in parts]
    stacked = not lines and all(minmax(c, 1)[0][0] > -1e-3 * scale for c in columns)
    if stacked:
        columns = [Computed(first_sums(i + 1), *columns) for i in range(len(columns))]
    time, (total, work, error, *curves) = envelope(energy["time"], [
        energy["total"], energy["external_work"], energy["balance_error"], *columns])
    figure, (above, below) = plt.subplots(
        2, 1, sharex=True, figsize=(9.5, 7.4), height_ratios=(3, 1), layout="constrained"
    )
    if stacked:
        draw_stack(above, time, curves, parts, len(time) < len(energy))
    else:
        for i, (name, values) in enumerate(zip(parts, curves)):
            style = {**curve_style(i), "color": PARTS[name]}
            above.plot(time, values, **style, label=name.replace("_", " "))
    above.plot(time, total, color=BLACK, linewidth=1.4, label="total")
    if size["external_work"] > 1e-9 * scale:
        above.plot(time, work, "--", color=BLACK, linewidth=1.4, label="external work")
    below.plot(time, error, color=BLACK, linewidth=1.2)
    if with_events:
        for axes in (above, below):
            mark_events(axes, result.events, time[0], time[-1])
    above.set_ylabel("energy")
    above.set_ylim(bottom=0 if stacked else None, top=1.05 * above.get_ylim()[1])
    legend_beside(above)
    below.set_ylabel("balance error")
    below.ticklabel_format(axis="y", scilimits=(-3, 4))
    below.set_xlabel("time")
    below.margins(x=0)
    head(figure, result)
    print(f"largest balance error: {largest(energy['balance_error']):.3e}")
    return figure


def main():
    parser = make_parser(__doc__)
    parser.add_argument("--lines", action="store_true", help="lines instead of a stack")
    parser.add_argument("--events", action="store_true", help="mark impacts, captures, releases")
    given = parser.parse_args()
    with Result(given.result) as result:
        figure = draw(result, given.lines, given.events)
        deliver(figure, given, result, "_energy.png")


if __name__ == "__main__":
    run(main)
