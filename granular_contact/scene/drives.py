"""Drives of a scenario, in SI units of the joints' coordinates; controls of drives that are set during a run.

The name of a control is the name of its joint and the key of its drive.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from granular_contact.config import schema
from granular_contact.config.schema.drives import OF_TARGET, TARGETS, target
from granular_contact.errors import Fault, scene_fault
from granular_contact.scene import signals
from granular_contact.scene.signal_tables import period, shortest_period
from granular_contact.scene.steps import Steps
from granular_contact.scene.types import Drive, Scene

FEWEST_STEPS = 50  # least number of steps for a change of a rate: energies are then right to 1e-3

# Steps per shortest period of a signal: up to UNDERSAMPLED a signal is refused, below WELL_SAMPLED a run warns.
UNDERSAMPLED, WELL_SAMPLED = 2, 16
MOST_PERIODS = 1e6  # of a signal in a run; its table has 50 pieces a period, which take 3 kB


def drives_of(scenario: schema.Scenario, solver: Steps, faults: list[Fault]) -> tuple[Drive, ...]:
    """All drives of a scenario; faults are appended. solver: with the step sizes, which bound how fast signals vary."""
    drives = []
    for name, spec in scenario.drives.items():
        key = target(spec)
        unit = math.radians(1.0) if key == "angle_deg" else 1.0
        if isinstance(spec, schema.External):
            least, most = spec.range or (-math.inf, math.inf)
            signal: signals.Signal = signals.Constant(unit * getattr(spec, key))
            drives.append(replace(_drive(name, spec, signal), sets=key, bounds=(unit * least, unit * most)))
            continue
        given: schema.AnySignal = getattr(spec, key)
        phase = 0.0
        if isinstance(given, schema.Shared):
            phase, given = given.phase_deg, scenario.signals[given.name]
        if isinstance(given, schema.Csv):
            words = f"{given.file} was not read: load the config from its file, or give the signal as a table"
            faults.append(scene_fault(f"drives.{name}.{key}", words))
            continue
        signal = _signal(given, unit, phase)
        if isinstance(spec, schema.Motion):
            signal = _without_jumps(signal, solver, name, spec, faults)
        faults += _undersampled(signal, solver, f"drives.{name}.{key}")
        drives.append(_drive(name, spec, signal))
    return tuple(drives)


def _without_jumps(
    signal: signals.Signal, solver: Steps, name: str, spec: schema.Motion, faults: list[Fault]
) -> signals.Signal:
    """Smooth the jumps of a motion's rate during the run over `smooth_s`; a fault is appended if that is not given.

    A jump of the rate takes an infinite force, and the result would depend on the step size.
    """
    key = target(spec)
    jumps = [jump for jump in signals.jumps(signal) if 0.0 < jump.time < solver.end_time_s]
    if spec.smooth_s is None:
        faults += [_jump_fault(f"drives.{name}.{key}", jumps)] if jumps else []
        return signal
    least = FEWEST_STEPS * solver.step_s
    if solver.accuracy is None and spec.smooth_s < least:
        words = f"got {spec.smooth_s:g}; allowed is at least {least:g}, {FEWEST_STEPS} times solver.step_s"
        words += ", or solver.accuracy"
        faults.append(scene_fault(f"drives.{name}.smooth_s", words))
    return signals.Smoothed(signal, tuple(jumps), spec.smooth_s) if jumps else signal


def _undersampled(signal: signals.Signal, solver: Steps, key: str) -> list[Fault]:
    """Fault of a signal that steps do not resolve: at two fixed ones a period, all of them may fall on its zeros."""
    periods = solver.end_time_s / (period(signal) or math.inf)
    if periods > MOST_PERIODS:
        words = f"repeats {periods:.3g} times until end_time_s, {solver.end_time_s:g}"
        return [scene_fault(key, f"{words}; allowed are {MOST_PERIODS:g} times, as memory is finite")]
    shortest = shortest_period(signal, solver.end_time_s)
    if solver.accuracy is not None or shortest > UNDERSAMPLED * solver.step_s * (1.0 + 1e-9):
        return []
    words = f"goes to and fro within {shortest:.3g} s ({1.0 / shortest:.4g} Hz), which steps of {solver.step_s:g} s "
    words += "do not resolve"
    allowed = f"solver.accuracy, which chooses shorter steps, or solver.step_s: {shortest / WELL_SAMPLED:.2g}"
    return [scene_fault(key, f"{words}; allowed are {allowed}")]


def _jump_fault(key: str, jumps: list[signals.Jump]) -> Fault:
    unit, factor = ("deg/s", math.degrees(1.0)) if key.endswith("angle_deg") else ("m/s", 1.0)
    time, before, after = jumps[0]
    words = f"at t = {time:g} s the rate jumps from {factor * before:.4g} to {factor * after:.4g} {unit}"
    words += f" (the first of {len(jumps)} jumps)" if len(jumps) > 1 else ""
    return scene_fault(
        key,
        f"{words}, which takes an infinite force; allowed are interpolation: cubic, and smooth_s: a time (s) over "
        "which the rate changes",
    )


def _drive(name: str, spec: schema.AnyDrive, signal: signals.Signal) -> Drive:
    key = target(spec)
    if isinstance(spec, schema.Motion):
        return Drive(name, "motion", signal)
    if key in ("torque_Nm", "force_N"):
        return Drive(name, "load", signal)
    gain, rate_gain, limit = (getattr(spec, option) for option in OF_TARGET[TARGETS[key]])
    of_rate = key in ("rate_rad_s", "speed_m_s")
    return Drive(name, "control", signal, gain, rate_gain, math.inf if limit is None else limit, of_rate)


def _signal(spec: schema.AnySignal, unit: float, phase_deg: float) -> signals.Signal:
    """Signal of a config with its values multiplied by `unit` and its phase advanced."""
    if isinstance(spec, schema.Constant):
        return signals.Constant(unit * spec.value)
    if isinstance(spec, schema.Sine):
        phase = math.radians(spec.phase_deg + phase_deg)
        return signals.Sine(unit * spec.amplitude, 2.0 * math.pi * spec.frequency_Hz, phase, unit * spec.offset)
    if isinstance(spec, schema.Ramp):
        return signals.Ramp(unit * spec.from_, unit * spec.to, spec.start_s, spec.duration_s)
    if isinstance(spec, schema.Buehler):
        sweep, offset = math.radians(spec.stance_sweep_deg), math.radians(spec.stance_offset_deg)
        phase = (spec.phase_deg + phase_deg) / 360.0
        return signals.Buehler(spec.frequency_Hz, sweep, offset, spec.duty_factor, phase, spec.blend)
    assert isinstance(spec, schema.Table)  # `drives_of` has resolved shared signals and files
    return signals.piecewise(np.array(spec.time_s), unit * np.array(spec.values), spec.interpolation == "cubic")


@dataclass(frozen=True)
class Control:
    """Control of the drive of a joint, which can be set during a run.

    unit: the unit in its name, in SI units; start: value at the start, in SI units; bounds: allowed range, in the unit
    of its name.
    """

    joint: str
    unit: float
    start: float
    bounds: tuple[float, float]

    def in_si(self, name: str, value: float) -> float:
        """Convert a value to SI units; name: the one by which it was given, for an angle also `..._rad`."""
        return value if name.endswith("_rad") else self.unit * value

    @property
    def bounds_in_si(self) -> tuple[float, float]:
        """Allowed range in SI units."""
        return self.unit * self.bounds[0], self.unit * self.bounds[1]


class RangeExcess(NamedTuple):
    """How often a control was set beyond the range of its drive, and the greatest excess (SI units)."""

    times: int = 0
    most: float = 0.0

    def with_excess(self, excess: float) -> RangeExcess:
        """Count one more value, with this excess."""
        return RangeExcess(self.times + 1, max(self.most, excess))


def range_warnings(controls: Mapping[str, Control], beyond: Mapping[str, RangeExcess]) -> Iterator[str]:
    """Warnings of controls (by name) that were set beyond their range; beyond: by joint."""
    for name, control in controls.items():
        if (excess := beyond.get(control.joint)) is not None:
            times = "once" if excess.times == 1 else f"{excess.times} times"
            words = f"{name} was given beyond its range, {control.bounds[0]:g} to {control.bounds[1]:g}, {times}"
            yield f"{words}, by {excess.most / control.unit:.3g} at the most: it was set to the end of the range"


def controls_of(scene: Scene) -> dict[str, Control]:
    """All controls of a scene by their names, in the order of its drives."""
    controls = {}
    for drive in scene.drives:
        if drive.sets:
            unit = math.radians(1.0) if drive.sets == "angle_deg" else 1.0
            least, most = drive.bounds
            bounds = least / unit, most / unit
            controls[f"{drive.joint}_{drive.sets}"] = Control(drive.joint, unit, drive.signal.value(0.0), bounds)
    return controls
