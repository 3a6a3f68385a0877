"""Schema of the shapes of bodies in space: mass, outside, and what the medium meets. SI units, named in the keys."""

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
    """Whether the medium acts on it; false: it only has mass and is drawn."""
    facet_size_m: Positive | None = None
    """Greatest edge of the facets on which the medium acts; null: by the error of the motion."""
    center_m: Point3 = ORIGIN
    """Origin of the shape's own frame, in the frame of the body."""


class SpatialBox(_Shape):
    """A box around its origin, with sides along its axes."""

    type: Literal["box"]
    size_m: Triple
    """Along x, y and z."""


class SpatialSphere(_Shape):
    """A ball around its origin."""

    type: Literal["sphere"]
    diameter_m: Positive


class _Round(_Shape):
    diameter_m: Positive
    length_m: Positive | None = None
    start_m: Point3 | None = None
    """Where its axis begins, in the frame of the body; with end_m in place of length_m and an orientation."""
    end_m: Point3 | None = None

    def _faults(self) -> Faults:
        yield from super()._faults()
        if self.start_m is None and self.end_m is None:
            if self.length_m is None:
                yield ("length_m",), "is missing; allowed is a number above 0, or else start_m and end_m"
            return
        for one, other in (("start_m", "end_m"), ("end_m", "start_m")):
            if getattr(self, one) is None:
                yield (one,), f"is missing; {other} needs it"
        given = [key for key in ("length_m", "rpy_deg", "quaternion") if getattr(self, key) is not None]
        for key in (*given, "center_m") if self.center_m != ORIGIN else given:
            yield (key,), "stands beside start_m and end_m, from which it follows"
        if self.start_m == self.end_m:
            yield ("end_m",), f"got {list(self.end_m or ())}, the same as start_m; the two must differ"


class SpatialCylinder(_Round):
    """A cylinder around the z axis of its own frame, half of it above its origin, or from start_m to end_m."""

    type: Literal["cylinder"]


class SpatialCapsule(_Round):
    """As a cylinder, with half spheres at both ends; its length is that between their centres."""

    type: Literal["capsule"]


class SpatialCone(_Shape):
    """A cone around the z axis of its own frame: its tip is the origin, its base at z = height."""

    type: Literal["cone"]
    diameter_m: Positive
    """Of the base."""
    height_m: Positive


class SpatialPlate(_Shape):
    """A thin rectangle in the x-y plane of its own frame, around its origin; either face can lead."""

    type: Literal["plate"]
    size_m: Pair
    """Along x and y."""
    thickness_m: Positive
    """For its mass alone."""


class SpatialArc(_Shape):
    """A thin plate bent along a circular arc in the x-z plane of its own frame, as a C-leg; either face can lead."""

    type: Literal["arc"]
    radius_m: Positive
    """Of the middle line."""
    from_deg: Annotated[float, Field(ge=-720, le=720)]
    """Where the arc begins, from the x axis towards -z: 90 is below its centre."""
    to_deg: Annotated[float, Field(ge=-720, le=720)]
    width_m: Positive
    """Along y, to both sides of the origin."""
    thickness_m: Positive
    """For its mass alone."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from opening_faults(self.from_deg, self.to_deg)


class SpatialPolygon(_Shape):
    """A solid whose section in the x-z plane of its own frame is a polygon."""

    type: Literal["polygon"]
    points_m: Annotated[tuple[Point, ...], Listed, Field(min_length=3, max_length=1000)]
    """Corners x, z in either sense; the last joins the first."""
    width_m: Positive
    """Along y, to both sides of the origin."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from outline_faults(self.points_m)


class SpatialWheel(_Shape):
    """A wheel with its axle along y of its own frame, smooth or with grousers; results have its slip and forces."""

    type: Literal["wheel"]
    radius_m: Positive
    """Of the rim."""
    width_m: Positive
    """Along y, to both sides of the origin."""
    grousers: Grousers | None = None
    """null: none."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from grouser_faults(self.radius_m, self.grousers)


class SpatialBar(Strict):
    """A thin round bar along straight pieces, for laws of bars."""

    type: Literal["bar"]
    in_sand: bool = True
    """Whether the medium acts on it; false: it only has mass and is drawn."""
    points_m: Annotated[tuple[Point3, ...], Listed, Field(min_length=2, max_length=1000)]
    """Corners in the frame of the body."""
    diameter_m: Positive

    def _faults(self) -> Faults:
        return corner_faults(self.points_m)


def _scales(scale: float | tuple[float, ...]) -> float | tuple[float, ...]:
    if isinstance(scale, tuple):
        if len(scale) != 3 or 0.0 in scale:
            raise refusal([((), f"got {list(scale)}; allowed is a number above 0, or three that are not 0")])
    elif scale <= 0.0:
        raise refusal([((), f"got {scale:g}; allowed is a number above 0, or three that are not 0")])
    return scale


class SpatialMesh(_Shape):
    """Triangles from a file, STL, OBJ or PLY."""

    type: Literal["mesh"]
    file: Text
    """A path from the folder of the file that names it."""
    scale: Annotated[tuple[float, ...], OneOrMore(), AfterValidator(_scales)] | None = None
    """Length of the file's unit in m, or one along each axis, of which a negative one mirrors; null: it is in metres,
    and one of more than 3 m is refused."""
    thin: bool = False
    """Whether it is a sheet, of which either face can lead; it need not be closed then."""
    thickness_m: Positive | None = None
    """Of a sheet, for its mass alone."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        if self.thickness_m is not None and not self.thin:
            yield ("thickness_m",), f"got {self.thickness_m:g}, but thin is false: allowed is nothing"


SHAPES = by_type(
    *(SpatialBox, SpatialCylinder, SpatialCapsule, SpatialSphere, SpatialCone, SpatialPlate, SpatialArc),
    *(SpatialPolygon, SpatialWheel, SpatialBar, SpatialMesh),
)
SpatialShape = Annotated[_Shape | SpatialBar, Tagged("type", SHAPES)]
