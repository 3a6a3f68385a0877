"""Shapes of a config in space -> shapes for the medium, and triangles to draw; their mass: `mass_properties`."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space import shapes as shapes_schema
from granular_contact.config.schema.space.turned import Oriented
from granular_contact.geometry import rotations
from granular_contact.geometry.mesh_quality import quality_notes
from granular_contact.geometry.polygon import ears
from granular_contact.sand.space import round_shapes
from granular_contact.sand.space import shapes as sand_shapes
from granular_contact.sand.space.beam_shape import Beam
from granular_contact.sand.space.mesh_shape import Extrusion, Mesh
from granular_contact.scene.shapes import effective_radius, pitch, wheel_outline
from granular_contact.scene.space.mass_properties import (
    Mass,
    of_arc,
    of_capsule,
    of_cylinder,
    of_element,
    of_line,
    of_sheet,
    of_surface,
    solid,
)
from granular_contact.scene.space.section import Element, section
from granular_contact.scene.space.types import Meets, Part, SpatialWheel, Vector

CHORDS = 96  # of a full circle: trajectories of a C-leg are then exact to 3e-4 of the path
RIM_POINTS = 192  # points on a rim: between two points it is deeper by up to 1.3e-4 of its radius
NOT_CUT = math.inf  # size of facets (m): they are not cut
_KEPT = 64  # shapes and meshes that are kept, as many bodies share them


def orientation(spec: Oriented) -> Vector:
    """Rotation matrix (3, 3) of an orientation of a config."""
    if spec.quaternion is not None:
        return rotations.of_quaternion(spec.quaternion)
    return np.eye(3) if spec.rpy_deg is None else rotations.of_rpy(np.radians(spec.rpy_deg))


def part_of(name: str, spec: Any, media: Collection[str], strips: int) -> tuple[Part, Mass]:
    """Build a shape of a config in the frame of its body, with its mass properties.

    media: kinds of shapes that the media of the run take: "surface", "bar", "ball"; strips: of a bar.

    Raises
    ------
    SceneError
        A mesh can't be read or used. Faults do not have the key of the shape, which is not known here.
    """
    if isinstance(spec, schema.SpatialLink | Element):
        return _link(name, spec, media, strips)
    if isinstance(spec, shapes_schema.SpatialBar):
        line = sand_shapes.Bar(np.array(spec.points_m), spec.diameter_m, strips)
        return _bar(name, line, spec.in_sand), of_line(line)
    notes: tuple[str, ...] = ()
    if isinstance(spec, shapes_schema.SpatialMesh):
        shape, volume, notes = _mesh_of(spec)
    else:
        shape, volume = build_shape(spec)
    position, turn = np.array(spec.center_m), orientation(spec)
    if isinstance(spec, shapes_schema.SpatialCylinder | shapes_schema.SpatialCapsule) and spec.start_m is not None:
        start, end = np.array(spec.start_m), np.array(spec.end_m)
        position, turn = 0.5 * (start + end), rotations.to_axis(end - start)
    if isinstance(spec, shapes_schema.SpatialWheel) and spec.grousers is None:
        turn = turn @ rotations.to_axis(np.array([0.0, 1.0, 0.0]))
    meets: tuple[Meets, ...] = ("surface",)
    if isinstance(shape, round_shapes.Sphere):
        meets = tuple(kind for kind in ("surface", "ball") if kind in media) or ("surface", "ball")
    part = _part(name, shape, meets, position, turn, spec.in_sand, spec.facet_size_m)
    if isinstance(spec, shapes_schema.SpatialWheel):
        radius = effective_radius(spec.radius_m, spec.grousers)
        wheel = SpatialWheel(position, orientation(spec)[:, 1], radius, spec.radius_m, pitch(spec.grousers))
        return replace(part, wheel=wheel), volume.placed(position, turn)
    return replace(part, notes=notes), volume.placed(position, turn)


def _part(
    name: str, shape: Any, meets: tuple[Meets, ...], position: Vector, turn: Vector, in_sand: bool, size: float | None
) -> Part:
    """Part with the triangles to draw and the outermost points of a shape; size (m): of its facets."""
    drawn = shape.drawn() @ turn.T + position
    if size is not None and in_sand:
        shape.facets(size)  # raises SceneError if there are too many
    points, drop = _rim_points(shape)
    points = outermost(drawn.reshape(-1, 3)) if points is None else points @ turn.T + position
    return Part(name, shape, meets, position, turn, in_sand, size, drawn, points, drop)


def _rim_points(shape: Any) -> tuple[Vector | None, float]:
    """Points (n, 3) m on the rims of a round shape, and how far (m) it reaches around them; None without rims."""
    rims, points = shape.rims(), []
    if len(rims) == 0:
        return None, 0.0
    angle = 2.0 * math.pi * np.arange(RIM_POINTS) / RIM_POINTS
    for x, y, z, *axis, radius, _ in rims:
        circle = radius * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
        circle = circle @ rotations.to_axis(np.array(axis)).T
        points.append(np.array([x, y, z]) + (circle if radius else np.zeros((1, 3))))
    return np.concatenate(points), float(rims[:, 7].max())


def _bar(name: str, line: Any, in_sand: bool) -> Part:
    """Part of a bar, which laws for bars act on along its line, and which is drawn as cylinders."""
    drawn = [np.zeros((0, 3, 3))]
    for a, b in pairwise(line.line):
        tube = round_shapes.Cylinder(line.diameter, float(np.linalg.norm(b - a))).corners(NOT_CUT)
        drawn.append(tube @ rotations.to_axis(b - a).T + 0.5 * (a + b))
    return Part(name, line, ("bar",), np.zeros(3), np.eye(3), in_sand, None, np.concatenate(drawn), line.line)


def _link(name: str, spec: schema.SpatialLink | Element, media: Collection[str], strips: int) -> tuple[Part, Mass]:
    """Part and mass properties of a link or of an element of a link that bends.

    It is a bar if it is round and a medium takes bars, or without media; otherwise it is a surface.
    """
    element = spec if isinstance(spec, Element) else Element(spec, 0.0, spec.length_m)
    link, cross_section = element.link, section(element.link)
    a, b = (np.array([x, 0.0, 0.0]) for x in (element.start, element.end))
    length, volume, diameter = element.end - element.start, of_element(cross_section, element), cross_section.diameter
    if diameter is not None and ("bar" in media or not media):
        return _bar(name, sand_shapes.Bar(np.array([a, b]), diameter, strips, element.ends[1]), True), volume
    if diameter is not None and not isinstance(spec, Element):
        turn = rotations.to_axis(np.array([1.0, 0.0, 0.0]))
        cylinder = _shared(round_shapes.Cylinder, diameter, length)
        return _part(name, cylinder, ("surface",), 0.5 * (a + b), turn, True, link.facet_size_m), volume
    size, sides = link.facet_size_m, (cross_section.width, cross_section.thickness)
    if size is None and isinstance(spec, Element):
        size = max(0.25 * length / element.share, min(sides))
    shape = _shared(Beam, length, sides, diameter is not None, element.ends)
    return _part(name, shape, ("surface",), 0.5 * (a + b), np.eye(3), True, size), volume


def moved(part: Part, position: Vector, rotation: Vector) -> Part:
    """The same part in another frame, in which the frame of its body has a position (3,) m and a rotation (3, 3)."""
    return replace(
        part,
        position=position + rotation @ part.position,
        rotation=rotation @ part.rotation,
        triangles=part.triangles @ rotation.T + position,
        points=part.points @ rotation.T + position,
        wheel=None
        if part.wheel is None
        else replace(part.wheel, axle=position + rotation @ part.wheel.axle, axis=rotation @ part.wheel.axis),
    )


# ---- shapes in their own frames ----


@lru_cache(maxsize=_KEPT)
def _shared(kind: Any, *numbers: Any) -> Any:
    """Shape of a class, the same object for all bodies with the same numbers."""
    return kind(*numbers)


@lru_cache(maxsize=_KEPT)
def build_shape(spec: Any) -> tuple[Any, Mass]:
    """Build a shape of a config in its own frame, with its mass properties; bodies with equal shapes share one."""
    if isinstance(spec, shapes_schema.SpatialPolygon):
        body = _extruded(np.array(spec.points_m), spec.width_m)
        return body, of_surface(body.vertices[body.faces])
    if isinstance(spec, shapes_schema.SpatialArc):
        return _arc_sheet(spec), of_arc(spec)
    if isinstance(spec, shapes_schema.SpatialWheel):
        if spec.grousers is None:
            return round_shapes.Cylinder(2 * spec.radius_m, spec.width_m), of_cylinder(2 * spec.radius_m, spec.width_m)
        body = _extruded(wheel_outline(spec.radius_m, spec.grousers, CHORDS)[0][:-1], spec.width_m)
        return body, of_surface(body.vertices[body.faces])
    zero = np.zeros(3)
    if isinstance(spec, shapes_schema.SpatialBox):
        a, b, c = spec.size_m
        return sand_shapes.Box(spec.size_m), solid(a * b * c, zero, np.diag([a * a, b * b, c * c]) / 12.0)
    if isinstance(spec, shapes_schema.SpatialPlate):
        a, b, t = *spec.size_m, spec.thickness_m
        return sand_shapes.Plate(spec.size_m), solid(a * b * t, zero, np.diag([a * a, b * b, t * t]) / 12.0)
    d = spec.diameter_m
    if isinstance(spec, shapes_schema.SpatialSphere):
        return round_shapes.Sphere(d), solid(math.pi / 6.0 * d**3, zero, np.eye(3) * d * d / 20.0)
    if isinstance(spec, shapes_schema.SpatialCone):
        h = spec.height_m
        second = np.diag([3.0 * d * d / 80.0, 3.0 * d * d / 80.0, 3.0 * h * h / 80.0])
        return round_shapes.Cone(d, h), solid(math.pi * d * d * h / 12.0, np.array([0.0, 0.0, 0.75 * h]), second)
    length = _length(spec)
    if isinstance(spec, shapes_schema.SpatialCapsule):
        return round_shapes.Capsule(d, length), of_capsule(d, length)
    return round_shapes.Cylinder(d, length), of_cylinder(d, length)


def _mesh_of(spec: shapes_schema.SpatialMesh) -> tuple[Any, Mass, tuple[str, ...]]:
    """Mesh of a config in its own frame, with its mass properties and notes."""
    path, thickness = Path(spec.file), spec.thickness_m or 0.0
    changed = path.stat().st_mtime_ns if path.is_file() else None
    mesh, volume = _read_mesh(path, changed, spec.scale, spec.thin, thickness)
    doubts = _mesh_doubts(path, changed, spec.scale) if spec.in_sand and not spec.thin else ()
    return mesh, volume, (*mesh.notes, *doubts)


@lru_cache(maxsize=_KEPT)
def _read_mesh(
    path: Path, changed: int | None, scale: float | tuple[float, ...] | None, thin: bool, thickness: float
) -> tuple[Any, Mass]:
    """Read the mesh of a file, with its mass properties; many bodies, and the runs of a sweep, share one.

    changed: time (ns) at which the file was changed last, a key of the cache.
    """
    del changed
    mesh = Mesh.read(path, scale=scale, thin=thin)
    return mesh, of_sheet(mesh, thickness) if thin else of_surface(mesh.vertices[mesh.faces])


@lru_cache(maxsize=_KEPT)
def _mesh_doubts(path: Path, changed: int | None, scale: float | tuple[float, ...] | None) -> tuple[str, ...]:
    """Sentences on flaws of the mesh of a file that make its forces uncertain."""
    mesh, _ = _read_mesh(path, changed, scale, False, 0.0)
    return quality_notes(mesh.vertices, mesh.faces)


def _length(spec: Any) -> float:
    if spec.start_m is not None and spec.end_m is not None:
        return math.dist(spec.start_m, spec.end_m)
    return float(spec.length_m)


def _extruded(section: Vector, width: float) -> Any:
    """Prism along y with a section (k, 2) m in the x-z plane and a width (m)."""
    corners = [(float(x), float(z)) for x, z in section]
    if np.sum(section[:, 0] * np.roll(section[:, 1], -1) - section[:, 1] * np.roll(section[:, 0], -1)) < 0.0:
        corners.reverse()
    return Extrusion(np.array(corners), width, ears(corners), name="polygon")


def _arc_sheet(spec: Any) -> Any:
    """Thin sheet along the chords of an arc."""
    start, end = math.radians(spec.from_deg), math.radians(spec.to_deg)
    chords = max(2, math.ceil(CHORDS * abs(end - start) / (2.0 * math.pi)))
    angles = np.linspace(start, end, chords + 1)
    line = spec.radius_m * np.column_stack([np.cos(angles), -np.sin(angles)])
    return Extrusion(line, spec.width_m, name="arc")


def outermost(points: Vector) -> Vector:
    """Points (k, 3) m of many (n, 3) that are farthest in some direction, so that they can be the deepest ones.

    Of many points, only those that are farthest in one of 400 directions are kept.
    """
    if len(points) > 4 * len(_DIRECTIONS):  # `unique` would take long for the corners of a large mesh
        points = points[_extreme(points)]
    distinct: Vector = np.unique(points, axis=0)
    return distinct if len(distinct) <= len(_DIRECTIONS) else np.asarray(distinct[_extreme(distinct)])


def _extreme(points: Vector) -> NDArray[np.int64]:
    """Indices of the points that are farthest in one of the directions.

    A matrix product would be slower, as it waits for its threads.
    """
    x, y, z = np.ascontiguousarray(points.T)
    return np.unique([int((a * x + b * y + c * z).argmax()) for a, b, c in _DIRECTIONS])


def _directions(count: int) -> Vector:
    """Unit vectors (count, 3) spread evenly over a sphere, along a spiral."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = math.pi * (1.0 + math.sqrt(5.0)) * np.arange(count)
    rho = np.sqrt(1.0 - z * z)
    return np.column_stack([rho * np.cos(turn), rho * np.sin(turn), z])


_DIRECTIONS = _directions(400)
