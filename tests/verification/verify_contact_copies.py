"""Turned, enlarged and renumbered copies of contact cases give the same answer."""
import math

import numpy as np

from carom_case import Checks
from contact_case import Folder

CASES = {
    'dropped disc': (Folder('dropped_disc', 'make_disc'), 'q4.inp', {'end': 0.5}),
    'short on long': (Folder('two_bars', 'make_bars'), 'short_on_long.inp', {'end': 0.6}),
}


class Deck:
    """A deck as cards: the keyword line and its data lines, meshes included."""

    def __init__(self, path):
        self.cards = []
        for line in self._lines(path):
            if line.startswith('**') or not line.strip():
                continue
            if line.startswith('*'):
                self.cards.append([line, []])
            else:
                self.cards[-1][1].append([word.strip() for word in line.split(',')])

    def _lines(self, path):
        for line in path.read_text().splitlines():
            if line.upper().startswith('*INCLUDE'):
                yield from self._lines(path.parent / line.split('=')[1])
            else:
                yield line

    def each(self, *keywords):
        """The cards that begin so."""
        return [card for card in self.cards if card[0].startswith(keywords)]

    def text(self):
        return ''.join(head + '\n' + ''.join(', '.join(words) + '\n' for words in data)
                       for head, data in self.cards)

    def turn(self, degrees):
        """About the origin."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

        def turned(words):
            x, y = (float(word) for word in words)
            return [repr(c * x - s * y), repr(s * x + c * y)]

        for card in self.each('*NODE,'):
            card[1] = [[words[0], *turned(words[1:3])] for words in card[1]]
        for card in self.each('*RIGID SURFACE'):
            card[1] = [[*turned(words[:2]), '0'] for words in card[1]]
        for card in self.each('*INITIAL CONDITIONS'):
            lines = []
            for name, axis, value in card[1]:
                both = turned((value, '0') if axis == '1' else ('0', value))
                lines += [[name, '1', both[0]], [name, '2', both[1]]]
            merged = {}
            for name, axis, value in lines:
                merged[name, axis] = merged.get((name, axis), 0.0) + float(value)
            card[1] = [[name, axis, repr(value)] for (name, axis), value in merged.items()]

    def enlarge(self, length, mass):
        """Other units of length and mass."""
        def times(words, factor):
            return [repr(float(word) * factor) for word in words]

        for card in self.each('*NODE,'):
            card[1] = [[words[0], *times(words[1:], length)] for words in card[1]]
        for card in self.each('*RIGID SURFACE'):
            card[1] = [times(card[1][0], length), card[1][1]]
        for card in self.each('*ELASTIC'):
            card[1] = [[*times(card[1][0][:1], mass / length), card[1][0][1]]]
        for card in self.each('*DENSITY'):
            card[1] = [times(card[1][0], mass / length**3)]
        for card in self.each('*SOLID SECTION'):
            card[1] = [times(card[1][0] if card[1] else ['1'], length)]
        for card in self.each('*INITIAL CONDITIONS'):
            card[1] = [[name, axis, *times([value], length)] for name, axis, value in card[1]]

    def renumber(self, seed):
        """Other ids of nodes and elements, in another order."""
        random = np.random.RandomState(seed)
        maps = []
        for keyword in ('*NODE,', '*ELEMENT,'):
            ids = [words[0] for card in self.each(keyword) for words in card[1]]
            new = random.permutation(3 * len(ids))[:len(ids)] + 1
            maps.append(dict(zip(ids, (str(number) for number in new))))
            for card in self.each(keyword):
                card[1] = [card[1][i] for i in random.permutation(len(card[1]))]
        node, element = maps
        for card in self.each('*NODE,'):
            card[1] = [[node[words[0]], *words[1:]] for words in card[1]]
        for card in self.each('*ELEMENT,'):
            card[1] = [[element[words[0]], *(node[word] for word in words[1:])] for words in card[1]]
        for card in self.each('*SURFACE, NAME'):
            card[1] = [[element[words[0]], *words[1:]] for words in card[1]]
        for card in self.each('*NSET'):
            card[1] = [[node[word] for word in words if word] for words in card[1]]
        return node


def compare(checks, name, copy, original, factors, turned=0.0, nodes=None):
    """Forces, energies and displacements, the copy's in the units of the original."""
    length, force, energy = factors
    c, s = math.cos(math.radians(turned)), math.sin(math.radians(turned))
    back = np.array([[c, -s], [s, c]])          # rows times this: turned back
    seen = copy.force / force @ back
    checks.close(seen / original.size.max(), original.force / original.size.max(), 1e-8,
                 f'{name}: contact force')
    checks.close(copy.energy / energy / original.energy[0], original.energy / original.energy[0], 1e-8,
                 f'{name}: energy')
    u = copy.frames('U')[-1, :, :2] / length @ back
    if nodes:
        place = {number: i for i, number in enumerate(copy.run['model/node_id'])}
        u = u[[place[int(nodes[str(number)])] for number in original.run['model/node_id']]]
    exact = original.frames('U')[-1, :, :2]
    checks.close(u / np.abs(exact).max(), exact / np.abs(exact).max(), 1e-8, f'{name}: displacements')
    checks.true(len(copy.moments('impact')) == len(original.moments('impact')),
                f'{name}: as many instants of impact')


checks = Checks()
for case, (folder, deck, given) in CASES.items():
    original = folder.run(Deck(folder.path / deck).text(), **given)
    for degrees in (90.0, 37.0):
        copy = Deck(folder.path / deck)
        copy.turn(degrees)
        compare(checks, f'{case}, turned by {degrees:.0f}', folder.run(copy.text(), **given), original,
                (1.0, 1.0, 1.0), degrees)
    copy = Deck(folder.path / deck)
    copy.enlarge(1e3, 1e-3)
    compare(checks, f'{case}, in mm, t, s', folder.run(copy.text(), **given), original,
            (1e3, 1.0, 1e3))
    copy = Deck(folder.path / deck)
    nodes = copy.renumber(7)
    compare(checks, f'{case}, renumbered', folder.run(copy.text(), **given), original,
            (1.0, 1.0, 1.0), nodes=nodes)
checks.finish()
