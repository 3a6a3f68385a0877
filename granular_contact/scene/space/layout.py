"""Where all bodies of a mechanism in space are and how they move, in a state of its joints.

The state at the start is the reference configuration, the values of the run, or those of a motion.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.joints import AnyClosure, AnyJoint
from granular_contact.errors import Fault
from granular_contact.geometry import rotations
from granular_contact.scene.layout import GROUND, joints_outward
from granular_contact.scene.space.shapes import orientation
from granular_contact.scene.space.types import SpatialMotion, Vector
from granular_contact.scene.start import Said, Start, begun, home
from granular_contact.scene.types import Drive

ZERO = np.zeros(3)
STILL = SpatialMotion(ZERO, np.eye(3), ZERO, ZERO)
Pose = dict[str, SpatialMotion]  # of all bodies, the ground among them


@dataclass(frozen=True)
class JointState:
    """State of a joint: coordinate (rad or m) of a hinge or slider, position (3,) m of a free body from the joint's
    point on the ground, orientation (3, 3) of the child in the parent's frame for a ball or free joint; rates: (1,) of
    the coordinate, of a ball joint the angular velocity (3,) along the axes of the parent, of a free one velocity and
    angular velocity (6,), world frame.
    """

    rates: Vector
    coordinate: float = 0.0
    position: Vector = field(default_factory=lambda: ZERO)
    turn: Vector = field(default_factory=lambda: np.eye(3))

    def at(self, coordinate: float) -> JointState:
        """The same of a hinge or slider at another coordinate."""
        return replace(self, coordinate=coordinate)

    def displaced(self, change: Vector) -> JointState:
        """The state after a small displacement, as rates over a unit of time."""
        if len(change) == 1:
            return self.at(self.coordinate + float(change[0]))
        position = self.position + change[:3] if len(change) == 6 else self.position
        return replace(self, position=position, turn=rotations.of_vector(change[-3:]) @ self.turn)


# Degrees of freedom; links that bend are straight at the start.
SIZES = {"hinge": 1, "slider": 1, "ball": 3, "free": 6, "weld": 0, "elastic": 0, "stretching": 0}


def axis_of(joint: AnyJoint | AnyClosure) -> Vector:
    """Unit vector (3,) along the axis of a hinge or slider, in the frame of its child; z for any other joint."""
    if not isinstance(joint, schema.SpatialHingeClosure | schema.SpatialSliderClosure):
        return np.array([0.0, 0.0, 1.0])
    axis = np.array(joint.axis, float)
    return np.asarray(axis / np.linalg.norm(axis))


def pose(model: schema.SpatialModel, states: Mapping[str, JointState]) -> Pose:
    """Place and move all bodies."""
    placed = {GROUND: STILL}
    for name, joint in joints_outward(model):
        placed[joint.child] = _child(joint, states.get(name), placed[joint.parent])
    return placed


def _child(joint: AnyJoint, state: JointState | None, parent: SpatialMotion) -> SpatialMotion:
    """Pose and velocity of the child of a joint."""
    pin, home, speed, rate = parent.world(np.array(joint.parent_point_m)), orientation(joint), ZERO, parent.rate
    turn = parent.rotation @ home
    if state is not None and joint.type == "slider":
        along = turn @ axis_of(joint)
        pin, speed = pin + state.coordinate * along, state.rates[0] * along
    elif state is not None and joint.type == "hinge":
        turn = turn @ rotations.about(axis_of(joint), state.coordinate)
        rate = rate + state.rates[0] * (turn @ axis_of(joint))
    elif state is not None and joint.type in ("ball", "elastic", "stretching"):
        turn, rate = parent.rotation @ state.turn, rate + parent.rotation @ state.rates[-3:]
        if len(state.rates) == 4:
            speed = state.rates[0] * parent.rotation[:, 0]
    elif state is not None:
        pin, turn, speed, rate = pin + state.position, state.turn, state.rates[:3], rate + state.rates[3:]
    arm = turn @ np.array(joint.child_point_m)
    # (On a slider the point of the parent that is at the pin now moves on with the parent.)
    return SpatialMotion(pin - arm, turn, parent.speed_at(pin) + speed - np.cross(rate, arm), rate)


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
