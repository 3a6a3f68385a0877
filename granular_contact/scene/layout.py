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
from granular_contact.scene.parts import InitialMotion, WorkspaceBound, rotation, scene_angle
from granular_contact.scene.start import InitialStates, RunState, states_with_drives
from granular_contact.scene.types import Drive, Vector

GROUND = "ground"
# Numbers of displacements and rotations that each type of joint leaves free.
FREEDOMS = {"hinge": (0, 1), "slider": (1, 0), "free": (2, 1), "weld": (0, 0)}
ZERO = np.zeros(2)
STILL = InitialMotion(ZERO, 0.0, ZERO, 0.0)
Pose = dict[str, InitialMotion]  # of all bodies and the ground


@dataclass(frozen=True)
class JointState:
    """Coordinates of a joint and their rates, (k,) each: rad clockwise, or m. A free joint has x, y and the angle."""

    value: Vector
    rates: Vector

    @property
    def coordinate(self) -> float:
        """Coordinate of a hinge or slider."""
        return float(self.value[0])

    def at(self, coordinate: float) -> JointState:
        """The state of a hinge or slider with the same rate at another coordinate."""
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


def pose_of(model: schema.Model, states: Mapping[str, JointState], ground_angle: float) -> Pose:
    """Poses and velocities of all bodies, undeformed; bodies welded to the ground are rotated by ground_angle (rad)."""
    pose = {GROUND: STILL}
    for name, joint in joints_outward(model):
        angle = ground_angle if joint.type == "weld" and joint.parent == GROUND else 0.0
        pose[joint.child] = _child(joint, states.get(name), pose[joint.parent], angle)
    return pose


def _child(joint: schema.Joint, state: JointState | None, parent: InitialMotion, turn: float) -> InitialMotion:
    """Pose and velocity of the child of a joint. turn (rad): rotation of a weld or slider besides its home angle."""
    pin, speed, rate = parent.world(point(joint.parent_point_m)), ZERO, parent.rate
    if isinstance(joint, schema.Slider | schema.Weld):
        angle = parent.angle + scene_angle(joint.home_deg) + turn
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


def initial_states(
    scenario: schema.Scenario, drives: tuple[Drive, ...], hinge_rate: float, faults: list[Fault]
) -> InitialStates:
    """Initial states of all joints of the tree, whether or not the loops close in them; faults are appended.

    hinge_rate: rate of the ground hinges (rad/s).
    """
    initial = scenario.initial

    def run_state(name: str, joint: schema.Joint) -> RunState:
        given = (initial.joints or {}).get(name, schema.JointStart())
        strikes = isinstance(joint, schema.Hinge) and joint.parent == GROUND and initial.impact_angle_deg is not None
        coordinates = (given.angle_deg, given.position_m, given.x_m, given.y_m)
        has_rate = given.rate_rad_s is not None or given.speed_m_s is not None
        free = isinstance(joint, schema.Free)
        return RunState(
            _initial_state(joint, given, initial, hinge_rate),
            free or strikes or any(coordinate is not None for coordinate in coordinates),
            free or (strikes and hinge_rate != 0.0) or has_rate,
        )

    return states_with_drives(scenario, drives, run_state, faults)


def _initial_state(
    joint: schema.Joint, given: schema.JointStart, initial: schema.Initial, hinge_rate: float
) -> JointState:
    """State of a joint with the values that the run gives; other values are those of the reference pose at rest."""
    if isinstance(joint, schema.Slider):
        position = joint.home_m if given.position_m is None else given.position_m
        return JointState(np.array([position]), np.array([given.speed_m_s or 0.0]))
    if isinstance(joint, schema.Free):
        value = [given.x_m or 0.0, given.y_m or 0.0, math.radians(given.angle_deg or 0.0)]
        rates = [given.vx_m_s or 0.0, given.vy_m_s or 0.0, given.rate_rad_s or 0.0]
        return JointState(np.array(value), np.array(rates))
    assert isinstance(joint, schema.Hinge)  # a weld has no state
    on_ground = joint.parent == GROUND
    home = initial.impact_angle_deg if on_ground and initial.impact_angle_deg is not None else joint.home_deg
    angle = home if given.angle_deg is None else given.angle_deg
    default_rate = hinge_rate if on_ground else 0.0
    rate = default_rate if given.rate_rad_s is None else given.rate_rad_s
    return JointState(np.array([math.radians(angle)]), np.array([rate]))


def workspace_bounds(model: schema.Model, pose: Pose) -> dict[str, WorkspaceBound]:
    """Workspace bound of each body, for all coordinates of the joints.

    pose: of the bodies at the start. Bodies outward of a slider or a free joint have no bound (infinite length). A
    welded part moves with the body that it is welded to.
    """
    bounds: dict[str, WorkspaceBound] = {}
    fixed = {GROUND}
    for _, joint in joints_outward(model):
        parent, on_parent, on_child = joint.parent, point(joint.parent_point_m), point(joint.child_point_m)
        rigidly = isinstance(joint, schema.Weld) and is_rigid(model, joint.child) and is_rigid(model, parent)
        if parent in fixed:
            workspace = WorkspaceBound(pose[parent].world(on_parent), on_child, 0.0)
            fixed |= {joint.child} if rigidly else set()
        elif rigidly:
            workspace = bounds[parent]
            workspace = replace(workspace, point=pose[joint.child].local(pose[parent].world(workspace.point)))
        else:
            workspace = WorkspaceBound(bounds[parent].root, on_child, bounds[parent].radius(on_parent))
        unbounded = isinstance(joint, schema.Slider | schema.Free)
        bounds[joint.child] = replace(workspace, length=math.inf) if unbounded else workspace
    return bounds


def is_rigid(model: Any, name: str) -> bool:
    """Whether a body (or the ground) is rigid."""
    if name == GROUND:
        return True
    body = model.all_bodies[name]
    return not (isinstance(body, schema.Link) and body.flexible is not None)


def weld_groups(model: Any) -> list[list[str]]:
    """Groups of rigid bodies (and the ground) that are welded together, of a model in the plane or in space."""
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
    """Initial configuration of a model: pose and workspace bound of every body, groups of welded rigid bodies."""

    model: schema.Model
    pose: Pose
    workspace_bounds: dict[str, WorkspaceBound]
    groups: list[list[str]]

    @cached_property
    def _joined(self) -> dict[str, list[Vector]]:
        """Points (2,) m of every body at which it is joined to another, in its frame."""
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
    """Lay out a model in a state of its joints; bodies welded to the ground are rotated by ground_angle (rad)."""
    pose = pose_of(model, states, ground_angle)
    return Layout(model, pose, workspace_bounds(model, pose), weld_groups(model))
