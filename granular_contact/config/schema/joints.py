"""Schema of joints in the plane: the relative motion that a joint allows, and the forces that act in it.

Each type has two names, the name of this package and the name in robotics: hinge or revolute, slider or prismatic,
weld or fixed, free or floating. A config may use either; a scenario holds the name of this package.

The results have a column for the coordinate of each joint. All angles are positive clockwise (see models/README.md).
The coordinate of a hinge is the angle of the child, measured from the x axis of the parent (on the ground: below the
horizontal). The coordinate of a slider is the position along its axis.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from granular_contact.values.strict import Faults, NotNegative, Point, Positive, Strict, Tagged, by_type, directed

# Name of a type of joints in robotics -> name in this package.
SYNONYMS = {"revolute": "hinge", "prismatic": "slider", "fixed": "weld", "floating": "free"}
IN_SPACE = {"spherical": "ball"}
_NOUNS = "hinge", "slider", "weld"  # types whose name is a noun; the others take "joint" behind them


def joint_of(kind: str) -> str:
    """Name of a type of joints in messages: hinge, ball joint."""
    return kind if kind in _NOUNS else f"{kind} joint"


def joints_of(kinds: Iterable[str]) -> str:
    """Names of several types of joints in messages: hinges, sliders and ball joints."""
    *first, last = (f"{joint_of(kind)}s" for kind in kinds)
    return f"{', '.join(first)} and {last}"


class OrSynonym:
    """Marker of the type of a joint: the name in robotics is accepted, and replaced by the name of this package."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Core schema that accepts both names."""
        del handler
        (name,) = get_args(source)
        accepted = [name, *(synonym for synonym, kind in (SYNONYMS | IN_SPACE).items() if kind == name)]
        return core_schema.no_info_after_validator_function(lambda _: name, core_schema.literal_schema(accepted))


class _Ends(Strict):
    parent: str
    """Name of the parent body, or `ground`."""
    child: str
    """Name of the child body. Each body is the child of exactly one joint; closures do not count."""
    start_keys: ClassVar[tuple[str, ...]] = ()  # keys of its initial state, see `JointStart`
    parent_point_m: Point = (0.0, 0.0)
    """Position of the joint, x and y in the frame of the parent."""
    child_point_m: Point = (0.0, 0.0)
    """Position of the joint, x and y in the frame of the child."""
    type: str
    """Kind of the joint, of which each class allows one; here, so that it stands before the forces in files."""


class HingeSpring(Strict):
    """Linear torsional spring: torque = -stiffness (angle - rest angle)."""

    stiffness_Nm_per_rad: Positive
    """Torque per angle."""
    rest_deg: float = 0.0
    """Angle of the joint at which the torque is zero."""


class HingeStops(Strict):
    """Limits of the angle, as springs with damping after Hunt and Crossley that act beyond the limits.

    Torque = stiffness x angle beyond the limit x (1 + dissipation x rate at which this angle grows). It only pushes
    back.
    """

    lower_deg: float
    """Smallest angle before the stop acts."""
    upper_deg: float
    """Largest angle before the stop acts."""
    stiffness_Nm_per_rad: Positive
    """Torque per angle beyond the limit, in slow motion."""
    dissipation_s_per_rad: NotNegative = 0.0
    """Factor of the rate in the torque; 0: the stop dissipates nothing."""

    def _faults(self) -> Faults:
        if self.lower_deg >= self.upper_deg:
            yield ("lower_deg",), f"got {self.lower_deg:g}; allowed is below upper_deg, {self.upper_deg:g}"


class HingeFriction(Strict):
    """Dry friction that can hold a load at rest: an elastic bristle that slides once the torque reaches its limit."""

    torque_Nm: Positive
    """Friction torque while the joint slides, the limit at rest too."""
    slip_deg: Positive = 0.01
    """Deflection of the bristle at which it begins to slide."""
    damping_time_s: NotNegative = 1e-3
    """Damping coefficient of the bristle over its stiffness; it suppresses vibration of the bristle."""


class HingeForces(Strict):
    """Forces in a hinge, and the limits of its actuator."""

    spring: HingeSpring | None = None
    """Torsional spring between parent and child; null: none."""
    damping_Nm_s_per_rad: NotNegative = 0.0
    """Viscous damping: torque per rate of the joint."""
    stops: HingeStops | None = None
    """Limits of the angle; null: none."""
    friction: HingeFriction | None = None
    """Dry friction; null: none."""
    effort_limit_Nm: Positive | None = None
    """Greatest torque of the actuator in either direction. A run in which the drive needs more has a warning; the
    torque is not limited (`limit_Nm` of a drive does that). null: not known."""
    rate_limit_rad_s: Positive | None = None
    """Greatest rate of the actuator in either direction. A run in which the joint turns faster while it is driven has a
    warning; the rate is not limited. null: not known."""


class HingeClosure(HingeForces, _Ends):
    """The child turns about the normal of the plane of motion."""

    type: Annotated[Literal["hinge"], OrSynonym()]


class Hinge(HingeClosure):
    """The child turns about the normal of the plane of motion."""

    start_keys = "angle_deg", "rate_rad_s"
    home_deg: float = 0.0
    """Angle of the child in the reference configuration, clockwise from the x axis of the parent. A run starts there
    unless `initial` gives another angle."""


class Weld(_Ends):
    """The child is fixed to the parent."""

    type: Annotated[Literal["weld"], OrSynonym()]
    home_deg: float = 0.0
    """Angle of the child, clockwise from the x axis of the parent."""


class SliderSpring(Strict):
    """Linear spring along the axis: force = -stiffness (position - rest position)."""

    stiffness_N_per_m: Positive
    """Force per displacement."""
    rest_m: float = 0.0
    """Position of the joint at which the force is zero."""


class SliderStops(Strict):
    """Limits of the position, as springs with damping after Hunt and Crossley that act beyond the limits.

    Force = stiffness x distance beyond the limit x (1 + dissipation x speed at which this distance grows). It only
    pushes back.
    """

    lower_m: float
    """Smallest position before the stop acts."""
    upper_m: float
    """Largest position before the stop acts."""
    stiffness_N_per_m: Positive
    """Force per distance beyond the limit, in slow motion."""
    dissipation_s_per_m: NotNegative = 0.0
    """Factor of the speed in the force; 0: the stop dissipates nothing."""

    def _faults(self) -> Faults:
        if self.lower_m >= self.upper_m:
            yield ("lower_m",), f"got {self.lower_m:g}; allowed is below upper_m, {self.upper_m:g}"


class SliderFriction(Strict):
    """Dry friction that can hold a load at rest: an elastic bristle that slides once the force reaches its limit."""

    force_N: Positive
    """Friction force while the joint slides, the limit at rest too."""
    slip_m: Positive = 1e-5
    """Deflection of the bristle at which it begins to slide."""
    damping_time_s: NotNegative = 1e-3
    """Damping coefficient of the bristle over its stiffness; it suppresses vibration of the bristle."""


class SliderForces(Strict):
    """Forces in a slider, and the limits of its actuator."""

    spring: SliderSpring | None = None
    """Spring along the axis; null: none."""
    damping_N_s_per_m: NotNegative = 0.0
    """Viscous damping: force per speed of the joint."""
    stops: SliderStops | None = None
    """Limits of the position; null: none."""
    friction: SliderFriction | None = None
    """Dry friction; null: none."""
    effort_limit_N: Positive | None = None
    """Greatest force of the actuator in either direction. A run in which the drive needs more has a warning; the force
    is not limited (`limit_N` of a drive does that). null: not known."""
    speed_limit_m_s: Positive | None = None
    """Greatest speed of the actuator in either direction. A run in which the joint moves faster while it is driven has
    a warning; the speed is not limited. null: not known."""


class SliderClosure(SliderForces, _Ends):
    """The child moves along an axis that is fixed in the parent, and does not rotate against the parent."""

    type: Annotated[Literal["slider"], OrSynonym()]
    axis: Annotated[Point, directed("a direction, as [0, 1] for upward")] = (1.0, 0.0)
    """Direction of the axis, x and y in the frame of the parent, of any length; on the ground [0, 1] is up."""
    home_deg: float = 0.0
    """Constant angle of the child, clockwise from the x axis of the parent."""


class Slider(SliderClosure):
    """The child moves along an axis that is fixed in the parent, and does not rotate against the parent."""

    start_keys = "position_m", "speed_m_s"
    home_m: float = 0.0
    """Position along the axis in the reference configuration. A run starts there unless `initial` gives another
    position."""


class Free(_Ends):
    """The child moves freely in the plane. `initial.joints` of the run gives its initial state."""

    type: Annotated[Literal["free"], OrSynonym()]
    start_keys = "x_m", "y_m", "angle_deg", "vx_m_s", "vy_m_s", "rate_rad_s"

    def _faults(self) -> Faults:
        if self.parent != "ground":
            yield ("parent",), f"got {self.parent!r}; a free joint has the parent ground"


def by_name(*classes: type[Strict]) -> dict[str, type[Strict]]:
    """Classes by the name of their type in this package and by its name in robotics."""
    types = by_type(*classes)
    return types | {synonym: types[name] for synonym, name in (SYNONYMS | IN_SPACE).items() if name in types}


JOINTS = by_name(Hinge, Weld, Slider, Free)
MOVABLE = "hinge", "slider", "free"  # types of joints with an initial state
Joint = Annotated[Hinge | Weld | Slider | Free, Tagged("type", JOINTS)]
CLOSURES = by_name(HingeClosure, Weld, SliderClosure)
Closure = Annotated[HingeClosure | Weld | SliderClosure, Tagged("type", CLOSURES)]
