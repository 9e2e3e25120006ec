"""Decks for runs that are stopped, killed and taken up again: made from those of input/.

They are made longer by smaller increments and write less, so that a run takes about a second and a
moment within it is within its increments. Each stands for one thing that a state has to keep. The
argument scales their lengths.
"""
from carom_case import INPUT

from carom_deck import Deck

RESTART = '*RESTART, WRITE, FREQUENCY={}'


def wall(length):
    """A mass on a spring that hits a wall: very many, very short increments."""
    deck = Deck.read(INPUT / 'sdof/sdof.inp')
    deck.set_time_step(1e-4, 40 * length)
    deck.thin_output(frames=2000, prints=50)
    return deck


def bar(length):
    """An elastic bar that stays at the wall for a while."""
    deck = Deck.read(INPUT / 'bar/bar_implicit.inp')
    deck.set_time_step(2e-5, 1.4 * length)
    deck.thin_output(frames=5000, prints=100)
    return deck


def plastic(length):
    """A cylinder of plastic material in static increments chosen by the program."""
    deck = Deck.read(INPUT / 'thick_cylinder/plastic_cax4.inp')
    deck.cards('STATIC')[0].set('DIRECT', None)
    deck.cards('STATIC')[0].set_data(0, f'1e-5, 1, 1e-8, {6e-4 / length!r}')
    deck.set('STEP', INC=100000)
    deck.thin_output(frames=100, prints=5)
    return deck


def friction(length):
    """A block that slides to rest on a rough plane, in contact all the time."""
    deck = Deck.read(INPUT / 'sliding_block/sliding.inp')
    deck.set_time_step(1e-4, 2.0 * length)
    deck.thin_output(frames=1000, prints=20)
    return deck


def tolerance(length):
    """Two masses and a wall, in increments that keep a TOLERANCE: rehearsed before."""
    deck = Deck.read(INPUT / 'two_dof/two_dof.inp')
    deck.set('DYNAMIC', DIRECT=None, TOLERANCE='1e-7')
    deck.set_time_step(0.04, 30 * length)
    deck.thin_output(frames=500, prints=20)
    return deck


def explicit(length):
    """The bar by explicit increments."""
    deck = Deck.read(INPUT / 'bar/bar_explicit.inp')
    deck.set_time_step(2e-5, 1.4 * length)
    deck.thin_output(frames=5000, prints=100)
    return deck


CASES = {case.__name__: case for case in (wall, bar, plastic, friction, tolerance, explicit)}


def write_case(name, path, states_every=None, length=1.0):
    """Writes the deck of a case; with `states_every`, it keeps a state every so many increments.
    The length is that of the run, one is about a second."""
    deck = CASES[name](length)
    if states_every:
        deck.add_before('END STEP', RESTART.format(states_every))
    deck.write(path)
    return path
