"""Schema of a run: mechanism, medium, initial state, drives, solver and output."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

import yaml
from pydantic import Discriminator, Field, Tag

from granular_contact.config.schema.bed import Bed, Media
from granular_contact.config.schema.drives import Drive
from granular_contact.config.schema.initial import Initial, drive_faults, initial_faults
from granular_contact.config.schema.method import Method
from granular_contact.config.schema.model import Model
from granular_contact.config.schema.signals import Signal
from granular_contact.config.schema.wheel import WheelRun, wheel_faults
from granular_contact.laws.law import Law
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.values.strict import Faults, Point, Positive, Strict, Tagged, Text, by_type, directed, form

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from granular_contact.config.given import Changes

FRICTIONS = by_type(Elastoplastic, Smooth)
Friction = Annotated[Elastoplastic | Smooth, Tagged("type", FRICTIONS)]


class Load(Strict):
    """Discretisation of the resistance of the medium, and the model of its static friction."""

    form: Literal["distributed", "resultant"] = "distributed"
    """distributed: forces along the immersed length; resultant: one force in the middle of the immersed length."""
    end_cap: bool = False
    """true: the cross-section at the free end of a link counts in the drag."""
    strips_per_element: Annotated[int, Field(ge=1, le=64)] = 4
    """Number of strips along each element of a flexible link. A run with chosen steps that needs more strips for its
    accuracy is repeated with more."""
    strips_per_rigid_part: Annotated[int, Field(ge=1, le=1024)] = 16
    """Number of strips along a bar or a plate; the closed outline of a solid has twice as many. A run with chosen steps
    that needs more strips for its accuracy is repeated with more."""
    friction: Friction = Elastoplastic()
    """Regularisation of static friction at zero speed."""


MOST_STEPS = 1e8  # of a run with fixed steps: their rows would take some 10 GB


class Solver(Strict):
    """Time integration, and the conditions that end a run."""

    end_time_s: Positive = 0.5
    """Simulated time at which the run ends at the latest."""
    step_s: Positive | None = None
    """Length of the fixed time steps; with accuracy the length of the first step. null: 0.2 ms, and the steps are fixed
    or chosen as `accuracy` says."""
    rest_time_s: Positive | None = 0.02
    """The run ends once the mechanism has been slower than rest_speed_m_s for this time; null: rest does not end the
    run. It never does with drives."""
    rest_speed_m_s: Positive = 1e-3
    """Speed below which the mechanism counts as at rest."""
    accuracy: Annotated[float, Field(ge=1e-7, le=0.1)] | None = None
    """Choose the time steps by their error: the estimated error of positions in a step stays below this fraction of the
    distance that the fastest point travels in the step. null: fixed steps where step_s is given, and for a single body
    in the plane on a hinge or slider without drive; else 1e-3. `run --explain` says which."""
    max_wall_s: Positive | None = None
    """Wall time after which the run ends with the status time_limit; null: no limit."""
    spectral_radius: Annotated[float, Field(ge=0, le=1)] | None = None
    """Spectral radius at infinite frequency of the generalised-alpha method; 1: no numerical damping, 0: the most.
    null: 0.9; 0.5 with chosen steps or prescribed motions, but 0.9 for a single free body in space; 0 where a link is
    so stiff that its elastic forces are below round-off."""
    tolerance: Annotated[float, Field(gt=0, lt=1)] | None = None
    """Largest residual of Newton's method in a step, relative to the forces of the scene. In minimal coordinates it
    also limits the last change of speeds, relative to the highest speed so far. null: 1e-5. With chosen steps: accuracy
    / 50 in minimal coordinates, and the smaller of accuracy / 50 and 1e-5 with method engine in the plane. There a body
    that moves under forces far below its weight needs a smaller tolerance."""

    def _faults(self) -> Faults:
        if self.step_s is not None and self.step_s > self.end_time_s:
            yield ("step_s",), f"got {self.step_s:g}, which exceeds end_time_s, {self.end_time_s:g}"
        elif self.step_s is not None and self.end_time_s / self.step_s > MOST_STEPS:
            steps = f"{self.end_time_s / self.step_s:.2g} steps to end_time_s, {self.end_time_s:g}"
            yield (
                ("step_s",),
                f"got {self.step_s:g}, which makes {steps}; allowed are {MOST_STEPS:g}, as memory is finite",
            )


Travel = (
    Annotated[Literal["x", "y", "path"], Tag("text")]
    | Annotated[Point, directed("a direction on the ground, as [0, 1] for y"), Tag("list")]
)


class Output(Strict):
    """Recorded rows and columns, and saved files."""

    interval_s: Positive | None = None
    """Simulated time between rows of the time series. null: a row for every accepted step."""
    figures: bool = True
    """true: draw and save the figures of the run."""
    bodies: Literal["auto", "all", "none"] = "auto"
    """Columns of the motion of every body. auto: only if the mechanism has at most 32 bodies, and in the plane only if
    it is no pendulum (one moving joint, a hinge)."""
    travel: Annotated[Travel, Discriminator(form)] = "x"
    """Direction along which distance, forward speed and cost of transport are measured, at the common centre of mass:
    an axis of the world (x or y), a direction [x, y] on the ground, or path (the length of the path seen from above).
    In the plane x or path."""

    @property
    def ahead(self) -> tuple[float, float] | None:
        """Unit vector along `travel` on the ground; None for the path."""
        if self.travel == "path":
            return None
        x, y = {"x": (1.0, 0.0), "y": (0.0, 1.0)}[self.travel] if isinstance(self.travel, str) else self.travel
        return x / math.hypot(x, y), y / math.hypot(x, y)


class Scenario(Strict):
    """A complete run: all names of models and media are resolved, and all defaults are filled in."""

    name: Text | None = None
    """Name of the run. null: the name of the file without its suffix."""
    model: Model
    """The mechanism: bodies and joints."""
    medium: Media | None = None
    """The medium, or a list of media whose forces add. null: vacuum."""
    gravity_m_s2: float = 9.81
    """Gravitational acceleration; positive is downward."""
    surface_height_m: float | None = None
    """Height of the free surface above the origin of the world. null: the mechanism touches the surface at the start.
    Parts below the surface start with zero friction state, as if placed there without disturbing a grain."""
    bed: Bed | None = None
    """Slope or profile of the surface, floor, container and layers. null: a level surface, without floor and walls."""
    initial: Initial = Initial()
    """Initial state. A joint that is not named starts at rest in the reference configuration (home)."""
    drives: dict[str, Drive] = Field(default_factory=dict)
    """Torques, forces, prescribed motions and controllers of joints, by the name of the joint."""
    signals: dict[str, Signal] = Field(default_factory=dict)
    """Signals that several drives share, by name."""
    wheel: WheelRun | None = None
    """Slip or torque, and load, of a single wheel on a mechanism like models/wheel.yaml, in place of its drives. null:
    none; the only value in space."""
    load: Load = Load()
    """Computation of the forces of the medium."""
    solver: Solver = Solver()
    """End of the run, time steps and accuracy."""
    method: Method = Method()
    """Method of solution."""
    output: Output = Output()
    """Recorded rows and columns, and saved files."""

    def replace(self, values: Mapping[str, Any] | None = None, /, **changes: Unpack[Changes]) -> Scenario:
        """Return the run with other values.

        `replace({"medium.eta_d": 5, "model": "chain"})` and `replace(medium={"eta_d": 5})` are examples.

        The values are checked as those of `--set` are. A mapping changes only the keys that it names, unless it says
        its kind (`type`, `law` or `from`); then it replaces the whole mapping. None removes a key: a named entry such
        as `drives.hip` is gone, any other key is null where null is allowed, else it has its default again. A value is
        a number, text, None, list, mapping, array or a part of another scenario. Names of models and media are looked
        up; paths start from the working folder. A medium with a changed number no longer claims the provenance of its
        source.

        Parameters
        ----------
        values : mapping, optional
            Values by dotted key.
        **changes
            Values by the keys of a config.

        Returns
        -------
        Scenario

        Raises
        ------
        ConfigError
            With every fault, each with its key, what was got and what is allowed.
        """
        from granular_contact.config.changed import replaced  # (it imports this class)
        from granular_contact.config.given import merged

        return replaced(self, merged(values, changes))

    def __repr__(self) -> str:
        medium = " and ".join(law.name or law.law for law in self.media) or "vacuum"
        method = "" if self.method.name == "auto" else f", by {self.method.name}"
        return f"<scenario {self.name or self.model.name}: {medium}, {self.solver.end_time_s:g} s{method}>"

    def _repr_html_(self) -> str:
        import html

        from granular_contact.config.export import scenario_to_dict

        text = yaml.safe_dump(scenario_to_dict(self), sort_keys=False, default_flow_style=None, width=100)
        summary = f"<summary>{html.escape(repr(self)[1:-1])}</summary>"
        return f"<details>{summary}<pre>{html.escape(text)}</pre></details>"

    @property
    def media(self) -> tuple[Law, ...]:
        """The media of the top layer; empty in vacuum."""
        if self.medium is None:
            return ()
        return self.medium if isinstance(self.medium, tuple) else (self.medium,)

    @property
    def is_modal(self) -> bool:
        """Whether the modal engine solves the run, which is for models in the plane."""
        return self.method.reduced is not None

    @property
    def surface_height(self) -> float | None:
        """Height of the surface (m), from either key; None if it follows from the mechanism or is a profile."""
        bed_height = None if self.bed is None else self.bed.height_m
        return self.surface_height_m if bed_height is None else bed_height

    def _faults(self) -> Faults:
        yield from self._surface_faults()
        yield from self._mechanism_faults()
        reduced, friction = self.method.reduced if self.is_modal else None, self.load.friction.type
        if self.solver.accuracy is not None and reduced is not None:
            message = "chooses steps by their error; those of method.reduced are chosen by its rtol: allowed is null"
            yield ("solver", "accuracy"), message
        if reduced is not None and reduced.static not in ("auto", "true_sign", friction):
            allowed = f"allowed are auto, true_sign and {friction}"
            message = f"got {reduced.static}, but load.friction has the type {friction}: {allowed}"
            yield ("method", "reduced", "static"), message

    def _surface_faults(self) -> Faults:
        """A fault of two heights of the surface."""
        bed = self.bed
        if bed is not None and self.surface_height_m is not None and (bed.height_m, bed.profile_m) != (None, None):
            yield ("surface_height_m",), "the bed has height_m or profile_m too; one height of the surface is allowed"

    def _mechanism_faults(self) -> Faults:
        """Faults of the initial state, of drives and of the wheel, which depend on the mechanism."""
        yield from initial_faults(self.initial, self.model)
        yield from drive_faults(self.drives, self.signals, self.model)
        yield from wheel_faults(self.wheel, self.model, self.drives)
