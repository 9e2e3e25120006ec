"""Decks that show how carom's own steps amplify motion, and how they are run. All have h = 1."""

import subprocess
import tempfile
from contextlib import contextmanager, nullcontext
from pathlib import Path

import numpy as np

from carom_deck import number_text, run_deck
from carom_results import Result
from carom_script import ScriptError


class Outcome:
    """A run that has ended: its status, columns by path."""

    def __init__(self, status, columns):
        self.status, self.columns = status, columns

    def __getitem__(self, name):
        return self.columns[name]


@contextmanager
def deck_file(text):
    """A file with a deck in a folder of its own, for a while."""
    with tempfile.TemporaryDirectory(prefix="carom_") as folder:
        deck = Path(folder, "deck.inp")
        deck.write_text(text)
        yield deck


def run_text(carom, text, columns=()):
    """Runs a deck given as text; one that stops with status 4 keeps its rows."""
    with deck_file(text) as deck:
        result = deck.with_suffix(".h5")
        done = run_deck(carom, deck, result)
        if done.status not in (0, 4):
            raise ScriptError(f"{carom} run ended with status {done.status}: {done.last_line}")
        values = {}
        with Result(result) if columns else nullcontext() as results:
            for path in columns:
                values[path] = results.array(path)
        return Outcome(done.status, values)


def is_refused(carom, text):
    """Whether `carom check` finds an error in a deck given as text."""
    with deck_file(text) as deck:
        done = subprocess.run([str(carom), "check", str(deck)], capture_output=True, check=False)
        if done.returncode not in (0, 2):
            raise ScriptError(f"{carom} check ended with status {done.returncode}")
        return done.returncode == 2


def number(value):
    """A number that the deck reads back exactly."""
    return number_text(float(value))


def initial(kind, rows):
    """*INITIAL CONDITIONS for nodes from 1 up, freedom 1."""
    return [f"*INITIAL CONDITIONS, TYPE={kind}",
            *(f"{i + 1}, 1, {number(value)}" for i, value in enumerate(rows))]


def dynamic(scheme, steps, size=1.0):
    """The step card with its data line."""
    words = ["*DYNAMIC, DIRECT", f"GAMMA={number(scheme.gamma)}"]
    if scheme.alpha:
        words.append(f"ALPHA={number(scheme.alpha)}")
    if scheme.explicit and scheme.beta == 0.0:
        words.append("EXPLICIT")
    else:
        words.append(f"BETA={number(scheme.beta)}")
    return [", ".join(words), f"{number(size)}, {number(steps * size)}"]


def text_of(*parts):
    """Lines and lists of lines as the text of a deck."""
    lines = []
    for part in parts:
        lines += [part] if isinstance(part, str) else list(part)
    return "\n".join(lines) + "\n"


def spring_cards(i, element, omega, table):
    """A spring from the ground to node i; as a table its largest stiffness is all that is known."""
    stiffness = omega**2
    law = [number(stiffness)]
    if table:
        far = 10.0 * (1.0 + stiffness) / omega   # no motion of a step or two leaves the table
        law = [f"{number(-far * stiffness)}, {number(-far)}", f"{number(far * stiffness)}, {number(far)}"]
    return [f"*ELEMENT, TYPE=SPRING1, ELSET=S{i}", f"{element}, {i}",
            f"*SPRING, ELSET=S{i}" + (", NONLINEAR" if table else ""), "1", *law]


def oscillators(scheme, omega, d, v, steps, table=False):
    """Independent oscillators, one a frequency: masses on springs, or for a damper of the material
    on trusses of length 1."""
    n = len(omega)
    lines = ["*NODE", *(f"{i + 1}, 1, 0" for i in range(n)), f"{n + 1}, 0, 0"]
    if scheme.damper == "dashpot":
        lines += ["*ELEMENT, TYPE=MASS, ELSET=MASSES", *(f"{i + 1}, {i + 1}" for i in range(n)),
                  "*MASS, ELSET=MASSES", "1"]
        for i, w in enumerate(omega):
            lines += spring_cards(i + 1, n + i + 1, w, table)
            if scheme.xi:
                lines += [f"*ELEMENT, TYPE=DASHPOT1, ELSET=D{i + 1}", f"{2 * n + i + 1}, {i + 1}",
                          f"*DASHPOT, ELSET=D{i + 1}", "1", number(2.0 * scheme.xi * w)]
        members = [f"S{i + 1}" for i in range(n)]
    else:
        for i, w in enumerate(omega):
            rate = (f"ALPHA={number(2.0 * scheme.xi * w)}" if scheme.damper == "mass"
                    else f"BETA={number(2.0 * scheme.xi / w)}")
            lines += [f"*ELEMENT, TYPE=T2D2, ELSET=S{i + 1}", f"{i + 1}, {n + 1}, {i + 1}",
                      f"*MATERIAL, NAME=M{i + 1}", "*ELASTIC", number(w**2), "*DENSITY", "2",
                      f"*DAMPING, {rate}", f"*SOLID SECTION, ELSET=S{i + 1}, MATERIAL=M{i + 1}", "1"]
        lines += ["*BOUNDARY", f"{n + 1}, 1"]
        members = [f"S{i + 1}" for i in range(n)]
    kind = "EXPLICIT" if scheme.explicit else "IMPLICIT"
    lines += ["*ELSET, ELSET=ALL", *members,
              f"*ELEMENT GROUP, ELSET=ALL, SCHEME={kind}, MASS=LUMPED"]
    return text_of(lines, initial("DISPLACEMENT", d), initial("VELOCITY", v), "*STEP",
                   dynamic(scheme, steps), "*NODE FILE", "U, V, A", "*END STEP")


def coupled_pairs(implicit, explicit, mass, start, steps, beta=0.25, inner_explicit=False):
    """Pairs of masses: a spring from the ground to the first (1) and one to the second, of mass
    `mass`; one implicit, one explicit. `start` is (pairs, 4): d1, d2, v1, v2."""
    n = len(implicit)
    lines = ["*NODE", *(f"{i + 1}, 0, 0" for i in range(2 * n)),
             "*ELEMENT, TYPE=MASS, ELSET=FIRST", *(f"{2 * i + 1}, {2 * i + 1}" for i in range(n)),
             "*MASS, ELSET=FIRST", "1"]
    for i in range(n):
        lines += [f"*ELEMENT, TYPE=MASS, ELSET=M{i}", f"{2 * i + 2}, {2 * i + 2}",
                  f"*MASS, ELSET=M{i}", number(mass[i])]
        outer, inner = (implicit[i], explicit[i]) if inner_explicit else (explicit[i], implicit[i])
        for name, nodes, stiffness in (("G", f"{2 * i + 1}", outer),
                                       ("B", f"{2 * i + 1}, {2 * i + 2}", inner)):
            kind = "SPRING1" if name == "G" else "SPRING2"
            element = (2 if name == "G" else 3) * 2 * n + i
            lines += [f"*ELEMENT, TYPE={kind}, ELSET={name}{i}", f"{element}, {nodes}",
                      f"*SPRING, ELSET={name}{i}", "1", number(stiffness)]
    for name, kind in (("G", "IMPLICIT" if inner_explicit else "EXPLICIT"),
                       ("B", "EXPLICIT" if inner_explicit else "IMPLICIT")):
        lines += [f"*ELSET, ELSET={name}ALL", *(f"{name}{i}" for i in range(n)),
                  f"*ELEMENT GROUP, ELSET={name}ALL, SCHEME={kind}, MASS=LUMPED"]
    d, v = start[:, :2].ravel(), start[:, 2:].ravel()
    return text_of(lines, initial("DISPLACEMENT", d), initial("VELOCITY", v), "*STEP",
                   f"*DYNAMIC, DIRECT, BETA={number(beta)}", f"1, {steps}",
                   "*NODE FILE", "U, V, A", "*END STEP")


def wall_cards(members, beta, place=0.0):
    """A rigid plane that faces along x, and nodes that rebound from it with e = 1, however
    often in a step: capture at MAX EVENTS would change the energy by itself."""
    return ["*SURFACE, NAME=BODY, TYPE=NODE", *members,
            "*RIGID SURFACE, NAME=WALL, TYPE=PLANE", f"{number(place)}, 0, 0", "1, 0, 0",
            "*SURFACE INTERACTION, NAME=HIT", f"*IMPACT, RESTITUTION=1, BETA={beta}, MAX EVENTS=10000",
            "*CONTACT PAIR, INTERACTION=HIT", "BODY, WALL"]


def impact_in_step(omega, start, place, beta):
    """Oscillators that all hit their walls in the one step: `start` (n, 2) is d and v, `place` the
    displacement at which the wall is."""
    n = len(omega)
    lines = ["*NODE", *(f"{i + 1}, {number(-place[i])}, 0" for i in range(n)),
             "*ELEMENT, TYPE=MASS, ELSET=MASSES", *(f"{i + 1}, {i + 1}" for i in range(n)),
             "*MASS, ELSET=MASSES", "1"]
    for i, w in enumerate(omega):
        lines += spring_cards(i + 1, n + i + 1, w, False)
    return text_of(lines, wall_cards([str(i + 1) for i in range(n)], beta),
                   initial("DISPLACEMENT", start[:, 0]), initial("VELOCITY", start[:, 1]), "*STEP",
                   "*DYNAMIC, DIRECT", "1, 1", "*NODE FILE", "U, V", "*END STEP")


def bouncing(omega, place, steps, beta="AUTO", own_beta=0.25):
    """One oscillator, from 1 at rest, at a wall: hit after hit."""
    lines = ["*NODE", "1, 0, 0", "*ELEMENT, TYPE=MASS, ELSET=MASSES", "1, 1",
             "*MASS, ELSET=MASSES", "1"]
    return text_of(lines, spring_cards(1, 2, omega, False), wall_cards(["1"], beta, place),
                   initial("DISPLACEMENT", [1.0]), "*STEP",
                   f"*DYNAMIC, DIRECT, BETA={number(own_beta)}", f"1, {steps}",
                   "*ENERGY PRINT", "*END STEP")


def bouncing_bar(courant, steps, beta="AUTO", alpha=0.0, n=20):
    """A bar of n elements, held at one end and stretched; its other end hits a wall at the place
    where it rests, with e = 1. One Courant step is 1/n."""
    size = courant / n
    lines = ["*NODE", *(f"{i + 1}, {number(i / n)}, 0" for i in range(n + 1)),
             "*ELEMENT, TYPE=T2D2, ELSET=BAR", *(f"{i + 1}, {i + 1}, {i + 2}" for i in range(n)),
             "*MATERIAL, NAME=M", "*ELASTIC", "1", "*DENSITY", "1",
             "*SOLID SECTION, ELSET=BAR, MATERIAL=M", "1",
             "*ELEMENT GROUP, ELSET=BAR, SCHEME=IMPLICIT, MASS=LUMPED", "*BOUNDARY", "1, 1"]
    stretch = 0.01 * np.arange(n + 1) / n
    return text_of(lines, wall_cards([str(n + 1)], beta, 1.0), initial("DISPLACEMENT", stretch),
                   "*STEP", "*DYNAMIC, DIRECT" + (f", ALPHA={number(alpha)}" if alpha else ""),
                   f"{number(size)}, {number(steps * size)}", "*ENERGY PRINT", "*END STEP")
