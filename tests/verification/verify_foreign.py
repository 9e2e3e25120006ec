"""Decks of others: CalculiX's test decks, decks that CalculiX runs too, a mesh as gmsh writes it.

Needs the Debian packages calculix-ccx and calculix-ccx-test; nothing of them is kept here.
"""
import gzip
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from carom_case import Checks, run_deck

AGREE = 1e-3                # of the largest displacement, or of each frequency
FEWEST = 4                  # decks of calculix-ccx-test that run today
PLANE = re.compile(rb'TYPE *= *(CPE|CPS|CAX|T3D2|T2D2|SPRING|MASS|DASHPOT|GAPUNI)', re.I)


def need(package, found):
    """Ends the test where a package is missing: nothing is left out silently."""
    if not found:
        sys.exit(f'FAILED: the Debian package {package} is not installed: '
                 f'apt-get install {package}')


def read(path):
    """The bytes of a file, gzipped or not."""
    return gzip.decompress(path.read_bytes()) if path.suffix == '.gz' else path.read_bytes()


def installed(package):
    """The files of a package by name without .gz."""
    try:
        done = subprocess.run(['dpkg', '-L', package], capture_output=True, text=True)
    except OSError:
        return {}
    files = [Path(line) for line in done.stdout.splitlines()]
    return {path.name.removesuffix('.gz'): path for path in files if path.is_file()}


def tables(text, heading):
    """The tables of a .dat file under a heading: a list of (time, rows of numbers)."""
    found = []
    for line in text.splitlines():
        if 'time' in line:
            found.append((float(line.split()[-1]), []) if heading in line else (None, []))
        elif found and re.match(r' *\d', line):
            # Fortran leaves no blank before a minus sign where the number fills its field
            words = re.sub(r'(?<=\d)-(?=\d*\.)', ' -', line).split()
            found[-1][1].append([float(word) for word in words])
    return [(time, np.array(rows)) for time, rows in found if time is not None and rows]


def displacement_error(run, text):
    """Largest difference of U from the tables of a .dat file, relative to the largest U in them."""
    times = run['history/time']
    worst = largest = 0.0
    n = 0
    for time, rows in tables(text, 'displacements'):
        row = int(np.argmin(np.abs(times - time)))
        if abs(times[row] - time) > 1e-6 * abs(time):
            return np.inf, n
        for node, *expected in rows:
            for i, value in enumerate(expected, 1):
                name = f'history/node_{int(node)}/U{i}'
                ours = run[name][row] if name in run.file else 0.0
                worst = max(worst, abs(ours - value))
                largest = max(largest, abs(value))
                n += 1
    return worst / largest if largest > 0 else np.inf, n


def stress_error(run, text):
    """The same for the axial stress of trusses, the trace of the stress at CalculiX's points."""
    worst = largest = 0.0
    n = 0
    _, rows = tables(text, 'stresses')[-1]
    for element in np.unique(rows[:, 0]).astype(int):
        expected = rows[rows[:, 0] == element][:, 2:5].sum(axis=1).mean()
        worst = max(worst, abs(run[f'history/element_{element}/S11'][-1] - expected))
        largest = max(largest, abs(expected))
        n += 1
    return worst / largest, n


def reason(text):
    """What stops a deck: its line, or the message."""
    line = re.search(r'^\s*(?:card: )?(\*\S.*)$', text, re.M)
    message = re.search(r'error: \S+?:\d+: (.*)', re.sub(r'/\S*/', '', text))
    words = [line.group(1).strip() if line else '', message.group(1) if message else text[:60]]
    return '  '.join(words).replace('is known but does not work yet', 'does not work yet')[:110]


def check_installed(checks):
    """Runs the decks of calculix-ccx-test that carom accepts, and lists what stops the others."""
    files = installed('calculix-ccx-test')
    decks = {name[:-4]: path for name, path in files.items() if name.endswith('.inp')}
    need('calculix-ccx-test', decks)
    carom = str(Path(sys.argv[1]).resolve())
    stopped, accepted, solid = {}, [], 0
    with tempfile.TemporaryDirectory() as folder:
        for name, path in sorted(decks.items()):
            deck = Path(folder) / f'{name}.inp'
            deck.write_bytes(read(path))
            if not PLANE.search(deck.read_bytes()):
                solid += 1
                continue
            done = subprocess.run([carom, 'check', str(deck)], capture_output=True, text=True,
                                  timeout=60)
            if done.returncode != 0:
                stopped[name] = reason(done.stdout + done.stderr)
                if done.returncode != 2:
                    checks.true(False, f'{name}: refused with status {done.returncode}, not 2')
                continue
            accepted.append(name)
            reference = read(files[f'{name}.dat.ref']).decode('latin-1')
            run = run_deck(deck)
            has_u = 'displacements' in reference
            error, n = (displacement_error if has_u else stress_error)(run, reference)
            checks.at_most(error, AGREE, f'{name}: {n} {"displacements" if has_u else "stresses"}')
    print(f'{len(decks)} decks, {solid} without any element type of carom; of the others '
          f'{len(accepted)} run, {len(stopped)} are stopped:')
    for name, why in stopped.items():
        print(f'   {name:14} {why}')
    checks.at_least(len(accepted), FEWEST, 'decks of calculix-ccx-test that run')


def lattice(nx, ny, place):
    """Nodes and eight-node elements on a lattice; the nodes by their place in it."""
    number, elements = {}, []

    def node(i, j):
        return number.setdefault((i, j), len(number) + 1)

    for i in range(0, 2 * nx, 2):
        for j in range(0, 2 * ny, 2):
            elements.append([node(i + a, j + b) for a, b in (
                (0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))])
    text = '*NODE, NSET=NALL\n' + ''.join(
        '{}, {:.12g}, {:.12g}, 0.\n'.format(n, *place(i / (2 * nx), j / (2 * ny)))
        for (i, j), n in number.items())
    return text, elements, number


def element_card(kind, elements, name, first=1):
    """An *ELEMENT card."""
    lines = [f'{first + k}, ' + ', '.join(map(str, e)) for k, e in enumerate(elements)]
    return f'*ELEMENT, TYPE={kind}, ELSET={name}\n' + '\n'.join(lines) + '\n'


def node_set(name, nodes):
    """An *NSET card."""
    return f'*NSET, NSET={name}\n' + ''.join(f'{n},\n' for n in nodes)


STEEL = '*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*DENSITY\n7.8E-9\n'


def own_decks():
    """Decks for both programs, by name.

    CalculiX makes a layer of bricks of plane stress elements; they are thin here, since the shear
    across the thickness of these makes them stiffer (0.2 % for a thickness of 0.5).
    """
    nodes, elements, number = lattice(16, 3, lambda a, b: (12 * a, 2 * b))
    beam = (nodes + element_card('CPS8', elements, 'EALL')
            + node_set('LEFT', [n for (i, _), n in number.items() if i == 0])
            + STEEL + '*SOLID SECTION, ELSET=EALL, MATERIAL=STEEL\n0.02\n*BOUNDARY\nLEFT, 1, 2\n')
    corner = number[32, 6]
    bending = (beam + f'*STEP\n*STATIC\n*CLOAD\n{corner}, 2, -0.12\n'
               '*NODE PRINT, NSET=NALL\nU\n*END STEP\n')
    modes = beam + '*STEP\n*FREQUENCY\n5\n*NODE FILE\nU\n*END STEP\n'
    nodes, elements, number = lattice(5, 3, lambda a, b: (5 + 4 * a, 3 * b))
    inner = ''.join(f'{k},\n' for k in range(1, 4))
    ring = (nodes + element_card('CAX8', elements, 'EALL') + f'*ELSET, ELSET=INNER\n{inner}'
            + node_set('FOOT', [n for (_, j), n in number.items() if j == 0])
            + STEEL + '*SOLID SECTION, ELSET=EALL, MATERIAL=STEEL\n*BOUNDARY\nFOOT, 2, 2\n'
            '*STEP\n*STATIC\n*DLOAD\nINNER, P4, 120.\n*NODE PRINT, NSET=NALL\nU\n*END STEP\n')
    return {'bending of CPS8': bending, 'pressure on CAX8': ring, 'modes of CPS8': modes,
            'rotation of CAX8': ring.replace(
                'INNER, P4, 120.', 'EALL, CENTRIF, 1.E8, 0., 0., 0., 0., 1., 0.')}


def run_ccx(deck, folder):
    """CalculiX's .dat file for a deck."""
    (Path(folder) / 'deck.inp').write_text(deck)
    try:
        done = subprocess.run(['ccx', '-i', 'deck'], cwd=folder, capture_output=True, text=True,
                              timeout=300, env={**os.environ, 'OMP_NUM_THREADS': '1'})
    except FileNotFoundError:
        need('calculix-ccx', False)
    if done.returncode != 0 or 'ERROR' in done.stdout:
        sys.exit(f'FAILED: ccx ended with {done.returncode}: {done.stdout[-800:]}')
    return (Path(folder) / 'deck.dat').read_text()


def check_side_by_side(checks):
    """The same deck through both programs."""
    for name, deck in own_decks().items():
        with tempfile.TemporaryDirectory() as folder:
            text = run_ccx(deck, folder)
        run = run_deck(deck)
        if '*FREQUENCY' not in deck:
            error, n = displacement_error(run, text)
            checks.at_most(error, AGREE, f'{name} as in ccx: {n} displacements')
            continue
        # mode, eigenvalue, omega, cycles per time, imaginary part
        rows = re.findall(r'^ +\d+ +(\S+) +(\S+) +(\S+) +(\S+)$', text.split('PARTICIPATION')[0],
                          re.M)
        theirs = np.array([float(row[2]) for row in rows])[:5]
        ours = run['frequency/frequency'][:5]
        checks.at_most(np.max(np.abs(ours / theirs - 1)), AGREE, f'{name} as in ccx: 5 frequencies')


def check_gmsh(checks):
    """A mesh in gmsh's way: CPS types, boundaries as T3D3; typed anew as plane strain."""
    nodes, quads, number = lattice(4, 2, lambda a, b: (4 * a, 2 * b))
    nodes += '999, 0., 0., 0.\n'          # a point of the geometry that no element uses
    triangles = []
    middle = max(number.values())
    for k in (0, 1):                      # the first two quadrilaterals as two triangles each
        a, b, c, d, ab, bc, cd, da = quads[k]
        middle += 1
        nodes = nodes.replace('999,', '{}, {:.12g}, {:.12g}, 0.\n999,'.format(middle, 0.5, k + 0.5))
        triangles += [[a, b, c, ab, bc, middle], [a, c, d, middle, cd, da]]
    left = [[number[0, j], number[0, j + 2], number[0, j + 1]] for j in (0, 2)]
    right = [[number[8, j], number[8, j + 2], number[8, j + 1]] for j in (0, 2)]

    def deck(kind, lines, section):
        text = '*HEADING\n mesh.inp\n' + nodes.replace(', NSET=NALL', '')
        text += '******* E L E M E N T S *************\n'
        if lines:
            text += element_card('T3D3', left, 'Line1', 1) + element_card('T3D3', right, 'Line2', 3)
        text += element_card(f'{kind}6', triangles, 'Surface1', 5)
        text += element_card(f'{kind}8', quads[2:], 'Surface2', 9)
        text += '*ELSET,ELSET=plate\n5, 6, 7, 8, 9, 10,\n11, 12, 13, 14\n'
        if lines:
            text += '*ELSET,ELSET=held\n1, 2,\n'
        text += '*NSET,NSET=held\n' + ', '.join(str(number[0, j]) for j in range(5)) + '\n'
        return (text + STEEL + f'*SOLID SECTION, ELSET=plate, MATERIAL=STEEL{section}\n1.\n'
                f'*BOUNDARY\nheld, 1, 2\n*STEP\n*STATIC\n*CLOAD\n{number[8, 4]}, 2, -10.\n'
                '*NODE FILE\nU\n*END STEP\n')

    ours = run_deck(deck('CPS', True, ', ELEMENTS=CPE'))
    plain = run_deck(deck('CPE', False, ''))
    n = len(plain['VTKHDF/Points'])
    a, b = ours['VTKHDF/PointData/U'][-n:], plain['VTKHDF/PointData/U'][-n:]
    checks.at_most(np.abs(a - b).max() / np.abs(b).max(), 1e-12,
                   'gmsh plate, CPS typed as CPE: as the same deck with CPE and no lines')
    kinds = ours['VTKHDF/Types'].tolist()
    checks.true([kinds.count(k) for k in (21, 22, 23)] == [4, 4, 6],
                'gmsh plate: quadratic lines, triangles and quadrilaterals in the grid')
    checks.true(ours['model/element_scheme'].tolist() == [0] * 4 + [1] * 10,
                'gmsh plate: lines have no scheme, the solids are implicit')
    fixed = sorted(zip(ours['model/node_id'][ours['model/fixed_point']].tolist(),
                       ours['model/fixed_dof'].tolist()))
    checks.true(fixed == sorted((number[0, j], dof) for j in range(5) for dof in (1, 2)),
                'gmsh plate: the supports are in the result')
    x = ours['VTKHDF/Points'][ours['VTKHDF/Connectivity'][:12].reshape(4, 3)]
    checks.close(x[:, 2], x[:, :2].mean(axis=1), 1e-12, 'gmsh plate: the middle node of lines last')


checks = Checks()
check_side_by_side(checks)
check_gmsh(checks)
check_installed(checks)
checks.finish()
