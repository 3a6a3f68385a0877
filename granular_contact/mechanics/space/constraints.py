"""Constraints of joints on accelerations in space, see `mechanics.constraints`.

Rates of a body: velocity of its centre of mass in the world frame, angular velocity in the body frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from granular_contact.geometry.rotations import vector_products
from granular_contact.mechanics.constraints import Rows, together
from granular_contact.scene.space.types import SpatialJoint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.space.kinematics import SpatialKinematics


class SpatialConstraints:
    """Constraint rows of joints in space, as `mechanics.constraints.Constraints` in the plane."""

    def __init__(self, motion: SpatialKinematics) -> None:
        self.motion = motion
        self._first = {name: 6 * i for i, name in enumerate(motion.system.rigid)}  # column of the rates of a body

    def held(self, joint: SpatialJoint) -> Rows:
        """Rows of the quantities that a joint keeps at zero, along the axes of its frame on the parent."""
        axes = self._axes(joint)
        displaced, turned = np.flatnonzero(joint.constrained[:3]), np.flatnonzero(joint.constrained[3:])
        return together([self._apart(joint, axes[:, displaced]), self._turned(joint, axes[:, turned])])

    def moved(self, joint: SpatialJoint) -> Rows:
        """Row of the coordinate of a hinge (rad) or slider (m)."""
        return (self._turned if joint.kind == "hinge" else self._apart)(joint, self._axes(joint)[:, 2:])

    def coordinates(self, joint: SpatialJoint) -> Rows:
        """Row of the coordinate of a hinge or slider; of a ball joint three rows of small relative rotations (rad).

        The rotations are along the axes of the joint's frame. Between elements of a flexible link that stretches, a
        fourth row is the elongation (m).
        """
        if joint.elastic is None and joint.kind != "ball":
            return self.moved(joint)
        axes = self._axes(joint)
        turned = self._turned(joint, axes)
        if joint.elastic is None or not joint.elastic.axial:
            return turned
        return together([turned, self._apart(joint, axes[:, :1])])

    def _axes(self, joint: SpatialJoint) -> Vector:
        """Axes (n, 3, 3) of a joint's frame on the parent, as rows."""
        return (self.motion.rotation(joint.parent) @ joint.parent_turn).transpose(0, 2, 1)

    def _apart(self, joint: SpatialJoint, along: Vector) -> Rows:
        """Rows of the position of the child's point relative to the parent, along directions (n, l, 3).

        They are the acceleration of the child's point, less that of the parent's point at the same place, and less the
        Coriolis acceleration.
        """
        J, place = self._none(along), self.motion.position(joint.child, joint.child_point)[0]
        acceleration, velocity = np.zeros((2, *place.shape))
        for name, sign in ((joint.child, 1.0), (joint.parent, -1.0)):
            if name is None:
                continue
            first, (center, speed), spin = self._first[name], self.motion.center(name), self.motion.spin(name)
            arm = place - center
            turning = vector_products(spin, arm)
            J[:, :, first : first + 3] = sign * along
            # d . (R w' x arm) = (arm x d) . R w'
            J[:, :, first + 3 : first + 6] = sign * vector_products(arm[:, None], along) @ self.motion.rotation(name)
            velocity += sign * (speed + turning)
            acceleration += sign * vector_products(spin, turning)
        coriolis = 2.0 * vector_products(self.motion.spin(joint.parent), velocity)
        return Rows(J, (along @ (acceleration - coriolis)[:, :, None])[:, :, 0])

    def _turned(self, joint: SpatialJoint, along: Vector) -> Rows:
        """Rows of the child's orientation relative to the parent, along directions (n, l, 3).

        They are the relative angular acceleration in the rotating frame of the parent.
        """
        J = self._none(along)
        for name, sign in ((joint.child, 1.0), (joint.parent, -1.0)):
            if name is not None:
                first = self._first[name] + 3
                J[:, :, first : first + 3] = sign * along @ self.motion.rotation(name)
        coriolis = vector_products(self.motion.spin(joint.parent), self.motion.spin(joint.child))
        return Rows(J, -(along @ coriolis[:, :, None])[:, :, 0])

    def _none(self, along: Vector) -> Vector:
        """Zeros (n, l, m), for the Jacobian of rows along directions (n, l, 3)."""
        return np.zeros((*along.shape[:2], self.motion.trajectory.v.shape[1]))
