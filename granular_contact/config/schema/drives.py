"""Schema of drives: what acts at a joint over time. Clockwise is positive, as in the joint's column."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import model_validator

from granular_contact.config.schema.signals import Buehler, Signal
from granular_contact.values.strict import NotNegative, Positive, Strict, Tagged, refusal


def _exactly_one(drive: Strict, names: tuple[str, ...]) -> None:
    given = [name for name in names if getattr(drive, name) is not None]
    if len(given) != 1:
        got = " and ".join(given) or "none"
        raise refusal([((), f"got {got} of {', '.join(names)}; exactly one is allowed")])
    for name in given:
        if name != "angle_deg" and isinstance(getattr(drive, name), Buehler):
            raise refusal([((name,), "got a buehler clock, which gives angles; allowed are the other signals")])


class Torque(Strict):
    """A torque on a hinge, the opposite one on its parent."""

    type: Literal["torque"]
    torque_Nm: Signal

    @model_validator(mode="after")
    def _no_angle(self) -> Torque:
        _exactly_one(self, ("torque_Nm",))
        return self


class Force(Strict):
    """A force along the axis of a slider, the opposite one on its parent."""

    type: Literal["force"]
    force_N: Signal

    @model_validator(mode="after")
    def _no_angle(self) -> Force:
        _exactly_one(self, ("force_N",))
        return self


class Motion(Strict):
    """The joint follows the signal exactly, whatever torque or force it takes; its rate must not jump."""

    type: Literal["motion"]
    angle_deg: Signal | None = None
    """Of a hinge."""
    position_m: Signal | None = None
    """Of a slider."""
    smooth_s: Positive | None = None
    """Time over which each jump of the rate is smoothed; null: jumps are refused."""

    @model_validator(mode="after")
    def _one_target(self) -> Motion:
        _exactly_one(self, ("angle_deg", "position_m"))
        return self


class HingeControl(Strict):
    """Torque = gain (reference angle - angle) + rate gain (reference rate - rate), within a limit."""

    type: Literal["pd"]
    angle_deg: Signal | None = None
    """Reference angle; give this or rate_rad_s."""
    rate_rad_s: Signal | None = None
    """Reference rate; the gain is then ignored."""
    gain_Nm_per_rad: NotNegative = 0.0
    rate_gain_Nm_s_per_rad: NotNegative = 0.0
    limit_Nm: Positive | None = None
    """null: no limit."""

    @model_validator(mode="after")
    def _one_target(self) -> HingeControl:
        _exactly_one(self, ("angle_deg", "rate_rad_s"))
        _gains(self, "gain_Nm_per_rad", "rate_gain_Nm_s_per_rad", by_rate=self.rate_rad_s is not None)
        return self


class SliderControl(Strict):
    """Force = gain (reference position - position) + speed gain (reference speed - speed), within a limit."""

    type: Literal["pd_slider"]
    position_m: Signal | None = None
    """Reference position; give this or speed_m_s."""
    speed_m_s: Signal | None = None
    """Reference speed; the gain is then ignored."""
    gain_N_per_m: NotNegative = 0.0
    speed_gain_N_s_per_m: NotNegative = 0.0
    limit_N: Positive | None = None
    """null: no limit."""

    @model_validator(mode="after")
    def _one_target(self) -> SliderControl:
        _exactly_one(self, ("position_m", "speed_m_s"))
        _gains(self, "gain_N_per_m", "speed_gain_N_s_per_m", by_rate=self.speed_m_s is not None)
        return self


def _gains(drive: Strict, gain: str, rate_gain: str, *, by_rate: bool) -> None:
    if by_rate and getattr(drive, gain) != 0.0:
        raise refusal([((gain,), f"got {getattr(drive, gain):g}, but a speed is controlled: allowed is {rate_gain}")])
    needed = rate_gain if by_rate else gain
    if getattr(drive, needed) == 0.0:
        raise refusal([((needed,), "got 0 or nothing, so the drive would do nothing; allowed is a number above 0")])


DRIVES: dict[str, type[Strict]] = {
    "torque": Torque,
    "force": Force,
    "motion": Motion,
    "pd": HingeControl,
    "pd_slider": SliderControl,
}
AnyDrive = Torque | Force | Motion | HingeControl | SliderControl
Drive = Annotated[AnyDrive, Tagged("type", DRIVES)]
# Key of the signal -> type of joint that has such a coordinate.
TARGETS = {
    "torque_Nm": "hinge",
    "angle_deg": "hinge",
    "rate_rad_s": "hinge",
    "force_N": "slider",
    "position_m": "slider",
    "speed_m_s": "slider",
}


def target(drive: AnyDrive) -> str:
    """Key under which the drive has its signal."""
    return next(name for name in TARGETS if getattr(drive, name, None) is not None)
