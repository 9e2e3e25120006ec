"""How report.py judges a claim: by a measured figure and a limit, never by hand.

    verdicts.append(at_most("the energy is kept", drift, 1e-12, "largest change of the energy"))
"""

from dataclasses import dataclass

import numpy as np

HOLDS, FAILS, OPEN = "holds", "does not hold", "not decidable"
ALIKE = 0.01        # of the height of a picture: two curves that the eye cannot part


@dataclass
class Verdict:
    """A claim in our words, what was measured, the limit it had to keep, and what follows."""

    claim: str
    measured: str
    limit: str
    outcome: str
    ours: bool = False      # not the source's: what we say of our own

    def own(self):
        """The same as a claim of ours."""
        self.ours = True
        return self


def judge(claim, value, good, measured, limit):
    """A verdict; without a finite value the claim cannot be decided."""
    finite = value is not None and np.all(np.isfinite(value))
    return Verdict(claim, measured, limit, OPEN if not finite else HOLDS if good else FAILS)


def at_most(claim, value, limit, what):
    """The claim holds if the value is at most the limit."""
    return judge(claim, value, value is not None and value <= limit, f"{what}: {shown(value)}",
                 f"at most {limit:.3g}")


def at_least(claim, value, limit, what):
    """The claim holds if the value is at least the limit."""
    return judge(claim, value, value is not None and value >= limit, f"{what}: {shown(value)}",
                 f"at least {limit:.3g}")


def convergent(claim, steps, errors, order=0.5, rise=1.5):
    """Errors that fall with the step: with this order at least, never rising by more than a factor
    from one step to the next smaller one."""
    found, rises = fitted_order(steps, errors), np.array(errors)[1:] / np.array(errors)[:-1]
    return judge(claim, found, found >= order and rises.max() <= rise,
                 f"order {found:.2f}; from one step to the next the error rises by up to "
                 f"{rises.max():.2g} times; last {errors[-1]:.2g}",
                 f"order at least {order:g}, rises at most {rise:g} times")


def undecided(claim, why):
    """A claim that these runs cannot decide."""
    return Verdict(claim, why, "", OPEN)


def shown(value):
    """A number as the page shows it."""
    return "none" if value is None else f"{value:.3g}"


def fitted_order(steps, errors):
    """The exponent of the step in the error, fitted through all pairs."""
    return float(np.polyfit(np.log(steps), np.log(np.maximum(errors, 1e-300)), 1)[0])


def largest(values):
    """The largest size; NaN where one is none."""
    return float(np.max(np.abs(values)))


def mean_difference(time, values, exact):
    """The difference over time, its mean: for curves with jumps, which no two runs have at the same
    instant."""
    return float(np.trapezoid(np.abs(values - exact), time) / (time[-1] - time[0]))


def energy_change(run):
    """The change of the total energy with time, relative to that at the start."""
    total = run["energy/total"]
    return total / total[0] - 1.0
