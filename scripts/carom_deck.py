"""Decks as cards that can be edited, and runs of carom: from carom_deck import Deck, run_deck.

    deck = Deck.read("input/bar/bar_implicit.inp")
    deck.set("IMPACT", METHOD="PENALTY", STIFFNESS=1000, BETA=None)     None takes a parameter away
    deck.set("DYNAMIC", BETA="1/4")
    deck.set_time_step(0.001)
    deck.write("work/penalty.inp")
    done = run_deck("build/carom", "work/penalty.inp", "work/penalty.h5", {"e": 0.6})
    print(done.status, done.last_line, done.costs["solves"])

Text that is not edited stays as it is, comments too. An included file that is not edited is included
by its absolute path, so that the deck may be written anywhere; one that is edited is written out.
"""

import os
import re
import subprocess
import time
from pathlib import Path

import h5py

from carom_script import ScriptError, folded

# The result group /cost of a run; what is missing there is read from the log
COSTS = [
    "increments", "iterations", "solves", "factorizations", "element_updates",
    "contact_searches", "cpu_seconds", "elapsed_seconds",
]
COST_LINE = re.compile(
    r"^cost: (?P<factorizations>\d+) factorizations .*, (?P<solves>\d+) solves .*, "
    r"all in (?P<elapsed_seconds>[-+.\dEe]+) s"
)
PROCEDURES = ("STATIC", "DYNAMIC", "FREQUENCY")
REQUESTS = (
    "NODEPRINT", "NODEFILE", "ELPRINT", "ELFILE", "CONTACTPRINT", "CONTACTFILE", "ENERGYPRINT",
)


def number_text(value):
    """A number as a deck takes it, all its digits; other things as text."""
    return repr(float(value)) if isinstance(value, float) else str(value)


def parse_number(text):
    """A number of a deck: `1.D3`, `2e-3`, `1/6`; None if it is none."""
    try:
        parts = [float(re.sub("[dD]", "e", part)) for part in text.split("/")]
    except ValueError:
        return None
    if len(parts) == 1:
        return parts[0]
    return parts[0] / parts[1] if len(parts) == 2 and parts[1] != 0.0 else None


class Card:
    """A keyword line with its parameters and the lines below it, comments among them."""

    def __init__(self, head, lines=()):
        self.head = list(head)      # the keyword line, and lines that a comma joins to it
        self.lines = list(lines)    # all lines up to the next keyword
        self.changed = False
        words = [word.strip() for line in self.head for word in line.split(",")]
        words = [word for word in words if word]
        self.written = words[0][1:].strip() if words else ""
        self.keyword = folded(self.written)
        self.parameters = {}        # folded name: (name as written, value or None)
        for word in words[1:]:
            name, equals, value = word.partition("=")
            self.parameters[folded(name)] = (name.strip(), value.strip() if equals else None)

    def has(self, name):
        """Whether the card has a parameter."""
        return folded(name) in self.parameters

    def get(self, name, default=None):
        """The value of a parameter as written; '' for one without a value."""
        written = self.parameters.get(folded(name))
        return default if written is None else (written[1] or "")

    def set(self, name, value=True):
        """Gives a parameter a value; True: the parameter without a value, None or False: removes it."""
        if value is None or value is False:
            if self.parameters.pop(folded(name), None) is None:
                return
        else:
            self.parameters[folded(name)] = (name, None if value is True else number_text(value))
        self.head, self.changed = [self._headline()], True

    def _headline(self):
        words = ["*" + self.written]
        words += [n if v is None else f"{n}={v}" for n, v in self.parameters.values()]
        return ", ".join(words)

    @property
    def data(self):
        """The data lines, without comments and blank ones."""
        return [line for line in self.lines if not is_empty(line)]

    def fields(self, row=0):
        """The fields of a data line."""
        return [field.strip() for field in self.data[row].split(",")]

    def set_data(self, row, line):
        """Replaces a data line, counted from 0 without comments."""
        places = [i for i, text in enumerate(self.lines) if not is_empty(text)]
        self.lines[places[row]] = line
        self.changed = True

    def text_lines(self):
        """The lines of the card as a file has them."""
        return [*self.head, *self.lines]


class Include:
    """An included file: its cards, and the path by which the deck can be written elsewhere."""

    def __init__(self, path, deck):
        self.path, self.deck, self.lines = path, deck, []   # lines: what follows in the includer

    @property
    def changed(self):
        return self.deck.changed

    def text_lines(self):
        """One line with the absolute path, or the text if it has been edited (or cannot be named)."""
        path = str(Path(self.path).resolve())
        if self.changed or "," in path:
            return [*self.deck.text_lines(), *self.lines]
        return [f"*INCLUDE, INPUT={path}", *self.lines]


class Deck:
    """A deck as a list of cards; files that it includes are followed."""

    def __init__(self, items, path=None):
        self.items, self.path = items, path
        self.cut = False    # whether cards were taken away or put in

    @classmethod
    def read(cls, path, above=()):
        """Reads a file and all it includes; `above` are the files that include this one."""
        path = Path(path)
        if path.resolve() in above:
            raise ScriptError(f"'{path}' includes itself")
        try:
            text = path.read_text(encoding="utf-8", errors="surrogateescape")
        except OSError as error:
            raise ScriptError(f"cannot read the deck '{path}': {error.strerror}") from None
        items = []
        for head, lines in split_cards(text.splitlines()):
            card = Card(head, lines)
            if card.keyword == "INCLUDE" and card.get("INPUT"):
                inner = path.parent / card.get("INPUT").strip("\"'")
                items.append(Include(inner, cls.read(inner, (*above, path.resolve()))))
                items[-1].lines = list(lines)
            else:
                items.append(card)
        return cls(items, path)

    @property
    def changed(self):
        return self.cut or any(item.changed for item in self.items)

    def __iter__(self):
        """All cards in the deck's order, those of included files too."""
        for item in self.items:
            if isinstance(item, Include):
                yield from item.deck
            else:
                yield item

    def cards(self, keyword):
        """The cards of a keyword."""
        return [card for card in self if card.keyword == folded(keyword)]

    def has(self, keyword):
        """Whether the deck has such a card."""
        return any(card.keyword == folded(keyword) for card in self)

    def get(self, keyword, name, default=None):
        """The value of a parameter in the first card of the keyword."""
        return next((card.get(name, default) for card in self.cards(keyword)), default)

    def set(self, keyword, **values):
        """Sets parameters of all cards of a keyword; None removes. `MAX_EVENTS` is MAX EVENTS."""
        found = self.cards(keyword)
        if not found:
            raise ScriptError(f"'{self.path}' has no card *{keyword.lstrip('*')}")
        for card in found:
            for name, value in values.items():
                card.set(name.replace("_", " "), value)

    def definitions(self):
        """The `*PARAMETER` lines: name (upper case) to value as written."""
        pairs = [line.partition("=") for card in self.cards("PARAMETER") for line in card.data]
        return {folded(name): value.strip() for name, _, value in pairs}

    def value(self, text, defined=None):
        """The number that a field stands for, `<name>` replaced; None if it is none."""
        known = {**self.definitions(), **{folded(k): str(v) for k, v in (defined or {}).items()}}
        text = re.sub(r"<([^<>]*)>", lambda hit: known.get(folded(hit[1]), "?"), text)
        return parse_number("".join(text.split()))

    def procedures(self, *kinds):
        """The procedure cards (`*DYNAMIC` … of all steps), or those of the kinds given."""
        return [card for card in self if card.keyword in (kinds or PROCEDURES)]

    def time_step(self, defined=None):
        """dt and the length of the first `*DYNAMIC` step; None where the deck has none."""
        for card in self.procedures("DYNAMIC"):
            if card.data:
                fields = [self.value(field, defined) for field in card.fields()]
                return fields[0], fields[1] if len(fields) > 1 else None
        return None, None

    def set_time_step(self, dt, end=None, automatic=None):
        """Replaces dt of all `*DYNAMIC` steps, the length if given, `dt min, dt max` by `automatic`."""
        for card in self.procedures("DYNAMIC"):
            fields = card.fields() if card.data else [""]
            fields[0] = number_text(dt)
            if end is not None:
                fields[1:2] = [number_text(end)]
            if automatic is not None:
                fields[2:] = [number_text(value) for value in automatic]
            card.set_data(0, ", ".join(fields))
        for card in self.cards("STEP"):
            card.set("INC", None)      # the deck's own limit was meant for its own dt

    def remove(self, *keywords):
        """Takes all cards of the keywords away."""
        unwanted = {folded(keyword) for keyword in keywords}
        for item in self.items:
            if isinstance(item, Include):
                item.deck.remove(*keywords)
        kept = [i for i in self.items if isinstance(i, Include) or i.keyword not in unwanted]
        self.cut |= len(kept) != len(self.items)
        self.items = kept

    def add_before(self, keyword, *lines):
        """Puts a card (its lines) before each card of a keyword; into the steps: 'END STEP'."""
        items = []
        for item in self.items:
            if isinstance(item, Include):
                item.deck.add_before(keyword, *lines)
            elif item.keyword == folded(keyword):
                items.append(Card(lines[:1], lines[1:]))
                self.cut = True
            items.append(item)
        self.items = items

    def add_before_first(self, keyword, *lines):
        """Puts a card before the first card of a keyword in the file itself, not in included ones."""
        for place, item in enumerate(self.items):
            if isinstance(item, Card) and item.keyword == folded(keyword):
                self.items.insert(place, Card(lines[:1], lines[1:]))
                self.cut = True
                return
        raise ScriptError(f"'{self.path}' itself has no card *{keyword}")

    def thin_output(self, frames=None, prints=None):
        """Sets FREQUENCY of the fields (`* FILE`) and of the tables (`* PRINT`); 0 removes the cards."""
        for keyword in REQUESTS:
            every = prints if keyword.endswith("PRINT") else frames
            if every == 0:
                self.remove(keyword)
            elif every is not None:
                for card in self.cards(keyword):
                    card.set("FREQUENCY", every)

    def text_lines(self):
        """All lines."""
        return [line for item in self.items for line in item.text_lines()]

    def text(self):
        """The deck as text; files that were not edited are included by their absolute paths."""
        return "\n".join(self.text_lines()) + "\n"

    def write(self, path):
        """Writes the deck."""
        try:
            Path(path).write_text(self.text(), encoding="utf-8", errors="surrogateescape")
        except OSError as error:
            raise ScriptError(f"cannot write the deck '{path}': {error.strerror}") from None


def is_empty(line):
    """A comment or nothing."""
    return line.lstrip().startswith("**") or not line.strip(" \t,")


def split_cards(lines):
    """Pairs of keyword lines (with those that a comma joins to them) and the lines below."""
    cards, joined = [], False
    for line in lines:
        if line.lstrip().startswith("*") and not is_empty(line):
            cards.append(([line], []))
            joined = line.rstrip().endswith(",")
        elif joined and not is_empty(line):
            cards[-1][0].append(line)
            joined = line.rstrip().endswith(",")
        elif cards:
            joined = False
            cards[-1][1].append(line)
        elif not is_empty(line):
            raise ScriptError(f"data before any keyword card: '{line.strip()}'")
    return cards


class Done:
    """A finished run: status, last line of the log, messages, seconds, costs by name."""

    def __init__(self, status, messages, result, seconds, late=False):
        self.status, self.messages, self.result, self.seconds = status, messages, result, seconds
        self.late = late
        log = Path(result).with_suffix(".log")
        self.log = log.read_text(errors="replace") if log.is_file() else ""
        text = self.log.strip() or messages.strip()
        self.last_line = text.splitlines()[-1] if text else ""
        self.costs = read_costs(result, self.log)

    @property
    def good(self):
        """Whether the run came to its end."""
        return self.status == 0 and self.last_line == "completed"


def read_costs(result, log=""):
    """The numbers of the result group /cost; of an older file those of the log's last lines."""
    found = {}
    for line in log.splitlines():
        match = COST_LINE.match(line)
        if match:
            found = {name: float(text) for name, text in match.groupdict().items()}
    try:
        with h5py.File(result, "r", locking=False) as file:
            for name, item in file.get("cost", {}).items():
                found[name] = float(item[()].ravel()[0])
    except (OSError, IndexError):
        pass
    return found


def run_deck(carom, deck, result, define=None, threads=1, limit=None, begun=None):
    """Runs carom on a deck file; `limit` seconds at most, then the run is killed (`late`). `begun` is
    called with the process."""
    words = [str(carom), "run", str(deck), "-o", str(result), "--quiet", "--overwrite",
             "--threads", str(threads)]
    for name, value in (define or {}).items():
        words += ["--define", f"{name}={number_text(value)}"]
    for left in (Path(result), Path(result).with_suffix(".log")):
        left.unlink(missing_ok=True)
    started = time.perf_counter()
    try:
        process = subprocess.Popen(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, errors="replace", env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
        )
    except OSError as error:
        raise ScriptError(f"cannot run '{carom}': {error.strerror}") from None
    late = False
    try:
        if begun:
            begun(process)
        messages, _ = process.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        late = True
        process.kill()
        messages, _ = process.communicate()
    except BaseException:      # interrupted: leave no run behind
        process.kill()
        process.wait()
        raise
    return Done(process.returncode, messages, result, time.perf_counter() - started, late)


def find_carom(given=None):
    """The program: as given, else build/carom of this checkout."""
    path = Path(given) if given else Path(__file__).resolve().parents[1] / "build" / "carom"
    if not (path.is_file() and os.access(path, os.X_OK)):
        raise ScriptError(f"no program '{path}': build carom first, or name it with --carom")
    return path.resolve()
