"""Initial states of joints in space: the reference configuration, the values of the run, or those of a motion."""

from __future__ import annotations

import math

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.joints import AnyJoint
from granular_contact.errors import Fault
from granular_contact.scene.space.layout import JointState
from granular_contact.scene.space.shapes import orientation
from granular_contact.scene.start import Said, Start, begun, home
from granular_contact.scene.types import Drive


def start(scenario: schema.SpatialScenario, drives: tuple[Drive, ...], faults: list[Fault]) -> Start:
    """Initial states of all joints of the tree, not looking at loops; faults are appended."""

    def said(name: str, joint: AnyJoint) -> Said:
        given = (scenario.initial.joints or {}).get(name, schema.SpatialJointStart())
        loose = joint.type in ("ball", "free")
        has_place = loose or given.angle_deg is not None or given.position_m is not None
        has_rate = loose or given.rate_rad_s is not None or given.speed_m_s is not None
        return Said(_said(joint, given), has_place, has_rate)

    return begun(scenario, drives, said, faults)


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
