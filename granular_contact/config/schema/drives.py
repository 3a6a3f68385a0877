"""Schema of drives: what acts at a joint over time. Clockwise is positive, as in the joint's column."""

from __future__ import annotations

from typing import Annotated, Literal

from granular_contact.config.schema.signals import Buehler, Signal
from granular_contact.values.strict import Faults, Listed, NotNegative, Positive, Strict, Tagged, by_type

# Key of the signal -> type of joint that has such a coordinate.
TARGETS = {
    "torque_Nm": "hinge",
    "angle_deg": "hinge",
    "rate_rad_s": "hinge",
    "force_N": "slider",
    "position_m": "slider",
    "speed_m_s": "slider",
}
_RATES = "rate_rad_s", "speed_m_s"
# Type of joint -> keys of the gains and the limit of its control.
OF_TARGET = {
    "hinge": ("gain_Nm_per_rad", "rate_gain_Nm_s_per_rad", "limit_Nm"),
    "slider": ("gain_N_per_m", "speed_gain_N_s_per_m", "limit_N"),
}


class _Drive(Strict):
    def _faults(self) -> Faults:
        """Of the signal: one is needed."""
        names = [name for name in TARGETS if name in type(self).model_fields]
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) != 1:
            got = " and ".join(given) or "none"
            yield (), f"got {got} of {', '.join(names)}; exactly one is allowed"
        for name in given:
            if name != "angle_deg" and isinstance(getattr(self, name), Buehler):
                yield (name,), "got a buehler clock, which gives angles; allowed are the other signals"


class _Control(_Drive):
    def _faults(self) -> Faults:
        yield from super()._faults()
        gain, rate_gain, _ = next(keys for keys in OF_TARGET.values() if hasattr(self, keys[0]))
        yield from _gains(self, gain, rate_gain, by_rate=any(getattr(self, key, None) is not None for key in _RATES))


class Torque(_Drive):
    """A torque on a hinge, the opposite one on its parent."""

    type: Literal["torque"]
    torque_Nm: Signal


class Force(_Drive):
    """A force along the axis of a slider, the opposite one on its parent."""

    type: Literal["force"]
    force_N: Signal


class Motion(_Drive):
    """The joint follows the signal exactly, whatever torque or force it takes; its rate must not jump."""

    type: Literal["motion"]
    angle_deg: Signal | None = None
    """Of a hinge."""
    position_m: Signal | None = None
    """Of a slider."""
    smooth_s: Positive | None = None
    """Time over which each jump of the rate is smoothed; null: jumps are refused."""


class HingeControl(_Control):
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


class SliderControl(_Control):
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


class External(_Drive):
    """Set by a program while the run goes on, see `granular_contact.Simulation`: a torque or force, or a PD target.

    One of the first six keys says what is set; its value acts until then. Of a target the torque or force is gain
    (target - coordinate) + rate gain (target of the rate - rate), within a limit; the rate that goes with an angle or a
    position is 0.
    """

    type: Literal["external"]
    torque_Nm: float | None = None
    """Of a hinge."""
    angle_deg: float | None = None
    """Of a hinge: its target."""
    rate_rad_s: float | None = None
    """Of a hinge: target of its rate."""
    force_N: float | None = None
    """Of a slider."""
    position_m: float | None = None
    """Of a slider: its target."""
    speed_m_s: float | None = None
    """Of a slider: target of its speed."""
    range: Annotated[tuple[float, float], Listed] | None = None
    """Least and greatest value that can be set; what lies beyond is set to them, with a warning. null: any."""
    gain_Nm_per_rad: NotNegative = 0.0
    rate_gain_Nm_s_per_rad: NotNegative = 0.0
    limit_Nm: Positive | None = None
    """null: no limit."""
    gain_N_per_m: NotNegative = 0.0
    speed_gain_N_s_per_m: NotNegative = 0.0
    limit_N: Positive | None = None
    """null: no limit."""

    def _faults(self) -> Faults:
        if faults := list(super()._faults()):
            yield from faults
            return
        key = target(self)
        gain, rate_gain, limit = OF_TARGET[TARGETS[key]]
        others = [name for one in OF_TARGET.values() for name in one if name not in (gain, rate_gain, limit)]
        if key in ("torque_Nm", "force_N"):
            others += [gain, rate_gain, limit]
        else:
            yield from _gains(self, gain, rate_gain, by_rate=key in _RATES)
        for name in others:
            if getattr(self, name):
                yield (name,), f"got {getattr(self, name):g}, but {key} is set: allowed is nothing"
        yield from _range_faults(self, key)


def _range_faults(drive: External, key: str) -> Faults:
    if drive.range is None:
        return
    least, most = drive.range
    if not least < most:
        yield ("range",), f"got {least:g} to {most:g}; allowed are two numbers that grow"
    elif not least <= getattr(drive, key) <= most:
        yield (key,), f"got {getattr(drive, key):g}; allowed is {least:g} to {most:g}, its range"


def _gains(drive: Strict, gain: str, rate_gain: str, *, by_rate: bool) -> Faults:
    if by_rate and getattr(drive, gain) != 0.0:
        yield (gain,), f"got {getattr(drive, gain):g}, but a speed is controlled: allowed is {rate_gain}"
    needed = rate_gain if by_rate else gain
    if getattr(drive, needed) == 0.0:
        yield (needed,), "got 0 or nothing, so the drive would do nothing; allowed is a number above 0"


DRIVES = by_type(Torque, Force, Motion, HingeControl, SliderControl, External)
AnyDrive = Torque | Force | Motion | HingeControl | SliderControl | External
Drive = Annotated[AnyDrive, Tagged("type", DRIVES)]


def target(drive: AnyDrive) -> str:
    """Key under which the drive has its signal."""
    return next(name for name in TARGETS if getattr(drive, name, None) is not None)
