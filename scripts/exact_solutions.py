"""Exact solutions of four cases with impacts: from exact_solutions import oscillator, two_dof."""

import math

import numpy as np

MOST_IMPACTS = 100000


class Flights:
    """A motion that is smooth between impacts: pieces that start at given times."""

    def __init__(self):
        self.starts = []  # when each piece begins; all but the first begin with an impact
        self.pieces = []  # functions of the time since then: (displacements, velocities)

    def add(self, start, piece):
        self.starts.append(start)
        self.pieces.append(piece)

    @property
    def impact_times(self):
        return np.array(self.starts[1:])

    def at(self, times):
        """Displacements and velocities at the times; at an impact those after it."""
        times = np.atleast_1d(np.asarray(times, dtype=float))
        owner = np.searchsorted(self.starts, times, side="right") - 1
        columns = [None] * len(times)
        for piece in np.unique(owner):
            chosen = np.flatnonzero(owner == piece)
            d, v = self.pieces[piece](times[chosen] - self.starts[piece])
            for place, index in enumerate(chosen):
                columns[index] = (d[..., place], v[..., place])
        return (
            np.array([column[0] for column in columns]).T,
            np.array([column[1] for column in columns]).T,
        )


def oscillator(end, mass=1.0, stiffness=1.0, d0=1.0, v0=0.0, wall=-0.5, restitution=1.0):
    """One undamped oscillator with a wall on the side of d that is away from d0."""
    side = 1.0 if d0 >= wall else -1.0
    omega = math.sqrt(stiffness / mass)
    flights = Flights()
    start, d, v, limit = 0.0, side * d0, side * v0, side * wall
    scale = math.hypot(d, v / omega) + abs(limit)
    for _ in range(MOST_IMPACTS):
        flights.add(start, _harmonic(side * d, side * v, omega))
        radius = math.hypot(d, v / omega)
        if radius <= -limit or (radius == 0.0):
            break  # never reaches the wall (again)
        phase = math.atan2(v / omega, d)
        wait = (math.acos(max(-1.0, min(1.0, limit / radius))) + phase) % (2.0 * math.pi) / omega
        if wait * omega < 1e-9:
            if limit <= 0.0:
                wait += 2.0 * math.pi / omega
            else:  # pressed to the wall: the impacts have died out
                flights.add(start + wait, _rest(side * limit))
                break
        start += wait
        if start > end:
            break
        speed = -omega * math.sqrt(max(0.0, radius**2 - limit**2))
        d, v = limit, -restitution * speed
        if v < 1e-12 * omega * scale and limit > 0.0:
            flights.add(start, _rest(side * limit))
            break
    return flights


def _harmonic(d, v, omega):
    def piece(s):
        c, sn = np.cos(omega * s), np.sin(omega * s)
        return d * c + v / omega * sn, -d * omega * sn + v * c

    return piece


def _rest(d):
    def piece(s):
        return np.full_like(s, d), np.zeros_like(s)

    return piece


def two_dof(end, restitution=1.0, wall=-0.5):
    """Two masses in a row, M = I, K = [2 -1; -1 1], from (1, 1) at rest; a wall for the second."""
    stiffness = np.array([[2.0, -1.0], [-1.0, 1.0]])
    d0, v0 = np.array([1.0, 1.0]), np.zeros(2)
    return modal(end, stiffness, d0, v0, 1, wall, restitution)


def modal(end, stiffness, d0, v0, node, wall, restitution):
    """Unit masses on springs, one of them (counted from 0) above a wall: modes between impacts."""
    squares, modes = np.linalg.eigh(stiffness)
    omega = np.sqrt(squares)
    flights = Flights()
    start, d, v = 0.0, np.array(d0, dtype=float), np.array(v0, dtype=float)
    for _ in range(MOST_IMPACTS):
        piece = _modal_piece(modes, omega, d, v)
        flights.add(start, piece)
        wait = _first_contact(piece, node, wall, end - start, 0.01 / omega.max())
        if wait is None:
            break
        start += wait
        d, v = (values[:, 0] for values in piece(np.array([wait])))
        d[node] = wall
        v[node] *= -restitution
    return flights


def _modal_piece(modes, omega, d, v):
    a, b = modes.T @ d, modes.T @ v / omega

    def piece(s):
        angle = np.outer(omega, s)
        c, sn = np.cos(angle), np.sin(angle)
        q = a[:, None] * c + b[:, None] * sn
        p = omega[:, None] * (b[:, None] * c - a[:, None] * sn)
        return modes @ q, modes @ p

    return piece


def _first_contact(piece, node, wall, end, step):
    """The first time at which the node comes down to the wall; None if not before the end."""
    begin = 0.0
    while begin < end:
        grid = begin + step * np.arange(2001)
        d, v = piece(grid)
        gap, rate = d[node] - wall, v[node]
        through = (gap[1:] <= 0.0) & (rate[1:] < 0.0)
        dips = (rate[:-1] < 0.0) & (rate[1:] >= 0.0)  # a minimum of the gap between two points
        for i in np.flatnonzero(through | dips):
            low, high = grid[i], grid[i + 1]
            if not through[i]:
                high = _bisect(lambda s: piece(np.array([s]))[1][node, 0], low, high)
            if piece(np.array([high]))[0][node, 0] > wall:
                continue
            time = _bisect(lambda s: wall - piece(np.array([s]))[0][node, 0], low, high)
            return time if time <= end else None
        begin = grid[-1]
    return None


def _bisect(function, low, high):
    """The place where a function rises through zero, to round-off."""
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return high
        if function(middle) < 0.0:
            low = middle
        else:
            high = middle


def bar_contact_force(
    times, length=10.0, modulus=900.0, density=1.0, area=1.0, gap=5.0, speed=10.0
):
    """A bar that flies against a wall: contact force, and when the contact begins and ends."""
    wave = math.sqrt(modulus / density)
    begin = gap / speed
    end = begin + 2.0 * length / wave
    times = np.asarray(times, dtype=float)
    height = modulus * area * speed / wave
    return np.where((times >= begin) & (times < end), height, 0.0), begin, end


def bouncing_ball(times, height=1.0, gravity=9.81, restitution=0.8):
    """Height and velocity of a ball dropped at rest, and the time at which it comes to rest."""
    times = np.asarray(times, dtype=float)
    e = restitution
    fall = math.sqrt(2.0 * height / gravity)
    rest = math.inf if e >= 1.0 else fall * (1.0 + e) / (1.0 - e)
    y = height - 0.5 * gravity * times**2
    v = -gravity * times
    flying = (times > fall) & (times < rest)
    after = times[flying] - fall
    if e >= 1.0:
        bounce = np.floor(after / (2.0 * fall))
        since = after - 2.0 * fall * bounce
    elif e > 0.0:  # after = first flight (1 - e^n) / (1 - e) gives n, the flight one is in
        first = 2.0 * e * fall
        bounce = np.floor(np.log1p(-after * (1.0 - e) / first) / math.log(e))
        since = after - first * (1.0 - e**bounce) / (1.0 - e)
    else:
        bounce = since = after
    speed = gravity * fall * e ** (bounce + 1.0)
    y[flying] = np.maximum(0.0, speed * since - 0.5 * gravity * since**2)
    v[flying] = speed - gravity * since
    y[times >= rest] = 0.0
    v[times >= rest] = 0.0
    return y, v, rest


def ball_impact_times(end, height=1.0, gravity=9.81, restitution=0.8):
    """The impact times of the ball up to a time; at most 200 of the infinitely many."""
    fall = math.sqrt(2.0 * height / gravity)
    flights = 2.0 * fall * restitution ** np.arange(1, 200)
    times = fall + np.concatenate(([0.0], np.cumsum(flights)))
    return np.unique(times[times <= end])


def masses_in_line(end, masses, gaps, speeds, restitution=1.0):
    """Free masses in a row that hit their neighbours: their motion, and the impulse of each impact.
    Displacements count from the first places; the gaps between neighbours must not be closed."""
    masses, v = np.array(masses, dtype=float), np.array(speeds, dtype=float)
    gaps, d = np.array(gaps, dtype=float), np.zeros(len(masses))
    flights, impulses, start = Flights(), [], 0.0
    while True:
        flights.add(start, _uniform(d, v))
        closing = v[:-1] - v[1:]
        open_gaps = gaps + d[1:] - d[:-1]
        meeting = closing > 1e-14 * np.max(np.abs(v))
        waits = np.where(meeting, open_gaps / np.where(meeting, closing, 1.0), math.inf)
        first = int(np.argmin(waits))
        if start + waits[first] > end or len(impulses) >= MOST_IMPACTS:
            return flights, np.array(impulses)
        start, d = start + waits[first], d + waits[first] * v
        i, j = first, first + 1
        impulse = (1.0 + restitution) * closing[first] / (1.0 / masses[i] + 1.0 / masses[j])
        v = v.copy()
        v[i], v[j] = v[i] - impulse / masses[i], v[j] + impulse / masses[j]
        impulses.append(impulse)


def _uniform(d, v):
    def piece(s):
        return d[:, None] + np.outer(v, s), np.outer(v, np.ones_like(s))

    return piece
