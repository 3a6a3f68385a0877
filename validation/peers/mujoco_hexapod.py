"""The hexapod of configs/hexapod.yaml in both engines, from one robot file; its hips are driven by a PD control each.

MuJoCo reads the URDF itself. What is added to it is what a URDF has no words for: a free joint and actuators. Of meshes
that are used with two scales it takes the first scale from the third use on, so the mirrored one is named again.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from granular_contact.config import load_scenario
from granular_contact.mujoco import MujocoBed
from granular_contact.scene import build
from validation.peers.mujoco_scene import controls_of

Array = NDArray[np.float64]
ROOT = Path(__file__).parents[2]
HIPS = {f"hip_{row}_{side}": 180 * ((i + j) % 2)  # phase (degrees) in an alternating tripod
        for i, row in enumerate(("front", "middle", "rear")) for j, side in enumerate(("left", "right"))}  # fmt: skip
GAIN, RATE_GAIN = 10.0, 0.1  # N m/rad, N m s/rad
DROP = 0.065  # m, the origin of the trunk at the start, as in the config


def scene_of(seconds: float, *overrides: str) -> Any:
    """The scene for Exudyn. The config gives the angles of the hips as constraints, which MuJoCo has none of."""
    drives = [
        f"drives.{hip}={{type: pd, angle_deg: {{type: shared, name: stride, phase_deg: {phase}}}, "
        f"gain_Nm_per_rad: {GAIN}, rate_gain_Nm_s_per_rad: {RATE_GAIN}}}"
        for hip, phase in HIPS.items()
    ]
    path = ROOT / "configs" / "hexapod.yaml"
    return build(load_scenario(path, [*drives, f"solver.end_time_s={seconds}", *overrides]))


def model_of(scene: Any, step: float) -> Any:
    """The robot file as MuJoCo reads it, with a free joint and the actuators of the scene."""
    spec = mujoco.MjSpec.from_file(str(ROOT / "models" / "hexapod" / "hexapod.urdf"))
    if spec.strippath:  # as old versions of MuJoCo read a URDF: without the folders of its meshes
        spec.meshdir = "meshes"
    spec.worldbody.first_body().add_freejoint()
    bodies = {body.name: body for body in spec.bodies}
    mirrored = bodies["leg_front_right"].first_geom().meshname
    for row in ("middle", "rear"):
        bodies[f"leg_{row}_right"].first_geom().meshname = mirrored
    spec.option.timestep, spec.option.integrator = step, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    for drive in scene.drives:
        made = spec.add_actuator()
        made.trntype, made.target = mujoco.mjtTrn.mjTRN_JOINT, drive.joint
        made.gainprm[0], made.biastype = drive.gain, mujoco.mjtBias.mjBIAS_AFFINE
        made.biasprm[1], made.biasprm[2] = -drive.gain, -drive.rate_gain
    return spec.compile()


def path_of(scene: Any, step: float, seconds: float) -> Array:
    """Path (n, 3) m of the centre of mass of the trunk by MuJoCo, with the start."""
    model = model_of(scene, step)
    data = mujoco.MjData(model)
    bed = MujocoBed(model, [layer.medium for layer in scene.bed.layers], scene.bed.origin, static=scene.static)
    bed.add_geoms(".*", facet_size=0.025)
    data.qpos[2] = DROP
    for joint in scene.joints:
        if joint.kind == "hinge":
            data.joint(joint.name).qpos, data.joint(joint.name).qvel = joint.start, joint.rate
    trunk, made = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "trunk"), []
    for control in controls_of(scene, np.arange(round(seconds / step)) * step):
        data.ctrl[:] = control
        bed.apply(data)
        made.append(data.xipos[trunk].copy())
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    return np.array([*made, data.xipos[trunk].copy()])
