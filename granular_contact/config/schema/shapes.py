"""Schema of the shapes of rigid bodies: mass, outline, and what the medium meets. SI units, named in the keys."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field

from granular_contact.geometry.polygon import crossing, doubled_area, extent
from granular_contact.values.strict import Faults, Listed, Point, Positive, Strict, Tagged, by_type

SLENDER = 1e6  # a sole of more times its height has an outline that round-off closes


class PlanarShape(Strict):
    """What all shapes in the plane have."""

    in_sand: bool = True
    """Whether the medium acts on it; false: it only has mass and is drawn."""


class DiscShape(PlanarShape):
    """A wheel: a cylinder whose axis is normal to the plane of motion."""

    type: Literal["disc"]
    diameter_m: Positive
    thickness_m: Positive
    """Extent along the axis."""
    center_m: Point = (0.0, 0.0)
    """In the frame of the body."""


class Grousers(Strict):
    """Bars across the rim of a wheel, at equal distances."""

    count: Annotated[int, Field(ge=1, le=200)]
    height_m: Positive
    """Beyond the rim."""
    thickness_m: Positive
    """Along the rim."""


def grouser_faults(radius: float, teeth: Grousers | None) -> Faults:
    """Of grousers that do not fit on the rim of a wheel of this radius (m)."""
    if teeth is not None and teeth.count * teeth.thickness_m > 0.9 * 2.0 * math.pi * radius:
        most = 0.9 * 2.0 * math.pi * radius / teeth.count
        words = f"got {teeth.thickness_m:g}; allowed is at most {most:.3g}, nine tenths of the rim over the count"
        yield ("grousers", "thickness_m"), words


class WheelShape(PlanarShape):
    """A wheel, smooth or with grousers; its slip, sinkage and pull are in the results."""

    type: Literal["wheel"]
    radius_m: Positive
    """Of the rim."""
    width_m: Positive
    """Extent along the axle."""
    center_m: Point = (0.0, 0.0)
    """The axle, in the frame of the body."""
    grousers: Grousers | None = None
    """null: none."""

    def _faults(self) -> Faults:
        return grouser_faults(self.radius_m, self.grousers)


class SphereShape(PlanarShape):
    """A ball."""

    type: Literal["sphere"]
    diameter_m: Positive
    center_m: Point = (0.0, 0.0)


class _Straight(PlanarShape):
    start_m: Point = (0.0, 0.0)
    end_m: Point

    def _faults(self) -> Faults:
        if self.start_m == self.end_m:
            yield ("end_m",), f"got {list(self.end_m)}, the same as start_m; the two must differ"


class CylinderShape(_Straight):
    """A cylinder whose axis lies in the plane of motion, from `start_m` to `end_m` in the frame of the body."""

    type: Literal["cylinder"]
    diameter_m: Positive


class PlateShape(_Straight):
    """A flat plate seen from its edge, from `start_m` to `end_m` in the frame of the body."""

    type: Literal["plate"]
    width_m: Positive
    """Extent normal to the plane of motion."""
    thickness_m: Positive


def section_faults(diameter: float | None, width: float | None, thickness: float | None) -> Faults:
    """Faults of a section that is round, with a diameter, or rectangular, with a width and a thickness."""
    if diameter is None and width is None and thickness is None:
        yield ("diameter_m",), "is missing; allowed is a number above 0, or else width_m and thickness_m"
    elif diameter is not None and (width is not None or thickness is not None):
        yield ("diameter_m",), "stands beside width_m or thickness_m; a section is round or rectangular"
    elif diameter is None and (width is None or thickness is None):
        missing = "width_m" if width is None else "thickness_m"
        yield (missing,), "is missing; a rectangular section has width_m and thickness_m"


class _Bent(PlanarShape):
    diameter_m: Positive | None = None
    """Of a round bar."""
    width_m: Positive | None = None
    """Of a flat bar, normal to the plane of motion."""
    thickness_m: Positive | None = None
    """Of a flat bar, in the plane."""

    def _faults(self) -> Faults:
        return section_faults(self.diameter_m, self.width_m, self.thickness_m)


def opening_faults(from_deg: float, to_deg: float) -> Faults:
    """Faults of an arc (deg) without an opening, or of more than a turn."""
    sweep = abs(to_deg - from_deg)
    if not 0.0 < sweep <= 360.0:
        yield ("to_deg",), f"got {to_deg:g}, which is {sweep:g} from from_deg; allowed is above 0 and at most 360"


class ArcShape(_Bent):
    """A round or flat bar along a circular arc, as a C-leg."""

    type: Literal["arc"]
    radius_m: Positive
    """Of the middle line."""
    center_m: Point = (0.0, 0.0)
    from_deg: Annotated[float, Field(ge=-720, le=720)]
    """Where the arc begins, clockwise from the x axis of the body: 90 is below its centre."""
    to_deg: Annotated[float, Field(ge=-720, le=720)]
    """Where it ends; the smaller one may be either."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from opening_faults(self.from_deg, self.to_deg)


class PolylineShape(_Bent):
    """A round or flat bar along straight pieces."""

    type: Literal["polyline"]
    points_m: Annotated[tuple[Point, ...], Listed, Field(min_length=2, max_length=1000)]
    """Corners in the frame of the body."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        yield from corner_faults(self.points_m)


class PolygonShape(PlanarShape):
    """A solid with a polygon as its section."""

    type: Literal["polygon"]
    points_m: Annotated[tuple[Point, ...], Listed, Field(min_length=3, max_length=1000)]
    """Corners in the frame of the body, in either sense; the last joins the first."""
    width_m: Positive
    """Extent normal to the plane of motion."""

    def _faults(self) -> Faults:
        return outline_faults(self.points_m)


class FootShape(PlanarShape):
    """A flat sole with round toe and heel: a rectangle that ends in half circles, along the x axis of its own frame."""

    type: Literal["foot"]
    length_m: Positive
    """From heel to toe, the round ends included."""
    height_m: Positive
    width_m: Positive
    """Extent normal to the plane of motion."""
    center_m: Point = (0.0, 0.0)
    tilt_deg: float = 0.0
    """Of the sole in the frame of the body, clockwise: positive lowers the toe."""

    def _faults(self) -> Faults:
        if self.length_m < self.height_m:
            allowed = f"allowed is at least height_m, {self.height_m:g}"
            yield ("length_m",), f"got {self.length_m:g}; {allowed}"
        if self.length_m > SLENDER * self.height_m:
            allowed = f"allowed is at most {SLENDER:g} times height_m, {SLENDER * self.height_m:g}"
            yield ("length_m",), f"got {self.length_m:g}; {allowed}"


def corner_faults(points: Sequence[tuple[float, ...]]) -> Faults:
    """A fault for each corner that is the same as the one before it."""
    for i, (one, other) in enumerate(pairwise(points)):
        if one == other:
            yield ("points_m",), f"corners {i} and {i + 1} are the same, {list(one)}; neighbours must differ"


def outline_faults(corners: Sequence[tuple[float, float]]) -> Faults:
    """Faults of a polygon: corners that are the same, else no area, else sides that cross."""
    if same := list(corner_faults((*corners, corners[0]))):
        yield from same
    elif abs(doubled_area(corners)) < 1e-12 * extent(corners) ** 2:
        yield ("points_m",), "encloses no area; the corners must not lie on one line"
    elif pair := crossing(corners):
        words = f"the sides after corners {pair[0] + 1} and {pair[1] + 1} cross; sides may only meet"
        yield ("points_m",), words


SHAPES = by_type(
    *(DiscShape, WheelShape, SphereShape, CylinderShape, PlateShape, ArcShape, PolylineShape, PolygonShape, FootShape)
)
Shape = Annotated[PlanarShape, Tagged("type", SHAPES)]
