"""A run of one wheel, as its start needs it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class WheelTest:
    """A run of one wheel under a load (N), its axle at a speed (m/s, to the right).

    rate (rad/s, counter-clockwise): of the wheel; None of one that a torque drives. body: the wheel; upright: the joint
    by which it sinks, whose coordinate grows upward (1) or downward (-1). begins: whether it begins in steady motion.
    """

    body: str
    upright: str
    upward: float
    load: float
    speed: float = 0.0
    rate: float | None = None
    begins: bool = True
