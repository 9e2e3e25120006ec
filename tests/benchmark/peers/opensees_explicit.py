"""OpenSees: element updates a second of 4-node quads by central differences, lumped mass."""
import peer

ops = peer.need('openseespy.opensees')


def main():
    from bench_decks import DENSITY, MODULUS, POISSON, WAVE, q4_grid
    given = peer.arguments()
    peer.version('openseespy')
    n = given.side or (60 if given.quick else 200)
    x, elements = q4_grid(n)
    ops.wipe()
    ops.model('basic', '-ndm', 2, '-ndf', 2)
    for i, p in enumerate(x, 1):
        ops.node(i, float(p[0]), float(p[1]))
        if p[0] < 1e-9:
            ops.fix(i, 1, 1)
    ops.nDMaterial('ElasticIsotropic', 1, MODULUS, POISSON, DENSITY)
    for e, ring in enumerate(elements, 1):
        ops.element('quad', e, *(int(k) + 1 for k in ring), 1.0, 'PlaneStrain', 1, 0.0, DENSITY)
    for i, p in enumerate(x, 1):
        if p[0] > n - 1e-9:
            ops.setNodeVel(i, 1, 3.0, '-commit')
    ops.constraints('Plain')
    ops.numberer('Plain')
    ops.system('Diagonal')
    ops.algorithm('Linear')
    ops.integrator('CentralDifference')
    ops.analysis('Transient')
    dt = 0.8 / WAVE
    ops.analyze(2, dt)

    def cost(steps):
        watch = peer.Clock()
        if ops.analyze(steps, dt) != 0:
            raise SystemExit('OpenSees did not finish its steps')
        return watch()

    steps = 40 if given.quick else 100
    seconds = min(cost(steps) for _ in range(2)) / steps
    peer.figure('updates_1t', len(elements) / seconds)
    peer.figure('elements', len(elements))


main()
