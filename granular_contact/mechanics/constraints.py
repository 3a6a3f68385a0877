"""Constraints of joints on accelerations along a trajectory: J a + c = 0, with the Jacobian J of the constraints.

a (n, m): accelerations, the derivatives of the trajectory's rates; c (n, k): velocity terms.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from granular_contact.scene.layout import FREEDOMS
from granular_contact.scene.types import Joint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.kinematics import Kinematics


class Rows(NamedTuple):
    """Second derivatives J a + c of k quantities: J (n, k, m), c (n, k)."""

    J: Vector
    c: Vector

    def __sub__(self, other: Rows) -> Rows:
        return Rows(self.J - other.J, self.c - other.c)

    def along(self, directions: Vector) -> Rows:
        """Rows of the components of a vector along directions (n, l, k)."""
        return Rows(directions @ self.J, np.einsum("nlk,nk->nl", directions, self.c))

    def plus(self, c: Vector) -> Rows:
        """Rows with additional velocity terms (n, k)."""
        return Rows(self.J, self.c + c)


def together(rows: list[Rows]) -> Rows:
    """Rows of several quantities in one."""
    return Rows(np.concatenate([part.J for part in rows], axis=1), np.concatenate([part.c for part in rows], axis=1))


class Constraints:
    """Constraint rows of joints in the plane."""

    def __init__(self, motion: Kinematics) -> None:
        self.motion = motion
        self.shape = motion.trajectory.v.shape

    def held(self, joint: Joint) -> Rows:
        """Rows of the quantities that a joint keeps at zero."""
        if joint.kind == "free":
            return self._none(0)
        displacements, turns = FREEDOMS[joint.kind]
        rows = self._across(joint) if displacements else self._apart(joint)
        return rows if turns else together([rows, self._turned(joint)])

    def moved(self, joint: Joint) -> Rows:
        """Row of the coordinate of a hinge (rad, clockwise) or slider (m)."""
        if joint.kind == "hinge":
            turned = self._turned(joint)
            return Rows(-turned.J, -turned.c)
        s, spin = self.motion.coordinate(joint)[0], self._spin(joint)
        return self._apart(joint).along(self._axes(joint)[:, :1]).plus((spin**2 * s)[:, None])

    def _across(self, joint: Joint) -> Rows:
        """Row of the offset of a slider's points normal to its axis."""
        across = self._apart(joint).along(self._axes(joint)[:, 1:])
        s, rate = self.motion.coordinate(joint)
        turn, spin = self._turn(joint.parent, joint.parent_point), self._spin(joint)
        # n . (d'' - 2 w x s' e) - w' s, for the offset d along the axis e with the normal n in a rotating frame.
        return Rows(across.J - s[:, None, None] * turn.J, across.c - (2.0 * spin * rate)[:, None])

    def _none(self, count: int) -> Rows:
        """Rows of zeros for `count` quantities."""
        n, m = self.shape
        return Rows(np.zeros((n, count, m)), np.zeros((n, count)))

    def _apart(self, joint: Joint) -> Rows:
        """Rows of the offset of the child's point from the parent's."""
        return self._point(joint.child, joint.child_point) - self._point(joint.parent, joint.parent_point)

    def _turned(self, joint: Joint) -> Rows:
        """Row of the angle of the child less that of the parent."""
        return self._turn(joint.child, joint.child_point) - self._turn(joint.parent, joint.parent_point)

    def _spin(self, joint: Joint) -> Vector:
        """Angular velocity (n,) rad/s of the parent."""
        return self.motion.angle(joint.parent, joint.parent_point)[1]

    def _axes(self, joint: Joint) -> Vector:
        """Axis of a slider and its normal, (n, 2, 2)."""
        assert joint.axis is not None
        angle = self.motion.angle(joint.parent, joint.parent_point)[0] + np.arctan2(joint.axis[1], joint.axis[0])
        c, s = np.cos(angle), np.sin(angle)
        return np.stack([np.column_stack([c, s]), np.column_stack([-s, c])], axis=1)

    def _point(self, name: str | None, point: Vector) -> Rows:
        """Rows of the position of a point of a body, or of the ground."""
        rows = self._none(2)
        if name is None:
            return rows
        places = self.motion.system.places(name, point)
        rows.J[:, [0, 1], places[:2]] = 1.0
        if len(places) == 3:
            arm = self.motion.position(name, point)[0] - self.motion.trajectory.q[:, places[:2]]
            spin = self.motion.trajectory.v[:, places[2]]
            rows.J[:, 0, places[2]], rows.J[:, 1, places[2]] = -arm[:, 1], arm[:, 0]
            rows.c[:] = -(spin**2)[:, None] * arm
        return rows

    def _turn(self, name: str | None, point: Vector) -> Rows:
        """Row of the angle of a body, counter-clockwise; for a flexible link of the slope at the nearer end."""
        rows = self._none(1)
        if name is None:
            return rows
        places = self.motion.system.places(name, point)
        if len(places) == 3:
            rows.J[:, 0, places[2]] = 1.0
            return rows
        (x, y), (u, w) = (table[:, places[2:]].T for table in (self.motion.trajectory.q, self.motion.trajectory.v))
        square = x**2 + y**2
        rows.J[:, 0, places[2]], rows.J[:, 0, places[3]] = -y / square, x / square
        rows.c[:, 0] = -2.0 * (x * w - y * u) * (x * u + y * w) / square**2
        return rows
