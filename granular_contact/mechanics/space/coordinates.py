"""Coordinates of hinges, sliders and ball joints in space, by the compiled functions of `kernels.space_joints`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from granular_contact.mechanics.coordinates import Coordinate, Reference
from granular_contact.mechanics.kernels import space_joints
from granular_contact.mechanics.kernels.joint_coordinates import HINGE, SLIDER
from granular_contact.mechanics.kernels.joint_loads import MOST
from granular_contact.scene.space.types import SpatialJoint

if TYPE_CHECKING:
    from granular_contact.mechanics.space.system import SpatialSystem

KINDS = {"hinge": HINGE, "slider": SLIDER, "ball": space_joints.BALL}
KINDS |= {"elastic": space_joints.ELASTIC, "stretching": space_joints.STRETCHING}


def coordinate(system: SpatialSystem, joint: SpatialJoint, reference: Reference | None = None) -> SpatialCoordinate:
    """Coordinate of a joint of a system, see `mechanics.coordinates.coordinate`."""
    nodes = system.nodes_of(joint)
    return SpatialCoordinate(joint, [x for node in nodes for x in (reference(node) if reference else [0.0] * 7)])


class SpatialCoordinate(Coordinate):
    """Coordinate of a joint in space; last_angles (2,): its last value, by which turns are counted, and a zero."""

    def __init__(self, joint: SpatialJoint, references: Sequence[float]) -> None:
        """references: values that the coordinates of parent and child are counted from; none for the ground."""
        self.joint, self.size = joint, len(references)  # type: ignore[assignment]
        self.record, self.last_angles = np.zeros(1, space_joints.JOINT), np.array([joint.start, 0.0])
        record = self.record[0]
        kind = KINDS[joint.kind]
        record["kind"], record["find"] = kind, space_joints.coordinate_address(kind)
        record["parent"], record["child"] = len(references) - 7, 7
        for name in ("parent_point", "parent_turn", "child_point", "child_turn"):
            record[name] = getattr(joint, name)
        record["reference"][: self.size] = references
        if joint.elastic is not None:
            record["bends"], record["damps"] = joint.elastic.stiffness, joint.elastic.damping
            record["axial"] = joint.elastic.axial or (0.0, 0.0)
        self._slope = np.zeros(MOST)
