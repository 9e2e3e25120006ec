"""What all scripts share, reading result files first: from carom_results import Results."""

import argparse
import fnmatch
import os
import sys

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

plt.rcParams.update(
    {
        "font.size": 12,
        "axes.labelsize": 13,
        "axes.titlesize": 13,
        "legend.fontsize": 11,
        "lines.linewidth": 1.6,
        "axes.grid": True,
        "grid.alpha": 0.3,
        "figure.dpi": 100,
        "savefig.dpi": 130,
        "axes.axisbelow": True,
    }
)

# Colours that remain apart for colour-blind readers (Okabe and Ito)
BLUE, ORANGE, GREEN, RED, PURPLE, SKY, YELLOW, BLACK = (
    "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#F0E442", "#000000",
)
COLOURS = [BLUE, ORANGE, GREEN, RED, PURPLE, SKY, BLACK]
EVENT_COLOURS = {"impact": RED, "capture": GREEN, "release": PURPLE}
EVENT_LINES = {"impact": "dashed", "capture": "dotted", "release": "dashdot"}

QUANTITIES = {
    "U": "displacement", "V": "velocity", "A": "acceleration", "RF": "reaction force",
    "S": "stress", "E": "strain", "PEEQ": "equivalent plastic strain", "ENER": "strain energy",
    "CF": "contact force", "CDIS": "smallest gap", "impulse": "contact impulse",
    "CPRESS": "contact pressure", "CSLIP": "slip", "CSTATE": "state of contact",
}


class ScriptError(Exception):
    """Something the user can put right; its text is all that is shown."""


def make_parser(docstring):
    """An argument parser with the result file and -o, described by the module's docstring."""
    parser = argparse.ArgumentParser(
        description=docstring, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", help="file to write (default: beside the result file)")
    return parser


def run(main):
    """Calls main(); an error the user can put right becomes one line and exit status 1."""
    try:
        main()
    except ScriptError as error:
        sys.exit(f"error: {error}")
    except BrokenPipeError:
        sys.exit(1)


class Results:
    """An open result file; use it in a `with` statement."""

    def __init__(self, path):
        self.path = path
        if not os.path.isfile(path):
            raise ScriptError(f"no result file '{path}'")
        try:  # without a lock, so that a run that still goes on can be looked at
            self.file = h5py.File(path, "r", locking=False)
        except OSError as error:
            raise ScriptError(f"cannot read '{path}' as an HDF5 file: {error}") from None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    def columns(self, group):
        """The paths of all columns of a table, in natural order (node_2 before node_10)."""
        found = []

        def note(name, item):
            if isinstance(item, h5py.Dataset):
                found.append(name)

        if isinstance(self.file.get(group), h5py.Group):
            self.file[group].visititems(note)
        return sorted(found, key=natural_key)

    def select(self, group, patterns):
        """The columns that match the comma-separated names (with * and ?), in the order given."""
        known = self.columns(group)
        chosen = []
        for pattern in filter(None, (item.strip().strip("/") for item in patterns.split(","))):
            if pattern.startswith(group.strip("/") + "/"):
                pattern = pattern[len(group.strip("/")) + 1 :]
            matching = [name for name in known if fnmatch.fnmatchcase(name, pattern)]
            if not matching:
                raise ScriptError(missing(self.path, group, pattern, known))
            chosen += [name for name in matching if name not in chosen]
        return chosen

    def column(self, group, name):
        """The values of one column."""
        item = self.file.get(f"{group}/{name}")
        if not isinstance(item, h5py.Dataset):
            raise ScriptError(missing(self.path, group, name, self.columns(group)))
        values = item[()]
        if values.dtype.kind == "S":
            values = np.char.decode(values, "utf-8", "replace")
        return values

    def table(self, group, names):
        """Columns by name, cut to the rows that all of them have."""
        values = {name: self.column(group, name) for name in names}
        rows = min(len(column) for column in values.values())
        if rows == 0:
            raise ScriptError(f"'{self.path}': /{group} has no rows yet")
        return {name: column[:rows] for name, column in values.items()}

    def description(self, group, name):
        """The description of a column, or its name if there is none."""
        text = self.file[f"{group}/{name}"].attrs.get("description", name)
        return text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text)

    def events(self):
        """The columns of /events with a row an impact; all empty where there were none."""
        names = ["time", "kind", "pair", "node", "gap_rate_before", "gap_rate_after", "impulse"]
        known = set(self.columns("events"))
        if "time" not in known:
            return {name: np.array([]) for name in names}
        values = {name: self.column("events", name) for name in names if name in known}
        rows = min(len(column) for column in values.values())
        values.setdefault("kind", np.full(rows, "impact"))
        return {name: column[:rows] for name, column in values.items()}

    def output(self, given, ending):
        """Where a picture goes: as asked, or beside the result file."""
        return given or os.path.splitext(self.path)[0] + ending


def natural_key(name):
    """A key that sorts node_2 before node_10."""
    digits = "".join(c if c.isdigit() else " " for c in name).split()
    letters = "".join("0" if c.isdigit() else c for c in name)
    head = letters.split("0")[0]
    return head, [int(d) for d in digits], name


def missing(path, group, name, known):
    """The message about a column that is not there."""
    if not known:
        return f"'{path}' has no columns in /{group} (did the deck ask for them?)"
    shown = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "")
    return f"'{path}' has no column '{name}' in /{group}; there are: {shown}"


def quantity(name):
    """The kind of a column, without its component: 'U' for node_2/U1."""
    return name.split("/")[-1].rstrip("0123456789")


def label(name):
    """A column in words: 'U1, node 2' for node_2/U1."""
    *owner, last = name.split("/")
    return f"{last}, {owner[0].replace('_', ' ', 1)}" if owner else last


def axis_label(kind):
    """The quantity on an axis in words."""
    words = QUANTITIES.get(kind)
    return f"{words} {kind}" if words and words.split()[-1] != kind else (words or kind)


def mark_events(axes, events, first, last):
    """Draws the events between two times as thin lines; many of them as ticks at the foot."""
    inside = (events["time"] >= first) & (events["time"] <= last)
    for kind in sorted(set(events["kind"][inside].tolist())):
        times = np.unique(events["time"][inside & (events["kind"] == kind)])
        colour = EVENT_COLOURS.get(kind, "0.5")
        top = 1.0 if len(times) <= 60 else 0.04
        axes.vlines(
            times, 0, top, transform=axes.get_xaxis_transform(), colors=colour,
            linewidth=1.2, linestyles=EVENT_LINES.get(kind, "solid") if top == 1.0 else "solid",
            label=f"{kind} ({len(times)})", zorder=1,
        )


def save(figure, path):
    """Writes a picture and says where it is."""
    try:
        figure.savefig(path)
    except (OSError, ValueError) as error:
        raise ScriptError(f"cannot write '{path}': {error}") from None
    plt.close(figure)
    print(path)
