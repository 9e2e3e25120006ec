"""Tables of a result file: columns read by slices or blocks, and what is drawn of long ones."""

import collections
import fnmatch

import numpy as np
from carom_script import MissingError, need

BLOCK = 1 << 16  # rows in memory at a time
BINS = 2000  # columns of pixels that a picture has at most
DIGITS = "0123456789"  # str.isdigit takes ² too


class Rows:
    """Rows that are read when they are asked for, by blocks where there are many."""

    def blocks(self, rows=BLOCK):
        """All rows in order, so many at a time."""
        for begin in range(0, len(self), rows):
            yield self[begin : min(begin + rows, len(self))]

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self[:], dtype)


class Column(Rows):
    """A column in the file: column[a:b] reads these rows, numpy.asarray(column) all of them."""

    def __init__(self, item, name):
        self.item, self.name = item, name

    @property
    def description(self):
        """What it is, in words."""
        text = self.item.attrs.get("description", self.name)
        return text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text)

    def __len__(self):
        return len(self.item)

    def __getitem__(self, rows):
        backwards = isinstance(rows, slice) and (rows.step or 1) < 0
        values = self.item[()][rows] if backwards else self.item[rows]
        kind = self.item.dtype.kind
        if kind == "S":
            texts = np.char.decode(values, "utf-8", "replace")
            return texts if texts.ndim else str(texts)
        return self.item.asstr()[rows] if kind == "O" else values

    def __repr__(self):
        return f"<{self.name}: {self.description}, {len(self)} rows>"


class Computed(Rows):
    """Columns combined row by row: Computed(numpy.hypot, v1, v2)."""

    def __init__(self, function, *columns):
        self.function, self.columns = function, columns

    def __len__(self):
        return min(len(column) for column in self.columns)

    def __getitem__(self, rows):
        rows = slice(*rows.indices(len(self))) if isinstance(rows, slice) else rows
        return self.function(*(column[rows] for column in self.columns))


class Table:
    """Columns by name: table.NAME is an array, table["NAME"] a Column."""

    def __init__(self, columns, missing):
        self._columns, self._missing = columns, missing

    @property
    def names(self):
        """The names of the columns (node_2/U1 before node_10/U1)."""
        return sorted(self._columns, key=natural_key)

    def __contains__(self, name):
        return name in self._columns

    def __len__(self):
        return min((len(column) for column in self._columns.values()), default=0)

    def __getitem__(self, name):
        if name not in self._columns:
            raise MissingError(self._missing(name, self.names))
        return self._columns[name]

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return self[name][:]

    def __dir__(self):
        return [*super().__dir__(), *self._columns]

    def select(self, patterns):
        """The names that are the comma-separated ones, or match them (with * and ?), in the order given."""
        chosen = []
        for pattern in filter(None, (item.strip().strip("/") for item in patterns.split(","))):
            text = pattern.replace("[", "[[]")
            matching = [pattern] if pattern in self else \
                [name for name in self.names if fnmatch.fnmatchcase(name, text)]
            if not matching:
                raise MissingError(self._missing(pattern, self.names))
            chosen += [name for name in matching if name not in chosen]
        return chosen

    def arrays(self, names=None):
        """Columns as a dictionary of arrays, cut to the rows that all of them have."""
        columns = {name: self[name] for name in (self.names if names is None else names)}
        rows = min((len(column) for column in columns.values()), default=0)
        return {name: column[:rows] for name, column in columns.items()}

    def envelope(self, names, bins=BINS):
        """`time` and columns as a dictionary of arrays to draw; see the function `envelope`."""
        time, curves = envelope(self["time"], [self[name] for name in names], bins)
        return {"time": time, **dict(zip(names, curves))}

    def to_pandas(self):
        """A pandas.DataFrame, its index `time` if there is such a column; a column of vectors is three:
        effective_mass_x, _y, _z."""
        columns = {}
        for name, values in self.arrays().items():
            parts = {name: values} if values.ndim == 1 else \
                {f"{name}_{axis}": part for axis, part in zip("xyz", values.T)}
            columns.update(parts)
        frame = need("pandas", "to_pandas").DataFrame(columns)
        return frame.set_index("time") if "time" in frame else frame


class Events(Table):
    """The rows of /events: iterate over them, take one by its number, as events[-1], or a column as
    with other tables."""

    def __iter__(self):
        for begin in range(0, len(self), BLOCK):
            yield from self._rows(slice(begin, begin + BLOCK))

    def __getitem__(self, name):
        if isinstance(name, slice):
            chosen = range(len(self))[name]
            first, last = (min(chosen), max(chosen)) if chosen else (0, -1)
            rows = list(self._rows(slice(first, last + 1)))
            return [rows[k - first] for k in chosen]
        if not isinstance(name, (int, np.integer)):
            return super().__getitem__(name)
        if not -len(self) <= name < len(self):
            raise IndexError(f"there are {len(self)} events, none with the number {name}")
        begin = int(name) % len(self)
        return next(self._rows(slice(begin, begin + 1)))

    def _rows(self, rows):
        """Some events in order."""
        row = collections.namedtuple("Event", self._columns)
        return map(row._make, zip(*(column[rows].tolist() for column in self._columns.values())))

    def filter(self, **wanted):
        """The events whose columns have these values: filter(kind="impact", node=5)."""
        tests = [(self[name], value) for name, value in wanted.items()]
        found = [np.zeros(0, int)]
        for begin in range(0, len(self), BLOCK):
            rows = slice(begin, begin + BLOCK)
            chosen = np.full(len(next(iter(self._columns.values()))[rows]), True)
            for column, value in tests:
                chosen &= column[rows] == value
            found.append(begin + np.flatnonzero(chosen))
        rows = np.concatenate(found)
        return Events({name: column[:][rows] for name, column in self._columns.items()},
                      self._missing)

    def to_pandas(self):
        """A pandas.DataFrame with a row an event."""
        return need("pandas", "to_pandas").DataFrame(self.arrays(self._columns))


class Named(dict):
    """A dictionary whose entries are also attributes."""

    def __getattr__(self, name):
        if name not in self:
            raise MissingError(f"no '{name}'; there are: {', '.join(self)}")
        return self[name]


def segments(bins):
    """Where runs of equal numbers begin and end."""
    begin = np.flatnonzero(np.concatenate(([True], bins[1:] != bins[:-1])))
    return begin, np.append(begin[1:], len(bins)) - 1


def minmax(column, bins):
    """Least and largest value in each of so many equal parts of a column, read by blocks; NaN where
    a part has no number."""
    low, high = np.full((2, bins), np.nan)
    begin = 0
    for block in (column if isinstance(column, Rows) else Computed(np.asarray, column)).blocks():
        part = (np.arange(begin, begin + len(block)) * bins) // len(column)
        first, _ = segments(part)
        np.fmin.at(low, part[first], np.fmin.reduceat(block, first))
        np.fmax.at(high, part[first], np.fmax.reduceat(block, first))
        begin += len(block)
    return low, high


def envelope(time, curves, bins=BINS):
    """Times and curves that draw as all rows do: of each of so many equal spans of time the first,
    least, largest and last value; all rows where there are few. The time does not decrease."""
    rows = min(len(column) for column in (time, *curves))
    if rows <= 4 * bins:
        return time[:rows], [curve[:rows] for curve in curves]
    start, end = time[0], time[rows - 1]
    scale = bins / (end - start) if end > start else 0.0
    ends = np.full((2, bins), np.nan)  # first and last time in each span
    found = np.full((len(curves), 4, bins), np.nan)  # first, least, largest, last
    for begin in range(0, rows, BLOCK):
        block = slice(begin, min(begin + BLOCK, rows))
        t = time[block]
        span = np.clip((t - start) * scale, 0, bins - 1).astype(int)
        first, last = segments(span)
        at = span[first]
        fresh = np.isnan(ends[0, at])
        ends[0, at[fresh]], ends[1, at] = t[first[fresh]], t[last]
        for (opening, low, high, closing), curve in zip(found, curves):
            values = curve[block]
            opening[at[fresh]], closing[at] = values[first[fresh]], values[last]
            np.fmin.at(low, at, np.fmin.reduceat(values, first))
            np.fmax.at(high, at, np.fmax.reduceat(values, first))
    met = ~np.isnan(ends[0])
    middle = ends.mean(axis=0)
    x = np.stack((ends[0], middle, middle, ends[1]))[:, met]
    return x.T.ravel(), [four[:, met].T.ravel() for four in found]


def natural_key(name):
    """A key that sorts node_2 before node_10."""
    digits = "".join(c if c in DIGITS else " " for c in name).split()
    letters = "".join("0" if c in DIGITS else c for c in name)
    return letters.split("0")[0], [int(d) for d in digits], name


def shortened(names):
    """Names in a message."""
    names = [str(name) for name in names]
    return ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
