"""Decks in which every number is marked: [r 1.5|2.5] is a real 1.5, and 2.5 must change the results.

The letters: r a real, i an integer, f a real parameter that may be a fraction, d a *PARAMETER's value.
Without a second value the number may not show in the results (a limit), or it is an id that others
name. Together the decks hold every number that a card or parameter takes.
"""

import re

MARK = re.compile(r"\[([rifd]) ([^|\]]+)(?:\|([^\]]+))?\]")

SPRINGS = """\
*PARAMETER
stiff = [d 100.|101.]
*NODE, NSET=ALL
[i 1], [r 0.125|0.25], [r 0.5|0.25], [r 0.25|0.375]
[i 2], 1.5, 0.75, 0.5
3, 0., 0.
4, 0., 1.
*ELEMENT, TYPE=SPRINGA, ELSET=K
[i 1], [i 1], [i 2]
*ELEMENT, TYPE=MASS, ELSET=M
2, 2
4, 4
*ELEMENT, TYPE=SPRING1, ELSET=N
3, 2
*ELEMENT, TYPE=DASHPOT2, ELSET=C
5, 2, 4
*ELEMENT, TYPE=SPRING2, ELSET=K2
6, 2, 4
*ELSET, ELSET=AGAIN
[i 5], C
*ELSET, ELSET=RANGE, GENERATE
[i 1], [i 5], [i 2]
*SPRING, ELSET=K
<stiff>
*SPRING, ELSET=K2
[i 1|2], [i 1|2]
[r 7.|8.]
*SPRING, ELSET=N, NONLINEAR
[i 1|2]
[r -3.|-4.], [r -0.03125|-0.0625]
[r 3.|4.], [r 0.03125|0.0625]
*DASHPOT, ELSET=C
[i 1|2], [i 1|2]
[r 0.5|0.25]
*MASS, ELSET=M
[r 2.|3.]
*NSET, NSET=RANGE, GENERATE
[i 1], [i 4], [i 3]
*NSET, NSET=LIST
[i 2], ALL
*AMPLITUDE, NAME=A
[r 0.], [r 0.5|0.25], [r 0.0625|0.125], [r 1.|2.]
*BOUNDARY
[i 1], [i 1], [i 3], [r 0.|0.5]
3, 1, 3
4, 3
*INITIAL CONDITIONS, TYPE=VELOCITY
[i 2], [i 1|2], [r 0.25|0.5]
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
[i 2], [i 1|2], [r 0.125|0.25]
*STEP, INC=[i 100]
*DYNAMIC, DIRECT, GAMMA=[f 0.5|0.625], BETA=[f 0.25|0.3125]
[r 0.015625|0.03125], [r 0.25|0.5]
*CLOAD, AMPLITUDE=A
[i 2], [i 2|3], [r 4.|5.]
*NODE PRINT, NSET=ALL, FREQUENCY=[i 2|3]
U, V
*NODE FILE, FREQUENCY=[i 1|2]
U
*ENERGY PRINT, FREQUENCY=[i 1|2], LIMIT=[f 0.75]
*OUTPUT, COMPRESS=[i 1]
*END STEP
*STEP
*DYNAMIC, DIRECT, ALPHA=[f -0.0625|-0.125], ORDER=[i 2]
0.015625, 0.125
*END STEP
"""

SOLID = """\
*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE=CPE4, ELSET=E
[i 1], [i 1], [i 2], [i 3], [i 4]
*MATERIAL, NAME=S
*ELASTIC
[r 1000.|1100.], [r 0.25|0.3]
*PLASTIC
[r 3.|2.5], [r 0.]
[r 30.|20.], [r 0.125|0.0625]
*DENSITY
[r 1.5|2.]
*SOLID SECTION, ELSET=E, MATERIAL=S, OFFSET=[f 0.]
[r 0.5|0.25]
*BOUNDARY
1, 1, 2
4, 1
*STEP
*STATIC
[r 0.25|0.5], [r 1.|2.], [r 0.0625], [r 0.5]
*DLOAD
[i 1], P2, [r -4.|-4.5]
E, BX, [r 0.5|1.]
E, GRAV, [r 0.5|1.], [r 0.5|1.], [r 1.|0.5], [r 0.|1.]
E, CENTRIF, [r 0.25|0.5], [r 0.5|1.], [r 0.25|0.5], [r 0.], [r 0.], [r 0.], [r 1.]
*EL PRINT, ELSET=E, FREQUENCY=[i 1|2]
S, PEEQ
*EL FILE, FREQUENCY=[i 1]
S
*END STEP
"""

RING = """\
*NODE, NSET=ALL
1, 1., 0.
2, 2., 0.
3, 2., 1.
4, 1., 1.
*ELEMENT, TYPE=CAX4, ELSET=E
1, 1, 2, 3, 4
*MATERIAL, NAME=S
*ELASTIC
1000.
*DENSITY
1.
*SOLID SECTION, ELSET=E, MATERIAL=S
[r 0.5]
*BOUNDARY
1, 2
2, 2
*STEP
*FREQUENCY
[i 1|2]
*END STEP
"""

IMPACT = """\
*NODE, NSET=ALL
1, 0.5, 0.
2, 1.5, 0.
3, 0., 0.
*ELEMENT, TYPE=MASS, ELSET=M
1, 1
2, 2
*ELEMENT, TYPE=SPRING1, ELSET=K
3, 1
4, 2
*ELEMENT, TYPE=GAPUNI, ELSET=G
5, 1, 2
*MASS, ELSET=M
1.
*SPRING, ELSET=K
1
1.
*SURFACE INTERACTION, NAME=I
*IMPACT, RESTITUTION=[f 0.5|0.75], BETA=[f 0.25|0.2], CAPTURE=[f 0.0625|3.], MAX EVENTS=[i 50]
*FRICTION
[r 0.]
*GAP, ELSET=G, INTERACTION=I
[r 0.25|0.125], [r 1.], [r 0.], [r 0.]
*AMPLITUDE, NAME=A, TIME=TOTAL TIME
0., 0., 1., 1.
*SURFACE, NAME=S, TYPE=NODE
[i 1]
*RIGID SURFACE, NAME=W, TYPE=PLANE, AMPLITUDE=A
[r 0.25|0.375], [r 0.], [r 0.]
[r 1.], [r 0.|0.5], [r 0.]
[r 1.|-1.], [r 0.], [r 0.], [r 0.125|0.25]
*CONTACT PAIR, INTERACTION=I, PASSES=[i 1]
S, W
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, -2.
*STEP
*DYNAMIC, DIRECT
0.0625, 2.
*NODE PRINT, NSET=ALL, FREQUENCY=2
U, V
*CONTACT PRINT, FREQUENCY=[i 1|2]
CF, CDIS
*CONTACT FILE, FREQUENCY=[i 1]
CF
*END STEP
"""

PENALTY = """\
*NODE, NSET=ALL
1, 0.5, 0.0625
*ELEMENT, TYPE=MASS, ELSET=M
1, 1
*ELEMENT, TYPE=SPRING1, ELSET=K
3, 1
*ELEMENT, TYPE=SPRING1, ELSET=L
4, 1
*MASS, ELSET=M
1.
*SPRING, ELSET=K
1
1.
*SPRING, ELSET=L
2
1.
*SURFACE INTERACTION, NAME=I
*IMPACT, METHOD=PENALTY, STIFFNESS=[f 100.|200.]
*FRICTION
[r 0.125|0.25]
*SURFACE, NAME=S, TYPE=NODE
1
*RIGID SURFACE, NAME=W, TYPE=CIRCLE
[r -1.|-1.125], [r 0.|0.125], [r 0.]
[r 1.|1.25]
*CONTACT PAIR, INTERACTION=I, ADJUST=[f 0.125|1.]
S, W
*AMPLITUDE, NAME=A
0., 1., 1., 2.
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, -1.
*STEP
*DYNAMIC, TOLERANCE=[f 0.0078125|0.0001]
[r 0.0625|0.03125], [r 1.|2.], [r 0.0001], [r 0.125]
*BASE MOTION, AMPLITUDE=A, DOF=[i 1|2]
[r 1.|2.]
*NODE PRINT, NSET=ALL
U, V
*END STEP
"""

TRUSSES = """\
*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 2., 0.
4, 0., 1.
5, 1., 1.
*ELEMENT, TYPE=T2D2, ELSET=T
1, 1, 2
2, 2, 3
3, 4, 5
*MATERIAL, NAME=S
*ELASTIC
100.
*DENSITY
1.
*DAMPING, ALPHA=[f 0.125|0.25], BETA=[f 0.0009765625|0.001953125]
*SOLID SECTION, ELSET=T, MATERIAL=S
[r 0.5|1.]
*BOUNDARY
1, 1, 2
2, 2
3, 2
4, 1, 2
5, 2
*EQUATION
[i 2]
[i 5], [i 1], [r 1.|2.], [i 2], [i 1], [r -1.|-2.]
*SURFACE INTERACTION, NAME=I
*IMPACT, METHOD=FICTITIOUS FORCE, RETURN=[f 0.25|0.5]
*SURFACE, NAME=S, TYPE=NODE
3
*RIGID SURFACE, NAME=W, TYPE=PLANE
2.0625, 0.
-1., 0.
*CONTACT PAIR, INTERACTION=I
S, W
*STEP
*DYNAMIC, DIRECT
0.0625, 0.5
*BOUNDARY, TYPE=VELOCITY
[i 2], 1, 1, [r 0.25|0.375]
*CLOAD
3, 1, 2.
*NODE PRINT, NSET=ALL
U, V
*END STEP
"""

DECKS = {"springs": SPRINGS, "solid": SOLID, "ring": RING, "impact": IMPACT, "penalty": PENALTY,
         "trusses": TRUSSES}


class Slot:
    """One number of a deck: its letter, its value, and another one or None."""

    def __init__(self, deck, index, mark, line):
        self.deck = deck
        self.index = index
        self.letter, self.value, self.other = mark
        self.line = line
        self.name = f"{deck}:{line} number {index} ({self.value})"


def slots():
    """All numbers of all decks."""
    found = []
    for deck, text in DECKS.items():
        for match in MARK.finditer(text):
            line = text.count("\n", 0, match.start()) + 1
            found.append(Slot(deck, len([s for s in found if s.deck == deck]), match.groups(), line))
    return found


def spelled(deck, form_of):
    """A deck with the text form_of(k) in the place of its number k."""
    count = -1

    def number(match):
        nonlocal count
        count += 1
        form = form_of(count)
        return match.group(2) if form is None else form
    return MARK.sub(number, DECKS[deck])


def deck_text(deck, slot=None, form=""):
    """A deck with its own numbers, or with another text in the place of one."""
    return spelled(deck, lambda k: form if slot is not None and k == slot.index else None)
