"""Result files as ParaView sees them: VTK reads the frames, warps them by U, and draws them off screen.

Needs, beside the Python packages, the system's libX11, libXrender and an OpenGL of its own that draws without
a display: on Debian and Ubuntu the packages libegl1 libgl1 libxrender1.
"""
import ctypes.util
import os
import sys

import h5py
import numpy as np
from carom_case import INPUT, Checks, run_deck, scratch_folder
from paraview_deck import VTK_TYPES, every_kind
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkFiltersGeneral import vtkWarpVector
from vtkmodules.vtkIOHDF import vtkHDFReader

SIZE = (480, 360)
PACKAGES = {'X11': 'libx11-6', 'Xrender': 'libxrender1', 'EGL': 'libegl1', 'GL': 'libgl1'}


def frame(path, step):
    """The grid of one frame."""
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    reader.SetStep(step)
    reader.Update()
    return reader.GetOutputDataObject(0)


def array(grid, where, name):
    """A field of a grid as an array."""
    data = grid.GetPointData() if where == 'point' else grid.GetCellData()
    return vtk_to_numpy(data.GetArray(name))


def warped(grid, factor=1.0):
    """What Warp By Vector makes of a grid with U."""
    warp = vtkWarpVector()
    warp.SetInputData(grid)
    warp.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, 'U')
    warp.SetScaleFactor(factor)
    warp.Update()
    return warp.GetOutput()


def places(grid):
    return vtk_to_numpy(grid.GetPoints().GetData())


def von_mises(s):
    """Of stresses in ParaView's order of symmetric tensors: XX YY ZZ XY YZ XZ."""
    t = np.zeros((len(s), 3, 3))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))):
        t[:, i, j] = t[:, j, i] = s[:, k]
    t -= np.trace(t, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3
    return np.sqrt(1.5 * np.sum(t**2, axis=(1, 2)))


def cells(checks):
    """Cell types, and fields with their components, of a deck with every kind of element."""
    deck, kinds = every_kind()
    run = run_deck(deck)
    last = int(run.file['VTKHDF/Steps'].attrs['NSteps']) - 1
    grid = frame(run.path, last)
    found = [grid.GetCellType(i) for i in range(grid.GetNumberOfCells())]
    for kind in VTK_TYPES:
        these = [found[i] for i, name in enumerate(kinds) if name == kind]
        checks.true(these and set(these) == {VTK_TYPES[kind]},
                    f'{kind} is VTK cell type {VTK_TYPES[kind]}: {these}')
    for i, name in enumerate(kinds):
        size = grid.GetCell(i).GetNumberOfPoints()
        if name[:3] in ('CPE', 'T2D'):
            checks.true(size == int(name[3]), f'cell {i + 1} ({name}) has {size} points')
    for name, n in (('U', 3), ('V', 3), ('A', 3), ('RF', 3), ('CF', 3), ('S', 6), ('E', 6), ('MISES', 1)):
        held = grid.GetPointData().GetArray(name)
        checks.true(held is not None and held.GetNumberOfComponents() == n,
                    f'{name} at points has {n} components')
    for where in ('point', 'cell'):
        s, mises = array(grid, where, 'S'), array(grid, where, 'MISES')
        checks.close(von_mises(s), mises, 1e-10 * mises.max(), f'MISES from S of each {where}')
        checks.at_least(mises.max(), 1.0, f'there are stresses at the {where}s')
    marks = {place: {key: np.asarray(value).item().decode() for key, value in
                     run.file[f'VTKHDF/{place}Data'].attrs.items()} for place in ('Point', 'Cell')}
    checks.true(marks == {'Point': {'Vectors': 'U', 'Tensors': 'S'}, 'Cell': {'Tensors': 'S'}},
                f'the active vector is U, the active tensor S: {marks}')
    middles(checks, grid, kinds)
    place = places(grid)
    checks.close(places(warped(grid)), place + array(grid, 'point', 'U'), 1e-12, 'Warp By Vector adds U')
    checks.close(array(frame(run.path, 0), 'point', 'U'), np.zeros_like(place), 0, 'no U at the start')


def middles(checks, grid, kinds):
    """The nodes of curved cells are in VTK's order: the middle nodes lie between their corners."""
    x = places(grid)
    for i, kind in enumerate(kinds):
        if kind not in ('CPE6', 'CPE8', 'T2D3'):
            continue
        ids = grid.GetCell(i).GetPointIds()
        p = x[[ids.GetId(k) for k in range(ids.GetNumberOfIds())]]
        n = {'CPE6': 3, 'CPE8': 4, 'T2D3': 2}[kind]
        expected = (p[:n] + np.roll(p[:n], -1, axis=0)) / 2 if n > 2 else (p[:1] + p[1:2]) / 2
        checks.close(p[n:], expected, 1e-12, f'middle nodes of cell {i + 1} ({kind})')


def shear(checks):
    """The fourth component of S is XY: a block under shear at rest."""
    run = run_deck(SHEAR)
    s = array(frame(run.path, 1), 'cell', 'S')
    checks.close(s, [[0, 0, 0, 2, 0, 0]], 1e-9, 'S of pure shear 2: XX YY ZZ XY YZ XZ')


SHEAR = """*NODE
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
*ELEMENT, TYPE=CPE4, ELSET=block
1, 1, 2, 3, 4
*MATERIAL, NAME=m
*ELASTIC
10, 0.25
*SOLID SECTION, ELSET=block, MATERIAL=m
*BOUNDARY
1, 1, 2, 0
2, 1, 2, 0
3, 1, 1, 0.5
4, 1, 1, 0.5
3, 2, 2, 0
4, 2, 2, 0
*STEP
*STATIC
*NODE FILE
U
*EL FILE
S
*END STEP
"""


def once(checks, path):
    """What does not change is in the file once: the mesh, and fields as long as they stay."""
    with h5py.File(path) as file:
        grid = file['VTKHDF']
        steps, points = int(grid['Steps'].attrs['NSteps']), len(grid['Points'])
        checks.at_least(steps, 3, 'frames of the picture')
        checks.true(len(grid['Points']) == grid['NumberOfPoints'][0]
                    and len(grid['Types']) == grid['NumberOfCells'][0], 'the mesh is there once')
        checks.true(not grid['Steps/PointOffsets'][:].any() and not grid['Steps/CellOffsets'][:].any(),
                    'every frame uses this mesh')
        for kind in ('PointData', 'CellData'):
            for name, data in grid[kind].items():
                n = points if kind == 'PointData' else len(grid['Types'])
                begins = grid[f'Steps/{kind}Offsets/{name}'][:steps]
                frames = [data[b : b + n] for b in begins]
                changes = sum(not np.array_equal(*pair) for pair in zip(frames, frames[1:]))
                checks.true(len(data) == (1 + changes) * n and len(set(begins)) == 1 + changes,
                            f'{kind}/{name}: {1 + changes} of {steps} frames, none of them twice')


def libraries():
    """Ends the test with the packages to install where VTK cannot draw."""
    missing = [PACKAGES[name] for name in PACKAGES if ctypes.util.find_library(name) is None]
    if missing:
        sys.exit(f'FAILED: VTK needs the Debian packages {" ".join(missing)} to draw: '
                 f'apt-get install {" ".join(missing)}')


def picture(grid, bounds, file=None):
    """Draws a grid off screen, coloured by MISES, as an array (rows, columns, 3)."""
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (the means to draw)
    from vtkmodules.vtkIOImage import vtkPNGWriter
    from vtkmodules.vtkRenderingCore import (vtkActor, vtkDataSetMapper, vtkRenderer, vtkRenderWindow,
                                             vtkWindowToImageFilter)

    mapper, actor = vtkDataSetMapper(), vtkActor()
    mapper.SetInputData(grid)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray('MISES')
    mapper.SetScalarRange(0, max(1e-9, array(grid, 'point', 'MISES').max()))
    actor.SetMapper(mapper)
    renderer, window = vtkRenderer(), vtkRenderWindow()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*SIZE)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    x, y, height = bounds
    camera.ParallelProjectionOn()
    camera.SetPosition(x, y, 1000)
    camera.SetFocalPoint(x, y, 0)
    camera.SetParallelScale(height / 2)
    renderer.ResetCameraClippingRange()
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    if file:
        writer = vtkPNGWriter()
        writer.SetFileName(str(file))
        writer.SetInputConnection(grab.GetOutputPort())
        writer.Write()
    image = grab.GetOutput()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars())
    return pixels.reshape(SIZE[1], SIZE[0], -1)[::-1, :, :3]


def drawn(checks):
    """The ring of input/from_gmsh, warped ten times: first frame round, then flat at the bottom."""
    libraries()
    run = run_deck(INPUT / 'from_gmsh' / 'ring.inp', end=1e-3)
    once(checks, run.path)
    steps = int(run.file['VTKHDF/Steps'].attrs['NSteps'])
    folder = os.environ.get('CAROM_PICTURES') or scratch_folder()
    view, factor = (0.0, 0.0, 160.0), 5.0
    seen = []
    for step, name in ((0, 'first'), (steps // 2, 'middle')):
        image = picture(warped(frame(run.path, step), factor), view, f'{folder}/{name}.png')
        seen.append(np.any(image < 250, axis=2))
        colours = len(np.unique(image.reshape(-1, 3), axis=0))
        checks.true(colours >= (2 if step == 0 else 20), f'{name} frame: {colours} colours')
    pixel = view[2] / SIZE[1]
    for step, mask in zip((0, steps // 2), seen):
        grid = warped(frame(run.path, step), factor)
        low, high = places(grid)[:, :2].min(axis=0), places(grid)[:, :2].max(axis=0)
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        found = [(columns[0] - SIZE[0] / 2) * pixel, (SIZE[1] / 2 - rows[-1] - 1) * pixel,
                 (columns[-1] + 1 - SIZE[0] / 2) * pixel, (SIZE[1] / 2 - rows[0]) * pixel]
        checks.close(found, [*low, *high], 2 * pixel, f'frame {step}: the outline in the picture')
    grown = [np.ptp(np.flatnonzero(mask.any(axis=axis))) for mask in seen for axis in (0, 1)]
    checks.true(grown[2] > grown[0] and grown[3] < grown[1],
                f'the ring is wider and lower in the middle: {grown} pixels')
    hole = ~seen[0][SIZE[1] // 2, SIZE[0] // 2]
    checks.true(hole and seen[0].any(), 'the ring has a hole')
    checks.close(seen[0].sum() * pixel**2, np.pi * 900, 85, 'its area in the picture')


def main():
    checks = Checks()
    cells(checks)
    shear(checks)
    drawn(checks)
    checks.finish()


if __name__ == '__main__':
    main()
