"""Coordinates of hinges and sliders for Python, by the compiled functions of `kernels.joint_coordinates`."""

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
    """One end of a joint.

    reference: values that the coordinates of its node are counted from: 3 for a rigid body, 4 for the node of a cable,
    none for the ground. point (2,) m: the joint's point from the node, in the node's frame; on the ground from the
    origin of the coordinates. angle (rad): of the body at the start, from which whole turns of a slope are counted.
    """

    reference: Numbers
    point: Numbers
    angle: float = 0.0


def coordinate(system: System, joint: Joint, origin: Vector, reference: Reference | None = None) -> Coordinate:
    """Coordinate of a joint of a system; origin (2,) m: of the system's coordinates, world frame.

    reference: values by node that its coordinates are counted from; None where coordinates include them.
    """

    def end(body: str | None, point: Vector) -> End:
        if body is None:
            return End([], (point - origin).tolist())
        arm, size = (point.tolist(), 3) if body in system.rigid else ([0.0, 0.0], 4)
        values = [0.0] * size if reference is None else reference(system.node_at(body, point))
        return End(values, arm, system.scene.body(body).motion.angle)

    return Coordinate(joint, end(joint.parent, joint.parent_point), end(joint.child, joint.child_point))


class Coordinate:
    """Coordinate of a hinge or slider; a slider's parent is rigid, or the ground.

    record (1,): of `JOINT`; last_angles (2,) rad: of the ends at the last evaluation.
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
        """Coordinate, its rate and its gradient; q, v: coordinates and rates of the parent's and the child's node."""
        s, rate = self.now(q, v)
        return s, rate, self._slope[: self.size].tolist()

    def now(self, q: Numbers, v: Numbers, slope: Vector | None = None) -> tuple[float, float]:
        """Coordinate and its rate, as `at`; slope (MOST,): array for the gradient."""
        arguments = self.record, self.last_angles, np.array(q), np.array(v), self._slope if slope is None else slope
        if self._at is None:
            self._at = ready(single, *arguments)
        return self._at(*arguments)
