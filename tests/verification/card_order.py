"""Decks with their cards in another order: shuffled(deck, seed) tells the same model another way.

    python3 card_order.py DECK SEED          prints the deck

What is moved: the lines of a card among each other where each stands for itself (nodes, elements,
members of sets, sides of surfaces, pairs, conditions, loads, equations), the cards of the model among each
other, and within a step all that follows its procedure. What stays: the lines of a table or
a property, cards that belong to the one before them (`*ELASTIC` to `*MATERIAL`), and the order of steps.
"""
import argparse
import random
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'scripts'))
from carom_deck import Deck, is_empty, parse_number   # noqa: E402  (from scripts)

# Each data line stands for itself
FREE_LINES = {'NODE', 'NSET', 'ELSET', 'BOUNDARY', 'INITIALCONDITIONS', 'CLOAD', 'DLOAD', 'SURFACE',
              'CONTACTPAIR', 'PARAMETER', 'NODEPRINT', 'NODEFILE', 'ELPRINT', 'ELFILE',
              'CONTACTPRINT', 'CONTACTFILE'}
# Cards that others after them belong to, and those others
OWNERS = {'MATERIAL', 'SURFACEINTERACTION'}
PARTS = {'ELASTIC', 'PLASTIC', 'DENSITY', 'DAMPING', 'IMPACT', 'FRICTION'}
PROCEDURES = {'STATIC', 'DYNAMIC', 'FREQUENCY'}


def joined_lines(lines):
    """Data lines with those that a comma at the end joins to them."""
    rows, open_row = [], False
    for line in lines:
        if open_row:
            rows[-1].append(line)
        else:
            rows.append([line])
        open_row = line.rstrip().endswith(',')
    return rows


def equations(lines):
    """The lines of each equation: the number of its terms, then four terms a line."""
    rows = []
    while lines:
        terms = int(lines[0].split(',')[0])
        rows.append(lines[:1 + (terms + 3) // 4])
        lines = lines[len(rows[-1]):]
    return rows


def rows_of(card):
    """The data of a card in the pieces that can be moved, or None."""
    lines = [line for line in card.lines if not is_empty(line)]
    if card.keyword == 'ELEMENT':
        return joined_lines(lines)
    if card.keyword == 'EQUATION':
        return equations(lines)
    return [[line] for line in lines] if card.keyword in FREE_LINES else None


def shuffled_card(card, order):
    """The lines of a card, its data in another order."""
    rows = rows_of(card)
    if rows is None:
        return card.text_lines()
    order.shuffle(rows)
    return [*card.head, *(line for row in rows for line in row)]


def shuffled_cards(cards, order):
    """The lines of cards in another order, each with those that belong to it."""
    blocks, owner = [], None
    for card in cards:
        if card.keyword in PARTS:
            owner += shuffled_card(card, order)
            continue
        blocks.append(shuffled_card(card, order))
        if card.keyword in OWNERS:
            owner = blocks[-1]
    order.shuffle(blocks)
    return [line for block in blocks for line in block]


def shuffled(deck, seed):
    """The text of a deck with the same cards in another order; included files are written out."""
    order = random.Random(seed)
    lines, model, step = [], [], None
    heading = [card for card in deck if card.keyword == 'HEADING']
    for card in deck:
        if card.keyword == 'STEP':
            if model is not None:
                lines = [line for head in heading for line in head.text_lines()]
                lines += shuffled_cards(model, order)
                model = None
            lines += card.text_lines()
            step = []
        elif card.keyword == 'ENDSTEP':
            lines += [*shuffled_cards(step, order), *card.text_lines()]
        elif step is not None and card.keyword in PROCEDURES:
            lines += card.text_lines()
        elif step is not None:
            step.append(card)
        elif card.keyword != 'HEADING':
            model.append(card)
    return '\n'.join(lines) + '\n'


def moved(deck, seed):
    """The text of a deck whose nodes are moved by round-off: some parts in 1e16 of their coordinates."""
    chance = random.Random(seed)
    for card in deck.cards('NODE'):
        for row in range(len(card.data)):
            fields = card.fields(row)
            for i, field in enumerate(fields[1:], 1):
                value = parse_number(field)
                if value:
                    fields[i] = repr(value * (1.0 + chance.randint(-4, 4) * 2.3e-16))
            card.set_data(row, ', '.join(fields))
    return deck.text()


def main():
    """Prints a shuffled deck."""
    parser = argparse.ArgumentParser(description=__doc__.split('\n', maxsplit=1)[0])
    parser.add_argument('deck')
    parser.add_argument('seed', type=int)
    arguments = parser.parse_args()
    print(shuffled(Deck.read(arguments.deck), arguments.seed), end='')


if __name__ == '__main__':
    main()
