"""Schema of signals: what a drive follows over time, in the unit of the key that holds it."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from granular_contact.values.strict import Listed, NotNegative, Positive, Strict, Tagged, Text, refusal


class Constant(Strict):
    """The same at all times; a number alone says it too."""

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
    """From one value to another, smoothly: a polynomial whose rate and acceleration are zero at both ends."""

    type: Literal["ramp"]
    from_: Annotated[float, Field(alias="from")]
    """`from` in YAML."""
    to: float
    start_s: NotNegative = 0.0
    duration_s: Positive


class Buehler(Strict):
    """Clock of a rotary leg: a slow sweep while it stands, the rest of the turn at another rate; it never turns back.

    For angles of hinges only. A leg that points along the x axis of its body stands with its foot down at 90 degrees.
    """

    type: Literal["buehler"]
    frequency_Hz: Positive
    """Turns a second; the leg turns clockwise, which walks to the right."""
    stance_sweep_deg: Annotated[float, Field(gt=0, lt=360)]
    stance_offset_deg: float = 90.0
    """Angle in the middle of the stance, which is where the clock starts."""
    duty_factor: Annotated[float, Field(gt=0, lt=1)]
    """Share of the turn's time that the stance takes."""
    phase_deg: float = 0.0
    """Ahead of the clock; 360 is a whole turn's time."""
    blend: Annotated[float, Field(gt=0, le=0.5)] = 0.05
    """Share of the turn's time in which one rate goes over into the other."""

    @model_validator(mode="after")
    def _blends_fit(self) -> Buehler:
        shortest = min(self.duty_factor, 1.0 - self.duty_factor)
        if self.blend > shortest:
            raise refusal(
                [(("blend",), f"got {self.blend:g}; allowed is at most {shortest:g}, the shorter of stance and swing")]
            )
        return self


class Csv(Strict):
    """Column of a CSV file beside the config; before its first row and after its last the value stays."""

    type: Literal["csv"]
    file: Text
    column: Text
    time_column: Text = "time_s"
    interpolation: Literal["linear", "cubic"] = "cubic"


class Table(Strict):
    """Values at instants, as read from a CSV file or written here; before the first and after the last they stay."""

    type: Literal["table"]
    time_s: Annotated[tuple[float, ...], Listed, Field(min_length=2)]
    values: Annotated[tuple[float, ...], Listed, Field(min_length=2)]
    interpolation: Literal["linear", "cubic"] = "cubic"
    source: Text | None = None

    @model_validator(mode="after")
    def _in_order(self) -> Table:
        if len(self.time_s) != len(self.values):
            raise refusal([(("values",), f"got {len(self.values)} values for {len(self.time_s)} instants")])
        for before, after in pairwise(self.time_s):
            if after <= before:
                raise refusal([(("time_s",), f"got {after:g} after {before:g}; allowed are instants that grow")])
        return self


class Shared(Strict):
    """One of the scenario's `signals` by its name, so that several drives follow one clock; its name alone says it."""

    type: Literal["shared"]
    name: Text
    phase_deg: float = 0.0
    """Ahead of the shared one, which must then be periodic; 360 is a whole period."""


SIGNALS: dict[str, type[Strict]] = {
    "constant": Constant,
    "sine": Sine,
    "ramp": Ramp,
    "buehler": Buehler,
    "csv": Csv,
    "table": Table,
    "shared": Shared,
}


def _spelled_out(value: Any) -> Any:
    """A number may stand for a constant, and a name for one of the shared signals."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return {"type": "constant", "value": value}
    return {"type": "shared", "name": value} if isinstance(value, str) else value


AnySignal = Constant | Sine | Ramp | Buehler | Csv | Table | Shared
Signal = Annotated[AnySignal, Tagged("type", SIGNALS), BeforeValidator(_spelled_out)]
