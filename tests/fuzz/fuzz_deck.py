"""Decks as the fuzzer changes them: cards of lines, read from input/ with their included files."""
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
INCLUDED = re.compile(r"^\*\s*INCLUDE\s*,\s*INPUT\s*=\s*(\S+)\s*$", re.IGNORECASE)
NUMBER = re.compile(r"(?<![\w.<])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?(?![\w.>])")
TIMED = ("STATIC", "DYNAMIC")


def squeezed(text):
    """A word as the program compares it."""
    return "".join(text.split()).upper()


class Deck:
    """A list of cards, each a list of lines of which the first is the keyword line.

    Bytes are kept one by one as latin-1. `files` are further files that the deck includes.
    """

    def __init__(self, name, cards, files=None):
        self.name, self.cards, self.files = name, cards, dict(files or {})

    @classmethod
    def from_text(cls, name, text, files=None):
        """A deck from its text; what stands before the first keyword is a card of its own."""
        cards = []
        for line in text.split("\n"):
            if not cards or (line.startswith("*") and not line.startswith("**")):
                cards.append([])
            cards[-1].append(line)
        return cls(name, cards, files)

    def copy(self):
        """A deck that may be changed without changing this one."""
        return Deck(self.name, [list(card) for card in self.cards], self.files)

    def text(self):
        """The deck's own file."""
        return "\n".join(line for card in self.cards for line in card)

    def keyword(self, place):
        """The keyword of a card, squeezed."""
        return squeezed(self.cards[place][0][1:].split(",")[0])

    def places(self, *keywords):
        """Where the cards of the given keywords stand."""
        return [i for i in range(len(self.cards)) if self.keyword(i) in keywords]

    def names(self, keyword, parameter):
        """Values of a parameter over all cards of a keyword."""
        found = (get_parameter(self.cards[i][0], parameter) for i in self.places(keyword))
        return [name for name in found if name]

    def data_lines(self, place):
        """Numbers of the lines of a card that hold data."""
        card = self.cards[place]
        return [i for i in range(1, len(card)) if card[i].strip() and not card[i].startswith("**")]


def get_parameter(head, parameter):
    """The value of a parameter on a keyword line; None if it is not there."""
    for word in head.split(",")[1:]:
        name, _, value = word.partition("=")
        if squeezed(name) == squeezed(parameter):
            return value.strip()
    return None


def set_parameter(head, parameter, value):
    """The keyword line with a parameter set (value None: without '='), replaced or appended."""
    words = head.split(",")
    new = f" {parameter}" + ("" if value is None else f"={value}")
    for i, word in enumerate(words[1:], 1):
        if squeezed(word.partition("=")[0]) == squeezed(parameter):
            words[i] = new
            return ",".join(words)
    return ",".join([*words, new])


def drop_parameter(head, parameter):
    """The keyword line without a parameter."""
    words = head.split(",")
    return ",".join(words[:1] + [word for word in words[1:]
                                 if squeezed(word.partition("=")[0]) != squeezed(parameter)])


def parse_number(text):
    """The value of a plain number, None for anything else."""
    try:
        return float(text.replace("d", "e").replace("D", "e"))
    except ValueError:
        return None


def read_decks(folder, pattern):
    """All decks of a folder, included files beside them, sorted by name."""
    return [read_deck(path, folder) for path in sorted(Path(folder).glob(pattern))]


def read_deck(path, folder):
    """One deck; its included files are kept under their names."""
    text = path.read_text(encoding="latin-1")
    files = {}
    for line in text.split("\n"):
        match = INCLUDED.match(line)
        if match and (path.parent / match[1]).is_file():
            files[match[1]] = (path.parent / match[1]).read_text(encoding="latin-1")
    return Deck.from_text(path.relative_to(folder).with_suffix("").as_posix(), text, files)


def flattened(deck):
    """The deck as one file."""
    lines = []
    for line in deck.text().split("\n"):
        match = INCLUDED.match(line)
        if match and match[1] in deck.files:
            lines += deck.files[match[1]].rstrip("\n").split("\n")
        else:
            lines.append(line)
    return Deck.from_text(deck.name, "\n".join(lines))


def defined_values(deck):
    """The numbers that `*PARAMETER` cards name."""
    values = {}
    for place in deck.places("PARAMETER"):
        for line in deck.cards[place][1:]:
            name, _, value = line.partition("=")
            values[squeezed(name)] = parse_number(value.strip())
    return values


def time_lines(deck):
    """For each step in time: place of the card, its number of the data line, dt and T, or None."""
    defined = defined_values(deck)
    found = []
    for place in deck.places(*TIMED):
        lines = deck.data_lines(place)
        if not lines:
            continue
        words = [word.strip() for word in deck.cards[place][lines[0]].split(",")]
        numbers = [defined.get(squeezed(word[1:-1])) if word.startswith("<") else parse_number(word)
                   for word in words[:2]]
        dt, length = (numbers + [None, None])[:2]
        found.append((place, lines[0], dt, length))
    return found


def shorten(deck, increments):
    """Cuts every step in time to so many increments of its own dt at most."""
    for place, line, dt, length in time_lines(deck):
        if not dt or not length or length <= increments*dt:
            continue
        words = deck.cards[place][line].split(",")
        words[1] = f" {increments*dt:.12g}"
        deck.cards[place][line] = ",".join(words)


def limit_increments(deck, most=500):
    """Gives the automatic increments of steps in motion a limit: a tolerance may ask for very many."""
    for place in deck.places("DYNAMIC"):
        if "DIRECT" not in squeezed(deck.cards[place][0]):
            for step in [i for i in deck.places("STEP") if i < place][-1:]:
                deck.cards[step][0] = set_parameter(deck.cards[step][0], "INC", str(most))


def count_increments(deck):
    """Increments that the steps in time ask for, as far as their numbers are plain."""
    return sum(abs(length/dt) for _, _, dt, length in time_lines(deck) if dt and length)
