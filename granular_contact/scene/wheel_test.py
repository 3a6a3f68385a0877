"""Data of a run of one wheel that its start needs."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class WheelTest:
    """Run of one wheel under a load (N), with the speed of its axle (m/s, to the right).

    body: the wheel. upright: joint that lets the wheel sink. upward: 1 if the coordinate of that joint grows upward,
    -1 if it grows downward. rate (rad/s, counter-clockwise): of the wheel; None if a torque drives it. begins: whether
    the run starts in steady motion, or with a torque in static equilibrium.
    """

    body: str
    upright: str
    upward: float
    load: float
    speed: float = 0.0
    rate: float | None = None
    begins: bool = True
