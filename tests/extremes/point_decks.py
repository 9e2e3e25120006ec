"""Decks of point masses on a line, with springs, dashpots, gaps and walls."""


class Points:
    """Collects masses, springs and so on along x, and writes the deck of them; nodes from 1."""

    def __init__(self, masses, places=None):
        self.masses = masses
        self.places = places or [float(i) for i in range(len(masses))]
        self.cards, self.conditions = [], []
        self.n_elements = 0

    def element(self, kind, nodes, section):
        """An element of its own set, named after its number."""
        self.n_elements += 1
        name = f'E{self.n_elements}'
        card, *lines = section
        self.cards += [f'*ELEMENT, TYPE={kind}, ELSET={name}',
                       ', '.join(map(str, [self.n_elements, *nodes])),
                       card.format(name), *lines]
        return self

    def ground(self, node, stiffness):
        """A spring from the ground to a node."""
        return self.element('SPRING1', [node], ['*SPRING, ELSET={}', '1', number(stiffness)])

    def link(self, first, second, stiffness):
        """A spring between two nodes."""
        return self.element('SPRING2', [first, second],
                            ['*SPRING, ELSET={}', '1, 1', number(stiffness)])

    def impact(self, options='METHOD=TRANSFORMATION, RESTITUTION=1, BETA=1/4'):
        """How things behave that touch: interaction I."""
        self.cards += ['*SURFACE INTERACTION, NAME=I', f'*IMPACT, {options}']
        return self

    def gap(self, first, second, clearance):
        """Two nodes that may hit each other, the second on the right."""
        return self.element('GAPUNI', [first, second],
                            ['*GAP, ELSET={}, INTERACTION=I', f'{number(clearance)}, 1, 0, 0'])

    def wall(self, node, place, side=1):
        """A wall for a node, which is on its right (side 1) or left (-1)."""
        self.cards += [f'*SURFACE, NAME=S{node}, TYPE=NODE', str(node),
                       f'*RIGID SURFACE, NAME=W{node}, TYPE=PLANE', f'{number(place)}, 0, 0',
                       f'{side}, 0, 0', '*CONTACT PAIR, INTERACTION=I', f'S{node}, W{node}']
        return self

    def start(self, displacements=None, velocities=None):
        """Initial values by node: {1: 0.5}."""
        for kind, values in (('DISPLACEMENT', displacements), ('VELOCITY', velocities)):
            if values:
                self.cards.append(f'*INITIAL CONDITIONS, TYPE={kind}')
                self.cards += [f'{node}, 1, {number(value)}' for node, value in values.items()]
        return self

    def add(self, *lines):
        """Any other lines of the model."""
        self.cards += lines
        return self

    def deck(self, *steps):
        """The text, with the steps as `dynamic` and `static` give them."""
        lines = ['*NODE'] + [f'{i + 1}, {number(x)}, 0' for i, x in enumerate(self.places)]
        for i, mass in enumerate(self.masses):
            if mass is not None:
                self.element('MASS', [i + 1], ['*MASS, ELSET={}', number(mass)])
        return '\n'.join([*lines, *self.cards, *steps]) + '\n'


def number(value):
    """A number with all its digits."""
    return repr(float(value))


PRINTS = '*NODE PRINT\nU, V, A\n*ENERGY PRINT\n'
CONTACT_PRINTS = PRINTS + '*CONTACT PRINT\nCF, CDIS\n'


def step(procedure, times, *cards, prints=PRINTS):
    """A step: '*DYNAMIC, DIRECT', (dt, T), cards of loads."""
    lines = ['*STEP', f'*{procedure}', ', '.join(number(t) for t in times), *cards]
    return '\n'.join(lines) + f'\n{prints}*END STEP'
