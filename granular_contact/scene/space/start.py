"""Initial states of joints in space: the reference configuration, the values of the run, or those of a motion."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.joints import AnyJoint
from granular_contact.errors import Fault, scene_fault
from granular_contact.scene.space.layout import JointState
from granular_contact.scene.space.shapes import orientation
from granular_contact.scene.start import AGREEMENT, Start, home, settling_fault
from granular_contact.scene.types import Drive


def start(scenario: schema.SpatialScenario, drives: tuple[Drive, ...], faults: list[Fault]) -> Start:
    """Initial states of all joints of the tree, not looking at loops; faults are appended."""
    initial, driven = scenario.initial, {drive.joint: drive for drive in drives}
    states, placed, moved = {}, set(), set()
    for name, joint in scenario.model.all_joints.items():
        if joint.type == "weld":
            continue
        said = (initial.joints or {}).get(name, schema.SpatialJointStart())
        state = _said(joint, said)
        loose = joint.type in ("ball", "free")
        has_place = loose or said.angle_deg is not None or said.position_m is not None
        has_rate = loose or said.rate_rad_s is not None or said.speed_m_s is not None
        drive = driven.get(name)
        if drive is not None and drive.kind == "motion":
            follows = JointState(np.array([drive.signal.rate(0.0)]), drive.signal.value(0.0))
            faults += _gaps(name, joint, said, follows)
            state, has_place, has_rate = follows, True, True
            if initial.settle and state.rates[0] != 0.0:
                faults.append(settling_fault(name, float(state.rates[0])))
        elif drive is not None and drive.kind == "control" and not drive.of_rate and not has_place:
            state, has_place = JointState(state.rates, drive.signal.value(0.0)), True
        states[name] = state
        placed |= {name} if has_place else set()
        moved |= {name} if has_rate else set()
    return Start(states, frozenset(placed), frozenset(moved))


def _said(joint: AnyJoint, said: schema.SpatialJointStart) -> JointState:
    """State of a joint as the run gives it; the reference configuration at rest where it does not."""
    if joint.type == "slider":
        return JointState(
            np.array([said.speed_m_s or 0.0]), home(joint) if said.position_m is None else said.position_m
        )
    if joint.type == "hinge":
        angle = home(joint) if said.angle_deg is None else math.radians(said.angle_deg)
        return JointState(np.array([said.rate_rad_s or 0.0]), angle)
    turn = orientation(said if said.is_turned else joint)
    spin = np.array(said.spin_rad_s or (0.0, 0.0, 0.0))
    if joint.type == "ball":
        return JointState(spin, turn=turn)
    position = np.array([said.x_m or 0.0, said.y_m or 0.0, said.z_m or 0.0])
    velocity = np.array([said.vx_m_s or 0.0, said.vy_m_s or 0.0, said.vz_m_s or 0.0])
    return JointState(np.concatenate([velocity, spin]), position=position, turn=turn)


def _gaps(name: str, joint: AnyJoint, said: schema.SpatialJointStart, follows: JointState) -> Iterator[Fault]:
    """Differences between what the run says and what a prescribed motion starts with."""
    hinge = joint.type == "hinge"
    keys, unit = (("angle_deg", "rate_rad_s"), math.degrees(1.0)) if hinge else (("position_m", "speed_m_s"), 1.0)
    for key, factor, starts in ((keys[0], unit, follows.coordinate), (keys[1], 1.0, float(follows.rates[0]))):
        given = getattr(said, key)
        if given is not None and abs(given / factor - starts) > AGREEMENT:
            words = (
                f"got {given:g}, but the drive of {name} starts at {factor * starts:g}: allowed is that, or no value"
            )
            yield scene_fault(f"initial.joints.{name}.{key}", words)
