"""Meshes that gmsh makes now: its own .inp files, and those of mesh_from_gmsh.py; for verify_meshes.py."""

import contextlib
import io

import numpy as np
from carom_case import INPUT, run_deck, scratch_folder      # finds the scripts too
import mesh_from_gmsh
from carom_results import Result
from verify_meshes import REST, beside, falls, refused, ring

GEO = INPUT / 'from_gmsh' / 'ring.geo'


def model_of(gmsh, order, quads, incomplete=1):
    """A disc beside a square: two surfaces with groups."""
    gmsh.initialize(['gmsh'], readConfigFiles=False, interruptible=False)
    for name, value in {'General.Terminal': 0, 'Mesh.MeshSizeMax': 0.4, 'Mesh.RecombineAll': quads,
                        'Mesh.SecondOrderIncomplete': incomplete}.items():
        gmsh.option.setNumber(name, value)
    square, disc = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1), gmsh.model.occ.addDisk(3, 1, 0, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [square, disc], name='part')
    edges = gmsh.model.getBoundary([(2, square)], oriented=False)
    gmsh.model.addPhysicalGroup(1, [tag for _, tag in edges], name='bottom')
    gmsh.model.addPhysicalGroup(0, [1], name='corner')
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(order)


def exported(gmsh, change=None):
    """The .inp text of the open model; closes it."""
    if change:
        change(gmsh)
    path = scratch_folder() / 'mesh.inp'
    gmsh.write(str(path))
    gmsh.finalize()
    return path.read_text()


def written(checks, gmsh):
    """gmsh's own .inp files: orders 1 and 2, triangles and quadrilaterals, with and without node
    sets, and what carom refuses; a .geo with a clockwise surface."""
    for order, quads, sets in ((1, 0, 0), (1, 1, 1), (2, 0, 1), (2, 1, 0)):
        model_of(gmsh, order, quads)
        mesh = exported(gmsh, lambda gmsh: gmsh.option.setNumber('Mesh.SaveGroupsOfNodes', sets))
        what = f'gmsh: order {order}, {("triangles", "quadrilaterals")[quads]}, node sets {sets}'
        run = falls(checks, what, beside(mesh))
        checks.true(('NSET=corner' in mesh) == bool(sets), f'{what}: the group of a point')
        area = run['model/mass'][:, 0].sum()
        checks.close(area, 1 + np.pi, 0.01 if order == 2 else 0.2, f'{what}: area')
    model_of(gmsh, 2, 1, incomplete=0)
    refused(checks, 'gmsh: 9 nodes', beside(exported(gmsh)), 'Mesh.SecondOrderIncomplete = 1')
    model_of(gmsh, 3, 0)
    refused(checks, 'gmsh: order 3', beside(exported(gmsh)), 'Mesh.ElementOrder 1 or 2')
    model_of(gmsh, 1, 0)
    everything = exported(gmsh, lambda gmsh: gmsh.model.removePhysicalGroups())
    refused(checks, 'gmsh: no groups, one of two surfaces', beside(everything, part='Surface1',
            curve='Line1'), 'has no section')
    turned = scratch_folder() / 'turned.geo'
    for words, sound in (('ReverseMesh Surface {1};', True), ('', False)):
        turned.write_text('Point(1) = {0, 0, 0, 0.3}; Point(2) = {1, 0, 0, 0.3}; Point(3) = {0, 1, 0, 0.3};\n'
                          'Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 1};\nCurve Loop(1) = {-3, -2, -1};\n'
                          f'Plane Surface(1) = {{1}};\n{words}\nPhysical Surface("part") = {{1}};\n'
                          'Physical Curve("bottom") = {1};\n')
        deck = beside(inp_of(gmsh, turned))
        if sound:
            falls(checks, 'gmsh: a clockwise surface turned by ReverseMesh', deck)
        else:
            refused(checks, 'gmsh: a clockwise surface', deck, 'clockwise', 'ReverseMesh')
    return turned


def inp_of(gmsh, geo):
    """What gmsh writes of a .geo file."""
    gmsh.initialize(['gmsh'], readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber('General.Terminal', 0)
    gmsh.open(str(geo))
    gmsh.model.mesh.generate(2)
    return exported(gmsh)


def made(checks, what, *words, status=0, says=''):
    """Runs mesh_from_gmsh.py; the file it writes."""
    path = scratch_folder() / 'mesh.inc'
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
        try:
            ended = mesh_from_gmsh.main([*map(str, words), '-o', str(path)])
        except SystemExit as end:    # of the command line
            ended = end.code
    good = ended == status and says in text.getvalue()
    checks.true(good, f'{what}: status {ended}, says {says!r}' + (not good) * text.getvalue())
    return path


def bodies(checks):
    """The bodies of mesh_from_gmsh.py have their areas, surfaces and sets."""
    # a body, its words, the area and how far off, its lowest y
    for words, area, off, curve, low in (
            ('disc --size 0.3 --order 2', np.pi, 1e-3, 'DISC_RIM', -1),
            ('disc --size 0.3 --quads', np.pi, 0.05, 'DISC_RIM', -1),
            ('ring --inner 0.8 --size 0.1 --quads --order 2', 0.36 * np.pi, 1e-4, 'RING_RIM', -1),
            ('plate --hole 0.2 --order 2 --size 0.2', 2 - 0.04 * np.pi, 1e-3, 'PLATE_BOTTOM', -0.5),
            ('plate --crack 0.5 --angle 30 --order 2 --size 0.2', 2, 1e-12, 'PLATE_BOTTOM', -0.5)):
        name, (body, *_) = words, words.split()
        path = made(checks, name, *words.split(), says=f'SURFACE {curve}')
        rest = REST.replace('*SURFACE, NAME=skin\n{curve}\n', '').replace('skin,', f'{curve},')
        rest = rest.format(part=body, elements='', floor=low - 0.002)
        run = run_deck(f'*INCLUDE, INPUT={path}\n' + rest)
        checks.close(run['model/mass'][:, 0].sum(), area, off, f'{name}: area')
        checks.at_least(run[f'history/contact_{curve}-FLOOR/CF2'].max(), 1e-3, f'{name}: hits the floor')
        if '--crack' in words:
            x = run['VTKHDF/Points'][:, :2]
            sides = path.read_text().split('NAME=PLATE_CRACK\n')[1].count(', S')
            double = len(x) - len(np.unique(np.round(x, 9), axis=0))
            checks.true(sides > 0 and sides % 2 == 0 and double == sides - 1,
                        f'{name}: {sides} sides on both faces, {double} nodes doubled')
    for words, size in (('0.05', '0.0125'), ('0.05 --order 2', '0.0125'), ('0.2 --size 0.3', '0.05')):
        made(checks, f'a crack of {words}', 'plate', '--crack', *words.split(), status=1,
             says=f'--size {size} or less')
    made(checks, 'a short crack', 'plate', '--crack', 0.2, '--size', 0.05, says='SURFACE PLATE_CRACK: 8 sides')
    for words in (['--scale', 'nan'], ['--size', 'inf'], ['--at', '0', 'nan'], ['--crack', 'nan']):
        made(checks, f'{words}', 'plate', *words, status=2, says='no finite number')
    path = made(checks, 'bolt', 'bolt', '--type', 'CAX', '--order', 2, '--size', 0.5,
                says='SURFACE BOLT_TIP')
    checks.true('TYPE=CAX6' in path.read_text(), 'bolt: axisymmetric elements')


def files(checks, gmsh, turned):
    """Files of gmsh and CAD through mesh_from_gmsh.py."""
    path = made(checks, 'ring.geo', GEO, '--type', 'CPS', says='NSET TOP')
    deck = (INPUT / 'from_gmsh' / 'ring.inp').read_text()
    for old, new in (('mesh/ring.inp', str(path)), ('*SURFACE, NAME=skin\nrim\n', ''),
                     ('skin, floor', 'rim, floor')):
        deck = deck.replace(old, new)
    ring(checks, deck, 'ring.geo', 45, 'RIM-FLOOR')
    made(checks, 'a clockwise .geo', turned, says='ran clockwise and were turned')
    folder = scratch_folder()
    gmsh.initialize(['gmsh'], readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber('General.Terminal', 0)
    gmsh.model.occ.addRectangle(0, 0, 0, 20, 10)
    gmsh.model.occ.synchronize()
    gmsh.write(str(folder / 'face.step'))
    gmsh.model.mesh.generate(2)
    gmsh.write(str(folder / 'face.msh'))
    gmsh.model.occ.addBox(0, 0, 5, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.write(str(folder / 'solid.step'))
    gmsh.finalize()
    path = made(checks, 'a face', folder / 'face.step', '--size', 5, '--scale', 0.1, '--at', 1, 0,
                says='SURFACE PART_OUTLINE')
    nodes = path.read_text().split('*NODE\n')[1].split('*')[0].splitlines()
    x = np.array([line.split(',')[1:] for line in nodes], float)
    checks.close([*x.min(axis=0), *x.max(axis=0)], [1, 0, 3, 1], 1e-9, 'a face: scaled and moved')
    made(checks, 'a .msh', folder / 'face.msh', says='ELSET, NSET PART')
    made(checks, 'a .msh of a size', folder / 'face.msh', '--size', 1, status=1, says='it is a mesh')
    made(checks, 'a solid', folder / 'solid.step', status=1, says='draw the body in the x, y plane')
    made(checks, 'no file', folder / 'none.geo', status=1, says='there is no file')
    made(checks, 'an unknown body', 'sphere', status=1, says='neither a body')


def names(checks, turned):
    """Groups of any letters: a deck finds them under their own names."""
    geo = turned.with_name('names.geo')
    text = turned.read_text()
    geo.write_text(text.replace('"part"', '"größe, é"').replace('"bottom"', '"Straße ½"'))
    path = made(checks, 'groups of any letters', geo, says='SURFACE STRAßE_½')
    rest = REST.replace('*SURFACE, NAME=skin\n{curve}\n', '').replace('skin,', 'straße_½,')
    deck = f'*INCLUDE, INPUT={path}\n' + rest.format(part='größe_é', elements='', floor=-0.002)
    with Result(run_deck(deck).path) as result:
        force = result.contact('stra ße_½-floor').CF2
        checks.true(force.max() > 0 and result.contacts == ['STRAßE_½-FLOOR'],
                    f'a deck names groups of any letters: force {force.max():.3g}')


    geo.write_text(text.replace('"part"', '"a/b"').replace('"bottom"', '"A b"'))
    made(checks, 'names that are one in a deck', geo, status=1, says="'A b' and 'a/b', are both 'A_B'")


def check(checks, gmsh):
    """All of it; `gmsh` is the module."""
    turned = written(checks, gmsh)
    ring_mesh = inp_of(gmsh, GEO)
    folder = scratch_folder()
    (folder / 'mesh').mkdir()
    (folder / 'mesh' / 'ring.inp').write_text(ring_mesh)
    deck = folder / 'ring.inp'
    deck.write_text((INPUT / 'from_gmsh' / 'ring.inp').read_text())
    ring(checks, deck, 'the ring meshed anew', 45)
    bodies(checks)
    files(checks, gmsh, turned)
    names(checks, turned)
