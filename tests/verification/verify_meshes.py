"""Meshes of gmsh and FreeCAD: their decks run, or say what to write instead.

The decks of input/from_gmsh and input/from_freecad, small meshes written as gmsh writes them, and, where the
Python package gmsh is installed, meshes that it makes now.
"""
import platform
import re
import subprocess
import sys

import numpy as np
from carom_case import INPUT, Checks, run_deck, scratch_folder
from gmsh_text import QUADS, TRIANGLES, gmsh_text

GMSH, FREECAD = INPUT / 'from_gmsh', INPUT / 'from_freecad'
EXPORT = FREECAD / 'export'
REST = """*SOLID SECTION, ELSET={part}, MATERIAL=m{elements}
*MATERIAL, NAME=m
*ELASTIC
100, 0.3
*DENSITY
1
*NSET, NSET=moving, ELSET={part}
*SURFACE, NAME=skin
{curve}
*RIGID SURFACE, NAME=floor, TYPE=PLANE
0, {floor}, 0
0, 1, 0
*SURFACE INTERACTION, NAME=hit
*IMPACT, METHOD=TRANSFORMATION
*CONTACT PAIR, INTERACTION=hit
skin, floor
*INITIAL CONDITIONS, TYPE=VELOCITY
moving, 2, -0.5
*STEP
*DYNAMIC, DIRECT
0.01, 0.1
*CONTACT PRINT
CF
*ENERGY PRINT
*END STEP
"""


def beside(mesh, part='part', curve='bottom', elements='', floor=-0.01, name='mesh.inp', tail=REST):
    """A deck that includes a mesh: a text, or None if it is there already."""
    folder = scratch_folder()
    if mesh is not None:
        (folder / name).write_text(mesh)
    deck = folder / 'deck.inp'
    deck.write_text(f'*INCLUDE, INPUT={name}\n'
                    + tail.format(part=part, curve=curve, elements=elements, floor=floor))
    return deck


def falls(checks, what, deck):
    """A deck of `beside` runs: the body hits the floor, and the energies balance."""
    run = run_deck(deck)
    error = np.abs(run['energy/balance_error']).max() / run['energy/total'][0]
    touched = run['history/contact_SKIN-FLOOR/CF2'].max()
    checks.true(error < 1e-9 and touched > 0, f'{what}: hits with {touched:.3g}, '
                f'energy to {error:.1e}')
    return run


def refused(checks, what, deck, *words, status=2):
    """A deck is refused with all these words in the message."""
    text = run_deck(deck, command='check', expect_status=status).text
    lost = [word for word in (*words, 'cure:') if word not in text]
    checks.true(not lost, f'{what}: refused with the cure {words[-1]!r} (missing: {lost})')


def written_as_gmsh_does(checks):
    """Small meshes in gmsh's format."""
    kinds = {'triangles': (TRIANGLES[:2], TRIANGLES[2:]), 'quadrilaterals': (QUADS[:1], QUADS[1:]),
             'both': (QUADS[:1], TRIANGLES[2:])}
    for kind, cells in kinds.items():
        for order in (1, 2):
            mesh = gmsh_text(cells, order, node_sets=order == 1, center=True)
            run = falls(checks, f'{kind} of order {order}', beside(mesh))
            checks.close(run['model/mass'][:, 1].sum(), 2.0, 1e-12, f'{kind} of order {order}: mass of both squares')
    mesh = gmsh_text()
    falls(checks, 'as plane strain', beside(mesh, elements=', ELEMENTS=CPE'))
    falls(checks, 'as a ring', beside(mesh, elements=', ELEMENTS=CAX'))
    names = ('it\'s_my_"part"', 'Längs/unten')
    falls(checks, 'names with quotes, umlauts',
          beside(gmsh_text(groups=names), part=names[0], curve=names[1]))
    falls(checks, 'no groups', beside(gmsh_text(groups=None), part='Surface1', curve='Line1'))


def refused_of_gmsh(checks):
    """Meshes that carom cannot take say what to set in gmsh."""
    mesh = gmsh_text()
    refused(checks, 'clockwise elements', beside(gmsh_text(clockwise=True)), 'clockwise', 'ReverseMesh')
    refused(checks, '9-node quadrilaterals', beside(mesh.replace('CPS4', 'M3D9')), 'M3D9',
            'Mesh.SecondOrderIncomplete = 1')
    refused(checks, 'volumes', beside(mesh.replace('CPS4', 'C3D10')), 'leave out the volumes')
    third = mesh.replace('*ELEMENT, type=T3D2, ELSET=Line1\n1, 1, 2',
                         '*ELEMENT, type=T3D2, ELSET=Line1\n1, 1, 2, 3, 4')
    refused(checks, 'lines of order 3', beside(third), 'Mesh.ElementOrder 1 or 2')
    refused(checks, 'out of the plane', beside(re.sub('6, 2, 1, 0', '6, 2, 0, 1', mesh)),
            'in the x, y plane')
    refused(checks, 'a number as name', beside(gmsh_text(groups=('17', 'bottom'))),
            'a name must not be a number')
    refused(checks, 'a comma in a name', beside(gmsh_text(groups=('part', 'foot,1'))),
            "unknown parameter '1'")
    refused(checks, 'nothing meshed', beside('*Heading\n a\n*NODE\n'), '*NODE has no data lines')
    refused(checks, 'a group of elements for one of nodes',
            beside(mesh, tail=REST.replace('\nmoving,', '\npart,')), 'ELSET=PART')
    refused(checks, 'a group without section', beside(gmsh_text((QUADS[:1], QUADS[1:])),
            part='Surface1'), 'has no section', 'a *SOLID SECTION card names')


def ring(checks, deck, what, off, pair='SKIN-FLOOR'):
    """The ring of input/from_gmsh bounces as its README says."""
    run = run_deck(deck)
    m, n = run['model/mass'], int(run['VTKHDF/NumberOfPoints'][0])
    speed = m[:, 1] @ run['VTKHDF/PointData/V'][-n:, 1] / m[:, 1].sum()
    impulse = run[f'history/contact_{pair}/impulse'].sum()
    energy = run['energy/balance_error'], run['energy/total']
    checks.close(m[:, 0].sum(), np.pi * 900 * 10 * 1.15e-9, 1e-3 * m[:, 0].sum(), f'{what}: mass')
    checks.close(speed, 1490, off, f'{what}: speed after the impact, mm/s')
    checks.close(impulse, m[:, 1].sum() * (speed + 2000), 1e-9, f'{what}: impulse is the momentum')
    checks.at_most(np.abs(energy[0]).max() / energy[1][0], 1e-10, f'{what}: balance of energy')
    checks.at_least(energy[1][-1] / energy[1][0], 0.999, f'{what}: energy kept')


def freecad(checks):
    """FreeCAD's deck at rest, whole and split, and the impact of its mesh."""
    rest = run_deck(EXPORT / 'FEMMeshGmsh.inp')
    up = sum(rest[f'history/{node}/RF2'][-1] for node in rest.file['history'] if node != 'time')
    checks.close(up, 1000, 1e-8, 'FreeCAD: the reactions carry the load')
    n = int(rest['VTKHDF/NumberOfPoints'][0])
    checks.close(rest['VTKHDF/PointData/U'][-n:, 1].min(), -0.010360, 1e-6, 'FreeCAD: sag of the crown')
    split = (EXPORT / 'FEMMeshGmsh.inp').read_text()
    whole = re.sub(r'\*INCLUDE,INPUT=(\S+)', lambda found: (EXPORT / found[1]).read_text(), split)
    same = run_deck(whole)
    checks.close(same['VTKHDF/PointData/U'], rest['VTKHDF/PointData/U'], 0, 'FreeCAD: in one file')
    older = whole.replace('*STEP, INC=2000', '*STEP').replace('1.0,1.0,1e-05,1.0\n', '')
    checks.close(run_deck(older)['VTKHDF/PointData/U'], rest['VTKHDF/PointData/U'], 0,
                 'FreeCAD: as older versions write the step')
    strain = run_deck(whole.replace('CPS6', 'CPE6'))
    sag = strain['VTKHDF/PointData/U'][-n:, 1].min()
    checks.true(-0.0104 < sag < -0.0090, f'FreeCAD: plane strain is stiffer, sag {-sag:.6f}')
    fell = run_deck(FREECAD / 'impact.inp')
    m = fell['model/mass'][:, 1]
    speed = m @ fell['VTKHDF/PointData/V'][-n:, 1] / m.sum()
    checks.close(speed, 230, 10, 'FreeCAD: the arch leaves the plane, mm/s')
    error = np.abs(fell['energy/balance_error']).max() / fell['energy/total'][0]
    checks.at_most(error, 1e-10, 'FreeCAD: balance of energy of the impact')
    folder = scratch_folder()
    subprocess.run([sys.executable, FREECAD / 'make_arch.py', folder], check=True)
    for path in folder.iterdir():
        checks.true(path.read_text() == (EXPORT / path.name).read_text(), f'{path.name} is as made')
    for what, old, new, words in (
            ('shells', 'TYPE=CPS6', 'TYPE=S6', 'set the model space of the solver'),
            ('a section of shells', '*SOLID SECTION', '*SHELL SECTION', 'write *SOLID SECTION'),
            ('large displacements', '*STEP, INC=2000', '*STEP, INC=2000, NLGEOM', 'NLGEOM'),
            ('direct increments', '*STATIC\n', '*STATIC, DIRECT\n', 'DIRECT'),
            ('expansion', '*ELASTIC', '*EXPANSION, ZERO=0\n1e-5\n*ELASTIC', 'no temperatures here')):
        refused(checks, f'FreeCAD: {what}', whole_deck(whole.replace(old, new)), words)


def whole_deck(text):
    """A deck on disk."""
    path = scratch_folder() / 'whole.inp'
    path.write_text(text)
    return path


def main():
    checks = Checks()
    written_as_gmsh_does(checks)
    refused_of_gmsh(checks)
    ring(checks, GMSH / 'ring.inp', 'the ring', 1.0)
    checks.at_most((GMSH / 'mesh' / 'ring.inp').stat().st_size, 60000, 'size of the mesh file, bytes')
    freecad(checks)
    try:
        import gmsh
    except (ImportError, OSError) as error:
        # there are wheels of gmsh for this machine alone
        checks.skip(f'new meshes, as gmsh is not here ({error}); all decks were run',
                    installed=platform.machine() == 'x86_64')
    else:
        import made_by_gmsh
        made_by_gmsh.check(checks, gmsh)
    checks.finish()


if __name__ == '__main__':
    main()
