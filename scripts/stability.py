"""How far carom's own steps are stable: stability.py [--quick] [-o FOLDER] [--carom PROGRAM]

Runs carom on oscillators from omega h = 1e-6 to 1e6, one deck a scheme, and finds the amplification
matrix of its step from what comes out: Newmark's beta and gamma, HHT, damping, explicit elements,
both in one model, steps with impacts. Draws spectral radii over those of theory and writes

    stability.h5, limits.csv     all figures; measured limits beside theory
    steps.png                    spectral radius over frequency, round-off
    impact_step.png              growth over frequency and place of the impact; every k steps
    recurring.png                energy where impacts recur by themselves
    coupling.png                 implicit and explicit springs in one model

Ends with status 1 if a figure is not as theory has it.
"""

import argparse
import csv
import sys
from pathlib import Path

import h5py
import numpy as np

from carom_deck import find_carom
from carom_script import run
from stability_measures import (
    accepted_limit, measure_bar, measure_bouncing, measure_coupling, measure_floor,
    measure_impact_steps, measure_limits, measure_schemes, recurring,
)
from stability_pictures import draw_coupling, draw_impact_steps, draw_recurring, draw_steps
from stability_theory import radius

EVERY = (1, 2, 5, 10)
OWN = "1/4 in all steps (AUTO)"


class Report:
    """Counts what is not as theory has it, and writes what was measured."""

    def __init__(self, file):
        self.file, self.failed = file, 0

    def check(self, sentence, value, limit):
        """Prints a line; value must not be above the limit, NaN fails."""
        good = bool(value <= limit)
        self.failed += not good
        print(f"{'ok     ' if good else 'FAILED '} {sentence}: {value:.3g} <= {limit:.3g}")

    def store(self, path, values, description):
        self.file[path] = values
        self.file[path].attrs["description"] = description


def steps_part(carom, quick, folder, report):
    """Free steps of all schemes."""
    measured = measure_schemes(carom, 2 if quick else 8)
    for i, (scheme, omega, radii, theory) in enumerate(measured):
        group = f"steps/{i:02d}"
        report.store(f"{group}/omega", omega, "frequency times step")
        report.store(f"{group}/radius", radii, f"measured spectral radius of a step: {scheme.name}")
        report.store(f"{group}/theory", theory, "the same of the closed-form matrix")
        allowed = 2e-9 + np.where(omega > scheme.limit(), 1e-6 * omega, 0.0)
        if scheme.gamma > 0.5 and not scheme.alpha:
            # two equal roots at large omega h: they move by the square root of a round-off
            allowed += 5e-3 * (omega / 1e6)**0.5
        away = np.abs(omega / scheme.limit() - 1.0) > 1e-4
        error = np.abs(radii / theory - 1.0) / allowed
        report.check(f"{scheme.name}: spectral radius against theory, part of what round-off allows",
                     error[away].max(), 1.0)
    trapezoidal = measured[0]
    report.check("β = 1/4: |radius − 1| up to ωh = 1e6", np.abs(trapezoidal[2] - 1).max(), 1e-12)
    steps = 200 if quick else 2000
    omega, errors = measure_floor(carom, steps, 1 if quick else 4)
    report.store("floor/omega", omega, "frequency times step")
    report.check(f"β = 1/4: largest energy error in {steps} steps", errors.max(), 3e-12)
    report.store("floor/energy_error", errors, f"β = 1/4: largest energy error in {steps} steps")
    if not quick:
        draw_steps(measured, (omega, errors, steps), folder / "steps.png")


def limits_part(carom, folder, report):
    """Limits: theory, growth, refusal."""
    rows = measure_limits(carom)
    print(f"\n{'scheme':34s}{'theory':>11s}{'measured':>11s}{'refused':>11s}")
    with open(folder / "limits.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["scheme", "gamma", "beta", "alpha", "xi", "explicit", "theory",
                        "measured", "refused_from"])
        for scheme, limit, measured, refused in rows:
            print(f"{scheme.name:34s}{limit:11.5f}{measured:11.5f}{refused:11.5f}")
            table.writerow([scheme.name, scheme.gamma, scheme.beta, scheme.alpha, scheme.xi,
                            int(scheme.explicit), limit, measured, refused])
    print()
    for scheme, limit, measured, refused in rows:
        allowed = min(accepted_limit(scheme), limit) if scheme.explicit else limit
        off = [0.0 if a == b else abs(a / b - 1.0) for a, b in ((measured, limit), (refused, allowed))]
        report.check(f"{scheme.name}: measured limit against theory", off[0], 1e-3)
        report.check(f"{scheme.name}: what the program refuses against what it should", off[1], 1e-3)


def impact_part(carom, quick, folder, report):
    """One step with an impact, and the same every k steps."""
    omega = np.geomspace(0.03, 100.0, 15 if quick else 57)
    deltas = np.array([0.02, 0.25, 0.5, 0.8, 0.98]) if quick else np.concatenate(
        [[0.001], np.linspace(0.02, 0.98, 33), [0.999]])
    growth, matrices = {}, {}
    for beta in ("1/6", "AUTO"):
        found, theory = measure_impact_steps(carom, omega, deltas, beta)
        good = np.isfinite(found).all(axis=(2, 3))
        report.check(f"impact step, β = {beta}: part of (ωh, δ) where no state can hit",
                     1.0 - good.mean(), 0.5)
        size = np.abs(theory[good]).max(axis=(1, 2))
        # impacts are located to 1e-9 of the step
        late = np.broadcast_to(np.maximum(omega, 1.0)[:, None], good.shape)[good]
        report.check(f"impact step, β = {beta}: matrix against N(δh) J N((1−δ)h)",
                     (np.abs(found - theory)[good].max(axis=(1, 2)) / size / late).max(), 1e-6)
        growth[beta] = np.full(good.shape, np.nan)
        growth[beta][good] = radius(found[good])
        matrices[beta] = found
        report.store(f"impact_step/{beta.replace('/', '_')}", growth[beta],
                     f"spectral radius of a step with an impact, β = {beta}, over omega and delta")
    report.store("impact_step/omega", omega, "frequency times step")
    report.store("impact_step/delta", deltas, "part of the step after the impact")
    report.check("impact step, AUTO: |radius − 1|", np.nanmax(np.abs(growth["AUTO"] - 1)), 1e-11)
    small = ((omega > 0.15) & (omega < 0.5))[:, None] & np.isfinite(growth["1/6"])
    worst = np.nanmax(np.where(small, growth["1/6"] - 1, np.nan) / omega[:, None]**4)
    report.check("impact step, β = 1/6: (radius − 1) × 256 / (ωh)⁴ up to ωh = 0.5", 256 * worst, 1.03)
    every = {k: np.nanmax(recurring(omega, matrices["1/6"], k), axis=1) for k in EVERY}
    kept = np.nanmax([np.nanmax(np.abs(recurring(omega, matrices["AUTO"], k) - 1), axis=1)
                      for k in EVERY], axis=0)
    report.check("impact every 1, 2, 5, 10 steps, AUTO: |radius − 1|", kept.max(), 1e-11)
    for k, values in every.items():
        report.store(f"impact_step/every_{k}", values, f"β = 1/6 every {k} steps: growth a step")
    if not quick:
        shown = {"1/6": growth["1/6"], "1/4 (AUTO)": growth["AUTO"]}
        draw_impact_steps(omega, deltas, shown, (every, kept), folder / "impact_step.png")


def recurring_part(carom, quick, folder, report):
    """Impacts that recur by themselves."""
    # half a period in k steps: 2 atan(omega h / 2) k = pi
    natural = [2.0 * np.tan(0.5 * np.pi / k) for k in (10, 5, 2)]
    omega = np.array([0.3, 1.0, 3.4, 10.0]) if quick else np.sort(
        np.concatenate([np.geomspace(0.1, 10.0, 21), natural, [0.5, np.sqrt(12.0)]]))
    steps = 2000 if quick else 6000
    bouncing = {}
    for place, words in ((0.0, "wall at rest"), (-0.5, "wall at −0.5")):
        for beta in ("1/6", "AUTO"):
            name = f"{words}, {'β = 1/6 at impacts' if beta == '1/6' else OWN}"
            bouncing[name] = measure_bouncing(carom, omega, place, steps, beta)
            if beta == "AUTO":
                report.check(f"bouncing oscillator, {words}, AUTO: largest energy gain",
                             bouncing[name][:, 0].max() - 1, 1e-12)
    if not quick:
        name = "wall at rest, 1/12 in all steps (AUTO)"
        below = omega < 2.4
        rows = np.full((len(omega), 3), np.nan)
        rows[below] = measure_bouncing(carom, omega[below], 0.0, steps, "AUTO", 1 / 12)
        bouncing[name] = rows
    courant = np.array([0.5, 2.0, 10.0]) if quick else np.array([0.1, 0.25, 0.5, 1, 2, 4, 10])
    bars = {}
    for name, beta, alpha in (("β = 1/6 at impacts", "1/6", 0.0), (OWN, "AUTO", 0.0),
                              ("HHT α = -0.3, β = 1/4 at impacts", "1/4", -0.3),
                              ("HHT α = -0.3, AUTO", "AUTO", -0.3)):
        bars[name] = measure_bar(carom, courant, 300 if quick else 1000, beta, alpha)
        if beta == "AUTO":
            report.check(f"bar, {name}: largest energy gain", bars[name][:, 0].max() - 1,
                         1e-10 if alpha == 0.0 else 0.05)
    for i, (name, rows) in enumerate([*bouncing.items(), *bars.items()]):
        report.store(f"recurring/{i}", rows, f"largest energy, growth an impact, impacts: {name}")
    report.store("recurring/omega", omega, "frequency times step of the oscillators")
    report.store("recurring/courant", courant, "Courant numbers of the bars")
    if not quick:
        draw_recurring(omega, bouncing, courant, bars, folder / "recurring.png")


def coupling_part(carom, quick, folder, report):
    """An implicit and an explicit spring on two masses."""
    ratios = [1e-4, 1.0, 1e4] if quick else list(np.geomspace(1e-4, 1e4, 9))
    omega = [0.1, 1.0, 1.99] if quick else list(np.geomspace(0.1, 1.99, 14))
    radii = {name: measure_coupling(carom, ratios, omega, inner) for name, inner in (
        ("outer spring explicit, inner implicit", False), ("inner spring explicit, outer implicit", True))}
    for i, (name, values) in enumerate(radii.items()):
        report.store(f"coupling/{i}", values, f"spectral radius over mass ratio, stiffness ratio, "
                                              f"explicit frequency: {name}")
        report.check(f"two masses, {name}: radius − 1", values.max() - 1.0, 1e-6)
    report.store("coupling/ratio", ratios, "mass and stiffness ratios")
    report.store("coupling/omega", omega, "frequency of the explicit element times step")
    if not quick:
        draw_coupling(ratios, omega, radii, folder / "coupling.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few frequencies, no pictures")
    parser.add_argument("-o", "--output", default="stability", help="folder (default: stability)")
    parser.add_argument("--carom", help="the program (default: build/carom)")
    arguments = parser.parse_args()
    folder, carom = Path(arguments.output), find_carom(arguments.carom)
    folder.mkdir(parents=True, exist_ok=True)
    with h5py.File(folder / "stability.h5", "w") as file:
        report = Report(file)
        limits_part(carom, folder, report)
        for part in (steps_part, impact_part, recurring_part, coupling_part):
            part(carom, arguments.quick, folder, report)
    print(f"{report.failed} figures are not as theory has them" if report.failed
          else "all figures are as theory has them")
    sys.exit(1 if report.failed else 0)


if __name__ == "__main__":
    run(main)
