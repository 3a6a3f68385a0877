"""Forces along the coordinate of a joint: stops, dry friction and drives, as a solve and its history need them."""

from __future__ import annotations

import math
from typing import NamedTuple

from granular_contact.scene.types import Drive, JointLaw


class Force(NamedTuple):
    """Torque or force along a coordinate (N m or N), and its derivatives by the coordinate and by its rate."""

    value: float
    by_place: float = 0.0
    by_rate: float = 0.0


def stop(law: JointLaw, s: float, rate: float) -> tuple[float, Force]:
    """Elastic part of the force of the stops, and the whole of it; it pushes only."""
    depth = s - law.upper if s > law.upper else s - law.lower if s < law.lower else 0.0
    if depth == 0.0:
        return 0.0, Force(0.0)
    elastic = -law.stop_stiffness * depth
    # Hunt and Crossley: the faster it gets deeper, the harder; what would pull back is left out.
    growing = rate if depth > 0.0 else -rate
    factor = 1.0 + law.dissipation * growing
    if factor <= 0.0:
        return elastic, Force(0.0)
    by_rate = elastic * law.dissipation * (1.0 if depth > 0.0 else -1.0)
    return elastic, Force(elastic * factor, -law.stop_stiffness * factor, by_rate)


def friction(law: JointLaw, s: float, rate: float, anchor: float) -> Force:
    """Dry friction of a bristle that is held at its anchor."""
    strain = (s - anchor + law.damping_time * rate) / law.slip
    if abs(strain) >= 1.0:
        return Force(-math.copysign(law.friction, strain))
    slope = -law.friction / law.slip
    return Force(law.friction * -strain, slope, slope * law.damping_time)


def follow(law: JointLaw, s: float, anchor: float) -> float:
    """Anchor of the bristle after a step that ended at s."""
    return min(max(anchor, s - law.slip), s + law.slip)


def wanted(drive: Drive, t: float) -> tuple[float, float]:
    """Signal of a drive at a time, and the rate that it wants; before t = 0 its clock stands, and it wants none."""
    if t < 0.0:
        return (0.0, 0.0) if drive.of_rate else (drive.signal.value(0.0), 0.0)
    value = drive.signal.value(t)
    return value, value if drive.of_rate else drive.signal.rate(t) if drive.kind == "control" else 0.0


def drive_force(drive: Drive, value: float, value_rate: float, s: float, rate: float) -> Force:
    """Torque or force of a drive, from what it wants."""
    if drive.kind == "load":
        return Force(value)
    force = drive.rate_gain * (value_rate - rate)
    by_place = 0.0
    if not drive.of_rate:
        force += drive.gain * (value - s)
        by_place = -drive.gain
    if force >= drive.limit or force <= -drive.limit:
        return Force(math.copysign(drive.limit, force))
    return Force(force, by_place, -drive.rate_gain)


def held(drive: Drive, value: float) -> tuple[float, float]:
    """What a drive that is set from outside wants while it is set to a value, and the rate that it wants."""
    return value, value if drive.of_rate else 0.0


def sum_of(one: Force, other: Force) -> Force:
    """Two forces at once."""
    return Force(one[0] + other[0], one[1] + other[1], one[2] + other[2])
