"""Result files of carom, of finished runs and of runs that go on; what is named is read, no more.

    from carom_results import Result

    with Result("run.h5") as result:
        print(result.heading, result.nodes, result.contacts)
        u = result.node(5).U1                 an array with a row an increment, as result.time
        s = result.element(7).S11
        f = result.contact("RIM-WALL").CF1
        last = result.node(5)["U1"][-1000:]   a column stays in the file: only these rows are read
        print(result.energy.kinetic.max(), result.cost.solves)
        for event in result.events.filter(kind="impact"):    or result.events[0], the first
            print(event.time, event.node, event.impulse)
        for frame in result.frames:           see carom_frames.py
            print(frame.time, abs(frame.U).max())
        table = result.to_pandas("history")   needs pandas

Names of sets and surfaces have no blanks in the file, and A to Z in upper case; `contact` takes them
as the deck has them. All quantities are in the units of the deck. What is not there ends with a
ScriptError that names the card which writes it.
"""

import functools
import os
import re

import h5py
import numpy as np
from carom_frames import Frames, all_frames
from carom_script import MissingError, ScriptError, folded
from carom_tables import Column, Events, Named, Table, natural_key, shortened

EVENTS = ("time", "kind", "pair", "node", "gap_rate_before", "gap_rate_after", "impulse", "beta",
          "solves", "factorizations")
OWNERS = {"node": "*NODE PRINT", "element": "*EL PRINT", "contact": "*CONTACT PRINT"}
HEADING = re.compile(rb"\*[ \t]*HEADING[ \t]*(?=[,\r\n])", re.IGNORECASE)
CARD = re.compile(rb"^[ \t]*\*(?!\*)", re.MULTILINE)
HEAD = 1 << 16  # bytes of a deck that are looked at first for its heading
TABLES = ("history", "energy", "events", "frequency", "cost")
WRITTEN_BY = {
    "history": "*NODE PRINT, *EL PRINT and *CONTACT PRINT write it",
    "energy": "*ENERGY PRINT writes it",
    "frequency": "a *FREQUENCY step writes it",
}


class Result:
    """An open result file; use it in a `with` statement, or close it."""

    def __init__(self, path):
        self.path = str(path)
        if not os.path.isfile(self.path):
            raise MissingError(f"no result file '{self.path}'")
        self.file = opened(self.path)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Closes the file."""
        self.file.close()

    def table(self, group, empty=False):
        """The columns of a group such as "history" or "frequency"."""
        found = self.file.get(group)
        columns = dict(columns_of(found)) if isinstance(found, h5py.Group) else {}

        def missing(name, known):
            return (f"'{self.path}' has no column '{name}' in /{group}; "
                    f"there are: {shortened(known)}")

        if not columns and not empty:
            written = WRITTEN_BY.get(group)
            raise MissingError(f"'{self.path}' has no columns in /{group}"
                               + (f" ({written})" if written else ""))
        return Table(columns, missing)

    @functools.cached_property
    def history(self):
        """All of /history: columns `time`, `node_5/U1`, `element_7/S11`, `contact_A-B/CF1`, ..."""
        return self.table("history")

    @functools.cached_property
    def energy(self):
        """The columns of /energy; those of groups of elements as energy["group_1/kinetic"]."""
        return self.table("energy")

    @functools.cached_property
    def modes(self):
        """The columns of /frequency, a row a mode."""
        return self.table("frequency")

    @functools.cached_property
    def events(self):
        """The events; their columns are there, and empty, where nothing has happened."""
        found = self.table("events", empty=True)
        known = [name for name in EVENTS if name in found] + \
            [name for name in found.names if name not in EVENTS]
        columns = {name: found[name] for name in known} or \
            {name: np.zeros(0, str if name in ("kind", "pair") else float) for name in EVENTS}
        return Events(columns, found._missing)

    @functools.cached_property
    def frames(self):
        """The frames of the mesh, a sequence; see carom_frames.py."""
        return Frames(self)

    @property
    def time(self):
        """The times of the rows of the history."""
        return self.history.time

    @property
    def frequencies(self):
        """The natural frequencies, per unit of time."""
        return self.modes.frequency

    @property
    def cost(self):
        """The numbers of /cost: result.cost.solves."""
        return Named({name: column[:].ravel()[0].item()
                      for name, column in self.table("cost")._columns.items() if len(column)})

    @property
    def nodes(self):
        """The ids of the nodes with a history."""
        return [int(name) for name in self._owners("node")]

    @property
    def elements(self):
        """The ids of the elements with a history."""
        return [int(name) for name in self._owners("element")]

    @property
    def contacts(self):
        """The names of the contact pairs and sets of gaps with a history."""
        return self._owners("contact")

    def node(self, number):
        """The history of a node: result.node(5).U1."""
        return self._owner("node", str(number))

    def element(self, number):
        """The history of an element: result.element(7).S11."""
        return self._owner("element", str(number))

    def contact(self, name):
        """The history of a contact pair or set of gaps: result.contact("SLAVE-MASTER").CF1."""
        known = f"history/contact_{name}" in self.file
        return self._owner("contact", name if known else folded(name))

    def _owners(self, kind):
        """What has a history."""
        names = sorted(self.file.get("history", ()), key=natural_key)
        return [name[len(kind) + 1 :] for name in names if name.startswith(kind + "_")]

    def _owner(self, kind, name):
        """The columns of one of them."""
        group = f"history/{kind}_{name}"
        if group not in self.file:
            known = self._owners(kind)
            there = f"; there are: {shortened(known)}" if known else ""
            raise MissingError(f"'{self.path}' has no history of {kind} {name} "
                               f"({OWNERS[kind]} writes it){there}")

        def missing(column, names):
            return (f"'{self.path}' has no {column} of {kind} {name} "
                    f"({OWNERS[kind]} writes it); there are: {shortened(names)}")

        columns = dict(columns_of(self.file[group]))
        columns.setdefault("time", Column(self.file["history/time"], "history/time"))
        return Table(columns, missing)

    def array(self, path):
        """Any dataset, as "model/node_id", in whole; fields, as "VTKHDF/PointData/U", in all their
        frames (frame, point, component)."""
        item = self.file.get(path)
        if not isinstance(item, h5py.Dataset):
            raise MissingError(f"'{self.path}' has no /{path.strip('/')}")
        field = re.fullmatch(r"/?VTKHDF/(Point|Cell)Data/(\w+)", path)
        if field:
            return all_frames(self.file["VTKHDF"], *field.groups())
        return Column(item, path)[:] if item.shape else item[()]

    @property
    def deck(self):
        """The text of the deck, included files behind it."""
        return self.array("model/deck").decode("utf-8", "replace")

    @functools.cached_property
    def heading(self):
        """The text of *HEADING; empty without one."""
        item = self.file.get("model/deck")
        if item is None:
            return ""
        start, size = item.id.get_offset(), item.id.get_storage_size()
        if start is None or not hasattr(os, "pread"):
            return heading_of(self.array("model/deck"))[0]
        for length in (min(size, HEAD), size):  # it mostly stands at the head of what may be long
            deck = os.pread(self.file.id.get_vfd_handle(), length, start)
            heading, whole = heading_of(deck)
            if whole:
                break
        return heading

    @property
    def title(self):
        """The heading, or the name of the file where there is none."""
        return self.heading or os.path.basename(self.path)

    def to_pandas(self, group="history"):
        """A table of the file, "history", "energy", "events", "frequency", as a pandas.DataFrame."""
        if group in self.file and group.strip("/").split("/")[0] not in TABLES:
            raise ScriptError(f"'{self.path}': /{group} is no table (tables are {', '.join(TABLES)}); "
                              f'result.array("{group}/NAME") has one of its datasets')
        if group == "events":
            return self.events.to_pandas()
        table = self.table(group)
        if group == "frequency":  # the moving mass has no row a mode
            table = Table({n: table[n] for n in table.names if n != "moving_mass"}, table._missing)
        return table.to_pandas()


def opened(path):
    """An HDF5 file without a lock, so that a run that still goes on can be looked at; with one where
    this process has opened the file with one before."""
    for locking in (False, None):
        try:
            return h5py.File(path, "r", locking=locking)
        except OSError as error:
            said = error
    raise ScriptError(f"cannot read '{path}' as an HDF5 file: {said}")


def columns_of(group, prefix=""):
    """The names and columns of a group and of the groups in it."""
    for name, item in group.items():
        if isinstance(item, h5py.Group):
            yield from columns_of(item, f"{prefix}{name}/")
        elif item.shape:
            yield prefix + name, Column(item, item.name.strip("/"))


def heading_of(deck):
    """The lines below *HEADING in one, of the bytes of a deck, and whether a card ends them."""
    for found in HEADING.finditer(deck):
        if not deck[deck.rfind(b"\n", 0, found.start()) + 1 : found.start()].strip():
            break
    else:
        return "", False
    _, _, below = deck[found.end() :].partition(b"\n")
    end = CARD.search(below)
    lines = below[: end.start() if end else None].decode("utf-8", "replace").split("\n")
    texts = [line.strip() for line in lines]
    return " ".join(t for t in texts if t and not t.startswith("**")), end is not None
