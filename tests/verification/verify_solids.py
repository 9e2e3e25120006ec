"""Plane and axisymmetric solids at rest: patch tests, orders of convergence, loads."""
import numpy as np

from carom_case import Checks, run_deck
from solid_mesh import Mesh, integrate, last_frame, material, step

PLANES = ('CPE', 'CPS', 'CAX')
SHAPES = ('3', '4', '6', '8', '4R', '8R')
E, NU = 7.0, 0.3


def stress(plane, strain):
    """Stress 11 22 33 12 of strains 11 22 33 12, rows over points."""
    exx, eyy, ezz, gxy = strain
    if plane == 'CPS':
        c = E / (1 - NU**2)
        return c * (exx + NU * eyy), c * (eyy + NU * exx), 0 * exx, E / (2 + 2 * NU) * gxy
    lam, mu = E * NU / (1 + NU) / (1 - 2 * NU), E / (2 + 2 * NU)
    trace = exx + eyy + ezz
    return lam * trace + 2 * mu * exx, lam * trace + 2 * mu * eyy, lam * trace + 2 * mu * ezz, mu * gxy


def conditions(points, values):
    values = values.tolist()
    return '*BOUNDARY\n' + ''.join(f'{p + 1}, {d + 1}, {d + 1}, {values[p][d]!r}\n'
                                   for p in points.tolist() for d in (0, 1))


def solve(kind, mesh, cards, section='', prints='*NODE FILE\nU\n*EL FILE\nS, E\n', density=1.0):
    """One static increment."""
    return run_deck(mesh.text(kind) + material(E, NU, density, section=section)
                    + step('STATIC, DIRECT', '1, 1', cards, prints))


def check_patch(checks):
    """3 x 3 elements, the inner nodes moved; the rim displaced as a linear field demands. Around an
    axis only u_r = a r, u_z = c z has constant stresses."""
    def place(s, t):
        inner = 16.0 * s * (1 - s) * t * (1 - t)
        return 1 + s + inner * 0.13 * np.sin(7 * s + 3 * t), t + inner * 0.12 * np.cos(5 * s - 4 * t)

    for plane in PLANES:
        for shape in SHAPES:
            mesh = Mesh(3, 3, int(shape[0]), place, straight=True)
            x, y = mesh.x.T
            if plane == 'CAX':
                exact, strain = np.stack((2e-3 * x, -3e-3 * y), axis=1), (2e-3, -3e-3, 2e-3, 0.0)
            else:
                exact = np.stack((1e-3 + 2e-3 * x + 1e-3 * y, 3e-3 * x - 1.5e-3 * y), axis=1)
                strain = (2e-3, -1.5e-3, 0.0, 4e-3)
            run = solve(plane + shape, mesh, conditions(mesh.rim(), exact))
            wrong = np.max(np.abs(last_frame(run, 'U')[:, :2] - exact)) / np.max(np.abs(exact))
            s = np.zeros(6)
            s[:4] = stress(plane, strain)
            for where in ('PointData', 'CellData'):
                wrong = max(wrong, np.max(np.abs(last_frame(run, 'S', where) - s))
                            / np.max(np.abs(s)))
            checks.at_most(wrong, 1e-12, f'patch test {plane + shape}: displacement and stress')


def wave(plane, x, y):
    """A smooth field and its strains."""
    u = np.stack((1e-2 * np.sin(2 * x + y), 1e-2 * np.cos(x - 2 * y)), axis=-1)
    exx, eyy = 2e-2 * np.cos(2 * x + y), 2e-2 * np.sin(x - 2 * y)
    gxy = 1e-2 * np.cos(2 * x + y) - 1e-2 * np.sin(x - 2 * y)
    hoop = u[..., 0] / x if plane == 'CAX' else 0 * x
    return u, (exx, eyy, hoop, gxy)


def check_orders(checks):
    """The rim moves as a smooth field, inner nodes carry the loads of its stresses: integrals of the
    stress over the gradients of the shape functions. Error in the L2 norm over three meshes."""
    def place(s, t):
        return 1 + s + 0.1 * np.sin(np.pi * s) * np.sin(np.pi * t), t + 0.1 * np.sin(
            2 * np.pi * s) * np.sin(np.pi * t)

    for plane in PLANES:
        for shape in SHAPES:
            linear = int(shape[0]) <= 4
            sizes = (6, 12, 24) if linear else (4, 8, 16) if shape == '6' else (3, 6, 12)
            errors = []
            for n in sizes:
                mesh = Mesh(n, n, int(shape[0]), place)
                load = np.zeros_like(mesh.x)

                def add(ring, values, slopes, point, area):
                    around = 2 * np.pi * point[0] if plane == 'CAX' else 1.0
                    sxx, syy, szz, sxy = stress(plane, wave(plane, *point)[1])
                    load[ring, 0] += area * around * (slopes[0] * sxx + slopes[1] * sxy)
                    load[ring, 1] += area * around * (slopes[0] * sxy + slopes[1] * syy)
                    if plane == 'CAX':
                        load[ring, 0] += area * around * values * szz / point[0]

                integrate(mesh, add, 3 if linear else 4)
                exact = wave(plane, *mesh.x.T)[0]
                rim = mesh.rim()
                inner = np.setdiff1d(np.arange(len(mesh.x)), rim).tolist()
                cards = conditions(rim, exact) + '*CLOAD\n' + ''.join(
                    f'{p + 1}, {d + 1}, {float(load[p, d])!r}\n' for p in inner for d in (0, 1))
                u = last_frame(solve(plane + shape, mesh, cards, prints='*NODE FILE\nU\n'),
                               'U')[:, :2]
                sums = np.zeros(2)

                def measure(ring, values, slopes, point, area):
                    right = wave(plane, *point)[0]
                    sums[:] += area * np.array([np.sum((values @ u[ring] - right)**2),
                                                np.sum(right**2)])

                integrate(mesh, measure, 3 if linear else 4)
                errors.append(np.sqrt(sums[0] / sums[1]))
            order = np.log2(errors[-2] / errors[-1])
            checks.at_least(order, 1.95 if linear else 2.9,
                            f'{plane + shape}: order of the L2 error {errors[-1]:.2g}')


def held(mesh, points, freedoms=(1, 2)):
    return '*BOUNDARY\n' + ''.join(f'{p + 1}, {d}\n' for p in points.tolist() for d in freedoms)


REACTIONS = '*NODE PRINT\nRF\n'


def reactions(run, mesh):
    """Sums of the last reactions along x and y."""
    names = [f'history/node_{p + 1}' for p in range(len(mesh.x))]
    return np.array([sum(run[f'{name}/RF{d}'][-1] for name in names) for d in (1, 2)])


def check_loads(checks):
    """Resultants of gravity, body force, pressure and rotation, curved edges included."""
    def place(s, t):
        return 1 + s + 0.2 * t * s, t * (1 + 0.3 * s) + 0.1 * np.sin(np.pi * s)

    for plane in PLANES:
        for shape in SHAPES:
            mesh = Mesh(3, 2, int(shape[0]), place)
            sums = np.zeros(3)

            def add(ring, values, slopes, point, area):
                around = 2 * np.pi * point[0] if plane == 'CAX' else 1.0
                sums[:] += area * around * np.array([1.0, *point])

            integrate(mesh, add)
            name, grounded = plane + shape, held(mesh, mesh.at(t=0))
            thickness = None if plane == 'CAX' else 0.5
            volume = sums[0] * (thickness or 1.0)
            model = mesh.text(name) + material(E, NU, 2.5, thickness)

            def total_reaction(load):
                return reactions(run_deck(model + step('STATIC, DIRECT', '1, 1', grounded
                                                       + '*DLOAD\n' + load, REACTIONS)), mesh)

            wrong = abs(total_reaction('solid, GRAV, 9.81, 0, -1, 0\n')[1]
                        / (9.81 * 2.5 * volume) - 1)
            wrong = max(wrong, abs(total_reaction('solid, BY, 3\n')[1] / (-3 * volume) - 1))
            # pressure on the curved top
            top = [e + 1 for e, ring in enumerate(mesh.elements)
                   if np.count_nonzero(np.isclose(mesh.st[ring, 1], 1)) >= 2]
            corners = 3 if shape[0] in '36' else 4
            lines, force = '', np.zeros(2)
            for e in top:
                ring = mesh.elements[e - 1]
                for k in range(corners):
                    a, b = ring[k], ring[(k + 1) % corners]
                    if not (np.isclose(mesh.st[a, 1], 1) and np.isclose(mesh.st[b, 1], 1)):
                        continue
                    lines += f'{e}, P{k + 1}, 4\n'
                    way = [mesh.x[a], mesh.x[b]] + ([mesh.x[ring[corners + k]]]
                                                    if len(ring) > 4 else [])
                    for s, w in zip(*np.polynomial.legendre.leggauss(5)):
                        n = [(1 - s) / 2, (1 + s) / 2] if len(way) == 2 else [
                            s * (s - 1) / 2, s * (s + 1) / 2, 1 - s * s]
                        dn = [-0.5, 0.5] if len(way) == 2 else [s - 0.5, s + 0.5, -2 * s]
                        along, r = np.dot(dn, way), np.dot(n, way)[0]
                        around = 2 * np.pi * r if plane == 'CAX' else 0.5
                        force += 4 * w * around * np.array([-along[1], along[0]])
            total = total_reaction(lines)
            if plane == 'CAX':
                wrong = max(wrong, abs(total[1] / force[1] + 1))
            else:
                wrong = max(wrong, np.max(np.abs(total + force)) / np.max(np.abs(force)))
                pull = 9 * 2.5 * thickness * (sums[1:] - sums[0] * np.array([-1.0, 0.5]))
                total = total_reaction('solid, CENTRIF, 9, -1, 0.5, 0, 0, 0, 1\n')
                wrong = max(wrong, np.max(np.abs(total + pull)) / np.max(np.abs(pull)))
            checks.at_most(wrong, 1e-12, f'{name}: resultants of gravity, BY, pressure, rotation')


def check_disc(checks):
    """A thin annulus turns about its axis; its faces are free."""
    a, b, rho, omega2 = 0.5, 2.0, 3.0, 4.0
    for shape in ('4', '8', '8R', '6'):
        n = 24 if shape[0] == '4' else 12
        mesh = Mesh(n, 1, int(shape[0]), lambda s, t: (a + (b - a) * s, 1e-3 * t))
        run = run_deck(mesh.text('CAX' + shape) + material(E, NU, rho) + step(
            'STATIC, DIRECT', '1, 1', held(mesh, mesh.at(s=0)[:1], (2,))
            + f'*DLOAD\nsolid, CENTRIF, {omega2!r}, 0, 0, 0, 0, 1, 0\n'))
        u = last_frame(run, 'U')[mesh.at(t=0), 0]
        r = mesh.x[mesh.at(t=0), 0]
        c = rho * omega2 * (3 + NU) / 8
        sr = c * (a * a + b * b - a * a * b * b / r**2 - r**2)
        st = c * (a * a + b * b + a * a * b * b / r**2 - (1 + 3 * NU) / (3 + NU) * r**2)
        exact = r / E * (st - NU * sr)
        checks.at_most(np.max(np.abs(u - exact)) / np.max(exact), 3e-3 if shape == '4' else 2e-4,
                       f'rotating thin annulus, {n} CAX{shape}: displacement')


checks = Checks()
check_patch(checks)
check_orders(checks)
check_loads(checks)
check_disc(checks)
checks.finish()
