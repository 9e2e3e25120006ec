"""Plane bodies that mesh_from_gmsh.py makes with gmsh; nothing to be run.

Each function draws its body in the model that is open, with the OpenCASCADE kernel, and returns the
groups: {name: (dimension, tags)}; a name is put behind that of the body, the empty one is the body.
"""

import math

from carom_script import ScriptError


def need(condition, sentence):
    """Ends the script with the sentence unless the condition holds."""
    if not condition:
        raise ScriptError(sentence)


def disc(model, options):
    """A disc: RIM."""
    need(options.radius > 0, "--radius must be positive")
    tag = model.occ.addDisk(0, 0, 0, options.radius, options.radius)
    model.occ.synchronize()
    return {"": (2, [tag]), "RIM": (1, outline(model, [tag]))}


def ring(model, options):
    """A ring: RIM outside, BORE inside."""
    need(0 < options.inner < options.radius, "0 < --inner < --radius is needed")
    outer = model.occ.addDisk(0, 0, 0, options.radius, options.radius)
    inner = model.occ.addDisk(0, 0, 0, options.inner, options.inner)
    (whole,), _ = model.occ.cut([(2, outer)], [(2, inner)])
    model.occ.synchronize()
    return {"": (2, [whole[1]]), **by_radius(model, whole[1], options)}


def by_radius(model, tag, options):
    """The curves of a ring, by their distance from its centre."""
    middle = (options.radius + options.inner) / 2
    groups = {"RIM": (1, []), "BORE": (1, [])}
    for curve in outline(model, [tag]):
        low, _ = model.getParametrizationBounds(1, curve)
        x, y, _ = model.getValue(1, curve, [low[0]])
        groups["RIM" if math.hypot(x, y) > middle else "BORE"][1].append(curve)
    return groups


def plate(model, options):
    """A plate, its centre at the origin, whole, with a round HOLE or with a CRACK through its centre:
    LEFT, RIGHT, BOTTOM, TOP."""
    width, height = options.width, options.height
    need(width > 0 and height > 0, "--width and --height must be positive")
    need(not (options.hole and options.crack), "a plate has --hole or --crack, not both")
    need(0 <= options.hole < min(width, height) / 2, "--hole must leave some of the plate")
    tag = model.occ.addRectangle(-width / 2, -height / 2, 0, width, height)
    if options.hole:
        hole = model.occ.addDisk(0, 0, 0, options.hole, options.hole)
        ((_, tag),), _ = model.occ.cut([(2, tag)], [(2, hole)])
    line = crack(model, options, tag) if options.crack else None
    model.occ.synchronize()
    groups = {"": (2, [tag])}
    for curve in outline(model, [tag]):
        groups.setdefault(edge_of_plate(model, curve, width, height), (1, []))[1].append(curve)
    if line is not None:
        model.mesh.embed(1, [line], 2, tag)
        groups["CRACK"] = (1, [line])
    return groups


def crack(model, options, tag):
    """The straight line of a crack, its middle at the origin."""
    turn = math.radians(options.angle)
    x, y = options.crack / 2 * math.cos(turn), options.crack / 2 * math.sin(turn)
    need(options.crack > 0 and abs(x) < options.width / 2 and abs(y) < options.height / 2,
         "--crack must be positive and lie inside the plate")
    ends = [model.occ.addPoint(sign * x, sign * y, 0) for sign in (-1, 1)]
    return model.occ.addLine(*ends)


def edge_of_plate(model, curve, width, height):
    """Which edge of a plate a curve is."""
    x, y, _ = model.occ.getCenterOfMass(1, curve)
    places = {"LEFT": x + width / 2, "RIGHT": x - width / 2,
              "BOTTOM": y + height / 2, "TOP": y - height / 2}
    nearest = min(places, key=lambda name: abs(places[name]))
    return nearest if abs(places[nearest]) < 1e-6 * max(width, height) else "HOLE"


def bolt(model, options):
    """Half of a bolt's section, its axis on y, the round TIP at the origin: a shank of --radius and
    --length, a head of --head (radius) and --thickness, a fillet between: AXIS, TIP, HEAD (its end)."""
    radius, head = options.radius, options.head or 2 * options.radius
    length, thickness = options.length, options.thickness or options.radius
    fillet = 0.3 * min(radius, head - radius)
    need(radius > 0 and head > radius and length > radius + fillet and thickness > 0,
         "a bolt needs 0 < --radius < --head, --length above 1.3 --radius and --thickness > 0")
    occ = model.occ
    places = [(0, 0), (radius, radius), (radius, length - fillet), (radius + fillet, length),
              (head, length), (head, length + thickness), (0, length + thickness)]
    p = [occ.addPoint(x, y, 0) for x, y in places]
    tip = occ.addCircleArc(p[0], occ.addPoint(0, radius, 0), p[1])
    root = occ.addCircleArc(p[2], occ.addPoint(radius + fillet, length - fillet, 0), p[3])
    lines = [occ.addLine(p[1], p[2]), occ.addLine(p[3], p[4]), occ.addLine(p[4], p[5])]
    end, axis = occ.addLine(p[5], p[6]), occ.addLine(p[6], p[0])
    loop = occ.addCurveLoop([tip, lines[0], root, lines[1], lines[2], end, axis])
    tag = occ.addPlaneSurface([loop])
    occ.synchronize()
    # points that only draw the arcs belong to no part of the body
    return {"": (2, [tag]), "AXIS": (1, [axis]), "TIP": (1, [tip]), "HEAD": (1, [end])}


def outline(model, tags):
    """The curves around some surfaces."""
    return [abs(tag) for _, tag in model.getBoundary([(2, tag) for tag in tags], oriented=False)]


BODIES = {"disc": disc, "ring": ring, "plate": plate, "bolt": bolt}
