"""The hexapod of configs/hexapod.yaml in both engines, from one robot file, with PD control of each hip.

MuJoCo reads the URDF. This module adds a free joint and actuators, which a URDF can't describe. If a mesh is used with
two scales, MuJoCo uses the first scale from the third use on; so this module sets the mirrored mesh again.
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
DROP = 0.065  # m, height of the trunk's origin at the start, as in the config


def scene_of(seconds: float, *overrides: str) -> Any:
    """Build the scene for Exudyn with PD control, as the config prescribes the hip angles, which MuJoCo can't do."""
    drives = [
        f"drives.{hip}={{type: pd, angle_deg: {{type: shared, name: stride, phase_deg: {phase}}}, "
        f"gain_Nm_per_rad: {GAIN}, rate_gain_Nm_s_per_rad: {RATE_GAIN}}}"
        for hip, phase in HIPS.items()
    ]
    path = ROOT / "configs" / "hexapod.yaml"
    return build(load_scenario(path, [*drives, f"solver.end_time_s={seconds}", *overrides]))


def model_of(scene: Any, step: float) -> Any:
    """MuJoCo model of the robot file, with a free joint and the actuators of the scene."""
    spec = mujoco.MjSpec.from_file(str(ROOT / "models" / "hexapod" / "hexapod.urdf"))
    if spec.strippath:  # old versions of MuJoCo drop the folders of a URDF's meshes
        spec.meshdir = "meshes"
    spec.worldbody.first_body().add_freejoint()
    bodies = {body.name: body for body in spec.bodies}
    mirrored = bodies["leg_front_right"].first_geom().meshname
    for row in ("middle", "rear"):
        bodies[f"leg_{row}_right"].first_geom().meshname = mirrored
    spec.option.timestep, spec.option.integrator = step, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    for drive in scene.drives:
        actuator = spec.add_actuator()
        actuator.trntype, actuator.target = mujoco.mjtTrn.mjTRN_JOINT, drive.joint
        actuator.gainprm[0], actuator.biastype = drive.gain, mujoco.mjtBias.mjBIAS_AFFINE
        actuator.biasprm[1], actuator.biasprm[2] = -drive.gain, -drive.rate_gain
    return spec.compile()


def path_of(scene: Any, step: float, seconds: float) -> Array:
    """Path (n, 3) m of the trunk's centre of mass by MuJoCo, from the start on."""
    model = model_of(scene, step)
    data = mujoco.MjData(model)
    bed = MujocoBed(model, [layer.medium for layer in scene.bed.layers], scene.bed.origin, static=scene.static)
    bed.add_geoms(".*", facet_size=0.025)
    data.qpos[2] = DROP
    for joint in scene.joints:
        if joint.kind == "hinge":
            data.joint(joint.name).qpos, data.joint(joint.name).qvel = joint.start, joint.rate
    trunk, positions = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "trunk"), []
    for control in controls_of(scene, np.arange(round(seconds / step)) * step):
        data.ctrl[:] = control
        bed.apply(data)
        positions.append(data.xipos[trunk].copy())
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    return np.array([*positions, data.xipos[trunk].copy()])
