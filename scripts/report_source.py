"""The list of the source's figures and claims, with the functions that put them to runs."""

from functools import partial

import report_claims as claims
import report_figures as figures
from report_figures import MORE_STEPS, RESTITUTIONS, STEPS, Figure, fictitious, sdof
from report_runs import Case

OSCILLATOR = "m = k = 1, from rest at 1, wall at −0.5"
STEPS_TEXT = "steps 0.04, 0.008, 0.001"
SHOWN = {"U": "displacement", "V": "velocity", "A": "acceleration"}


def chapter_three():
    """The fictitious force."""
    base = f"{OSCILLATOR}; fictitious force, α = 0.3, γ = 1/2, β = 1/4"
    one = [fictitious(0.001, 0.6)]
    several = [fictitious(0.001, e) for e in RESTITUTIONS]
    note = ("The source says of no coefficient but 0, 0.6 and 1 that it was used; "
            "0.3 is ours. Thin lines: exact.")
    steps = [fictitious(step, e) for e in (0.6, None) for step in MORE_STEPS]
    return [
        Figure("3.3", "Response", f"{base}; step 0.001, e = 0.6", one,
               partial(figures.draw_fictitious, kind="U")),
        Figure("3.4", "Velocity", f"{base}; step 0.001, e = 0.6", one,
               partial(figures.draw_fictitious, kind="V")),
        Figure("3.5", "Response for several restitutions", f"{base}; step 0.001", several,
               figures.draw_restitutions, note),
        Figure("3.6", "Total energy for several restitutions", f"{base}; step 0.001", several,
               figures.draw_energies, note),
        Figure("3.7", "Response for several steps", f"{base}; {STEPS_TEXT}", steps,
               figures.draw_convergence,
               "The steps are those of chapter 5; the text gives none for this figure. How the source "
               "brings in e is not stated: carom ends the contact by the velocity jump. The pure "
               "iteration has no such jump and stands for e = 1."),
    ]


def chapter_five():
    """The transformation."""
    listed = []
    for first, e in ((1, 1.0), (6, 0.6)):
        cases = [sdof(step, e) for step in STEPS]
        parameters = f"{OSCILLATOR}; transformation, β = 1/6 at impacts; e = {e:g}; {STEPS_TEXT}"
        for k, kind in enumerate("UVA"):
            title = f"{SHOWN[kind].capitalize()}, e = {e:g}"
            listed.append(Figure(f"5.{first + k}", title, parameters, cases,
                                 partial(figures.draw_steps, kind=kind, e=e)))
        if e == 1.0:
            listed.append(Figure("5.4", "Error of the total energy", parameters, cases,
                                 figures.draw_energy_error))
            listed.append(two_energies())
    two = [Case("two_dof_dt0.001", "input/two_dof/two_dof.inp", dt=0.001, end=30, e=1)]
    parameters = "M = I, K = [2 −1; −1 1], both from rest at 1, wall for mass 2 at −0.5; step 0.001"
    for node in (1, 2):
        listed.append(Figure(f"5.{9 + node}", f"Two masses: displacement of mass {node}", parameters,
                             two, partial(figures.draw_two_dof, node=node)))
    listed.append(Figure("5.12", "Two masses: energy", parameters, two, figures.draw_two_dof_energy))
    return listed


def two_energies():
    """Figure 5.5; what its second algorithm is can be read in two ways."""
    pure = fictitious(0.04, None)
    return Figure(
        "5.5", "Energy with β = 1/6 and 1/4", f"{OSCILLATOR}; e = 1, step 0.04",
        [sdof(0.04, 1.0), sdof(0.04, 1.0, BETA="1/4"), fictitious(0.04, 1.0), pure],
        figures.draw_two_energies,
        "The source compares with Newmark's method with β = 1/4. That may be the transformation with "
        "this β or the fictitious force: both are here.",
    )


def without_figures():
    """Claims that the source makes in words alone."""
    return [
        Figure("4.2.3", "Order of accuracy", f"{OSCILLATOR}; e = 1, to t = 20", claims.order_cases(),
               claims.draw_orders),
        Figure("4.2.3 b", "The transformation matrix",
               "oscillator with ω = 1, one step with an impact at 0.7 of it, β = 1/6",
               claims.matrix_cases(), claims.draw_matrix),
        Figure("3.2.2", "Energy of the fictitious force and γ = 2β",
               f"{OSCILLATOR}; pure iteration, α = 0.3, step 0.01, to t = 60", claims.pair_cases(),
               claims.draw_pairs, "Drawn and measured at times without contact."),
        Figure("6.1", "The fictitious force with small steps and return parameters",
               f"{OSCILLATOR}; e = 1", claims.return_cases(), claims.draw_returns),
        Figure("abstract", "Energy without impacts", "oscillator with ω = 1, step 0.1, no wall",
               [claims.free_case(*pair) for pair in claims.FREE], claims.draw_free),
    ]


def all_figures():
    """Every figure of the source, then the claims without one."""
    chapters = chapter_five()
    chapters.sort(key=lambda figure: int(figure.number.split(".")[1]))
    return [*chapter_three(), *chapters, *without_figures()]
