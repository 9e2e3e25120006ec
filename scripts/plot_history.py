"""Histories over time: plot_history.py RESULT.h5 [--columns node_2/U1,node_2/V1] [--events]

One panel for each quantity. Names may hold * and ?, e.g. 'node_*/U1'; without --columns all
displacements are drawn, or whatever there is. --list shows the names. Of long histories the extremes
of each column of pixels are drawn.
"""

from carom_plots import (
    axis_label, curve_style, deliver, head, label, legend_beside, make_parser, mark_events, plt,
    quantity,
)
from carom_results import WRITTEN_BY, Result
from carom_script import ScriptError, run

MOST_CURVES = 24


def choose(result, patterns):
    """The columns to draw."""
    if patterns:
        chosen = [name for name in result.history.select(patterns) if name != "time"]
    else:
        known = [name for name in result.history.names if name != "time"]
        chosen = [name for name in known if quantity(name) == "U"] or known
    if not chosen and patterns:
        raise ScriptError(f"'{result.path}': --columns names nothing but the time")
    if not chosen:
        raise ScriptError(f"'{result.path}' has nothing but the time in /history "
                          f"({WRITTEN_BY['history']})")
    if len(chosen) > MOST_CURVES:
        print(f"note: only the first {MOST_CURVES} of {len(chosen)} columns are drawn")
    return chosen[:MOST_CURVES]


def common(words):
    """The word that all are, or else none."""
    return words[0] if len(set(words)) == 1 else ""


def draw(result, chosen, with_events):
    """A figure with a panel for each quantity."""
    kinds = list(dict.fromkeys(quantity(name) for name in chosen))
    table = result.history.envelope(chosen)
    time = table["time"]
    if not len(time):
        raise ScriptError(f"'{result.path}': /history has no rows yet")
    figure, panels = plt.subplots(
        len(kinds), 1, sharex=True, squeeze=False, figsize=(9.5, 2.0 + 2.9 * len(kinds)),
        layout="constrained",
    )
    above = ""
    for axes, kind in zip(panels[:, 0], kinds):
        names = [name for name in chosen if quantity(name) == kind]
        owner = common([label(name).partition(", ")[2] for name in names])
        for i, name in enumerate(names):
            axes.plot(time, table[name], **curve_style(i),
                      label=name.split("/")[-1] if owner else label(name))
        if with_events:
            mark_events(axes, result.events, time[0], time[-1])
        axes.set_ylabel(axis_label(common([name.split("/")[-1] for name in names]) or kind))
        axes.set_title(owner if owner != above else "", loc="left", fontsize=12)
        above = owner
        legend_beside(axes)
    panels[-1, 0].set_xlabel("time")
    panels[-1, 0].margins(x=0.01)
    head(figure, result)
    return figure


def main():
    parser = make_parser(__doc__)
    parser.add_argument("--columns", default="", help="columns of /history, comma-separated")
    parser.add_argument("--events", action="store_true", help="mark impacts, captures, releases")
    parser.add_argument("--list", action="store_true", help="show the column names and stop")
    given = parser.parse_args()
    with Result(given.result) as result:
        if given.list:
            print("\n".join(result.history.names))
            return
        figure = draw(result, choose(result, given.columns), given.events)
        deliver(figure, given, result, "_history.png")


if __name__ == "__main__":
    run(main)
