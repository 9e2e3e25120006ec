"""A cantilever of CPS8: deflection of the tip, frequencies against the beam of Timoshenko."""
import numpy as np

from carom_case import INPUT, Checks, run_deck
from solid_mesh import Mesh, kept, last_frame

E, NU, RHO, LENGTH, HEIGHT, FORCE = 210e9, 0.3, 7800.0, 1.0, 0.1, 1000.0
SHEAR = E / (2 + 2 * NU)
KAPPA = 10 * (1 + NU) / (12 + 11 * NU)


def frequencies(n):
    """The first n frequencies of the clamped-free beam of Timoshenko: zeros of the determinant of
    the end conditions, from the first order equations y' = A(omega) y of w, psi, M, Q."""
    area, inertia = HEIGHT, HEIGHT**3 / 12

    def determinant(omega):
        # w' = psi + Q/(kappa G A), psi' = M/(E I), M' = -Q - rho I w^2 psi, Q' = -rho A w^2 w
        matrix = np.zeros((4, 4))
        matrix[0, 1], matrix[0, 3] = 1, 1 / (KAPPA * SHEAR * area)
        matrix[1, 2] = 1 / (E * inertia)
        matrix[2, 3], matrix[2, 1] = -1, -RHO * inertia * omega**2
        matrix[3, 0] = -RHO * area * omega**2
        # scaled so that all four are of the size of w
        scale = np.array([1, 1, 1 / (E * inertia), 1 / (E * inertia)])
        values, vectors = np.linalg.eig(scale[:, None] * matrix / scale[None, :])
        transfer = ((vectors * np.exp(values * LENGTH)) @ np.linalg.inv(vectors)).real
        return np.linalg.det(transfer[2:, 2:])

    found, step = [], 2.0
    omega, left = step, determinant(step)
    while len(found) < n:
        right = determinant(omega + step)
        if left * right < 0:
            a, b = omega, omega + step
            for _ in range(60):
                middle = 0.5 * (a + b)
                if determinant(middle) * left > 0:
                    a = middle
                else:
                    b = middle
            found.append(0.5 * (a + b) / (2 * np.pi))
        omega, left = omega + step, right
    return np.array(found)


def deck():
    """20 x 2 CPS8, clamped at x = 0; the shear force along the tip as a parabola."""
    mesh = Mesh(20, 2, 8, lambda s, t: (LENGTH * s, HEIGHT * (t - 0.5)))
    tip = mesh.at(s=1)
    y = mesh.x[tip, 1]
    load = np.zeros(5)
    for e in (0, 2):
        for s, w in zip(*np.polynomial.legendre.leggauss(4)):
            n = np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2])
            load[e:e + 3] += 0.25 * HEIGHT * w * n * 1.5 / HEIGHT * (
                1 - (2 * (n @ y[e:e + 3]) / HEIGHT)**2)
    lines = ''.join(f'{p + 1}, 2, {float(-FORCE * q)!r}\n' for p, q in zip(tip, load))
    root = ''.join(f'{p + 1}\n' for p in mesh.at(s=0))
    return mesh, f"""*HEADING
Cantilever of steel, 20 x 2 CPS8: a force at the tip
** length {LENGTH}, height {HEIGHT}, thickness 1; tests/verification/verify_cantilever.py writes this deck
{mesh.text('CPS8')}*NSET, NSET=root
{root}*MATERIAL, NAME=steel
*ELASTIC
210e9, {NU!r}
*DENSITY
{RHO!r}
*SOLID SECTION, ELSET=solid, MATERIAL=steel
1
*BOUNDARY
root, 1, 2
*STEP, NAME=force
*STATIC, DIRECT
1, 1
*CLOAD
{lines}*NODE FILE
U
*EL FILE
S
*NODE PRINT
U
*ENERGY PRINT
*END STEP
"""


MODES = '*STEP\n*FREQUENCY\n4\n*NODE FILE\nU\n*END STEP\n'

checks = Checks()
mesh, text = deck()
path = kept(checks, INPUT / 'cantilever' / 'cantilever.inp', text)
run = run_deck(path)
inertia = HEIGHT**3 / 12
exact = FORCE * LENGTH**3 / (3 * E * inertia) + FORCE * LENGTH / (KAPPA * SHEAR * HEIGHT)
middle = mesh.at(s=1)[2]
tip = -run[f'history/node_{middle + 1}/U2'][-1]
checks.at_most(abs(tip / exact - 1), 5e-3, f'tip deflection {tip:.6g} against {exact:.6g}')
checks.close(run['energy/strain'][-1], run['energy/external_work'][-1],
             1e-10 * run['energy/external_work'][-1], 'strain energy is the work of the force')
top = mesh.at(t=1)
quarter = [p for p in top if abs(mesh.x[p, 0] - 0.5) < 1e-9][0]
bending = FORCE * 0.5 * (HEIGHT / 2) / inertia
checks.at_most(abs(last_frame(run, 'S')[quarter, 0] / bending - 1), 2e-3,
               f'bending stress at half of the length against {bending:.6g}')

modes = text[:text.index('*STEP')].replace('a force at the tip', 'four modes of vibration') + MODES
run = run_deck(kept(checks, INPUT / 'cantilever' / 'modes.inp', modes))
beam = frequencies(3)
found = run['frequency/frequency']
# the fourth is the second along the axis or the fourth of bending; three of bending are wanted
shapes = run['VTKHDF/PointData/U'].reshape(-1, len(mesh.x), 3)[-4:]
bends = [k for k in range(4) if np.abs(shapes[k, :, 1]).max() > np.abs(shapes[k, :, 0]).max()]
for i, k in enumerate(bends[:3]):
    checks.at_most(abs(found[k] / beam[i] - 1), 1e-2,
                   f'frequency {i + 1} of bending {found[k]:.6g} against {beam[i]:.6g}')
checks.true(len(run['VTKHDF/Steps/Values']) >= 4, f'{len(run["VTKHDF/Steps/Values"])} frames')
checks.close(run['VTKHDF/Steps/Values'][-4:], found, 1e-9 * found[-1],
             'frames stand at their frequencies')
axial = [k for k in range(4) if k not in bends]
if axial:
    rod = np.sqrt(E / RHO) / (4 * LENGTH)
    checks.at_most(abs(found[axial[0]] / rod - 1), 1e-2,
                   f'frequency along the axis {found[axial[0]]:.6g} against {rod:.6g}')
line = mesh.at(t=0.5)
signs = [int(np.sum(np.diff(np.sign(shapes[k, line[1:], 1])) != 0)) for k in bends[:3]]
checks.true(signs == [0, 1, 2], f'nodes of the bending modes: {signs}')
masses = run['frequency/effective_mass']
checks.true(masses.min() >= 0, f'effective masses {masses.shape}')
checks.at_most(float(np.max(run['frequency/residual'])), 1e-8, 'residuals of the modes')

# behind a static step with frames, up to the third frequency
both = text.replace('*NODE FILE\nU\n', '*NODE FILE\nU, RF\n') + MODES.replace(
    '\n4\n', f'\n4, 0, {1.0001 * found[2]:.6g}\n')
run = run_deck(both)
checks.close(run['frequency/frequency'], found[:3], 1e-9 * found[2], 'modes up to a frequency')
checks.true(len(run['VTKHDF/PointData/U']) == 3 * len(mesh.x), 'a frame for each mode, no other')
checks.true('RF' not in run.file['VTKHDF/PointData'], 'no field of the static step in them')
checks.true('with a *FREQUENCY step all frames are modes' in run.path.with_suffix('.log').read_text(),
            'a warning that the static step has no frames')
run = run_deck(modes.replace('\n4\n', f'\n4, 0, {0.5 * found[0]:.6g}\n'), expect_status=4)
checks.true('the lowest frequency' in run.text and 'is above the highest' in run.text,
            'no mode up to a frequency is an error')
checks.finish()
