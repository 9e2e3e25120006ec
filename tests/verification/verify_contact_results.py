"""Contact in the result file: pressure, gap, slip and state of two blocks, forces of both bodies."""
import sys

import h5py
import numpy as np
from carom_case import Checks, run_deck
from solid_mesh import Mesh, last_frame

YOUNG, WIDTH, PRESSURE, THICKNESS = 1000.0, 2.0, 5.0, 0.7


class Blocks:
    """An upper block on a lower one, y = 0 between them; the upper one is the slave `TOP`."""

    def __init__(self, counts, nodes, kind='CPS', inner=0.0):
        """Elements along the surfaces of the upper and the lower block; inner radius of rings."""
        self.type = f'{kind}{nodes}'
        self.upper = Mesh(counts[0], 2, nodes, lambda s, t: (inner + WIDTH*s, t))
        self.lower = Mesh(counts[1], 2, nodes, lambda s, t: (inner + WIDTH*s, t - 1.0))
        self.counts = counts
        self.first = len(self.upper.x)

    def slaves(self):
        """Points of the upper block on the surface, from left to right."""
        return self.upper.at(t=0)

    def masters(self):
        """Points of the lower block on the surface."""
        return self.first + self.lower.at(t=1)

    def text(self, pair='', interaction='', dofs=1):
        """Everything above the steps; no Poisson's ratio, so that pressures stay uniform."""
        n, m = self.counts
        text = self.upper.text(self.type, 'upper') + self.lower.text(
            self.type, 'lower', self.first + 1, len(self.upper.elements) + 1)
        text += '*NSET, NSET=all, GENERATE\n' f'1, {self.first + len(self.lower.x)}\n'
        text += nodes('lid', self.upper.at(t=1)) + nodes('slaves', self.slaves())
        text += nodes('floor', self.first + self.lower.at(t=0))
        text += elements('bottoms', range(1, n + 1))
        text += elements('tops', range(2*n + m + 1, 2*n + 2*m + 1))
        text += f'*MATERIAL, NAME=stuff\n*ELASTIC\n{YOUNG}, 0.\n*DENSITY\n1.\n'
        for name in ('upper', 'lower'):
            text += f'*SOLID SECTION, ELSET={name}, MATERIAL=stuff\n{THICKNESS}\n'
        text += '*SURFACE, NAME=top\nbottoms, S1\n*SURFACE, NAME=base\ntops, S3\n'
        text += f'*SURFACE INTERACTION, NAME=touch\n{interaction}'
        text += f'*CONTACT PAIR, INTERACTION=touch{pair}\ntop, base\n'
        return text + f'*BOUNDARY\nfloor, 2, 2\nall, {dofs}, {dofs}\n'


def nodes(name, points):
    return f'*NSET, NSET={name}\n' + ''.join(f'{p + 1}\n' for p in points)


def elements(name, numbers):
    return f'*ELSET, ELSET={name}\n' + ''.join(f'{e}\n' for e in numbers)


def table_entry(log, row, column):
    """A figure of the energies in the summary at the end of a log."""
    lines = [line.split() for line in log[log.index('summary of the run'):].splitlines()]
    head = next(words for words in lines if words[:2] == ['energy', 'kinetic'])
    return next(words for words in lines[lines.index(head):] if words[:1] == [row])[head.index(column)]


def requests(print_words='CF, CDIS, CPRESS', file_words='CF, CDIS'):
    return f'*CONTACT PRINT\n{print_words}\n*CONTACT FILE\n{file_words}\n*ENERGY PRINT\n'


def pressed(cards=''):
    """A static step that moves the lid down until both blocks, each of height 1, carry PRESSURE."""
    return (f'*STEP\n*STATIC, DIRECT\n0.5, 1.\n*BOUNDARY\nlid, 2, 2, {-2*PRESSURE/YOUNG!r}\n'
            f'{cards}{requests()}*END STEP\n')


def no_far_gaps(run):
    """Whether the placeholder of rows without a partner is nowhere in the file."""
    good = []

    def look(_, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind == 'f':
            values = item[()]
            good.append(not np.any(np.abs(values[np.isfinite(values)]) > 1e20))
    run.file.visititems(look)
    return len(good) > 10 and all(good)


def check_uniform(checks, what, blocks, pair='', kind='node to surface', tolerance=1e-10):
    """A uniform stress across the whole contact comes back as the pressure."""
    run = run_deck(blocks.text(pair) + pressed())
    slaves, masters = blocks.slaves(), blocks.masters()
    pressure, state = last_frame(run, 'CPRESS'), last_frame(run, 'CSTATE')
    checks.close(pressure[slaves], np.full(len(slaves), PRESSURE), tolerance*PRESSURE,
                 f'{what}: CPRESS is the stress')
    others = np.ones(len(pressure), bool)
    others[slaves] = False
    if 'PASSES=2' in pair:
        checks.close(pressure[masters], np.full(len(masters), PRESSURE), tolerance*PRESSURE,
                     f'{what}: CPRESS of the master too')
        others[masters] = False
    checks.true(np.all(state[~others] == 2) and np.all(state[others] == 0),
                f'{what}: CSTATE 2 at contact nodes, 0 elsewhere')
    checks.close(pressure[others], 0*pressure[others], 0.0, f'{what}: no pressure elsewhere')
    gap = last_frame(run, 'CDIS')
    checks.close(gap, 0*gap, 1e-14, f'{what}: CDIS is zero')
    check_forces(checks, what, run, slaves, masters)
    history = run.file['history/contact_TOP-BASE']
    checks.true(history['CNUM'][-1] == np.count_nonzero(~others),
                f'{what}: CNUM counts the contact nodes')
    checks.close(history['CPRESS'][-1], PRESSURE, tolerance*PRESSURE, f'{what}: printed CPRESS')
    checks.true(f'TOP: {len(slaves)} slave nodes on {blocks.counts[1]} edges of BASE, {kind}'
                in run.path.with_suffix('.log').read_text(), f'{what}: the log names the pair')
    return run


def check_forces(checks, what, run, slaves, masters):
    """Forces of the frames cancel, and add up to those of the history."""
    force = last_frame(run, 'CF')
    size = np.abs(force).sum()
    checks.close(force[slaves].sum(axis=0) + force[masters].sum(axis=0), np.zeros(3),
                 1e-13*size, f'{what}: CF of master and slave cancel')
    printed = [run[f'history/contact_TOP-BASE/CF{i}'][-1] for i in (1, 2, 3)]
    checks.close(printed, force[slaves].sum(axis=0), 1e-12*size,
                 f'{what}: printed CF is the slave\'s')
    checks.true(no_far_gaps(run), f'{what}: no placeholder in the file')


def check_pressures(checks):
    """Matching and nonmatching meshes, one way and both, plane and around an axis."""
    for n in (4, 8):
        check_uniform(checks, f'CPS{n} on CPS{n}', Blocks((4, 4), n))
        run = check_uniform(checks, f'CPE{n}, both ways', Blocks((3, 3), n, 'CPE'), ', PASSES=2',
                            'node to surface both ways')
        checks.close(run['history/contact_TOP-BASE/CF2'][-1], PRESSURE*WIDTH*THICKNESS, 1e-10,
                     f'CPE{n}, both ways: CF2 is the load once')
        check_uniform(checks, f'CPS{n}, 5 on 3, weighted', Blocks((5, 3), n),
                      ', TYPE=SURFACE TO SURFACE', 'surface to surface')
        check_uniform(checks, f'CPS{n}, 3 on 5, weighted, small sliding', Blocks((3, 5), n),
                      ', TYPE=SURFACE TO SURFACE, SMALL SLIDING',
                      'surface to surface, small sliding')
        check_uniform(checks, f'CAX{n} on CAX{n}', Blocks((4, 4), n, 'CAX'))
        check_uniform(checks, f'CAX{n} on CAX{n}, weighted', Blocks((3, 3), n, 'CAX', 0.5),
                      ', TYPE=SURFACE TO SURFACE', 'surface to surface')


def check_nodes(checks):
    """A slave of nodes has forces and no pressure."""
    blocks = Blocks((4, 4), 4)
    text = blocks.text().replace('*SURFACE, NAME=top\nbottoms, S1\n',
                                 '*SURFACE, NAME=top, TYPE=NODE\nslaves\n')
    run = run_deck(text + pressed())
    checks.close(last_frame(run, 'CPRESS'), np.zeros(len(run['model/node_id'])), 0.0,
                 'a slave of nodes: no pressure')
    checks.at_least(last_frame(run, 'CF')[blocks.slaves(), 1].min(), 1e-3*PRESSURE,
                    'a slave of nodes: forces')
    checks.true('edges' not in run.file['model/surface_TOP'], 'a slave of nodes: no edges in /model')


def check_surfaces(checks):
    """/model tells the surfaces: edges that follow one another, body on the left; rigid ones."""
    blocks = Blocks((3, 2), 8)
    rigid = ('*RIGID SURFACE, NAME=ball, TYPE=CIRCLE\n9., 8., 0.\n0.5\n*RIGID SURFACE, NAME=wall, '
             'TYPE=PLANE\n-7., 0., 0.\n1., 0., 0.\n')
    run = run_deck(blocks.text() + rigid + pressed())
    edges, points = run['model/surface_TOP/edges'], run['model/surface_TOP/nodes']
    checks.true(np.array_equal(np.sort(points), np.sort(blocks.slaves())), '/model: slave nodes')
    left = blocks.slaves()
    expected = [[left[2*i], left[2*i + 2], left[2*i + 1]] for i in range(3)]
    checks.true(np.array_equal(edges, expected), '/model: edges of the slave, from left to right')
    linear = run_deck(Blocks((3, 2), 4).text() + pressed())['model/surface_BASE/edges']
    checks.true(linear.shape == (2, 3) and np.all(linear[:, 2] == -1),
                '/model: edges without a middle node')
    x = run['VTKHDF/Points'][run['model/surface_BASE/edges'][:, :2], 0]
    checks.true(np.all(x[:, 0] > x[:, 1]), '/model: the body is on the left of its edges')
    checks.close(run['model/rigid_circles'], [[9, 8, 0, 0.5]], 0.0, '/model: rigid circle')
    checks.close(run['model/rigid_planes'], [[-7, 0, 0, 1, 0, 0]], 0.0, '/model: rigid plane')


def check_slip(checks):
    """The upper block is pressed, then pushed to the right against friction."""
    friction, way = 0.1, 0.03
    for n, pair in ((4, ''), (8, ''), (4, ', PASSES=2'), (4, ', TYPE=SURFACE TO SURFACE')):
        what = f'{n} nodes{pair}, slid'
        pair += ', SMALL SLIDING'
        blocks = Blocks((3, 3), n)
        text = blocks.text(pair, f'*FRICTION\n{friction}\n', 3).replace(
            '*BOUNDARY\n', '*BOUNDARY\nfloor, 1, 1\n')
        slide = f'*STEP\n*STATIC, DIRECT\n0.25, 1.\n*BOUNDARY\nlid, 1, 1, {way}\n{requests()}*END STEP\n'
        run = run_deck(text + pressed('lid, 1, 1\n') + slide)
        slaves, masters = blocks.slaves(), blocks.masters()
        state, slip = last_frame(run, 'CSTATE'), last_frame(run, 'CSLIP')
        checks.true(np.all(state[slaves] == 3), f'{what}: CSTATE 3')
        displacement = last_frame(run, 'U')[:, 0]
        expected = np.abs(displacement[slaves] - displacement[masters])
        if 'SURFACE TO SURFACE' in pair:
            # weighted with the shape functions of the edges, int N_j u ds/int N_j ds
            mass = sum(np.pad([[2, 1], [1, 2]], (e, len(expected) - 2 - e))
                       for e in range(len(expected) - 1))
            expected = mass @ expected/mass.sum(axis=1)
        if 'PASSES=2' not in pair:
            checks.close(slip[slaves], expected, 1e-12, f'{what}: CSLIP is the relative motion')
        checks.at_least(slip[slaves].min(), way/2, f'{what}: CSLIP')
        checks.close(run['history/contact_TOP-BASE/CSLIP'][-1], slip.max(), 0.0,
                     f'{what}: printed CSLIP')
        along, across = (run[f'history/contact_TOP-BASE/CF{i}'][-1] for i in (1, 2))
        checks.at_least(across, 0.5*PRESSURE*WIDTH*THICKNESS, f'{what}: the blocks are pressed')
        checks.close(along, -friction*across, 1e-9*across, f'{what}: printed CF is normal and friction')
        check_forces(checks, what, run, slaves, masters)
        checks.true(f'friction {friction}' in run.path.with_suffix('.log').read_text(),
                    f'{what}: the log names the friction')
        energy = float(table_entry(run.path.with_suffix('.log').read_text(), 'end', 'friction'))
        checks.close(energy, run['energy/friction'][-1], 1e-4*energy,
                     f'{what}: friction in the log\'s energies')
        stuck = Blocks((3, 3), n)
        run = run_deck(stuck.text(pair, '*FRICTION\n5.\n', 3).replace(
            '*BOUNDARY\n', '*BOUNDARY\nfloor, 1, 1\n') + pressed('lid, 1, 1\n'))
        checks.true(np.all(last_frame(run, 'CSTATE')[slaves] == 2), f'{what}: CSTATE 2 if it sticks')
        checks.close(last_frame(run, 'CSLIP'), 0*slip, 1e-12, f'{what}: no CSLIP if it sticks')


def check_open(checks):
    """The upper block hangs above the lower one: gaps are told from afar; beside it there are none."""
    for pair, nothing in (('', False), (', TYPE=SURFACE TO SURFACE', False), (', SMALL SLIDING', False),
                          ('', True)):
        blocks = Blocks((3, 4), 4)
        blocks.upper.x[:, 1] += 0.8
        if nothing:
            blocks.upper.x[:, 0] += 3*WIDTH
        step = f'*STEP\n*DYNAMIC, DIRECT\n1e-3, 1e-2\n{requests()}*NODE FILE\nU\n*END STEP\n'
        fall = '*INITIAL CONDITIONS, TYPE=VELOCITY\n' + ''.join(
            f'{i + 1}, 2, -1.\n' for i in range(blocks.first))
        run = run_deck(blocks.text(pair) + fall + step)
        what = f'open{pair}' + (', beside' if nothing else '')
        gaps = run['VTKHDF/PointData/CDIS'].reshape(11, -1)
        expected = 0.8 - np.arange(11)*1e-3
        slaves = blocks.slaves()
        if nothing:
            checks.true(np.all(np.isnan(gaps[:, slaves])), f'{what}: CDIS is NaN in the frames')
            checks.true(np.all(np.isnan(run['history/contact_TOP-BASE/CDIS'])),
                        f'{what}: CDIS is NaN in the history')
        else:
            checks.close(gaps[:, slaves], np.repeat(expected[:, None], len(slaves), 1), 1e-12,
                         f'{what}: CDIS in the frames')
            checks.close(run['history/contact_TOP-BASE/CDIS'], expected, 1e-12,
                         f'{what}: CDIS in the history')
        checks.true(np.all(last_frame(run, 'CSTATE')[slaves] == 1), f'{what}: CSTATE 1')
        checks.close(last_frame(run, 'CPRESS'), np.zeros(gaps.shape[1]), 0.0, f'{what}: no pressure')
        checks.true(no_far_gaps(run), f'{what}: no placeholder in the file')
        check_vtk(checks, what, run)


def check_part(checks):
    """A slave that overhangs its master: nodes beyond have no gap, the minimum is over the others."""
    blocks = Blocks((4, 4), 4)
    blocks.upper.x[:, 0] += WIDTH/2
    blocks.upper.x[:, 1] += 0.1
    step = f'*STEP\n*DYNAMIC, DIRECT\n1e-3, 1e-2\n{requests()}*END STEP\n'
    run = run_deck(blocks.text() + step)
    gaps = last_frame(run, 'CDIS')[blocks.slaves()]
    checks.true(np.array_equal(np.isnan(gaps), [False, False, False, True, True]),
                f'overhang: NaN beyond the end of the master only, {gaps}')
    checks.close(run['history/contact_TOP-BASE/CDIS'], np.full(11, 0.1), 1e-12,
                 'overhang: the printed gap is that of the others')


def check_words(checks):
    """Words of *CONTACT FILE and PRINT, alone."""
    blocks = Blocks((2, 2), 4)
    for words, fields in (('CSTR', {'CPRESS'}), ('CPRESS', {'CPRESS'}), ('CSLIP', {'CSLIP'}),
                          ('CSTATE', {'CSTATE'}), ('CF', {'CF', 'CPRESS'}),
                          ('CDIS', {'CDIS', 'CSLIP', 'CSTATE'})):
        text = pressed().replace('*CONTACT FILE\nCF, CDIS', f'*CONTACT FILE\n{words}')
        run = run_deck(blocks.text() + text.replace('CF, CDIS, CPRESS', words))
        checks.true(set(run.file['VTKHDF/PointData']) == {'U'} | fields, f'{words}: the fields')
        columns = {'CSTR': {'CPRESS'}, 'CSTATE': {'CNUM'}, 'CDIS': {'CDIS', 'CSLIP'},
                   'CF': {'CF1', 'CF2', 'CF3', 'impulse', 'CNUM'}}.get(words, fields)
        checks.true(set(run.file['history/contact_TOP-BASE']) == columns, f'{words}: the columns')


def check_sets_of_gaps(checks):
    """Gaps of two sets in turns: a column each."""
    gaps = ''.join(f'*ELEMENT, TYPE=GAPUNI, ELSET={name}\n{10 + i}, {2*i + 1}, {2*i + 2}\n'
                   for i, name in enumerate('XYX'))
    run = run_deck('*NODE\n' + ''.join(f'{n}, {n}, 0\n' for n in range(1, 7))
                   + '*ELEMENT, TYPE=MASS, ELSET=M\n' + ''.join(f'{n}, {n}\n' for n in range(1, 7))
                   + '*MASS, ELSET=M\n1\n' + gaps + '*SURFACE INTERACTION, NAME=K\n*IMPACT\n'
                   '*GAP, ELSET=X, INTERACTION=K\n0, 1, 0, 0\n*GAP, ELSET=Y, INTERACTION=K\n0, 1, 0, 0\n'
                   '*STEP\n*DYNAMIC, DIRECT\n0.1, 1\n*CLOAD\n1, 1, 1\n2, 1, -1\n3, 1, 2\n4, 1, -2\n'
                   '5, 1, 4\n6, 1, -4\n*CONTACT PRINT\nCF\n*END STEP\n')
    for name, force in (('X', 1 + 4), ('Y', 2)):
        found = np.abs(run[f'history/contact_{name}/CF1'][1:])
        checks.at_most(np.abs(found - force).max(), 1e-12, f'gaps of the set {name}: their force')


def check_vtk(checks, what, run):
    """VTK reads all frames, NaN too."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader
    reader = vtkHDFReader()
    reader.SetFileName(str(run.path))
    reader.UpdateInformation()
    count = run.file['VTKHDF/Steps'].attrs['NSteps']
    good = []
    for k in range(count):
        reader.SetStep(k)
        reader.Update()
        data = reader.GetOutputDataObject(0).GetPointData()
        for name in run.file['VTKHDF/PointData']:
            values = run[f'VTKHDF/PointData/{name}']
            n = len(values)//count
            good.append(np.array_equal(vtk_to_numpy(data.GetArray(name)), values[k*n:(k + 1)*n],
                                       equal_nan=True))
    checks.true(len(good) == 6*count and all(good), f'{what}: VTK reads {count} frames')


def main():
    checks = Checks()
    check_pressures(checks)
    check_nodes(checks)
    check_surfaces(checks)
    check_slip(checks)
    check_open(checks)
    check_part(checks)
    check_words(checks)
    check_sets_of_gaps(checks)
    checks.finish()


if __name__ == '__main__':
    sys.exit(main())
