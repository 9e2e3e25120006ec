"""Means over elements are weighted by volume: the mean energy density times the volume is the strain
energy, and means of known strains are their integrals, in skew and in axisymmetric elements."""
import numpy as np

from carom_case import Checks, run_deck
from solid_mesh import Mesh

THICKNESS = 0.3
KINDS = ('CPE4', 'CPS4', 'CAX4', 'CPE8', 'CPS8', 'CAX8', 'CPE6', 'CPS6', 'CAX6', 'CPS3', 'CAX3')


def skew(s, t):
    """A quadrilateral with four different sides; straight lines stay straight."""
    return 2 + s + 0.3*t + 0.4*s*t, 1.2*t + 0.2*s - 0.3*s*t


def deck(kind, mesh, moves, prints):
    """A static step that moves every node of a mesh."""
    given = '*BOUNDARY\n' + ''.join(f'{i + 1}, 1, 1, {float(u)!r}\n{i + 1}, 2, 2, {float(v)!r}\n'
                                    for i, (u, v) in enumerate(moves))
    return (mesh.text(kind, 'body', 1, 1) + '*MATERIAL, NAME=steel\n*ELASTIC\n1000, 0.3\n*DENSITY\n1\n'
            f'*SOLID SECTION, ELSET=body, MATERIAL=steel\n{THICKNESS}\n*STEP\n*STATIC\n1, 1\n{given}'
            f'*EL PRINT\n{prints}\n*EL FILE\n{prints}\n*ENERGY PRINT\n*END STEP\n')


def volume(kind, corners):
    """Of an element with straight sides; of axisymmetric ones by Pappus, all around."""
    x, y = corners.T
    after = np.roll(corners, -1, axis=0).T
    cross = x*after[1] - after[0]*y
    if 'CAX' in kind:
        return 2*np.pi*np.sum((x + after[0])*cross)/6
    return THICKNESS*np.sum(cross)/2


def check_energy(checks):
    """Sum of ENER times volume = strain energy; cells have the same ENER."""
    for kind in KINDS:
        nodes = int(kind[-1])
        mesh = Mesh(2, 2, nodes, skew, straight=True)
        x, y = np.array(mesh.x).T
        moves = 1e-3*np.column_stack((x*x + 0.5*x*y, y*y*x - x))
        run = run_deck(deck(kind, mesh, moves, 'ENER'))
        density = np.array([run[f'history/element_{e + 1}/ENER'][-1]
                            for e in range(len(mesh.elements))])
        corners = 3 if nodes in (3, 6) else 4
        volumes = [volume(kind, np.array(mesh.x)[list(e[:corners])]) for e in mesh.elements]
        strain = run['energy/strain'][-1]
        checks.close(density @ volumes/strain, 1, 1e-12, f'{kind}: ENER times volume')
        checks.close(np.ravel(run['VTKHDF/CellData/ENER'])[-len(density):], density, 0,
                     f'{kind}: ENER of cells')


def check_radial(checks):
    """u = r^2/1000 in a ring from 2 to 3: the mean of E11 = r/500 is 2/500 (27 - 8)/3/(9 - 4)."""
    for nodes in (8, 6):
        mesh = Mesh(1, 1, nodes, lambda s, t: (2 + s, t))
        r = np.array(mesh.x)[:, 0]
        run = run_deck(deck(f'CAX{nodes}', mesh, np.column_stack((r*r/1000, 0*r)), 'E'))
        means = np.array([run[f'history/element_{e + 1}/E11'][-1]
                          for e in range(len(mesh.elements))])
        volumes = np.array([volume('CAX', np.array(mesh.x)[list(e[:4 if nodes == 8 else 3])])
                            for e in mesh.elements])
        exact = 2/500*(27 - 8)/3/(9 - 4)
        checks.close(means @ volumes/volumes.sum(), exact, 1e-15, f'CAX{nodes}: mean radial strain')


def main():
    checks = Checks()
    check_energy(checks)
    check_radial(checks)
    checks.finish()


main()
