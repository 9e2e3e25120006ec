"""A pressure wave in a strip whose sides are held: arrival, speed, and the blow on a rigid wall."""
import numpy as np

from carom_case import INPUT, Checks, run_deck
from solid_mesh import Mesh, kept, material, node_set

E, RHO, LENGTH, HEIGHT = 4.0, 1.0, 1.0, 0.05


def speed(nu):
    """Of pressure waves with held sides."""
    return float(np.sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / RHO))


def strip(n, nu, model, procedure, line, cards='', title='Strip', prints='', kind='CPE4', rows=1):
    mesh = Mesh(n, rows, int(kind[3]), lambda s, t: (LENGTH * s, HEIGHT * t))
    return mesh, f"""*HEADING
{title}
{mesh.text(kind)}{node_set('all', range(len(mesh.x)))}{material(E, nu, RHO)}*BOUNDARY
all, 2
{model}*STEP, INC=10000000
*{procedure}
{line}
{cards}{prints}*END STEP
"""


def check_speed(checks):
    """A standing wave of free ends, cos(pi m x/L), 20 elements to the wavelength: its frequency gives
    the phase speed; a packet of such waves gives the group speed."""
    for nu in (0.0, 0.3):
        c = speed(nu)
        for name, procedure, part, group in (
                ('implicit', 'DYNAMIC, DIRECT', 0.5, ''),
                ('explicit', 'DYNAMIC, DIRECT, EXPLICIT', 0.5, ''),
                ('implicit, lumped', 'DYNAMIC, DIRECT', 0.5,
                 '*ELEMENT GROUP, ELSET=solid, SCHEME=IMPLICIT, MASS=LUMPED\n')):
            n, m = 40, 4
            x = np.linspace(0, LENGTH, n + 1)
            start = '*INITIAL CONDITIONS, TYPE=DISPLACEMENT\n' + ''.join(
                f'{p + 1 + row * (n + 1)}, 1, {float(1e-3 * np.cos(m * np.pi * x[p]))!r}\n'
                for row in (0, 1) for p in range(n + 1))
            h = part * LENGTH / n / c
            steps = 400
            text = strip(n, nu, group + start, procedure, f'{h!r}, {steps * h!r}',
                         prints='*NODE PRINT\nU\n*ENERGY PRINT\n')[1]
            run = run_deck(text)
            t, u = run['history/time'], run['history/node_1/U1']
            # frequency from the angle between first and last zero
            zeros = np.flatnonzero(u[1:] * u[:-1] < 0)
            at = t[zeros] - u[zeros] * (t[zeros + 1] - t[zeros]) / (u[zeros + 1] - u[zeros])
            omega = np.pi * (len(at) - 1) / (at[-1] - at[0])
            phase = omega / (m * np.pi / LENGTH)
            checks.at_most(abs(phase / c - 1), 0.02,
                           f'{name}, nu = {nu}: phase speed {phase:.6g} against {c:.6g}')
            # the trapezoidal rule keeps the energy; central differences let it swing
            limit = 1.02 * (omega * h)**2 / 4 if name == 'explicit' else 1e-12
            checks.at_most(np.max(np.abs(run['energy/balance_error'])) / np.max(run['energy/total']),
                           limit, f'{name}, nu = {nu}: balance error')
            # a packet exp(-(x/w)^2) cos(k x) going right; 20 elements to its wavelength
            n, wave = 200, 0.1
            x = np.linspace(0, LENGTH, n + 1)
            k, w, x0 = 2 * np.pi / wave, 0.09, 0.3

            def shape(s):
                return 1e-3 * np.exp(-(s / w)**2) * np.cos(k * s)

            def slope(s):
                return 1e-3 * np.exp(-(s / w)**2) * (-2 * s / w**2 * np.cos(k * s)
                                                     - k * np.sin(k * s))

            # by frames of velocity and displacement: start by u(x), v = -c u'(x)
            start = ''.join(f'*INITIAL CONDITIONS, TYPE={kind}\n' + ''.join(
                f'{p + 1 + row * (n + 1)}, 1, {float(values[p])!r}\n'
                for row in (0, 1) for p in range(n + 1) if abs(values[p]) > 1e-12)
                for kind, values in (('DISPLACEMENT', shape(x - x0)),
                                     ('VELOCITY', -c * slope(x - x0))))
            h = part * LENGTH / n / c
            steps = 160
            text = strip(n, nu, group + start, procedure, f'{h!r}, {steps * h!r}',
                         prints=f'*NODE FILE, FREQUENCY={steps}\nU\n*ENERGY PRINT\n')[1]
            run = run_deck(text)
            u = run['VTKHDF/PointData/U'].reshape(-1, 2 * (n + 1), 3)[-1, :n + 1, 0]
            centre = np.sum(x * u**2) / np.sum(u**2)
            group_speed = (centre - x0) / (steps * h)
            checks.at_most(abs(group_speed / c - 1), 0.02,
                           f'{name}, nu = {nu}: group speed {group_speed:.6g} against {c:.6g}')


def check_arrival(checks):
    """A pressure comes on at the left end at once; behind the front the speed is p/(rho c). The front
    is where half of it has been reached."""
    for nu in (0.0, 0.3):
        c = speed(nu)
        for name, procedure, part in (('implicit', 'DYNAMIC, DIRECT', 0.5),
                                      ('explicit', 'DYNAMIC, DIRECT, EXPLICIT', 0.9)):
            n = 400
            h = part * LENGTH / n / c
            mesh, text = strip(n, nu, '*NSET, NSET=seen\n101\n201\n301\n', procedure,
                               f'{h!r}, {float(0.9 * LENGTH / c)!r}', '*DLOAD\n1, P4, 0.01\n',
                               prints='*NODE PRINT, NSET=seen\nU, V\n*ENERGY PRINT\n')
            run = run_deck(text)
            t = run['history/time']
            v = 0.01 / (RHO * c)
            worst = 0.0
            for node in (101, 201, 301):
                seen = run[f'history/node_{node}/V1']
                i = int(np.argmax(seen > 0.5 * v))
                at = t[i] - (seen[i] - 0.5 * v) / (seen[i] - seen[i - 1]) * h
                worst = max(worst, abs(at * c / mesh.x[node - 1, 0] - 1))
            checks.at_most(worst, 0.02, f'{name}, nu = {nu}: arrival of the front')
            u = run['history/node_101/U1'][-1]
            checks.at_most(abs(u / (v * (t[-1] - 0.25 * LENGTH / c)) - 1), 0.02,
                           f'{name}, nu = {nu}: displacement behind the front')


def check_blow(checks):
    """The strip flies against a wall at its left end: force rho c v A, for 2 L/c."""
    v = 0.01
    for nu in (0.0, 0.3):
        c = speed(nu)
        for name, procedure, part in (('implicit', 'DYNAMIC, DIRECT', 0.5),
                                      ('explicit', 'DYNAMIC, DIRECT, EXPLICIT', 0.5)):
            n = 200
            h = part * LENGTH / n / c
            gap = 1e-4
            model = f"""*SURFACE, NAME=front, TYPE=NODE
1
{n + 2}
*RIGID SURFACE, NAME=wall, TYPE=PLANE
{-gap!r}, 0, 0
1, 0, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, METHOD=TRANSFORMATION
*CONTACT PAIR, INTERACTION=hit
front, wall
*INITIAL CONDITIONS, TYPE=VELOCITY
all, 1, {-v!r}
"""
            hit = gap / v
            end = float(hit + 3.0 * LENGTH / c)
            title = f'A strip of {n} CPE4, nu = {nu}, hits a wall: {name}'
            mesh, text = strip(n, nu, model, procedure, f'{h!r}, {end!r}', title=title,
                               prints='*CONTACT PRINT\nCF, CDIS\n*NODE PRINT, NSET=ends\nU, V\n'
                                      '*NODE FILE, FREQUENCY=40\nU, V\n*EL FILE, FREQUENCY=40\nS\n'
                                      '*ENERGY PRINT\n')
            text = text.replace('*BOUNDARY\nall', f'*NSET, NSET=ends\n1, {n + 1}\n*BOUNDARY\nall', 1)
            deck = INPUT / 'strip' / f'{name}.inp'
            run = run_deck(kept(checks, deck, text) if nu > 0 else text)
            t, impulse = run['history/time'], run['history/contact_FRONT-WALL/impulse']
            force = run['history/contact_FRONT-WALL/CF1']
            exact = RHO * c * v * HEIGHT
            plateau = (t > hit + 0.2 * LENGTH / c) & (t < hit + 1.8 * LENGTH / c)
            mean = np.mean(force[plateau])
            checks.at_most(abs(mean / exact - 1), 5e-3,
                           f'{name}, nu = {nu}: mean force {mean:.6g} against {exact:.6g}')
            energy = 0.5 * RHO * v * v * LENGTH * HEIGHT
            print(f'        force from {force[plateau].min():.6g} to {force[plateau].max():.6g}, '
                  f'impulse {np.sum(impulse):.6g}, impact loss '
                  f'{run["energy/impact_loss"][-1] / energy:.3g} of the energy')
            checks.at_most(np.max(np.abs(run['energy/balance_error'])) / energy,
                           1e-3 if name == 'explicit' else 1e-12,
                           f'{name}, nu = {nu}: balance error of the blow')
            total = run['energy/total'][-1]
            # the end nodes stop at once: their share of the mass, 1/(2 n), is lost when lumped
            checks.at_most(abs(total / energy - 1), 3e-3, f'{name}, nu = {nu}: energy kept')
            gone = np.flatnonzero(force > 0)[-1]
            checks.at_most(abs((t[gone] - hit) * c / (2 * LENGTH) - 1), 0.02,
                           f'{name}, nu = {nu}: contact lasts 2 L/c')


checks = Checks()
check_speed(checks)
check_arrival(checks)
check_blow(checks)
checks.finish()
