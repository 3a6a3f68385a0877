"""Schema of signals: values over time that drives follow, in the unit of the key that holds the signal."""

from __future__ import annotations

from itertools import islice, pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from granular_contact.values.strict import Faults, Listed, NotNegative, Positive, Strict, Tagged, Text, by_type


class Constant(Strict):
    """A constant value. A plain number in place of this mapping means the same."""

    type: Literal["constant"]
    value: float
    """The value, in the unit of the key that holds the signal."""


class Sine(Strict):
    """offset + amplitude sin(2 pi frequency t + phase)."""

    type: Literal["sine"]
    amplitude: float
    """Amplitude, in the unit of the key that holds the signal."""
    frequency_Hz: Positive
    """Periods per second."""
    phase_deg: float = 0.0
    """Phase at t = 0; 360 is one period."""
    offset: float = 0.0
    """Mean value, in the unit of the key that holds the signal."""


class Ramp(Strict):
    """Smooth change from one value to another, constant before and after it.

    The change is a polynomial of degree 5, whose rate and acceleration are zero at both ends.
    """

    type: Literal["ramp"]
    from_: Annotated[float, Field(alias="from")]
    """Value before the change, in the unit of the key that holds the signal."""
    to: float
    """Value after the change."""
    start_s: NotNegative = 0.0
    """Time at which the change begins."""
    duration_s: Positive
    """Time that the change takes."""


class Buehler(Strict):
    """Buehler clock of a rotary leg: it turns at one rate in stance and at another rate in swing, never backward.

    For angles of hinges only. A leg along the x axis of its body points straight down at 90 degrees.
    """

    type: Literal["buehler"]
    frequency_Hz: Positive
    """Turns per second, clockwise: the leg walks to the right."""
    stance_sweep_deg: Annotated[float, Field(gt=0, lt=360)]
    """Angle that the leg sweeps during the stance."""
    stance_offset_deg: float = 90.0
    """Angle of the leg in the middle of the stance. With phase 0 the clock starts there."""
    duty_factor: Annotated[float, Field(gt=0, lt=1)]
    """Duration of the stance over the period."""
    phase_deg: float = 0.0
    """Lead of the leg ahead of the clock; 360 is one period."""
    blend: Annotated[float, Field(gt=0, le=0.5)] = 0.05
    """Duration of each change between the two rates over the period."""

    def _faults(self) -> Faults:
        shortest = min(self.duty_factor, 1.0 - self.duty_factor)
        if self.blend > shortest:
            yield ("blend",), f"got {self.blend:g}; allowed is at most {shortest:g}, the shorter of stance and swing"


class Csv(Strict):
    """A column of a CSV file, interpolated. The value is constant before the first row and after the last."""

    type: Literal["csv"]
    file: Text
    """Path of the CSV file, relative to the folder of the config."""
    column: Text
    """Header of the column with the values, which are in the unit of the key that holds the signal."""
    time_column: Text = "time_s"
    """Header of the column with the times (s), which must increase."""
    interpolation: Literal["linear", "cubic"] = "cubic"
    """Interpolation between rows. linear: straight lines; cubic: cubics that do not overshoot (PCHIP), with zero rate
    at both ends."""


class Table(Strict):
    """Values at given times, interpolated. The value is constant before the first time and after the last."""

    type: Literal["table"]
    time_s: Annotated[tuple[float, ...], Listed, Field(min_length=2)]
    """Times, which must increase."""
    values: Annotated[tuple[float, ...], Listed, Field(min_length=2)]
    """Value at each time, in the unit of the key that holds the signal."""
    interpolation: Literal["linear", "cubic"] = "cubic"
    """Interpolation between times. linear: straight lines; cubic: cubics that do not overshoot (PCHIP), with zero rate
    at both ends."""
    source: Text | None = None
    """Where the values come from, for readers; null: not stated."""

    def _faults(self) -> Faults:
        if len(self.time_s) != len(self.values):
            yield ("values",), f"got {len(self.values)} values for {len(self.time_s)} instants"
        falling = ((a, b) for a, b in pairwise(self.time_s) if b <= a)
        for before, after in islice(falling, 1):
            yield ("time_s",), f"got {after:g} after {before:g}; allowed are instants that grow"


class Shared(Strict):
    """One of the shared `signals` of the run, so that several drives follow the same clock.

    The name of the signal in place of this mapping means the same.
    """

    type: Literal["shared"]
    name: Text
    """Name of the shared signal."""
    phase_deg: float = 0.0
    """Lead of this drive ahead of the shared signal; 360 is one period. Other than 0 for a sine or buehler alone."""


SIGNALS = by_type(Constant, Sine, Ramp, Buehler, Csv, Table, Shared)


def _spelled_out(value: Any) -> Any:
    """The long form of a signal: a number stands for a constant, a name for a shared signal."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return {"type": "constant", "value": value}
    return {"type": "shared", "name": value} if isinstance(value, str) else value


AnySignal = Constant | Sine | Ramp | Buehler | Csv | Table | Shared
Signal = Annotated[AnySignal, Tagged("type", SIGNALS), BeforeValidator(_spelled_out)]
