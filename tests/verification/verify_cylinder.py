"""A thick cylinder under internal pressure: elastic against Lamé, nearly incompressible, and
elastic-plastic against the exact plastic radius (plane strain, no hardening to speak of)."""
import numpy as np

from carom_case import INPUT, Checks, run_deck
from solid_mesh import Mesh, kept, last_frame, material, node_set

A, B, E, PRESSURE = 1.0, 2.0, 200e3, 100.0


def deck(kind, n, nu, title, section='', plastic='', pressure=PRESSURE, procedure='STATIC, DIRECT',
         line='1, 1', grade=1.0, prints=''):
    """The quarter ring in the x, y plane (CPE), or a slice of the half section (CAX), plane strain."""
    nodes = int(kind[3])

    def radius(s):
        return A + (B - A) * s**grade

    if kind.startswith('CAX'):
        mesh = Mesh(n, 1, nodes, lambda s, t: (radius(s), 0.1 * t))
        held = node_set('flat', np.union1d(mesh.at(t=0), mesh.at(t=1))) + '*BOUNDARY\nflat, 2\n'
    else:
        mesh = Mesh(n, 2 * n, nodes, lambda s, t: (radius(s) * np.cos(0.5 * np.pi * t),
                                                   radius(s) * np.sin(0.5 * np.pi * t)))
        held = (node_set('below', mesh.at(t=0)) + node_set('left', mesh.at(t=1))
                + '*BOUNDARY\nbelow, 2\nleft, 1\n')
    inner = ''.join(f'{e + 1}, P4, {pressure!r}\n' for e, ring in enumerate(mesh.elements)
                    if np.abs(mesh.st[ring[0], 0]) < 1e-12)
    bore = node_set('bore', mesh.at(s=0)[:1])
    return mesh, f"""*HEADING
{title}
{mesh.text(kind)}{bore}{material(E, nu, more=plastic, section=section)}{held}*STEP, INC=1000
*{procedure}
{line}
*DLOAD
{inner}*NODE PRINT, NSET=bore
U
*NODE FILE
U
*EL FILE
S, PEEQ
*ENERGY PRINT
{prints}*END STEP
"""


def lame(r, nu):
    """Radial displacement and hoop stress in plane strain."""
    c = PRESSURE * A**2 / (B**2 - A**2)
    return (1 + nu) * c / E * ((1 - 2 * nu) * r + B**2 / r), c * (1 + B**2 / r**2)


def check_elastic(checks, kind, n, nu, limit, name=None, section=''):
    mesh, text = deck(kind, n, nu, f'Thick cylinder under internal pressure, {kind}, nu = {nu}',
                      section=section)
    run = run_deck(kept(checks, INPUT / 'thick_cylinder' / name, text) if name else text)
    line = mesh.at(t=0)
    r = mesh.x[line, 0]
    u, hoop = lame(r, nu)
    found = last_frame(run, 'U')[line, 0]
    checks.at_most(np.max(np.abs(found / u - 1)), limit,
                   f'{kind}, nu = {nu}: radial displacement at the bore {found[0]:.6g}')
    # S is XX YY ZZ: the hoop is ZZ in a half section, YY on the x axis of a ring
    component = 2 if kind.startswith('CAX') else 1
    if section:
        cells = last_frame(run, 'S', 'CellData')
        rings = [e for e, ring in enumerate(mesh.elements) if mesh.st[ring[0], 1] < 1e-12]
        centre = np.array([mesh.x[mesh.elements[e]].mean(axis=0) for e in rings])
        angle = np.arctan2(centre[:, 1], centre[:, 0]) if component == 1 else 0 * centre[:, 0]
        distance = np.hypot(*centre.T) if component == 1 else centre[:, 0]
        s = cells[rings]
        stress = s[:, 2] if component == 2 else (
            s[:, 0] * np.sin(angle)**2 + s[:, 1] * np.cos(angle)**2
            - 2 * s[:, 3] * np.sin(angle) * np.cos(angle))
        exact = lame(distance, nu)[1]
        checks.at_most(np.max(np.abs(stress - exact)) / np.max(exact), limit,
                       f'{kind}, nu = {nu}: mean hoop stress in the elements')
    else:
        stress = last_frame(run, 'S')[line, component]
        checks.at_most(np.max(np.abs(stress - hoop)) / np.max(hoop), limit,
                       f'{kind}, nu = {nu}: hoop stress at the nodes, {stress[0]:.6g} at the bore')


YIELD = 240.0


def exact_pressure(c):
    """Pressure at a plastic radius c: Tresca's with k = yield/sqrt(3), which is Mises's where the
    axial stress is the mean of the others (nu = 1/2)."""
    k = YIELD / np.sqrt(3)
    return 2 * k * np.log(c / A) + k * (1 - c**2 / B**2)


def iterations(run):
    return np.loadtxt(run.path.with_suffix('.sta'), ndmin=2)[:, 5]


def check_plastic(checks, kind, n, section, c, name=None):
    """Plastic radius: where the equivalent plastic strain, which is about c^2/r^2 - 1, fades."""
    nu = 0.4999
    pressure = float(round(exact_pressure(c), 3))
    mesh, text = deck(kind, n, nu, f'Thick cylinder beyond yield, {kind}: plastic radius {c}',
                      section, f'*PLASTIC\n{YIELD!r}, 0\n', pressure, line='0.1, 1')
    run = run_deck(kept(checks, INPUT / 'thick_cylinder' / name, text) if name else text)
    strain = last_frame(run, 'PEEQ', 'CellData')
    rows = [e for e, ring in enumerate(mesh.elements) if mesh.st[ring[0], 1] < 1e-12]
    first, last = mesh.st[mesh.elements[rows]][:, :, 0].min(1), mesh.st[mesh.elements[rows]][:, :, 0].max(1)
    middle = A + (B - A) * 0.5 * (first + last)
    strain = strain[rows]
    # peeq = (Y (1 - nu^2)2/(sqrt 3 E))(c^2/r^2 - 1): a line in 1/r^2 whose zero is c
    good = strain > 0.1 * strain.max()
    slope, shift = np.polyfit(1 / middle[good]**2, strain[good], 1)
    radius = np.sqrt(-slope / shift)
    checks.at_most(abs(radius / c - 1), 0.02, f'{kind}: plastic radius {radius:.5g} against {c}')
    front = middle[strain > 1e-4 * strain.max()].max()
    checks.at_most(abs(front / c - 1), 0.02, f'{kind}: outermost plastic element at {front:.5g}')
    k = YIELD / np.sqrt(3)
    exact = (1 + nu) * k * c**2 / (E * A)
    bore = run['history/node_' + str(mesh.at(s=0)[0] + 1) + '/U1'][-1]
    checks.at_most(abs(bore / exact - 1), 0.01, f'{kind}: displacement of the bore {bore:.6g}')
    counts = iterations(run)
    checks.at_most(counts.max(), 6, f'{kind}: iterations of an increment')
    checks.at_most(abs(run['energy/balance_error'][-1]) / run['energy/external_work'][-1], 1e-6,
                   f'{kind}: error of the energy balance')
    checks.at_least(run['energy/plastic'][-1] / run['energy/external_work'][-1], 0.05,
                    f'{kind}: plastic part of the work')
    print('        iterations', counts.astype(int))


def check_limit(checks):
    """A pressure beyond what the cylinder bears: increments are cut back until the run stops, at the
    limit 2 k ln(b/a)."""
    limit = 2 * YIELD / np.sqrt(3) * np.log(B / A)
    pressure = 220.0
    text = deck('CAX4', 40, 0.4999, 'Beyond the limit', ', BBAR=YES', f'*PLASTIC\n{YIELD!r}, 0\n',
                pressure, 'STATIC', '0.1, 1, 1e-5, 0.1')[1]
    run = run_deck(text, expect_status=4)
    table = np.loadtxt(run.path.with_suffix('.sta'), ndmin=2)
    reached = table[-1, 2] * pressure
    checks.at_most(abs(reached / limit - 1), 5e-3,
                   f'limit pressure {reached:.6g} against {limit:.6g}, {len(table)} increments')
    checks.at_most(table[:, 4].min(), 1e-3, 'limit pressure: smallest increment')
    checks.true('cut back' in run.text, 'limit pressure: the message says that it was cut back')


checks = Checks()
check_elastic(checks, 'CAX8', 12, 0.3, 2e-3, 'elastic_cax8.inp')
check_elastic(checks, 'CPE8', 12, 0.3, 2e-3, 'elastic_cpe8.inp')
check_elastic(checks, 'CPE8R', 12, 0.3, 3e-3)
check_elastic(checks, 'CPE4', 16, 0.4999, 1e-2, section=', BBAR=YES')
check_elastic(checks, 'CAX4', 16, 0.4999, 1e-2, section=', BBAR=YES')
check_plastic(checks, 'CAX4', 80, ', BBAR=YES', 1.5, 'plastic_cax4.inp')
check_plastic(checks, 'CPE4', 40, ', BBAR=YES', 1.5)
check_plastic(checks, 'CAX8R', 40, '', 1.5)
check_limit(checks)
checks.finish()
