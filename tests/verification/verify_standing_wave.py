"""Orders of convergence in motion: a standing P-wave in a block, exact in space and time.

u = cos(pi x / L) cos(w t) along x, nothing along y (held): the ends are free of stress. The meshes
are distorted; the step is so small that the error is that of the elements.
"""
import numpy as np

from carom_case import Checks, run_deck
from solid_mesh import Mesh, integrate, last_frame, material, step

E, NU, RHO, STEPS = 7.0, 0.3, 2.0, 400
LAMBDA, MU = E * NU / (1 + NU) / (1 - 2 * NU), E / (2 + 2 * NU)
PLANE_STRAIN, PLANE_STRESS = LAMBDA + 2 * MU, E / (1 - NU**2)
SHAPES = ('CPE3', 'CPS4', 'CPE4', 'CPS6', 'CPE6', 'CPS8', 'CPE8', 'CPE8R')


def place(s, t):
    return s + 0.06 * np.sin(np.pi * s) * np.sin(np.pi * t), 0.7 * t + 0.05 * np.sin(
        2 * np.pi * s) * np.sin(np.pi * t)


def error_of(kind, n, lumped):
    """L2 error after 0.3 periods, and the balance error of the energy."""
    shape = int(kind[3])
    omega = np.pi * np.sqrt((PLANE_STRAIN if kind[2] == 'E' else PLANE_STRESS) / RHO)
    end = 0.3 * 2 * np.pi / omega
    mesh = Mesh(n, n, shape, place)
    group = '*ELEMENT GROUP, ELSET=solid, SCHEME=IMPLICIT, MASS=LUMPED\n' if lumped else ''
    start = np.cos(np.pi * mesh.x[:, 0])
    cards = ''.join(f'{p + 1}, 1, {float(value)!r}\n' for p, value in enumerate(start))
    held = ''.join(f'{p + 1}, 2\n' for p in range(len(start)))
    text = (mesh.text(kind) + material(E, NU, RHO) + group + '*BOUNDARY\n' + held
            + '*INITIAL CONDITIONS, TYPE=DISPLACEMENT\n' + cards
            + step('DYNAMIC, DIRECT', f'{float(end / STEPS)!r}, {float(end)!r}', '',
                   f'*NODE FILE, FREQUENCY={STEPS}\nU\n*ENERGY PRINT\n'))
    run = run_deck(text)
    u = last_frame(run, 'U')[:, :2]
    sums = np.zeros(2)

    def measure(ring, values, slopes, point, area):
        right = np.cos(np.pi * point[0])
        sums[:] += area * np.array([(values @ u[ring, 0] - right * np.cos(omega * end))**2,
                                    right**2])

    integrate(mesh, measure, 3 if shape <= 4 else 4)
    balance = np.max(np.abs(run['energy/balance_error'])) / run['energy/total'][0]
    return np.sqrt(sums[0] / sums[1]), balance


checks = Checks()
for kind in SHAPES:
    linear = int(kind[3]) <= 4
    for lumped in (False, True) if linear else (False,):
        pairs = [error_of(kind, n, lumped) for n in ((8, 16, 32) if linear else (4, 8, 16))]
        errors, balances = zip(*pairs)
        order = np.log2(errors[-2] / errors[-1])
        name = kind + (' lumped' if lumped else '')
        checks.at_least(order, 1.95 if linear else 2.9,
                        f'{name} in motion: order of the L2 error {errors[-1]:.2g}')
        checks.at_most(max(balances), 1e-10, f'{name} in motion: energy balance error')
checks.finish()
