"""One element pulled to and fro beyond yield: the exact uniaxial curve, energies, increments."""
import numpy as np

from carom_case import Checks, run_deck
from solid_mesh import Mesh, material, step

E, NU, YIELD, HARDENING = 200e3, 0.3, 250.0, 4000.0
PATH = np.array([0.0, 0.004, -0.003, 0.005, 0.0046, -0.001])
PLASTIC = f'*PLASTIC, HARDENING={{}}\n{YIELD!r}, 0\n{YIELD + HARDENING!r}, 1\n'


def uniaxial(strain, kinematic):
    """Stress, plastic strain and dissipated energy (trapezoids over the sorted path) at strains."""
    stress, plastic, back, size = 0.0, 0.0, 0.0, YIELD
    rows = [(0.0, 0.0, 0.0)]
    work = 0.0
    for e in strain[1:]:
        old = stress
        trial = E * (e - plastic) - back
        over = abs(trial) - size
        if over > 0:
            growth = over / (E + HARDENING) * np.sign(trial)
            plastic += growth
            if kinematic:
                back += HARDENING * growth
            else:
                size += HARDENING * abs(growth)
        else:
            growth = 0.0
        stress = E * (e - plastic)
        work += 0.5 * (old + stress) * growth
        rows.append((stress, plastic, work))
    return np.array(rows).T


def deck(kind, law, per_piece, path=PATH):
    """The unit square, sides free; CPE would hold the thickness, so it is checked by itself. CAX4 is a
    cylinder pulled along its axis."""
    mesh = Mesh(1, 1, int(kind[3]))
    left, below, top = mesh.at(s=0), mesh.at(t=0), mesh.at(t=1)
    cards = '*BOUNDARY\n' + ''.join(f'{p + 1}, 2\n' for p in below) + ''.join(
        f'{p + 1}, 1\n' for p in left)
    times = ', '.join(f'{float(i)!r}, {a!r}' + ('\n' if i % 4 == 3 else '')
                      for i, a in enumerate(path.tolist())).replace('\n, ', '\n')
    amplitude = f'*AMPLITUDE, NAME=path\n{times}\n'
    motion = '*BOUNDARY, AMPLITUDE=path\n' + ''.join(f'{p + 1}, 2, 2, 1\n' for p in top)
    prints = '*NODE PRINT\nU, RF\n*EL PRINT\nS, E, PEEQ\n*ENERGY PRINT\n'
    n = len(path) - 1
    return mesh, (mesh.text(kind) + material(E, NU, more=PLASTIC.format(law)) + amplitude + cards
                  + step('STATIC, DIRECT', f'{1 / per_piece!r}, {n}', motion, prints))


def check_uniaxial(checks, kind, law):
    mesh, text = deck(kind, law, 40)
    run = run_deck(text)
    t = run['history/time']
    strain = np.interp(t, np.arange(len(PATH)), PATH)
    stress, plastic, work = uniaxial(strain, law == 'KINEMATIC')
    element = 'history/element_1/'
    checks.close(run[element + 'S22'], stress, 1e-8 * np.max(np.abs(stress)),
                 f'{kind}, {law}: stress over {len(t)} increments')
    peeq = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(plastic)))))
    checks.close(run[element + 'PEEQ'], peeq, 1e-8 * peeq[-1], f'{kind}, {law}: plastic strain')
    for name in ('S11', 'S33', 'S12'):
        checks.close(run[element + name], 0 * t, 1e-8 * YIELD, f'{kind}, {law}: {name} stays zero')
    unloading = (t >= 3) & (t <= 4)
    slope = np.diff(run[element + 'S22'][unloading]) / np.diff(strain[unloading])
    checks.close(slope, np.full(len(slope), E), 1e-7 * E, f'{kind}, {law}: unloading is elastic')
    volume = np.pi if kind.startswith('CAX') else 1.0
    checks.close(run['energy/plastic'], volume * work, 1e-8 * volume * work[-1],
                 f'{kind}, {law}: plastic energy')
    force = sum(run[f'history/node_{p + 1}/RF2'] for p in mesh.at(t=1))
    checks.close(force, volume * stress, 1e-8 * volume * np.max(np.abs(stress)),
                 f'{kind}, {law}: force')
    supplied = np.concatenate(([0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(strain))))
    checks.close(run['energy/external_work'], supplied, 1e-9 * supplied.max(),
                 f'{kind}, {law}: work of the force')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])) / np.max(supplied), 1e-9,
                   f'{kind}, {law}: balance error')


def check_loop(checks):
    """A closed loop, kinematic: after a first cycle the curve repeats itself, and the energy of a
    cycle is the area of the loop, 2 sigma_y times the width 2 (E delta - sigma_y)/(E + H) for an
    amplitude delta of the strain."""
    delta = 0.005
    path = np.array([0.0, delta, -delta, delta, -delta, delta])
    for kind in ('CPS4', 'CAX4', 'CPS8'):
        mesh, text = deck(kind, 'KINEMATIC', 400, path)
        run = run_deck(text)
        volume = np.pi if kind.startswith('CAX') else 1.0
        at = [int(np.argmin(np.abs(run['history/time'] - k))) for k in (1, 3, 5)]
        plastic = run['energy/plastic'][at] / volume
        stress, strain = run['history/element_1/S22'], run['history/element_1/E22']
        loop = slice(at[1], at[2] + 1)
        area = np.sum(0.5 * (stress[loop][1:] + stress[loop][:-1]) * np.diff(strain[loop]))
        checks.at_most(abs((plastic[2] - plastic[1]) / area - 1), 1e-8,
                       f'{kind}: plastic energy of a cycle against the area of the loop')
        reach = 2 * delta * E - 2 * YIELD
        exact = 2 * YIELD * reach / (E + HARDENING)
        checks.at_most(abs(area / exact - 1), 1e-4,
                       f'{kind}: area of the loop {area:.6g} against {exact:.6g}')
        checks.at_most(abs(stress[at[1]] - stress[at[2]]), 1e-8 * YIELD, f'{kind}: the loop is closed')


def check_strain(checks):
    """CPE4 with its sides free: plane strain tension. Incompressible flow far beyond yield without
    hardening reaches 2/sqrt(3) of the yield stress."""
    mesh = Mesh(1, 1, 4)
    top = mesh.at(t=1)
    cards = '*BOUNDARY\n' + ''.join(f'{p + 1}, 2\n' for p in mesh.at(t=0)) + ''.join(
        f'{p + 1}, 1\n' for p in mesh.at(s=0)) + ''.join(f'{p + 1}, 2, 2, 0.05\n' for p in top)
    text = (mesh.text('CPE4') + material(E, NU, more=f'*PLASTIC\n{YIELD!r}, 0\n')
            + step('STATIC, DIRECT', '0.005, 1', cards,
                   '*EL PRINT\nS, PEEQ\n*NODE PRINT\nRF\n*ENERGY PRINT\n'))
    run = run_deck(text)
    s = [run['history/element_1/' + name] for name in ('S11', 'S22', 'S33', 'S12')]
    mises = np.sqrt(s[0]**2 + s[1]**2 + s[2]**2 - s[0] * s[1] - s[1] * s[2] - s[2] * s[0]
                    + 3 * s[3]**2)
    first = int(0.2 * len(mises))
    checks.close(mises[first:], np.full(len(mises) - first, YIELD), 1e-9 * YIELD,
                 'CPE4: the stress stays on the yield surface')
    checks.at_most(abs(s[1][-1] / (2 * YIELD / np.sqrt(3)) - 1), 1e-6,
                   'CPE4: limit of tension in plane strain')
    checks.close(s[0], 0 * s[0], 1e-8 * YIELD, 'CPE4: sides free of stress')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])) / np.max(run['energy/external_work']),
                   1e-9, 'CPE4: balance error')
    counts = np.loadtxt(run.path.with_suffix('.sta'), ndmin=2)[:, 5]
    checks.at_most(counts.max(), 6, 'CPE4: iterations of an increment')


def check_rest(checks, kind):
    """Beyond yield in a static step, then at rest in a dynamic one: its accelerations are round-off."""
    mesh = Mesh(1, 1, 4)
    cards = ('*BOUNDARY\n' + ''.join(f'{p + 1}, 2\n' for p in mesh.at(t=0))
             + ''.join(f'{p + 1}, 1\n' for p in mesh.at(s=0)))
    pull = '*BOUNDARY\n' + ''.join(f'{p + 1}, 2, 2, 0.005\n' for p in mesh.at(t=1))
    text = (mesh.text(kind) + material(E, NU, 7.8e-9, more=PLASTIC.format('ISOTROPIC')) + cards
            + step('STATIC', '0.1, 1', pull, '*EL PRINT\nS\n*NODE PRINT\nU\n*ENERGY PRINT\n')
            + step('DYNAMIC, DIRECT', '0.001, 0.1', '', ''))
    run = run_deck(text)
    t = run['history/time']
    checks.at_most(abs(t[-1] - 1.1), 1e-9, f'{kind}: the dynamic step reaches its end')
    stress = run['history/element_1/S22'][t >= 1]
    checks.close(stress, np.full(len(stress), stress[0]), 1e-9 * YIELD, f'{kind}: stress at rest')
    checks.at_most(np.max(run['energy/kinetic']) / np.max(run['energy/external_work']), 1e-20,
                   f'{kind}: kinetic energy at rest')


def check_flight(checks, kind):
    """A plastic body flies freely: no force but round-off, found at once, and its speed stays."""
    mesh = Mesh(2, 1, 4)
    flight = '*NSET, NSET=BODY\n' + ''.join(f'{p + 1}\n' for p in range(len(mesh.x)))
    flight += '*INITIAL CONDITIONS, TYPE=VELOCITY\nBODY, 1, -10\n'
    text = (mesh.text(kind) + material(E, NU, 7.8e-9, more=PLASTIC.format('KINEMATIC')) + flight
            + step('DYNAMIC, DIRECT', '1e-6, 3e-4', '', '*NODE PRINT\nV\n*ENERGY PRINT\n'))
    run = run_deck(text)
    checks.close(run['history/node_1/V1'], np.full(301, -10.0), 1e-10, f'{kind}: speed in flight')
    checks.at_most(np.max(run['cost/iterations']), 3 * 300, f'{kind}: iterations in flight')


checks = Checks()
for kind in ('CPE4', 'CPE4R'):
    check_rest(checks, kind)
    check_flight(checks, kind)
for kind in ('CPS4', 'CAX4', 'CPS8', 'CPS3', 'CPS4R', 'CAX8R'):
    for law in ('ISOTROPIC', 'KINEMATIC'):
        check_uniaxial(checks, kind, law)
check_loop(checks)
check_strain(checks)
checks.finish()
