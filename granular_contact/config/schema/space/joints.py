"""Schema of joints in space. As in the plane, each type has two names: that of this package and that of robotics.

A joint connects a point of the child to a point of the parent. Its axis is fixed in the frame of the child. rpy_deg or
quaternion is the orientation of the child's frame in the parent's frame at coordinate 0. A joint of a URDF file is the
same with child_point_m = 0; its origin is parent_point_m and rpy_deg. The coordinate of a hinge turns the child
right-handed about the axis.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from granular_contact.config.schema.joints import (
    HingeForces,
    OrSynonym,
    SliderForces,
    by_name,
)
from granular_contact.config.schema.space.turned import ORIGIN, Axis, Oriented, Point3
from granular_contact.values.strict import Faults, NotNegative, Positive, Strict, Tagged

_TURN = "rpy_deg", "quaternion"


class _Ends(Oriented):
    parent: str
    """Name of the parent body, or `ground`."""
    child: str
    """Name of the child body. Each body is the child of exactly one joint; closures do not count."""
    start_keys: ClassVar[tuple[str, ...]] = ()  # keys of its initial state, see `SpatialJointStart`
    parent_point_m: Point3 = ORIGIN
    """Position of the joint, x, y and z in the frame of the parent."""
    child_point_m: Point3 = ORIGIN
    """Position of the joint, x, y and z in the frame of the child."""
    type: str
    """Kind of the joint, see `schema.joints`."""


class SpatialHingeClosure(HingeForces, _Ends):
    """The child turns about an axis."""

    type: Annotated[Literal["hinge"], OrSynonym()]
    axis: Axis = (0.0, 0.0, 1.0)
    """Direction of the axis in the frame of the child, of any length."""


class SpatialHinge(SpatialHingeClosure):
    """The child turns about an axis."""

    start_keys = "angle_deg", "rate_rad_s"
    home_deg: float = 0.0
    """Angle of the child in the reference configuration, right-handed about the axis. A run starts there unless
    `initial` gives another angle."""


class SpatialWeld(_Ends):
    """The child is fixed to the parent."""

    type: Annotated[Literal["weld"], OrSynonym()]


class BallSpring(Strict):
    """Torsional spring: torque towards the home orientation, proportional to the angle of the rotation from home."""

    stiffness_Nm_per_rad: Positive
    """Torque per angle of the rotation from home."""


class BallStops(Strict):
    """Limit of the rotation, as a spring with damping after Hunt and Crossley that acts beyond the limit.

    Torque = stiffness x angle beyond the limit x (1 + dissipation x rate at which this angle grows). It only pushes
    back.
    """

    upper_deg: Annotated[float, Field(gt=0.0, lt=180.0)]
    """Largest angle of the rotation from home, about any axis, before the stop acts."""
    stiffness_Nm_per_rad: Positive
    """Torque per angle beyond the limit, in slow motion."""
    dissipation_s_per_rad: NotNegative = 0.0
    """Factor of the rate in the torque; 0: the stop dissipates nothing."""


class Ball(_Ends):
    """The child rotates freely about a point of the parent."""

    type: Annotated[Literal["ball"], OrSynonym()]
    start_keys = *_TURN, "spin_rad_s"
    spring: BallSpring | None = None
    """Torsional spring towards the home orientation; null: none."""
    damping_Nm_s_per_rad: NotNegative = 0.0
    """Viscous damping: torque per angular velocity relative to the parent, about any axis."""
    stops: BallStops | None = None
    """Limit of the rotation from home; null: none."""


class SpatialSliderClosure(SliderForces, _Ends):
    """The child moves along an axis, and does not rotate against the parent."""

    type: Annotated[Literal["slider"], OrSynonym()]
    axis: Axis = (1.0, 0.0, 0.0)
    """Direction of the axis in the frame of the child, of any length."""


class SpatialSlider(SpatialSliderClosure):
    """The child moves along an axis, and does not rotate against the parent."""

    start_keys = "position_m", "speed_m_s"
    home_m: float = 0.0
    """Position along the axis in the reference configuration. A run starts there unless `initial` gives another
    position."""


class SpatialFree(_Ends):
    """The child moves freely. `initial.joints` of the run gives its initial state."""

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
