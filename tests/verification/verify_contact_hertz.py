"""Static line contact against Hertz: input/hertz."""
import numpy as np

from carom_case import Checks
from contact_case import Folder
from contact_solutions import (
    contact_modulus, contact_radius, hertz_line, hertz_pressure, pressure_of_forces,
)

folder = Folder('hertz', 'make_hertz')
POISSON = 0.3


class Hertz:
    """Pressures of one run: those of the file and those that follow from the forces of the slave."""

    def __init__(self, deck, radii, youngs, below):
        self.contact = contact = folder.run(deck)
        radius = contact_radius(*radii)
        modulus = contact_modulus(youngs[0], POISSON, youngs[1], POISSON)
        points = contact.run['VTKHDF/Points'][:, :2]
        edges = lower_sides(contact.run, radii[1]) if below else upper_sides(contact.run, radii[0])
        nodes = np.unique(edges)
        nodes = nodes[np.argsort(points[nodes, 0])]
        number = {p: i for i, p in enumerate(nodes)}
        edges = [[number[p] for p in edge] for edge in edges]
        self.x = points[nodes, 0]
        forces = np.abs(contact.frames('CF')[-1, nodes, 1])
        # half of the contact is in the mesh
        force = 2 * abs(contact.force[-1, 1])
        self.width, self.peak = hertz_line(force, radius, modulus)
        self.exact = hertz_pressure(self.x, force, radius, modulus)
        self.recovered = pressure_of_forces(points[nodes], edges, forces)
        self.written = contact.frames('CPRESS')[-1, nodes].reshape(-1)
        self.touching = forces > 1e-12 * forces.max()
        self.spacing = self.x[1] - self.x[0]

    def figures(self, pressure):
        """Error of the peak, and root mean square over 0.9 and 1.2 of the half-width."""
        errors = (pressure - self.exact) / self.peak
        return (pressure.max() / self.peak - 1,
                *(np.sqrt(np.mean(errors[self.x < part * self.width]**2)) for part in (0.9, 1.2)))


def upper_sides(run, radius):
    """The low sides of the upper disc."""
    points = run['VTKHDF/Points'][:, :2]
    return sides(run, (np.abs(np.hypot(points[:, 0], points[:, 1] - radius) / radius - 1) < 1e-6)
                 & (points[:, 1] >= 0))


def lower_sides(run, radius):
    """The high sides of the lower disc; its node at the contact is the last with this place."""
    points = run['VTKHDF/Points'][:, :2]
    on = (np.abs(np.hypot(points[:, 0], points[:, 1] + radius) / radius - 1) < 1e-6) \
        & (points[:, 1] <= 0)
    on[np.flatnonzero(np.abs(points).max(axis=1) < 1e-12)[0]] = False
    return sides(run, on)


def sides(run, on):
    """Sides of elements with all points chosen: points with the middle one last."""
    ring = run['VTKHDF/Connectivity'].reshape(-1, 8)
    return np.array([edge for element in ring for i in range(4)
                     if on[edge := element[[i, (i + 1) % 4, 4 + i]]].all()])


def check(checks, name, deck, radii, youngs, rms, below=False):
    hertz = Hertz(deck, radii, youngs, below)
    for what, pressure in (('consistent', hertz.recovered), ('written', hertz.written)):
        peak, inner, whole = hertz.figures(pressure)
        print(f'        {name}, {what} pressure: peak {peak:+.3%}, rms {inner:.3%} (0.9 a), '
              f'{whole:.3%} (1.2 a); last node in touch at {hertz.x[hertz.touching].max():.5g}, '
              f'half-width {hertz.width:.5g}, nodes {hertz.spacing:.5g} apart')
        if rms is None:
            continue
        checks.at_most(abs(peak), 5e-3, f'{name}, {what} pressure: error of the peak')
        checks.at_most(inner, rms, f'{name}, {what} pressure: root mean square to 0.9 a')
    if rms is not None:
        checks.close(hertz.x[hertz.touching].max(), hertz.width, hertz.spacing,
                     f'{name}: half-width within one node')
    return hertz


checks = Checks()
folder.check(checks)
check(checks, 'disc on plane', 'disc_on_plane.inp', (1, np.inf), (1000, np.inf), 1e-2)
check(checks, 'matching discs', 'matching.inp', (1, 1), (1000, 1000), 1e-2)
check(checks, 'nonmatching discs, weighted rows', 'nonmatching.inp', (1, 3), (1000, 10000), 1e-2)
check(checks, 'nonmatching discs, node rows', 'nonmatching_nodes.inp', (1, 3), (1000, 10000), None)
check(checks, 'nonmatching discs, node rows, coarse slave', 'nonmatching_swapped.inp', (1, 3),
      (1000, 10000), None, below=True)
checks.finish()
