"""Schema of joints: how two bodies move against each other in the plane, and what acts between them there.

Each type has two names, ours and that of robotics: hinge or revolute, slider or prismatic, weld or fixed, free or
floating. Scenarios have ours.

The coordinate of a joint is what its column in the results shows. All angles turn clockwise (see models/README.md):
that of a hinge is the child's below the x axis of the parent, on the ground below the horizontal. A slider grows along
its axis.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from granular_contact.values.strict import Faults, NotNegative, Point, Positive, Strict, Tagged, by_type, directed

# The words of robotics for types of joints, and ours.
SYNONYMS = {"revolute": "hinge", "prismatic": "slider", "fixed": "weld", "floating": "free"}
IN_SPACE = {"spherical": "ball"}
_NOUNS = "hinge", "slider", "weld"  # types that are nouns by themselves


def joint_of(kind: str) -> str:
    """Name of a type of joints in messages: hinge, ball joint."""
    return kind if kind in _NOUNS else f"{kind} joint"


def joints_of(kinds: Iterable[str]) -> str:
    """Names of several types of joints in messages: hinges, sliders and ball joints."""
    *first, last = (f"{joint_of(kind)}s" for kind in kinds)
    return f"{', '.join(first)} and {last}"


class OrSynonym:
    """Marks the type of a joint: its synonym is accepted, and replaced by the name."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Core schema of both words."""
        del handler
        (name,) = get_args(source)
        words = [name, *(synonym for synonym, of in (SYNONYMS | IN_SPACE).items() if of == name)]
        return core_schema.no_info_after_validator_function(lambda _: name, core_schema.literal_schema(words))


class _Ends(Strict):
    parent: str
    """A body, or `ground`."""
    child: str
    """A body; each is the child of exactly one joint, besides the closures of loops."""
    start_keys: ClassVar[tuple[str, ...]] = ()  # of its state at the start, see `JointStart`
    parent_point_m: Point = (0.0, 0.0)
    """Where the joint sits in the frame of the parent."""
    child_point_m: Point = (0.0, 0.0)
    """Where the joint sits in the frame of the child."""


class HingeSpring(Strict):
    """Linear torsional spring."""

    stiffness_Nm_per_rad: Positive
    rest_deg: float = 0.0


class HingeStops(Strict):
    """Ends of the range: springs beyond them, stiffness x (1 + dissipation x rate), after Hunt-Crossley."""

    lower_deg: float
    upper_deg: float
    stiffness_Nm_per_rad: Positive
    dissipation_s_per_rad: NotNegative = 0.0

    def _faults(self) -> Faults:
        if self.lower_deg >= self.upper_deg:
            yield ("lower_deg",), f"got {self.lower_deg:g}; allowed is below upper_deg, {self.upper_deg:g}"


class HingeFriction(Strict):
    """Dry friction that can hold a load at rest: a spring (a bristle) that slides at its limit."""

    torque_Nm: Positive
    slip_deg: Positive = 0.01
    """Angle at which it slips."""
    damping_time_s: NotNegative = 1e-3
    """Damping time of the bristle, which suppresses its vibration."""


class HingeClosure(_Ends):
    """The child turns about the normal of the plane."""

    type: Annotated[Literal["hinge"], OrSynonym()]
    spring: HingeSpring | None = None
    damping_Nm_s_per_rad: NotNegative = 0.0
    stops: HingeStops | None = None
    friction: HingeFriction | None = None


class Hinge(HingeClosure):
    """The child turns about the normal of the plane."""

    start_keys = "angle_deg", "rate_rad_s"
    home_deg: float = 0.0
    """Angle at the start, unless the run says otherwise; clockwise, from the x axis of the parent."""


class Weld(_Ends):
    """The child is held at a fixed angle."""

    type: Annotated[Literal["weld"], OrSynonym()]
    home_deg: float = 0.0
    """The angle of the child, clockwise, from the x axis of the parent."""


class SliderSpring(Strict):
    """Linear spring along the axis."""

    stiffness_N_per_m: Positive
    rest_m: float = 0.0


class SliderStops(Strict):
    """Ends of the range: springs beyond them, stiffness x (1 + dissipation x speed), after Hunt-Crossley."""

    lower_m: float
    upper_m: float
    stiffness_N_per_m: Positive
    dissipation_s_per_m: NotNegative = 0.0

    def _faults(self) -> Faults:
        if self.lower_m >= self.upper_m:
            yield ("lower_m",), f"got {self.lower_m:g}; allowed is below upper_m, {self.upper_m:g}"


class SliderFriction(Strict):
    """Dry friction that can hold a load at rest: a spring (a bristle) that slides at its limit."""

    force_N: Positive
    slip_m: Positive = 1e-5
    """Displacement at which it slips."""
    damping_time_s: NotNegative = 1e-3
    """Damping time of the bristle, which suppresses its vibration."""


class SliderClosure(_Ends):
    """The child moves along an axis that is fixed in the parent, and does not turn."""

    type: Annotated[Literal["slider"], OrSynonym()]
    axis: Annotated[Point, directed("a direction, as [0, 1] for upward")] = (1.0, 0.0)
    """Direction of the axis, x and y in the frame of the parent, of any length; [0, 1] on the ground is up."""
    home_deg: float = 0.0
    """The angle of the child, clockwise, from the x axis of the parent, at which it stays."""
    spring: SliderSpring | None = None
    damping_N_s_per_m: NotNegative = 0.0
    stops: SliderStops | None = None
    friction: SliderFriction | None = None


class Slider(SliderClosure):
    """The child moves along an axis that is fixed in the parent, and does not turn."""

    start_keys = "position_m", "speed_m_s"
    home_m: float = 0.0
    """Position along the axis at the start, unless the run says otherwise."""


class Free(_Ends):
    """The child moves freely in the plane; `initial.joints` of the run gives its initial state."""

    type: Annotated[Literal["free"], OrSynonym()]
    start_keys = "x_m", "y_m", "angle_deg", "vx_m_s", "vy_m_s", "rate_rad_s"

    def _faults(self) -> Faults:
        if self.parent != "ground":
            yield ("parent",), f"got {self.parent!r}; a free joint has the parent ground"


def by_name(*classes: type[Strict]) -> dict[str, type[Strict]]:
    """Classes by both names of each type."""
    types = by_type(*classes)
    return types | {synonym: types[name] for synonym, name in (SYNONYMS | IN_SPACE).items() if name in types}


JOINTS = by_name(Hinge, Weld, Slider, Free)
MOVABLE = "hinge", "slider", "free"  # that have a state at the start
Joint = Annotated[Hinge | Weld | Slider | Free, Tagged("type", JOINTS)]
CLOSURES = by_name(HingeClosure, Weld, SliderClosure)
Closure = Annotated[HingeClosure | Weld | SliderClosure, Tagged("type", CLOSURES)]
