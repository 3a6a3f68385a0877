"""What joints ask of accelerations, along a trajectory: rows J and numbers c with J a + c = 0 for what they hold.

a (n, m): accelerations in the coordinates of the rates of a trajectory; c (n, k) is what velocities alone do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from granular_contact.scene.layout import FREEDOMS
from granular_contact.scene.types import Joint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.kinematics import Kinematics


class Rows(NamedTuple):
    """Accelerations J a + c of k quantities: J (n, k, m), c (n, k)."""

    J: Vector
    c: Vector

    def __sub__(self, other: Rows) -> Rows:
        return Rows(self.J - other.J, self.c - other.c)

    def along(self, directions: Vector) -> Rows:
        """Of a vector's rows its components along directions (n, l, k)."""
        return Rows(directions @ self.J, np.einsum("nlk,nk->nl", directions, self.c))

    def plus(self, c: Vector) -> Rows:
        """With more (n, k) that velocities do."""
        return Rows(self.J, self.c + c)


def together(rows: list[Rows]) -> Rows:
    """Several quantities as one."""
    return Rows(np.concatenate([one.J for one in rows], axis=1), np.concatenate([one.c for one in rows], axis=1))


class Constraints:
    """Rows of joints in the plane."""

    def __init__(self, motion: Kinematics) -> None:
        self.motion = motion
        self.shape = motion.trajectory.v.shape

    def held(self, joint: Joint) -> Rows:
        """What a joint keeps at zero."""
        if joint.kind == "free":
            return self._none(0)
        displacements, turns = FREEDOMS[joint.kind]
        rows = self._across(joint) if displacements else self._apart(joint)
        return rows if turns else together([rows, self._turned(joint)])

    def moved(self, joint: Joint) -> Rows:
        """The coordinate (rad clockwise, or m) of a hinge or slider."""
        if joint.kind == "hinge":
            turned = self._turned(joint)
            return Rows(-turned.J, -turned.c)
        s, spin = self.motion.coordinate(joint)[0], self._spin(joint)
        return self._apart(joint).along(self._axes(joint)[:, :1]).plus((spin**2 * s)[:, None])

    def _across(self, joint: Joint) -> Rows:
        """Of the offset of a slider's points across its axis."""
        across = self._apart(joint).along(self._axes(joint)[:, 1:])
        s, rate = self.motion.coordinate(joint)
        turn, spin = self._turn(joint.parent, joint.parent_point), self._spin(joint)
        # n (d'' - 2 w x s' e) - w' s, of the offset d along the axis e with the normal n in a frame that turns.
        return Rows(across.J - s[:, None, None] * turn.J, across.c - (2.0 * spin * rate)[:, None])

    def _none(self, count: int) -> Rows:
        n, m = self.shape
        return Rows(np.zeros((n, count, m)), np.zeros((n, count)))

    def _apart(self, joint: Joint) -> Rows:
        return self._point(joint.child, joint.child_point) - self._point(joint.parent, joint.parent_point)

    def _turned(self, joint: Joint) -> Rows:
        return self._turn(joint.child, joint.child_point) - self._turn(joint.parent, joint.parent_point)

    def _spin(self, joint: Joint) -> Vector:
        return self.motion.angle(joint.parent, joint.parent_point)[1]

    def _axes(self, joint: Joint) -> Vector:
        """Direction of a slider, and across it, (n, 2, 2)."""
        assert joint.axis is not None
        angle = self.motion.angle(joint.parent, joint.parent_point)[0] + np.arctan2(joint.axis[1], joint.axis[0])
        c, s = np.cos(angle), np.sin(angle)
        return np.stack([np.column_stack([c, s]), np.column_stack([-s, c])], axis=1)

    def _point(self, name: str | None, point: Vector) -> Rows:
        """Of a point of a body, or of the ground."""
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
        """Of the angle of a body, counter-clockwise; of a link at one of its ends, that of its slope."""
        rows = self._none(1)
        if name is None:
            return rows
        places = self.motion.system.places(name, point)
        if len(places) == 3:
            rows.J[:, 0, places[2]] = 1.0
            return rows
        (x, y), (u, w) = (of[:, places[2:]].T for of in (self.motion.trajectory.q, self.motion.trajectory.v))
        square = x**2 + y**2
        rows.J[:, 0, places[2]], rows.J[:, 0, places[3]] = -y / square, x / square
        rows.c[:, 0] = -2.0 * (x * w - y * u) * (x * u + y * w) / square**2
        return rows
