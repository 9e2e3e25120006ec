"""The deck reference against the program: tests/reference/run.py CAROM

- The cards of input/README.md are those of the reader's table (`carom help --table`), with the same
  parameters, which take a value or not, are required or not yet known alike, and have a default.
- A wrong value given to each parameter, a wrong word in each field: the words that the reader then
  allows are those of the entry.
- A default that the entry gives as a word or number changes nothing when it is written.
- Each example, put into the whole deck that it names, runs. So do these decks.
- `carom help` prints each entry, whole, in any spelling, no wider than 100 columns.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py

from reference import Card, assemble, folded, indented, read_entries, split_cards

LEVELS = {
    "model": "before the steps.", "step": "in a step.", "both": "before the steps or in a step.",
    "note": "anywhere.",
}
WRONG = "XQZ"
# What else a card must have or lack for a parameter to mean anything
FICTITIOUS = {"METHOD": "FICTITIOUS FORCE", "BETA": None}
CIRCUMSTANCES = {
    ("IMPACT", "RETURN"): FICTITIOUS, ("IMPACT", "SOLUTION"): FICTITIOUS,
    ("ELEMENT GROUP", "MASS"): {"SCHEME": "IMPLICIT"}, ("DYNAMIC", "GAMMA"): {"ALPHA": None},
    ("DYNAMIC", "TOLERANCE"): {"DIRECT": None, "ALPHA": None},
}
INCLUDED = "*NSET, NSET=EXTRA\n1\n"
WIDTH, SUMMARY = 100, 74


class Rule:
    """A line of the reader's table: keyword; level; parameters; data line."""

    def __init__(self, line):
        self.name, self.level, parameters, self.usage = line.split(";", 3)
        self.parameters = {}
        for word in parameters.split("/") if parameters else []:
            name = re.match(r"~?([A-Z ]+)", word)[1]
            marks = "~" * word.startswith("~") + re.sub(r"[~A-Z ]", "", word)
            self.parameters[name] = marks


class Bench:
    """The program, the entries, the table, and the mistakes found."""

    def __init__(self, carom, folder):
        self.carom, self.folder, self.mistakes = carom, Path(folder), []
        self.entries = read_entries()
        self.cards = {entry.name: entry for entry in self.entries if entry.is_card}
        table = self.call("help", "--table").stdout.splitlines()
        self.rules = {rule.name: rule for rule in map(Rule, table)}
        self.decks = {}
        for kind in ("block", "masses"):
            entry = next(e for e in self.entries if e.title == f"{kind.capitalize()} deck")
            self.decks[kind] = indented(entry.lines)
        (self.folder / "sets.inc").write_text(INCLUDED)

    def call(self, *words):
        """Runs the program."""
        return subprocess.run([self.carom, *words], capture_output=True, text=True,
                              encoding="utf-8", timeout=60, check=False)

    def report(self, *words):
        self.mistakes.append(" ".join(str(word) for word in words))

    def level_of(self, keyword):
        """'step' for cards that stand in steps only."""
        if keyword == "RESTART":
            return "step"
        return next(r.level for r in self.rules.values() if folded(r.name) == keyword)

    def deck(self, kind, example):
        """The lines of a deck with an example."""
        return assemble(self.decks[kind], example, self.level_of)

    def try_deck(self, command, lines):
        """Runs or checks a deck given by its lines."""
        path = self.folder / "deck.inp"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        words = ["-o", str(self.folder / "out.h5"), "--overwrite", "--quiet"]
        return self.call(command, str(path), *(words if command == "run" else []))


def check_cards(bench):
    """The same cards here and there, each entry with all its parts."""
    for name in bench.rules.keys() - bench.cards.keys():
        bench.report(f"*{name} is known to the reader, the reference has no entry")
    for name in bench.cards.keys() - bench.rules.keys():
        bench.report(f"*{name} has an entry, the reader does not know it")
    if len(bench.rules) < 50:
        bench.report("the table of the reader is cut short:", len(bench.rules), "cards")
    titles = [folded(entry.title) for entry in bench.entries]
    for title in {title for title in titles if titles.count(title) > 1}:
        bench.report(title, "has two entries")
    for entry in bench.entries:
        if not entry.summary.endswith(".") or len(entry.summary.replace("`", "")) > SUMMARY:
            bench.report(f"{entry.title}: the first line is no short sentence: {entry.summary}")
    for name in bench.cards.keys() & bench.rules.keys():
        check_parts(bench, bench.cards[name], bench.rules[name])


def check_parts(bench, entry, rule):
    """Where, Data, Parameters, Example, Differs; whether there are data lines."""
    for start in ("Where: ", "Data", "Example (", "Differs: "):
        if not entry.paragraph(start):
            bench.report(f"{entry.title} has no '{start.strip(' (')}'")
    where = entry.paragraph("Where: ")
    if rule.level in LEVELS and where != "Where: " + LEVELS[rule.level]:
        bench.report(f"{entry.title}: '{where}', but its level is {rule.level}")
    if (rule.usage == "-") != entry.paragraph("Data").startswith("Data: none"):
        bench.report(f"{entry.title}: '{entry.paragraph('Data')}', the reader: '{rule.usage}'")


def check_parameters(bench):
    """The same parameters with the same marks."""
    for name in sorted(bench.cards.keys() & bench.rules.keys()):
        entry, rule = bench.cards[name], bench.rules[name]
        found, odd = entry.parameters()
        for line in odd:
            bench.report(f"*{name}: this parameter cannot be read: {line[:60]}")
        if bool(found) == bool(entry.paragraph("Parameters: ")) and rule.usage != "-":
            bench.report(f"*{name}: parameters, or 'Parameters: none.'")
        for word in [p.name for p in found.values() if not p.tells_default]:
            bench.report(f"*{name}: {word} has no default")
        for word in rule.parameters.keys() - found.keys():
            bench.report(f"*{name}: the reader knows {word}, the entry does not")
        for word in found.keys() - rule.parameters.keys():
            bench.report(f"*{name}: the entry has {word}, the reader does not know it")
        for word in found.keys() & rule.parameters.keys():
            if found[word].marks != rule.parameters[word]:
                bench.report(f"*{name}: {word} is '{found[word].marks}' in the entry, "
                             f"'{rule.parameters[word]}' in the reader's table")


def allowed_words(message):
    """The words after `allowed:` of a message about a value or word, None of another message."""
    if "unknown " not in message.partition("\n")[0]:
        return None
    found = re.search(r"allowed: (.*)", message)
    return {word.strip() for word in found[1].split(",")} if found else None


def spoil(deck, name, change):
    """A deck whose last card of a name is changed by a function."""
    cards = [Card(head, below) for head, below in split_cards(deck)]
    place = max(i for i, card in enumerate(cards) if card.keyword == folded(name))
    change(cards[place])
    return [line for card in cards for line in card.text_lines()]


def check_values(bench):
    """The values of each parameter: those that the reader names when it is given another."""
    n_lists = 0
    for name, entry in bench.cards.items():
        kind, example = entry.examples()[0]
        deck = bench.deck(kind, example)
        for parameter in entry.parameters()[0].values():
            if parameter.form == "" or parameter.not_yet or name == "INCLUDE":
                continue
            spoilt = spoil(deck, name, lambda card, p=parameter: card.set(p.name, WRONG))
            done = bench.try_deck("check", spoilt)
            allowed = allowed_words(done.stderr)
            if parameter.closed and allowed != set(parameter.words):
                bench.report(f"*{name}, {parameter.name}={parameter.words}; the reader:",
                             allowed, done.stderr[:200])
            elif allowed and not parameter.closed:
                missing = [word for word in allowed if f"`{word}`" not in entry.text]
                if missing:
                    bench.report(f"*{name}, {parameter.name}: the entry lacks {missing}")
            n_lists += allowed is not None
            for word in [] if parameter.closed else parameter.words:
                check_choice(bench, deck, name, parameter.name, word)
    if n_lists < 20:
        bench.report("only", n_lists, "parameters have named their values")


def check_choice(bench, deck, name, parameter, word):
    """A value that stands beside others in an entry (a number, AUTO) is known to the reader."""
    if not re.fullmatch(r"[A-Z]+|\d+", word):
        return
    done = bench.try_deck("check", spoil(deck, name, lambda card: card.set(parameter, word)))
    first = done.stderr.partition("\n")[0]
    if re.search(rf"{parameter}: |out of range|no such|no scheme|unknown", first):
        bench.report(f"*{name}, {parameter}={word} is refused: {first}")


def check_data_words(bench):
    """Words of data lines: those that the reader names when a field holds another."""
    n_lists = 0
    for name, entry in bench.cards.items():
        kind, example = entry.examples()[0]
        deck = bench.deck(kind, example)
        sizes = []
        spoil(deck, name, lambda card, s=sizes: s.extend(len(card.fields(r)) for r in
                                                         range(len(card.data))))
        for row, size in enumerate(sizes[:2]):
            for column in range(size):
                done = bench.try_deck("check", spoil(deck, name, wrong_field(row, column)))
                allowed = allowed_words(done.stderr)
                if allowed is None:
                    continue
                n_lists += 1
                if allowed != entry.data_words():
                    bench.report(f"*{name}: data words {entry.data_words()}, the reader: {allowed}")
    if n_lists < 7:
        bench.report("only", n_lists, "data lines have named their words")


def check_defaults(bench):
    """A default that is written out: the same results as without it."""
    n_defaults = 0
    for name, entry in bench.cards.items():
        kind, example = entry.examples()[0]
        deck = bench.deck(kind, example)
        for parameter in entry.parameters()[0].values():
            if parameter.default is None:
                continue
            n_defaults += 1
            results = []
            for value in (None, parameter.default):
                settings = {**CIRCUMSTANCES.get((name, parameter.name), {}), parameter.name: value}
                done = bench.try_deck("run", spoil(deck, name, lambda card, s=settings: [
                    card.set(word, setting) for word, setting in s.items()]))
                if done.returncode != 0:
                    bench.report(f"*{name}, {parameter.name}={value}:", done.stderr)
                results.append(done.returncode == 0 and recorded(bench.folder / "out.h5"))
            if results[0] != results[1]:
                bench.report(f"*{name}: {parameter.default} is not the default of {parameter.name}")
    if n_defaults < 25:
        bench.report("only", n_defaults, "parameters have a default that can be tried")


def recorded(path):
    """All numbers that a run recorded, by name: all but the deck and the costs."""
    found = {}
    with h5py.File(path, "r") as file:
        for group in file.keys() - {"cost", "model", "restart"}:
            file[group].visititems(lambda name, item, group=group: found.update(
                {f"{group}/{name}": item[()].tobytes()} if isinstance(item, h5py.Dataset) else {}))
    return found


def wrong_field(row, column):
    """A change of a card: a wrong word in a field."""
    def change(card):
        fields = card.fields(row)
        fields[column] = WRONG
        card.set_data(row, ", ".join(fields))
    return change


def check_examples(bench):
    """Every example runs in its deck, and holds the card it is for."""
    for kind, lines in bench.decks.items():
        done = bench.try_deck("run", lines)
        if done.returncode != 0:
            bench.report(f"the {kind} deck ends with status {done.returncode}:", done.stderr)
    for name, entry in bench.cards.items():
        for kind, example in entry.examples():
            if folded(name) not in [Card(head).keyword for head, _ in split_cards(example)]:
                bench.report(f"*{name}: its example lacks it")
            done = bench.try_deck("run", bench.deck(kind, example))
            if done.returncode != 0:
                bench.report(f"*{name}: its example ends with status {done.returncode}:",
                             done.stderr)


def plain(text):
    """Words without the marks of Markdown."""
    return text.replace("`", "").split()


def check_help(bench):
    """`carom help` prints every entry, whole, and the list of all."""
    contents = bench.call("help").stdout
    for entry in bench.entries:
        done = bench.call("help", entry.title)
        if done.returncode != 0 or plain(done.stdout) != plain(entry.title + "\n" + entry.text):
            bench.report(f"carom help {entry.title}: not the entry", done.stderr)
        wide = [line for line in done.stdout.splitlines() if len(line) > WIDTH]
        if wide:
            bench.report(f"{entry.title}: wider than {WIDTH}: {wide[0]}")
        line = f"  {entry.title:24}" + entry.summary.replace("`", "")
        if line not in contents.splitlines():
            bench.report(f"carom help lacks the line '{line}'")
    whole = bench.call("help", "*CONTACT PAIR").stdout
    for words in (["contact pair"], ["Contact", "Pair"], ["* contactpair"], ["### *CONTACT PAIR"]):
        if bench.call("help", *words).stdout != whole:
            bench.report("carom help does not know", words)
    for word, cure in (("frikton", "'FRICTION'"), ("restitution", "*IMPACT"),
                       ("contact", "*CONTACT PRINT"), ("zzzz", "carom help lists all")):
        done = bench.call("help", word)
        if done.returncode != 1 or done.stdout or cure not in done.stderr:
            bench.report(f"carom help {word}: status {done.returncode}, {done.stderr}")


def main():
    """Prints all mistakes; status 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("carom", help="the program")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(given.carom, folder)
        check_cards(bench)
        if not bench.mistakes:
            for check in (check_parameters, check_values, check_data_words, check_defaults,
                          check_examples, check_help):
                check(bench)
    for mistake in bench.mistakes:
        print(mistake)
    print(f"{len(bench.cards)} cards, {len(bench.entries)} entries, {len(bench.mistakes)} mistakes")
    return 1 if bench.mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
