"""Schema of signals: what a drive follows over time, in the unit of the key that holds it."""

from __future__ import annotations

from itertools import islice, pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from granular_contact.values.strict import Faults, Listed, NotNegative, Positive, Strict, Tagged, Text, by_type


class Constant(Strict):
    """A constant value; a plain number means the same."""

    type: Literal["constant"]
    value: float


class Sine(Strict):
    """offset + amplitude sin(2 pi frequency t + phase)."""

    type: Literal["sine"]
    amplitude: float
    frequency_Hz: Positive
    phase_deg: float = 0.0
    offset: float = 0.0


class Ramp(Strict):
    """Smooth change from one value to another: a polynomial whose rate and acceleration are zero at both ends."""

    type: Literal["ramp"]
    from_: Annotated[float, Field(alias="from")]
    """`from` in YAML."""
    to: float
    start_s: NotNegative = 0.0
    duration_s: Positive


class Buehler(Strict):
    """Clock of a rotary leg: a slow sweep in stance and another rate in swing; it never turns back.

    For angles of hinges only. A leg that points along the x axis of its body stands with its foot down at 90 degrees.
    """

    type: Literal["buehler"]
    frequency_Hz: Positive
    """Turns per second, clockwise: the leg walks to the right."""
    stance_sweep_deg: Annotated[float, Field(gt=0, lt=360)]
    stance_offset_deg: float = 90.0
    """Angle in the middle of the stance, where the clock starts."""
    duty_factor: Annotated[float, Field(gt=0, lt=1)]
    """Share of the period that the stance takes."""
    phase_deg: float = 0.0
    """Phase ahead of the clock; 360 is one period."""
    blend: Annotated[float, Field(gt=0, le=0.5)] = 0.05
    """Share of the period in which one rate changes to the other."""

    def _faults(self) -> Faults:
        shortest = min(self.duty_factor, 1.0 - self.duty_factor)
        if self.blend > shortest:
            yield ("blend",), f"got {self.blend:g}; allowed is at most {shortest:g}, the shorter of stance and swing"


class Csv(Strict):
    """Column of a CSV file, a path from the folder of the config; constant before its first and after its last row."""

    type: Literal["csv"]
    file: Text
    column: Text
    time_column: Text = "time_s"
    interpolation: Literal["linear", "cubic"] = "cubic"


class Table(Strict):
    """Values at given times; constant before the first and after the last."""

    type: Literal["table"]
    time_s: Annotated[tuple[float, ...], Listed, Field(min_length=2)]
    values: Annotated[tuple[float, ...], Listed, Field(min_length=2)]
    interpolation: Literal["linear", "cubic"] = "cubic"
    source: Text | None = None

    def _faults(self) -> Faults:
        if len(self.time_s) != len(self.values):
            yield ("values",), f"got {len(self.values)} values for {len(self.time_s)} instants"
        falling = ((a, b) for a, b in pairwise(self.time_s) if b <= a)
        for before, after in islice(falling, 1):
            yield ("time_s",), f"got {after:g} after {before:g}; allowed are instants that grow"


class Shared(Strict):
    """One of the scenario's `signals`, so that several drives share one clock; its plain name means the same."""

    type: Literal["shared"]
    name: Text
    phase_deg: float = 0.0
    """Phase ahead of the shared signal, which must be periodic; 360 is one period."""


SIGNALS = by_type(Constant, Sine, Ramp, Buehler, Csv, Table, Shared)


def _spelled_out(value: Any) -> Any:
    """A number may stand for a constant, and a name for one of the shared signals."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return {"type": "constant", "value": value}
    return {"type": "shared", "name": value} if isinstance(value, str) else value


AnySignal = Constant | Sine | Ramp | Buehler | Csv | Table | Shared
Signal = Annotated[AnySignal, Tagged("type", SIGNALS), BeforeValidator(_spelled_out)]
