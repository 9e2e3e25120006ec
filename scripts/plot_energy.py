"""Energies over time and the error of their balance: plot_energy.py RESULT.h5 [--lines]

The energies are stacked; drawn as lines with --lines, or where one of them is negative. The total
is a line. The lower panel shows the balance error.
"""

import numpy as np
from carom_results import (
    BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, YELLOW, Results, make_parser, mark_events, plt, run,
    save,
)

PARTS = {
    "kinetic": BLUE, "strain": ORANGE, "damping": GREEN, "plastic": YELLOW, "friction": PURPLE,
    "impact_loss": RED,
}


def draw_parts(axes, time, parts, stacked):
    """The energies that are not zero throughout, stacked or as lines."""
    if stacked:
        axes.stackplot(
            time, *parts.values(), labels=[name.replace("_", " ") for name in parts],
            colors=[PARTS[name] for name in parts], alpha=0.55, linewidth=0,
        )
        return
    for name, values in parts.items():
        axes.plot(time, values, color=PARTS[name], label=name.replace("_", " "))


def draw(results, lines, with_events):
    """The figure: energies above, balance error below."""
    known = results.columns("energy")
    wanted = ["time", "total", "balance_error", *(name for name in PARTS if name in known)]
    table = results.table("energy", wanted)
    time, total = table["time"], table["total"]
    scale = max(np.abs(total).max(), max(np.abs(table[n]).max() for n in wanted[3:]), 1e-300)
    parts = {n: table[n] for n in wanted[3:] if np.abs(table[n]).max() > 1e-9 * scale}
    stacked = not lines and all(values.min() > -1e-3 * scale for values in parts.values())
    figure, (above, below) = plt.subplots(
        2, 1, sharex=True, figsize=(9, 7), height_ratios=(3, 1), layout="constrained"
    )
    draw_parts(above, time, parts, stacked)
    above.plot(time, total, color=BLACK, linewidth=1.2, label="total")
    if "external_work" in known:
        work = results.column("energy", "external_work")[: len(time)]
        if np.abs(work).max() > 1e-9 * scale:
            above.plot(time, work, "--", color=BLACK, linewidth=1.2, label="external work")
    below.plot(time, table["balance_error"], color=BLACK, linewidth=1.2)
    if with_events:
        for axes in (above, below):
            mark_events(axes, results.events(), time[0], time[-1])
    above.set_ylabel("energy")
    above.set_ylim(bottom=0 if stacked else None, top=1.05 * above.get_ylim()[1])
    above.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    below.set_ylabel("balance error")
    below.ticklabel_format(axis="y", scilimits=(-3, 4))
    below.set_xlabel("time")
    below.margins(x=0)
    print(f"largest balance error: {np.abs(table['balance_error']).max():.3e}")
    return figure


def main():
    parser = make_parser(__doc__)
    parser.add_argument("result", help="result file of carom")
    parser.add_argument("--lines", action="store_true", help="lines instead of a stack")
    parser.add_argument("--events", action="store_true", help="mark impacts, captures, releases")
    arguments = parser.parse_args()
    with Results(arguments.result) as results:
        figure = draw(results, arguments.lines, arguments.events)
        save(figure, results.output(arguments.output, "_energy.png"))


if __name__ == "__main__":
    run(main)
