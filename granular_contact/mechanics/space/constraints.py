"""What joints ask of accelerations in space, see `mechanics.constraints`.

Coordinates of a body: velocity of its centre of mass along the axes of the world, angular velocity along its own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from granular_contact.mechanics.constraints import Rows, together
from granular_contact.scene.space.types import SpatialJoint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.space.kinematics import SpatialKinematics


class SpatialConstraints:
    """Rows of joints in space, as `mechanics.constraints.Constraints`."""

    def __init__(self, motion: SpatialKinematics) -> None:
        self.motion = motion
        self.shape = motion.trajectory.v.shape
        self._places = {name: slice(6 * i, 6 * i + 6) for i, name in enumerate(motion.system.rigid)}

    def held(self, joint: SpatialJoint) -> Rows:
        """What a joint keeps at zero, in the axes of its frame on its parent."""
        axes = (self.motion.rotation(joint.parent) @ joint.parent_turn).transpose(0, 2, 1)
        displaced, turned = np.flatnonzero(joint.constrained[:3]), np.flatnonzero(joint.constrained[3:])
        return together([self._apart(joint).along(axes[:, displaced]), self._turned(joint).along(axes[:, turned])])

    def moved(self, joint: SpatialJoint) -> Rows:
        """The coordinate (rad or m) of a hinge or slider."""
        axis = (self.motion.rotation(joint.parent) @ joint.parent_turn)[:, None, :, 2]
        return (self._turned(joint) if joint.kind == "hinge" else self._apart(joint)).along(axis)

    def coordinates(self, joint: SpatialJoint) -> Rows:
        """The coordinate of a hinge or slider; of a ball joint the three of its turn, by small angles (rad).

        Between elements of a link that bends these are along the axes of its frame; the last is its stretch (m).
        """
        if joint.elastic is None:
            return self._turned(joint) if joint.kind == "ball" else self.moved(joint)
        axes = (self.motion.rotation(joint.parent) @ joint.parent_turn).transpose(0, 2, 1)
        turned = self._turned(joint).along(axes)
        return together([turned, self._apart(joint).along(axes[:, :1])]) if joint.elastic.axial else turned

    def _apart(self, joint: SpatialJoint) -> Rows:
        """Of the child's point in the frame of the parent: less the parent's own point that is there, and Coriolis'."""
        place, speed = self.motion.position(joint.child, joint.child_point)
        apart, spin = self._point(joint.child, place), self.motion.spin(joint.parent)
        if joint.parent is None:
            return apart
        center, velocity = self.motion.center(joint.parent)
        over = speed - velocity - np.cross(spin, place - center)
        return (apart - self._point(joint.parent, place)).plus(-2.0 * np.cross(spin, over))

    def _turned(self, joint: SpatialJoint) -> Rows:
        """Of the child's angular velocity in the frame of the parent."""
        spin, other = self.motion.spin(joint.parent), self.motion.spin(joint.child)
        turned = self._turn(joint.child) - self._turn(joint.parent)
        return turned.plus(-np.cross(spin, other - spin))

    def _none(self) -> Rows:
        n, m = self.shape
        return Rows(np.zeros((n, 3, m)), np.zeros((n, 3)))

    def _point(self, name: str, place: Vector) -> Rows:
        """Of a body's point that is at a place (n, 3) m in the world."""
        rows, at, R = self._none(), self._places[name], self.motion.rotation(name)
        arm, spin = place - self.motion.center(name)[0], self.motion.spin(name)
        rows.J[:, :, at.start : at.start + 3] = np.eye(3)
        # R w' x arm, column by column.
        rows.J[:, :, at.start + 3 : at.stop] = np.cross(R, arm[:, :, None], axis=1)
        rows.c[:] = np.cross(spin, np.cross(spin, arm))
        return rows

    def _turn(self, name: str | None) -> Rows:
        rows = self._none()
        if name is not None:
            at = self._places[name]
            rows.J[:, :, at.start + 3 : at.stop] = self.motion.rotation(name)
        return rows
