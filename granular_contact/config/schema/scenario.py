"""Schema of a run: what moves, in what, from which start, and how it is computed and saved."""

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
    """How the resistance of the medium is applied to the mechanism."""

    form: Literal["distributed", "resultant"] = "distributed"
    """Along the immersed length, or one force in the middle of it."""
    end_cap: bool = False
    """Count the area of the free end in the drag."""
    strips_per_element: Annotated[int, Field(ge=1, le=64)] = 4
    strips_per_rigid_part: Annotated[int, Field(ge=1, le=1024)] = 16
    """Along a bar or a plate; the closed outline of a solid gets twice as many."""
    friction: Friction = Elastoplastic()


class Solver(Strict):
    """Time integration, and when it ends."""

    end_time_s: Positive = 0.5
    step_s: Positive | None = None
    """Fixed step; with accuracy the first one. null: 0.2 ms, and the steps are fixed or chosen, as suits the scene."""
    rest_time_s: Positive | None = 0.02
    """Stop once everything has been slower than rest_speed_m_s for this long; null: never. Not used with drives."""
    rest_speed_m_s: Positive = 1e-3
    accuracy: Annotated[float, Field(ge=1e-7, le=0.1)] | None = None
    """Choose the steps so that the estimated error of positions in a step is below this fraction of the distance that
    the fastest point travels in it. null: fixed steps where step_s is given, and for one body in the plane that nothing
    drives; else 1e-3. `run --explain` says which."""
    max_wall_s: Positive | None = None
    """Stop after this wall time, with the status time_limit; null: never."""
    spectral_radius: Annotated[float, Field(ge=0, le=1)] | None = None
    """Of the generalised-alpha method at high frequency: 1 no damping, 0 the most. null: 0.9, less with chosen steps or
    prescribed motions, and 0 where a link is so stiff that its elastic forces are below round-off."""
    tolerance: Annotated[float, Field(gt=0, lt=1)] | None = None
    """Largest residual of a step, relative to the forces of the scene. null: 1e-5; where steps are chosen a fiftieth
    of the accuracy in minimal coordinates, and at most that by the engine in the plane. In minimal coordinates also of
    changes of speed, relative to the fastest one so far. By the engine in the plane, what moves by forces far below its
    weight needs a smaller tolerance."""

    def _faults(self) -> Faults:
        if self.step_s is not None and self.step_s > self.end_time_s:
            yield ("step_s",), f"got {self.step_s:g}, which exceeds end_time_s, {self.end_time_s:g}"


Travel = (
    Annotated[Literal["x", "y", "path"], Tag("text")]
    | Annotated[Point, directed("a direction on the ground, as [0, 1] for y"), Tag("list")]
)


class Output(Strict):
    """What is saved."""

    interval_s: Positive | None = None
    """Time between rows of the table; null: every accepted step."""
    figures: bool = True
    bodies: Literal["auto", "all", "none"] = "auto"
    """Columns of the motion of every body. auto: where more than one joint moves or the ground joint is no hinge, and
    there are at most 32 bodies."""
    travel: Annotated[Travel, Discriminator(form)] = "x"
    """What distance, forward speed and cost of transport are taken along, by the common centre of mass: an axis of the
    world, a direction [x, y] on the ground, or its path seen from above. In the plane x or path."""

    @property
    def ahead(self) -> tuple[float, float] | None:
        """Unit vector of `travel` on the ground; None for the path."""
        if self.travel == "path":
            return None
        x, y = {"x": (1.0, 0.0), "y": (0.0, 1.0)}[self.travel] if isinstance(self.travel, str) else self.travel
        return x / math.hypot(x, y), y / math.hypot(x, y)


class Scenario(Strict):
    """A run, complete: every name resolved and every default in place."""

    name: Text | None = None
    """null: the name of the file, without its suffix."""
    model: Model
    """The mechanism: bodies and joints."""
    medium: Media | None = None
    """null: vacuum; of several media in a list the forces add."""
    gravity_m_s2: float = 9.81
    """Positive is downward."""
    surface_height_m: float | None = None
    """Height of the free surface above the origin; null: the mechanism touches the surface at the start. Parts below it
    start in the medium with zero friction state, as if placed there without disturbing a grain."""
    bed: Bed | None = None
    """Slope or profile of the surface, floor, container and layers; null: level and unbounded."""
    initial: Initial = Initial()
    """Joints left out start at rest in the reference configuration, their home."""
    drives: dict[str, Drive] = Field(default_factory=dict)
    """What acts at joints over time, by the name of the joint."""
    signals: dict[str, Signal] = Field(default_factory=dict)
    """Signals that several drives share, by a name."""
    wheel: WheelRun | None = None
    """Slip or torque, and load, of the wheel of a mechanism as models/wheel.yaml, in place of its drives."""
    load: Load = Load()
    """How the forces of the medium are computed."""
    solver: Solver = Solver()
    """End of the run, time steps, accuracy."""
    method: Method = Method()
    """Which method of solution is taken."""
    output: Output = Output()
    """What is recorded and saved."""

    def replace(self, values: Mapping[str, Any] | None = None, /, **changes: Unpack[Changes]) -> Scenario:
        """The run with other values: `replace({"medium.eta_d": 5, "model": "chain"})`, `replace(medium={"eta_d": 5})`.

        Checked as `--set` is. A medium with a changed number no longer says that it is what its source published. Of a
        mapping only the keys that it names are changed, unless it says its kind (`type`, `law` or `from`).
        None takes a key away: a name as `drives.hip` is gone, any other key has its default again, or is null where it
        may be.
        Values: numbers, texts, None, lists, mappings, arrays and parts of other scenarios; names of models and media
        are looked up, paths are from the working folder.

        Parameters
        ----------
        values : mapping, optional
            Values by dotted key.
        **changes
            The same by the keys of a config.

        Returns
        -------
        Scenario

        Raises
        ------
        ConfigError
            With every fault, each with its key, what was got and what is allowed.
        """
        from granular_contact.config.changed import replaced  # which needs this class
        from granular_contact.config.given import merged

        return replaced(self, merged(values, changes))

    def __repr__(self) -> str:
        medium = " and ".join(law.name or law.law for law in self.media) or "vacuum"
        how = "" if self.method.name == "auto" else f", by {self.method.name}"
        return f"<scenario {self.name or self.model.name}: {medium}, {self.solver.end_time_s:g} s{how}>"

    def _repr_html_(self) -> str:
        import html

        from granular_contact.config.export import scenario_to_dict

        text = yaml.safe_dump(scenario_to_dict(self), sort_keys=False, default_flow_style=None, width=100)
        words = f"<summary>{html.escape(repr(self)[1:-1])}</summary>"
        return f"<details>{words}<pre>{html.escape(text)}</pre></details>"

    @property
    def media(self) -> tuple[Law, ...]:
        """The media on top of the bed; none in vacuum."""
        if self.medium is None:
            return ()
        return self.medium if isinstance(self.medium, tuple) else (self.medium,)

    @property
    def is_modal(self) -> bool:
        """Whether it is solved by the modal engine, which is of the plane."""
        return self.method.reduced is not None

    @property
    def surface_height(self) -> float | None:
        """Height of the surface (m) by either key; None of one that goes with the mechanism, or is a profile."""
        of_bed = None if self.bed is None else self.bed.height_m
        return self.surface_height_m if of_bed is None else of_bed

    def _faults(self) -> Faults:
        yield from self._surface_faults()
        yield from self._mechanism_faults()
        reduced, has = self.method.reduced if self.is_modal else None, self.load.friction.type
        if self.solver.accuracy is not None and reduced is not None:
            words = "chooses steps by their error; those of method.reduced are chosen by its rtol: allowed is null"
            yield ("solver", "accuracy"), words
        if reduced is not None and reduced.static not in ("auto", "true_sign", has):
            allowed = f"allowed are auto, true_sign and {has}"
            words = f"got {reduced.static}, but load.friction has the type {has}: {allowed}"
            yield ("method", "reduced", "static"), words

    def _surface_faults(self) -> Faults:
        bed = self.bed
        if bed is not None and self.surface_height_m is not None and (bed.height_m, bed.profile_m) != (None, None):
            yield ("surface_height_m",), "the bed has height_m or profile_m too; one height of the surface is allowed"

    def _mechanism_faults(self) -> Faults:
        yield from initial_faults(self.initial, self.model)
        yield from drive_faults(self.drives, self.signals, self.model)
        yield from wheel_faults(self.wheel, self.model, self.drives)
