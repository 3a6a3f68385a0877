"""Schema of drives: torques, forces, prescribed motions and controllers of joints over time.

Signs are those of the coordinate of the joint: in the plane clockwise is positive, in space right-handed about the axis
of the joint.
"""

from __future__ import annotations

from typing import Annotated, Literal

from granular_contact.config.schema.signals import Buehler, Signal
from granular_contact.values.strict import Faults, Listed, NotNegative, Positive, Strict, Tagged, by_type

# Key of the signal -> type of joint that it drives.
TARGETS = {
    "torque_Nm": "hinge",
    "angle_deg": "hinge",
    "rate_rad_s": "hinge",
    "force_N": "slider",
    "position_m": "slider",
    "speed_m_s": "slider",
}
_RATES = "rate_rad_s", "speed_m_s"
# Type of joint -> keys of the two gains and the limit of its controller.
OF_TARGET = {
    "hinge": ("gain_Nm_per_rad", "rate_gain_Nm_s_per_rad", "limit_Nm"),
    "slider": ("gain_N_per_m", "speed_gain_N_s_per_m", "limit_N"),
}


class _Drive(Strict):
    def _faults(self) -> Faults:
        """Faults of the signal: exactly one key must hold one."""
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
    """A torque on the child of a hinge; the opposite torque acts on the parent."""

    type: Literal["torque"]
    torque_Nm: Signal
    """Torque over time."""


class Force(_Drive):
    """A force on the child of a slider, along the axis; the opposite force acts on the parent."""

    type: Literal["force"]
    force_N: Signal
    """Force over time."""


class Motion(_Drive):
    """Prescribed motion: the joint follows the signal exactly, with the torque or force that this takes.

    The rate of the signal must not jump.
    """

    type: Literal["motion"]
    angle_deg: Signal | None = None
    """Hinge: angle over time."""
    position_m: Signal | None = None
    """Slider: position over time."""
    smooth_s: Positive | None = None
    """Time over which each jump of the rate is spread. null: a signal whose rate jumps is refused."""


class HingeControl(_Control):
    """PD controller: torque = gain (reference angle - angle) + rate gain (reference rate - rate), within a limit."""

    type: Literal["pd"]
    angle_deg: Signal | None = None
    """Reference angle over time; its derivative is the reference rate. Give this or rate_rad_s."""
    rate_rad_s: Signal | None = None
    """Reference rate over time. The controller then has a rate gain alone."""
    gain_Nm_per_rad: NotNegative = 0.0
    """Torque per error of the angle; above 0 with angle_deg, 0 with rate_rad_s."""
    rate_gain_Nm_s_per_rad: NotNegative = 0.0
    """Torque per error of the rate; above 0 with rate_rad_s."""
    limit_Nm: Positive | None = None
    """Largest torque in either direction. null: no limit."""


class SliderControl(_Control):
    """PD controller: force = gain (reference position - position) + speed gain (reference speed - speed), within a
    limit.
    """

    type: Literal["pd_slider"]
    position_m: Signal | None = None
    """Reference position over time; its derivative is the reference speed. Give this or speed_m_s."""
    speed_m_s: Signal | None = None
    """Reference speed over time. The controller then has a speed gain alone."""
    gain_N_per_m: NotNegative = 0.0
    """Force per error of the position; above 0 with position_m, 0 with speed_m_s."""
    speed_gain_N_s_per_m: NotNegative = 0.0
    """Force per error of the speed; above 0 with speed_m_s."""
    limit_N: Positive | None = None
    """Largest force in either direction. null: no limit."""


class External(_Drive):
    """A drive that a program sets during the run, see `granular_contact.Simulation`.

    One of the first six keys says what the program sets: a torque, a force or the target of a PD controller. Its value
    acts until the program sets another. Controller: torque or force = gain (target - coordinate) + rate gain (target
    rate - rate), within a limit. With a target angle or target position the target rate is 0.
    """

    type: Literal["external"]
    torque_Nm: float | None = None
    """Hinge: initial torque."""
    angle_deg: float | None = None
    """Hinge: initial target angle."""
    rate_rad_s: float | None = None
    """Hinge: initial target rate."""
    force_N: float | None = None
    """Slider: initial force."""
    position_m: float | None = None
    """Slider: initial target position."""
    speed_m_s: float | None = None
    """Slider: initial target speed."""
    range: Annotated[tuple[float, float], Listed] | None = None
    """Smallest and largest value that can be set, in the unit of the key. A value outside is set to the nearer end,
    with a warning. null: any value."""
    gain_Nm_per_rad: NotNegative = 0.0
    """Hinge: torque per error of the angle; with angle_deg alone."""
    rate_gain_Nm_s_per_rad: NotNegative = 0.0
    """Hinge: torque per error of the rate."""
    limit_Nm: Positive | None = None
    """Hinge: largest torque of the controller in either direction. null: no limit."""
    gain_N_per_m: NotNegative = 0.0
    """Slider: force per error of the position; with position_m alone."""
    speed_gain_N_s_per_m: NotNegative = 0.0
    """Slider: force per error of the speed."""
    limit_N: Positive | None = None
    """Slider: largest force of the controller in either direction. null: no limit."""

    def _faults(self) -> Faults:
        if faults := list(super()._faults()):
            yield from faults
            return
        key = target(self)
        gain, rate_gain, limit = OF_TARGET[TARGETS[key]]
        others = [name for keys in OF_TARGET.values() for name in keys if name not in (gain, rate_gain, limit)]
        if key in ("torque_Nm", "force_N"):
            others += [gain, rate_gain, limit]
        else:
            yield from _gains(self, gain, rate_gain, by_rate=key in _RATES)
        for name in others:
            if getattr(self, name):
                yield (name,), f"got {getattr(self, name):g}, but {key} is set: allowed is nothing"
        yield from _range_faults(self, key)


def _range_faults(drive: External, key: str) -> Faults:
    """Faults of the range of an external drive, and of an initial value, under `key`, outside it."""
    if drive.range is None:
        return
    least, most = drive.range
    if not least < most:
        yield ("range",), f"got {least:g} to {most:g}; allowed are two numbers that grow"
    elif not least <= getattr(drive, key) <= most:
        yield (key,), f"got {getattr(drive, key):g}; allowed is {least:g} to {most:g}, its range"


def _gains(drive: Strict, gain: str, rate_gain: str, *, by_rate: bool) -> Faults:
    """Faults of the gains of a controller; by_rate: whether it controls the rate."""
    if by_rate and getattr(drive, gain) != 0.0:
        yield (gain,), f"got {getattr(drive, gain):g}, but a speed is controlled: allowed is {rate_gain}"
    needed = rate_gain if by_rate else gain
    if getattr(drive, needed) == 0.0:
        yield (needed,), "got 0 or nothing, so the drive would do nothing; allowed is a number above 0"


DRIVES = by_type(Torque, Force, Motion, HingeControl, SliderControl, External)
AnyDrive = Torque | Force | Motion | HingeControl | SliderControl | External
Drive = Annotated[AnyDrive, Tagged("type", DRIVES)]


def target(drive: AnyDrive) -> str:
    """Key of the drive that holds its signal."""
    return next(name for name in TARGETS if getattr(drive, name, None) is not None)
