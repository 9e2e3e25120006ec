"""The work-precision picture of tradeoff.py: error over cost, a panel an error and problem."""

import textwrap

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from carom_plots import BLACK, COLOURS, RED, plain, plt
from tradeoff_advice import front, grouped, series_of

MARKERS = "osD^vP*Xh<>p"
DASHES = ["solid", "dashed", "dotted", "dashdot"]
COST_LABELS = {
    "solves": "solutions of equations", "factorizations": "factorizations",
    "element_updates": "element updates", "cpu_seconds": "processor time in s",
    "elapsed_seconds": "time in s", "iterations": "iterations", "increments": "increments",
}
STATE_LETTERS = {"capped": "c", "diverged": "d", "late": "l", "refused": "r", "missing": "m"}
STATE_WORDS = {"c": "capped by MAX EVENTS", "d": "diverged", "l": "out of time", "r": "refused",
               "m": "has not run", "s": "stopped"}


def draw(rows, errors, cost, fits, wanted=None, choice=None, title=""):
    """The figure."""
    problems = list(grouped(rows, lambda row: row.point.problem_text))
    names = list(dict.fromkeys(row.point.series for row in rows))
    longest = max((len(textwrap.wrap(legend_text(name, fits, e), 44))
                   for name in names for e in errors), default=1)
    figure, panels = plt.subplots(
        len(errors), len(problems), squeeze=False, layout="constrained",
        figsize=(6.2 * len(problems) + 4.6,
                 max(4.8, 0.21 * longest * len(names) + 1.5) * len(errors)),
    )
    for i, error in enumerate(errors):
        for j, problem in enumerate(problems):
            panel = panels[i][j]
            members = [row for row in rows if row.point.problem_text == problem]
            chosen = [] if i or choice is None else choice.rows
            panel_of(panel, members, error, cost, fits, names, chosen, None if i else wanted)
            panel.set_title("" if i else plain(problem or title), fontsize=12)
            if i == len(errors) - 1:
                panel.set_xlabel(COST_LABELS.get(cost, cost.replace("_", " ")))
            if j == 0:
                panel.set_ylabel(f"error of the {error}")
        legend = legend_of(panels[i], names, fits, error, wanted if i == 0 else None, choice)
        panels[i][-1].legend(handles=legend, loc="upper left", bbox_to_anchor=(1.02, 1.0),
                             borderaxespad=0.0, fontsize=10)
    if title and any(problems):
        figure.suptitle(plain(title), fontsize=13)
    return figure


def panel_of(panel, rows, error, cost, fits, names, chosen, wanted):
    """One panel: curves, fitted lines, the front, bad points at the top edge."""
    panel.set_xscale("log")
    panel.set_yscale("log")
    edge = front(rows, error, cost)
    if len(edge) > 1:
        panel.plot([r.costs[cost] for r in edge], [r.errors[error] for r in edge],
                   drawstyle="steps-post", color="0.75", lw=6, solid_capstyle="round", zorder=1)
    for (problem, series), members in series_of(rows).items():
        number = names.index(series)
        good = [r for r in members if r.good(error) and r.costs.get(cost)]
        spent = np.array([r.costs[cost] for r in good])
        values = np.array([max(r.errors[error], 1e-17) for r in good])
        bars = np.array([r.bars.get(error, 0.0) for r in good])
        style = {"color": colour_of(number), "marker": MARKERS[number % len(MARKERS)], "ms": 6.5,
                 "lw": 0.0, "zorder": 3}
        if bars.any():
            low = np.minimum(bars, 0.9 * values)
            panel.errorbar(spent, values, [low, bars], elinewidth=1.0, capsize=3, **style)
        else:
            panel.plot(spent, values, **style)
        fit = fits.get((problem, series, error))
        if fit and fit.rows:
            draw_line(panel, fit, error, cost, number)
    for row in chosen:
        if row in rows:
            panel.plot(row.costs[cost], row.errors[error], "o", ms=17, mfc="none", mec=BLACK, mew=1.8,
                       zorder=4)
    low, high = panel.get_ylim()
    if wanted is not None and wanted > 0.01 * low:
        panel.axhline(wanted, color="0.35", lw=1.2, ls=(0, (6, 3)), zorder=1)
        panel.set_ylim(min(low, 0.7 * wanted), max(high, 1.5 * wanted))
    name_ticks(panel.xaxis, panel.get_xlim())
    name_ticks(panel.yaxis, panel.get_ylim())
    mark_bad(panel, [row for row in rows if not row.good(error)], cost, names)


def name_ticks(axis, values):
    """Ticks at 1, 2, 5 with plain numbers where decades alone would be too few."""
    if max(values) / min(values) < 100.0:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def draw_line(panel, fit, error, cost, number):
    """The fitted line along the points that it is made of."""
    spent = np.array([row.costs.get(cost, np.nan) for row in fit.rows])
    if not np.isfinite(fit.slope):
        return
    values = np.log([row.errors[error] for row in fit.rows])
    height = np.mean(values) - fit.slope * np.mean(np.log(spent))
    ends = np.array([spent.min(), spent.max()])
    panel.plot(ends, np.exp(height) * ends**fit.slope, color=colour_of(number), lw=1.8,
               ls=DASHES[number // len(COLOURS) % len(DASHES)], zorder=2)


def mark_bad(panel, rows, cost, names):
    """Bad points as crosses at the top edge, each with the letter of its state."""
    known = [row.costs[cost] for row in rows if row.costs.get(cost)]
    left = panel.get_xlim()[0] if panel.lines or panel.collections else min(known, default=1.0)
    low, high = panel.get_ylim()
    panel.set_ylim(low, high * (high / low) ** 0.1)
    for place, row in enumerate(rows):
        x = row.costs.get(cost) or left
        letter = STATE_LETTERS.get(row.state, "s")
        height = 0.965 - 0.045 * (place % 3)
        panel.plot(x, height, "X", ms=9, color=colour_of(names.index(row.point.series)), mec=RED,
                   mew=1.2, transform=panel.get_xaxis_transform(), clip_on=False, zorder=5)
        panel.text(x, height, f"  {letter}", fontsize=9, color=BLACK, va="center",
                   transform=panel.get_xaxis_transform())
    panel.bad_letters = sorted({STATE_LETTERS.get(row.state, "s") for row in rows})


def legend_of(panels, names, fits, error, wanted, choice):
    """Handles of a row of panels: a line a series with its orders, the marks, the bad points."""
    handles = []
    for number, name in enumerate(names):
        handles.append(plt.Line2D(
            [], [], color=colour_of(number), marker=MARKERS[number % len(MARKERS)], ms=6.5, lw=1.8,
            ls=DASHES[number // len(COLOURS) % len(DASHES)],
            label=plain("\n".join(textwrap.wrap(legend_text(name, fits, error), 44))),
        ))
    handles.append(plt.Line2D([], [], color="0.75", lw=6, label="front: nothing is better in both"))
    if wanted is not None:
        handles.append(plt.Line2D([], [], color="0.35", lw=1.2, ls=(0, (6, 3)),
                                  label=f"wanted, {wanted:g}"))
        if choice is not None:
            handles.append(plt.Line2D([], [], marker="o", ms=14, mfc="none", mec=BLACK, mew=1.8, lw=0,
                                      label="recommended"))
    letters = sorted({letter for panel in panels for letter in panel.bad_letters})
    if letters:
        words = ", ".join(f"{letter} {STATE_WORDS[letter]}" for letter in letters)
        handles.append(plt.Line2D([], [], marker="X", ms=9, color="0.6", mec=RED, mew=1.2, lw=0,
                                  label="\n".join(textwrap.wrap(f"no result: {words}", 44))))
    return handles


def legend_text(name, fits, error):
    """A series with its fitted orders, one a problem."""
    found = [fit.text for (_, series, kind), fit in fits.items() if (series, kind) == (name, error)]
    return f"{spoken(name)}: {' | '.join(dict.fromkeys(found))}"


def spoken(name):
    """A series with its method as a word instead of a parameter."""
    words = [w.removeprefix("METHOD=").lower() if w.startswith("METHOD=") else w
             for w in name.split(", ")]
    return ", ".join(words)


def colour_of(number):
    """The colour of a series."""
    return COLOURS[number % len(COLOURS)]
