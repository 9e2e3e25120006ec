"""The figures of the source from runs of carom, and what its text says of each: for report.py.

Every figure is a `Figure`: what it shows, the runs that it needs, and a function that makes of them
a picture and verdicts. The source is the thesis on elastodynamic impact that the methods
FICTITIOUS FORCE and TRANSFORMATION come from; its claims are told in our words.
"""

from dataclasses import dataclass

import numpy as np
from carom_plots import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, mark_events, plt
from exact_solutions import oscillator, two_dof
from report_runs import Case
from report_verdicts import (
    ALIKE, at_least, at_most, convergent, energy_change, fitted_order, judge, largest,
    mean_difference, shown,
)

END = 20.0
STEPS = (0.04, 0.008, 0.001)
MORE_STEPS = (0.04, 0.02, 0.008, 0.005, 0.0025, 0.00125, 0.001, 0.000625)
RESTITUTIONS = (0.0, 0.3, 0.6, 1.0)
LINES = [(ORANGE, "-", 4.0), (BLUE, "--", 2.4), (RED, ":", 2.2), (GREEN, "-.", 1.6)]
PERIODS = 4.0 * np.pi       # two periods of the free oscillator

# What the source prints of its exact solution with e = 0.6: the phases of the first four impacts in
# degrees, and the speeds after them
PHASES = np.array([120.0, 387.8, 683.8, 1002.8])
SPEEDS = np.array([0.5196, 0.3118, 0.1871, 0.1122])
# ... and of the two masses after their first impact: cos and sin of 0.618 s, cos and sin of 1.618 s
PRINTED = np.array([[-0.26838, 0.66978, 0.10637, -0.25735], [-0.43427, 1.08379, -0.06574, 0.15904]])
EXACT_TWO = np.array([[-0.26840389, 0.66973945, 0.10632649, -0.25737053],
                      [-0.43428662, 1.0836612, -0.06571338, 0.15906373]])


@dataclass
class Figure:
    """A figure of the source beside ours."""

    number: str
    title: str
    parameters: str
    cases: list
    draw: object        # function (figure, runs): picture, verdicts
    note: str = ""


def sdof(dt, e, end=END, **impact):
    """The oscillator with the transformation."""
    name = f"sdof_e{e:g}_dt{dt:g}" + "".join(f"_{v}" for v in impact.values()).replace("/", "_")
    changes = {"IMPACT": impact} if impact else None
    return Case(name, "input/sdof/sdof.inp", changes, dt=dt, e=e, end=end)


def fictitious(dt, e, alpha=0.3, end=END):
    """The oscillator with the fictitious force; e = None: its pure iteration."""
    deck = "input/sdof/sdof_fictitious.inp"
    if e is None:
        return Case(f"pure_a{alpha:g}_dt{dt:g}", deck, {"IMPACT": {"RESTITUTION": None}},
                    dt=dt, alpha=alpha, end=end)
    return Case(f"fictitious_e{e:g}_a{alpha:g}_dt{dt:g}", deck, dt=dt, e=e, alpha=alpha, end=end)


def axes_with(quantity, wide=9.0, high=4.6):
    """A picture with one pair of axes over time."""
    picture, axes = plt.subplots(figsize=(wide, high), layout="constrained")
    axes.set(xlabel="time", ylabel=quantity)
    axes.margins(x=0.01)
    return picture, axes


def panels_with(quantity):
    """A picture with the curves above and their differences to the exact one below."""
    picture, (above, below) = plt.subplots(
        2, 1, sharex=True, figsize=(9, 6.4), height_ratios=(2, 1), layout="constrained"
    )
    above.set_ylabel(quantity)
    below.set(xlabel="time", ylabel="size of the\ndifference", yscale="log")
    below.margins(x=0.01)
    return picture, above, below


def legend(axes, columns=4):
    """The legend above the axes, clear of the curves."""
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=columns, frameon=False)


def motion(run, exact, kind):
    """Time, values of the run, and exact ones: kind U, V or A of node 1."""
    time, values = run["history/time"], run[f"history/node_1/{kind}1"]
    d, v = exact.at(time)
    return time, values, {"U": d, "V": v, "A": -d}[kind]


QUANTITIES = {"U": "displacement", "V": "velocity", "A": "acceleration"}


def draw_motion(axes, runs, cases, exact, kind, below=None):
    """The exact curve and those of the runs, their differences below; returns of each the largest
    difference and the mean one."""
    fine = np.linspace(0.0, END, 4001)
    d, v = exact.at(fine)
    axes.plot(fine, {"U": d, "V": v, "A": -d}[kind], color=BLACK, lw=1.0, label="exact", zorder=5)
    worst, mean = [], []
    for (colour, style, width), (name, case) in zip(LINES, cases.items()):
        time, values, right = motion(runs[case], exact, kind)
        axes.plot(time, values, style, color=colour, lw=width, label=name)
        if below is not None:
            below.plot(time, np.maximum(np.abs(values - right), 1e-12), color=colour, lw=1.2)
        worst.append(largest(values - right))
        mean.append(mean_difference(time, values, right))
    return worst, mean


def agreement(claim, kind, worst, mean, height, where=""):
    """Curves agree if the eye cannot part them; those with jumps are compared in the mean. worst and
    mean: the differences of each curve."""
    parts = np.array(mean if kind == "V" else worst) / height
    name = "mean" if kind == "V" else "largest"
    said = ", ".join(shown(part) for part in parts)
    return judge(claim, parts, max(parts) <= ALIKE,
                 f"{name} difference over the height of the curve{where}: {said}",
                 f"at most {ALIKE:g}")


def draw_fictitious(figure, runs, kind):
    """Figures 3.3 and 3.4: one run beside the exact solution and what the source prints of it."""
    exact = oscillator(END, restitution=0.6)
    picture, axes, below = panels_with(QUANTITIES[kind])
    case = figure.cases[0]
    draw_motion(axes, runs, {"carom, fictitious force": case}, exact, kind, below)
    time, values, right = motion(runs[case], exact, kind)
    marks, printed = printed_flights(kind)
    axes.plot(marks, printed, "o", color=BLACK, mfc="none", ms=6, label="printed by the source")
    axes.axvline(PERIODS, color="0.5", lw=1, ls="--", label="two periods")
    legend(axes)
    height = right.max() - right.min()
    early = time <= PERIODS
    first = agreement("good agreement over the first two periods", kind,
                      [largest((values - right)[early])],
                      [mean_difference(time[early], values[early], right[early])], height)
    if kind == "V":
        return picture, [first]
    late = largest((values - right)[~early]) / largest((values - right)[early])
    degrees = np.degrees(exact.impact_times[:4])
    rates = 0.6 ** np.arange(1, 5) * np.sqrt(0.75)
    return picture, [
        first,
        at_least("the distortion is larger later", late, 1.0,
                 "largest displacement error after two periods over that before"),
        at_most("the printed phases of the impacts are exact", largest(degrees - PHASES), 0.2,
                "largest difference in degrees (the last printed digit is 0.1)"),
        at_most("the printed speeds after the impacts are exact", largest(rates - SPEEDS), 1e-4,
                "largest difference (the last printed digit is 1e-4)"),
    ]


def printed_flights(kind):
    """Points of the motion with e = 0.6 by the formulas that the source prints."""
    starts = np.concatenate(([0.0], np.radians(PHASES), [END]))
    times, values = [], []
    for k in range(5):
        t = np.arange(starts[k] + 0.1, starts[k + 1] - 0.05, 0.4)
        d, v = (1.0, 0.0) if k == 0 else (-0.5, SPEEDS[k - 1])
        s = t - starts[k]
        times.append(t)
        c, sn = np.cos(s), np.sin(s)
        values.append(v * c - d * sn if kind == "V" else (d * c + v * sn) * (-1) ** (kind == "A"))
    return np.concatenate(times), np.concatenate(values)


def draw_restitutions(figure, runs):
    """Figure 3.5: the response for several coefficients of restitution."""
    picture, axes = axes_with("displacement")
    after, growth = [], []
    for (colour, style, width), e, case in zip(LINES, RESTITUTIONS, figure.cases):
        exact = oscillator(END, restitution=e)
        time, values, right = motion(runs[case], exact, "U")
        axes.plot(time, values, style, color=colour, lw=width, label=f"e = {e:g}")
        axes.plot(time, right, color=BLACK, lw=0.8, label="exact" if e == 1 else None, zorder=5)
        after.append(values[time > exact.impact_times[0]].max())
        late = largest((values - right)[time > PERIODS])
        growth.append(late / largest((values - right)[time <= PERIODS]))
    legend(axes, 5)
    sizes = ", ".join(f"{size:.3f}" for size in after)
    return picture, [
        judge("the more is given back, the larger the motion after the first impact", after,
              np.all(np.diff(after) > 0.0), f"largest displacement after it: {sizes}",
              "rising with e"),
        judge("the distortion is larger later, for each e", growth, min(growth) >= 1.0,
              "largest error after two periods over that before, e = 0 to 1: "
              + ", ".join(shown(value) for value in growth), "at least 1"),
    ]


def draw_energies(figure, runs):
    """Figure 3.6: the total energy for several coefficients of restitution."""
    picture, axes = axes_with("total energy")
    lost, off = [], []
    for (colour, style, width), e, case in zip(LINES, RESTITUTIONS, figure.cases):
        run, exact = runs[case], oscillator(END, restitution=e)
        axes.plot(run["energy/time"], run["energy/total"], style, color=colour, lw=width,
                  label=f"e = {e:g}")
        d, v = exact.at([END])
        lost.append(-energy_change(run)[-1])
        off.append(abs(lost[-1] - (1.0 - float(d[0] ** 2 + v[0] ** 2))))
    axes.set_ylim(0, 0.56)
    legend(axes)
    said = ", ".join(f"{part:.2%}" for part in lost)
    return picture, [
        judge("least is lost with e = 1, most with e = 0", lost, np.all(np.diff(lost) < 0.0),
              f"lost at the end, e = 0 to 1: {said}", "falling with e"),
        at_most("with e = 1 the energy stays", abs(lost[-1]), ALIKE, "part of the energy lost"),
        at_most("what is lost is what the restitution takes", max(off), ALIKE,
                "largest difference to the exact loss, part of the first energy").own(),
    ]


def draw_convergence(figure, runs):
    """Figure 3.7: the response for three steps, with restitution and as the pure iteration, and the
    errors of more steps."""
    picture, panels = plt.subplots(3, 1, figsize=(9, 10.5), layout="constrained")
    verdicts, count = [], len(MORE_STEPS)
    for k, (name, e) in enumerate((("with restitution 0.6", 0.6), ("pure iteration", 1.0))):
        cases = dict(zip(MORE_STEPS, figure.cases[k * count:]))
        exact = oscillator(END, restitution=e)
        draw_motion(panels[k], runs, {f"step {step:g}": cases[step] for step in STEPS}, exact, "U")
        panels[k].set(xlabel="time", ylabel=f"displacement,\n{name}")
        panels[k].margins(x=0.01)
        errors = [largest(np.subtract(*motion(runs[case], exact, "U")[1:]))
                  for case in cases.values()]
        panels[2].loglog(MORE_STEPS, errors, "os"[k] + "-", color=(BLUE, RED)[k], label=name)
        verdicts.append(convergent(
            f"the response tends to the exact one as the step goes to zero, {name}, α = 0.3",
            MORE_STEPS, errors))
    panels[2].set(xlabel="step", ylabel="largest error")
    panels[2].legend()
    legend(panels[0])
    return picture, verdicts


def draw_steps(figure, runs, kind, e):
    """Figures 5.1 to 5.3 and 5.6 to 5.8: three steps beside the exact solution."""
    exact = oscillator(END, restitution=e)
    picture, axes, below = panels_with(QUANTITIES[kind])
    named = {f"step {step:g}": case for step, case in zip(STEPS, figure.cases)}
    worst, mean = draw_motion(axes, runs, named, exact, kind, below)
    if e == 0.6:
        axes.plot(*printed_flights(kind), "o", color=BLACK, mfc="none", ms=6, label="printed")
    legend(axes, 5)
    right = motion(runs[figure.cases[0]], exact, kind)[2]
    height = right.max() - right.min()
    verdicts = [agreement(f"agreement with the exact {QUANTITIES[kind]} with all three steps", kind,
                          worst, mean, height, ", steps 0.04, 0.008, 0.001")]
    if kind == "U":
        order = fitted_order(STEPS, worst)
        verdicts.append(at_least("accurate to fourth order", order, 3.8,
                                 "order fitted to the displacement errors "
                                 + ", ".join(shown(w) for w in worst)))
    return picture, verdicts


def draw_energy_error(figure, runs):
    """Figure 5.4: relative error of the total energy for three steps."""
    picture, axes = axes_with("relative change of the total energy")
    errors = []
    for (colour, style, width), step, case in zip(LINES, STEPS, figure.cases):
        change = energy_change(runs[case])
        axes.plot(runs[case]["energy/time"], change, style, color=colour, lw=width,
                  label=f"step {step:g}")
        errors.append(largest(change))
    axes.set_yscale("symlog", linthresh=1e-11)
    legend(axes)
    return picture, [
        at_most("the error of the energy is close to zero", max(errors), 1e-4, "largest change"),
        at_most("the transformation conserves the energy always, its eigenvalues having modulus 1",
                max(errors), 1e-12, "largest change"),
        at_least("it oscillates most with the smallest step", errors[-1] / errors[0], 1.0,
                 "largest change with step 0.001 over that with 0.04"),
    ]


def draw_two_energies(figure, runs):
    """Figure 5.5: the energy with beta = 1/6 and with 1/4 at the impacts."""
    names = ("transformation, β = 1/6", "transformation, β = 1/4", "fictitious force with e = 1",
             "fictitious force, pure")
    picture, panels = plt.subplots(2, 1, figsize=(9, 7.4), sharex=True, layout="constrained")
    changes, errors = [], []
    for (colour, style, width), name, case in zip(LINES, names, figure.cases):
        run = runs[case]
        _, values, right = motion(run, oscillator(END), "U")
        errors.append(largest(values - right))
        changes.append(energy_change(run))
        for axes in panels if "trans" in name else panels[1:]:
            axes.plot(run["energy/time"], changes[-1], style, color=colour, lw=width, label=name)
    for axes in panels:
        axes.set_ylabel("relative change\nof the total energy")
        axes.margins(x=0.01)
    picture.legend(*panels[1].get_legend_handles_labels(), loc="outside upper center", ncol=2,
                   frameon=False)
    panels[0].ticklabel_format(axis="y", scilimits=(0, 0))
    panels[1].set_xlabel("time")
    sixth, quarter, restored, pure = changes
    return picture, [
        judge("with β = 1/4 at the impacts energy is lost at each", quarter,
              largest(quarter) > 1e-12 and np.all(np.diff(quarter) < 1e-12),
              f"largest change {largest(quarter):.2g}", "falling, by more than 1e-12"),
        at_most("β = 1/6 loses less than β = 1/4", largest(sixth), largest(quarter),
                "largest change with β = 1/6"),
        at_most("β = 1/6 at the impacts is more accurate than 1/4", errors[0] / errors[1], 1.0,
                f"displacement errors {errors[0]:.4g} and {errors[1]:.4g}, their ratio"),
        at_most("β = 1/6 loses less than the fictitious force with β = 1/4 (the other reading)",
                largest(sixth), min(abs(restored[-1]), abs(pure[-1])), "largest change with β = 1/6"),
        judge("the fictitious force loses energy at each impact (the other reading)", pure,
              pure[-1] < -1e-12 and restored[-1] < -1e-12,
              f"change at the end: {restored[-1]:+.2g} with e = 1, {pure[-1]:+.2g} pure", "below 0"),
    ]


def draw_two_dof(figure, runs, node):
    """Figures 5.10 and 5.11: the displacement of one of the two masses."""
    run, exact = runs[figure.cases[0]], two_dof(30.0)
    time, values = run["history/time"], run[f"history/node_{node}/U1"]
    right = exact.at(time)[0][node - 1]
    picture, axes = axes_with("displacement")
    axes.plot(time, values, color=ORANGE, lw=4, label="carom, step 0.001")
    axes.plot(time, right, color=BLACK, lw=1.0, label="exact")
    first, second = exact.impact_times[:2]
    marks = np.arange(first + 0.1, second, 0.5)
    angles = np.outer((0.618, 1.618), marks - first)
    terms = np.array([np.cos(angles[0]), np.sin(angles[0]), np.cos(angles[1]), np.sin(angles[1])])
    axes.plot(marks, PRINTED[node - 1] @ terms, "o", color=BLACK, mfc="none", ms=6,
              label="printed by the source")
    before = np.linspace(0.0, first, 400)
    start = 0.72359 * np.cos(0.618 * before) + 0.27643 * np.cos(1.618 * before)
    axes.plot(before[::20], start[::20], "s", color=PURPLE, mfc="none", ms=6,
              label="printed, before the impact")
    legend(axes)
    off = largest(start - exact.at(before)[0][node - 1])
    return picture, [
        at_most("very good agreement", largest(values - right) / np.ptp(right), ALIKE,
                "largest difference over the height of the curve"),
        at_most("the printed motion after the first impact is exact",
                largest(PRINTED[node - 1] - EXACT_TWO[node - 1]), 2e-4,
                "largest difference of a coefficient"),
        at_most("the printed motion before the first impact is exact", off, 1e-3,
                "largest difference of the displacement"),
    ]


def draw_two_dof_energy(figure, runs):
    """Figure 5.12: the total energy of the two masses."""
    picture, panels = plt.subplots(2, 1, figsize=(9, 6.6), sharex=True, layout="constrained")
    run = runs[figure.cases[0]]
    change = energy_change(run)
    for name, colour in (("kinetic", BLUE), ("strain", ORANGE), ("total", BLACK)):
        panels[0].plot(run["energy/time"], run[f"energy/{name}"], color=colour, label=name)
    panels[1].plot(run["energy/time"], change, color=BLACK)
    mark_events(panels[1], run.events(), 0.0, 30.0)
    panels[0].set_ylabel("energy")
    panels[1].set(ylabel="relative change\nof the total", xlabel="time")
    panels[1].ticklabel_format(axis="y", scilimits=(0, 0))
    panels[1].margins(x=0.01)
    legend(panels[0])
    return picture, [
        at_most("the balance of the energy does not change", largest(change), 1e-4, "largest change"),
        at_most("it is conserved", largest(change), 1e-12, "largest change"),
    ]
