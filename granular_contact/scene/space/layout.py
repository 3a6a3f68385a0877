"""Poses and velocities of all bodies of a mechanism in space, as functions of the states of its joints.

Initial states come from the reference configuration, the values of the run, or a prescribed motion.
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
from granular_contact.scene.start import InitialStates, RunState, states_with_drives
from granular_contact.scene.types import Drive

ZERO = np.zeros(3)
STILL = SpatialMotion(ZERO, np.eye(3), ZERO, ZERO)
Pose = dict[str, SpatialMotion]  # of all bodies and the ground


@dataclass(frozen=True)
class JointState:
    """State of a joint.

    value (k,): coordinates along (m) and about (rad) the axis of the joint, if it has one. position (3,) m: of a free
    joint, from its point on the ground. turn (3, 3): of a joint without an axis, the child's axes in the parent's
    frame. rates: (k,) of the coordinates; of a ball joint the angular velocity (3,) along the axes of the parent, with
    the rate of stretch before it (4,) between elements of links; of a free joint velocity and angular velocity (6,),
    world frame.
    """

    rates: Vector
    value: Vector = field(default_factory=lambda: np.zeros(0))
    position: Vector = field(default_factory=lambda: ZERO)
    turn: Vector = field(default_factory=lambda: np.eye(3))

    @property
    def coordinate(self) -> float:
        """Coordinate of a hinge or slider."""
        return float(self.value[0])

    def at(self, coordinate: float) -> JointState:
        """The state of a hinge or slider with the same rate at another coordinate."""
        return replace(self, value=np.array([coordinate]))

    def displaced(self, change: Vector) -> JointState:
        """The state after a small displacement, which has the components of `rates`."""
        if len(self.value):
            return replace(self, value=self.value + change)
        position = self.position + change[:3] if len(change) == 6 else self.position
        return replace(self, position=position, turn=rotations.of_vector(change[-3:]) @ self.turn)


# For each type of joint: whether the displacements along x, y, z of its frame are constrained, and the rotations about
# them. z is the axis of the joint.
CONSTRAINED = {
    "hinge": (True, True, True, True, True, False),
    "slider": (True, True, False, True, True, True),
    "weld": (True,) * 6,
    "ball": (True, True, True, False, False, False),
    "elastic": (True, True, True, False, False, False),
    "stretching": (False, True, True, False, False, False),
    "free": (False,) * 6,
}
BENDING = dict.fromkeys(("elastic", "stretching"), (1, 3))  # freedoms between elements of links that bend and stretch
# Numbers of free displacements and rotations of each type; 0 for links that bend, as they are straight at the start.
FREEDOMS = {kind: (held[:3].count(False), held[3:].count(False)) for kind, held in CONSTRAINED.items()}
FREEDOMS |= dict.fromkeys(BENDING, (0, 0))


def slides(joint: Any) -> bool:
    """Whether the child moves along the axis of a joint."""
    return CONSTRAINED[joint.type][:3] == (True, True, False)


def turns(joint: Any) -> bool:
    """Whether the child turns about the axis of a joint, and about no other axis."""
    return CONSTRAINED[joint.type][3:] == (True, True, False)


def axis_of(joint: Any) -> Vector:
    """Unit vector (3,) along the axis of a joint, in the frame of its child; z for a joint without an axis."""
    axis = np.array(getattr(joint, "axis", (0.0, 0.0, 1.0)), float)
    return np.asarray(axis / np.linalg.norm(axis))


def pose_of(model: schema.SpatialModel, states: Mapping[str, JointState]) -> Pose:
    """Poses and velocities of all bodies."""
    pose = {GROUND: STILL}
    for name, joint in joints_outward(model):
        pose[joint.child] = _child(joint, states.get(name), pose[joint.parent])
    return pose


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
    # (On a slider, the velocity of the parent is that of its point at the current place of the pin.)
    return SpatialMotion(pin - arm, turn, parent.speed_at(pin) + speed - rotations.vector_products(rate, arm), rate)


def initial_states(scenario: schema.SpatialScenario, drives: tuple[Drive, ...], faults: list[Fault]) -> InitialStates:
    """Initial states of all joints of the tree, whether or not the loops close in them; faults are appended."""

    def run_state(name: str, joint: AnyJoint) -> RunState:
        given = (scenario.initial.joints or {}).get(name, schema.SpatialJointStart())
        loose = joint.type in ("ball", "free")
        has_coordinate = loose or given.angle_deg is not None or given.position_m is not None
        has_rate = loose or given.rate_rad_s is not None or given.speed_m_s is not None
        return RunState(_initial_state(joint, given), has_coordinate, has_rate)

    return states_with_drives(scenario, drives, run_state, faults)


def _initial_state(joint: Any, given: schema.SpatialJointStart) -> JointState:
    """State of a joint with the values that the run gives; other values are those of the reference pose at rest."""
    value, rates = [], []
    if slides(joint):
        value.append(joint.home_m if given.position_m is None else given.position_m)
        rates.append(given.speed_m_s or 0.0)
    if turns(joint):
        value.append(math.radians(joint.home_deg if given.angle_deg is None else given.angle_deg))
        rates.append(given.rate_rad_s or 0.0)
    if value:
        return JointState(np.array(rates), np.array(value))
    turn = orientation(given if given.is_turned else joint)
    spin = np.array(given.spin_rad_s or (0.0, 0.0, 0.0))
    if joint.type == "ball":
        return JointState(spin, turn=turn)
    position = np.array([given.x_m or 0.0, given.y_m or 0.0, given.z_m or 0.0])
    velocity = np.array([given.vx_m_s or 0.0, given.vy_m_s or 0.0, given.vz_m_s or 0.0])
    return JointState(np.concatenate([velocity, spin]), position=position, turn=turn)
