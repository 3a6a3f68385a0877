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
from granular_contact.geometry import rotations
from granular_contact.scene.loops import RANK_TOLERANCE, Loops
from granular_contact.scene.space.layout import BENDING, CONSTRAINED, FREEDOMS, JointState, Pose, axis_of, pose, turns
from granular_contact.scene.space.shapes import orientation
from granular_contact.scene.space.types import Vector
from granular_contact.scene.types import Drive


class SpatialLoops(Loops):
    """The loops of a model in space."""

    def __init__(self, model: schema.SpatialModel, *, bending: bool = False) -> None:
        """bending: whether links that bend do, and stretch; to close loops they do not."""
        super().__init__(model, FREEDOMS | BENDING if bending else FREEDOMS)

    def pose(self, states: Mapping[str, JointState]) -> Pose:
        """Pose of the mechanism."""
        return pose(self.model, states)

    def gaps(self, name: str, placed: Pose) -> Vector:
        """Residual (6,) of a closure along and about the axes of its frame: m, rad; what it leaves free is zero."""
        joint = self.model.closures[name]
        frame, at_child = joint_frame(joint, placed)
        at_parent = placed[joint.parent].world(np.array(joint.parent_point_m))
        turn = frame.T @ placed[joint.child].rotation @ rotations.to_axis(axis_of(joint))
        gap = np.concatenate([frame.T @ (at_child - at_parent), _misaligned(joint, turn)])
        return np.where(CONSTRAINED[joint.type], gap, 0.0)

    def gap_rates(self, name: str, placed: Pose) -> Vector:
        """Rates (6,) of a closed loop's residual."""
        joint = self.model.closures[name]
        frame, at_child = joint_frame(joint, placed)
        parent, child = placed[joint.parent], placed[joint.child]
        apart, spin = child.speed_at(at_child) - parent.speed_at(at_child), child.rate - parent.rate
        return np.where(CONSTRAINED[joint.type], np.concatenate([frame.T @ apart, frame.T @ spin]), 0.0)

    def apart(self, name: str, gap: Vector) -> tuple[float, float]:  # noqa: ARG002
        """Distance (m) and angle (rad) in the residual of a closure."""
        return float(np.linalg.norm(gap[:3])), float(np.linalg.norm(gap[3:]))


def joint_frame(joint: AnyJoint | AnyClosure, placed: Pose) -> tuple[Vector, Vector]:
    """Axes (3, 3) of a joint's frame on its parent, in the world, and the joint's point (3,) m on its child."""
    turn = placed[joint.parent].rotation @ orientation(joint)
    if getattr(joint, "elastic", None) is None:  # else it is that of the link
        turn = turn @ rotations.to_axis(axis_of(joint))
    return turn, placed[joint.child].world(np.array(joint.child_point_m))


def _misaligned(joint: AnyClosure, turn: Vector) -> Vector:
    """Rotation vector (3,) rad by which a closure's frames differ, apart from a turn about its axis that is free."""
    if not turns(joint):
        return rotations.vector_of(turn)
    z = turn[:, 2]
    sine = np.array([-z[1], z[0], 0.0])
    size = float(np.hypot(z[0], z[1]))
    return sine * (math.atan2(size, float(z[2])) / size) if size > 0.0 else sine


def needed(
    model: schema.SpatialModel, states: Mapping[str, JointState], drives: tuple[Drive, ...], faults: list[Fault]
) -> dict[str, tuple[bool, ...]]:
    """Of each closure which of its six constraints the joints before it do not hold already.

    A fault is appended for a closure of which none is left, for one that would hold the length of a straight link that
    can't change, and for a prescribed motion that the loops do not allow.
    """
    if not model.closures:
        return {}
    loops = SpatialLoops(model, bending=True)
    links = {name: joint for name, joint in loops.joints.items() if joint.type in BENDING}
    straight = {name: JointState(np.zeros(4)) for name in links}
    slopes, moves = loops.jacobian({**states, **straight}), np.ones(loops.size, bool)
    freer = _kept(model, slopes)[0]
    moves[[loops.places[name].start for name, joint in links.items() if joint.type == "elastic"]] = False
    found, held = _kept(model, {name: slope[:, moves] for name, slope in slopes.items()})
    for name, keep in found.items():
        if keep != freer[name]:
            words = "holds a straight link by both of its ends, which keeps its length: give axial_stiffness_N of links"
            faults.append(scene_fault(f"model.closures.{name}", f"{name} {words}"))
        elif not any(keep):
            words = f"all that {name} holds is held by the other joints: leave it out"
            faults.append(scene_fault(f"model.closures.{name}", words))
    rank = len(held)
    for drive in drives:
        if drive.kind == "motion" and drive.joint in loops.places:
            tried = np.vstack([held, np.eye(loops.size)[loops.places[drive.joint]][:, moves]])
            if _rank(tried) == rank:
                words = f"the motion of {drive.joint} is redundant with the other joints: leave it out"
                faults.append(scene_fault(f"drives.{drive.joint}", words))
            held, rank = tried, _rank(tried)
    return found


def _kept(model: schema.SpatialModel, slopes: Mapping[str, Vector]) -> tuple[dict[str, tuple[bool, ...]], Vector]:
    """Of each closure which constraints are not held by those before it, and these rows of the Jacobian."""
    found, held = {}, np.zeros((0, next(iter(slopes.values())).shape[1]))
    for name, slope in slopes.items():
        keep = [False] * 6
        for row in np.flatnonzero(CONSTRAINED[model.closures[name].type]):
            tried = np.vstack([held, slope[row]])
            if _rank(tried) > len(held):
                held, keep[row] = tried, True
        found[name] = tuple(keep)
    return found, held


def _rank(rows: Vector) -> int:
    scale = max(1.0, float(np.abs(rows).max(initial=0.0)))
    return int(np.linalg.matrix_rank(rows, tol=RANK_TOLERANCE * scale))
