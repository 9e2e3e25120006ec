"""Writes the arch in the files of FreeCAD's FEM workbench: python make_arch.py [FOLDER]

The cards, comments and number formats are those of FreeCAD 1.0 with the solver CalculiX: model space
"plane stress", analysis type "static", split input writer. In place of FreeCAD's mesh generator stands
half a ring cut into 6-node triangles.
"""

import sys
from pathlib import Path

import numpy as np

INSIDE, OUTSIDE, THICKNESS = 48.0, 60.0, 10.0     # mm
ROUND, ACROSS = 40, 2                             # quadrilaterals, each cut into two triangles
LOAD = 1000.0                                     # N, down, on the crown
MESH = "FEMMeshGmsh"
RULE = "*" * 59


def arch():
    """Points (n, 2) and triangles of 6 nodes: corners, then the middles of 1-2, 2-3, 3-1."""
    n_round, n_across = 2 * ROUND + 1, 2 * ACROSS + 1
    angle = np.linspace(0.0, np.pi, n_round)
    radius = np.linspace(INSIDE, OUTSIDE, n_across)
    x = radius[None, :] * np.cos(angle)[:, None]
    y = radius[None, :] * np.sin(angle)[:, None]
    x, y = np.round(x, 9) + 0.0, np.round(y, 9) + 0.0     # the same on every machine
    number = np.arange(n_round * n_across).reshape(n_round, n_across)
    triangles = []
    for i in range(0, n_round - 1, 2):
        for j in range(0, n_across - 1, 2):
            a, ab, b = number[i, j : j + 3]
            ad, middle, bc = number[i + 1, j : j + 3]
            d, dc, c = number[i + 2, j : j + 3]
            triangles += [[a, b, c, ab, bc, middle], [a, c, d, middle, dc, ad]]
    return np.stack([x.ravel(), y.ravel()], axis=1), triangles


def mesh_cards(x, triangles):
    """The file of the mesh."""
    lines = ["** written by FreeCAD inp file writer for CalculiX,Abaqus meshes",
             "** highest dimension mesh elements only.", "", "** Nodes", "*Node, NSET=Nall"]
    lines += [f"{i}, {a:.13g}, {b:.13g}, 0" for i, (a, b) in enumerate(x, 1)]
    lines += ["", "", "** Face elements", "*Element, TYPE=CPS6, ELSET=Efaces"]
    lines += [", ".join(str(k) for k in [i, *(int(node) + 1 for node in nodes)])
              for i, nodes in enumerate(triangles, 1)]
    lines += ["", "** Define element set Eall", "*ELSET, ELSET=Eall", "Efaces", ""]
    return "\n".join(lines)


def titled(*lines):
    """A part of the main file, with FreeCAD's rule above it."""
    return ["", RULE, *lines]


def main_file(crown):
    """The cards around the mesh: sets, material, section, step, support, load, output."""
    lines = [RULE, "** femesh", f"*INCLUDE,INPUT={MESH}_femesh.inp"]
    lines += titled("** Element sets for materials and FEM element type (solid, shell, beam, fluid)",
                    "*ELSET,ELSET=MaterialSolidElementGeometry2D", "Efaces")
    lines += titled("** constraints fixed node sets",
                    f"*INCLUDE,INPUT={MESH}_constraints_fixed_node_sets.inp")
    lines += titled("** Materials", "** see information about units at file end",
                    "** FreeCAD material name: CalculiX-Steel", "** MaterialSolid",
                    "*MATERIAL, NAME=MaterialSolid", "*ELASTIC", "210000,0.3")
    lines += titled("** Sections", "*SOLID SECTION, ELSET=MaterialSolidElementGeometry2D, "
                    "MATERIAL=MaterialSolid", f"{THICKNESS:.13G}")
    lines += titled("** At least one step is needed to run an CalculiX analysis of FreeCAD",
                    "*STEP, INC=2000", "*STATIC", "1.0,1.0,1e-05,1.0", "")
    lines += titled("** Fixed Constraints", "** ConstraintFixed", "*BOUNDARY",
                    "ConstraintFixed,1", "ConstraintFixed,2", "")
    lines += titled("** constraints force node loads", "*CLOAD", "** ConstraintForce",
                    "** node load on shape: Arch:Vertex3", f"{crown},2,{-LOAD:.13G}", "", "")
    lines += titled("** Outputs --> frd file", "*NODE FILE, OUTPUT=2d", "U", "*EL FILE", "S, E",
                    "** outputs --> dat file", "** reaction forces for Constraint fixed",
                    "*NODE PRINT, NSET=ConstraintFixed, TOTALS=ONLY", "RF", "",
                    "*OUTPUT, FREQUENCY=1")
    lines += titled("*END STEP ")
    return "\n".join(lines) + "\n"


def node_set(nodes):
    """A file with one set of nodes, a node a line."""
    return "\n".join(["** ConstraintFixed", "*NSET,NSET=ConstraintFixed",
                      *(f"{node}," for node in nodes)]) + "\n"


def main():
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "export")
    x, triangles = arch()
    feet = [i for i, (_, y) in enumerate(x, 1) if y == 0.0]
    crown = int(np.argmin(np.hypot(x[:, 0], x[:, 1] - OUTSIDE))) + 1
    (folder / f"{MESH}_femesh.inp").write_text(mesh_cards(x, triangles))
    (folder / f"{MESH}_constraints_fixed_node_sets.inp").write_text(node_set(feet))
    (folder / f"{MESH}.inp").write_text(main_file(crown))


if __name__ == "__main__":
    main()
