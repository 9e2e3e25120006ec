"""The meshes of the contact decks, and the exact solutions themselves (nothing is run)."""
import math
import sys

import numpy as np

from carom_case import INPUT, ROOT, Checks
from contact_case import Folder

sys.path[:0] = [str(ROOT / 'scripts'), str(INPUT)]
from contact_solutions import (  # noqa: E402
    bars_head_on, contact_modulus, contact_radius, hertz_force, hertz_line, hertz_pressure,
    oblique_bounce, pressure_of_forces, slope_acceleration, sliding_distance, stopping,
)
from mesh_tools import disc, quarter_disc  # noqa: E402


def check_hertz(checks):
    """The pressure carries the force; half-width and peak belong together; two bodies."""
    radius, modulus = contact_radius(1, 3), contact_modulus(1000, 0.3, 10000, 0.2)
    checks.close(radius, 0.75, 1e-15, 'radius of two cylinders')
    checks.close(1 / modulus, 0.91 / 1000 + 0.96 / 10000, 1e-18, 'modulus of two bodies')
    checks.close(contact_radius(2), 2, 0, 'radius on a plane')
    checks.close(contact_modulus(1, 0), 1, 0, 'modulus on a rigid body')
    width, peak = hertz_line(3.0, radius, modulus)
    checks.close(hertz_force(width, radius, modulus), 3.0, 1e-14, 'force of a half-width')
    checks.close(peak, modulus * width / (2 * radius), 1e-12 * peak, 'peak and half-width')
    angle = (np.arange(2000) + 0.5) * math.pi / 2000
    x = width * np.cos(angle)
    total = np.sum(hertz_pressure(x, 3.0, radius, modulus) * width * np.sin(angle)) * math.pi / 2000
    checks.close(total, 3.0, 1e-5, 'the pressure carries the force')
    checks.close(hertz_pressure([-2 * width, width, 0], 3.0, radius, modulus), [0, 0, peak], 1e-12 * peak,
                 'no pressure beyond the contact')


def check_motions(checks):
    """Bars keep momentum and, if equal, energy; blocks and points obey Newton."""
    for lengths, speeds in (((10, 10), (5, -5)), ((5, 10), (10, 0)), ((10, 4), (3, -1))):
        force, duration, *after = bars_head_on(*lengths, *speeds)
        checks.close(np.dot(lengths, after), np.dot(lengths, speeds), 1e-12,
                     f'bars of {lengths}: momentum')
        checks.close(force * duration, lengths[1] * (after[1] - speeds[1]), 1e-12,
                     f'bars of {lengths}: impulse')
    checks.close(bars_head_on(10, 10, 5, -5)[2:], [-5, 5], 1e-14, 'equal bars change their speeds')
    checks.close(bars_head_on(5, 10, 10, 0)[2:], [0, 5], 1e-14, 'the short bar stops')
    distance, time = stopping(5.0, 0.3)
    checks.close(sliding_distance([time, 2 * time], 5.0, 0.3), [distance] * 2, 1e-14, 'block: stop')
    checks.close(0.3 * 9.81 * distance, 12.5, 1e-13, 'block: friction takes its energy')
    limit = math.atan(0.3)
    checks.close([slope_acceleration(limit, 0.3), slope_acceleration(0.9 * limit, 0.3)], [0, 0], 1e-15,
                 'slope: no motion to arctan mu')
    checks.close(slope_acceleration(math.pi / 2, 0.3, 2.0), 2.0, 1e-15, 'slope: free fall')
    checks.close(oblique_bounce(2, -1, 0.3, 0.8), [2 - 0.54, 0.8], 1e-15, 'oblique bounce: slides')
    checks.close(oblique_bounce(-0.3, -1, 0.3, 0.8), [0, 0.8], 1e-15, 'oblique bounce: stops')


def check_recovery(checks):
    """Nodal forces of a pressure that is linear along an edge give it back."""
    x = np.array([[0, 0], [1, 0.2], [0.5, 0.1], [2, 0.4], [1.5, 0.3]])
    edges = [[0, 1, 2], [1, 3, 4]]
    pressure = 1 + 0.5 * x[:, 0]
    forces = np.zeros(5)
    for s, w in zip(*np.polynomial.legendre.leggauss(4)):
        shape = np.array([s * (s - 1) / 2, s * (s + 1) / 2, 1 - s * s])
        for edge in edges:
            forces[edge] += w * np.hypot(1, 0.2) / 2 * shape * (shape @ pressure[edge])
    checks.close(pressure_of_forces(x, edges, forces), pressure, 1e-13, 'pressure of nodal forces')


def check_meshes(checks):
    """No element is turned over; nodes of the rim on the circle, middle nodes amid; sizes as promised."""
    for name, body, circle in (('disc', disc(2.0, 14, 9), (0, 0, 2.0)),
                               ('disc of 8', disc(1.0, 7, 5).quadratic((0, 0, 1.0)), (0, 0, 1.0)),
                               ('quarter', quarter_disc(1.0, 0.05, 1.3).quadratic((0, 1, 1.0)),
                                (0, 1, 1.0))):
        checks.at_least(body.smallest_jacobian(), 0.2, f'{name}: smallest Jacobian')
        sides = body.rim(lambda x: abs(math.hypot(x[0] - circle[0], x[1] - circle[1]) / circle[2] - 1)
                         < 1e-12)
        length, amid = 0.0, 0.0
        for side in sides:
            points = body.x[body.side(*side)]
            length += np.hypot(*(points[1] - points[0]))
            if len(points) == 3:
                ways = np.hypot(*(points[:2] - points[2]).T)
                amid = max(amid, abs(ways[0] / ways[1] - 1))
        whole = math.pi * circle[2] * (0.5 if name == 'quarter' else 2)
        checks.at_most(abs(length / whole - 1), 0.01, f'{name}: the rim goes around')
        checks.at_most(amid, 1e-12, f'{name}: middle nodes amid the arcs')
    make = Folder('hertz', 'make_hertz').make
    for across in (8, 7):
        body = make.quarter(1.0, 0.05, across)
        low = [p for p in body.points_of(make.low_side(body, 1.0, 0.05 * (1 + 1e-6)))]
        checks.true(len(low) == 2 * across + 1, f'Hertz: {2 * across} distances of nodes to the rim')
    freedoms = 2 * len(Folder('dropped_disc', 'make_disc').make.disc(1.0, 14, 9).x)
    checks.close(freedoms, 1500, 60, 'dropped disc: about 1500 freedoms')
    crack = Folder('crack', 'make_plate').make
    body, (above, below) = crack.plate(30.0)
    checks.at_least(body.smallest_jacobian(), 0.2, 'cracked plate: smallest Jacobian')
    up = np.array([body.x[body.side(*side)] for side in above])
    down = np.array([body.x[body.side(*side)] for side in below])
    checks.close(np.sort(up, axis=1), np.sort(down, axis=1), 0.0, 'crack: its faces coincide')
    shared = set(body.points_of(above)) & set(body.points_of(below))
    checks.true(len(shared) == 2, 'crack: its faces share the tips alone')


checks = Checks()
check_hertz(checks)
check_motions(checks)
check_recovery(checks)
check_meshes(checks)
checks.finish()
