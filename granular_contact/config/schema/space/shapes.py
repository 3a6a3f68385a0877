"""Schema of the shapes of bodies in space: their mass, and the surfaces or lines on which the medium acts.

The keys name SI units.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from granular_contact.config.schema.shapes import (
    Grousers,
    corner_faults,
    grouser_faults,
    opening_faults,
    outline_faults,
)
from granular_contact.config.schema.space.turned import ORIGIN, Oriented, Point3
from granular_contact.values.strict import (
    Faults,
    Listed,
    OneOrMore,
    Point,
    Positive,
    Strict,
    Tagged,
    Text,
    by_type,
    refusal,
)

Pair = Annotated[tuple[Positive, Positive], Listed]
Triple = Annotated[tuple[Positive, Positive, Positive], Listed]


class _Shape(Oriented):
    in_sand: bool = True
    """true: the medium acts on the shape; false: the shape only has mass and is drawn."""
    facet_size_m: Positive | None = None
    """Longest edge of the facets on which the medium acts. null: chosen by the estimated error of the motion."""
    center_m: Point3 = ORIGIN
    """Origin of the shape's own frame, x, y and z in the frame of the body."""


class SpatialBox(_Shape):
    """A box with its centre at the origin of its own frame, and its edges along the axes."""

    type: Literal["box"]
    size_m: Triple
    """Lengths of the edges along x, y and z."""


class SpatialSphere(_Shape):
    """A ball with its centre at the origin of its own frame."""

    type: Literal["sphere"]
    diameter_m: Positive
    """Diameter."""


class _Round(_Shape):
    diameter_m: Positive
    """Diameter."""
    length_m: Positive | None = None
    """Length along the axis; with an orientation. Or give start_m and end_m."""
    start_m: Point3 | None = None
    """First end of the axis, x, y and z in the frame of the body. With end_m, it replaces length_m, center_m and the
    orientation."""
    end_m: Point3 | None = None
    """Second end of the axis, x, y and z in the frame of the body."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        if self.start_m is None and self.end_m is None:
            if self.length_m is None:
                yield ("length_m",), "is missing; allowed is a number above 0, or else start_m and end_m"
            return
        for end, other in (("start_m", "end_m"), ("end_m", "start_m")):
            if getattr(self, end) is None:
                yield (end,), f"is missing; {other} needs it"
        given = [key for key in ("length_m", "rpy_deg", "quaternion") if getattr(self, key) is not None]
        for key in (*given, "center_m") if self.center_m != ORIGIN else given:
            yield (key,), "stands beside start_m and end_m, from which it follows"
        if self.start_m == self.end_m:
            yield ("end_m",), f"got {list(self.end_m or ())}, the same as start_m; the two must differ"


class SpatialCylinder(_Round):
    """A cylinder along the z axis of its own frame with its centre at the origin; or from start_m to end_m."""

    type: Literal["cylinder"]


class SpatialCapsule(_Round):
    """A cylinder with half spheres at both ends. Its length is the distance between their centres."""

    type: Literal["capsule"]


class SpatialCone(_Shape):
    """A cone along the z axis of its own frame: its tip is at the origin, its base at z = height."""

    type: Literal["cone"]
    diameter_m: Positive
    """Diameter of the base."""
    height_m: Positive
    """Distance from the tip to the base."""


class SpatialPlate(_Shape):
    """A thin rectangular plate in the x-y plane of its own frame, with its centre at the origin.

    The medium acts on either face.
    """

    type: Literal["plate"]
    size_m: Pair
    """Lengths of the edges along x and y."""
    thickness_m: Positive
    """Thickness, for the mass alone."""


class SpatialArc(_Shape):
    """A thin plate along a circular arc in the x-z plane of its own frame, for example a C-leg.

    The centre of the circle is at the origin. The medium acts on either face.
    """

    type: Literal["arc"]
    radius_m: Positive
    """Radius of the middle of the thickness."""
    from_deg: Annotated[float, Field(ge=-720, le=720)]
    """Angle at which the arc begins, from the x axis towards -z: 90 is below the centre."""
    to_deg: Annotated[float, Field(ge=-720, le=720)]
    """Angle at which the arc ends. It may be smaller or larger than from_deg."""
    width_m: Positive
    """Width along y, half of it on either side of the origin."""
    thickness_m: Positive
    """Thickness, for the mass alone."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from opening_faults(self.from_deg, self.to_deg)


class SpatialPolygon(_Shape):
    """A solid with a polygon in the x-z plane of its own frame as its cross-section, extruded along y."""

    type: Literal["polygon"]
    points_m: Annotated[tuple[Point, ...], Listed, Field(min_length=3, max_length=1000)]
    """Corners x, z, clockwise or counter-clockwise. The last corner connects to the first."""
    width_m: Positive
    """Width along y, half of it on either side of the origin."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from outline_faults(self.points_m)


class SpatialWheel(_Shape):
    """A wheel with its axle along y of its own frame, smooth or with grousers.

    The results contain its slip and its forces.
    """

    type: Literal["wheel"]
    radius_m: Positive
    """Radius of the rim, without grousers."""
    width_m: Positive
    """Width along y, half of it on either side of the origin."""
    grousers: Grousers | None = None
    """Grousers on the rim. null: a smooth wheel."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from grouser_faults(self.radius_m, self.grousers)


class SpatialBar(Strict):
    """A thin round bar along straight pieces, for laws of bars."""

    type: Literal["bar"]
    in_sand: bool = True
    """true: the medium acts on the bar; false: the bar only has mass and is drawn."""
    points_m: Annotated[tuple[Point3, ...], Listed, Field(min_length=2, max_length=1000)]
    """Corners x, y, z of the centre line, in the frame of the body."""
    diameter_m: Positive
    """Diameter."""

    def _faults(self) -> Faults:
        return corner_faults(self.points_m)


def _scales(scale: float | tuple[float, ...]) -> float | tuple[float, ...]:
    """Refuse a scale that is not above 0, or three scales one of which is 0; return it unchanged otherwise."""
    if isinstance(scale, tuple):
        if len(scale) != 3 or 0.0 in scale:
            raise refusal([((), f"got {list(scale)}; allowed is a number above 0, or three that are not 0")])
    elif scale <= 0.0:
        raise refusal([((), f"got {scale:g}; allowed is a number above 0, or three that are not 0")])
    return scale


class SpatialMesh(_Shape):
    """A mesh of triangles from a file: STL, OBJ or PLY."""

    type: Literal["mesh"]
    file: Text
    """Path of the mesh file, relative to the folder of the file with this key."""
    scale: Annotated[tuple[float, ...], OneOrMore(), AfterValidator(_scales)] | None = None
    """Length of the file's unit in m (0.001 for millimetres), or a list of three, one for each axis; a negative one
    mirrors the mesh. null: the file is in metres, and a mesh larger than 3 m is refused."""
    thin: bool = False
    """true: the mesh is a thin sheet, which need not be closed; the medium acts on either face."""
    thickness_m: Positive | None = None
    """Thickness of a thin sheet, for the mass alone."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        if self.thickness_m is not None and not self.thin:
            yield ("thickness_m",), f"got {self.thickness_m:g}, but thin is false: allowed is nothing"


SHAPES = by_type(
    *(SpatialBox, SpatialCylinder, SpatialCapsule, SpatialSphere, SpatialCone, SpatialPlate, SpatialArc),
    *(SpatialPolygon, SpatialWheel, SpatialBar, SpatialMesh),
)
SpatialShape = Annotated[_Shape | SpatialBar, Tagged("type", SHAPES)]
