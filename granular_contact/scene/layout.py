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
from granular_contact.errors import Fault
from granular_contact.scene.parts import InitialMotion, WorkspaceBound, rotation, turned
from granular_contact.scene.start import Said, Start, begun
from granular_contact.scene.types import Drive, Vector

GROUND = "ground"
# Displacements and turns that joints leave free.
FREEDOMS = {"hinge": (0, 1), "slider": (1, 0), "free": (2, 1), "weld": (0, 0)}
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


def direction(joint: Any) -> Vector:
    """Unit vector (2,) along the axis of a joint, in the frame of its parent."""
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


def start(scenario: schema.Scenario, drives: tuple[Drive, ...], impact_speed: float, faults: list[Fault]) -> Start:
    """Initial states of all joints of the tree, not looking at loops; faults are appended.

    impact_speed: rate of the ground hinges (rad/s).
    """
    initial = scenario.initial

    def said(name: str, joint: schema.Joint) -> Said:
        given = (initial.joints or {}).get(name, schema.JointStart())
        struck = isinstance(joint, schema.Hinge) and joint.parent == GROUND and initial.impact_angle_deg is not None
        places = (given.angle_deg, given.position_m, given.x_m, given.y_m)
        has_rate = given.rate_rad_s is not None or given.speed_m_s is not None
        free = isinstance(joint, schema.Free)
        return Said(
            _said(joint, given, initial, impact_speed),
            free or struck or any(v is not None for v in places),
            free or (struck and impact_speed != 0.0) or has_rate,
        )

    return begun(scenario, drives, said, faults)


def _said(joint: schema.Joint, said: schema.JointStart, initial: schema.Initial, impact_speed: float) -> JointState:
    """State of a joint as the run gives it; the reference configuration at rest where it does not."""
    if isinstance(joint, schema.Slider):
        at = joint.home_m if said.position_m is None else said.position_m
        return JointState(np.array([at]), np.array([said.speed_m_s or 0.0]))
    if isinstance(joint, schema.Free):
        value = [said.x_m or 0.0, said.y_m or 0.0, math.radians(said.angle_deg or 0.0)]
        return JointState(np.array(value), np.array([said.vx_m_s or 0.0, said.vy_m_s or 0.0, said.rate_rad_s or 0.0]))
    assert isinstance(joint, schema.Hinge)  # a weld has no state
    on_ground = joint.parent == GROUND
    home = initial.impact_angle_deg if on_ground and initial.impact_angle_deg is not None else joint.home_deg
    angle = home if said.angle_deg is None else said.angle_deg
    speed = impact_speed if on_ground else 0.0
    return JointState(
        np.array([math.radians(angle)]), np.array([speed if said.rate_rad_s is None else said.rate_rad_s])
    )


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
