"""Schema of a fit file: runs, the parameters to be found in them, and options.

parameters:                                   # shared by all runs
  medium.eta_d: {from: 1, to: 40}             # start: what the config has; scale: log or linear
  medium.eta_h:                               # bounds follow from the start
set: {method.reduced.modes: 0}                # for all runs, as columns and time_offset_s may be
runs:
  - {config: slow.yaml, data: slow.csv}
  - config: fast.yaml
    data: fast.csv
    columns: {time_ms: t, tip_x_mm: X, tip_y_mm: Y}
    time_offset_s: fit                        # or a number, or {from: -0.01, to: 0.01}
    parameters: {initial.impact_speed_rad_s: {from: 8, to: 9}}
  - config: penetrometer.yaml                 # a force test: the law alone, on the body of this config
    data: plate.csv
    columns: {depth_mm: z, force_N: F}
    rows: {diameter_mm: 60}                   # of a table of several tests
    force_test: {direction: down, speed_m_s: 0.005, depth_offset_m: fit}
noise: {tip_x_mm: 0.1}                        # estimated where it is not given
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from granular_contact.config.schema.sweep import DottedKeys
from granular_contact.values.strict import Faults, Listed, Names, NotNegative, Positive, Strict, Text, allow, form

MOST_RUNS, MOST_STARTS = 1000, 1024
OFFSET_RANGE = (-0.02, 0.02)  # s, of a clock of which nothing is said


class Bounds(Strict):
    """Bounds of a parameter; what is left out follows from the config and the schema."""

    low: Annotated[float | None, Field(alias="from")] = None
    high: Annotated[float | None, Field(alias="to")] = None
    start: float | None = None
    """null: the value in the config."""
    scale: Literal["log", "linear"] | None = None
    """null: log where the bounds are far apart."""

    def _faults(self) -> Faults:
        low, high, start = self.low, self.high, self.start
        if low is not None and high is not None and low >= high:
            yield (), f"got bounds from {low:g} to {high:g}; the first must be below the second"
        elif start is not None and ((low is not None and start < low) or (high is not None and start > high)):
            bounds = f"from {'-inf' if low is None else f'{low:g}'} to {'inf' if high is None else f'{high:g}'}"
            yield ("start",), f"got {start:g}, which is not within the bounds {bounds}"
        elif self.scale == "log" and any(one is not None and one <= 0.0 for one in (low, high, start)):
            yield ("scale",), "got log, for which bounds and start must be above 0"


class ClockBounds(Bounds):
    """Bounds of the offset of a clock (s), or of a zero of depth (m) or force (N)."""

    low: Annotated[float, Field(alias="from")]
    high: Annotated[float, Field(alias="to")]


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
    """A body that is moved through the medium as prescribed, while its force is measured: the law alone, without a run.

    Columns of the table go before the numbers given here.
    """

    body: Text | None = None
    """The body that is moved; null: the only one that meets the medium."""
    direction: Direction = "down"
    """Of the motion: down, up, right, left, or its angle below the horizontal (deg)."""
    speed_m_s: NotNegative | None = None
    """Of the body in that direction; null: so slow that only what does not depend on speed is left."""
    depth_m: float | None = None
    """Of its lowest point below the surface, where no column says it."""
    rate_rad_s: float = 0.0
    """At which it turns about its joint, clockwise."""
    area_m2: Positive | None = None
    """Over which the force is a pressure; of tables that hold pressures."""
    depth_offset_m: Offset = 0.0
    """Depth in the table where the body touches the surface. fit: it is looked for."""
    force_offset_N: Offset = 0.0
    """Force in the table where there is none. fit: it is looked for."""
    unloading: Literal["refuse", "leave_out"] = "refuse"
    """What is done about rows in which the body goes back, after it was pressed in."""


class FitRun(Strict):
    """A measured run; columns, time_offset_s and force_test that it leaves out are those of the whole file."""

    name: Text | None = None
    """null: the name of the CSV file, without its suffix."""
    config: Annotated[Text, Field(min_length=1), allow("the path of a config")]
    data: Annotated[Text, Field(min_length=1), allow("the path of a CSV file")]
    set_: DottedKeys = Field(default_factory=dict, alias="set")
    """Dotted keys and their values in this run."""
    columns: Columns | None = None
    """Headers in the CSV file by quantity; null: the headers are those of a run's own table."""
    time_offset_s: Offset | None = None
    """Time at which the run starts, by the clock of the data. null: 0."""
    parameters: Parameters | None = None
    """Parameters of this run only."""
    rows: Annotated[dict[str, float], Field(min_length=1), allow("a mapping from headers to numbers")] | None = None
    """Which rows of the table are of this run: those with these numbers in these columns. null: all."""
    force_test: ForceTest | None = None
    """How the body was moved, where forces against depth or speed were measured. null: as its columns say."""


class FitFile(Strict):
    """A fit: parameters of configs, estimated from measured runs."""

    runs: Annotated[
        tuple[FitRun, ...],
        Listed,
        Field(min_length=1, max_length=MOST_RUNS),
        allow(f"a list of one run or more, to {MOST_RUNS}"),
    ]
    parameters: Parameters | None = None
    """Parameters that all runs share."""
    set_: DottedKeys = Field(default_factory=dict, alias="set")
    """Dotted keys and their values in all runs."""
    columns: Columns | None = None
    time_offset_s: Offset | None = None
    force_test: ForceTest | None = None
    noise: Annotated[dict[str, Positive], allow("a mapping from columns to their noise, as tip_x_mm: 0.1")] = Field(
        default_factory=dict
    )
    """Standard deviation of columns; estimated where it is not given."""
    loss: Literal["soft_l1", "linear"] = "soft_l1"
    """soft_l1 limits the weight of outliers; linear: ordinary least squares."""
    scatter: bool = False
    """Whether the scatter of grains is separated from noise, in force tests of one column each."""
    starts: Annotated[int, Field(ge=1, le=MOST_STARTS)] = 8
    """Number of starting points."""
    seed: Annotated[int, Field(ge=0, le=999_999)] = 0
    """Seed of the choice of these points."""
