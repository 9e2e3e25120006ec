"""Changes that mostly leave a deck valid, so that they reach the model builder and the run."""
import numpy as np

from fuzz_deck import Deck, drop_parameter, parse_number, set_parameter, squeezed, time_lines
from spoil import pick, vary_number
from vocabulary import ELEMENT_TYPES, PARAMETERS, REQUESTED


def vary_parameter(rng, deck, _):
    """A parameter that a card knows takes a value that it knows, or goes."""
    places = [i for i in range(len(deck.cards)) if deck.keyword(i) in PARAMETERS]
    if not places:
        return False
    kinds = sorted({deck.keyword(i) for i in places})
    keyword = pick(rng, kinds)
    place = pick(rng, deck.places(keyword))
    name = pick(rng, sorted(PARAMETERS[keyword]))
    value = pick(rng, PARAMETERS[keyword][name])
    head = deck.cards[place][0]
    deck.cards[place][0] = (drop_parameter(head, name) if value == ""
                            else set_parameter(head, name, value))
    return True


def vary_impact(rng, deck, _):
    """Another method of impact with what it takes."""
    places = deck.places("IMPACT")
    if not places:
        return False
    deck.cards[pick(rng, places)][0] = "*IMPACT, METHOD=" + pick(rng, [
        "TRANSFORMATION", "TRANSFORMATION, RESTITUTION=0.5", "TRANSFORMATION, EVENTS=ANCHOR",
        "TRANSFORMATION, EVENTS=ANCHOR, RESTITUTION=1", "TRANSFORMATION, BETA=1/6, RESTITUTION=0",
        "TRANSFORMATION, CAPTURE=0", "TRANSFORMATION, RESTITUTION=1, MAX EVENTS=1",
        "FICTITIOUS FORCE", "FICTITIOUS FORCE, RESTITUTION=0.7", "FICTITIOUS FORCE, RETURN=0.9",
        "FICTITIOUS FORCE, SOLUTION=DIRECT", "PENALTY, STIFFNESS=100", "PENALTY, STIFFNESS=1e8",
        "LAGRANGE"])
    return True


def vary_procedure(rng, deck, _):
    """Another procedure card, the data line kept or not."""
    places = deck.places("STATIC", "DYNAMIC", "FREQUENCY")
    if not places:
        return False
    place = pick(rng, places)
    heads = ["*STATIC", "*STATIC, DIRECT", "*DYNAMIC, DIRECT", "*DYNAMIC, DIRECT, EXPLICIT",
             "*DYNAMIC, DIRECT, ORDER=4", "*DYNAMIC", "*DYNAMIC, TOLERANCE=1e-2", "*FREQUENCY",
             "*DYNAMIC, DIRECT, ALPHA=-0.3", "*DYNAMIC, DIRECT, BETA=1/12",
             "*DYNAMIC, DIRECT, GAMMA=0.6", "*DYNAMIC, DIRECT, SOLVER=MUMPS",
             "*STATIC, SOLVER=MUMPS"]
    deck.cards[place][0] = pick(rng, heads)
    if deck.keyword(place) == "FREQUENCY":
        deck.cards[place][1:] = [pick(rng, ["1", "3", "1000", "100000000"])]
    elif rng.random() < 0.1:
        del deck.cards[place][1:]
    return True


def vary_times(rng, deck, _):
    """Another dt and T, with limits or without."""
    found = [item for item in time_lines(deck) if item[2] and item[3]]
    if not found:
        return False
    place, line, dt, length = pick(rng, found)
    factor = pick(rng, [0.01, 0.1, 0.5, 0.9, 2, 10, 100, 1e4, 1e-6, 1e9])
    count = min(40.0, length/dt)*pick(rng, [1, 1, 0.3, 0.999, 1.001, 2])
    words = [f"{dt*factor:.9g}", f"{dt*factor*count:.9g}"]
    if rng.random() < 0.2:
        words += [f"{dt*factor*0.01:.9g}", f"{dt*factor*5:.9g}"]
    deck.cards[place][line] = ", ".join(words)
    return True


def vary_elements(rng, deck, _):
    """Another element type with as many nodes, of one card or all."""
    places = deck.places("ELEMENT")
    if not places:
        return False
    chosen = places if rng.random() < 0.6 else [pick(rng, places)]
    choice = rng.random(2)
    for place in chosen:
        for family in ELEMENT_TYPES:
            for name in family:
                if f"TYPE={name}," in squeezed(deck.cards[place][0]) + ",":
                    new = family[int(choice[0]*len(family))]
                    deck.cards[place][0] = set_parameter(deck.cards[place][0], "TYPE", new)
                    break
            else:
                continue
            break
    return True


def vary_material(rng, deck, _):
    """Other stiffness, density, Poisson's ratio; a yield stress, damping, or none."""
    places = deck.places("ELASTIC")
    if not places:
        return False
    place = pick(rng, places)
    kind = rng.integers(4)
    if kind == 0:
        words = (deck.cards[place] + [""])[1].split(",")
        young = (parse_number(words[0].strip()) or 1.0)*pick(rng, [1e-12, 1e-3, 0.1, 1, 10, 1e6])
        deck.cards[place][1:] = [f"{young:.6g}, " + pick(rng, [
            "0", "0.3", "0.4999999", "0.5", "-0.99", "-1", "0.49999999999999"])]
    elif kind == 1:
        deck.cards.insert(place + 1, ["*PLASTIC" + pick(rng, ["", ", HARDENING=KINEMATIC"]),
                                      *pick(rng, [["1e-6, 0"], ["1, 0"], ["100, 0", "110, 0.1"],
                                                  ["1, 0", "1, 1"], ["1e9, 0"]])])
    elif kind == 2:
        deck.cards.insert(place + 1, ["*DAMPING, " + pick(rng, [
            "BETA=1e-5", "ALPHA=10", "BETA=1", "ALPHA=1e9", "ALPHA=0, BETA=0"])])
    else:
        for density in deck.places("DENSITY"):
            deck.cards[density][1:] = [pick(rng, ["1", "1e-9", "1e9", "7800", "0", "1e-300"])]
    return True


def add_friction(rng, deck, _):
    """Friction of small and large coefficients."""
    places = deck.places("SURFACEINTERACTION")
    if not places:
        return False
    deck.cards.insert(pick(rng, places) + 1,
                      ["*FRICTION", pick(rng, ["0", "0.1", "0.5", "1", "10", "1e6"])])
    return True


def node_names(rng, deck):
    """Sets and ids of nodes that the deck has, a few of each."""
    names = deck.names("NODE", "NSET") + deck.names("NSET", "NSET")
    for place in deck.places("NODE"):
        lines = deck.data_lines(place)
        for line in [pick(rng, lines) for _ in range(3) if lines]:
            names.append(deck.cards[place][line].split(",")[0].strip())
    return names or ["1"]


def element_names(rng, deck):
    """Sets and ids of elements that the deck has, a few of each."""
    names = deck.names("ELEMENT", "ELSET") + deck.names("ELSET", "ELSET")
    for place in deck.places("ELEMENT"):
        lines = deck.data_lines(place)
        if lines:
            names.append(deck.cards[place][pick(rng, lines)].split(",")[0].strip())
    return names or ["1"]


def add_to_step(rng, deck, _):
    """A load, condition or request in one of the steps."""
    places = deck.places("ENDSTEP")
    if not places:
        return False
    node, element = pick(rng, node_names(rng, deck)), pick(rng, element_names(rng, deck))
    size = pick(rng, ["1", "-1", "1e-6", "1e6", "1e150", "0"])
    freedom = pick(rng, ["1", "2", "3", "1"])
    keyword = pick(rng, sorted(REQUESTED))
    amplitude = pick(rng, ["", "", *(f", AMPLITUDE={name}"
                                     for name in deck.names("AMPLITUDE", "NAME"))])
    card = pick(rng, [
        [f"*CLOAD{amplitude}", f"{node}, {freedom}, {size}"],
        [f"*DLOAD{amplitude}", f"{element}, {pick(rng, ['P1', 'P2', 'P3', 'P4', 'BX', 'BY'])}, {size}"],
        [f"*DLOAD{amplitude}", f", GRAV, {size}, 0, -1, 0"],
        [f"*DLOAD{amplitude}", f"{element}, CENTRIF, {size}, 0, 0, 0, 0, 0, 1"],
        [f"*BOUNDARY{amplitude}, TYPE={pick(rng, ['DISPLACEMENT', 'VELOCITY', 'ACCELERATION'])}",
         f"{node}, {freedom}, {freedom}, {size}"],
        ["*BOUNDARY, OP=NEW", f"{node}, 1, 2"],
        ["*INITIAL CONDITIONS, TYPE=VELOCITY", f"{node}, {freedom}, {size}"],
        [f"*BASE MOTION{amplitude}, DOF={freedom}", size],
        [f"*{keyword[:-5] if keyword.endswith('PRINT') else keyword[:-4]} "
         f"{'PRINT' if keyword.endswith('PRINT') else 'FILE'}",
         ", ".join(rng.permutation(REQUESTED[keyword])[:int(rng.integers(1, 5))])],
        ["*ENERGY PRINT"],
        ["*RESTART, WRITE, FREQUENCY=3"],
    ])
    deck.cards.insert(pick(rng, places), card)
    return True


def add_to_model(rng, deck, _):
    """A condition, constraint, set, group, amplitude or contact pair before the steps."""
    places = deck.places("STEP")
    if not places:
        return False
    nodes, elements = node_names(rng, deck), element_names(rng, deck)
    freedom = pick(rng, ["1", "2", "3"])
    size = pick(rng, ["1", "-1", "1e-6", "1000", "0", "1e100"])
    surfaces = deck.names("SURFACE", "NAME") or ["A"]
    masters = surfaces + deck.names("RIGIDSURFACE", "NAME")
    interaction = pick(rng, deck.names("SURFACEINTERACTION", "NAME") or ["I"])
    pair = ["*CONTACT PAIR, INTERACTION=" + interaction
            + pick(rng, ["", ", ADJUST", ", PASSES=2", ", SMALL SLIDING", ", MASS=REDISTRIBUTED",
                         ", TYPE=SURFACE TO SURFACE"]),
            f"{pick(rng, surfaces)}, {pick(rng, masters)}"]
    groups = (f"*ELEMENT GROUP, ELSET={pick(rng, elements)}, "
              f"SCHEME={pick(rng, ['IMPLICIT', 'EXPLICIT', 'AUTO'])}"
              f"{pick(rng, ['', ', MASS=LUMPED', ', MASS=CONSISTENT'])}")
    card = pick(rng, [
        pair,
        pair,
        [groups],
        ["*BOUNDARY", f"{pick(rng, nodes)}, 1, {pick(rng, ['1', '2', '3'])}"],
        ["*BOUNDARY", f"{pick(rng, nodes)}, {freedom}, {freedom}, {size}"],
        [f"*INITIAL CONDITIONS, TYPE={pick(rng, ['DISPLACEMENT', 'VELOCITY'])}",
         f"{pick(rng, nodes)}, {freedom}, {size}"],
        ["*EQUATION", "2", f"{pick(rng, nodes)}, {freedom}, {size}, {pick(rng, nodes)}, 1, -1"],
        ["*EQUATION", "3", f"{pick(rng, nodes)}, {freedom}, 1, {pick(rng, nodes)}, 1, -1, "
         f"{pick(rng, nodes)}, 2, {size}"],
        [f"*AMPLITUDE, NAME={pick(rng, ['AMP', 'AMP2'])}",
         pick(rng, ["0, 0, 1, 1", "0, 1, 1e-9, -1, 2, 1e9", "1, 1, 2, 2"])],
        ["*ELSET, ELSET=MORE", ", ".join(pick(rng, elements) for _ in range(3))],
        ["*NSET, NSET=MORE", ", ".join(pick(rng, nodes) for _ in range(3))],
        ["*NSET, NSET=ROW, GENERATE", pick(rng, ["1, 3", "1, 1000000000", "3, 1, -1", "1, 9, 0"])],
        ["*ELEMENT, TYPE=MASS, ELSET=EXTRA", f"9999999, {nodes[-1]}", "*MASS, ELSET=EXTRA", size],
    ])
    deck.cards.insert(places[0], card)
    deck.cards = Deck.from_text("", deck.text()).cards
    return True


def add_step(rng, deck, _):
    """One more step, a copy of one with other times or a short one of another kind."""
    ends = deck.places("ENDSTEP")
    if not ends:
        return False
    lines = pick(rng, [["*STATIC", "1, 1"], ["*STATIC, DIRECT", "0.5, 1"], ["*FREQUENCY", "2"],
                       ["*DYNAMIC, DIRECT", "1e-3, 5e-3"], ["*DYNAMIC", "1e-3, 5e-3"],
                       ["*DYNAMIC, DIRECT, ORDER=4", "1e-3, 5e-3"],
                       ["*DYNAMIC, DIRECT, EXPLICIT", "1e-6, 1e-5"]])
    step = Deck.from_text("", "\n".join(["*STEP", *lines, "*END STEP"])).cards
    starts = deck.places("STEP")
    if starts and rng.random() < 0.5:
        step = [list(card) for card in deck.cards[starts[-1]:ends[-1] + 1]]
    place = pick(rng, [ends[-1] + 1, starts[0] if starts else 0])
    deck.cards[place:place] = step
    return True


def renumber(rng, deck, _):
    """All nodes get other ids, huge or scattered; or the nodes come in another order."""
    places = deck.places("NODE")
    if not places:
        return False
    for place in places:
        lines = deck.data_lines(place)
        order = rng.permutation(len(lines))
        old = [deck.cards[place][line] for line in lines]
        for line, i in zip(lines, order):
            deck.cards[place][line] = old[i]
    return True


CHANGES = [
    (8, vary_parameter), (6, vary_impact), (6, vary_procedure), (5, vary_times),
    (4, vary_elements), (5, vary_material), (2, add_friction), (7, add_to_step),
    (7, add_to_model), (3, add_step), (1, renumber), (8, vary_number),
]
WEIGHTS = np.array([weight for weight, _ in CHANGES])/sum(weight for weight, _ in CHANGES)
