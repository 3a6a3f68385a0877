"""Schema of the start of a run: angles, positions and rates of joints, or the impact of a pendulum."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_contact.values.strict import Faults, Strict


class JointStart(Strict):
    """State of one joint, in its own coordinate; what is left out is that of rest in the reference configuration."""

    angle_deg: float | None = None
    """Of a hinge, clockwise; of a free body, below the horizontal."""
    rate_rad_s: float | None = None
    position_m: float | None = None
    """Of a slider, along its axis."""
    speed_m_s: float | None = None
    x_m: float | None = None
    """Of a free body: position of its joint, from the joint's point on the ground."""
    y_m: float | None = None
    vx_m_s: float | None = None
    """Of a free body: velocity of its joint's point."""
    vy_m_s: float | None = None

    @property
    def height(self) -> float | None:
        """Of a free body (m), if it is given."""
        return self.y_m


KEYS = {
    "hinge": ("angle_deg", "rate_rad_s"),
    "slider": ("position_m", "speed_m_s"),
    "free": ("x_m", "y_m", "angle_deg", "vx_m_s", "vy_m_s", "rate_rad_s"),
}
RATES = ("rate_rad_s", "speed_m_s", "vx_m_s", "vy_m_s")


class Initial(Strict):
    """Initial state: the undeformed mechanism, with given states of its joints."""

    impact_angle_deg: Annotated[float, Field(ge=-90, le=90)] | None = None
    """Angle below the horizontal of what is hinged or welded to the ground; null: that of the reference
    configuration."""
    impact_speed_rad_s: float = 0.0
    """Rate of the ground hinge; a positive one moves the link into the medium."""
    impact_tip_speed_m_s: float | None = None
    """The same, given as the speed of the tip, the farthest end of the mechanism."""
    joints: dict[str, JointStart] | None = None
    """By the name of the joint; others start at rest in the reference configuration, or follow a loop or a drive."""
    settle: bool = False
    """Start from static equilibrium under gravity, with the drives as they are at t = 0."""

    def _faults(self) -> Faults:
        if self.impact_tip_speed_m_s is not None and self.impact_speed_rad_s != 0.0:
            yield ("impact_tip_speed_m_s",), "got both this and impact_speed_rad_s; allowed is one of them"
        if self.settle:
            yield from [(path, f"got {value:g}, but settle is true: allowed is 0") for path, value in self._speeds()]

    def _speeds(self) -> list[tuple[tuple[str, ...], float]]:
        speeds: list[tuple[tuple[str, ...], float | None]] = [
            ((key,), getattr(self, key)) for key in ("impact_speed_rad_s", "impact_tip_speed_m_s")
        ]
        for name, start in (self.joints or {}).items():
            speeds += [(("joints", name, key), getattr(start, key)) for key in RATES]
        return [(path, value) for path, value in speeds if value]
