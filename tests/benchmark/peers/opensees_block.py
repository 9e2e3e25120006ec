"""OpenSees: the block of input/block against a wall, its 8-node quads, penalty springs with a gap.

The element's own mass is summed by rows, negative at the corners of 8-node quads and no good for
dynamics: the nodes get masses in proportion to the diagonal of the consistent mass instead.
"""
import numpy as np
import peer

ops = peer.need('openseespy.opensees')
GAP = 0.4           # steps until the wall is hit
SOLVERS = ('UmfPack', 'SparseSYM', 'ProfileSPD')
CORNER, MIDDLE = 3.0 / 76.0, 16.0 / 76.0        # parts of an element's mass


def build(n, solver):
    """The model, ready to be moved; returns dt and the contact elements."""
    from make_block import DENSITY, MODULUS, POISSON, SPEED
    x, elements, face, dt = peer.block(n)
    ops.wipe()
    ops.model('basic', '-ndm', 2, '-ndf', 2)
    for i, p in enumerate(x, 1):
        ops.node(i, float(p[0]), float(p[1]))
    mass = np.zeros(len(x))
    np.add.at(mass, elements[:, :4], CORNER * DENSITY / n ** 2)
    np.add.at(mass, elements[:, 4:], MIDDLE * DENSITY / n ** 2)
    for i, m in enumerate(mass, 1):
        ops.mass(i, float(m), float(m))
    ops.nDMaterial('ElasticIsotropic', 1, MODULUS, POISSON, 0.0)
    for e, ring in enumerate(elements, 1):
        ops.element('quad8n', e, *(int(k) + 1 for k in ring), 1.0, 'PlaneStrain', 1)
    stiffness = 2 * MODULUS
    ops.uniaxialMaterial('ElasticPPGap', 2, stiffness, -1e12, -GAP * SPEED * dt, 0.0)
    springs = []
    for k in face:
        wall = len(x) + 1 + int(k)
        ops.node(wall, float(x[k][0]), float(x[k][1]))
        ops.fix(wall, 1, 1)
        springs.append(len(elements) + 1 + int(k))
        ops.element('zeroLength', springs[-1], wall, int(k) + 1, '-mat', 2, '-dir', 1)
    for i in range(1, len(x) + 1):
        ops.setNodeVel(i, 1, -SPEED, '-commit')
    ops.constraints('Plain')
    ops.numberer('RCM')
    ops.system(solver)
    ops.test('NormDispIncr', 1e-8, 20)
    ops.algorithm('Newton')
    ops.integrator('Newmark', 0.5, 0.25)
    ops.analysis('Transient')
    return dt, springs


def force(springs):
    """On the wall."""
    return sum(abs(ops.eleResponse(s, 'material', 1, 'stress')[0]) for s in springs)


def main():
    given = peer.arguments()
    peer.version('openseespy')
    n = given.side or 40
    best = None
    for solver in SOLVERS[:2] if given.quick else SOLVERS:
        dt, springs = build(n, solver)
        if ops.analyze(1, dt) != 0:
            continue
        steps = 4 if given.quick else 12
        forces, watch = [], peer.Clock()
        for _ in range(steps):
            if ops.analyze(1, dt) != 0:
                break
            forces.append(force(springs))
        if len(forces) < steps:
            continue
        ms = 1e3 * watch() / steps
        peer.figure(f'step_ms_{solver}', ms)
        if best is None or ms < best:
            best = ms
            tail = forces[2:]
            error = abs(sum(tail) / len(tail) / peer.plane_wave_force() - 1)
    peer.figure('step_ms', best)
    peer.figure('error', error)


main()
