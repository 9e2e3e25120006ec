"""Amplification matrices of one step on one oscillator, m = h = 1, in closed form.

A scheme is Newmark's gamma and beta with the alpha of Hilber, Hughes and Taylor; an explicit spring
or dashpot acts on the predictors (Hughes and Liu). The state is (omega d, v, a / omega).
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Scheme:
    """How an oscillator is stepped: omega is its frequency times step, damping ratio xi."""

    name: str
    beta: float = 0.25
    gamma: float = 0.5
    alpha: float = 0.0
    explicit: bool = False
    xi: float = 0.0
    damper: str = "dashpot"          # or the material's: "mass", "stiffness"

    def matrix(self, omega):
        """The 3 x 3 matrix from one state to the next."""
        stiffness, damping = omega**2, 2.0 * self.xi * omega
        predictor = np.array([[1.0, 1.0, 0.5 - self.beta], [0.0, 1.0, 1.0 - self.gamma]])
        now = 0.0 if self.explicit else self.gamma * damping + self.beta * stiffness
        force = (1.0 + self.alpha) * (stiffness * predictor[0] + damping * predictor[1])
        force -= self.alpha * np.array([stiffness, damping, 0.0])
        acceleration = -force / (1.0 + (1.0 + self.alpha) * now)
        plain = np.vstack([predictor[0] + self.beta * acceleration,
                           predictor[1] + self.gamma * acceleration, acceleration])
        scale = np.array([omega, 1.0, 1.0 / omega])
        return scale[:, None] * plain / scale

    def radius(self, omega):
        """The spectral radius: how much the worst motion grows in a step."""
        return float(np.abs(np.linalg.eigvals(self.matrix(omega))).max())

    def limit(self, largest=1e6):
        """The omega h up to which no motion grows; infinite if that is beyond the largest."""
        grid = np.geomspace(1e-3, largest, 4001)
        over = [self.radius(omega) > 1.0 + 1e-7 for omega in grid]
        if not any(over):
            return np.inf
        i = over.index(True)
        low, high = grid[i - 1], grid[i]
        while high - low > 1e-12 * high:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.radius(middle) > 1.0 + 1e-9 else (middle, high)
        return low


def newmark_part(omega, part, beta):
    """Part of a step (of size `part` h) on (omega d, v), gamma = 1/2, the acceleration -omega^2 d."""
    x = np.asarray(omega * part)
    r = 1.0 + beta * x**2
    matrix = np.array([[1.0 - x**2 / (2.0 * r), x / r],
                       [-x * (1.0 - x**2 / (4.0 * r)), 1.0 - x**2 / (2.0 * r)]])
    return np.moveaxis(matrix, (0, 1), (-2, -1))


def impact_step(omega, delta, beta, restitution=1.0):
    """A step whose impact comes at (1 - delta) h: Newmark, jump, Newmark (eq. 4.25)."""
    jump = np.diag([1.0, -restitution])
    return newmark_part(omega, delta, beta) @ jump @ newmark_part(omega, 1.0 - delta, beta)


def radius(matrix):
    """Spectral radius of a matrix, or of each in a stack."""
    return np.abs(np.linalg.eigvals(matrix)).max(axis=-1)


SCHEMES = (
    Scheme("β = 1/4 (trapezoidal)"),
    Scheme("β = 1/6 (linear acceleration)", beta=1 / 6),
    Scheme("β = 1/12 (Fox-Goodwin)", beta=1 / 12),
    Scheme("β = 0 (central differences)", beta=0.0, explicit=True),
    Scheme("γ = 0.6, default β", beta=0.3025, gamma=0.6),
    Scheme("γ = 0.6, β = 1/4", gamma=0.6),
    Scheme("γ = 0.6, β = 0", beta=0.0, gamma=0.6, explicit=True),
    Scheme("HHT α = -0.1", beta=0.3025, gamma=0.6, alpha=-0.1),
    Scheme("HHT α = -0.3", beta=0.4225, gamma=0.8, alpha=-0.3),
    Scheme("HHT α = -0.3, β = 0.36", beta=0.36, gamma=0.8, alpha=-0.3),
    Scheme("HHT α = -0.1, explicit group", beta=0.3025, gamma=0.6, alpha=-0.1, explicit=True),
    Scheme("dashpot, ξ = 0.05", xi=0.05),
    Scheme("mass damping, ξ = 0.05", xi=0.05, damper="mass"),
    Scheme("stiffness damping, ξ = 0.05", xi=0.05, damper="stiffness"),
    Scheme("dashpot, β = 0", beta=0.0, explicit=True, xi=0.05),
    Scheme("mass damping, β = 0", beta=0.0, explicit=True, xi=0.05, damper="mass"),
    Scheme("stiffness damping, β = 0", beta=0.0, explicit=True, xi=0.05, damper="stiffness"),
)
