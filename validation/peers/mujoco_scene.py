"""A planar scene of rigid bodies in MuJoCo: bodies, hinges and drives as MJCF, sand by `MujocoBed`.

x is ahead, z up, y into the plane, so that a positive rotation about +y is clockwise, as in scenes. Joint coordinates
are those of the scene. MuJoCo computes linear dampers of hinges; stops, dry friction and springs are computed once a
step by the kernels of the engine's runs (`Laws`).
"""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np
from numba import njit
from numpy.typing import NDArray

from granular_contact.mechanics.joint_loads import fill
from granular_contact.mechanics.kernels.joint_laws import follow, total
from granular_contact.mechanics.kernels.joint_loads import JOINT
from granular_contact.mujoco import MujocoBed
from granular_contact.sand.from_scene import lines_from_shape
from granular_contact.scene import Scene
from granular_contact.scene.parts import RigidBody, rotation
from granular_contact.scene.types import Drive, Joint

Array = NDArray[np.float64]
SERVO = 200.0, 0.4  # N m/rad, N m s/rad: servo in place of a prescribed motion, which MuJoCo does not have
FREE = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>'


def model_of(scene: Scene, step: float, integrator: str = "implicitfast") -> Any:
    """MuJoCo model of a tree of hinges and sliders on the ground or on a floating body, with a time step (s)."""
    children: dict[str | None, list[Joint]] = {}
    for joint in scene.joints:
        children.setdefault(joint.parent, []).append(joint)
    bodies = "".join(_body(scene, joint, children) for joint in children[None])
    drives = "".join(_drive(drive) for drive in scene.drives)
    option = f'timestep="{step!r}" gravity="0 0 {-scene.gravity!r}" integrator="{integrator}"'
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><compiler angle='radian' autolimits='true'/><option {option}><flag contact='disable'/></option>"
        f"<worldbody>{bodies}</worldbody><actuator>{drives}</actuator></mujoco>"
    )


def _body(scene: Scene, joint: Joint, children: dict[str | None, list[Joint]]) -> str:
    body = scene.body(joint.child)
    assert isinstance(body, RigidBody)
    place, angle = body.motion.position, body.motion.angle
    if joint.parent is not None:
        parent = scene.body(joint.parent).motion
        place, angle = rotation(-parent.angle) @ (place - parent.position), angle - parent.angle
    x, z = joint.child_point
    if joint.kind == "free":
        degrees = FREE
    elif joint.kind == "slider":
        assert joint.axis is not None
        along, up = (float(component) for component in joint.axis)
        degrees = f'<joint type="slide" name="{joint.name}" axis="{along!r} 0 {up!r}" ref="{joint.start!r}"/>'
    else:
        place_there = f'pos="{x!r} 0 {z!r}" ref="{joint.start!r}" damping="{_damper(joint)!r}"'
        degrees = f'<joint name="{joint.name}" axis="0 1 0" {place_there}/>'
    inner = "".join(_body(scene, child, children) for child in children.get(body.name, []))
    inertia = " ".join([repr(body.inertia)] * 3)
    return (
        (
            f'<body name="{body.name}" pos="{place[0]!r} 0 {place[1]!r}"'
            f' quat="{math.cos(0.5 * angle)!r} 0 {-math.sin(0.5 * angle)!r} 0">{degrees}'
            f'<inertial pos="0 0 0" mass="{body.mass!r}" diaginertia="{inertia}"/>{inner}</body>'
        )
        .replace("np.float64(", "")
        .replace(")", "")
    )


def _damper(joint: Joint) -> float:
    """Damping (N m s/rad) of a hinge that has only a damper; 0 for other joints, whose forces come from `Laws`."""
    law = joint.law
    return law.damping if joint.kind == "hinge" and law.is_linear and law.stiffness == 0.0 else 0.0


class Laws:
    """Springs, stops and dry friction of joints, with forces constant over a step; anchors: those of the bristles."""

    def __init__(self, scene: Scene, model: Any) -> None:
        acting = [joint for joint in scene.joints if not joint.law.is_idle and not _damper(joint)]
        self.places = np.array([model.joint(joint.name).qposadr[0] for joint in acting], int)
        self.rates = np.array([model.joint(joint.name).dofadr[0] for joint in acting], int)
        self.records = np.zeros(len(acting), JOINT)
        for i, joint in enumerate(acting):
            fill(self.records[i : i + 1], joint.law, None)
        self.anchors = np.array([joint.start for joint in acting])

    def apply(self, data: Any) -> None:
        """Accept the last step, and set the forces of the next one."""
        if len(self.places):
            act(
                self.records, self.anchors, data.qpos[self.places], data.qvel[self.rates], self.rates, data.qfrc_applied
            )


@njit
def act(joints, anchors, s, rate, places, out):  # type: ignore[no-untyped-def]
    """Write the forces of joints (k,) to `out` at `places`, and update their anchors (k,).

    s, rate (k,): coordinates and rates of the joints.
    """
    for k in range(joints.shape[0]):
        if joints[k].friction > 0.0:
            anchors[k] = follow(joints[k], s[k], anchors[k])
        out[places[k]] = total(joints[k], s[k], rate[k], anchors[k], 0.0, 0.0)


def _drive(drive: Drive) -> str:
    gain, rate_gain = _gains(drive)
    limit = "" if math.isinf(drive.limit) else f' forcerange="{-drive.limit!r} {drive.limit!r}"'
    return (
        f'<general joint="{drive.joint}" gainprm="{gain!r}" biastype="affine" '
        f'biasprm="0 {-gain!r} {-rate_gain!r}"{limit}/>'
    )


def _gains(drive: Drive) -> tuple[float, float]:
    assert drive.kind in ("control", "motion")
    return SERVO if drive.kind == "motion" else (drive.gain, drive.rate_gain)


def controls_of(scene: Scene, times: Array) -> Array:
    """Controls (n, drives) of the model's actuators at times (n,) s."""
    gains = [_gains(drive) for drive in scene.drives]
    columns = [
        [
            drive.signal.value(t) + rate_gain / gain * drive.signal.rate(t)
            for drive, (gain, rate_gain) in zip(scene.drives, gains, strict=True)
        ]
        for t in times
    ]
    return np.array(columns).reshape(len(times), len(scene.drives))


def bed_of(scene: Scene, model: Any, **options: Any) -> MujocoBed:
    """Bed of the scene with all its bodies."""
    assert scene.bed is not None
    bed = MujocoBed(
        model,
        scene.bed.layers,
        scene.bed.profile,
        plane=(1.0, 0.0, 0.0),
        slope=scene.bed.slope,
        static=scene.static,
        form=scene.load.form,
        end_cap=scene.load.end_cap,
        floor=scene.bed.floor,
        **options,
    )
    for body in scene.rigid:
        for shape in body.shapes:
            if shape.in_sand:
                bed.add_lines(lines_from_shape(bed.body(body.name), shape, scene.load.strips_per_rigid_part))
    return bed


def start(scene: Scene, model: Any) -> Any:
    """MuJoCo data at the start of the scene, with the rates of its joints."""
    data = mujoco.MjData(model)
    for joint in scene.joints:
        if joint.kind == "free":
            motion = scene.body(joint.child).motion
            data.qvel[:3] = motion.velocity[0], motion.velocity[1], -motion.rate
        else:
            data.joint(joint.name).qvel = joint.rate
    return data
