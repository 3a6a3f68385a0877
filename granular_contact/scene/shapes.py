"""Shapes of a config -> lines and outlines in the frame of their body, with their mass properties.

The lowest point of an arc, and the farthest one from another point, lie on the exact arc, not on its chords.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from granular_contact.config import schema
from granular_contact.config.schema import shapes
from granular_contact.laws.kinds import Kind
from granular_contact.scene.parts import InitialMotion, Shape, Wheel, rotation, scene_angle
from granular_contact.scene.types import Vector

CHORDS = 48  # least number of chords of a full circle


@dataclass(frozen=True)
class Mass:
    """Mass (kg), centre of mass (2,) m in the body's frame, inertia (kg m2) about it; of a shape at a density of 1."""

    mass: float
    center: Vector
    inertia: float

    def of_density(self, density: float) -> Mass:
        """Mass properties of the shape with a density (kg/m3)."""
        return Mass(density * self.mass, self.center, density * self.inertia)


def merged(masses: Iterable[Mass]) -> Mass:
    """Mass properties of several masses together, about their common centre of mass."""
    parts = list(masses)
    mass = sum(part.mass for part in parts)
    with np.errstate(invalid="ignore"):  # a mass of 0 has no centre; it is refused later
        center: Vector = sum((part.mass * part.center for part in parts), np.zeros(2)) / mass
    inertia = sum(part.inertia + part.mass * float(np.sum((part.center - center) ** 2)) for part in parts)
    return Mass(mass, center, inertia)


def _volume(volume: float, center: Vector, gyration_squared: float) -> Mass:
    """Mass properties of a shape with a volume (m3) and a squared radius of gyration about its centre (m2)."""
    return Mass(volume, center, volume * gyration_squared)


def build_shape(part: str, spec: shapes.Shape, strips: int) -> tuple[Shape, Mass]:
    """Build a shape of a config, with its mass properties; curves get at least `strips` chords."""
    shape, properties = _SHAPES[type(spec)](part, spec, strips)
    return shape, properties


def bar(part: str, start: Vector, end: Vector, section: Section, in_sand: bool = True) -> tuple[Shape, Mass]:
    """Straight bar from start to end, (2,) m each, with its mass properties."""
    length = float(np.linalg.norm(end - start))
    properties = _volume(section.area * length, (start + end) / 2, length**2 / 12 + section.gyration_squared)
    return Shape(part, section.kind, np.stack([start, end]), section.width, section.thickness, in_sand), properties


@dataclass(frozen=True)
class Section:
    """Section of a bar: round, or rectangular with its width (m) normal to the plane and its thickness (m) in it."""

    is_round: bool
    width: float
    thickness: float

    @property
    def kind(self) -> Kind:
        """Kind of shape for the laws."""
        return "round" if self.is_round else "flat"

    @property
    def area(self) -> float:
        """Area (m2)."""
        return self.width * self.thickness * (math.pi / 4 if self.is_round else 1.0)

    @property
    def gyration_squared(self) -> float:
        """Squared radius of gyration of the section for bending in the plane (m2)."""
        return self.thickness**2 / (16 if self.is_round else 12)


def section(spec: schema.Link | shapes.ArcShape | shapes.PolylineShape) -> Section:
    """Section of a link or shape with a diameter, or with a width and a thickness."""
    if spec.diameter_m is not None:
        return Section(True, spec.diameter_m, spec.diameter_m)
    assert spec.width_m is not None  # the schema requires a diameter, or width and thickness
    assert spec.thickness_m is not None
    return Section(False, spec.width_m, spec.thickness_m)


def _disc(part: str, spec: shapes.DiscShape, strips: int) -> tuple[Shape, Mass]:
    radius, center = spec.diameter_m / 2, np.array(spec.center_m)
    chords = max(CHORDS, strips)
    circle = center + radius * _circle(chords)
    properties = _volume(math.pi * radius**2 * spec.thickness_m, center, radius**2 / 2)
    turns = np.full(chords, 2 * math.pi / chords)
    return Shape(part, "outline", circle, spec.thickness_m, 0.0, spec.in_sand, turns=turns), properties


def effective_radius(radius: float, teeth: shapes.Grousers | None) -> float:
    """Effective radius (m) of a wheel for its slip: the rim plus a third of the grousers (Agarwal et al. 2021)."""
    return radius + (0.0 if teeth is None else teeth.height_m / 3.0)


def pitch(teeth: shapes.Grousers | None) -> float:
    """Angle (rad) between two grousers, 0 without grousers."""
    return 0.0 if teeth is None else 2.0 * math.pi / teeth.count


def wheel_outline(radius: float, teeth: shapes.Grousers | None, chords: int) -> tuple[Vector, Vector]:
    """Closed outline (k, 2) m of a wheel around the origin, and the arc angle of each side (k - 1,) rad.

    chords: number for a full circle. For the arc angles see `turns` of `Shape`.
    """
    if teeth is None:
        return radius * _circle(chords), np.full(chords, 2 * math.pi / chords)
    half, tip = 0.5 * teeth.thickness_m, radius + teeth.height_m
    opening = pitch(teeth) - 2 * math.asin(half / radius)  # angle of the rim between two grousers
    on_rim = max(2, round(chords * opening / (2 * math.pi)))
    segment = [*radius * _arc_points(-0.5 * opening, 0.5 * opening, on_rim)]
    middle = np.array([math.cos(math.pi / teeth.count), math.sin(math.pi / teeth.count)])
    across = half * np.array([-middle[1], middle[0]])
    segment += [tip * middle - across, tip * middle + across]
    segments = [np.array(segment) @ rotation(pitch(teeth) * k).T for k in range(teeth.count)]
    turns = np.tile([*np.full(on_rim, opening / on_rim), 0.0, 0.0, 0.0], teeth.count)
    return np.vstack([*segments, segment[:1]]), turns


def _wheel(part: str, spec: shapes.WheelShape, strips: int) -> tuple[Shape, Mass]:
    radius, center, teeth = spec.radius_m, np.array(spec.center_m), spec.grousers
    points, turns = wheel_outline(radius, teeth, max(CHORDS, strips))
    teeth_mass, gyration = 0.0, 0.0
    if teeth is not None:
        teeth_mass = teeth.count * teeth.thickness_m * teeth.height_m / (math.pi * radius**2)
        gyration = (radius + 0.5 * teeth.height_m) ** 2 + (teeth.thickness_m**2 + teeth.height_m**2) / 12
    squared = (radius**2 / 2 + teeth_mass * gyration) / (1.0 + teeth_mass)
    properties = _volume(math.pi * radius**2 * (1.0 + teeth_mass) * spec.width_m, center, squared)
    wheel = Wheel(center, effective_radius(radius, teeth), radius, pitch(teeth))
    shape = Shape(part, "outline", center + points, spec.width_m, 0.0, spec.in_sand, turns=turns, wheel=wheel)
    return shape, properties


def _arc_points(start: float, end: float, chords: int) -> Vector:
    """Points (chords + 1, 2) on the unit circle between two angles (rad)."""
    angles = np.linspace(start, end, chords + 1)
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _sphere(part: str, spec: shapes.SphereShape, _: int) -> tuple[Shape, Mass]:
    d, center = spec.diameter_m, np.array(spec.center_m)
    return Shape(part, "ball", center[None, :], d, d, spec.in_sand), _volume(math.pi / 6 * d**3, center, d**2 / 10)


def _cylinder(part: str, spec: shapes.CylinderShape, _: int) -> tuple[Shape, Mass]:
    size = Section(True, spec.diameter_m, spec.diameter_m)
    return bar(part, np.array(spec.start_m), np.array(spec.end_m), size, spec.in_sand)


def _plate(part: str, spec: shapes.PlateShape, _: int) -> tuple[Shape, Mass]:
    size = Section(False, spec.width_m, spec.thickness_m)
    return bar(part, np.array(spec.start_m), np.array(spec.end_m), size, spec.in_sand)


def _arc(part: str, spec: shapes.ArcShape, strips: int) -> tuple[Shape, Mass]:
    size, radius, center = section(spec), spec.radius_m, np.array(spec.center_m)
    start, end = scene_angle(spec.from_deg), scene_angle(spec.to_deg)
    half = abs(end - start) / 2
    chords = max(strips, math.ceil(CHORDS * half / math.pi))
    angles = np.linspace(start, end, chords + 1)
    points = center + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    # The centre of mass of an arc of half angle h is R sin(h) / h away from the centre of the circle, on the bisector.
    offset = radius * math.sin(half) / half
    middle = (start + end) / 2
    properties = _volume(
        size.area * radius * 2 * half,
        center + offset * np.array([math.cos(middle), math.sin(middle)]),
        radius**2 - offset**2 + size.gyration_squared,
    )
    turns = np.full(chords, (end - start) / chords)
    return Shape(part, size.kind, points, size.width, size.thickness, spec.in_sand, turns=turns), properties


def _polyline(part: str, spec: shapes.PolylineShape, _: int) -> tuple[Shape, Mass]:
    size, points = section(spec), np.array(spec.points_m)
    shape = Shape(part, size.kind, points, size.width, size.thickness, spec.in_sand)
    return shape, merged(bar(part, a, b, size)[1] for a, b in pairwise(points))


def _polygon(part: str, spec: shapes.PolygonShape, _: int) -> tuple[Shape, Mass]:
    return _solid(part, np.array(spec.points_m), spec.width_m, spec.in_sand)


def _foot(part: str, spec: shapes.FootShape, _: int) -> tuple[Shape, Mass]:
    radius = spec.height_m / 2
    half_circle = _circle(CHORDS)[: CHORDS // 2 + 1] * radius  # counter-clockwise from +x over +y to -x
    toe = half_circle @ rotation(math.pi / 2)  # from -y over +x to +y
    offset = np.array([spec.length_m / 2 - radius, 0.0])
    outline = np.vstack([toe + offset, -toe - offset])
    if not offset.any():
        outline = _circle(CHORDS)[:-1] * radius
    corners = np.array(spec.center_m) + outline @ rotation(scene_angle(spec.tilt_deg)).T
    shape, properties = _solid(part, corners, spec.width_m, spec.in_sand)
    turns = np.full(len(shape.points) - 1, 2 * math.pi / CHORDS)
    if offset.any():  # the sole and the top are straight
        turns[[CHORDS // 2, -1]] = 0.0
    return replace(shape, turns=turns), properties


def _solid(part: str, corners: Vector, width: float, in_sand: bool) -> tuple[Shape, Mass]:
    """Prism with a polygon as its section; corners (k, 2) m, without the first one repeated."""
    closed = np.vstack([corners, corners[:1]])
    origin = corners.mean(axis=0)
    (x0, y0), (x1, y1) = (closed[:-1] - origin).T, (closed[1:] - origin).T
    twice_areas = x0 * y1 - x1 * y0  # of the triangles between the origin and the sides, signed
    area = twice_areas.sum() / 2
    center = np.array([((x0 + x1) * twice_areas).sum(), ((y0 + y1) * twice_areas).sum()]) / (6 * area)
    polar = ((x0**2 + x0 * x1 + x1**2 + y0**2 + y0 * y1 + y1**2) * twice_areas).sum() / 12
    properties = _volume(abs(area) * width, origin + center, polar / area - float(center @ center))
    return Shape(part, "outline", closed, width, 0.0, in_sand), properties


def _circle(chords: int) -> Vector:
    """Points (chords + 1, 2) around the unit circle, counter-clockwise from the x axis."""
    angles = np.linspace(0.0, 2 * math.pi, chords + 1)
    points = np.column_stack([np.cos(angles), np.sin(angles)])
    points[-1] = points[0]
    return points


_SHAPES: dict[type, Callable[[str, Any, int], tuple[Shape, Mass]]] = {
    shapes.DiscShape: _disc,
    shapes.WheelShape: _wheel,
    shapes.SphereShape: _sphere,
    shapes.CylinderShape: _cylinder,
    shapes.PlateShape: _plate,
    shapes.ArcShape: _arc,
    shapes.PolylineShape: _polyline,
    shapes.PolygonShape: _polygon,
    shapes.FootShape: _foot,
}


DOWN = np.array([0.0, -1.0])
AT_CENTRE = 1e-9  # relative to the radius: closer to the centre of an arc, all points of the arc are equally far


def lowest(shape: Shape, motion: InitialMotion) -> Iterator[Vector]:
    """Lowest points (2,) m of the arcs of a shape, in the frame of the body, without arcs that are lowest at an end."""
    yield from _arc_extrema(shape, motion, None)


def farthest(shape: Shape, motion: InitialMotion, root: Vector) -> Iterator[Vector]:
    """Farthest points (2,) m of the arcs of a shape from a world point (2,) m, in the frame of the body.

    Arcs that are farthest at an end are left out.
    """
    yield from _arc_extrema(shape, motion, root)


def _arc_extrema(shape: Shape, motion: InitialMotion, root: Vector | None) -> Iterator[Vector]:
    """Points of arcs (2,) m, in the frame of the body, that are farthest from root, or lowest if root is None."""
    if shape.turns is None:
        return
    points = motion.world(shape.points)
    for a, b, turn in zip(points, points[1:], shape.turns, strict=False):
        if turn == 0.0:
            continue
        chord, middle = b - a, 0.5 * (a + b)
        left = np.array([-chord[1], chord[0]])
        centre = middle + 0.5 * left / np.tan(0.5 * turn)  # to the left of the chord for a counter-clockwise arc
        radius = float(np.linalg.norm(a - centre))
        direction = DOWN if root is None else centre - root
        length = float(np.linalg.norm(direction))
        if length <= AT_CENTRE * radius:
            continue
        # The extreme point of the full circle counts if it lies on the arc: within half the arc angle of its middle.
        cosine = np.cos(0.5 * turn)
        if float((middle - centre) @ direction) >= cosine * float(np.linalg.norm(middle - centre)) * length:
            yield motion.local(centre + radius * direction / length)
