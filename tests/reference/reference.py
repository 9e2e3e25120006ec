"""The deck reference (input/README.md) taken apart, and decks made of its examples."""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
from carom_deck import Card, split_cards  # noqa: E402
from carom_script import folded  # noqa: E402

TEXT = ROOT / "input" / "README.md"
START = "## Deck reference"
# Name and value, then what follows: ", required" or ", not yet", or neither
PARAMETER = re.compile(r"- `([A-Z][A-Z ]*)(\[=[^`]*\]|=[^`]*)?`(, required|, not yet)?[.:]")
EXAMPLE = re.compile(r"Example \((\w+)\):$")
SUB_CARDS = {
    "ELASTIC": "MATERIAL", "PLASTIC": "MATERIAL", "DENSITY": "MATERIAL", "DAMPING": "MATERIAL",
    "IMPACT": "SURFACEINTERACTION", "FRICTION": "SURFACEINTERACTION",
}
PROCEDURES = ("STATIC", "DYNAMIC", "FREQUENCY")
IDENTITIES = ("NAME", "NSET", "ELSET", "INTERACTION", "TYPE")


class Parameter:
    """A parameter as an entry describes it: its form (`''`, `=`, `?`), its alternatives, its marks."""

    def __init__(self, match):
        value, self.text = match[2] or "", match.string
        self.name = match[1].strip()
        self.form = "?" if value.startswith("[") else value[:1]
        self.required = match[3] == ", required"
        self.not_yet = match[3] == ", not yet"
        words = [word.strip() for word in value.strip("[]=").split("|")]
        self.words = [word for word in words if word]

    @property
    def marks(self):
        """The marks of the reader's table."""
        return "~" * self.not_yet + self.form + "!" * self.required

    @property
    def default(self):
        """The default, where it is a word or a number; else None."""
        found = re.search(r"[dD]efault:? (?:`([^`]+)`|(\d+(?:\.\d+)?(?:[e/]-?\d+)?))", self.text)
        return found and (found[1] or found[2])

    @property
    def tells_default(self):
        """Whether it says what holds without it; a flag, a required one and an error need not."""
        free = self.required or self.not_yet or self.form == ""
        return free or re.search(r"[dD]efault|without effect|penalty only|an error\b", self.text)

    @property
    def closed(self):
        """Whether the alternatives are words of the deck, all of them."""
        return bool(self.words) and all(re.fullmatch(r"\d?[A-Z][A-Z ]*", w) for w in self.words)


class Entry:
    """A section: its title and its lines; of a card also parameters and examples."""

    def __init__(self, title, group):
        self.title, self.group, self.lines = title, group, []

    @property
    def is_card(self):
        return self.title.startswith("*")

    @property
    def name(self):
        return self.title.lstrip("*")

    @property
    def text(self):
        return "\n".join(self.lines)

    @property
    def summary(self):
        """The line below the title."""
        return self.lines[1] if len(self.lines) > 1 else ""

    def paragraph(self, start):
        """The paragraph that begins with a word; empty without one."""
        found = re.search(rf"^{re.escape(start)}.*?(?=\n\n|\Z)", self.text, re.M | re.S)
        return " ".join(found[0].split()) if found else ""

    def parameters(self):
        """All parameters by name, and the lines that look like one and are none."""
        found, odd = {}, []
        for item in re.findall(r"^- `.*?(?=\n- |\n\n|\Z)", self.text, re.M | re.S):
            line = " ".join(item.split())
            match = PARAMETER.match(line)
            if match:
                found[match[1].strip()] = Parameter(match)
            else:
                odd.append(line)
        return found, odd

    def data_words(self):
        """Words that the entry names for data lines: in its Data, and in the first column of tables."""
        cells = re.findall(r"^\| *(`.*?) *\|", self.text, re.M)
        codes = re.findall(r"`([^`]*)`", self.paragraph("Data") + " ".join(cells))
        return {code for code in codes if re.fullmatch(r"[A-Z]+\d?", code)}

    def examples(self):
        """Pairs of the kind of deck and the example's lines."""
        found = []
        for i, line in enumerate(self.lines):
            match = EXAMPLE.match(line)
            if match:
                found.append((match[1], indented(self.lines[i + 1:])))
        return found


def indented(lines):
    """The first block of indented lines."""
    block = []
    for line in lines:
        if line.startswith("    "):
            block.append(line[4:])
        elif block:
            break
    return block


def read_entries():
    """All entries in their order."""
    entries, group, inside = [], "", False
    for line in TEXT.read_text(encoding="utf-8").splitlines():
        if line == START:
            inside = True
        elif inside and line.startswith("### "):
            entries.append(Entry(line[4:], group))
        elif inside and line.startswith("## "):
            group = line[3:]
            entries.append(Entry("", group))
        elif inside and entries:
            entries[-1].lines.append(line)
    return [entry for entry in entries if entry.title]


def units(lines):
    """The cards of a deck, those that belong to another one with it, a step as one."""
    found = []
    for head, below in split_cards(lines):
        card = Card(head, below)
        in_step = found and found[-1][0].keyword == "STEP" and found[-1][-1].keyword != "ENDSTEP"
        belongs = found and SUB_CARDS.get(card.keyword) == found[-1][0].keyword
        if in_step or belongs:
            found[-1].append(card)
        else:
            found.append([card])
    return found


def identity(card):
    """What tells a card from others of its keyword."""
    if card.keyword in PROCEDURES:
        return "procedure"
    given = next((card.get(name) for name in IDENTITIES if card.has(name)), "")
    return card.keyword, folded(given)


def put(cards, unit, before):
    """Puts a unit into a list of units: in the place of its like, else before one of a keyword."""
    alike = [i for i, old in enumerate(cards) if identity(old[0]) == identity(unit[0])]
    for i in reversed(alike):
        del cards[i]
    last = next((i for i, old in enumerate(cards) if old[0].keyword == before), len(cards))
    cards.insert(alike[0] if alike else last, unit)


def assemble(base, example, level_of):
    """The lines of a deck with an example's cards; `level_of` gives 'step' for cards of a step."""
    cards = units(base)
    for unit in units(example):
        if level_of(unit[0].keyword) == "step":
            step = next(i for i, old in enumerate(cards) if old[0].keyword == "STEP")
            inner = [[card] for card in cards[step]]
            put(inner, unit, "ENDSTEP")
            cards[step] = [card for part in inner for card in part]
        elif unit[0].keyword == "PARAMETER":
            cards.insert(0, unit)
        else:
            put(cards, unit, "STEP")
    return [line for unit in cards for card in unit for line in card.text_lines()]
