"""Akantu: element updates a second of 4-node elements by central differences, lumped mass."""
import numpy as np
import peer

aka = peer.need('akantu')


def square(n):
    """The mesh as Akantu holds it."""
    from bench_decks import q4_grid
    x, elements = q4_grid(n)
    mesh = aka.Mesh(2)
    access = aka.MeshAccessor(mesh)
    access.resizeNodes(len(x))
    mesh.getNodes()[:, :] = x
    access.resizeConnectivity(len(elements), aka._quadrangle_4)
    mesh.getConnectivity(aka._quadrangle_4)[:, :] = elements
    access.makeReady()
    return mesh, x


def main():
    from bench_decks import DENSITY, MODULUS, POISSON
    given = peer.arguments()
    peer.version('akantu')
    n = given.side or (60 if given.quick else 200)
    given.work.mkdir(parents=True, exist_ok=True)
    material = given.work / 'akantu_material.dat'
    material.write_text(f'material elastic [\n name = stuff\n rho = {DENSITY}\n E = {MODULUS}\n'
                        f' nu = {POISSON}\n]\n')
    aka.parseInput(str(material))
    mesh, x = square(n)
    model = aka.SolidMechanicsModel(mesh)
    model.initFull(_analysis_method=aka._explicit_lumped_mass)
    model.setTimeStep(0.8 * model.getStableTimeStep())
    model.getBlockedDOFs()[x[:, 0] < 1e-9] = True
    model.getVelocity()[x[:, 0] > n - 1e-9, 0] = 3.0

    def cost(steps):
        watch = peer.Clock()
        for _ in range(steps):
            model.solveStep()
        return watch()

    cost(2)
    steps = 40 if given.quick else 200
    seconds = min(cost(steps) for _ in range(2)) / steps
    peer.figure('updates_1t', n * n / seconds)
    peer.figure('elements', n * n)
    if not np.isfinite(model.getDisplacement()).all():
        raise SystemExit('Akantu: the motion is not finite')


main()
