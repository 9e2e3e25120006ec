"""Changes that spoil a deck: bytes, cards, parameters, data lines, numbers, names, files.

Every change is a function of a random generator, a deck (changed in place) and the list of all
decks. It returns False where the deck has nothing that it could change.
"""
import numpy as np

from fuzz_deck import Deck, NUMBER, drop_parameter, get_parameter, set_parameter
from vocabulary import (ODD_BYTES, ODD_FILES, ODD_NAMES, ODD_NUMBERS, PARAMETERS, REFERENCES)


def pick(rng, items):
    """One of the items of a sequence, kept as it is."""
    return items[int(rng.integers(len(items)))]


def pick_card(rng, deck):
    """Place of a card, or None."""
    return int(rng.integers(len(deck.cards))) if deck.cards else None


def replace_text(deck, text):
    """Gives the deck another text."""
    deck.cards = Deck.from_text("", text).cards


def spoil_bytes(rng, deck, _):
    """Flips, inserts, deletes, repeats or cuts off bytes somewhere in the text."""
    text = deck.text()
    if not text:
        return False
    here = int(rng.integers(len(text)))
    if rng.random() < 0.5:      # near the cards, not in the midst of a table
        place = pick_card(rng, deck)
        here = sum(len(line) + 1 for card in deck.cards[:place] for line in card)
        here = min(here + int(rng.integers(40)), len(text) - 1)
    there = min(len(text), here + int(rng.integers(1, 30)))
    kind = rng.integers(7)
    if kind == 0:
        text = text[:here] + chr(ord(text[here]) ^ (1 << int(rng.integers(8)))) + text[here + 1:]
    elif kind == 1:
        text = text[:here] + pick(rng, ODD_BYTES) + text[here:]
    elif kind == 2:
        text = text[:here] + text[there:]
    elif kind == 3:
        text = text[:there] + text[here:]
    elif kind == 4:
        text = text[:here]
    elif kind == 5:
        text = text[:here] + pick(rng, ODD_BYTES)*pick(rng, [2, 80, 5000]) + text[here:]
    else:
        text = text[:here] + "".join(chr(c) for c in rng.integers(0, 256, 12)) + text[there:]
    replace_text(deck, text)
    return True


def spoil_whole_file(rng, deck, _):
    """Other ends of lines, a mark at the start, no end of the last line, tabs, one case, nothing."""
    text = deck.text()
    changes = [
        lambda: text.replace("\n", "\r\n"), lambda: text.replace("\n", "\r"),
        lambda: "\xef\xbb\xbf" + text, lambda: "\xff\xfe" + text, lambda: text.rstrip("\n"),
        lambda: text.replace(" ", "\t"), lambda: text.upper(), lambda: text.lower(),
        lambda: "".join(c + "\x00" for c in text[:5000]), lambda: text.replace(",", ", "),
        lambda: text.replace("\n", "   \n"), lambda: text + text, lambda: "",
        lambda: text.replace(",", ""), lambda: text.replace(",", ";"), lambda: text + "\n"*1000,
        lambda: text.replace("\n", " "), lambda: text[::-1], lambda: text.replace("*", "**"),
        lambda: text.replace(".", ","), lambda: text.replace(" ", ""),
    ]
    replace_text(deck, pick(rng, changes)())
    return True


def drop_card(rng, deck, _):
    """Takes one card away, or one and all that follow."""
    place = pick_card(rng, deck)
    if place is None:
        return False
    del deck.cards[place:place + 1 if rng.random() < 0.9 else None]
    return True


def repeat_card(rng, deck, _):
    """A card twice, at once or elsewhere."""
    place, other = pick_card(rng, deck), pick_card(rng, deck)
    if place is None:
        return False
    deck.cards.insert(place if rng.random() < 0.5 else other, list(deck.cards[place]))
    return True


def move_card(rng, deck, _):
    """A card to another place: into steps, out of them, before what it belongs to."""
    place, other = pick_card(rng, deck), pick_card(rng, deck)
    if place is None:
        return False
    deck.cards.insert(other, deck.cards.pop(place))
    return True


def exchange_cards(rng, deck, _):
    """Two cards change places, or all are shuffled."""
    place, other = pick_card(rng, deck), pick_card(rng, deck)
    if place is None:
        return False
    if rng.random() < 0.1:
        deck.cards = [deck.cards[i] for i in rng.permutation(len(deck.cards))]
    else:
        cards = deck.cards
        cards[place], cards[other] = cards[other], cards[place]
    return True


def splice_card(rng, deck, decks):
    """A card of another deck, in any place."""
    donor = pick(rng, decks)
    place = pick_card(rng, donor)
    if place is None or sum(len(line) for line in donor.cards[place]) > 20000:
        return False
    deck.cards.insert(int(rng.integers(len(deck.cards) + 1)), list(donor.cards[place]))
    return True


def splice_halves(rng, deck, decks):
    """The first cards of this deck, the last ones of another (such as the steps)."""
    donor = pick(rng, decks)
    if not donor.cards or not deck.cards:
        return False
    steps = donor.places("STEP")
    start = steps[0] if steps and rng.random() < 0.5 else pick_card(rng, donor)
    mine = deck.places("STEP")
    end = mine[0] if mine and rng.random() < 0.5 else pick_card(rng, deck)
    deck.cards[end:] = [list(card) for card in donor.cards[start:]]
    deck.files = {**donor.files, **deck.files}
    return True


def spoil_keyword(rng, deck, _):
    """A misspelt, shortened or other keyword."""
    place = pick_card(rng, deck)
    if place is None or not deck.cards[place][0].startswith("*"):
        return False
    word, comma, rest = deck.cards[place][0][1:].partition(",")
    there = int(rng.integers(len(word) + 1))
    word = pick(rng, [word[:there] + word[there + 1:], word[:there] + "X" + word[there:],
                      word[:there], word + word, pick(rng, sorted(PARAMETERS)), "",
                      pick(rng, ODD_NAMES), " " + word, word.lower(), word + "=1"])
    deck.cards[place][0] = "*" + word + comma + rest
    return True


def spoil_parameter(rng, deck, decks):
    """Parameters dropped, given twice, misspelt, from other cards, with other values."""
    places = [i for i, card in enumerate(deck.cards) if "," in card[0]]
    if not places:
        return False
    place = pick(rng, places)
    words = deck.cards[place][0].split(",")
    chosen = int(rng.integers(1, len(words)))
    name, _, value = words[chosen].partition("=")
    kind = rng.integers(8)
    if kind == 0:
        del words[chosen]
    elif kind == 1:
        words.append(words[chosen])
    elif kind == 2:
        there = int(rng.integers(len(name) + 1))
        words[chosen] = name[:there] + pick(rng, ["", "X", " ", "=", "*"]) + name[there + 1:] + "=1"
    elif kind == 3:
        donor = pick(rng, decks)
        if donor.cards:
            words += pick(rng, donor.cards)[0].split(",")[1:]
    elif kind == 4:
        words[chosen] = f"{name}={pick(rng, ODD_NAMES)}"
    elif kind == 5:
        words[chosen] = f"{name}={pick(rng, ODD_NUMBERS)}"
    elif kind == 6:
        words[chosen] = pick(rng, [name, value, f"{name}=", f"={value}", f"{name}=={value}"])
    else:
        words = [*words[:1], *(words[1 + i] for i in rng.permutation(len(words) - 1))]
    deck.cards[place][0] = ",".join(words)
    return True


def pick_line(rng, deck, pattern=None):
    """Place of a card and number of one of its data lines; None if there is none."""
    places = [i for i in range(len(deck.cards)) if deck.data_lines(i)]
    if not places:
        return None
    for _ in range(20):
        place = pick(rng, places)
        line = pick(rng, deck.data_lines(place))
        if pattern is None or pattern.search(deck.cards[place][line]):
            return place, line
    return None


def spoil_line(rng, deck, _):
    """Data lines dropped, given twice, shuffled, cut, with too many or too few fields."""
    found = pick_line(rng, deck)
    if found is None:
        return False
    place, line = found
    card = deck.cards[place]
    words = card[line].split(",")
    kind = rng.integers(11)
    if kind == 0:
        del card[line]
    elif kind == 1:
        card.insert(line, card[line])
    elif kind == 2:
        card[1:] = [card[1 + i] for i in rng.permutation(len(card) - 1)]
    elif kind == 3:
        card[line] = ",".join(words[:-1])
    elif kind == 4:
        card[line] = ",".join([*words, pick(rng, [" 1", "", " 0.5", " x"])])
    elif kind == 5:
        card[line] = card[line].replace(",", " ", 1)
    elif kind == 6:
        del card[1:]
    elif kind == 7:
        card[line] = ",".join(words*pick(rng, [2, 3, 2000]))
    elif kind == 8:
        card[line] = ",".join(words[i] for i in rng.permutation(len(words)))
    elif kind == 9:
        card[line] += pick(rng, [",", ",,", "\\", " ** comment", "!", " /"])
    else:
        words[int(rng.integers(len(words)))] = pick(rng, ["", " ", *ODD_NAMES])
        card[line] = ",".join(words)
    return True


def spoil_number(rng, deck, _):
    """One number of a data line, or of a keyword line, becomes an odd one."""
    return change_number(rng, deck, lambda text: pick(rng, ODD_NUMBERS))


def vary_number(rng, deck, _):
    """One number becomes another of its kind: scaled, with the other sign, next to it, from elsewhere."""
    def vary(text):
        try:
            value = int(text)
        except ValueError:
            return scale(text)
        if rng.random() < 0.2:
            return scale(text)
        return str(pick(rng, [value + 1, value - 1, -value, 0, 10*value, other(), other(), other()]))

    def scale(text):
        try:
            value = float(text.replace("d", "e").replace("D", "e"))
        except ValueError:
            return text
        factor = pick(rng, [-1, 0, 0.1, 10, 1e-3, 1e3, 1e-6, 1e6, 1e-12, 1e12, 1 + 1e-9, 2, 0.5])
        return repr(float(value*factor))

    def other():
        found = pick_line(rng, deck, NUMBER)
        if found is None:
            return 1
        return pick(rng, NUMBER.findall(deck.cards[found[0]][found[1]]))

    return change_number(rng, deck, vary)


def change_number(rng, deck, change):
    """Applies a change to the text of one number."""
    if rng.random() < 0.15:
        places = [i for i, card in enumerate(deck.cards) if NUMBER.search(card[0])]
        found = (pick(rng, places), 0) if places else None
    else:
        found = pick_line(rng, deck, NUMBER)
    if found is None:
        return False
    place, line = found
    text = deck.cards[place][line]
    match = pick(rng, list(NUMBER.finditer(text)))
    deck.cards[place][line] = text[:match.start()] + change(match[0]) + text[match.end():]
    return True


def spoil_table(rng, deck, _):
    """One column of a card's lines: constant, exchanged with another, scaled, or in another order."""
    places = [i for i in range(len(deck.cards)) if len(deck.data_lines(i)) > 1]
    if not places:
        return False
    card = deck.cards[place := pick(rng, places)]
    lines = deck.data_lines(place)
    rows = [card[i].split(",") for i in lines]
    width = min(len(row) for row in rows)
    column, other = int(rng.integers(width)), int(rng.integers(width))
    kind = rng.integers(5)
    order = rng.permutation(len(rows))
    constant = pick(rng, [rows[0][column], pick(rng, ODD_NUMBERS), "0", "1"])
    old = [row[column] for row in rows]
    for i, row in enumerate(rows):
        if kind == 0:
            row[column] = constant
        elif kind == 1:
            row[column], row[other] = row[other], row[column]
        elif kind == 2:
            row[column] = old[order[i]]
        elif kind == 3:
            row[column] = scaled_field(row[column], constant)
        else:
            row[column] = str(i + int(order[0]))
        card[lines[i]] = ",".join(row)
    return True


def scaled_field(field, constant):
    """A number of a table shrunk or blown up, by what `constant` says; other fields stay."""
    try:
        return f" {float(field)*(1e-9 if len(constant) % 2 else -1e6)!r}"
    except ValueError:
        return field


def spoil_name(rng, deck, _):
    """The value of a parameter that names something becomes another name of the deck, or nonsense."""
    found = [(i, parameter) for i, card in enumerate(deck.cards)
             for parameter in [*REFERENCES, "NAME"] if get_parameter(card[0], parameter)]
    if not found:
        return False
    place, parameter = pick(rng, found)
    names = [name for source in REFERENCES.values() for pair in source
             for name in deck.names(*pair)]
    names += deck.names("SURFACE", "NAME") + deck.names("RIGIDSURFACE", "NAME") + [""]
    name = pick(rng, names if rng.random() < 0.6 else ODD_NAMES)
    deck.cards[place][0] = set_parameter(deck.cards[place][0], parameter, name)
    if rng.random() < 0.1:
        deck.cards[place][0] = drop_parameter(deck.cards[place][0], parameter)
    return True


def spoil_include(rng, deck, _):
    """A file that includes itself, another, nothing, many; or one that is no deck."""
    name = pick(rng, ODD_FILES)
    if name == "self.inc":
        deck.files[name] = pick(rng, ["*INCLUDE, INPUT=self.inc\n", "*INCLUDE, INPUT=deck.inp\n",
                                      "", "1, 2, 3\n", "** nothing\n", "*NODE\n9, 9., 9.\n"])
    deck.cards.insert(int(rng.integers(len(deck.cards) + 1)), [f"*INCLUDE, INPUT={name}"])
    if deck.files and rng.random() < 0.5:
        spoiled = pick(rng, sorted(deck.files))
        inner = Deck.from_text("", deck.files[spoiled])
        if spoil_bytes(rng, inner, None):
            deck.files[spoiled] = inner.text()
    return True


def spoil_deeply(rng, deck, _):
    """Included files one in the other, down to some depth."""
    depth = pick(rng, [2, 20, 200])
    for i in range(depth):
        deck.files[f"deep{i}.inc"] = f"*INCLUDE, INPUT=deep{i + 1}.inc\n"
    deck.files[f"deep{depth}.inc"] = "** the deepest\n"
    deck.cards.insert(int(rng.integers(len(deck.cards) + 1)), ["*INCLUDE, INPUT=deep0.inc"])
    return True


def spoil_defined(rng, deck, _):
    """Numbers with names: other values, names that stand for each other, named twice."""
    lines = pick(rng, [["dt = <dt>"], ["a = <b>", "b = <a>"], [f"e = {pick(rng, ODD_NUMBERS)}"],
                       [f"{pick(rng, ODD_NAMES)} = 1"], ["e = 1", "e = 2"], ["x"], ["="], ["= 1"],
                       ["x ="], ["x = 1 = 2"], [f"p{i} = {i}" for i in range(2000)]])
    deck.cards.insert(int(rng.integers(len(deck.cards) + 1)), ["*PARAMETER", *lines])
    return True


CHANGES = [
    (6, spoil_bytes), (1, spoil_whole_file), (4, drop_card), (3, repeat_card), (4, move_card),
    (2, exchange_cards), (5, splice_card), (2, splice_halves), (2, spoil_keyword),
    (6, spoil_parameter), (5, spoil_line), (8, spoil_number), (8, vary_number), (5, spoil_table),
    (4, spoil_name), (1, spoil_include), (0.3, spoil_deeply), (1, spoil_defined),
]
WEIGHTS = np.array([weight for weight, _ in CHANGES])/sum(weight for weight, _ in CHANGES)
