"""Coordinates of hinges and sliders as functions of the coordinates of the nodes that they join.

    hinge   s = phi_P - phi_C + offset                  clockwise from parent to child
    slider  s = u . (r_C + arm_C - r_P) - u . arm_P     u: axis, turns with the parent

r: position of a node, phi: its angle, of a cable's node that of its slope; arm: from the node to the joint's point. A
torque or force tau along s is tau ds/dq on the nodes. Used with engine coordinates: without reference values.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from granular_contact.scene.types import Connection, Vector

Numbers = list[float]


@dataclass
class End:
    """One end of a joint: reference coordinates of its node (3 of a rigid body, 4 of a cable's, none of the ground).

    point (2,) m: of the joint, from the node, in its frame; last: angle (rad) found last, by which the turns of a slope
    are counted.
    """

    reference: Numbers
    point: Numbers
    last: float = 0.0
    size: int = field(init=False)

    def __post_init__(self) -> None:
        self.size = len(self.reference)

    def angle(self, q: Numbers, v: Numbers) -> tuple[float, float, Numbers]:
        """Angle (rad), its rate, and its gradient."""
        if self.size == 0:
            return 0.0, 0.0, []
        if self.size == 3:
            return self.reference[2] + q[2], v[2], [0.0, 0.0, 1.0]
        x, y = self.reference[2] + q[2], self.reference[3] + q[3]
        square = x * x + y * y
        phi = math.atan2(y, x)
        phi += 2.0 * math.pi * round((self.last - phi) / (2.0 * math.pi))
        self.last = phi
        return phi, (x * v[3] - y * v[2]) / square, [0.0, 0.0, -y / square, x / square]

    def place(self, q: Numbers) -> tuple[float, float]:
        """Position of the node (m)."""
        return (self.reference[0] + q[0], self.reference[1] + q[1]) if self.size else (0.0, 0.0)

    def bending(self, q: Numbers) -> Vector:
        """Second derivatives (size, size) of the angle."""
        second = np.zeros((self.size, self.size))
        if self.size == 4:
            x, y = self.reference[2] + q[2], self.reference[3] + q[3]
            square = (x * x + y * y) ** 2
            second[2, 2], second[3, 3] = 2.0 * x * y / square, -2.0 * x * y / square
            second[2, 3] = second[3, 2] = (y * y - x * x) / square
        return second


class Hinge:
    """Angle of a hinge."""

    def __init__(self, joint: Connection, parent: End, child: End) -> None:
        self.joint, self.parent, self.child = joint, parent, child

    def at(self, q: Numbers, v: Numbers) -> tuple[float, float, Numbers]:
        """Coordinate, its rate and gradient, by the coordinates of the parent's node and then the child's."""
        n = self.parent.size
        one, one_rate, one_slope = self.parent.angle(q[:n], v[:n])
        two, two_rate, two_slope = self.child.angle(q[n:], v[n:])
        return one - two + self.joint.offset, one_rate - two_rate, one_slope + [-g for g in two_slope]

    def second(self, q: Numbers) -> Vector:
        """Second derivatives of the coordinate."""
        n = self.parent.size
        total = np.zeros((n + self.child.size,) * 2)
        total[:n, :n] = self.parent.bending(q[:n])
        total[n:, n:] = -self.child.bending(q[n:])
        return total


class RigidHinge(Hinge):
    """Angle of a hinge of rigid bodies: a difference of two coordinates, asked for in every iteration of every step."""

    def __init__(self, joint: Connection, parent: End, child: End) -> None:
        super().__init__(joint, parent, child)
        self._start = joint.offset - child.reference[2] + (parent.reference[2] if parent.size else 0.0)
        self._slope: Numbers = [0.0, 0.0, 1.0, 0.0, 0.0, -1.0] if parent.size else [0.0, 0.0, -1.0]

    def at(self, q: Numbers, v: Numbers) -> tuple[float, float, Numbers]:
        """Coordinate, its rate and gradient, by the coordinates of the parent's node and then the child's."""
        if self.parent.size:
            return self._start + q[2] - q[5], v[2] - v[5], self._slope
        return self._start - q[2], -v[2], self._slope


class Slider:
    """Position along the axis of a slider, whose parent is rigid."""

    def __init__(self, joint: Connection, parent: End, child: End) -> None:
        assert joint.axis is not None
        self.joint, self.parent, self.child = joint, parent, child
        self.axis, self.seat = joint.axis, float(joint.axis @ joint.parent_point)

    def _vectors(self, q: Numbers) -> tuple[float, float, float, float, float, float]:
        """Axis u, vector D from the parent's node to the joint's point on the child, arm of the child (x, y each)."""
        n = self.parent.size
        angle, _, _ = self.parent.angle(q[:n], [0.0] * n)
        c, s = math.cos(angle), math.sin(angle)
        ux, uy = c * self.axis[0] - s * self.axis[1], s * self.axis[0] + c * self.axis[1]
        x, y = self.parent.place(q[:n])
        ax, ay = 0.0, 0.0
        if self.child.size == 3:
            turned, _, _ = self.child.angle(q[n:], [0.0] * self.child.size)
            c, s = math.cos(turned), math.sin(turned)
            ax = c * self.child.point[0] - s * self.child.point[1]
            ay = s * self.child.point[0] + c * self.child.point[1]
        cx, cy = self.child.place(q[n:])
        return ux, uy, cx + ax - x, cy + ay - y, ax, ay

    def at(self, q: Numbers, v: Numbers) -> tuple[float, float, Numbers]:
        """Coordinate, its rate and gradient, by the coordinates of the parent's node and then the child's."""
        ux, uy, dx, dy, ax, ay = self._vectors(q)
        slope: Numbers = [-ux, -uy, ux * dy - uy * dx] if self.parent.size else []
        slope += [ux, uy, uy * ax - ux * ay] if self.child.size == 3 else [ux, uy, 0.0, 0.0]
        rate = sum(g * w for g, w in zip(slope, v, strict=True))
        return ux * dx + uy * dy - self.seat, rate, slope

    def second(self, q: Numbers) -> Vector:
        """Second derivatives of the coordinate."""
        ux, uy, dx, dy, ax, ay = self._vectors(q)
        n = self.parent.size
        total = np.zeros((n + self.child.size,) * 2)
        rigid_child = self.child.size == 3
        if n:
            total[2, 2] = -(ux * dx + uy * dy)
            total[2, [0, 1]] = total[[0, 1], 2] = uy, -ux
            total[2, [n, n + 1]] = total[[n, n + 1], 2] = -uy, ux
        if rigid_child:
            total[n + 2, n + 2] = -(ux * ax + uy * ay)
            if n:
                total[2, n + 2] = total[n + 2, 2] = ux * ax + uy * ay
        return total


def coordinate(joint: Connection, parent: End, child: End) -> Hinge | Slider:
    """Coordinate of a joint that has one."""
    if joint.kind == "slider":
        return Slider(joint, parent, child)
    rigid = child.size == 3 and parent.size in (0, 3)
    return (RigidHinge if rigid else Hinge)(joint, parent, child)
