"""Schema of a fit file: measured runs, the parameters to estimate from them, and options.

parameters:                                   # shared by all runs
  medium.eta_d: {from: 1, to: 40}             # start: the value in the config; scale: log or linear
  medium.eta_h:                               # the bounds follow from the start
set: {method.reduced.modes: 0}                # for all runs; columns and time_offset_s may stand here too
runs:
  - {config: slow.yaml, data: slow.csv}
  - config: fast.yaml
    data: fast.csv
    columns: {time_ms: t, tip_x_mm: X, tip_y_mm: Y}
    time_offset_s: fit                        # or a number, or {from: -0.01, to: 0.01}
    parameters: {initial.impact_speed_rad_s: {from: 8, to: 9}}
  - config: penetrometer.yaml                 # a force test: the law alone acts on the body of this config
    data: plate.csv
    columns: {depth_mm: z, force_N: F}
    rows: {diameter_mm: 60}                   # one test of a table with several
    force_test: {direction: down, speed_m_s: 0.005, depth_offset_m: fit}
noise: {tip_x_mm: 0.1}                        # other columns: estimated
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from granular_contact.config.schema.sweep import DottedKeys
from granular_contact.values.strict import Faults, Listed, Names, NotNegative, Positive, Strict, Text, allow, form

MOST_RUNS, MOST_STARTS = 1000, 1024
OFFSET_RANGE = (-0.02, 0.02)  # s, bounds of a clock offset that is fitted without bounds of its own


class Interval(Strict):
    """Bounds of a number that is fitted, and its first estimate."""

    low: Annotated[float | None, Field(alias="from")] = None
    """Lower bound, in the unit of the key. null: a fraction of the start, as far as the schema allows."""
    high: Annotated[float | None, Field(alias="to")] = None
    """Upper bound, in the unit of the key. null: a multiple of the start, as far as the schema allows."""
    start: float | None = None
    """First estimate. null: the value in the config."""

    def _faults(self) -> Faults:
        low, high, start = self.low, self.high, self.start
        if low is not None and high is not None and low >= high:
            yield (), f"got bounds from {low:g} to {high:g}; the first must be below the second"
        elif start is not None and ((low is not None and start < low) or (high is not None and start > high)):
            bounds = f"from {'-inf' if low is None else f'{low:g}'} to {'inf' if high is None else f'{high:g}'}"
            yield ("start",), f"got {start:g}, which is not within the bounds {bounds}"


class Bounds(Interval):
    """Bounds, start and scale of a parameter; each has a default, which follows from the config and the schema."""

    scale: Literal["log", "linear"] | None = None
    """Whether the parameter or its logarithm is varied. null: log if the bounds are above 0 and differ by a factor of
    10 or more, else linear."""

    def _faults(self) -> Faults:
        faults = list(super()._faults())
        if not faults and self.scale == "log":
            numbers = (self.low, self.high, self.start)
            if any(number is not None and number <= 0.0 for number in numbers):
                faults.append((("scale",), "got log, for which bounds and start must be above 0"))
        yield from faults


class ClockBounds(Interval):
    """Bounds of an offset that is fitted: of a clock (s), of the zero of depth (m) or of the zero of force (N)."""

    low: Annotated[float, Field(alias="from")]
    """Lower bound."""
    high: Annotated[float, Field(alias="to")]
    """Upper bound."""
    start: float | None = None
    """First estimate. null: 0, or the nearer bound if 0 is outside."""


Parameters = Annotated[
    Annotated[Names, Tag("list")]
    | Annotated[
        dict[str, Annotated[Bounds | None, allow("a mapping with from, to, start, scale, or nothing")]],
        Field(min_length=1),
        Tag("mapping"),
    ],
    Discriminator(form),
    allow("a list of dotted keys, or a mapping from them to their bounds"),
]
Columns = Annotated[
    dict[str, Text],
    Field(min_length=1),
    allow("a mapping from time_s, pivot_angle_deg and the like to names in the CSV file"),
]
Offset = Annotated[
    Annotated[Literal["fit"], Tag("text")] | Annotated[float, Tag("number")] | Annotated[ClockBounds, Tag("mapping")],
    Discriminator(form),
    allow("fit, a number, or a mapping with from and to"),
]


Direction = Annotated[
    Annotated[Literal["down", "up", "right", "left"], Tag("text")] | Annotated[float, Tag("number")],
    Discriminator(form),
    allow("down, up, right, left, or an angle below the horizontal (deg)"),
]
DIRECTIONS = {"right": 0.0, "down": 90.0, "left": 180.0, "up": -90.0}


class ForceTest(Strict):
    """Force test: a body moves through the medium in a prescribed way while its force is measured.

    The law alone gives the force; no run is computed. A column of the table replaces the number given here for the same
    quantity.
    """

    body: Text | None = None
    """Name of the body that moves. null: the only body on which the medium acts."""
    direction: Direction = "down"
    """Direction of the motion: down, up, right, left, or its angle below the horizontal (deg)."""
    speed_m_s: NotNegative | None = None
    """Speed of the body in this direction. null: quasi-static, only forces that do not depend on speed act."""
    depth_m: float | None = None
    """Depth of the lowest point of the body below the surface, if the table has no column of depths."""
    rate_rad_s: float = 0.0
    """Angular rate of the body about its joint, clockwise."""
    area_m2: Positive | None = None
    """Area over which the measured pressure acts; only for tables of pressures."""
    depth_offset_m: Offset = 0.0
    """Depth in the table at which the body touches the surface. fit: it is estimated too."""
    force_offset_N: Offset = 0.0
    """Force in the table at zero load (zero of the force sensor). fit: it is estimated too."""
    unloading: Literal["refuse", "leave_out"] = "refuse"
    """Treatment of rows in which the body moves back after it was pressed in: a fault, or left out of the fit."""


class FitRun(Strict):
    """A measured run. Its columns, time_offset_s and force_test replace those of the whole file."""

    name: Text | None = None
    """Name of the run. null: the name of the CSV file without its suffix."""
    config: Annotated[Text, Field(min_length=1), allow("the path of a config")]
    """Path of the config that simulates this run, relative to the folder of the fit file; or the name of a shipped
    config."""
    data: Annotated[Text, Field(min_length=1), allow("the path of a CSV file")]
    """Path of the CSV file with the measured values, relative to the folder of the fit file."""
    set_: DottedKeys = Field(default_factory=dict, alias="set")
    """Values that replace those of the config in this run, by dotted key."""
    columns: Columns | None = None
    """Header in the CSV file of each quantity, as tip_x_mm: X. null: the headers have the names that the table of a
    simulated run has."""
    time_offset_s: Offset | None = None
    """Time at which the run starts, by the clock of the data. fit: it is estimated too. null: that of the file, else
    0."""
    parameters: Parameters | None = None
    """Parameters to estimate from this run alone, by dotted key, with their bounds."""
    rows: Annotated[dict[str, float], Field(min_length=1), allow("a mapping from headers to numbers")] | None = None
    """Selects the rows of the CSV file that belong to this run: those with these numbers under these headers. null: all
    rows."""
    force_test: ForceTest | None = None
    """Says that the data are a force test, and how the body moved. null: that of the file, else the columns decide."""


class FitFile(Strict):
    """A fit: estimates of parameters of configs from measured runs."""

    runs: Annotated[
        tuple[FitRun, ...],
        Listed,
        Field(min_length=1, max_length=MOST_RUNS),
        allow(f"a list of one run or more, to {MOST_RUNS}"),
    ]
    """Measured runs, each with its config and its data."""
    parameters: Parameters | None = None
    """Parameters to estimate, common to all runs, by dotted key, with their bounds."""
    set_: DottedKeys = Field(default_factory=dict, alias="set")
    """Values that replace those of the configs in all runs, by dotted key."""
    columns: Columns | None = None
    """Headers for all runs that give none, see `columns` of a run."""
    time_offset_s: Offset | None = None
    """Offset for all runs that give none, see `time_offset_s` of a run."""
    force_test: ForceTest | None = None
    """Force test for all runs that give none, see `force_test` of a run."""
    noise: Annotated[dict[str, Positive], allow("a mapping from columns to their noise, as tip_x_mm: 0.1")] = Field(
        default_factory=dict
    )
    """Standard deviation of the noise of columns, in the unit of each column. For other columns it is estimated."""
    loss: Literal["soft_l1", "linear"] = "soft_l1"
    """Loss function of the residuals. soft_l1: limits the weight of outliers; linear: ordinary least squares."""
    scatter: bool = False
    """true: separate the scatter of the grains' resistance from measurement noise. For force tests with one measured
    column each."""
    starts: Annotated[int, Field(ge=1, le=MOST_STARTS)] = 8
    """Number of starting points of the least-squares iteration."""
    seed: Annotated[int, Field(ge=0, le=999_999)] = 0
    """Seed of the random starting points."""
