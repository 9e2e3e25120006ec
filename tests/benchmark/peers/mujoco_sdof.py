"""MuJoCo: the oscillator of input/sdof with a joint limit for its wall, 2e5 steps to t = 20."""
import numpy as np
import peer

mujoco = peer.need('mujoco')
END, STEPS, SAMPLES = 20.0, 200000, 2000

MODEL = """<mujoco>
<option timestep="{dt}" gravity="0 0 0" integrator="implicitfast"/>
<worldbody><body>
<joint type="slide" axis="1 0 0" stiffness="1" damping="0" limited="true" range="-0.5 1000"
 solreflimit="-{stiffness} 0" solimplimit="0.9999 0.9999 0.001"/>
<geom type="sphere" size="0.1" mass="1"/>
</body></worldbody></mujoco>
"""


def run(stiffness):
    """Seconds, and the largest error of the displacement."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(dt=END / STEPS, stiffness=stiffness))
    data = mujoco.MjData(model)
    data.qpos[0] = 1.0
    watch, d = peer.Clock(), [1.0]
    for _ in range(SAMPLES):
        mujoco.mj_step(model, data, STEPS // SAMPLES)
        d.append(data.qpos[0])
    return watch(), peer.oscillator_error(np.linspace(0, END, SAMPLES + 1), d)


peer.penalty_oscillator('mujoco', run, STEPS)
