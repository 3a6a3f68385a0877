"""Where all bodies of a mechanism in space are and how they move, in a state of its joints.

The state at the start is the reference configuration, the values of the run, or those of a motion.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.joints import AnyJoint
from granular_contact.errors import Fault
from granular_contact.geometry import rotations
from granular_contact.scene.layout import GROUND, joints_outward
from granular_contact.scene.space.shapes import orientation
from granular_contact.scene.space.types import SpatialMotion, Vector
from granular_contact.scene.start import Said, Start, begun
from granular_contact.scene.types import Drive

ZERO = np.zeros(3)
STILL = SpatialMotion(ZERO, np.eye(3), ZERO, ZERO)
Pose = dict[str, SpatialMotion]  # of all bodies, the ground among them


@dataclass(frozen=True)
class JointState:
    """State of a joint: value (k,) its coordinates along (m) and about (rad) its axis; of a free body position (3,) m
    from the joint's point on the ground, of it and of a ball joint turn (3, 3), the child's axes in the parent's frame.

    rates: (k,) of the coordinates, of a ball joint the angular velocity (3,) along the axes of the parent, of a free
    one velocity and angular velocity (6,), world frame.
    """

    rates: Vector
    value: Vector = field(default_factory=lambda: np.zeros(0))
    position: Vector = field(default_factory=lambda: ZERO)
    turn: Vector = field(default_factory=lambda: np.eye(3))

    @property
    def coordinate(self) -> float:
        """Of a hinge or slider."""
        return float(self.value[0])

    def at(self, coordinate: float) -> JointState:
        """The same of a hinge or slider at another coordinate."""
        return replace(self, value=np.array([coordinate]))

    def displaced(self, change: Vector) -> JointState:
        """The state after a small displacement, as rates over a unit of time."""
        if len(self.value):
            return replace(self, value=self.value + change)
        position = self.position + change[:3] if len(change) == 6 else self.position
        return replace(self, position=position, turn=rotations.of_vector(change[-3:]) @ self.turn)


# Of each type of joint the displacements along the axes of its frame, whose z is its axis, and the rotations about
# them, that are held.
CONSTRAINED = {
    "hinge": (True, True, True, True, True, False),
    "slider": (True, True, False, True, True, True),
    "weld": (True,) * 6,
    "ball": (True, True, True, False, False, False),
    "elastic": (True, True, True, False, False, False),
    "stretching": (False, True, True, False, False, False),
    "free": (False,) * 6,
}
BENDING = dict.fromkeys(("elastic", "stretching"), (1, 3))  # freedoms between elements of links, if these stretched
# Displacements and turns that are free; links that bend are straight at the start.
FREEDOMS = {kind: (held[:3].count(False), held[3:].count(False)) for kind, held in CONSTRAINED.items()}
FREEDOMS |= dict.fromkeys(BENDING, (0, 0))


def slides(joint: Any) -> bool:
    """Whether the child moves along the axis of a joint."""
    return CONSTRAINED[joint.type][:3] == (True, True, False)


def turns(joint: Any) -> bool:
    """Whether the child turns about the axis of a joint, and no other."""
    return CONSTRAINED[joint.type][3:] == (True, True, False)


def axis_of(joint: Any) -> Vector:
    """Unit vector (3,) along the axis of a joint, in the frame of its child; z for one that has none."""
    axis = np.array(getattr(joint, "axis", (0.0, 0.0, 1.0)), float)
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
    if state is not None and len(state.value):
        axis = axis_of(joint)
        if slides(joint):
            along = turn @ axis
            pin, speed = pin + state.value[0] * along, state.rates[0] * along
        if turns(joint):
            turn = turn @ rotations.about(axis, state.value[-1])
            rate = rate + state.rates[-1] * (turn @ axis)
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


def _said(joint: Any, said: schema.SpatialJointStart) -> JointState:
    """State of a joint as the run gives it; the reference configuration at rest where it does not."""
    value, rates = [], []
    if slides(joint):
        value.append(joint.home_m if said.position_m is None else said.position_m)
        rates.append(said.speed_m_s or 0.0)
    if turns(joint):
        value.append(math.radians(joint.home_deg if said.angle_deg is None else said.angle_deg))
        rates.append(said.rate_rad_s or 0.0)
    if value:
        return JointState(np.array(rates), np.array(value))
    turn = orientation(said if said.is_turned else joint)
    spin = np.array(said.spin_rad_s or (0.0, 0.0, 0.0))
    if joint.type == "ball":
        return JointState(spin, turn=turn)
    position = np.array([said.x_m or 0.0, said.y_m or 0.0, said.z_m or 0.0])
    velocity = np.array([said.vx_m_s or 0.0, said.vy_m_s or 0.0, said.vz_m_s or 0.0])
    return JointState(np.concatenate([velocity, spin]), position=position, turn=turn)
