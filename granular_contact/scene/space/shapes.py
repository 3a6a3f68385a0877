"""Shapes of a config in space -> what the medium meets, and triangles to draw; their mass: `mass_properties`."""

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
from granular_contact.sand.space import shapes as made
from granular_contact.sand.space.beam_shape import Beam
from granular_contact.sand.space.mesh_shape import Extrusion, Mesh
from granular_contact.scene.shapes import effective_radius, pitch, wheel_outline
from granular_contact.scene.space.mass_properties import (
    Mass,
    of_arc,
    of_bar,
    of_capsule,
    of_cylinder,
    of_line,
    of_sheet,
    of_surface,
    solid,
)
from granular_contact.scene.space.section import Element, section
from granular_contact.scene.space.types import Meets, Part, SpatialWheel, Vector

CHORDS = 96  # of a full circle of an arc: trajectories of a C-leg are then within 3e-4 of the path
ON_A_RIM = 192  # points: between them a rim is 1.3e-4 of its radius deeper
NOT_CUT = math.inf
_KEPT = 64  # shapes, and meshes of files, that many bodies share


def orientation(spec: Oriented) -> Vector:
    """Matrix (3, 3) of an orientation of a config."""
    if spec.quaternion is not None:
        return rotations.of_quaternion(spec.quaternion)
    return np.eye(3) if spec.rpy_deg is None else rotations.of_rpy(np.radians(spec.rpy_deg))


def part_of(name: str, spec: Any, media: Collection[str], strips: int) -> tuple[Part, Mass]:
    """A shape of a config, in the frame of its body, with its mass properties.

    media: as what the media of the run meet shapes: "surface", "bar", "ball"; strips: of a bar.

    Raises
    ------
    SceneError
        A mesh can't be read or used; its key is not known here.
    """
    if isinstance(spec, schema.SpatialLink | Element):
        return _link(name, spec, media, strips)
    if isinstance(spec, shapes_schema.SpatialBar):
        line = made.Bar(np.array(spec.points_m), spec.diameter_m, strips)
        return _bar(name, line, spec.in_sand), of_line(line)
    shape, own, notes = (*_made(spec), ()) if not isinstance(spec, shapes_schema.SpatialMesh) else _mesh_of(spec)
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
        return replace(part, wheel=wheel), own.placed(position, turn)
    return replace(part, notes=notes), own.placed(position, turn)


def _part(
    name: str, shape: Any, meets: tuple[Meets, ...], position: Vector, turn: Vector, in_sand: bool, size: float | None
) -> Part:
    drawn = shape.drawn() @ turn.T + position
    if size is not None and in_sand:
        shape.facets(size)  # or there are too many
    points, drop = _deepest(shape)
    points = outermost(drawn.reshape(-1, 3)) if points is None else points @ turn.T + position
    return Part(name, shape, meets, position, turn, in_sand, size, drawn, points, drop)


def _deepest(shape: Any) -> tuple[Vector | None, float]:
    """Of a round shape the points that its rims have, and how far (m) it reaches around them."""
    rims, points = shape.rims(), []
    if len(rims) == 0:
        return None, 0.0
    angle = 2.0 * math.pi * np.arange(ON_A_RIM) / ON_A_RIM
    for x, y, z, *axis, circle, _ in rims:
        around = circle * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
        around = around @ rotations.to_axis(np.array(axis)).T
        points.append(np.array([x, y, z]) + (around if circle else np.zeros((1, 3))))
    return np.concatenate(points), float(rims[:, 7].max())


def _bar(name: str, line: Any, in_sand: bool) -> Part:
    """A bar: drawn as cylinders, met along its line."""
    drawn = [np.zeros((0, 3, 3))]
    for a, b in pairwise(line.line):
        tube = round_shapes.Cylinder(line.diameter, float(np.linalg.norm(b - a))).corners(NOT_CUT)
        drawn.append(tube @ rotations.to_axis(b - a).T + 0.5 * (a + b))
    return Part(name, line, ("bar",), np.zeros(3), np.eye(3), in_sand, None, np.concatenate(drawn), line.line)


def _link(name: str, spec: schema.SpatialLink | Element, media: Collection[str], strips: int) -> tuple[Part, Mass]:
    """A link, or an element of one that bends: a bar where the media take bars and it is round, else its surface."""
    element = spec if isinstance(spec, Element) else Element(spec, 0.0, spec.length_m)
    link, own = element.link, section(element.link)
    a, b = (np.array([x, 0.0, 0.0]) for x in (element.start, element.end))
    length, mass = element.end - element.start, of_bar(own, element)
    if own.diameter is not None and ("bar" in media or not media):
        return _bar(name, made.Bar(np.array([a, b]), own.diameter, strips, element.ends[1]), True), mass
    if own.diameter is not None and not isinstance(spec, Element):
        turn = rotations.to_axis(np.array([1.0, 0.0, 0.0]))
        tube = _shared(round_shapes.Cylinder, own.diameter, length)
        return _part(name, tube, ("surface",), 0.5 * (a + b), turn, True, link.facet_size_m), mass
    size = link.facet_size_m
    if size is None and isinstance(spec, Element):
        size = max(0.25 * length / element.share, min(own.width, own.thickness))
    shape = _shared(Beam, length, (own.width, own.thickness), own.diameter is not None, element.ends)
    return _part(name, shape, ("surface",), 0.5 * (a + b), np.eye(3), True, size), mass


def moved(part: Part, position: Vector, rotation: Vector) -> Part:
    """A part in a frame in which that of its body lies at a position (3,) m, turned by (3, 3)."""
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
    """A shape of a kind, one for all bodies that have it."""
    return kind(*numbers)


@lru_cache(maxsize=_KEPT)
def _made(spec: Any) -> tuple[Any, Mass]:
    """Shape of a config in its own frame, with its mass properties; bodies with the same one share it."""
    if isinstance(spec, shapes_schema.SpatialPolygon):
        body = _extruded(np.array(spec.points_m), spec.width_m)
        return body, of_surface(body.vertices[body.faces])
    if isinstance(spec, shapes_schema.SpatialArc):
        return _bent(spec), of_arc(spec)
    if isinstance(spec, shapes_schema.SpatialWheel):
        if spec.grousers is None:
            return round_shapes.Cylinder(2 * spec.radius_m, spec.width_m), of_cylinder(2 * spec.radius_m, spec.width_m)
        body = _extruded(wheel_outline(spec.radius_m, spec.grousers, CHORDS)[0][:-1], spec.width_m)
        return body, of_surface(body.vertices[body.faces])
    zero = np.zeros(3)
    if isinstance(spec, shapes_schema.SpatialBox):
        a, b, c = spec.size_m
        return made.Box(spec.size_m), solid(a * b * c, zero, np.diag([a * a, b * b, c * c]) / 12.0)
    if isinstance(spec, shapes_schema.SpatialPlate):
        a, b, t = *spec.size_m, spec.thickness_m
        return made.Plate(spec.size_m), solid(a * b * t, zero, np.diag([a * a, b * b, t * t]) / 12.0)
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
    """A mesh of a config in its own frame, with its mass properties and notes."""
    path, sheet = Path(spec.file), spec.thickness_m or 0.0
    changed = path.stat().st_mtime_ns if path.is_file() else None
    found, mass = _looked_through(path, changed, spec.scale, spec.thin, sheet)
    doubts = _doubts(path, changed, spec.scale) if spec.in_sand and not spec.thin else ()
    return found, mass, (*found.notes, *doubts)


@lru_cache(maxsize=_KEPT)
def _looked_through(
    path: Path, changed: int | None, scale: float | tuple[float, ...] | None, thin: bool, thickness: float
) -> tuple[Any, Mass]:
    """Mesh of a file that was changed at a time (ns), and its mass; many bodies, and the runs of a sweep, share one."""
    del changed
    found = Mesh.read(path, scale=scale, thin=thin)
    return found, of_sheet(found, thickness) if thin else of_surface(found.vertices[found.faces])


@lru_cache(maxsize=_KEPT)
def _doubts(path: Path, changed: int | None, scale: float | tuple[float, ...] | None) -> tuple[str, ...]:
    """What makes forces on the mesh of a file uncertain."""
    found, _ = _looked_through(path, changed, scale, False, 0.0)
    return quality_notes(found.vertices, found.faces)


def _length(spec: Any) -> float:
    if spec.start_m is not None and spec.end_m is not None:
        return math.dist(spec.start_m, spec.end_m)
    return float(spec.length_m)


def _extruded(section: Vector, width: float) -> Any:
    """Solid of a section (k, 2) m in the x-z plane."""
    corners = [(float(x), float(z)) for x, z in section]
    if np.sum(section[:, 0] * np.roll(section[:, 1], -1) - section[:, 1] * np.roll(section[:, 0], -1)) < 0.0:
        corners.reverse()
    return Extrusion(np.array(corners), width, ears(corners), name="polygon")


def _bent(spec: Any) -> Any:
    """Thin sheet along an arc, of chords."""
    start, end = math.radians(spec.from_deg), math.radians(spec.to_deg)
    chords = max(2, math.ceil(CHORDS * abs(end - start) / (2.0 * math.pi)))
    angles = np.linspace(start, end, chords + 1)
    line = spec.radius_m * np.column_stack([np.cos(angles), -np.sin(angles)])
    return Extrusion(line, spec.width_m, name="arc")


def outermost(points: Vector) -> Vector:
    """Of many points (n, 3) m those that are outermost in some direction: all that can be deepest, or nearly so."""
    if len(points) > 4 * len(_DIRECTIONS):  # a mesh of many triangles: to sort its corners would take long
        points = points[_extreme(points)]
    found: Vector = np.unique(points, axis=0)
    return found if len(found) <= len(_DIRECTIONS) else np.asarray(found[_extreme(found)])


def _extreme(points: Vector) -> NDArray[np.int64]:
    """Which points are farthest in one of the directions; a matrix product would wait for its threads."""
    x, y, z = np.ascontiguousarray(points.T)
    return np.unique([int((a * x + b * y + c * z).argmax()) for a, b, c in _DIRECTIONS])


def _around(count: int) -> Vector:
    """Directions (count, 3) spread evenly over a sphere, along a spiral."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = math.pi * (1.0 + math.sqrt(5.0)) * np.arange(count)
    rho = np.sqrt(1.0 - z * z)
    return np.column_stack([rho * np.cos(turn), rho * np.sin(turn), z])


_DIRECTIONS = _around(400)
