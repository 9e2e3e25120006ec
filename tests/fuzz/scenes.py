"""Small random decks of every feature: points, trusses, blocks that meet walls and each other."""
from fuzz_deck import Deck
from spoil import pick

# Nodes of an element in the corners of a cell (x, y in half cells), corners first
SHAPES = {
    "3": [[(0, 0), (2, 0), (2, 2)], [(0, 0), (2, 2), (0, 2)]],
    "4": [[(0, 0), (2, 0), (2, 2), (0, 2)]],
    "6": [[(0, 0), (2, 0), (2, 2), (1, 0), (2, 1), (1, 1)],
          [(0, 0), (2, 2), (0, 2), (1, 1), (1, 2), (0, 1)]],
    "8": [[(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]],
}


class Scene:
    """Lines of a deck in the making; ids of nodes and elements are counted up."""

    def __init__(self, rng):
        self.rng, self.lines, self.loads = rng, [], []
        self.n_nodes = self.n_elements = self.bodies = 0
        self.soft = rng.random() < 0.7      # or as hard as steel

    def add(self, *lines):
        """More lines of the model."""
        self.lines += lines

    def point(self, x, y, *springs):
        """A mass, perhaps with springs and dashpots to the ground; its node."""
        self.n_nodes += 1
        node = self.n_nodes
        self.add("*NODE", f"{node}, {x!r}, {y!r}")
        self.element("MASS", [node], "*MASS", pick(self.rng, ["1", "2.5", "1e-3"]))
        if self.rng.random() < 0.7:
            self.element("SPRING1", [node], "*SPRING", pick(self.rng, ["1", "2"]),
                         pick(self.rng, ["1", "100", "1e4"]))
        if self.rng.random() < 0.3:
            self.element("DASHPOT1", [node], "*DASHPOT", "1", pick(self.rng, ["0.1", "10"]))
        self.add(*springs)
        return node

    def element(self, kind, nodes, *section):
        """An element in a set of its own, with its section."""
        self.n_elements += 1
        name = f"E{self.n_elements}"
        self.add(f"*ELEMENT, TYPE={kind}, ELSET={name}",
                 f"{self.n_elements}, " + ", ".join(map(str, nodes)),
                 f"{section[0]}, ELSET={name}", *section[1:])
        return name

    def block(self, x, y, plane):
        """A block of a few solids with its corner at x, y; the name of the body."""
        rng = self.rng
        self.bodies += 1
        name = f"B{self.bodies}"
        kind = pick(rng, sorted(SHAPES))
        nx, ny = int(rng.integers(1, 4)), int(rng.integers(1, 4))
        size = pick(rng, [0.5, 1.0])
        nodes, elements = {}, []
        for i in range(nx):
            for j in range(ny):
                for shape in SHAPES[kind]:
                    elements.append([nodes.setdefault((2*i + a, 2*j + b),
                                                      self.n_nodes + len(nodes) + 1)
                                     for a, b in shape])
        self.n_nodes += len(nodes)
        self.add(f"*NODE, NSET={name}N")
        self.add(*(f"{node}, {x + size*a/2!r}, {y + size*b/2!r}" for (a, b), node in nodes.items()))
        reduced = "R" if kind in "48" and rng.random() < 0.15 else ""
        self.add(f"*ELEMENT, TYPE={plane}{kind}{reduced}, ELSET={name}")
        for element in elements:
            self.n_elements += 1
            self.add(f"{self.n_elements}, " + ", ".join(map(str, element)))
        self.add(f"*SOLID SECTION, ELSET={name}, MATERIAL={name}M"
                 + (", BBAR=YES" if kind == "4" and plane != "CPS" and not reduced
                    and rng.random() < 0.3 else ""), "1.",
                 f"*MATERIAL, NAME={name}M", "*ELASTIC", "1000., 0.3" if self.soft else "2e11, 0.25",
                 "*DENSITY", "1." if self.soft else "7800.")
        if rng.random() < 0.3:
            yields = ["10., 0.", "20., 0.1"] if self.soft else ["2e8, 0.", "3e8, 0.1"]
            self.add("*PLASTIC" + pick(rng, ["", ", HARDENING=KINEMATIC"]), *yields)
        if rng.random() < 0.2:
            self.add("*DAMPING, ALPHA=0.1, BETA=1e-4")
        if rng.random() < 0.3:
            scheme = pick(rng, ["EXPLICIT", "AUTO", "IMPLICIT", "IMPLICIT, MASS=LUMPED"])
            self.add(f"*ELEMENT GROUP, ELSET={name}, SCHEME={scheme}")
        self.outer_surface(name, kind, nx, ny)
        return name

    def outer_surface(self, name, kind, nx, ny):
        """The sides of a block's elements that are on its outside."""
        self.add(f"*SURFACE, NAME={name}S")
        first = self.n_elements - len(SHAPES[kind])*nx*ny
        for i in range(nx):
            for j in range(ny):
                cell = first + len(SHAPES[kind])*(i*ny + j) + 1
                if kind in "48":
                    outer = [(j == 0, 1), (i == nx - 1, 2), (j == ny - 1, 3), (i == 0, 4)]
                    self.add(*(f"{cell}, S{side}" for there, side in outer if there))
                else:
                    outer = [(j == 0, 0, 1), (i == nx - 1, 0, 2), (j == ny - 1, 1, 2),
                             (i == 0, 1, 3)]
                    self.add(*(f"{cell + k}, S{side}" for there, k, side in outer if there))


def make_points(scene):
    """Masses in a row, springs and gaps between them, a wall."""
    rng = scene.rng
    nodes = [scene.point(float(i), 0.0) for i in range(int(rng.integers(1, 5)))]
    for a, b in zip(nodes, nodes[1:]):
        kind = pick(rng, ["SPRING2", "SPRINGA", "DASHPOT2", "GAPUNI", "T2D2"])
        if kind == "GAPUNI":
            name = scene.element(kind, [a, b], "*GAP", "0.1, 1, 0, 0")
            scene.lines[-2] = f"*GAP, ELSET={name}, INTERACTION=I"
        elif kind == "T2D2":
            name = scene.element(kind, [a, b], "*SOLID SECTION", "0.1")
            scene.lines[-2] = f"*SOLID SECTION, ELSET={name}, MATERIAL={name}M"
            scene.add(f"*MATERIAL, NAME={name}M", "*ELASTIC", "1000", "*DENSITY", "1")
        elif kind == "SPRINGA" and rng.random() < 0.5:
            name = scene.element(kind, [a, b], "*SPRING", "-10, -1", "0, 0", "5, 1")
            scene.lines[-4] = f"*SPRING, ELSET={name}, NONLINEAR"
        else:
            scene.element(kind, [a, b], *(["*SPRING"] if "SPRING" in kind else ["*DASHPOT"]),
                          *([] if kind == "SPRINGA" else ["1, 1"]), "10")
    scene.add("*SURFACE, NAME=TIP, TYPE=NODE", str(nodes[0]),
              *wall(rng, "-0.2, 0, 0", "1, 0, 0"))
    add_pair(scene, "TIP", "WALL")
    if len(nodes) > 2 and rng.random() < 0.2:
        scene.add("*EQUATION", "2", f"{nodes[1]}, 1, 1, {nodes[2]}, 1, {pick(rng, ['-1', '2'])}")
    scene.add("*INITIAL CONDITIONS, TYPE=VELOCITY", f"{nodes[0]}, 1, -1")


def make_blocks(scene):
    """One block or two in front of a wall or a circle, or of each other."""
    rng = scene.rng
    plane = pick(rng, ["CPE", "CPS", "CAX"])
    lower = scene.block(2.0 if plane == "CAX" else 0.0, 0.0, plane)
    target = pick(rng, ["WALL", "WALL", "CIRCLE", "BLOCK", "BLOCK", "NONE"])
    if target == "WALL":
        scene.add(*wall(rng, "0, -0.01, 0", "0, 1, 0"))
        add_pair(scene, f"{lower}S", "WALL")
    elif target == "CIRCLE":
        scene.add("*RIGID SURFACE, NAME=WALL, TYPE=CIRCLE",
                  *pick(rng, [["0.3, -5.01", "5"], ["0.5, 0.5", "-8"], ["0.3, -0.11", "0.1"]]))
        add_pair(scene, f"{lower}S", "WALL")
    elif target == "BLOCK":
        upper = scene.block((2.0 if plane == "CAX" else 0.0) + pick(rng, [0.0, 0.2, -0.3]),
                            pick(rng, [3.01, 1.51, 1.01, 2.01, 0.51, 3.0]), plane)
        add_pair(scene, f"{upper}S", f"{lower}S")
        scene.add("*INITIAL CONDITIONS, TYPE=VELOCITY", f"{upper}N, 2, -1")
    if rng.random() < 0.7:
        scene.add("*BOUNDARY", *pick(rng, [["1, 1, 2", "2, 2"], [f"{lower}N, 1"], ["1, 1, 2"]]))
    scene.add("*INITIAL CONDITIONS, TYPE=VELOCITY", f"{lower}N, 2, "
              + pick(rng, ["-1", "1", "-100", "0"]))
    scene.loads += ["*DLOAD" + pick(rng, ["", ", AMPLITUDE=AMP"]),
                    f"{lower}, " + pick(rng, ["P3, 1", "BY, -10", "GRAV, 9.81, 0, -1, 0"])]


def wall(rng, point, normal):
    """A plane, now and then one that moves."""
    if rng.random() < 0.8:
        return ["*RIGID SURFACE, NAME=WALL, TYPE=PLANE", point, normal]
    return ["*RIGID SURFACE, NAME=WALL, TYPE=PLANE, AMPLITUDE=AMP", point, normal,
            f"{normal}, {pick(rng, ['0.05', '-0.05', '2'])}"]


def add_pair(scene, slave, master):
    """A contact pair with what its bodies do when they meet."""
    rng = scene.rng
    scene.add("*SURFACE INTERACTION, NAME=I", "*IMPACT, METHOD=" + pick(rng, [
        "TRANSFORMATION", "TRANSFORMATION, RESTITUTION=1", "TRANSFORMATION, RESTITUTION=0.5",
        "FICTITIOUS FORCE", "FICTITIOUS FORCE, RESTITUTION=0.5", "PENALTY, STIFFNESS=1e4",
        "LAGRANGE", "TRANSFORMATION, EVENTS=ANCHOR"]))
    if rng.random() < 0.3 and slave != "TIP":
        scene.add("*FRICTION", pick(rng, ["0.2", "1"]))
    kinds = ["", "", ", ADJUST", ", SMALL SLIDING"]
    if slave != "TIP":
        kinds += [", MASS=REDISTRIBUTED", ", TYPE=SURFACE TO SURFACE"]
    if master.startswith("B"):
        kinds += [", PASSES=2", ", PASSES=2, TYPE=SURFACE TO SURFACE"]
    scene.add("*CONTACT PAIR, INTERACTION=I" + pick(rng, kinds), f"{slave}, {master}")


def make_scene(rng):
    """A random small deck."""
    scene = Scene(rng)
    pick(rng, [make_points, make_blocks, make_blocks])(scene)
    scene.add("*AMPLITUDE, NAME=AMP", "0, 0, 0.01, 1, 0.05, -1")
    for number in range(pick(rng, [1, 1, 1, 2])):
        add_step(scene, number)
    return Deck.from_text("scene", "\n".join(scene.lines) + "\n")


def add_step(scene, number):
    """A step that the elements of the scene allow, as a rule."""
    rng = scene.rng
    procedure = pick(rng, [
        "*DYNAMIC, DIRECT", "*DYNAMIC, DIRECT", "*DYNAMIC, DIRECT", "*DYNAMIC", "*STATIC",
        "*STATIC, DIRECT", "*DYNAMIC, DIRECT, ORDER=4", "*DYNAMIC, DIRECT, EXPLICIT",
        "*FREQUENCY", "*DYNAMIC, TOLERANCE=1e-2"])
    unit = 0.01 if scene.soft else 1e-4      # a side over the speed of waves
    step = unit*(0.1 if "EXPLICIT" in procedure else pick(rng, [0.1, 0.3, 1, 10]))
    if procedure == "*FREQUENCY":
        scene.add("*STEP", procedure, pick(rng, ["1", "3"]), "*NODE FILE", "U", "*END STEP")
        return
    inc = "" if "DIRECT" in procedure else ", INC=500"
    scene.add(f"*STEP{inc}", procedure, f"{step:.6g}, {step*pick(rng, [5, 20, 40]):.6g}",
              *scene.loads)
    if number == 0 or rng.random() < 0.5:
        motion = "U, RF" if "STATIC" in procedure else "U, V, A, RF"
        scene.add("*NODE PRINT", motion, "*NODE FILE", motion, "*EL FILE", "S, E",
                  "*CONTACT PRINT", "CF, CDIS", "*CONTACT FILE", "CF, CDIS", "*ENERGY PRINT")
    scene.add("*END STEP")
