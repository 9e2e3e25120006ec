"""Exact solutions of bodies in contact: from contact_solutions import hertz_line, bars_head_on."""

import math

import numpy as np


def contact_modulus(young_1, poisson_1, young_2=math.inf, poisson_2=0.0):
    """E* of two bodies in plane strain; a rigid one has an infinite modulus."""
    softness = (1.0 - poisson_1**2) / young_1 + (1.0 - poisson_2**2) / young_2
    return 1.0 / softness


def contact_radius(radius_1, radius_2=math.inf):
    """The radius of the cylinder that closes on a plane as two cylinders close on one another."""
    return 1.0 / (1.0 / radius_1 + 1.0 / radius_2)


def hertz_line(force, radius, modulus):
    """Half-width and largest pressure of two cylinders that a force per length presses together."""
    width = math.sqrt(4.0 * force * radius / (math.pi * modulus))
    return width, 2.0 * force / (math.pi * width)


def hertz_force(width, radius, modulus):
    """The force per length that belongs to a half-width."""
    return math.pi * modulus * width**2 / (4.0 * radius)


def hertz_pressure(x, force, radius, modulus):
    """The pressure at distances x from the middle of the contact."""
    width, peak = hertz_line(force, radius, modulus)
    inside = 1.0 - (np.asarray(x, dtype=float) / width) ** 2
    return peak * np.sqrt(np.maximum(inside, 0.0))


def bars_head_on(
    length_1, length_2, speed_1, speed_2, modulus=900.0, density=1.0, area=1.0, wave=None
):
    """Two bars of one material and section: contact force, duration of the contact, and the mean
    velocities after it. The contact ends when the wave comes back from the nearer free end."""
    wave = wave or math.sqrt(modulus / density)
    impedance = density * wave * area
    force = 0.5 * impedance * (speed_1 - speed_2)
    duration = 2.0 * min(length_1, length_2) / wave
    impulse = force * duration
    return (
        force, duration,
        speed_1 - impulse / (density * area * length_1),
        speed_2 + impulse / (density * area * length_2),
    )


def stopping(speed, friction, gravity=9.81):
    """Distance and time in which a block slides to rest on a rough level plane."""
    return speed**2 / (2.0 * friction * gravity), speed / (friction * gravity)


def sliding_distance(times, speed, friction, gravity=9.81):
    """How far the block has come."""
    _, stop = stopping(speed, friction, gravity)
    t = np.minimum(np.asarray(times, dtype=float), stop)
    return speed * t - 0.5 * friction * gravity * t**2


def slope_acceleration(angle, friction, gravity=9.81):
    """Of a block on a slope, the angle in radians; zero if it sticks."""
    return max(0.0, gravity * (math.sin(angle) - friction * math.cos(angle)))


def oblique_bounce(across, down, friction, restitution):
    """Velocities after a point has hit a rough plane: Newton's restitution normal to it, Coulomb's
    cone on the impulse. The point may stop to slide, it does not turn back."""
    up = -restitution * down
    most = friction * (up - down)
    return across - math.copysign(min(abs(across), most), across), up


def edge_mass(x):
    """Integrals of the products of the shape functions of an edge: x (2 or 3, 2), the middle point
    last."""
    x = np.asarray(x, dtype=float)
    total = np.zeros((len(x), len(x)))
    for s, weight in zip(*np.polynomial.legendre.leggauss(5)):
        shape, slope = edge_shapes(len(x), s)
        total += weight * np.hypot(*(slope @ x)) * np.outer(shape, shape)
    return total


def edge_shapes(n, s):
    """Shape functions of an edge of 2 or 3 points and their derivatives."""
    if n == 2:
        return np.array([1 - s, 1 + s]) / 2, np.array([-0.5, 0.5])
    return (
        np.array([s * (s - 1) / 2, s * (s + 1) / 2, 1 - s * s]),
        np.array([s - 0.5, s + 0.5, -2 * s]),
    )


def pressure_of_forces(x, edges, forces, tolerance=1e-12):
    """The pressure at the nodes that does the work of their normal forces: edges (m, 2 or 3) of points
    x (n, 2), forces (n). Nodes without force have no pressure."""
    mass = np.zeros((len(x), len(x)))
    for edge in edges:
        mass[np.ix_(edge, edge)] += edge_mass(x[np.asarray(edge)])
    active = np.flatnonzero(forces > tolerance * np.max(np.abs(forces)))
    pressure = np.zeros(len(x))
    pressure[active] = np.linalg.solve(mass[np.ix_(active, active)], forces[active])
    return pressure
