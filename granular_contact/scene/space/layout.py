"""Frames and twists of all bodies of a mechanism in space, in a state of its joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.joints import AnyClosure, AnyJoint
from granular_contact.scene.layout import GROUND, joints_outward
from granular_contact.scene.space import rotations
from granular_contact.scene.space.shapes import orientation
from granular_contact.scene.space.types import SpatialMotion, Vector

ZERO = np.zeros(3)


@dataclass(frozen=True)
class Frame:
    """Where a body's frame lies: origin (3,) m in the world, rotation (3, 3)."""

    origin: Vector
    rotation: Vector

    def world(self, point: Vector) -> Vector:
        """World position of a point (3,) m of the body."""
        moved: Vector = self.origin + self.rotation @ point
        return moved

    def local(self, point: Vector) -> Vector:
        """Body-frame position of a world point (3,) m."""
        moved: Vector = self.rotation.T @ (point - self.origin)
        return moved


@dataclass(frozen=True)
class Twist:
    """How a body's frame moves: velocity (3,) m/s of its origin, rate (3,) rad/s, world frame."""

    velocity: Vector
    rate: Vector


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


SIZES = {"hinge": 1, "slider": 1, "ball": 3, "free": 6, "weld": 0}  # degrees of freedom


def axis_of(joint: AnyJoint | AnyClosure) -> Vector:
    """Unit vector (3,) along the axis of a hinge or slider, in the frame of its child; z for any other joint."""
    if not isinstance(joint, schema.SpatialHingeClosure | schema.SpatialSliderClosure):
        return np.array([0.0, 0.0, 1.0])
    axis = np.array(joint.axis, float)
    return np.asarray(axis / np.linalg.norm(axis))


@dataclass(frozen=True)
class Pose:
    """Frames and twists of all bodies, the ground among them."""

    frames: dict[str, Frame]
    twists: dict[str, Twist]

    def velocity(self, body: str, world: Vector) -> Vector:
        """Velocity (3,) m/s of the point of a body that is at a world position (3,) m."""
        twist = self.twists[body]
        moved: Vector = twist.velocity + np.cross(twist.rate, world - self.frames[body].origin)
        return moved

    def motion(self, body: str, frame: Frame) -> SpatialMotion:
        """Pose and velocity of a frame that moves with a body."""
        velocity = self.velocity(body, frame.origin)
        return SpatialMotion(frame.origin, frame.rotation, velocity, self.twists[body].rate)


def pose(model: schema.SpatialModel, states: Mapping[str, JointState]) -> Pose:
    """Place and move all bodies."""
    placed = Pose({GROUND: Frame(ZERO, np.eye(3))}, {GROUND: Twist(ZERO, ZERO)})
    for name, joint in joints_outward(model):
        frame, moves = _child(joint, states.get(name), placed)
        placed.frames[joint.child], placed.twists[joint.child] = frame, moves
    return placed


def _child(joint: AnyJoint, state: JointState | None, placed: Pose) -> tuple[Frame, Twist]:
    """Frame and twist of the child of a joint."""
    parent, rate = placed.frames[joint.parent], placed.twists[joint.parent].rate
    pin, home, speed = parent.world(np.array(joint.parent_point_m)), orientation(joint), ZERO
    turn = parent.rotation @ home
    if state is not None and joint.type == "slider":
        along = turn @ axis_of(joint)
        pin, speed = pin + state.coordinate * along, state.rates[0] * along
    elif state is not None and joint.type == "hinge":
        turn = turn @ rotations.about(axis_of(joint), state.coordinate)
        rate = rate + state.rates[0] * (turn @ axis_of(joint))
    elif state is not None and joint.type == "ball":
        turn, rate = parent.rotation @ state.turn, rate + parent.rotation @ state.rates
    elif state is not None:
        pin, turn, speed, rate = pin + state.position, state.turn, state.rates[:3], rate + state.rates[3:]
    arm = turn @ np.array(joint.child_point_m)
    frame = Frame(pin - arm, turn)
    # (On a slider the point of the parent that is at the pin now moves on with the parent.)
    velocity = placed.velocity(joint.parent, pin) + speed - np.cross(rate, arm)
    return frame, Twist(velocity, rate)
