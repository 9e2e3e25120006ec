"""Solids in motion, implicit and explicit side by side: orders, energy, the critical step, automatic
increments, and the order of the nodes."""
import numpy as np

from carom_case import Checks, run_deck
from solid_mesh import Mesh, last_frame, material, step

E, NU, RHO = 4.0, 0.3, 1.0


def elements_where(mesh, left):
    """Numbers of the elements left of, or right of, the middle of the mesh."""
    middle = mesh.st[mesh.elements][:, :, 0].mean(axis=1)
    return np.flatnonzero((middle < 0.5) == left)


def group(name, members, scheme):
    return (f'*ELSET, ELSET={name}\n' + ''.join(f'{e + 1}\n' for e in members)
            + f'*ELEMENT GROUP, ELSET={name}, SCHEME={scheme}, MASS=LUMPED\n')


def cantilever(schemes):
    """Coarse on the left, four times finer on the right; clamped at the left, starts with a smooth
    velocity. Schemes of the coarse and of the fine part."""
    def place(s, t):
        return np.where(s < 0.5, 1.6 * s, 0.8 + 0.4 * (s - 0.5)), 0.2 * t

    mesh = Mesh(16, 2, 4, place)
    x, y = mesh.x.T
    length = x.max()
    speeds = np.stack((0.01 * np.sin(0.5 * np.pi * x / length),
                       0.02 * (1 - np.cos(0.5 * np.pi * x / length))), axis=1).tolist()
    start = '*INITIAL CONDITIONS, TYPE=VELOCITY\n' + ''.join(
        f'{p + 1}, {d + 1}, {speeds[p][d]!r}\n' for p in range(len(x)) for d in (0, 1)
        if x[p] > 1e-9)
    held = '*BOUNDARY\n' + ''.join(f'{p + 1}, 1, 2\n' for p in mesh.at(s=0))
    groups = (group('coarse', elements_where(mesh, True), schemes[0])
              + group('fine', elements_where(mesh, False), schemes[1]))
    return mesh, mesh.text('CPE4') + material(E, NU, RHO) + groups + held + start


def check_orders(checks):
    end = 1.5

    def final(schemes, steps):
        mesh, text = cantilever(schemes)
        run = run_deck(text + step('DYNAMIC, DIRECT', f'{end / steps!r}, {end!r}',
                                   prints=f'*NODE FILE, FREQUENCY={steps}\nU\n'))
        return last_frame(run, 'U')[:, :2]

    implicit = ('IMPLICIT', 'IMPLICIT')
    counts = (600, 1200, 2400)
    limit = (4 * final(implicit, 9600) - final(implicit, 4800)) / 3
    size = np.max(np.abs(limit))
    same = [final(implicit, n) for n in counts]
    for name, schemes in (('all implicit', implicit),
                          ('coarse implicit, fine explicit', ('IMPLICIT', 'EXPLICIT')),
                          ('coarse explicit, fine implicit', ('EXPLICIT', 'IMPLICIT')),
                          ('all explicit', ('EXPLICIT', 'EXPLICIT'))):
        found = [final(schemes, n) for n in counts]
        errors = [np.sqrt(np.mean((u - limit)**2)) / size for u in found]
        order = np.log2(errors[0] / errors[-1]) / 2
        checks.at_least(order, 1.9, f'{name}: order of the error {errors[-1]:.2g} in h')
        if schemes == implicit:
            continue
        apart = [np.sqrt(np.mean((u - v)**2)) / size for u, v in zip(found, same)]
        order = np.log2(apart[0] / apart[-1]) / 2
        checks.at_least(order, 1.9, f'{name}: order of the distance {apart[-1]:.2g} from all implicit')


def check_balance(checks):
    """10^4 steps without damping."""
    for name, schemes, limit in (('all implicit', ('IMPLICIT', 'IMPLICIT'), 1e-6),
                                 ('fine explicit', ('IMPLICIT', 'EXPLICIT'), 1e-2),
                                 ('coarse explicit', ('EXPLICIT', 'IMPLICIT'), 1e-2),
                                 ('all explicit', ('EXPLICIT', 'EXPLICIT'), 1e-2)):
        text = cantilever(schemes)[1] + step('DYNAMIC, DIRECT', '0.004, 40',
                                             prints='*ENERGY PRINT\n')
        run = run_deck(text)
        error = np.abs(run['energy/balance_error']) / np.max(run['energy/total'])
        half = len(error) // 2
        checks.at_most(error.max(), limit, f'{name}, {len(error) - 1} steps: balance error')
        if limit > 1e-6:
            checks.at_most(error[half:].max() / error[:half].max(), 1.2,
                           f'{name}: the balance error swings and does not grow')


def check_critical(checks):
    """One free element: its highest frequency, found implicitly with the same lumped mass, gives the
    critical step 2/omega."""
    for kind in ('CPE4', 'CPS3', 'CPE8', 'CAX4', 'CPE4R', 'CPS6', 'CAX8R'):
        mesh = Mesh(1, 1, int(kind[3]), lambda s, t: (1 + s + 0.2 * t, t + 0.3 * s * t))
        if mesh.nodes in (3, 6):
            mesh.elements = mesh.elements[:1]
            used = np.unique(mesh.elements)
            mesh.x, mesh.st = mesh.x[used], mesh.st[used]
            mesh.elements = np.searchsorted(used, mesh.elements)
        model = mesh.text(kind) + material(E, NU, RHO)
        count = 2 * len(mesh.x)
        run = run_deck(model + '*ELEMENT GROUP, ELSET=solid, SCHEME=IMPLICIT, MASS=LUMPED\n'
                       + f'*STEP\n*FREQUENCY\n{count}\n*NODE FILE\nU\n*END STEP\n')
        omega = float(np.sqrt(np.max(run['frequency/eigenvalue'])))
        x = mesh.x - mesh.x.mean(axis=0)
        start = '*INITIAL CONDITIONS, TYPE=DISPLACEMENT\n' + ''.join(
            f'{p + 1}, {d + 1}, {float(1e-3 * np.sin(5 * p + 2 * d + x[p, d]))!r}\n'
            for p in range(len(x)) for d in (0, 1))

        def moving(part, steps):
            h = part * 2 / omega
            return model + start + step('DYNAMIC, DIRECT, EXPLICIT', f'{h!r}, {h * steps!r}',
                                        prints='*ENERGY PRINT, FREQUENCY=50\n')

        refused = run_deck(moving(1.05, 100), expect_status=2)
        checks.true('critical' in refused.text.lower() or 'step' in refused.text.lower(),
                    f'{kind}: 1.05 of the critical step {2 / omega:.5g} is refused')
        total = run_deck(moving(0.95, 100000))['energy/total']
        checks.at_most(np.max(total[len(total) // 2:]) / np.max(total[:len(total) // 2]), 1.05,
                       f'{kind}: 0.95 of it for 1e5 steps, energy of the last half over the first')


OSCILLATOR = """*NODE
1, 0, 0
2, 1, 0
*ELEMENT, TYPE=MASS, ELSET=mass
1, 1
*ELEMENT, TYPE=SPRING2, ELSET=spring
2, 1, 2
*MASS, ELSET=mass
1
*SPRING, ELSET=spring
1, 1
4
*BOUNDARY
2, 1
*INITIAL CONDITIONS, TYPE=DISPLACEMENT
1, 1, 1
"""


def status(run):
    return np.loadtxt(run.path.with_suffix('.sta'), ndmin=2)


def check_automatic(checks):
    """What verify_tolerance.py does not look at: limits and growth of increments, balance, a solid."""
    run = run_deck(OSCILLATOR + step('DYNAMIC, TOLERANCE=1e-3', '0.5, 10',
                                     prints='*NODE PRINT\nU\n*ENERGY PRINT\n'))
    h = status(run)[:, 4]
    checks.at_most(h[0], 0.1, f'oscillator, 0.5 was cut back: {len(h)} increments')
    checks.close(run['history/time'][-1], 10.0, 1e-12, 'oscillator: end')
    checks.at_most(np.max(np.abs(run['energy/balance_error'])) / 2, 1e-9, 'oscillator: balance error')
    run = run_deck(OSCILLATOR + step('DYNAMIC, TOLERANCE=1e-3', '1e-5, 10',
                                     prints='*NODE PRINT\nU\n'))
    h = status(run)[:, 4]
    checks.at_least(h.max() / h[0], 50, f'oscillator begun with 1e-5: growth over {len(h)} increments')
    run = run_deck(OSCILLATOR + step('DYNAMIC, TOLERANCE=1e-2', '0.001, 10, 0.001, 0.008',
                                     prints='*NODE PRINT\nU\n'))
    checks.close(status(run)[:, 4].max(), 0.008, 1e-9, 'oscillator: the largest increment is kept to')
    t, u = run['history/time'], run['history/node_1/U1']
    # 20 rad at 0.016 a step: 20 * 0.016^2 / 12
    checks.at_most(np.max(np.abs(u - np.cos(2 * t))), 5e-4, 'oscillator: and is as accurate as that')

    # the solid against many fixed steps
    mesh, text = cantilever(('IMPLICIT', 'IMPLICIT'))
    fine = last_frame(run_deck(text + step('DYNAMIC, DIRECT', '0.0005, 1.5',
                                           prints='*NODE FILE, FREQUENCY=3000\nU\n')), 'U')
    for tolerance in (1e-2, 1e-3, 1e-4):
        run = run_deck(text + step(f'DYNAMIC, TOLERANCE={tolerance!r}', '0.05, 1.5'))
        h = status(run)[:, 4]
        distance = np.max(np.abs(last_frame(run, 'U') - fine)) / np.max(np.abs(fine))
        checks.at_most(distance, 5 * tolerance,
                       f'solid, tolerance {tolerance:g}: error at the end, {len(h)} increments '
                       f'from {h.min():.3g} to {h.max():.3g}')


def check_static(checks):
    """A bar with a narrow middle, pulled beyond yield: automatic increments against 400 fixed ones."""
    def place(s, t):
        return 2 * s, (t - 0.5) * (1 - 0.4 * np.exp(-20 * (s - 0.5)**2))

    mesh = Mesh(16, 6, 4, place)
    plastic = '*PLASTIC\n0.02, 0\n0.06, 0.2\n'
    pulled = '*BOUNDARY\n' + ''.join(f'{p + 1}, 1\n' for p in mesh.at(s=0)) + '1, 2\n' + ''.join(
        f'{p + 1}, 1, 1, 0.04\n' for p in mesh.at(s=1))
    model = mesh.text('CPS4') + material(E, NU, more=plastic)
    prints = '*NODE FILE\nU\n*EL FILE\nS, PEEQ\n*ENERGY PRINT\n*NODE PRINT\nRF\n'
    fixed = run_deck(model + step('STATIC, DIRECT', '0.0025, 1', pulled, prints))
    right = last_frame(fixed, 'PEEQ', 'CellData')
    for first in (0.01, 1.0):
        run = run_deck(model + step('STATIC', f'{first!r}, 1', pulled, prints))
        table = status(run)
        h, found = table[:, 4], last_frame(run, 'PEEQ', 'CellData')
        checks.at_most(np.max(np.abs(found - right)) / right.max(), 0.05,
                       f'bar, first increment {first:g}: plastic strain after {len(h)} increments')
        checks.at_most(np.max(np.abs(run['energy/balance_error']))
                       / run['energy/external_work'][-1], 1e-6,
                       f'bar, first increment {first:g}: balance error')
        checks.at_most(table[:, 5].max(), 8, f'bar, first increment {first:g}: iterations')
        if first < 1:
            checks.at_least(h.max() / h[0], 5, 'bar: growth')
            checks.at_most(len(h), 40, 'bar: increments')
        checks.close(np.sum(h), 1.0, 1e-5, f'bar, first increment {first:g}: increments add up')


def check_numbering(checks):
    """The same solid with node ids and elements in random order."""
    rng = np.random.default_rng(3)

    def place(s, t):
        return 2 * s + 0.1 * np.sin(3 * t), t * (1 + 0.3 * s)

    for kind in ('CPE4', 'CPS8', 'CAX6'):
        mesh = Mesh(8, 4, int(kind[3]), lambda s, t: (1 + place(s, t)[0], place(s, t)[1]))
        fields = []
        for shuffled in (False, True):
            n, m = len(mesh.x), len(mesh.elements)
            node_id = (rng.permutation(n) * 7 + 3 if shuffled else np.arange(1, n + 1)).tolist()
            order = rng.permutation(n) if shuffled else np.arange(n)
            rings = rng.permutation(m) if shuffled else np.arange(m)
            text = '*NODE\n' + ''.join(f'{node_id[p]}, {mesh.x[p].tolist()[0]!r}, '
                                       f'{mesh.x[p].tolist()[1]!r}\n' for p in order)
            text += f'*ELEMENT, TYPE={kind}, ELSET=solid\n' + ''.join(
                f'{e + 1}, ' + ', '.join(str(node_id[p]) for p in mesh.elements[e]) + '\n'
                for e in rings)
            held = '*BOUNDARY\n' + ''.join(f'{node_id[p]}, 1, 2\n' for p in mesh.at(s=0))
            load = '*CLOAD\n' + ''.join(f'{node_id[p]}, 2, -0.01\n' for p in mesh.at(s=1))
            run = run_deck(text + material(E, NU, RHO) + held
                           + step('STATIC, DIRECT', '1, 1', load)
                           + step('DYNAMIC, DIRECT', '0.05, 5', '*CLOAD, OP=NEW\n1000000, 2, 0\n'
                                  .replace('1000000', str(node_id[0])), '*NODE FILE, FREQUENCY=10\nU, V\n'))
            ids = run['model/node_id'].tolist()
            where = [ids.index(node_id[p]) for p in range(n)]
            frames = run['VTKHDF/PointData/U'].reshape(-1, n, 3)
            fields.append(frames[:, where])
            heights = run['model/profile']
            print(f'        {kind}: {heights.sum()} entries in the skyline of {len(heights)} columns')
        checks.at_most(np.max(np.abs(fields[0] - fields[1])) / np.max(np.abs(fields[0])), 1e-12,
                       f'{kind}: shuffled nodes and elements, {len(fields[0])} frames')


checks = Checks()
check_orders(checks)
check_balance(checks)
check_critical(checks)
check_automatic(checks)
check_static(checks)
check_numbering(checks)
checks.finish()
