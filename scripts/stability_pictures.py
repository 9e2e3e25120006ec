"""Pictures of stability.py: steps, impact steps, impacts that recur, coupling."""

import numpy as np

from carom_plots import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, SKY, plt, save

STYLES = ((BLUE, "o", "-"), (RED, "s", "--"), (GREEN, "^", "-."), (ORANGE, "D", ":"),
          (PURPLE, "v", "-"), (BLACK, "x", "--"), (SKY, "P", "-."))
FREQUENCY = "frequency × step, ωh"


def draw_family(axes, family, title, low, high):
    """Spectral radius over frequency: lines of theory, marks of measurement, limits as ticks."""
    for (scheme, omega, radii, theory), (colour, mark, line) in zip(family, STYLES):
        axes.plot(omega, np.clip(theory, low, 10 * high), line, color=colour, alpha=0.8)
        sparse = np.unique(np.round(8 * np.log10(omega)), return_index=True)[1]
        axes.plot(omega[sparse], radii[sparse], mark, color=colour, markersize=5, label=scheme.name)
        if np.isfinite(scheme.limit()):
            axes.axvline(scheme.limit(), color=colour, linewidth=1, linestyle=line, alpha=0.6)
    axes.set(xscale="log", xlim=(1e-6, 1e6), ylim=(low, high), title=title)
    axes.legend(loc="upper left", fontsize=10)


def draw_steps(measured, floor, path):
    """Spectral radii of all schemes, and what is left by round-off."""
    figure, panels = plt.subplots(2, 2, figsize=(14, 10), layout="constrained")
    plain = [row for row in measured if not row[0].alpha and not row[0].xi]
    hht = [row for row in measured if row[0].alpha]
    damped = [row for row in measured if row[0].xi]
    draw_family(panels[0, 0], plain, "Newmark's rule (limits: thin vertical lines)", 0.4, 1.6)
    draw_family(panels[0, 1], hht, "Hilber, Hughes and Taylor", 0.4, 1.6)
    draw_family(panels[1, 0], damped, "Damping, ratio ξ = 0.05", 0.6, 1.3)
    for axes in panels.flat[:3]:
        axes.set(xlabel=FREQUENCY, ylabel="spectral radius of a step")
    axes = panels[1, 1]
    conserving = [row for row in plain if row[0].gamma == 0.5]
    for (scheme, omega, radii, _), (colour, mark, _) in zip(conserving, STYLES):
        good = omega < 0.99 * scheme.limit()
        axes.plot(omega[good], np.abs(radii[good] - 1.0) + 1e-17, mark, color=colour, markersize=4,
                  label=f"|radius − 1|, {scheme.name}")
    omega, errors, steps = floor
    axes.plot(omega, errors, color=BLACK, label=f"energy error in {steps} steps, β = 1/4")
    axes.axhline(2.2e-16, color="0.4", linestyle="--", label="one round-off")
    axes.set(xscale="log", yscale="log", ylim=(1e-17, 1e-9), xlabel=FREQUENCY,
             ylabel="deviation from 1", title="Round-off where theory says 1")
    axes.legend(loc="upper left", fontsize=10)
    save(figure, path)


def draw_impact_steps(omega, deltas, found, recurring, path):
    """Growth of a step with an impact over frequency and place of the impact; of impacts every k
    steps (a dictionary with β = 1/6, and the worst of AUTO) over frequency."""
    figure, panels = plt.subplots(1, 3, figsize=(17, 5.6), layout="constrained")
    for axes, (beta, growth) in zip(panels, found.items()):
        shown = np.log10(np.maximum(growth - 1.0, 1e-16))
        picture = axes.pcolormesh(omega, deltas, shown.T, shading="nearest", cmap="cividis",
                                  vmin=-12, vmax=2)
        axes.set(xscale="log", xlabel=FREQUENCY, ylabel="part of the step after the impact, δ",
                 title=f"A step with an impact, β = {beta}")
        limit = {"1/6": np.sqrt(12.0)}.get(beta)
        if not np.isnan(growth).all() and np.nanmax(growth) - 1 < 1e-9:
            axes.text(0.5, 0.5, f"radius − 1 below {np.nanmax(growth) - 1:.0e}\neverywhere",
                      color="white", ha="center", va="center", fontsize=14, transform=axes.transAxes)
        if limit:
            axes.axvline(limit, color="black", linestyle="--")
            axes.text(1.15 * limit, 0.9, "limit of\nβ = 1/6", fontsize=12)
    figure.colorbar(picture, ax=panels[:2], label="log₁₀ (spectral radius − 1); white: no impact there")
    axes = panels[2]
    every, kept = recurring
    for (k, growth), (colour, mark, line) in zip(every.items(), STYLES):
        axes.plot(omega, np.maximum(growth - 1.0, 1e-16), line, marker=mark, color=colour,
                  markersize=5, label=f"β = 1/6, every {k} steps" if k > 1 else "β = 1/6, every step")
    axes.plot(omega, omega**4 / 256.0, color="0.5", linewidth=1, label="(ωh)⁴ / 256")
    axes.plot(omega, np.maximum(kept, 1e-16), color=PURPLE, label="β = 1/4 (AUTO), every 1 to 10 steps")
    axes.set(xscale="log", yscale="log", ylim=(1e-16, 1e3), xlabel=FREQUENCY,
             ylabel="growth in a step (radius − 1), worst δ", title="The same every k steps")
    axes.legend(loc="center right", bbox_to_anchor=(1.0, 0.42), fontsize=10)
    save(figure, path)


def draw_recurring(omega, bouncing, courant, bars, path):
    """Energy growth where impacts recur by themselves: an oscillator, a bar."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(14, 5.8), layout="constrained")
    for (name, rows), (colour, mark, _) in zip(bouncing.items(), STYLES):
        shown = np.where(rows[:, 0] - 1.0 > 1e-9, rows[:, 1], np.nan)
        left.plot(omega, shown, mark, color=colour, markersize=7, label=name)
        kept = rows[:, 0] - 1.0 <= 1e-9
        left.plot(omega[kept], np.full(kept.sum(), 1e-9), mark, color=colour, fillstyle="none",
                  markersize=7)
    left.text(0.02, 0.04, "open marks: no gain", transform=left.transAxes, fontsize=11)
    left.set(xscale="log", yscale="log", ylim=(1e-10, 10), xlabel=FREQUENCY,
             ylabel="ln(largest energy / first) / impacts", title="One oscillator bounces, e = 1")
    for (name, rows), (colour, mark, line) in zip(bars.items(), STYLES):
        right.plot(courant, np.clip(rows[:, 0] - 1.0, 1e-12, 1e20), line, marker=mark, color=colour,
                   label=name)
    right.set(xscale="log", yscale="log", ylim=(1e-13, 1e22), xlabel="Courant number",
              ylabel="largest energy gain / first energy", title="A bar bounces at its end, e = 1")
    right.text(0.02, 0.5, "at 1e20: no bound\nat 1e-12: no gain", transform=right.transAxes, fontsize=11)
    for axes in (left, right):
        axes.legend(loc="upper left", fontsize=10)
    save(figure, path)


def draw_coupling(ratios, omega, radii, path):
    """Two masses on an implicit and an explicit spring: worst radius over the mass ratios."""
    figure, panels = plt.subplots(1, len(radii), figsize=(13, 5.2), layout="constrained")
    for axes, (name, values) in zip(panels, radii.items()):
        shown = np.log10(np.abs(values.max(axis=0) - 1.0) + 1e-17)
        picture = axes.pcolormesh(omega, ratios, shown, shading="nearest", cmap="cividis",
                                  vmin=-16, vmax=-6)
        axes.set(xscale="log", yscale="log", xlabel="frequency of the explicit element × step",
                 ylabel="implicit / explicit stiffness", title=name)
    figure.colorbar(picture, ax=panels, label="log₁₀ |spectral radius − 1|, worst mass ratio")
    save(figure, path)
