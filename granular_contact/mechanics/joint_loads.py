"""Forces along the coordinate of a joint: springs, dampers, stops, dry friction, and drives except prescribed motions.

One compiled call computes the forces of all joints (`kernels.joint_loads`); they reach the bodies with the forces of
the bed (`joint_actions`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.mechanics.coordinates import Coordinate
from granular_contact.mechanics.kernels import joint_laws, joint_loads
from granular_contact.scene.joint_law import JointLaw
from granular_contact.scene.types import Drive, Vector


def fill(record: NDArray[np.void], law: JointLaw, drive: Drive | None) -> None:
    """Write the numbers of a joint's law and drive into its record (1,)."""
    for name in joint_loads.LAW:
        record[name] = getattr(law, name)
    if drive is not None:
        control = joint_laws.RATE_CONTROL if drive.of_rate else joint_laws.CONTROL
        record["drive"] = joint_laws.LOAD if drive.kind == "load" else control
        for name in joint_loads.DRIVE:
            record[name] = getattr(drive, name)


def setpoint(drive: Drive, t: float) -> tuple[float, float]:
    """Target and target rate of a drive at a time (s); before t = 0 rates are 0, other values as at 0."""
    if t < 0.0:
        return (0.0, 0.0) if drive.of_rate else (drive.signal.value(0.0), 0.0)
    value = drive.signal.value(t)
    return value, value if drive.of_rate else drive.signal.rate(t) if drive.kind == "control" else 0.0


def held(drive: Drive, value: float) -> tuple[float, float]:
    """Target and target rate of a drive that is set to a value from outside."""
    return value, value if drive.of_rate else 0.0


class JointLoad:
    """Forces in one joint.

    nodes: of parent and child; the ground has none; sizes: their numbers of coordinates. state: record of
    `kernels.joint_loads.STATE`, later a view into the table of all joints. first_anchor: of its bristle at the start.
    """

    def __init__(self, coordinate: Coordinate, nodes: list[int], law: JointLaw, drive: Drive | None) -> None:
        self.nodes, self.law, self.drive = nodes, law, drive
        self.record, self.state = coordinate.record, np.zeros(1, joint_loads.STATE)[0]
        fill(self.record, law, drive)
        self.sizes = [int(self.record[end][0]) for end in ("parent", "child") if self.record[end][0]]
        self.first_anchor = self.state["anchor"] = coordinate.joint.start
        self.state["last_angles"] = coordinate.last_angles
        self.where = np.zeros(0, int)  # indices of its nodes' coordinates in the assembled system
        if drive is not None and drive.sets:
            self.set_to = drive.signal.value(0.0)

    @property
    def anchor(self) -> float:
        """Anchor of the bristle of dry friction."""
        return float(self.state["anchor"])

    @property
    def set_to(self) -> float:
        """Target of a drive that is set from outside."""
        return float(self.state["target"])

    @set_to.setter
    def set_to(self, value: float) -> None:
        assert self.drive is not None  # of a joint with such a drive
        self.want(held(self.drive, value))

    def setpoint(self, t: float) -> tuple[float, float]:
        """Target and target rate of its drive, see the function `setpoint`."""
        assert self.drive is not None  # of a joint with one
        return setpoint(self.drive, t)

    def want(self, values: tuple[float, float]) -> None:
        """Set the target and the target rate of the drive."""
        self.state["target"], self.state["target_rate"] = values

    def slope(self, q: Vector) -> Vector:
        """Gradient of the coordinate by the coordinates at `where`, in the system's state q."""
        q_joint, v_joint, gradient = np.zeros((3, joint_loads.MOST))
        q_joint[: len(self.where)] = q[self.where]
        joint_loads.single(self.record, np.zeros(2), q_joint, v_joint, gradient)
        used: Vector = gradient[: len(self.where)]
        return used
