"""Kinematic loops at the start: closing them, states of dependent joints, redundant constraints."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import schema
from granular_contact.errors import Fault, scene_fault
from granular_contact.scene.homes import home_notes, nearest_closed
from granular_contact.scene.layout import FREEDOMS, JointState, Pose, direction, is_rigid, point, pose_of
from granular_contact.scene.parts import rotation, scene_angle
from granular_contact.scene.start import InitialStates, home
from granular_contact.scene.types import Drive, Vector

Mask = NDArray[np.bool_]
# A loop of the config may be open by this much (m, rad) without a note; it is then closed to round-off.
LARGEST_GAP, LARGEST_TILT = 1e-4, math.radians(0.01)
RANK_TOLERANCE = 1e-9  # of singular values, relative to the largest entry of the Jacobian, or to 1 if that is larger
_CONTINUATION_STEPS = 8  # from the reference configuration of a loop to the coordinates that the run gives


class Loops:
    """Loop-closure equations of a model as functions of the states of its tree of joints; in the plane `PlanarLoops`.

    freedoms: for each type of joint the numbers of free displacements and rotations, which are its coordinates in this
    order. slices: of each joint its degrees of freedom in a vector (size,). States: `JointState` of the layout, in the
    plane or in space.
    """

    def __init__(self, model: Any, freedoms: Mapping[str, tuple[int, int]]) -> None:
        self.model, self.freedoms = model, freedoms
        sizes = {kind: sum(both) for kind, both in freedoms.items()}
        self.joints = {name: joint for name, joint in model.all_joints.items() if sizes[joint.type] > 0}
        ends = np.cumsum([0, *(sizes[joint.type] for joint in self.joints.values())])
        self.slices = {name: slice(a, b) for name, a, b in zip(self.joints, ends, ends[1:], strict=False)}
        self.size = int(ends[-1])

    def pose_of(self, states: Mapping[str, Any]) -> Any:
        """Pose of the mechanism."""
        raise NotImplementedError

    def residual(self, name: str, pose: Any) -> Vector:
        """Residual of a closure (m, rad) in a pose."""
        raise NotImplementedError

    def residual_rates(self, name: str, pose: Any) -> Vector:
        """Rates of a closed loop's residual in a pose."""
        raise NotImplementedError

    def gap(self, name: str, residual: Vector) -> tuple[float, float]:
        """Distance (m) and angle (rad) in the residual of a closure."""
        raise NotImplementedError

    def mask(self, names: frozenset[str]) -> Mask:
        """Mask (size,) of the degrees of freedom of these joints."""
        mask = np.zeros(self.size, bool)
        for name in names:
            mask[self.slices[name]] = True
        return mask

    def rates(self, states: Mapping[str, Any]) -> Vector:
        """Rates (size,) of the joints."""
        return np.concatenate([np.zeros(0), *(states[name].rates for name in self.joints)])

    def with_rates(self, states: Mapping[str, Any], rates: Vector) -> dict[str, Any]:
        """The same states with other rates (size,)."""
        return {name: replace(states[name], rates=rates[part]) for name, part in self.slices.items()}

    def jacobian(self, states: Mapping[str, Any]) -> dict[str, Vector]:
        """Constraint Jacobian (rows, size) of every closure, in a closed pose."""
        still = self.pose_of(states)
        jacobians = {name: np.zeros((len(self.residual(name, still)), self.size)) for name in self.model.closures}
        for i, unit in enumerate(np.eye(self.size)):
            pose = self.pose_of(self.with_rates(states, unit))
            for name, jacobian in jacobians.items():
                jacobian[:, i] = self.residual_rates(name, pose)
        return jacobians

    def close(self, states: dict[str, Any], movable: Mask) -> dict[str, Any]:
        """Close all loops by Newton's method from these states; only the movable degrees of freedom change.

        It takes at most 20 iterations, and returns the last states, also if loops are still open.
        """
        for _ in range(20 if movable.any() else 0):
            pose = self.pose_of(states)
            residual = np.concatenate([self.residual(name, pose) for name in self.model.closures])
            if np.abs(residual).max() < 1e-14:
                break
            jacobian = np.concatenate(list(self.jacobian(states).values()))[:, movable]
            change = np.zeros(self.size)
            change[movable] = -np.linalg.lstsq(jacobian, residual, rcond=1e-10)[0]
            states = {name: states[name].displaced(change[part]) for name, part in self.slices.items()}
        return states


class PlanarLoops(Loops):
    """Loop-closure equations in the plane; bodies welded to the ground are rotated by ground_angle (rad)."""

    def __init__(self, model: schema.Model, ground_angle: float) -> None:
        super().__init__(model, FREEDOMS)
        self.ground_angle = ground_angle

    def pose_of(self, states: Mapping[str, JointState]) -> Pose:
        """Pose of the mechanism."""
        return pose_of(self.model, states, self.ground_angle)

    def residual(self, name: str, pose: Pose) -> Vector:
        """Residual of a closure: (2,) m of a hinge, (m, rad) of a slider, (m, m, rad) of a weld."""
        joint = self.model.closures[name]
        parent, child = pose[joint.parent], pose[joint.child]
        gap = child.world(point(joint.child_point_m)) - parent.world(point(joint.parent_point_m))
        turn = child.angle - parent.angle - scene_angle(getattr(joint, "home_deg", 0.0))
        return _constrained(joint, parent.angle, gap, turn - 2.0 * math.pi * round(turn / (2.0 * math.pi)))

    def residual_rates(self, name: str, pose: Pose) -> Vector:
        """Rates of a closed loop's residual: differences of velocities and of angular rates."""
        joint = self.model.closures[name]
        parent, child = pose[joint.parent], pose[joint.child]
        pin = child.world(point(joint.child_point_m))
        velocity = child.speed_at(pin) - parent.speed_at(pin)
        return _constrained(joint, parent.angle, velocity, child.rate - parent.rate)

    def gap(self, name: str, residual: Vector) -> tuple[float, float]:
        """Distance (m) and angle (rad) in the residual of a closure."""
        if FREEDOMS[self.model.closures[name].type][1]:
            return float(np.linalg.norm(residual)), 0.0
        return float(np.linalg.norm(residual[:-1])), abs(float(residual[-1]))


def _constrained(joint: schema.Closure, angle: float, gap: Vector, turn: float) -> Vector:
    """Components that a closure constrains of a displacement (2,) and a rotation; angle (rad): of its parent."""
    displacements, turns = FREEDOMS[joint.type]
    if displacements:
        along = rotation(angle) @ direction(joint)
        gap = np.array([np.array([-along[1], along[0]]) @ gap])
    return gap if turns else np.array([*gap, turn])


def close_loops(loops: Loops, initial: InitialStates, faults: list[Fault], notes: list[Fault]) -> dict[str, Any]:
    """Close all loops in position and velocity: joint states with the given coordinates and rates, others dependent.

    Where loops are open in the reference configuration of the config, the nearest configuration in which they close
    takes its place, and a note is appended. Faults of loops that can't be closed are appended.
    """
    if not loops.model.closures:
        return initial.states
    moving = {name: joint for name, joint in loops.joints.items() if joint.type in ("hinge", "slider")}
    written = initial.states | {name: initial.states[name].at(home(joint)) for name, joint in moving.items()}
    is_open = bool(_open_loops(loops, written, ""))
    states = nearest_closed(loops, written) if is_open else written
    faults += _open_loops(loops, states, ", whatever its joints; at best")
    if faults:
        return initial.states
    states = loops.close(states, np.ones(loops.size, dtype=bool))
    notes += home_notes(loops, written, states) if is_open else []
    if initial.with_coordinate:
        dependent = ~loops.mask(initial.with_coordinate)
        homes = {name: states[name].coordinate for name in initial.with_coordinate & moving.keys()}
        states |= {name: initial.states[name] for name in initial.with_coordinate - moving.keys()}
        for share in np.linspace(0.0, 1.0, _CONTINUATION_STEPS + 1)[1:] if homes else (1.0,):
            for name, start in homes.items():
                states[name] = states[name].at(start + float(share) * (initial.states[name].coordinate - start))
            states = loops.close(states, dependent)
        faults += _open_loops(loops, states, " at the start:")
    given = loops.mask(initial.with_rate)
    rates = dependent_rates(loops.jacobian(states), given, loops.rates(initial.states), faults)
    return loops.with_rates(states, rates)


def dependent_rates(jacobians: Mapping[str, Vector], given: Mask, rates: Vector, faults: list[Fault]) -> Vector:
    """Rates (n,) that keep loops closed: the given ones (mask) unchanged, the others by least squares.

    A fault is appended if the given rates open a loop.
    """
    jacobian = np.concatenate(list(jacobians.values()))
    rates = np.where(given, rates, 0.0)
    if not given.all():
        rates[~given] = np.linalg.lstsq(jacobian[:, ~given], -jacobian @ rates, rcond=1e-10)[0]
    opening = float(np.abs(jacobian @ rates).max(initial=0.0))
    if opening > 1e-6 * max(1.0, float(np.abs(rates).max(initial=0.0))):
        words = f"the joint rates violate a loop closure by {opening:.3g} m/s or rad/s: give fewer of them"
        faults.append(scene_fault("initial.joints", words))
    return rates


def _open_loops(loops: Loops, states: Mapping[str, Any], when: str) -> list[Fault]:
    """Faults of all loops that are open in these states; when: the middle of the sentence."""
    faults, pose = [], loops.pose_of(states)
    for name, joint in loops.model.closures.items():
        distance, turn = loops.gap(name, loops.residual(name, pose))
        if distance > LARGEST_GAP or turn > LARGEST_TILT:
            words = f"the loop does not close{when} {joint.parent} and {joint.child} are {distance:.4g} m"
            words += f" and {math.degrees(turn):.4g} deg" if turn > LARGEST_TILT else ""
            words += f" apart there; allowed are {LARGEST_GAP:g} m"
            words += f" and {math.degrees(LARGEST_TILT):g} deg" if turn else ""
            faults.append(scene_fault(f"model.closures.{name}", words))
    return faults


def redundancy_faults(
    model: schema.Model, states: Mapping[str, JointState], ground_angle: float, drives: tuple[Drive, ...]
) -> list[Fault]:
    """Faults of redundant closures and prescribed motions, by the rank of the constraint Jacobian at the start.

    A loop through a flexible link is never redundant.
    """
    if not model.closures:
        return []
    loops = PlanarLoops(model, ground_angle)
    jacobians = loops.jacobian(states).items()
    constraints = {("closures", name): rows for name, rows in jacobians if not _has_flexible_link(model, name)}
    for drive in drives:
        if drive.kind == "motion" and drive.joint in loops.slices:
            constraints["drives", drive.joint] = np.eye(loops.size)[loops.slices[drive.joint]]
    independent, rank, faults = np.zeros((0, loops.size)), 0, []
    scale = max((float(np.abs(rows).max(initial=0.0)) for rows in constraints.values()), default=1.0)
    for (kind, name), rows in constraints.items():
        stacked = np.vstack([independent, rows])
        gained = int(np.linalg.matrix_rank(stacked, tol=RANK_TOLERANCE * max(scale, 1.0))) - rank
        if gained == len(rows):
            independent, rank = stacked, rank + gained
            continue
        spare = len(rows) - gained
        verb = "is" if spare == 1 else "are"
        words = f"{spare} of the {len(rows)} constraint{'s' * (len(rows) > 1)} of {name} {verb} redundant with the"
        words += " other joints: leave it out, or choose a type with fewer constraints"
        faults.append(scene_fault(f"{'model.' * (kind == 'closures')}{kind}.{name}", words))
    return faults


def _has_flexible_link(model: schema.Model, closure: str) -> bool:
    """Whether the loop of a closure contains a flexible link."""
    inward_joint = {joint.child: joint for joint in model.all_joints.values()}

    def path(body: str) -> list[str]:
        """Bodies from this one to the ground."""
        bodies = [body]
        while bodies[-1] in inward_joint:
            bodies.append(inward_joint[bodies[-1]].parent)
        return bodies

    joint = model.closures[closure]
    loop = set(path(joint.parent)) ^ set(path(joint.child)) | {joint.parent, joint.child}
    return any(not is_rigid(model, body) for body in loop)
