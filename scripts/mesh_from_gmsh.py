"""Makes a plane mesh with gmsh and writes it as cards for *INCLUDE: mesh_from_gmsh.py WHAT -o mesh.inc

WHAT is a body (disc, ring, plate, bolt) or a file of gmsh (.geo, .msh) or of CAD (.step, .stp, .brep,
.iges, .igs) with a face in the x, y plane. Physical groups become sets and surfaces:

    of surfaces   ELSET and NSET of that name; what is in no group is left out. PART without groups
    of curves     NSET and, where they bound the body, *SURFACE of that name
    of points     NSET of that name

Without groups of curves the *SURFACE PART_OUTLINE has all sides of the body. In names a to z become
A to Z, and blanks and any of , = " ' / * < > become _. Elements are turned counterclockwise, nodes without
elements left out, 9-node elements written with 8. Needs the Python package gmsh (pip install gmsh)
and the system's libraries of OpenGL and X11.

    mesh_from_gmsh.py disc --radius 1 --size 0.1 --order 2 -o disc.inc      DISC, DISC_RIM
    mesh_from_gmsh.py ring --radius 1 --inner 0.8 --size 0.05 --quads -o ring.inc    ... RING_BORE
    mesh_from_gmsh.py plate --hole 0.2 --at 0 3 --name TARGET -o plate.inc  TARGET, TARGET_LEFT ...
    mesh_from_gmsh.py plate --crack 0.5 --angle 30 -o cracked.inc           PLATE_CRACK: both faces
    mesh_from_gmsh.py bolt --radius 1 --length 6 --type CAX -o bolt.inc     BOLT_TIP, _HEAD, _AXIS
    mesh_from_gmsh.py part.geo -o part.inc --type CPE
    mesh_from_gmsh.py part.step --size 2 --scale 0.001 -o part.inc
"""

import argparse
import sys
from pathlib import Path

from carom_script import ScriptError, finite
from gmsh_bodies import BODIES
from gmsh_mesh import PlaneMesh, cards, clean_name

PACKAGES = "libglu1-mesa libgl1 libxcursor1 libxft2 libxinerama1 libgomp1"
FILES = (".geo", ".msh", ".step", ".stp", ".brep", ".iges", ".igs")


def load_gmsh():
    """The module gmsh, or what to install."""
    try:
        import gmsh
    except ImportError as error:
        raise ScriptError(f"the Python package gmsh is missing ({error}): "
                          f"{sys.executable} -m pip install gmsh") from error
    except OSError as error:
        raise ScriptError(f"gmsh needs a library of the system ({error}): "
                          f"on Debian and Ubuntu apt-get install {PACKAGES}") from error
    return gmsh


def set_options(gmsh, options):
    """What the command line says of the mesh."""
    numbers = {"General.Terminal": 0, "General.NumThreads": 1, "Mesh.SecondOrderIncomplete": 1}
    if options.size:
        numbers.update({"Mesh.MeshSizeMin": options.size, "Mesh.MeshSizeMax": options.size})
    if options.quads:
        numbers.update({"Mesh.RecombineAll": 1, "Mesh.Algorithm": 8})
    for name, value in numbers.items():
        gmsh.option.setNumber(name, value)


def draw_body(gmsh, options):
    """Draws one of the bodies, moved to its place, with its groups; the name of its crack."""
    model = gmsh.model
    model.add(options.what)
    name = clean_name(options.name or options.what)
    for part, (dimension, tags) in BODIES[options.what](model, options).items():
        model.addPhysicalGroup(dimension, tags, name=f"{name}_{part}" if part else name)
    return f"{name}_CRACK" if getattr(options, "crack", 0) else None


def open_file(gmsh, options):
    """Opens a file; one of CAD has no groups."""
    path = Path(options.what)
    if path.suffix.lower() not in FILES:
        raise ScriptError(f"'{path}' is neither a body ({', '.join(BODIES)}) nor a file that "
                          f"ends in {', '.join(FILES)}")
    if not path.is_file():
        raise ScriptError(f"there is no file '{path}'")
    if path.suffix.lower() == ".msh" and (options.size or options.quads or options.order):
        raise ScriptError("--size, --quads and --order do not change a .msh file: it is a mesh")
    gmsh.open(str(path))
    # the file's own options come last otherwise
    set_options(gmsh, options)


def make_mesh(gmsh, options):
    """The mesh of a body or of a file."""
    crack = None
    try:
        set_options(gmsh, options)
        if options.what in BODIES:
            options.size = options.size or default_size(options)
            set_options(gmsh, options)
            crack = draw_body(gmsh, options)
        else:
            open_file(gmsh, options)
        if len(gmsh.model.mesh.getElementTypes(2)) == 0:
            gmsh.model.mesh.generate(2)
        order = options.order or int(gmsh.option.getNumber("Mesh.ElementOrder"))
        if Path(options.what).suffix.lower() != ".msh":
            gmsh.model.mesh.setOrder(order)
    except ScriptError:
        raise
    except Exception as error:     # gmsh raises Exception itself
        raise ScriptError(f"gmsh: {error}") from error
    mesh = PlaneMesh(gmsh)
    if crack:
        mesh.split(crack)
    mesh.x = mesh.x * options.scale + options.at
    return mesh


def default_size(options):
    """The size of elements where the command line gives none."""
    extent = {"disc": 2 * options.radius, "ring": 4 * (options.radius - options.inner),
              "plate": min(options.width, options.height), "bolt": 2 * options.radius}
    return extent[options.what] / 12


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", metavar="WHAT", help="disc, ring, plate, bolt or a file")
    parser.add_argument("-o", "--output", required=True, help="the file to write")
    parser.add_argument("--type", choices=["CPE", "CPS", "CAX"], default="CPE",
                        help="plane strain (default), plane stress, axisymmetric")
    parser.add_argument("--order", type=int, choices=[1, 2],
                        help="of the elements (default: 1, of a .geo what it says)")
    parser.add_argument("--size", type=finite, help="of the elements")
    parser.add_argument("--quads", action="store_true", help="quadrilaterals where that can be")
    parser.add_argument("--scale", default=1.0, type=finite, help="factor of all coordinates")
    parser.add_argument("--at", nargs=2, default=(0.0, 0.0), metavar=("X", "Y"), type=finite,
                        help="what is added to them after that")
    parser.add_argument("--name", help="of a body's sets (default: the body)")
    parser.add_argument("--first-node", type=int, default=1, help="its number (default 1)")
    parser.add_argument("--first-element", type=int, default=1, help="its number (default 1)")
    body = parser.add_argument_group("measures of bodies")
    for name, value, what in (
            ("radius", 1.0, "disc, ring; shank of the bolt"), ("inner", 0.7, "of the ring"),
            ("width", 2.0, "of the plate"), ("height", 1.0, "of the plate"),
            ("hole", 0.0, "its radius"), ("crack", 0.0, "its length"),
            ("angle", 0.0, "of the crack to the x axis, degrees"),
            ("length", 6.0, "of the shank"), ("head", 0.0, "radius (default: twice the shank's)"),
            ("thickness", 0.0, "of the head (default: the shank's radius)")):
        body.add_argument(f"--{name}", default=value, help=f"{what} (default {value:g})"
                          if value else what, type=finite)
    options = parser.parse_args(arguments)
    if options.size is not None and options.size <= 0 or options.scale <= 0:
        parser.error("--size and --scale must be positive")
    if options.first_node < 1 or options.first_element < 1:
        parser.error("--first-node and --first-element must be positive")
    return options


def report(mesh, options):
    """What was written, in a few lines."""
    print(f"{options.output}: {len(mesh.x)} nodes, {len(mesh.elements)} elements {options.type}")
    for name, group in mesh.areas.items():
        print(f"  ELSET, NSET {name}: {len(group)} elements")
    for name in mesh.curves:
        sides = len(mesh.surface(name))
        print(f"  NSET {name}" + (f", SURFACE {name}: {sides} sides" if sides
                                  else ": inside the body, no surface"))
    if not mesh.curves:
        print(f"  SURFACE {mesh.outline_name()}: {len(mesh.outline())} sides")
    for name in mesh.points:
        print(f"  NSET {name}")
    if mesh.turned:
        print(f"  {mesh.turned} elements ran clockwise and were turned")


def main(arguments=None):
    """Does what the words of the command line say; the exit status."""
    words = sys.argv[1:] if arguments is None else arguments
    options = parse(words)
    try:
        gmsh = load_gmsh()
        gmsh.initialize(["gmsh"], readConfigFiles=False, interruptible=False)
        try:
            mesh = make_mesh(gmsh, options)
        finally:
            version = gmsh.option.getString("General.Version")
            gmsh.finalize()
        heading = f"gmsh {version}: mesh_from_gmsh.py {' '.join(words)}"
        text = cards(mesh, options.type, options.first_node, options.first_element, heading)
        Path(options.output).write_text(text, encoding="utf-8")
        report(mesh, options)
    except (ScriptError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
