"""What stability.py measures: amplification of carom's steps, limits, growth at impacts."""

import numpy as np

from carom_script import ScriptError
from stability_decks import (
    bouncing, bouncing_bar, coupled_pairs, impact_in_step, is_refused, oscillators, run_text,
)
from stability_theory import SCHEMES, impact_step, newmark_part, radius

MOST_UNSTABLE = 2e3
OVER = 1e-7   # a spectral radius beyond 1 by more than this grows


FRAMES = [f"VTKHDF/PointData/{q}" for q in "UVA"]


def states_of(outcome, n, scale):
    """(n, times, 3): omega d, v, a / omega of the first n nodes, from the frames."""
    d, v, a = (outcome[path][:, :n, 0].T for path in FRAMES)
    scale = np.asarray(scale)[:, None]
    return np.stack([d * scale, v, a / scale], axis=-1)


def run_frames(carom, text, n, scale):
    """The states of the first n nodes at all times of a run."""
    return states_of(run_text(carom, text, FRAMES), n, scale)


def fitted_radius(before, after):
    """Spectral radius of the linear map that takes the columns `before` to the columns `after`."""
    matrix = after @ np.linalg.pinv(before, rcond=1e-10)
    return float(np.abs(np.linalg.eigvals(matrix)).max()), matrix


def amplification(carom, scheme, omega, table=False):
    """Radius and matrix of the program's step at each frequency, from two runs with starts at right
    angles."""
    omega = np.asarray(omega)
    n, steps = len(omega), 2 if scheme.alpha or scheme.explicit else 1
    phase = np.random.default_rng(7).uniform(0.0, 2.0 * np.pi, n)
    # with gamma over 1/2 stiff motion overshoots: speeds of omega d times omega h come out
    speed = np.maximum(omega, 1.0) if scheme.gamma > 0.5 else np.ones(n)
    runs = []
    for turn in (0.0, 0.5 * np.pi):
        text = oscillators(scheme, omega, np.cos(phase + turn) / omega, speed * np.sin(phase + turn),
                           steps, table)
        states = run_frames(carom, text, n, omega)
        states[:, :, 1] /= speed[:, None]
        runs.append(states)
    radii, matrices = np.empty(n), np.empty((n, 3, 3))
    for i in range(n):
        before = np.concatenate([states[i, :-1] for states in runs]).T
        after = np.concatenate([states[i, 1:] for states in runs]).T
        radii[i], matrices[i] = fitted_radius(before, after)
        scale = np.array([1.0, speed[i], 1.0])
        matrices[i] *= scale[:, None] / scale
    return radii, matrices


def frequencies(scheme, per_decade, with_dense=True):
    """A log grid over 1e-6 to 1e6, dense near the limit; explicit ones end there."""
    grid = np.geomspace(1e-6, 1e6, 12 * per_decade + 1)
    limit = scheme.limit()
    if np.isfinite(limit):
        if with_dense:
            near = np.geomspace(1e-5, 0.1, 2 * per_decade)
            grid = np.sort(np.concatenate([grid, limit * (1.0 - near), limit * (1.0 + near)]))
        grid = grid[grid < MOST_UNSTABLE]   # beyond, round-off (omega h)^2 hides what is measured
        if scheme.explicit:
            grid = grid[grid < 0.999999 * accepted_limit(scheme)]
    return grid


def accepted_limit(scheme):
    """Theory of the critical step that the program computes for explicit elements."""
    return np.sqrt(0.5 / scheme.gamma) * 2.0 * (np.sqrt(1.0 + scheme.xi**2) - scheme.xi)


def is_limited(scheme):
    """Implicit and with a finite limit: beyond it only springs by a table are let through."""
    return not scheme.explicit and np.isfinite(scheme.limit())


def measure_schemes(carom, per_decade):
    """Spectral radius over frequency of every scheme, measured and by theory."""
    found = []
    for scheme in SCHEMES:
        omega = frequencies(scheme, per_decade)
        radii = np.empty(len(omega))
        beyond = omega > scheme.limit() if is_limited(scheme) else np.zeros(len(omega), bool)
        if not beyond.all():
            radii[~beyond] = amplification(carom, scheme, omega[~beyond])[0]
        if beyond.any():
            radii[beyond] = amplification(carom, scheme, omega[beyond], table=True)[0]
        theory = np.array([scheme.radius(w) for w in omega])
        found.append((scheme, omega, radii, theory))
    return found


def measured_limit(carom, scheme):
    """Where the program's steps begin to grow, by zooming in; of explicit ones, which the program
    refuses beyond it, by extrapolation of det(I + A) to zero from below."""
    if scheme.explicit:
        omega = accepted_limit(scheme) * np.array([0.998, 0.9998])
        matrices = amplification(carom, scheme, omega)[1]
        det = [np.linalg.det(np.eye(3) + matrix) for matrix in matrices]
        square = omega**2
        return np.sqrt(square[0] - det[0] * (square[1] - square[0]) / (det[1] - det[0]))
    low, high = 0.5, 50.0
    for _ in range(4):
        omega = np.geomspace(low, high, 60)
        grows = amplification(carom, scheme, omega, table=True)[0] > 1.0 + OVER
        if not grows.any():
            return np.inf
        i = int(np.argmax(grows))
        low, high = omega[max(i - 1, 0)], omega[i]
    return low


def refused_limit(carom, scheme):
    """The omega h from which `carom check` refuses an oscillator, by bisection."""
    def refused(omega):
        text = oscillators(scheme, [omega], [1.0], [0.0], 2)
        return is_refused(carom, text)

    limit = accepted_limit(scheme) if scheme.explicit else scheme.limit()
    if not np.isfinite(limit):
        return np.nan if refused(1e6) else np.inf
    low, high = 0.87 * limit, 1.19 * limit
    if refused(low) or not refused(high):
        return np.nan
    while high - low > 1e-6 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if refused(middle) else (middle, high)
    return low


def measure_limits(carom):
    """A row a scheme: theory, where growth is measured, where the program refuses."""
    rows = []
    for scheme in SCHEMES:
        limit = scheme.limit()
        if scheme.explicit or np.isfinite(limit):
            measured = measured_limit(carom, scheme)
        else:
            radii = amplification(carom, scheme, np.geomspace(1e-3, 1e6, 91))[0]
            measured = np.nan if (radii > 1.0 + 1e-3).any() else np.inf
        rows.append((scheme, limit, measured, refused_limit(carom, scheme)))
    return rows


def measure_floor(carom, steps, per_decade):
    """beta = 1/4: how far energies are from constant over many steps, at each frequency."""
    omega = np.geomspace(1e-6, 1e6, 12 * per_decade + 1)
    phase = np.random.default_rng(3).uniform(0.0, 2.0 * np.pi, len(omega))
    text = oscillators(SCHEMES[0], omega, np.cos(phase) / omega, np.sin(phase), steps)
    states = run_frames(carom, text, len(omega), omega)
    energy = states[:, :, 0]**2 + states[:, :, 1]**2
    return omega, np.abs(energy / energy[:, :1] - 1.0).max(axis=1)


def measure_coupling(carom, ratios, explicit_omega, inner_explicit):
    """Largest spectral radius of two masses, one on an implicit and one on an explicit spring.

    (mass ratio, stiffness ratio implicit / explicit, frequency of the explicit element x step)."""
    grid = np.array([(m, r, w) for m in ratios for r in ratios for w in explicit_omega])
    mass, ratio, omega = grid.T
    # the explicit element's own bound: on the mass, all of it where no implicit spring shares it
    share = 1.0 / (1.0 + 1.0 / mass) if inner_explicit else np.ones(len(mass))
    explicit = omega**2 * share
    implicit = ratio * explicit
    n, steps = len(mass), 6
    scale = np.sqrt(explicit + implicit)
    runs = []
    for j in range(4):
        start = np.zeros((n, 4))
        start[:, j] = 1.0 / scale if j < 2 else 1.0
        text = coupled_pairs(implicit, explicit, mass, start, steps, inner_explicit=inner_explicit)
        states = run_frames(carom, text, 2 * n, np.repeat(scale, 2))
        runs.append(states.reshape(n, 2, steps + 1, 3).transpose(0, 2, 1, 3).reshape(n, steps + 1, 6))
    radii = np.empty(n)
    for i in range(n):
        before = np.concatenate([states[i, :-1] for states in runs]).T
        after = np.concatenate([states[i, 1:] for states in runs]).T
        radii[i] = fitted_radius(before, after)[0]
    return radii.reshape(len(ratios), len(ratios), len(explicit_omega))


def hitting_starts(omega, delta, beta):
    """Two unit states (omega d, v) that meet a wall at (1 - delta) h, and at no other time of the
    step, and that would be behind it at its end; None if hardly any state does."""
    angles = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    states = np.stack([np.cos(angles), np.sin(angles)])
    at = newmark_part(omega, 1.0 - delta, beta) @ states
    path = newmark_part(omega, (1.0 - delta) * np.linspace(0.0, 0.99, 34), beta) @ states
    back = newmark_part(omega, delta * np.linspace(0.03, 1.0, 34), beta) @ np.diag([1.0, -1.0]) @ at
    ends = [newmark_part(omega, 1.0, b) @ states for b in (0.25, beta)]
    good = at[1] < -0.05
    for way in (path, back):
        good &= (way[:, 0] > at[0]).all(axis=0)
    for end in ends:
        good &= end[0] < at[0] - 1e-4
    places = np.flatnonzero(good)
    if len(places) < 8:
        return None
    # the largest connected arc
    arcs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    if len(arcs) > 1 and arcs[0][0] == 0 and arcs[-1][-1] == 719:
        arcs = [np.concatenate([arcs[-1], arcs[0]]), *arcs[1:-1]]
    arc = max(arcs, key=len)
    chosen = states[:, [arc[len(arc) // 5], arc[(4 * len(arc)) // 5]]]
    return chosen if len(arc) >= 8 else None


def measure_impact_steps(carom, omega, deltas, beta):
    """The program's matrix of a step with an impact at (1 - delta) h, e = 1, for each omega and
    delta; NaN where no state hits. (omega, delta, 2, 2), and the matrices of theory."""
    value = {"AUTO": 0.25}.get(beta) or eval_fraction(beta)
    shape = (len(omega), len(deltas), 2, 2)
    found, theory = np.full(shape, np.nan), np.full(shape, np.nan)
    for j, delta in enumerate(deltas):
        starts = [hitting_starts(w, delta, value) for w in omega]
        members = [i for i, start in enumerate(starts) if start is not None]
        if not members:
            continue
        w = np.repeat(omega[members], 2)
        state = np.concatenate([starts[i].T for i in members])
        at = (newmark_part(w, 1.0 - delta, value) @ state[:, :, None])[:, 0, 0]
        n = len(w)
        text = impact_in_step(w, state / np.stack([w, np.ones(n)], axis=1), at / w, beta)
        outcome = run_text(carom, text, [*FRAMES[:2], "events/time"])
        times = outcome["events/time"]
        if len(times) != n or np.abs(times - (1.0 - delta)).max() > 1e-6:
            raise ScriptError(f"beta {beta}, delta {delta}: {len(times)} impacts of {n}, "
                              f"times {times.min()} to {times.max()}")
        d, v = (outcome[path][-1, :n, 0] for path in FRAMES[:2])
        after = np.stack([d * w, v], axis=1)
        for m, i in enumerate(members):
            found[i, j] = after[2 * m:2 * m + 2].T @ np.linalg.inv(starts[i])
            theory[i, j] = impact_step(omega[i], delta, value)
    return found, theory


def eval_fraction(text):
    """A number, or a fraction such as 1/6."""
    top, _, bottom = str(text).partition("/")
    return float(top) / float(bottom or 1)


def recurring(omega, matrices, k):
    """Growth a step of k - 1 steps without and one with an impact; matrices (omega, delta, 2, 2)."""
    free = newmark_part(omega, 1.0, 0.25)[:, None]
    power = np.linalg.matrix_power(free, k - 1)
    growth = np.full(matrices.shape[:2], np.nan)
    good = np.isfinite(matrices).all(axis=(2, 3))
    product = matrices @ power
    growth[good] = radius(product[good])**(1.0 / k)
    return growth


def growth_of(outcome, events):
    """Largest energy over the first one, and its logarithmic growth an impact."""
    energy = outcome["energy/total"]
    finite = energy[np.isfinite(energy) & (energy < 1e280)]
    largest = float(finite.max() / energy[0])
    rows = max(len(finite) / len(energy), 1e-9)
    return largest, float(np.log(largest) / max(events * rows, 1.0))


def measure_bouncing(carom, omega, place, steps, beta, own_beta=0.25):
    """Largest energy, growth an impact and number of impacts of one oscillator at a wall."""
    rows = []
    for w in omega:
        outcome = run_text(carom, bouncing(w, place, steps, beta, own_beta),
                           ["energy/total", "events/time"])
        events = len(outcome["events/time"])
        rows.append((*growth_of(outcome, events), events))
    return np.array(rows)


def measure_bar(carom, courant, steps, beta, alpha=0.0):
    """The same of a bar whose end hits a wall."""
    rows = []
    for c in courant:
        outcome = run_text(carom, bouncing_bar(c, steps, beta, alpha),
                           ["energy/total", "events/time"])
        events = len(outcome["events/time"])
        rows.append((*growth_of(outcome, events), events))
    return np.array(rows)
