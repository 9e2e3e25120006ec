"""The grid of tradeoff.py: which runs of a deck are to be compared, and the deck of each."""

import hashlib
import itertools
import math
from dataclasses import dataclass, field

from carom_deck import Deck, number_text, parse_number
from carom_script import ScriptError, folded

METHODS = ["TRANSFORMATION", "FICTITIOUS FORCE", "PENALTY", "LAGRANGE"]

# What may vary beside dt and TOLERANCE: option: (keyword, parameter, methods that know it, help)
AXES = {
    "method": ("IMPACT", "METHOD", METHODS, "of *IMPACT"),
    "restitution": ("IMPACT", "RESTITUTION", METHODS[:2], "of *IMPACT; `none` leaves it out"),
    "return": ("IMPACT", "RETURN", METHODS[1:2], "of *IMPACT, fictitious force only"),
    "solution": ("IMPACT", "SOLUTION", METHODS[1:2], "of *IMPACT, fictitious force only"),
    "impact-beta": ("IMPACT", "BETA", METHODS[:1], "BETA of *IMPACT, transformation only"),
    "events": ("IMPACT", "EVENTS", METHODS[:1], "of *IMPACT, transformation only"),
    "max-events": ("IMPACT", "MAX EVENTS", METHODS[:2], "of *IMPACT"),
    "stiffness": ("IMPACT", "STIFFNESS", METHODS[2:3], "of *IMPACT, penalty only"),
    "mass": ("CONTACT PAIR", "MASS", METHODS, "of *CONTACT PAIR: REDISTRIBUTED or none"),
    "scheme": ("ELEMENT GROUP", "SCHEME", METHODS, "of all elements: IMPLICIT, EXPLICIT, AUTO"),
    "order": ("DYNAMIC", "ORDER", METHODS[:1], "of *DYNAMIC: 2 or 4, transformation only"),
    "beta": ("DYNAMIC", "BETA", METHODS, "Newmark's, of *DYNAMIC"),
    "gamma": ("DYNAMIC", "GAMMA", METHODS, "Newmark's, of *DYNAMIC"),
    "alpha": ("DYNAMIC", "ALPHA", METHODS, "of *DYNAMIC: damping of high frequencies"),
    "solver": ("DYNAMIC", "SOLVER", METHODS, "of *DYNAMIC: AUTO, SKYLINE, MUMPS"),
}
# What a scheme of fourth order does without
NOT_WITH_ORDER_4 = ("beta", "gamma", "alpha", "impact-beta", "events")
MOST_POINTS = 100000


@dataclass
class Point:
    """One run: the problem it solves (defined parameters), how, and with which step."""

    problem: dict = field(default_factory=dict)
    settings: dict = field(default_factory=dict)
    dt: float = None
    tolerance: str = None
    ratio: int = None           # the coarsest step over this one, where all steps have common times
    key: str = ""

    @property
    def series(self):
        """The settings in words: points of one series differ in the step only."""
        words = [show_setting(name, value) for name, value in self.settings.items()]
        if self.tolerance is not None:
            words.append("TOLERANCE")
        return ", ".join(words) or "as in the deck"

    @property
    def problem_text(self):
        """The problem in words."""
        return ", ".join(f"{name} = {value}" for name, value in self.problem.items())

    @property
    def step_text(self):
        """The step in words."""
        return f"dt = {self.dt:.4g}" if self.tolerance is None else f"TOLERANCE={self.tolerance}"


def show_setting(name, value):
    """A setting as in the deck: IMPACT BETA=1/6."""
    keyword, parameter = AXES.get(name, ("", name))[:2]
    prefix = "impact " if name == "impact-beta" else ""
    return f"no {parameter}" if value == "none" else f"{prefix}{parameter}={value}"


def parse_steps(text, option="--dt"):
    """`0.1:0.001:8`, eight values in equal ratios, or `0.1,0.05`: numbers, and whether a range."""
    parts = text.split(":")
    if len(parts) == 3 and parts[2].strip().isdigit():
        first, last, n = parse_number(parts[0]), parse_number(parts[1]), int(parts[2])
        if first and last and min(first, last) > 0.0 and n >= 2:
            first, last = max(first, last), min(first, last)
            return [first * (last / first) ** (i / (n - 1)) for i in range(n)], True
    elif len(parts) == 1:
        numbers = [parse_number(word) for word in text.split(",")]
        if all(number is not None and 0.0 < number < math.inf for number in numbers):
            return sorted(set(numbers), reverse=True), False
    raise ScriptError(
        f"{option} {text}: write first:last:count (count 2 or more) or numbers with commas, all > 0"
    )


def parse_values(text, option):
    """The values of an axis, each once; methods by their first letters."""
    values = [" ".join(word.split()) for word in text.split(",")]
    if not all(values):
        raise ScriptError(f"--{option} {text}: an empty value between commas")
    if option == "method":
        values = [method_called(word) for word in values]
    return list(dict.fromkeys(as_written(value) for value in values))


def as_written(value):
    """A value as decks have it: words in capitals, numbers and names of parameters as they are."""
    if value.lower() == "none":
        return "none"
    return value if "<" in value or parse_number(value) is not None else value.upper()


def method_called(word):
    """The method that begins so."""
    found = [m for m in METHODS if folded(m).startswith(folded(word))]
    if len(found) != 1:
        raise ScriptError(f"--method {word}: no such method; there are: {', '.join(METHODS)}")
    return found[0]


def parse_definitions(items, option="--define"):
    """`e=1,0.6` to {"e": ["1", "0.6"]}."""
    chosen = {}
    for item in items:
        name, _, text = item.partition("=")
        values = [word.strip() for word in text.split(",")]
        if not name.strip() or any(parse_number(value) is None for value in values):
            raise ScriptError(f"{option} {item}: write NAME=NUMBER or NAME=NUMBER,NUMBER,…")
        chosen[name.strip()] = list(dict.fromkeys(values))
    return chosen


def common_steps(steps, end):
    """Steps near the given ones that divide each other's times: the coarsest over small products of
    2, 3 and 5, and itself a part of the whole time. Pairs of ratio and step."""
    coarsest = steps[0] if not end else end / max(1, math.ceil(end / steps[0] - 1e-9))
    smooth = sorted(2**i * 3**j * 5**k for i in range(31) for j in range(16) for k in range(11))
    ratios = [min(smooth, key=lambda m: abs(math.log(m * step / coarsest))) for step in steps]
    return [(m, coarsest / m) for m in dict.fromkeys(ratios)]


def default_axes(deck, accepts):
    """What varies if nothing is asked for: methods and orders that the deck leaves open. `accepts` says
    of settings whether the program takes the deck with them."""
    axes = {}
    if deck.has("IMPACT"):
        axes["method"] = METHODS[:2]
        if deck.get("IMPACT", "RESTITUTION") is None:
            axes["method"] = [*METHODS[:2], METHODS[3]]
        axes["method"] = [m for m in axes["method"] if accepts({"method": m})] or [own_method(deck)]
    if accepts({**({"method": METHODS[0]} if axes else {}), "order": "4"}):
        axes["order"] = ["2", "4"]
    return axes


def default_steps(deck, defined, quick):
    """The deck's own step, four times and an eighth (quick: a quarter) of it, in ratios of 2."""
    dt, _ = deck.time_step(defined)
    if dt is None:
        raise ScriptError(f"'{deck.path}' has no *DYNAMIC step with a step size")
    return [dt * 2.0**i for i in range(2, -3 if quick else -4, -1)]


def make_grid(deck, axes, problems, steps, tolerances, quick=False):
    """All points: for each problem every combination of settings and steps that means something.

    axes: {option: values}; problems: {name: values}; steps: (numbers, is_range) or None.
    """
    check_axes(deck, axes)
    known = deck.definitions()
    for name in problems:
        if folded(name) not in known:
            raise ScriptError(f"--define {name}: '{deck.path}' has no such *PARAMETER; it has: "
                              + (", ".join(known) or "none"))
    count = math.prod(len(v) for v in (*axes.values(), *problems.values()))
    if count > MOST_POINTS:
        raise ScriptError(f"this grid has {count} points a step: at most {MOST_POINTS}")
    points = {}
    for values in itertools.product(*problems.values()):
        problem = dict(zip(problems, values))
        for chosen in itertools.product(*axes.values()):
            settings = meaningful(deck, dict(zip(axes, chosen)))
            for point in stepped(deck, problem, settings, steps, tolerances, quick):
                points.setdefault(repr(point), point)
    return list(points.values())


def stepped(deck, problem, settings, steps, tolerances, quick):
    """The points of one series of a problem."""
    dt, end = deck.time_step(problem)
    if steps is None and not tolerances:
        steps = (default_steps(deck, problem, quick), True)
    found = []
    if steps:
        numbers, is_range = steps
        pairs = common_steps(numbers, end) if is_range else [(None, step) for step in numbers]
        found = [Point(problem, settings, step, None, ratio) for ratio, step in pairs]
    return found + [Point(problem, settings, dt, text) for text in tolerances]


def check_axes(deck, axes):
    """Axes need the card that they change."""
    for name in axes:
        keyword = AXES[name][0]
        if not (deck.has(keyword) or (name == "scheme" and deck.has("SOLID SECTION"))):
            raise ScriptError(f"--{name}: '{deck.path}' has no card *{keyword}")
    if "PENALTY" in axes.get("method", ()) and not (
        "stiffness" in axes or deck.get("IMPACT", "STIFFNESS")
    ):
        raise ScriptError("--method PENALTY needs --stiffness k (force on an overlap of one)")


def meaningful(deck, settings):
    """The settings that the method and the order know; others belong to other combinations."""
    method = settings.get("method") or own_method(deck)
    kept = {n: v for n, v in settings.items() if method in AXES[n][2]}
    if kept.get("order") == "4":
        kept = {n: v for n, v in kept.items() if n not in NOT_WITH_ORDER_4}
    if kept.get("events") == "ANCHOR":
        kept.pop("impact-beta", None)
    return kept


def own_method(deck):
    """METHOD of the deck."""
    own = deck.get("IMPACT", "METHOD") or METHODS[0]
    same = [method for method in METHODS if folded(method) == folded(own)]
    return (same or METHODS)[0]


def edited_deck(path, point, own_requests=False):
    """The deck of a point: no fields, every increment in the tables; or its own requests."""
    deck = Deck.read(path)
    set_method(deck, point.settings)
    for name, value in point.settings.items():
        keyword, parameter = AXES[name][:2]
        if name == "scheme":
            set_scheme(deck, value)
        elif name != "method":
            left_out = value == "none" or (name, value) == ("order", "2")
            deck.set(keyword, **{parameter.replace(" ", "_"): None if left_out else value})
    if point.settings.get("order") == "4":
        deck.set("DYNAMIC", BETA=None, GAMMA=None, ALPHA=None)
        for card in deck.cards("IMPACT"):
            card.set("EVENTS", None)
    if point.tolerance is None:
        deck.set_time_step(point.dt)
    else:
        deck.set("DYNAMIC", TOLERANCE=point.tolerance, DIRECT=None)
        for card in deck.cards("STEP"):
            card.set("INC", None)
    if not own_requests:
        complete_requests(deck)
    return deck


def set_method(deck, settings):
    """METHOD, without those of the deck's own parameters that it does not know."""
    for card in deck.cards("IMPACT"):
        if "method" in settings:
            card.set("METHOD", settings["method"])
        method = folded(card.get("METHOD") or METHODS[0])
        for keyword, parameter, methods, _ in AXES.values():
            if keyword == "IMPACT" and method not in map(folded, methods):
                card.set(parameter, None)
        if method not in map(folded, METHODS[:2]):
            card.set("CAPTURE", None)
        if settings.get("events") == "ANCHOR" or settings.get("order") == "4":
            card.set("BETA", None)


def set_scheme(deck, scheme):
    """SCHEME of all elements; all explicit also makes the step explicit."""
    if not deck.has("ELEMENT GROUP"):
        sets = [card.get("ELSET") for card in deck.cards("SOLID SECTION")]
        for name in dict.fromkeys(sets):
            deck.add_before_first("STEP", f"*ELEMENT GROUP, ELSET={name}, SCHEME=IMPLICIT")
    deck.set("ELEMENT GROUP", SCHEME=scheme)
    if scheme == "EXPLICIT":
        deck.set("ELEMENT GROUP", MASS="LUMPED")
        deck.set("DYNAMIC", EXPLICIT=True, BETA=None)
    else:
        deck.set("DYNAMIC", EXPLICIT=None)


def complete_requests(deck):
    """Tables of every increment of displacements, velocities, contact and energy; no fields."""
    deck.thin_output(frames=0)
    for keyword in ("NODE PRINT", "CONTACT PRINT", "ENERGY PRINT"):
        for card in deck.cards(keyword):
            card.set("FREQUENCY", None)
    if not deck.has("NODE PRINT"):
        deck.add_before("END STEP", "*NODE PRINT", "U, V")
    if not deck.has("ENERGY PRINT"):
        deck.add_before("END STEP", "*ENERGY PRINT")
    if not deck.has("CONTACT PRINT") and (deck.has("CONTACT PAIR") or deck.has("GAP")):
        deck.add_before("END STEP", "*CONTACT PRINT", "CF")


def content_key(deck, point, program, extra=""):
    """A name for a run made of all that decides its outcome."""
    digest = hashlib.sha256(program.encode())
    for card in deck:
        digest.update("\n".join(card.text_lines()).encode("utf-8", "surrogateescape") + b"\n")
    for name, value in sorted(point.problem.items()):
        digest.update(f"{name}={number_text(value)}\n".encode())
    digest.update(extra.encode())
    return digest.hexdigest()[:16]
