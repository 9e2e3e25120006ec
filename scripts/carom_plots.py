"""What the scripts that draw share: style, words, events, and pictures saved or shown."""

import argparse
import collections
import os
import sys
import textwrap

import numpy as np
from carom_script import ScriptError, finite
from carom_tables import BLOCK

if "matplotlib.pyplot" not in sys.modules:  # MPLBACKEND is for --show; a wrong one stops the import
    wanted = os.environ.pop("MPLBACKEND", None)
    import matplotlib

    matplotlib.use("Agg")
    os.environ.update({"MPLBACKEND": wanted} if wanted is not None else {})
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

plt.rcParams.update(
    {
        "font.size": 13,
        "axes.labelsize": 14,
        "axes.titlesize": 13,
        "figure.titlesize": 14,
        "legend.fontsize": 12,
        "lines.linewidth": 1.8,
        "axes.grid": True,
        "grid.alpha": 0.3,
        "figure.dpi": 100,
        "savefig.dpi": 130,
        "axes.axisbelow": True,
        "svg.hashsalt": "carom",
    }
)

# Colours that remain apart for colour-blind readers (Okabe and Ito)
BLUE, ORANGE, GREEN, RED, PURPLE, SKY, YELLOW, BLACK = (
    "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#F0E442", "#000000",
)
COLOURS = [BLUE, ORANGE, GREEN, RED, PURPLE, SKY, BLACK]
DASHES = ["-", (0, (6, 2)), (0, (6, 2, 1.5, 2)), (0, (1.5, 1.5))]
EVENT_COLOURS = {"impact": RED, "capture": GREEN, "release": PURPLE}
EVENT_LINES = {"impact": "dashed", "capture": "dotted", "release": "dashdot"}
MOST_LINES = 60  # instants beyond which they are ticks at the foot
BINS_OF_TICKS = 1500  # places along an axis that ticks can have
FORMATS = (".png", ".pdf", ".svg")
WINDOWS = ("QtAgg", "TkAgg", "GTK4Agg", "GTK3Agg", "WxAgg", "MacOSX")

QUANTITIES = {
    "U": "displacement", "V": "velocity", "A": "acceleration", "RF": "reaction force",
    "S": "stress", "E": "strain", "PEEQ": "equivalent plastic strain", "ENER": "strain energy",
    "MISES": "Mises stress", "CF": "contact force", "CDIS": "smallest gap",
    "impulse": "contact impulse", "CPRESS": "contact pressure", "CSLIP": "slip",
    "CSTATE": "state of contact", "CNUM": "nodes in contact",
}


class Show(argparse.Action):
    """--show: takes a backend with windows before anything is drawn."""

    def __call__(self, parser, given, values, option=None):
        open_windows()
        given.show = True


def two_numbers(text):
    """An argument of two numbers with a comma."""
    try:
        first, second = map(finite, text.split(","))
    except (ValueError, argparse.ArgumentTypeError):
        raise argparse.ArgumentTypeError("two numbers with a comma") from None
    return first, second


def make_parser(docstring, kind="picture: .png, .pdf or .svg", first=None):
    """An argument parser with the result file, --save and --show, described by a docstring; an
    argument before the result file as (name, choices)."""
    parser = argparse.ArgumentParser(
        description=docstring, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    if first:
        parser.add_argument(first[0], choices=first[1])
    parser.add_argument("result", help="result file of carom")
    parser.add_argument("-o", "--output", "--save", dest="output", metavar="FILE",
                        help=f"{kind} (default: beside the result file, unless --show)")
    parser.add_argument("--show", nargs=0, action=Show, default=False, help="open a window")
    return parser


def open_windows():
    """Takes a backend that opens windows: that of MPLBACKEND, or the first that works."""
    wanted = os.environ.get("MPLBACKEND")
    if not wanted and sys.platform.startswith("linux") and not (
            os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise ScriptError("--show needs a display, and there is none (DISPLAY is not set): "
                          "write a file with --save NAME.png")
    for backend in (wanted,) if wanted else WINDOWS:
        try:
            plt.switch_backend(backend)
        except (ImportError, ValueError, RuntimeError):
            continue
        if backend.lower() not in ("agg", "pdf", "svg", "ps", "cairo", "template"):
            return
    raise ScriptError(f"--show: no window with {wanted or 'any of ' + ', '.join(WINDOWS)}: "
                      "python3 -m pip install PyQt6, or write a file with --save NAME.png")


def deliver(figure, given, result, ending):
    """Saves a picture as asked, or else beside the result file; shows it if asked."""
    if given.output or not given.show:
        save(figure, output(given, result, ending), close=not given.show)
    if given.show:
        plt.show()
    plt.close(figure)


def output(given, result, ending):
    """The file to write: as asked, or beside the result file."""
    return given.output or os.path.splitext(result.path)[0] + ending


def save(figure, path, close=True):
    """Writes a picture and says where it is."""
    path = str(path)
    if not path.lower().endswith(FORMATS):
        raise ScriptError(f"'{path}' should end in {', '.join(FORMATS[:-1])} or {FORMATS[-1]}")
    try:
        figure.savefig(path)
    except (OSError, ValueError) as error:
        raise ScriptError(f"cannot write '{path}': {error}") from None
    if close:
        plt.close(figure)
    print(path)


def head(figure, result, more="", width=None):
    """The deck's heading above a figure, and below it what else there is to say."""
    width = width or int(9.5 * figure.get_size_inches()[0])
    lines = [plain(line) for line in textwrap.wrap(result.title, width)[:3]]
    figure.suptitle("\n".join([*lines, *([more] if more else [])]))


def plain(text):
    """A text of the user's for a picture: its $ stand for themselves, not around mathematics."""
    return text.replace("$", r"\$")


def curve_style(number):
    """Colour and line of a curve: neighbours differ in both."""
    return {"color": COLOURS[number % len(COLOURS)], "linestyle": DASHES[number % len(DASHES)]}


def legend_beside(axes, least=2):
    """A legend to the right of the axes, where it hides nothing, of so many entries at least."""
    if len(axes.get_legend_handles_labels()[1]) >= least:
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def legend_below(figure, columns, **entries):
    """A legend at the foot of a figure of constrained layout, which makes room for it."""
    legend = figure.legend(loc="lower center", ncols=columns, **entries)
    box = legend.get_window_extent()
    height = (box.y0 + box.y1) / figure.bbox.height  # with the margin below it above it too
    figure.get_layout_engine().set(rect=(0, height, 1, 1 - height))


def quantity(name):
    """The kind of a column, without its component: 'U' for node_2/U1."""
    return name.split("/")[-1].rstrip("0123456789")


def label(name):
    """A column in words: 'U1, node 2' for node_2/U1."""
    *owner, last = name.split("/")
    return plain(f"{last}, {owner[0].replace('_', ' ', 1)}" if owner else last)


def axis_label(name):
    """A quantity or a component of it in words: 'displacement U1' for U1."""
    words = QUANTITIES.get(quantity(name))
    return f"{words} {name}" if words and words.split()[-1] != name else (words or name)


def colours_of(values, where, inner=1.0):
    """Colour map and limits for a field; beyond an inner part of the values colours stay the same."""
    if not np.isfinite(values).all():
        raise ScriptError(f"{where} has values that are no numbers")
    low, high = (float(v) for v in np.quantile(values, (0.5 - 0.5 * inner, 0.5 + 0.5 * inner)))
    colours = "viridis"
    if low < 0 < high and min(-low, high) > 0.05 * max(-low, high):
        low, high = -max(-low, high), max(-low, high)
        colours = "coolwarm"
    if high - low <= 1e-12 * max(abs(low), abs(high), 1e-300):
        low, high = low - (abs(low) * 0.01 or 1.0), high + (abs(high) * 0.01 or 1.0)
    return {"cmap": colours, "clim": (low, high)}


def mark_events(axes, events, first, last):
    """Draws the events between two times as thin lines; many of them as ticks at the foot."""
    for kind, (count, times) in event_times(events, first, last).items():
        top = 1.0 if len(times) <= MOST_LINES else 0.04
        axes.vlines(
            times, 0, top, transform=axes.get_xaxis_transform(), zorder=1, linewidth=1.2,
            colors=EVENT_COLOURS.get(kind, "0.5"), label=f"{kind} ({count})",
            linestyles=EVENT_LINES.get(kind, "solid") if top == 1.0 else "solid",
        )


def event_times(events, first, last):
    """The events between two times by kind: how many, and the times at which to draw them."""
    found, counts, span = {}, collections.Counter(), max(last - first, 1e-300)
    for begin in range(0, len(events), BLOCK):
        rows = slice(begin, begin + BLOCK)
        times, kinds = events["time"][rows], events["kind"][rows]
        inside = (times >= first) & (times <= last)
        for kind in np.unique(kinds[inside]).tolist():
            chosen = times[inside & (kinds == kind)]
            counts[kind] += len(chosen)
            found.setdefault(kind, []).append(np.unique(chosen))
    drawn = {}
    for kind, parts in sorted(found.items()):
        times = np.unique(np.concatenate(parts))
        if len(times) > BINS_OF_TICKS:
            places = np.unique(np.floor((times - first) / span * BINS_OF_TICKS))
            times = first + (places + 0.5) / BINS_OF_TICKS * span
        drawn[kind] = counts[kind], times
    return drawn
