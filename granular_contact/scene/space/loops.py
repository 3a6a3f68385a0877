"""Kinematic loops in space: closing them at the start, and the independent constraints of their closures.

Most loops in space are overconstrained: a four-bar of four hinges has three redundant constraints. Constraints of a
closure that the joints before it satisfy already are left out, by the rank of the constraint Jacobian at the start.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.joints import AnyClosure, AnyJoint
from granular_contact.errors import Fault, scene_fault
from granular_contact.geometry import rotations
from granular_contact.scene.loops import RANK_TOLERANCE, Loops
from granular_contact.scene.space.layout import (
    BENDING,
    CONSTRAINED,
    FREEDOMS,
    JointState,
    Pose,
    axis_of,
    pose_of,
    turns,
)
from granular_contact.scene.space.shapes import orientation
from granular_contact.scene.space.types import Vector
from granular_contact.scene.types import Drive


class SpatialLoops(Loops):
    """Loop-closure equations of a model in space."""

    def __init__(self, model: schema.SpatialModel, *, bending: bool = False) -> None:
        """bending: give elements of links freedom to bend and stretch; loops are closed with straight links."""
        super().__init__(model, FREEDOMS | BENDING if bending else FREEDOMS)

    def pose_of(self, states: Mapping[str, JointState]) -> Pose:
        """Pose of the mechanism."""
        return pose_of(self.model, states)

    def residual(self, name: str, pose: Pose) -> Vector:
        """Residual (6,) of a closure along and about the axes of its frame (m, rad); 0 for free components."""
        joint = self.model.closures[name]
        frame, at_child = joint_frame(joint, pose)
        at_parent = pose[joint.parent].world(np.array(joint.parent_point_m))
        turn = frame.T @ pose[joint.child].rotation @ rotations.to_axis(axis_of(joint))
        gap = np.concatenate([frame.T @ (at_child - at_parent), _misaligned(joint, turn)])
        return np.where(CONSTRAINED[joint.type], gap, 0.0)

    def residual_rates(self, name: str, pose: Pose) -> Vector:
        """Rates (6,) of a closed loop's residual."""
        joint = self.model.closures[name]
        frame, at_child = joint_frame(joint, pose)
        parent, child = pose[joint.parent], pose[joint.child]
        velocity, spin = child.speed_at(at_child) - parent.speed_at(at_child), child.rate - parent.rate
        return np.where(CONSTRAINED[joint.type], np.concatenate([frame.T @ velocity, frame.T @ spin]), 0.0)

    def gap(self, name: str, residual: Vector) -> tuple[float, float]:  # noqa: ARG002
        """Distance (m) and angle (rad) in the residual of a closure."""
        return float(np.linalg.norm(residual[:3])), float(np.linalg.norm(residual[3:]))


def joint_frame(joint: AnyJoint | AnyClosure, pose: Pose) -> tuple[Vector, Vector]:
    """Axes (3, 3) of a joint's frame on its parent, and the joint's point (3,) m on its child, in the world frame."""
    turn = pose[joint.parent].rotation @ orientation(joint)
    if getattr(joint, "elastic", None) is None:  # an elastic joint has the frame of its link
        turn = turn @ rotations.to_axis(axis_of(joint))
    return turn, pose[joint.child].world(np.array(joint.child_point_m))


def _misaligned(joint: AnyClosure, turn: Vector) -> Vector:
    """Rotation vector (3,) rad between the frames of a closure, without the rotation about its axis if that is free.

    turn (3, 3): axes of the child's frame in the parent's frame.
    """
    if not turns(joint):
        return rotations.vector_of(turn)
    z = turn[:, 2]
    sine = np.array([-z[1], z[0], 0.0])
    size = float(np.hypot(z[0], z[1]))
    return sine * (math.atan2(size, float(z[2])) / size) if size > 0.0 else sine


def independent_constraints(
    model: schema.SpatialModel, states: Mapping[str, JointState], drives: tuple[Drive, ...], faults: list[Fault]
) -> dict[str, tuple[bool, ...]]:
    """Independent constraints of each closure, a mask (6,): those that the joints before it do not satisfy already.

    A fault is appended for a closure without independent constraints, for a closure that needs a change of the length
    of a straight link that can't stretch, and for a prescribed motion that the loops do not allow.
    """
    if not model.closures:
        return {}
    loops = SpatialLoops(model, bending=True)
    links = {name: joint for name, joint in loops.joints.items() if joint.type in BENDING}
    straight = {name: JointState(np.zeros(4)) for name in links}
    jacobians, movable = loops.jacobian({**states, **straight}), np.ones(loops.size, bool)
    with_stretch = _independent(model, jacobians)[0]
    movable[[loops.slices[name].start for name, joint in links.items() if joint.type == "elastic"]] = False
    constraints, rows = _independent(model, {name: jacobian[:, movable] for name, jacobian in jacobians.items()})
    for name, mask in constraints.items():
        if mask != with_stretch[name]:
            words = (
                "holds a straight link by both of its ends, but the link can't stretch: give axial_stiffness_N of links"
            )
            faults.append(scene_fault(f"model.closures.{name}", f"{name} {words}"))
        elif not any(mask):
            words = f"all constraints of {name} are redundant with the other joints: leave it out"
            faults.append(scene_fault(f"model.closures.{name}", words))
    rank = len(rows)
    for drive in drives:
        if drive.kind == "motion" and drive.joint in loops.slices:
            rows = np.vstack([rows, np.eye(loops.size)[loops.slices[drive.joint]][:, movable]])
            if _rank(rows) == rank:
                words = f"the motion of {drive.joint} is redundant with the other joints: leave it out"
                faults.append(scene_fault(f"drives.{drive.joint}", words))
            rank = _rank(rows)
    return constraints


def _independent(
    model: schema.SpatialModel, jacobians: Mapping[str, Vector]
) -> tuple[dict[str, tuple[bool, ...]], Vector]:
    """Mask (6,) of the independent constraints of each closure, and their rows of the Jacobian."""
    constraints, rows = {}, np.zeros((0, next(iter(jacobians.values())).shape[1]))
    for name, jacobian in jacobians.items():
        mask = [False] * 6
        for i in np.flatnonzero(CONSTRAINED[model.closures[name].type]):
            stacked = np.vstack([rows, jacobian[i]])
            if _rank(stacked) > len(rows):
                rows, mask[i] = stacked, True
        constraints[name] = tuple(mask)
    return constraints, rows


def _rank(rows: Vector) -> int:
    scale = max(1.0, float(np.abs(rows).max(initial=0.0)))
    return int(np.linalg.matrix_rank(rows, tol=RANK_TOLERANCE * scale))
