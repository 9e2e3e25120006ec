"""Claims of the source without a figure of their own, each put to runs of carom: for report.py."""

import numpy as np
from carom_plots import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, SKY, plt
from exact_solutions import oscillator
from report_figures import END, axes_with, fictitious, legend
from report_runs import Case
from report_verdicts import (
    ALIKE, at_least, at_most, convergent, energy_change, fitted_order, judge, largest, shown,
)

SDOF, FICTITIOUS = "input/sdof/sdof.inp", "input/sdof/sdof_fictitious.inp"
MARKERS = "osD^vP"
COLOURS = (BLUE, RED, ORANGE, GREEN, PURPLE, SKY)

# Steps of the schemes whose orders are fitted; the last ones are for the cost at a given error
ORDER_STEPS = {
    "transformation": (0.16, 0.08, 0.04, 0.02, 0.01, 0.0025, 0.00025, 0.00007),
    "fictitious force, pure": (0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125, 0.000625),
    "fictitious force, e = 1": (0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125, 0.0005, 0.00006),
    "ORDER=4": (0.32, 0.16, 0.08, 0.04, 0.02, 0.01, 0.005),
}
PAIRS = ((0.5, 0.25), (0.6, 0.3), (0.5, 1.0 / 6.0), (0.6, 0.3025), (0.5, 0.3))
RETURNS = (0.9, 0.3, 0.1, 0.02)
RETURN_STEPS = (0.01, 0.004, 0.001, 0.0004)
DELTA = 0.3         # part of the step that is left after the impact
MATRIX_STEPS = (0.8, 0.4, 0.2, 0.1)


def order_case(scheme, step):
    """A run of the oscillator, e = 1, to t = 20; with few rows where the step is small."""
    every = int(round(0.01 / step)) if step < 0.005 else None
    if scheme == "transformation":
        return Case(f"order_transformation_dt{step:g}", SDOF, every=every, dt=step, e=1, end=END)
    if scheme == "ORDER=4":
        changes = {"IMPACT": {"BETA": None}, "DYNAMIC": {"ORDER": 4}}
        return Case(f"order_4_dt{step:g}", SDOF, changes, every=every, dt=step, e=1, end=END)
    pure = {"IMPACT": {"RESTITUTION": None}} if scheme.endswith("pure") else None
    name = f"order_{'pure' if pure else 'restitution'}_dt{step:g}"
    return Case(name, FICTITIOUS, pure, every=every, dt=step, e=1, end=END)


def order_cases():
    """All runs for the orders."""
    return [order_case(scheme, step) for scheme, steps in ORDER_STEPS.items() for step in steps]


def displacement_error(run, restitution=1.0):
    """The largest displacement error of the oscillator over the recorded rows."""
    exact = oscillator(END, restitution=restitution)
    return largest(run["history/node_1/U1"] - exact.at(run["history/time"])[0])


def cost_at(errors, costs, wanted):
    """The cost at an error, between the two neighbouring runs; None outside of all runs."""
    errors, costs = np.log(errors), np.log(costs)
    order = np.argsort(errors)
    if not errors[order[0]] <= np.log(wanted) <= errors[order[-1]]:
        return None
    return float(np.exp(np.interp(np.log(wanted), errors[order], costs[order])))


def draw_orders(figure, runs):
    """Error against step and against the number of solves, all schemes."""
    picture, panels = plt.subplots(1, 2, figsize=(11, 5.4), sharey=True, layout="constrained")
    errors, costs = {}, {}
    for (scheme, steps), colour, marker in zip(ORDER_STEPS.items(), COLOURS, MARKERS):
        found = [runs[order_case(scheme, step)] for step in steps]
        errors[scheme] = [displacement_error(run) for run in found]
        costs[scheme] = [run.costs["solves"] for run in found]
        for axes, x in zip(panels, (steps, costs[scheme])):
            axes.loglog(x, errors[scheme], marker + "-", color=colour, label=scheme)
    panels[0].set(xlabel="step", ylabel="largest displacement error to t = 20")
    panels[1].set_xlabel("solves")
    picture.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncol=4,
                   frameon=False)
    return picture, order_verdicts(errors, costs)


def order_verdicts(errors, costs):
    """What follows for the orders and costs."""
    steps = {scheme: np.array(values) for scheme, values in ORDER_STEPS.items()}
    order = {s: fitted_order(steps[s], errors[s]) for s in steps}
    fourth = [e > 1e-10 for e in errors["ORDER=4"]]
    best = fitted_order(steps["ORDER=4"][fourth], np.array(errors["ORDER=4"])[fourth])
    slow, fast = (cost_at(errors[s], costs[s], 1e-3)
                  for s in ("fictitious force, e = 1", "transformation"))
    second, gauss = (cost_at(errors[s], costs[s], 1e-8) for s in ("transformation", "ORDER=4"))
    series = {s: (steps[s], errors[s]) for s in steps}
    fit = "order fitted to the displacement errors"
    return [
        at_least("the transformation is of fourth order", order["transformation"], 3.8, fit),
        at_least("it is of second order", order["transformation"], 1.95, fit).own(),
        convergent("the fictitious force converges with the step, pure, α = 0.3",
                   *series["fictitious force, pure"]),
        convergent("the fictitious force converges with restitution 1, α = 0.3",
                   *series["fictitious force, e = 1"], order=0.9),
        at_least("ORDER=4, carom's own scheme, is of fourth order", best, 3.8,
                 fit + " down to 1e-10; least error " + shown(min(errors["ORDER=4"]))).own(),
        ratio("the transformation costs less at error 1e-3 than the fictitious force", slow, fast, 50),
        ratio("ORDER=4 costs less at error 1e-8 than second order", second, gauss, 30),
    ]


def ratio(claim, dear, cheap, limit):
    """A claim about a ratio of costs, None where no run has that error."""
    value = dear / cheap if dear and cheap else None
    return at_least(f"{claim} by {limit} times", value, limit, "ratio of solves").own()


def newmark(h, beta=1.0 / 6.0):
    """One step of the oscillator, omega = 1, gamma = 1/2: only to place the wall where the program
    is at the instant of the impact."""
    r = 1.0 + beta * h * h
    q = 1.0 - h * h / (2.0 * r)
    return np.array([[q, h / r], [-h * (1.0 - h * h / (4.0 * r)), q]])


def matrix_case(step, column):
    """One step with an impact at (1 - delta) h, from displacement 1 or from velocity -1."""
    first = np.array([[1.0, 0.0], [0.0, -1.0]])[column]
    wall = (newmark((1.0 - DELTA) * step) @ first)[0]
    lines = {"RIGIDSURFACE": f"{float(wall)!r}, 0, 0"}
    changes = {}
    if column == 1:
        changes = {"INITIALCONDITIONS": {"TYPE": "VELOCITY"}}
        lines["INITIALCONDITIONS"] = "1, 1, -1"
    return Case(f"matrix_{'dv'[column]}_h{step:g}", SDOF, changes, lines, dt=step, end=step, e=1)


def matrix_cases():
    """The runs that measure the transformation."""
    return [matrix_case(step, column) for step in MATRIX_STEPS for column in (0, 1)]


def draw_matrix(figure, runs):
    """The transformation matrix, from single steps of the program, less the exact one."""
    errors, moduli = [], []
    for h in MATRIX_STEPS:
        columns = []
        for column in (0, 1):
            run = runs[matrix_case(h, column)]
            state = np.array([run["history/node_1/U1"][-1], run["history/node_1/V1"][-1]])
            columns.append(state if column == 0 else -state)
        measured, angle = np.array(columns).T, (1.0 - 2.0 * DELTA) * h
        exact = np.array([[np.cos(angle), np.sin(angle)], [np.sin(angle), -np.cos(angle)]])
        scale = np.array([[1.0, h], [h, 1.0]])
        errors.append((np.abs(measured - exact) / scale).ravel())
        moduli.append(largest(np.abs(np.linalg.eigvals(measured)) - 1.0))
    errors = np.array(errors)
    picture, axes = plt.subplots(figsize=(8, 5.2), layout="constrained")
    names = ("B11", "B12", "B21", "B22")
    orders = [fitted_order(MATRIX_STEPS, errors[:, k]) for k in range(4)]
    for k, name in enumerate(names):
        axes.loglog(MATRIX_STEPS, errors[:, k], MARKERS[k] + "-", color=COLOURS[k],
                    label=f"{name}, order {orders[k]:.2f}")
    axes.set(xlabel="ω h", ylabel="difference to the exact entry,\nrelative to 1, h, ω²h, 1")
    axes.legend()
    verdicts = [at_least(f"{name} agrees through the third power of ω h", order, 3.8,
                         "order of the difference") for name, order in zip(names, orders)]
    verdicts.append(at_most("its eigenvalues have modulus 1, and so the energy is conserved",
                            max(moduli), 1e-12, "largest difference from 1"))
    return picture, verdicts


def pair_case(gamma, beta, step, alpha=0.3):
    """The pure fictitious force with other parameters of Newmark, over fifteen impacts."""
    changes = {"IMPACT": {"RESTITUTION": None}, "DYNAMIC": {"GAMMA": gamma, "BETA": beta}}
    return Case(f"pair_g{gamma:g}_b{beta:.4g}_dt{step:g}", FICTITIOUS, changes, dt=step, end=60,
                alpha=alpha)


def pair_cases():
    """The runs for the condition gamma = 2 beta."""
    cases = [pair_case(gamma, beta, 0.01) for gamma, beta in PAIRS]
    return cases + [pair_case(0.5, 0.25, step) for step in (0.004, 0.001)]


def draw_pairs(figure, runs):
    """Energy of the pure fictitious force over time for several gamma and beta."""
    picture, axes = axes_with("total energy over that at the start")
    kept, broken = [], []
    for (gamma, beta), colour, style in zip(PAIRS, COLOURS, ("-", "-.", "--", ":", "-")):
        run = runs[pair_case(gamma, beta, 0.01)]
        equal = abs(gamma - 2.0 * beta) < 1e-12
        time, change = free_energy(run)
        axes.plot(time, 1.0 + change, style, color=colour, lw=2.2,
                  label=f"γ = {gamma:g}, β = {beta:.4g}" + (" (γ = 2β)" if equal else ""))
        (kept if equal else broken).append(largest(change))
    fine = [largest(free_energy(runs[pair_case(0.5, 0.25, step)])[1]) for step in (0.004, 0.001)]
    axes.set_ylim(0, None)
    legend(axes, 2)
    return picture, [
        at_most("γ = 2β conserves the energy", max(kept[0], *fine), ALIKE,
                "γ = 1/2, β = 1/4: largest change, steps 0.01, 0.004, 0.001: "
                + ", ".join(shown(v) for v in (kept[0], *fine)) + "; the largest"),
        at_most("and so in the limit of small steps", fine[-1], ALIKE,
                "largest change with step 0.001"),
        judge("γ = 2β is necessary", broken, min(broken) > ALIKE,
              "least change of the pairs with γ ≠ 2β: " + shown(min(broken)), f"above {ALIKE:g}"),
    ]


def free_energy(run):
    """The times when nothing touches, and the change of the energy there."""
    free = run["history/contact_BODY-WALL/CNUM"] == 0
    return run["energy/time"][free], energy_change(run)[free]


def return_case(alpha, step, pure):
    """A run for one return parameter and step."""
    return fictitious(step, None if pure else 1.0, alpha)


def return_cases():
    """The runs for small steps and return parameters."""
    return [return_case(alpha, step, pure) for alpha in RETURNS for step in RETURN_STEPS
            for pure in (True, False)]


def draw_returns(figure, runs):
    """Error of the fictitious force for several return parameters and steps."""
    picture, panels = plt.subplots(1, 2, figsize=(10, 5), sharey=True, layout="constrained")
    errors = {}
    for axes, pure in zip(panels, (True, False)):
        for alpha, colour, marker in zip(RETURNS, COLOURS, MARKERS):
            errors[pure, alpha] = [displacement_error(runs[return_case(alpha, step, pure)])
                                   for step in RETURN_STEPS]
            axes.loglog(RETURN_STEPS, errors[pure, alpha], marker + "-", color=colour,
                        label=f"α = {alpha:g}")
        axes.axhline(1.5 * ALIKE, color=BLACK, lw=1, ls="--")
        axes.set(xlabel="step", title="pure iteration" if pure else "with restitution 1")
    panels[0].set_ylabel("largest displacement error to t = 20")
    panels[0].legend()
    verdicts = []
    for pure, name in ((True, "pure iteration"), (False, "with restitution")):
        last = {alpha: errors[pure, alpha][-1] for alpha in RETURNS}
        least, most = last[RETURNS[-1]], last[RETURNS[0]]
        step = f"step {RETURN_STEPS[-1]:g}"
        verdicts.append(at_most(f"accurate with small steps and return parameters, {name}",
                                min(least, last[0.1]), 1.5 * ALIKE,
                                f"error at {step}, the better of α = 0.1, 0.02"))
        verdicts.append(at_most(f"a small return parameter makes it more accurate, {name}",
                                least / most, 1.0,
                                f"error with α = 0.02 over that with 0.9, {step}"))
    return picture, verdicts


def free_case(gamma, beta):
    """The oscillator without impacts: the wall is far away."""
    changes = {"DYNAMIC": {"GAMMA": gamma, "BETA": beta}}
    return Case(f"free_g{gamma:g}_b{beta:.4g}", SDOF, changes, {"RIGIDSURFACE": "-9, 0, 0"},
                dt=0.1, end=60, e=1)


FREE = ((0.5, 0.25), (0.5, 1.0 / 6.0), (0.5, 1.0 / 12.0), (0.6, 0.3025), (0.5, 0.5))


def draw_free(figure, runs):
    """Energy without impacts for several gamma and beta."""
    picture, axes = axes_with("relative change of the total energy")
    changes = []
    for (gamma, beta), colour, style in zip(FREE, COLOURS, ("-", "--", ":", "-.", "--")):
        run = runs[free_case(gamma, beta)]
        changes.append(largest(energy_change(run)))
        axes.plot(run["energy/time"], energy_change(run), style, color=colour,
                  label=f"γ = {gamma:g}, β = {beta:.4g}")
    axes.set_yscale("symlog", linthresh=1e-4)
    legend(axes, 3)
    return picture, [
        at_most("the average acceleration conserves the energy", changes[0], 1e-12,
                "largest change"),
        at_least("no other pair tried conserves it", min(changes[1:]), 1e-6,
                 "least change of the others"),
    ]
