"""Decks of point masses that hit walls and each other, for cases at the extremes of impact."""
from collections import namedtuple

import numpy as np

#: `nodes` (counted from 1) may touch a plane; `push` is the way it goes at amplitude 1, and `curve`
#: the pairs of time and amplitude, as in 'push=(1, 0), curve="0, 0, 10, 5"'.
Wall = namedtuple('Wall', 'point normal nodes interaction push curve',
                  defaults=[(1,), 'HIT', None, None])

REQUESTS = '*NODE PRINT\nU, V\n*CONTACT PRINT\nCF, CDIS\n*ENERGY PRINT'
#: All ways to enforce contact; what fits a single mass of about one and steps below 0.1.
TRANSFORMATIONS = ('BETA=1/4', 'EVENTS=ANCHOR')
FICTITIOUS = ('METHOD=FICTITIOUS FORCE', 'METHOD=FICTITIOUS FORCE, SOLUTION=DIRECT')
OTHERS = ('METHOD=PENALTY, STIFFNESS=300', 'METHOD=LAGRANGE')
METHODS = TRANSFORMATIONS + FICTITIOUS + OTHERS
#: Overlap that is round-off of places of about one.
ROUND_OFF = 1e-11


def slug(text):
    """A word for the name of a case."""
    return ''.join(letter if letter.isalnum() else '_' for letter in text).strip('_')


def _numbers(*values):
    return ', '.join(repr(float(value)) for value in values)


def _pair(vector):
    return (vector, 0.0) if np.ndim(vector) == 0 else tuple(vector)


class PointDeck:
    """Collects the cards of a deck of point masses; `text()` is the deck.

    places, speeds: a number (along x) or a pair for each node; masses: 0 for none
    """

    def __init__(self, places, speeds=0.0, masses=1.0):
        n = len(places)
        self.lines = ['*NODE'] + [f'{i + 1}, {_numbers(*_pair(place))}'
                                  for i, place in enumerate(places)]
        self.conditions, self.n_elements, self.n_walls = [], 0, 0
        for i, mass in enumerate(np.broadcast_to(masses, n)):
            if mass > 0:
                self._element('MASS', f'M{i + 1}', [i + 1], ['*MASS', _numbers(mass)])
        speeds = [_pair(speed) for speed in (speeds if np.ndim(speeds) else [speeds]*n)]
        self._condition('VELOCITY', speeds)

    def _element(self, kind, name, nodes, section):
        self.n_elements += 1
        self.lines += [f'*ELEMENT, TYPE={kind}, ELSET={name}',
                       ', '.join(str(i) for i in [self.n_elements, *nodes]),
                       f'{section[0]}, ELSET={name}', *section[1:]]

    def _condition(self, kind, values):
        lines = [f'{i + 1}, {freedom + 1}, {_numbers(value)}' for i, pair in enumerate(values)
                 for freedom, value in enumerate(pair) if value != 0]
        if lines:
            self.conditions += [f'*INITIAL CONDITIONS, TYPE={kind}', *lines]

    def moved(self, displacements):
        """Initial displacements along x, one a node."""
        self._condition('DISPLACEMENT', [(value,) for value in displacements])
        return self

    def ground(self, node, stiffness, freedom=1):
        """A spring from a node to the ground."""
        self._element('SPRING1', f'G{self.n_elements}', [node],
                      ['*SPRING', str(freedom), _numbers(stiffness)])
        return self

    def spring(self, one, other, stiffness):
        """A spring between two nodes, along x."""
        self._element('SPRING2', f'S{self.n_elements}', [one, other],
                      ['*SPRING', '1, 1', _numbers(stiffness)])
        return self

    def impact(self, parameters, name='HIT', friction=None):
        """How things behave that touch: the parameters of *IMPACT."""
        self.lines += [f'*SURFACE INTERACTION, NAME={name}', f'*IMPACT, {parameters}']
        if friction is not None:
            self.lines += ['*FRICTION', _numbers(friction)]
        return self

    def gap(self, one, other, clearance, interaction='HIT'):
        """A gap along x between two nodes."""
        self._element('GAPUNI', f'P{self.n_elements}', [one, other],
                      [f'*GAP, INTERACTION={interaction}', _numbers(clearance, 1, 0, 0)])
        return self

    def wall(self, *arguments, **keywords):
        """A rigid plane, as `Wall` says."""
        wall = Wall(*arguments, **keywords)
        self.n_walls += 1
        n = self.n_walls
        self.lines += [f'*SURFACE, NAME=B{n}, TYPE=NODE', *(str(node) for node in wall.nodes)]
        amplitude = ''
        if wall.push:
            amplitude = f', AMPLITUDE=A{n}'
            self.lines += [f'*AMPLITUDE, NAME=A{n}, TIME=TOTAL TIME', wall.curve]
        self.lines += [f'*RIGID SURFACE, NAME=W{n}, TYPE=PLANE{amplitude}',
                       _numbers(*_pair(wall.point), 0), _numbers(*_pair(wall.normal), 0)]
        if wall.push:
            self.lines.append(_numbers(*_pair(wall.push), 0, 1))
        self.lines += [f'*CONTACT PAIR, INTERACTION={wall.interaction}', f'B{n}, W{n}']
        return self

    def text(self, dt, end, gravity=0.0, procedure='DIRECT', requests=REQUESTS, steps=1, loads=()):
        """The deck, with so many steps as long as `end`; gravity along x."""
        lines = [*self.lines, *self.conditions]
        for step in range(steps):
            lines += ['*STEP', f'*DYNAMIC, {procedure}', _numbers(dt, end)]
            if step == 0:
                if gravity:
                    lines += ['*DLOAD', f', GRAV, {_numbers(abs(gravity), np.sign(gravity), 0, 0)}']
                lines += [*loads, requests]
            lines.append('*END STEP')
        return '\n'.join(lines) + '\n'


def one_mass(parameters, wall=-0.5, speed=-1.0, place=0.0):
    """A mass of one that flies at a wall."""
    return PointDeck([place], [speed]).impact(parameters).wall(wall, 1)


def smallest_gap(run):
    """The smallest gap of all pairs at all times."""
    return min(np.min(run[f'history/{name}/CDIS']) for name in run.file['history']
               if name.startswith('contact'))


def kinds(run):
    """How many events of each kind there were."""
    if 'events' not in run.file:
        return {}
    names, counts = np.unique(run['events/kind'], return_counts=True)
    return {name.decode(): int(count) for name, count in zip(names, counts)}


def worst_balance(run):
    """Largest error of the energy balance, in parts of the largest energy met."""
    scale = max(np.abs(run[f'energy/{name}']).max() for name in ('total', 'external_work'))
    return np.abs(run['energy/balance_error']).max()/max(scale, 1e-300)


def is_capped(run):
    """Whether MAX EVENTS was reached, by the log."""
    return 'MAX EVENTS was reached' in run.log
