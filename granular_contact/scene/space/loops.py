"""Kinematic loops in space: whether they close, states of dependent joints, and which constraints are needed.

Most loops in space hold more than they need: a four-bar of four hinges has three constraints too many. Of each closure
those that the joints before it hold already are left out, by the rank of the constraints' Jacobian at the start.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.joints import AnyClosure, AnyJoint
from granular_contact.errors import Fault, scene_fault
from granular_contact.scene.loops import LARGEST_GAP, LARGEST_TILT, RANK_TOLERANCE, Mask, dependent_rates
from granular_contact.scene.space import rotations
from granular_contact.scene.space.layout import SIZES, JointState, Pose, axis_of, pose
from granular_contact.scene.space.shapes import orientation
from granular_contact.scene.space.start import home
from granular_contact.scene.space.types import Vector
from granular_contact.scene.start import Start
from granular_contact.scene.types import Drive

# Displacements along the axes of the joint's frame, whose z is its axis, and rotations about them, that are held.
CONSTRAINED = {
    "hinge": (True, True, True, True, True, False),
    "slider": (True, True, False, True, True, True),
    "weld": (True,) * 6,
    "ball": (True, True, True, False, False, False),
    "free": (False,) * 6,
}
_CONTINUATION_STEPS = 8  # in which a loop is led from home to where the run wants it


class Loops:
    """The loops of a model, as equations of the states of its tree of joints."""

    def __init__(self, model: schema.SpatialModel) -> None:
        self.model = model
        self.joints = {name: joint for name, joint in model.all_joints.items() if joint.type != "weld"}
        ends = np.cumsum([0, *(SIZES[joint.type] for joint in self.joints.values())])
        self.places = {name: slice(a, b) for name, a, b in zip(self.joints, ends, ends[1:], strict=False)}
        self.size = int(ends[-1])

    def mask(self, names: frozenset[str]) -> Mask:
        """Which degrees of freedom (size,) belong to these joints."""
        found = np.zeros(self.size, bool)
        for name in names:
            found[self.places[name]] = True
        return found

    def rates(self, states: Mapping[str, JointState]) -> Vector:
        """Rates (size,) of the joints."""
        return np.concatenate([np.zeros(0), *(states[name].rates for name in self.joints)])

    def moving(self, states: Mapping[str, JointState], rates: Vector) -> dict[str, JointState]:
        """The same states with other rates (size,)."""
        return {name: _with(states[name], rates[self.places[name]]) for name in self.joints}

    def displaced(self, states: Mapping[str, JointState], change: Vector) -> dict[str, JointState]:
        """States after small displacements (size,), as rates over a unit of time."""
        return {name: _displaced(self.joints[name].type, states[name], change[at]) for name, at in self.places.items()}

    def gaps(self, name: str, placed: Pose) -> Vector:
        """Residual (6,) of a closure along and about the axes of its frame: m, rad; what it leaves free is zero."""
        joint = self.model.closures[name]
        frame, at_child = joint_frame(joint, placed)
        at_parent = placed.frames[joint.parent].world(np.array(joint.parent_point_m))
        turn = frame.T @ placed.frames[joint.child].rotation @ rotations.to_axis(axis_of(joint))
        gap = np.concatenate([frame.T @ (at_child - at_parent), _misaligned(joint, turn)])
        return np.where(CONSTRAINED[joint.type], gap, 0.0)

    def gap_rates(self, name: str, placed: Pose) -> Vector:
        """Rates (6,) of a closed loop's residual."""
        joint = self.model.closures[name]
        frame, at_child = joint_frame(joint, placed)
        apart = placed.velocity(joint.child, at_child) - placed.velocity(joint.parent, at_child)
        spin = placed.twists[joint.child].rate - placed.twists[joint.parent].rate
        return np.where(CONSTRAINED[joint.type], np.concatenate([frame.T @ apart, frame.T @ spin]), 0.0)

    def jacobian(self, states: Mapping[str, JointState]) -> dict[str, Vector]:
        """Constraint Jacobian (6, size) of every closure, in a closed pose."""
        slopes = {name: np.zeros((6, self.size)) for name in self.model.closures}
        for i, unit in enumerate(np.eye(self.size)):
            placed = pose(self.model, self.moving(states, unit))
            for name, slope in slopes.items():
                slope[:, i] = self.gap_rates(name, placed)
        return slopes

    def close(self, states: dict[str, JointState], movable: Mask) -> dict[str, JointState]:
        """States near these that close all loops, or as far as Newton's method gets; only the movable change."""
        for _ in range(20 if movable.any() else 0):
            placed = pose(self.model, states)
            gap = np.concatenate([self.gaps(name, placed) for name in self.model.closures])
            if np.abs(gap).max() < 1e-14:
                break
            slope = np.concatenate(list(self.jacobian(states).values()))[:, movable]
            change = np.zeros(self.size)
            change[movable] = -np.linalg.lstsq(slope, gap, rcond=1e-10)[0]
            states = self.displaced(states, change)
        return states


def joint_frame(joint: AnyJoint | AnyClosure, placed: Pose) -> tuple[Vector, Vector]:
    """Axes (3, 3) of a joint's frame on its parent, in the world, and the joint's point (3,) m on its child."""
    turn = placed.frames[joint.parent].rotation @ orientation(joint) @ rotations.to_axis(axis_of(joint))
    return turn, placed.frames[joint.child].world(np.array(joint.child_point_m))


def _misaligned(joint: AnyClosure, turn: Vector) -> Vector:
    """Rotation vector (3,) rad by which a closure's frames differ, apart from what a hinge leaves free."""
    if joint.type != "hinge":
        return rotations.vector_of(turn)
    z = turn[:, 2]
    sine = np.array([-z[1], z[0], 0.0])
    size = float(np.hypot(z[0], z[1]))
    return sine * (math.atan2(size, float(z[2])) / size) if size > 0.0 else sine


def _with(state: JointState, rates: Vector) -> JointState:
    return JointState(rates, state.coordinate, state.position, state.turn)


def _displaced(kind: str, state: JointState, change: Vector) -> JointState:
    if kind in ("hinge", "slider"):
        return JointState(state.rates, state.coordinate + float(change[0]), state.position, state.turn)
    turn = rotations.of_vector(change[-3:]) @ state.turn
    position = state.position + change[:3] if kind == "free" else state.position
    return JointState(state.rates, state.coordinate, position, turn)


def closed(scenario: schema.SpatialScenario, begun: Start, faults: list[Fault]) -> dict[str, JointState]:
    """Joint states that close all loops in position and velocity; joints not given follow. Faults are appended."""
    model = scenario.model
    if not model.closures:
        return begun.states
    loops = Loops(model)
    states = dict(begun.states)
    for name, joint in loops.joints.items():
        if joint.type in ("hinge", "slider"):
            states[name] = JointState(states[name].rates, home(joint))
    faults += _open(loops, states, "at home")
    if faults:
        return begun.states
    states = loops.close(states, np.ones(loops.size, dtype=bool))
    placed = loops.mask(begun.placed)
    led = [name for name in begun.placed if loops.joints[name].type in ("hinge", "slider")]
    if led:
        first = {name: states[name].coordinate for name in led}
        for share in np.linspace(0.0, 1.0, _CONTINUATION_STEPS + 1)[1:]:
            for name in led:
                target = first[name] + float(share) * (begun.states[name].coordinate - first[name])
                states[name] = JointState(states[name].rates, target)
            states = loops.close(states, ~placed)
        faults += _open(loops, states, "at the start")
    given = loops.mask(begun.moved), loops.rates(begun.states)
    return loops.moving(states, dependent_rates(loops.jacobian(states), *given, faults))


def _open(loops: Loops, states: Mapping[str, JointState], when: str) -> list[Fault]:
    """A fault for every loop that does not close."""
    faults, placed = [], pose(loops.model, states)
    for name, joint in loops.model.closures.items():
        gap = loops.gaps(name, placed)
        distance, turn = float(np.linalg.norm(gap[:3])), float(np.linalg.norm(gap[3:]))
        if distance > LARGEST_GAP or turn > LARGEST_TILT:
            words = f"the loop does not close {when}: {joint.parent} and {joint.child} are {distance:.4g} m and "
            words += f"{math.degrees(turn):.4g} deg apart there; "
            words += f"allowed are {LARGEST_GAP:g} m and {math.degrees(LARGEST_TILT):g} deg"
            faults.append(scene_fault(f"model.closures.{name}", words))
    return faults


def needed(
    model: schema.SpatialModel, states: Mapping[str, JointState], drives: tuple[Drive, ...], faults: list[Fault]
) -> dict[str, tuple[bool, ...]]:
    """Of each closure which of its six constraints the joints before it do not hold already.

    A fault is appended for a closure of which none is left, and for a prescribed motion that the loops do not allow.
    """
    if not model.closures:
        return {}
    loops, found = Loops(model), {}
    held, rank = np.zeros((0, loops.size)), 0
    for name, slope in loops.jacobian(states).items():
        keep = [False] * 6
        for row in np.flatnonzero(CONSTRAINED[model.closures[name].type]):
            tried = np.vstack([held, slope[row]])
            if _rank(tried) > rank:
                held, rank, keep[row] = tried, rank + 1, True
        found[name] = tuple(keep)
        if not any(keep):
            words = f"all that {name} holds is held by the other joints: leave it out"
            faults.append(scene_fault(f"model.closures.{name}", words))
    for drive in drives:
        if drive.kind == "motion" and drive.joint in loops.places:
            tried = np.vstack([held, np.eye(loops.size)[loops.places[drive.joint]]])
            if _rank(tried) == rank:
                words = f"the motion of {drive.joint} is redundant with the other joints: leave it out"
                faults.append(scene_fault(f"drives.{drive.joint}", words))
            held, rank = tried, _rank(tried)
    return found


def _rank(rows: Vector) -> int:
    scale = max(1.0, float(np.abs(rows).max(initial=0.0)))
    return int(np.linalg.matrix_rank(rows, tol=RANK_TOLERANCE * scale))
