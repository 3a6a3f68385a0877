"""Schema of the shapes of rigid bodies in the plane: their mass, outline, and surfaces on which the medium acts.

The keys name SI units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field

from granular_contact.geometry.polygon import crossing, doubled_area, extent
from granular_contact.values.strict import Faults, Listed, Point, Positive, Strict, Tagged, by_type

SLENDER = 1e6  # largest length of a sole over its height; round-off closes the outline of a longer one


class PlanarShape(Strict):
    """Keys that all shapes in the plane share."""

    in_sand: bool = True
    """true: the medium acts on the shape; false: the shape only has mass and is drawn."""


class DiscShape(PlanarShape):
    """A disc or wheel: a cylinder whose axis is normal to the plane of motion."""

    type: Literal["disc"]
    diameter_m: Positive
    """Diameter."""
    thickness_m: Positive
    """Length along the axis."""
    center_m: Point = (0.0, 0.0)
    """Position of the axis, x and y in the frame of the body."""


class Grousers(Strict):
    """Grousers of a wheel: equal bars across the rim, at equal distances."""

    count: Annotated[int, Field(ge=1, le=200)]
    """Number of grousers."""
    height_m: Positive
    """Height above the rim."""
    thickness_m: Positive
    """Thickness along the rim."""


def grouser_faults(radius: float, grousers: Grousers | None) -> Faults:
    """A fault of grousers that do not fit on the rim of a wheel of this radius (m)."""
    if grousers is not None and grousers.count * grousers.thickness_m > 0.9 * 2.0 * math.pi * radius:
        most = 0.9 * 2.0 * math.pi * radius / grousers.count
        message = f"got {grousers.thickness_m:g}; allowed is at most {most:.3g}, nine tenths of the rim over the count"
        yield ("grousers", "thickness_m"), message


class WheelShape(PlanarShape):
    """A wheel, smooth or with grousers. The results contain its slip, sinkage and drawbar pull."""

    type: Literal["wheel"]
    radius_m: Positive
    """Radius of the rim, without grousers."""
    width_m: Positive
    """Width along the axle."""
    center_m: Point = (0.0, 0.0)
    """Position of the axle, x and y in the frame of the body."""
    grousers: Grousers | None = None
    """Grousers on the rim. null: a smooth wheel."""

    def _faults(self) -> Faults:
        return grouser_faults(self.radius_m, self.grousers)


class SphereShape(PlanarShape):
    """A ball."""

    type: Literal["sphere"]
    diameter_m: Positive
    """Diameter."""
    center_m: Point = (0.0, 0.0)
    """Position of the centre, x and y in the frame of the body."""


class _Straight(PlanarShape):
    start_m: Point = (0.0, 0.0)
    """Position of the first end, x and y in the frame of the body."""
    end_m: Point
    """Position of the second end, x and y in the frame of the body."""

    def _faults(self) -> Faults:
        if self.start_m == self.end_m:
            yield ("end_m",), f"got {list(self.end_m)}, the same as start_m; the two must differ"


class CylinderShape(_Straight):
    """A cylinder whose axis lies in the plane of motion, from `start_m` to `end_m`."""

    type: Literal["cylinder"]
    diameter_m: Positive
    """Diameter."""


class PlateShape(_Straight):
    """A flat plate, seen from its edge, from `start_m` to `end_m`."""

    type: Literal["plate"]
    width_m: Positive
    """Width normal to the plane of motion."""
    thickness_m: Positive
    """Thickness in the plane of motion."""


def section_faults(diameter: float | None, width: float | None, thickness: float | None) -> Faults:
    """Faults of a cross-section: it must have either a diameter (round), or a width and a thickness (rectangular)."""
    if diameter is None and width is None and thickness is None:
        yield ("diameter_m",), "is missing; allowed is a number above 0, or else width_m and thickness_m"
    elif diameter is not None and (width is not None or thickness is not None):
        yield ("diameter_m",), "stands beside width_m or thickness_m; a section is round or rectangular"
    elif diameter is None and (width is None or thickness is None):
        missing = "width_m" if width is None else "thickness_m"
        yield (missing,), "is missing; a rectangular section has width_m and thickness_m"


class _Bent(PlanarShape):
    diameter_m: Positive | None = None
    """Diameter of a round bar. A flat bar has width_m and thickness_m instead."""
    width_m: Positive | None = None
    """Width of a flat bar, normal to the plane of motion."""
    thickness_m: Positive | None = None
    """Thickness of a flat bar, in the plane of motion."""

    def _faults(self) -> Faults:
        return section_faults(self.diameter_m, self.width_m, self.thickness_m)


def opening_faults(from_deg: float, to_deg: float) -> Faults:
    """A fault of an arc (deg) that has no length, or is longer than a full turn."""
    sweep = abs(to_deg - from_deg)
    if not 0.0 < sweep <= 360.0:
        yield ("to_deg",), f"got {to_deg:g}, which is {sweep:g} from from_deg; allowed is above 0 and at most 360"


class ArcShape(_Bent):
    """A round or flat bar along a circular arc, for example a C-leg."""

    type: Literal["arc"]
    radius_m: Positive
    """Radius of the centre line of the bar."""
    center_m: Point = (0.0, 0.0)
    """Position of the centre of the circle, x and y in the frame of the body."""
    from_deg: Annotated[float, Field(ge=-720, le=720)]
    """Angle at which the arc begins, clockwise from the x axis of the body: 90 is below the centre."""
    to_deg: Annotated[float, Field(ge=-720, le=720)]
    """Angle at which the arc ends. It may be smaller or larger than from_deg."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from opening_faults(self.from_deg, self.to_deg)


class PolylineShape(_Bent):
    """A round or flat bar along straight pieces."""

    type: Literal["polyline"]
    points_m: Annotated[tuple[Point, ...], Listed, Field(min_length=2, max_length=1000)]
    """Corners x, y of the centre line, in the frame of the body."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from corner_faults(self.points_m)


class PolygonShape(PlanarShape):
    """A solid whose outline in the plane of motion is a polygon."""

    type: Literal["polygon"]
    points_m: Annotated[tuple[Point, ...], Listed, Field(min_length=3, max_length=1000)]
    """Corners x, y in the frame of the body, clockwise or counter-clockwise. The last corner connects to the first."""
    width_m: Positive
    """Width normal to the plane of motion."""

    def _faults(self) -> Faults:
        return outline_faults(self.points_m)


class FootShape(PlanarShape):
    """A flat sole with a round toe and a round heel: a rectangle with half circles at both ends.

    Its length is along the x axis of its own frame.
    """

    type: Literal["foot"]
    length_m: Positive
    """Length from heel to toe, including the round ends."""
    height_m: Positive
    """Height of the sole, the diameter of the round ends."""
    width_m: Positive
    """Width normal to the plane of motion."""
    center_m: Point = (0.0, 0.0)
    """Position of the centre of the sole, x and y in the frame of the body."""
    tilt_deg: float = 0.0
    """Angle of the sole in the frame of the body, clockwise: a positive angle lowers the toe."""

    def _faults(self) -> Faults:
        if self.length_m < self.height_m:
            allowed = f"allowed is at least height_m, {self.height_m:g}"
            yield ("length_m",), f"got {self.length_m:g}; {allowed}"
        if self.length_m > SLENDER * self.height_m:
            allowed = f"allowed is at most {SLENDER:g} times height_m, {SLENDER * self.height_m:g}"
            yield ("length_m",), f"got {self.length_m:g}; {allowed}"


def corner_faults(points: Sequence[tuple[float, ...]]) -> Faults:
    """A fault for each corner that equals the corner before it."""
    for i, (corner, following) in enumerate(pairwise(points)):
        if corner == following:
            yield ("points_m",), f"corners {i} and {i + 1} are the same, {list(corner)}; neighbours must differ"


def outline_faults(corners: Sequence[tuple[float, float]]) -> Faults:
    """Faults of a polygon: equal neighbouring corners, else no area, else sides that cross."""
    size = extent(corners)
    if equal_corners := list(corner_faults((*corners, corners[0]))):
        yield from equal_corners
    elif abs(doubled_area(corners)) < 1e-12 * size * size:  # of numbers that are too large infinite, or NaN
        yield ("points_m",), "encloses no area; the corners must not lie on one line"
    elif pair := crossing(corners):
        message = f"the sides after corners {pair[0] + 1} and {pair[1] + 1} cross; sides may only meet"
        yield ("points_m",), message


SHAPES = by_type(
    *(DiscShape, WheelShape, SphereShape, CylinderShape, PlateShape, ArcShape, PolylineShape, PolygonShape, FootShape)
)
Shape = Annotated[PlanarShape, Tagged("type", SHAPES)]
