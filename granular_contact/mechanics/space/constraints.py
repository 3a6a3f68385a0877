"""Constraints of joints on accelerations in space, see `mechanics.constraints`.

Rates of a body: velocity of its centre of mass in the world frame, angular velocity in the body frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from granular_contact.mechanics.constraints import Rows, together
from granular_contact.scene.space.types import SpatialJoint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.space.kinematics import SpatialKinematics


class SpatialConstraints:
    """Constraint rows of joints in space, as `mechanics.constraints.Constraints` in the plane."""

    def __init__(self, motion: SpatialKinematics) -> None:
        self.motion = motion
        self.shape = motion.trajectory.v.shape
        self._places = {name: slice(6 * i, 6 * i + 6) for i, name in enumerate(motion.system.rigid)}

    def held(self, joint: SpatialJoint) -> Rows:
        """Rows of the quantities that a joint keeps at zero, along the axes of its frame on the parent."""
        axes = (self.motion.rotation(joint.parent) @ joint.parent_turn).transpose(0, 2, 1)
        displaced, turned = np.flatnonzero(joint.constrained[:3]), np.flatnonzero(joint.constrained[3:])
        return together([self._apart(joint).along(axes[:, displaced]), self._turned(joint).along(axes[:, turned])])

    def moved(self, joint: SpatialJoint) -> Rows:
        """Row of the coordinate of a hinge (rad) or slider (m)."""
        axis = (self.motion.rotation(joint.parent) @ joint.parent_turn)[:, None, :, 2]
        return (self._turned(joint) if joint.kind == "hinge" else self._apart(joint)).along(axis)

    def coordinates(self, joint: SpatialJoint) -> Rows:
        """Row of the coordinate of a hinge or slider; three rows of small relative rotations (rad) of a ball joint.

        Between elements of a flexible link the rotations are along the axes of the joint's frame; a fourth row is the
        elongation (m) of a link that stretches.
        """
        if joint.elastic is None:
            return self._turned(joint) if joint.kind == "ball" else self.moved(joint)
        axes = (self.motion.rotation(joint.parent) @ joint.parent_turn).transpose(0, 2, 1)
        turned = self._turned(joint).along(axes)
        return together([turned, self._apart(joint).along(axes[:, :1])]) if joint.elastic.axial else turned

    def _apart(self, joint: SpatialJoint) -> Rows:
        """Rows of the position of the child's point relative to the parent.

        They are the acceleration of the child's point, less that of the parent's point at the same place, and less the
        Coriolis acceleration.
        """
        place, velocity = self.motion.position(joint.child, joint.child_point)
        on_child, spin = self._point(joint.child, place), self.motion.spin(joint.parent)
        if joint.parent is None:
            return on_child
        center, center_velocity = self.motion.center(joint.parent)
        relative = velocity - center_velocity - np.cross(spin, place - center)
        return (on_child - self._point(joint.parent, place)).plus(-2.0 * np.cross(spin, relative))

    def _turned(self, joint: SpatialJoint) -> Rows:
        """Rows of the child's orientation relative to the parent: relative angular acceleration."""
        spin, child_spin = self.motion.spin(joint.parent), self.motion.spin(joint.child)
        turned = self._turn(joint.child) - self._turn(joint.parent)
        return turned.plus(-np.cross(spin, child_spin - spin))

    def _none(self) -> Rows:
        """Three rows of zeros."""
        n, m = self.shape
        return Rows(np.zeros((n, 3, m)), np.zeros((n, 3)))

    def _point(self, name: str, place: Vector) -> Rows:
        """Rows of the position of a body's point that is at a place (n, 3) m, world frame."""
        rows, columns, R = self._none(), self._places[name], self.motion.rotation(name)
        arm, spin = place - self.motion.center(name)[0], self.motion.spin(name)
        rows.J[:, :, columns.start : columns.start + 3] = np.eye(3)
        # R w' x arm, column by column.
        rows.J[:, :, columns.start + 3 : columns.stop] = np.cross(R, arm[:, :, None], axis=1)
        rows.c[:] = np.cross(spin, np.cross(spin, arm))
        return rows

    def _turn(self, name: str | None) -> Rows:
        """Rows of the orientation of a body, or of the ground: angular acceleration in the world frame."""
        rows = self._none()
        if name is not None:
            columns = self._places[name]
            rows.J[:, :, columns.start + 3 : columns.stop] = self.motion.rotation(name)
        return rows
