"""The picture of bench.py: time and memory against the number of equations, with exponents."""

import numpy as np
from carom_plots import BLUE, GREEN, ORANGE, plt, save

# What theory says of a square grid: skyline, sparse factors by nested dissection
THEORY = {
    "skyline": {"factor": (2.0, "n^2"), "solve": (1.5, "n^{1.5}"), "memory": (1.5, "n^{1.5}")},
    "mumps": {"factor": (1.5, "n^{1.5}"), "solve": (1.0, "n\\log n"),
              "memory": (1.0, "n\\log n")},
}
KEYS = {
    "skyline": {"factor": "factor_seconds_1t", "solve": "solve_seconds_1t",
                "memory": "stored_bytes"},
    "mumps": {"factor": "mumps_factor_seconds", "solve": "mumps_solve_seconds",
              "memory": "mumps_bytes"},
}
UNITS = {"factor": (1.0, "s"), "solve": (1.0, "s"), "memory": (1e-6, "MB")}


def series(rows, method, what):
    """Equations and values of one curve."""
    key = KEYS[method][what]
    pairs = [(row["equations"], row[key] * UNITS[what][0]) for row in rows if key in row]
    return np.array(pairs).reshape(-1, 2).T


def exponent(n, values, fewest=9000.0):
    """The slope of the logarithms from a size on at which the small things no longer count."""
    large = n >= min(fewest, np.sort(n)[len(n) // 2]) if len(n) else n
    if np.count_nonzero(large) < 2:
        return None
    return float(np.polyfit(np.log(n[large]), np.log(values[large]), 1)[0])


def exponents(rows):
    """All fitted exponents by name."""
    return {
        f"exponent_{method}_{what}": exponent(*series(rows, method, what))
        for method in KEYS for what in UNITS if series(rows, method, what).size
    }


def draw(rows, path, title):
    """Three panels: factor, solve, memory."""
    figure, panels = plt.subplots(1, 3, figsize=(15, 5.2), layout="constrained")
    names = {"factor": "factorization", "solve": "one solution", "memory": "factors"}
    for axes, what in zip(panels, UNITS):
        for method, colour, mark in (("skyline", BLUE, "o"), ("mumps", ORANGE, "s")):
            n, values = series(rows, method, what)
            if not len(n):
                continue
            slope, (theory, formula) = exponent(n, values), THEORY[method][what]
            fitted = "" if slope is None else f": n^{slope:.2f}"
            name = "MUMPS" if method == "mumps" else method
            axes.loglog(n, values, mark + "-", color=colour, label=name + fitted)
            guide = (n / n[-1]) ** theory
            if "log" in formula:
                guide = guide * np.log(n) / np.log(n[-1])
            axes.loglog(n, values[-1] * guide, ":", color=colour, label=f"${formula}$")
        for row in rows:
            if "GB" in row.get("skipped", ""):
                axes.axvline(row["equations"], color=GREEN, linestyle="dashed",
                             label="skyline beyond memory")
                break
        axes.set_xlabel("equations n")
        axes.set_ylabel(f"{names[what]}, {UNITS[what][1]}")
        axes.legend()
    figure.suptitle(title)
    save(figure, path)
