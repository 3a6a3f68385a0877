"""What acts in a joint by its coordinate: springs, dampers, stops, dry friction, and drives but for motions.

That of all joints is computed in one compiled call, `kernels.joint_loads`, and reaches the bodies with the bed's
forces, see `joint_actions`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.mechanics.coordinates import Coordinate
from granular_contact.mechanics.kernels import joint_laws, joint_loads
from granular_contact.scene.joint_law import JointLaw
from granular_contact.scene.types import Drive, Vector


def fill(record: NDArray[np.void], law: JointLaw, drive: Drive | None) -> None:
    """Write what acts in a joint into its record (1,)."""
    for name in joint_loads.LAW:
        record[name] = getattr(law, name)
    if drive is not None:
        control = joint_laws.RATE_CONTROL if drive.of_rate else joint_laws.CONTROL
        record["drive"] = joint_laws.LOAD if drive.kind == "load" else control
        for name in joint_loads.DRIVE:
            record[name] = getattr(drive, name)


def setpoint(drive: Drive, t: float) -> tuple[float, float]:
    """Signal of a drive at a time, and the rate that it wants; before t = 0 its clock stands, and it wants none."""
    if t < 0.0:
        return (0.0, 0.0) if drive.of_rate else (drive.signal.value(0.0), 0.0)
    value = drive.signal.value(t)
    return value, value if drive.of_rate else drive.signal.rate(t) if drive.kind == "control" else 0.0


def held(drive: Drive, value: float) -> tuple[float, float]:
    """What a drive that is set from outside wants while it is set to a value, and the rate that it wants."""
    return value, value if drive.of_rate else 0.0


class JointLoad:
    """What acts in one joint; `nodes` are those of parent and child, without the ground's, `sizes` their coordinates.

    state: record of `kernels.joint_loads.STATE`, among those of all joints once there are such. first_anchor: of its
    bristle, at the start.
    """

    def __init__(self, coordinate: Coordinate, nodes: list[int], law: JointLaw, drive: Drive | None) -> None:
        self.nodes, self.law, self.drive = nodes, law, drive
        self.record, self.state = coordinate.record, np.zeros(1, joint_loads.STATE)[0]
        fill(self.record, law, drive)
        self.sizes = [int(self.record[end][0]) for end in ("parent", "child") if self.record[end][0]]
        self.first_anchor = self.state["anchor"] = coordinate.joint.start
        self.state["last_angles"] = coordinate.last_angles
        self.where = np.zeros(0, int)  # places of its nodes' coordinates in the assembled system
        if drive is not None and drive.sets:
            self.set_to = drive.signal.value(0.0)

    @property
    def anchor(self) -> float:
        """Where the bristle of dry friction is held."""
        return float(self.state["anchor"])

    @property
    def set_to(self) -> float:
        """What a drive that is set from outside is set to."""
        return float(self.state["target"])

    @set_to.setter
    def set_to(self, value: float) -> None:
        assert self.drive is not None  # of a joint with such a drive
        self.want(held(self.drive, value))

    def setpoint(self, t: float) -> tuple[float, float]:
        """As of its drive, see `setpoint`."""
        assert self.drive is not None  # of a joint with one
        return setpoint(self.drive, t)

    def want(self, values: tuple[float, float]) -> None:
        """Let the drive want a value and a rate."""
        self.state["target"], self.state["target_rate"] = values

    def slope(self, q: Vector) -> Vector:
        """Gradient of the coordinate by those at `where`, in the system's state q."""
        place, still, slope = np.zeros((3, joint_loads.MOST))
        place[: len(self.where)] = q[self.where]
        joint_loads.single(self.record, np.zeros(2), place, still, slope)
        gradient: Vector = slope[: len(self.where)]
        return gradient
