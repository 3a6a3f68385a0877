"""Initial configuration of a model: frames, workspace bounds, groups of welded bodies, initial motion."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from granular_contact.config import schema
from granular_contact.scene.types import InitialMotion, Vector, WorkspaceBound, rotation, turned

GROUND = "ground"
SIZES = {"hinge": 1, "slider": 1, "free": 3, "weld": 0}  # degrees of freedom of joints
ZERO = np.zeros(2)


@dataclass(frozen=True)
class Frame:
    """Where a body's frame lies at the start: origin (2,) m in the world, angle rad."""

    origin: Vector
    angle: float

    def world(self, point: Vector) -> Vector:
        """World position of a point (2,) m of the body, or of several (n, 2)."""
        moved: Vector = self.origin + point @ rotation(self.angle).T
        return moved

    def local(self, point: Vector) -> Vector:
        """Body-frame position of a world point (2,) m, or of several (n, 2)."""
        moved: Vector = (point - self.origin) @ rotation(-self.angle).T
        return moved


@dataclass(frozen=True)
class Twist:
    """How a body's frame moves at the start: velocity (2,) m/s of the world's origin moving along, rate rad/s."""

    velocity: Vector
    rate: float

    def at(self, world: Vector) -> Vector:
        """Velocity (2,) m/s of the body's point at a world position (2,) m."""
        return self.velocity + self.rate * np.array([-world[1], world[0]])


@dataclass(frozen=True)
class JointState:
    """Coordinates of a joint and their rates, (k,) each: rad clockwise, or m; of a free joint x, y and the angle."""

    value: Vector
    rates: Vector

    @property
    def coordinate(self) -> float:
        """Of a hinge or slider."""
        return float(self.value[0])

    def at(self, coordinate: float) -> JointState:
        """The same of a hinge or slider at another coordinate."""
        return JointState(np.array([coordinate]), self.rates)

    def displaced(self, change: Vector) -> JointState:
        """The state after a small displacement (k,)."""
        return JointState(self.value + change, self.rates)


def point(xy: tuple[float, float]) -> Vector:
    """Point of a config as an array (2,) m."""
    return np.array(xy, dtype=float)


def direction(joint: schema.SliderClosure) -> Vector:
    """Unit vector (2,) along the axis of a slider, in the frame of its parent."""
    axis = point(joint.axis)
    unit: Vector = axis / math.hypot(*axis)
    return unit


def joints_outward(model: Any) -> Iterator[tuple[str, Any]]:
    """Joints of a model, in the plane or in space, in topological order: every parent before its children."""
    below: dict[str, list[str]] = defaultdict(list)
    for name, joint in model.all_joints.items():
        below[joint.parent].append(name)
    waiting = below[GROUND][::-1]
    while waiting:
        name = waiting.pop()
        joint = model.all_joints[name]
        yield name, joint
        waiting += below[joint.child][::-1]


@dataclass(frozen=True)
class Pose:
    """Frames and twists of all bodies, the ground among them, in a state of the joints."""

    frames: dict[str, Frame]
    twists: dict[str, Twist]


def pose(model: schema.Model, states: Mapping[str, JointState], ground_angle: float) -> Pose:
    """Place and move all bodies, undeformed; what is welded to the ground is turned by ground_angle (rad)."""
    still = Twist(ZERO, 0.0)
    frames, twists = {GROUND: Frame(ZERO, 0.0)}, {GROUND: still}
    for name, joint in joints_outward(model):
        parent, motion = frames[joint.parent], twists[joint.parent]
        pin, angle, relative = _relative(joint, states.get(name), parent)
        if isinstance(joint, schema.Weld) and joint.parent == GROUND:
            angle += ground_angle
        frames[joint.child] = Frame(pin - rotation(angle) @ point(joint.child_point_m), angle)
        twists[joint.child] = Twist(motion.velocity + relative.velocity, motion.rate + relative.rate)
    return Pose(frames, twists)


def _relative(joint: schema.Joint, state: JointState | None, parent: Frame) -> tuple[Vector, float, Twist]:
    """Where a joint holds its child (m), at which angle (rad), and how the child moves against the parent."""
    at = point(joint.parent_point_m)
    pin = parent.world(at)
    if state is None or isinstance(joint, schema.Weld):
        assert isinstance(joint, schema.Weld)  # all others have a state
        return pin, parent.angle + turned(joint.home_deg), Twist(ZERO, 0.0)
    if isinstance(joint, schema.Slider):
        axis = rotation(parent.angle) @ direction(joint)
        pin = pin + state.value[0] * axis
        return pin, parent.angle + turned(joint.home_deg), Twist(state.rates[0] * axis, 0.0)
    shift, speed = (state.value[:2], state.rates[:2]) if isinstance(joint, schema.Free) else (ZERO, ZERO)
    pin, rate = pin + shift, -float(state.rates[-1])
    return pin, parent.angle - float(state.value[-1]), Twist(speed - rate * np.array([-pin[1], pin[0]]), rate)


def workspace_bounds(model: schema.Model, frames: Mapping[str, Frame]) -> dict[str, WorkspaceBound]:
    """Workspace bound of each body, whatever the coordinates of the joints.

    frames: of the bodies at the start. There is no bound beyond sliders and free joints. A welded part moves with the
    body that it is welded to.
    """
    held: dict[str, WorkspaceBound] = {}
    fixed = {GROUND}
    for _, joint in joints_outward(model):
        parent, on_parent, on_child = joint.parent, point(joint.parent_point_m), point(joint.child_point_m)
        rigidly = isinstance(joint, schema.Weld) and is_rigid(model, joint.child) and is_rigid(model, parent)
        if parent in fixed:
            workspace = WorkspaceBound(frames[parent].world(on_parent), on_child, 0.0)
            fixed |= {joint.child} if rigidly else set()
        elif rigidly:
            workspace = held[parent]
            workspace = replace(workspace, point=frames[joint.child].local(frames[parent].world(workspace.point)))
        else:
            workspace = WorkspaceBound(held[parent].root, on_child, held[parent].radius(on_parent))
        no_end = isinstance(joint, schema.Slider | schema.Free)
        held[joint.child] = replace(workspace, length=math.inf) if no_end else workspace
    return held


def is_rigid(model: Any, name: str) -> bool:
    """Whether a body (or the ground) is rigid."""
    if name == GROUND:
        return True
    body = model.all_bodies[name]
    return not (isinstance(body, schema.Link) and body.flexible is not None)


def weld_groups(model: Any) -> list[list[str]]:
    """Rigid bodies (and the ground) of a model, in the plane or in space, grouped by the welds between them."""
    groups = {name: [name] for name in (GROUND, *model.all_bodies) if is_rigid(model, name)}
    for _, joint in joints_outward(model):
        if joint.type == "weld" and joint.parent in groups and joint.child in groups:
            merged = groups[joint.parent]
            merged += groups[joint.child]
            for name in groups[joint.child]:
                groups[name] = merged
    distinct = {id(group): group for group in groups.values()}
    return list(distinct.values())


@dataclass(frozen=True)
class Layout:
    """A model laid out: pose and workspace bound of every body, groups of rigid bodies that are welded together."""

    model: schema.Model
    pose: Pose
    workspace_bounds: dict[str, WorkspaceBound]
    groups: list[list[str]]

    @property
    def frames(self) -> dict[str, Frame]:
        """Frames of all bodies, the ground among them."""
        return self.pose.frames

    def motion(self, name: str, frame: Frame) -> InitialMotion:
        """Pose and velocity of a frame that moves with a body."""
        twist = self.pose.twists[name]
        return InitialMotion(frame.origin, frame.angle, twist.at(frame.origin), twist.rate)

    @cached_property
    def _joined(self) -> dict[str, list[Vector]]:
        """Points of every body at which it is joined to another."""
        points: dict[str, list[Vector]] = defaultdict(list)
        for joint in (*self.model.all_joints.values(), *self.model.closures.values()):
            if joint.type != "free":
                points[joint.parent].append(point(joint.parent_point_m))
                points[joint.child].append(point(joint.child_point_m))
        return points

    def is_free(self, name: str, end: Vector) -> bool:
        """Whether nothing is joined to a body at this end (2,) m of it."""
        return not any(np.abs(at - end).max() <= 1e-9 for at in self._joined.get(name, ()))


def lay_out(model: schema.Model, states: Mapping[str, JointState], ground_angle: float) -> Layout:
    """Lay out a model in a state of its joints; what is welded to the ground is turned by ground_angle (rad)."""
    placed = pose(model, states, ground_angle)
    return Layout(model, placed, workspace_bounds(model, placed.frames), weld_groups(model))
