"""Exact solutions for tradeoff.py: which belongs to a deck, and its motion, impulse and energy.

A deck of input/ is recognised by its model: every card but those that say how it is computed and
what is printed must be the same. Parameters (`*PARAMETER`, --define) may differ.
"""

import math
from pathlib import Path

import numpy as np

from carom_deck import Deck, parse_number
from carom_script import ScriptError, folded
from contact_solutions import bars_head_on
from exact_solutions import bouncing_ball, masses_in_line, oscillator, two_dof

INPUT = Path(__file__).resolve().parents[1] / "input"

# Cards that change how a model is computed or shown, not what it is
FREE_CARDS = {
    "HEADING", "PARAMETER", "IMPACT", "STEP", "ENDSTEP", "DYNAMIC", "ELEMENTGROUP", "NODEPRINT",
    "NODEFILE", "ELPRINT", "ELFILE", "CONTACTPRINT", "CONTACTFILE", "ENERGYPRINT", "OUTPUT",
    "NSET", "PREPRINT", "PRINT",
}


class Exact:
    """An exact solution. What is not known stays None.

    motion(t)   displacements, an array (columns, times), of the columns of /history named
    impulse(t)  contact impulse up to the times
    energy(t)   kinetic and strain energy at a time
    """

    def __init__(self, columns=(), motion=None, impulse=None, energy=None, errors=("displacement",)):
        self.columns, self.motion = list(columns), motion
        self.impulse, self.energy, self.errors = impulse, energy, errors


def signature(deck):
    """What the model of a deck is, as text that can be compared."""
    words = []
    for card in deck:
        if card.keyword in FREE_CARDS:
            continue
        kept = {"INTERACTION"} if card.keyword == "CONTACTPAIR" else set(card.parameters)
        words.append(card.keyword)
        words += sorted(f"{k}={card.parameters[k][1]}" for k in kept & set(card.parameters))
        words += [folded(line) for line in card.data]
    return "\n".join(words)


def recognise(deck):
    """The name of the case that a deck of input/ is; None if it is none."""
    own = signature(deck)
    for path, case in DECKS.items():
        original = INPUT / path
        if original.is_file() and signature(Deck.read(original)) == own:
            return case
    return None


def exact_solution(name, deck, defined):
    """The exact solution of a case with the parameters of a deck; None if it has none for them.

    `name` may carry values of its own: `sdof:wall=-0.4,e=0.8`.
    """
    case, _, rest = name.partition(":")
    if case not in CASES:
        raise ScriptError(f"no exact solution '{case}'; there are: {', '.join(CASES)}, none")
    values = {k: parse_number(v) for k, v in deck.definitions().items()}
    values.update((folded(k), float(v)) for k, v in defined.items())
    for item in filter(None, rest.split(",")):
        key, _, text = item.partition("=")
        number = parse_number(text)
        if number is None:
            raise ScriptError(f"--exact {name}: '{item}' is not NAME=NUMBER")
        values[folded(key)] = number
    return CASES[case](values, deck)


def solve_sdof(given, _):
    """One mass on a spring in front of a wall; the impulse is the sum of those of the impacts."""
    m, k, e = given.get("MASS", 1.0), given.get("STIFFNESS", 1.0), given.get("E", 1.0)
    end = given["END"]
    wall = given.get("WALL", -0.5)
    flights = oscillator(end, m, k, given.get("D0", 1.0), given.get("V0", 0.0), wall, e)
    omega = math.sqrt(k / m)
    start = given.get("D0", 1.0) ** 2 + (given.get("V0", 0.0) / omega) ** 2 - wall**2
    speeds = omega * math.sqrt(max(0.0, start)) * e ** np.arange(len(flights.impact_times))
    blows = m * (1.0 + e) * speeds

    def energy(t):
        d, v = flights.at(t)
        return 0.5 * (m * v**2 + k * d**2)

    return Exact(
        ["node_1/U1"], lambda t: flights.at(t)[0][None, :], sums(flights.impact_times, blows), energy
    )


def solve_two_dof(given, _):
    """Two masses on two springs, the second in front of a wall."""
    flights = two_dof(given["END"], given.get("E", 1.0), given.get("WALL", -0.5))
    stiffness = np.array([[2.0, -1.0], [-1.0, 1.0]])

    def energy(t):
        d, v = flights.at(t)
        return 0.5 * (np.sum(v**2, axis=0) + np.sum(d * (stiffness @ d), axis=0))

    return Exact(["node_1/U1", "node_2/U1"], lambda t: flights.at(t)[0], None, energy)


def solve_ball(given, _):
    """A ball dropped on a plane; displacements count from its first height."""
    h, g, e = given["HEIGHT"], given["GRAVITY"], given["E"]
    return Exact(["node_1/U2"], lambda t: bouncing_ball(t, h, g, e)[0][None, :] - h)


def solve_masses(given, _):
    """Two free masses that meet."""
    masses, speeds = [given["M1"], given["M2"]], [given["V1"], given["V2"]]
    return free_masses(given, masses, [given["CLEARANCE"]], speeds)


def solve_cradle(given, _):
    """Four free masses in a row; without clearance all meet at once, which is another problem."""
    if given["GAP"] <= 0.0:
        return None
    return free_masses(given, [1.0] * 4, [0.5, given["GAP"], given["GAP"]], [given["SPEED"], 0, 0, 0])


def free_masses(given, masses, gaps, speeds):
    """Masses that move along a line and hit their neighbours."""
    flights, impulses = masses_in_line(given["END"], masses, gaps, speeds, given["E"])
    columns = [f"node_{i + 1}/U1" for i in range(len(masses))]
    masses = np.asarray(masses)[:, None]
    return Exact(
        columns, lambda t: flights.at(t)[0], sums(flights.impact_times, impulses),
        lambda t: np.sum(0.5 * masses * flights.at(t)[1] ** 2, axis=0),
    )


def solve_bar(_given, deck):
    """The bar of input/bar against a wall."""
    return flying_bar(deck, 10.0, 30.0, 1.0, 10.0, 5.0)


def solve_elastic_strip(given, deck):
    """The bar as a strip of plane elements, 1 high; without Poisson's ratio the same."""
    return None if given.get("NU", 0.0) else flying_bar(deck, 10.0, 30.0, 1.0, 10.0, 5.0)


def solve_strip(_given, deck):
    """The strip of input/strip, its sides held: a bar with the modulus of uniaxial strain."""
    young, nu = 4.0, 0.3
    wave = math.sqrt(young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)))
    return flying_bar(deck, 1.0, wave, 0.05, 0.01, 1e-4)


def flying_bar(deck, length, wave, area, speed, gap):
    """A bar of density 1 that flies against a wall at its left end, which stands at x = 0."""
    begin = gap / speed
    places = printed_places(deck)
    x = np.array(list(places.values()))[:, None] if places else None
    lasting, force = 2.0 * length / wave, area * wave * speed

    def motion(t):
        stop = begin + x / wave
        go = begin + (2.0 * length - x) / wave
        return -speed * (np.minimum(t, stop) - np.maximum(0.0, t - go))

    return Exact(
        list(places), motion if places else None, plateau(begin, lasting, force),
        lambda t: np.full(np.shape(t), 0.5 * area * length * speed**2),
        ("force", "impulse", "energy"),
    )


def solve_two_bars(given, deck):
    """Two strips of E = 900, density 1, height 1, half a unit apart; which, its velocities say."""
    if given.get("NU", 0.0):
        return None
    short = "RIGHT,1,0" in signature(deck)
    lengths, speeds = ((5.0, 10.0), (10.0, 0.0)) if short else ((10.0, 10.0), (5.0, -5.0))
    force, lasting, *_ = bars_head_on(*lengths, *speeds)
    begin = 0.5 / (speeds[0] - speeds[1])
    energy = 0.5 * sum(size * v**2 for size, v in zip(lengths, speeds))
    return Exact(
        [], None, plateau(begin, lasting, force), lambda t: np.full(np.shape(t), energy),
        ("force", "impulse", "energy"),
    )


def sums(times, parts):
    """The sum of all parts up to a time."""
    total = np.concatenate(([0.0], np.cumsum(parts)))
    return lambda t: total[np.searchsorted(times, t, side="right")]


def plateau(begin, lasting, force):
    """The impulse of a force that is constant for a while."""
    return lambda t: force * np.clip(np.asarray(t, dtype=float) - begin, 0.0, lasting)


def printed_places(deck):
    """x of the printed nodes, by the column of their displacement U1."""
    wanted = set()
    for name in {card.get("NSET", "") for card in deck.cards("NODE PRINT")} - {""}:
        for card in deck.cards("NSET"):
            if folded(card.get("NSET", "")) == folded(name) and not card.has("GENERATE"):
                wanted.update(word.strip() for line in card.data for word in line.split(","))
    places = {}
    for card in deck.cards("NODE"):
        for line in card.data:
            words = [word.strip() for word in line.split(",")]
            if words[0] in wanted:
                places[f"node_{words[0]}/U1"] = float(words[1])
    return places


CASES = {
    "sdof": solve_sdof, "two_dof": solve_two_dof, "ball": solve_ball, "masses": solve_masses,
    "cradle": solve_cradle, "bar": solve_bar, "elastic_strip": solve_elastic_strip,
    "strip": solve_strip, "two_bars": solve_two_bars,
}
DECKS = {
    "sdof/sdof.inp": "sdof", "two_dof/two_dof.inp": "two_dof", "ball/ball.inp": "ball",
    "colliding_masses/colliding_masses.inp": "masses", "cradle/cradle.inp": "cradle",
    "bar/bar_implicit.inp": "bar", "bar/bar_mixed.inp": "bar", "strip/implicit.inp": "strip",
    "strip/explicit.inp": "strip", "ball/ball_fictitious.inp": "ball",
    **{f"elastic_strip/{name}.inp": "elastic_strip"
       for name in ("q4", "q8", "q4_massless", "q8_massless", "q4_fictitious")},
    "two_bars/equal.inp": "two_bars", "two_bars/short_on_long.inp": "two_bars",
}
