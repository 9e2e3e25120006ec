"""Histories over time: plot_history.py RESULT.h5 [--columns node_2/U1,node_2/V1] [--events]

One panel for each quantity. Names may hold * and ?, e.g. 'node_*/U1'; without --columns all
displacements are drawn, or whatever there is. --list shows the names.
"""

from carom_results import (
    COLOURS, Results, ScriptError, axis_label, label, make_parser, mark_events, plt, quantity, run,
    save,
)

MOST_CURVES = 24


def choose(results, patterns):
    """The columns to draw."""
    known = [name for name in results.columns("history") if name != "time"]
    if patterns:
        chosen = [name for name in results.select("history", patterns) if name != "time"]
    else:
        chosen = [name for name in known if quantity(name) == "U"] or known
    if not chosen:
        raise ScriptError(f"'{results.path}' has no history (the deck prints none)")
    if len(chosen) > MOST_CURVES:
        print(f"note: only the first {MOST_CURVES} of {len(chosen)} columns are drawn")
    return chosen[:MOST_CURVES]


def draw(results, chosen, with_events):
    """A figure with a panel for each quantity."""
    kinds = list(dict.fromkeys(quantity(name) for name in chosen))
    table = results.table("history", ["time", *chosen])
    figure, panels = plt.subplots(
        len(kinds), 1, sharex=True, squeeze=False, figsize=(9, 1.6 + 2.9 * len(kinds)),
        layout="constrained",
    )
    time = table["time"]
    for axes, kind in zip(panels[:, 0], kinds):
        names = [name for name in chosen if quantity(name) == kind]
        for i, name in enumerate(names):
            style = ("-", "--", ":", "-.")[i // len(COLOURS) % 4]
            axes.plot(time, table[name], style, color=COLOURS[i % len(COLOURS)], label=label(name))
        if with_events:
            mark_events(axes, results.events(), time[0], time[-1])
        axes.set_ylabel(axis_label(kind))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    panels[-1, 0].set_xlabel("time")
    panels[-1, 0].margins(x=0.01)
    return figure


def main():
    parser = make_parser(__doc__)
    parser.add_argument("result", help="result file of carom")
    parser.add_argument("--columns", default="", help="columns of /history, comma-separated")
    parser.add_argument("--events", action="store_true", help="mark impacts, captures, releases")
    parser.add_argument("--list", action="store_true", help="show the column names and stop")
    arguments = parser.parse_args()
    with Results(arguments.result) as results:
        if arguments.list:
            print("\n".join(results.columns("history")))
            return
        figure = draw(results, choose(results, arguments.columns), arguments.events)
        save(figure, results.output(arguments.output, "_history.png"))


if __name__ == "__main__":
    run(main)
