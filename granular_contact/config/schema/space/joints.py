"""Schema of joints in space. Each type has two names, ours and that of robotics, as in the plane.

A joint holds a point of the child at a point of the parent. Its axis is fixed in the child's frame, and rpy_deg or
quaternion turn that frame against the parent's at coordinate 0: as a joint of a URDF file, with its origin there and
the child's point at the origin. The coordinate of a hinge turns the child right-handed about the axis.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from granular_contact.config.schema.joints import (
    HingeFriction,
    HingeSpring,
    HingeStops,
    OrSynonym,
    SliderFriction,
    SliderSpring,
    SliderStops,
    by_name,
)
from granular_contact.config.schema.space.turned import ORIGIN, Axis, Oriented, Point3
from granular_contact.values.strict import Faults, NotNegative, Positive, Strict, Tagged

_TURN = "rpy_deg", "quaternion"


class _Ends(Oriented):
    parent: str
    """A body, or `ground`."""
    child: str
    """A body; each is the child of exactly one joint, besides the closures of loops."""
    start_keys: ClassVar[tuple[str, ...]] = ()  # of its state at the start, see `SpatialJointStart`
    parent_point_m: Point3 = ORIGIN
    """Where the joint sits in the frame of the parent."""
    child_point_m: Point3 = ORIGIN
    """Where the joint sits in the frame of the child."""


class SpatialHingeClosure(_Ends):
    """The child turns about an axis."""

    type: Annotated[Literal["hinge"], OrSynonym()]
    axis: Axis = (0.0, 0.0, 1.0)
    """Direction of the axis in the frame of the child, of any length."""
    spring: HingeSpring | None = None
    damping_Nm_s_per_rad: NotNegative = 0.0
    stops: HingeStops | None = None
    friction: HingeFriction | None = None


class SpatialHinge(SpatialHingeClosure):
    """The child turns about an axis."""

    start_keys = "angle_deg", "rate_rad_s"
    home_deg: float = 0.0
    """Angle at the start, unless the run says otherwise; right-handed about the axis."""


class SpatialWeld(_Ends):
    """The child is held."""

    type: Annotated[Literal["weld"], OrSynonym()]


class BallSpring(Strict):
    """Torsional spring towards the orientation at home, in proportion to the angle of the rotation from there."""

    stiffness_Nm_per_rad: Positive


class BallStops(Strict):
    """End of the range: a spring beyond it, stiffness x (1 + dissipation x rate), after Hunt-Crossley."""

    upper_deg: Annotated[float, Field(gt=0.0, lt=180.0)]
    """Greatest angle of the rotation from home, whatever its axis."""
    stiffness_Nm_per_rad: Positive
    dissipation_s_per_rad: NotNegative = 0.0


class Ball(_Ends):
    """The child turns as it likes about a point."""

    type: Annotated[Literal["ball"], OrSynonym()]
    start_keys = *_TURN, "spin_rad_s"
    spring: BallSpring | None = None
    damping_Nm_s_per_rad: NotNegative = 0.0
    """Of the angular velocity relative to the parent, about any axis."""
    stops: BallStops | None = None


class SpatialSliderClosure(_Ends):
    """The child moves along an axis, and does not turn."""

    type: Annotated[Literal["slider"], OrSynonym()]
    axis: Axis = (1.0, 0.0, 0.0)
    """Direction of the axis in the frame of the child, of any length."""
    spring: SliderSpring | None = None
    damping_N_s_per_m: NotNegative = 0.0
    stops: SliderStops | None = None
    friction: SliderFriction | None = None


class SpatialSlider(SpatialSliderClosure):
    """The child moves along an axis, and does not turn."""

    start_keys = "position_m", "speed_m_s"
    home_m: float = 0.0
    """Position along the axis at the start, unless the run says otherwise."""


class SpatialFree(_Ends):
    """The child moves freely; `initial.joints` of the run gives its initial state."""

    type: Annotated[Literal["free"], OrSynonym()]
    start_keys = "x_m", "y_m", "z_m", *_TURN, "vx_m_s", "vy_m_s", "vz_m_s", "spin_rad_s"

    def _faults(self) -> Faults:
        if self.parent != "ground":
            yield ("parent",), f"got {self.parent!r}; a free joint has the parent ground"


JOINTS = by_name(SpatialHinge, SpatialWeld, SpatialSlider, Ball, SpatialFree)
AnyJoint = SpatialHinge | SpatialWeld | SpatialSlider | Ball | SpatialFree
SpatialJoint = Annotated[AnyJoint, Tagged("type", JOINTS)]
CLOSURES = by_name(SpatialHingeClosure, SpatialWeld, SpatialSliderClosure, Ball)
AnyClosure = SpatialHingeClosure | SpatialWeld | SpatialSliderClosure | Ball
SpatialClosure = Annotated[AnyClosure, Tagged("type", CLOSURES)]
