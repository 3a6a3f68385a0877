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
from granular_contact.scene.parts import InitialMotion, WorkspaceBound, rotation, turned
from granular_contact.scene.types import Vector

GROUND = "ground"
SIZES = {"hinge": 1, "slider": 1, "free": 3, "weld": 0}  # degrees of freedom of joints
ZERO = np.zeros(2)
STILL = InitialMotion(ZERO, 0.0, ZERO, 0.0)
Pose = dict[str, InitialMotion]  # of all bodies, the ground among them


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


def pose(model: schema.Model, states: Mapping[str, JointState], ground_angle: float) -> Pose:
    """Place and move all bodies, undeformed; what is welded to the ground is turned by ground_angle (rad)."""
    placed = {GROUND: STILL}
    for name, joint in joints_outward(model):
        angle = ground_angle if joint.type == "weld" and joint.parent == GROUND else 0.0
        placed[joint.child] = _child(joint, states.get(name), placed[joint.parent], angle)
    return placed


def _child(joint: schema.Joint, state: JointState | None, parent: InitialMotion, turn: float) -> InitialMotion:
    """Pose and velocity of the child of a joint, which is turned besides (rad)."""
    pin, speed, rate = parent.world(point(joint.parent_point_m)), ZERO, parent.rate
    if isinstance(joint, schema.Slider | schema.Weld):
        angle = parent.angle + turned(joint.home_deg) + turn
    if isinstance(joint, schema.Slider) and state is not None:
        axis = rotation(parent.angle) @ direction(joint)
        pin, speed = pin + state.value[0] * axis, state.rates[0] * axis
    elif state is not None:
        angle, rate = parent.angle - float(state.value[-1]), rate - float(state.rates[-1])
        if isinstance(joint, schema.Free):
            pin, speed = pin + state.value[:2], state.rates[:2]
    arm = rotation(angle) @ point(joint.child_point_m)
    velocity = parent.speed_at(pin) + speed - rate * np.array([-arm[1], arm[0]])
    return InitialMotion(pin - arm, angle, velocity, rate)


def workspace_bounds(model: schema.Model, placed: Pose) -> dict[str, WorkspaceBound]:
    """Workspace bound of each body, whatever the coordinates of the joints.

    placed: the bodies at the start. There is no bound beyond sliders and free joints. A welded part moves with the
    body that it is welded to.
    """
    held: dict[str, WorkspaceBound] = {}
    fixed = {GROUND}
    for _, joint in joints_outward(model):
        parent, on_parent, on_child = joint.parent, point(joint.parent_point_m), point(joint.child_point_m)
        rigidly = isinstance(joint, schema.Weld) and is_rigid(model, joint.child) and is_rigid(model, parent)
        if parent in fixed:
            workspace = WorkspaceBound(placed[parent].world(on_parent), on_child, 0.0)
            fixed |= {joint.child} if rigidly else set()
        elif rigidly:
            workspace = held[parent]
            workspace = replace(workspace, point=placed[joint.child].local(placed[parent].world(workspace.point)))
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
    placed: Pose
    workspace_bounds: dict[str, WorkspaceBound]
    groups: list[list[str]]

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
    return Layout(model, placed, workspace_bounds(model, placed), weld_groups(model))
