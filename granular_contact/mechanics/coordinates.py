"""Coordinates of hinges and sliders for Python, by the compiled functions of `kernels.joint_coordinates`.

Used with engine coordinates: without reference values.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from granular_contact.jit.compiled import ready
from granular_contact.mechanics.kernels.joint_coordinates import SLIDER
from granular_contact.mechanics.kernels.joint_loads import JOINT, MOST, single
from granular_contact.scene.types import Joint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.system import System

Numbers = list[float]
Reference = Callable[[int], Numbers]  # of a node, by its number


@dataclass(frozen=True)
class End:
    """One end of a joint: reference coordinates of its node (3 of a rigid body, 4 of a cable's, none of the ground).

    point (2,) m: of the joint, from the node, in its frame; on the ground from the origin of the coordinates. angle
    (rad): at the start, from which the turns of a slope are counted.
    """

    reference: Numbers
    point: Numbers
    angle: float = 0.0


def coordinate(system: System, joint: Joint, origin: Vector, reference: Reference | None = None) -> Coordinate:
    """Coordinate of a joint of a system, whose ground has its origin at a place (2,) m of the world frame.

    reference: values of a node that its coordinates are counted from; None where they are whole.
    """

    def end(body: str | None, point: Vector) -> End:
        if body is None:
            return End([], (point - origin).tolist())
        at, size = (point.tolist(), 3) if body in system.rigid else ([0.0, 0.0], 4)
        of_node = [0.0] * size if reference is None else reference(system.node_at(body, point))
        return End(of_node, at, system.scene.body(body).motion.angle)

    return Coordinate(joint, end(joint.parent, joint.parent_point), end(joint.child, joint.child_point))


class Coordinate:
    """Coordinate of a hinge or slider; a slider's parent is rigid, or the ground.

    record (1,): its `JOINT`; last_angles (2,) rad: of the ends, found last.
    """

    _at: Callable[..., tuple[float, float]] | None = None

    def __init__(self, joint: Joint, parent: End, child: End) -> None:
        sizes = len(parent.reference), len(child.reference)
        self.joint, self.size = joint, sum(sizes)
        self.record, self.last_angles = np.zeros(1, JOINT), np.array([parent.angle, child.angle])
        record = self.record[0]
        record["parent"], record["child"], record["offset"] = *sizes, joint.offset
        record["parent_reference"][: sizes[0]] = parent.reference
        record["child_reference"][: sizes[1]] = child.reference
        if joint.kind == "slider":
            assert joint.axis is not None
            record["kind"], record["axis"] = SLIDER, joint.axis
            record["seat"], record["arm"] = joint.axis @ parent.point, child.point
        self._slope = np.zeros(MOST)

    def at(self, q: Numbers, v: Numbers) -> tuple[float, float, Numbers]:
        """Coordinate, its rate and gradient, by the coordinates of the parent's node and then the child's."""
        s, rate = self.now(q, v)
        return s, rate, self._slope[: self.size].tolist()

    def now(self, q: Numbers, v: Numbers, slope: Vector | None = None) -> tuple[float, float]:
        """Coordinate and its rate, as `at`; slope, of at least as many numbers as kernels fill, gets the gradient."""
        arguments = self.record, self.last_angles, np.array(q), np.array(v), self._slope if slope is None else slope
        if self._at is None:
            self._at = ready(single, *arguments)
        return self._at(*arguments)
