"""Geoms of a MuJoCo model -> shapes in space, or sections in the plane, in the frames of their bodies."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.engine import mujoco, name_of
from granular_contact.errors import Fault, SceneError, scene_fault
from granular_contact.sand.kernels.facet_records import PARALLELOGRAM
from granular_contact.sand.space import round_shapes, shapes
from granular_contact.sand.space.facets import Facets, Size
from granular_contact.sand.space.mesh_shape import Mesh

Vector = NDArray[np.float64]
KIND = mujoco.mjtGeom
FLAT = {KIND.mjGEOM_PLANE: "plane", KIND.mjGEOM_HFIELD: "height field"}


@dataclass(frozen=True)
class Geom:
    """A geom of a model.

    number, body: numbers of the geom and of its body. position (3,) m and rotation (3, 3): of the geom in the frame of
    its body. kind: its `mjtGeom`. size (3,) m: as MuJoCo has it.
    """

    number: int
    body: int
    name: str
    position: Vector
    rotation: Vector
    kind: int
    size: Vector


def chosen(model: Any, pattern: str, taken: Sequence[int]) -> list[Geom]:
    """Geoms whose whole name, or the name of their body if they have none, fits a regular expression.

    If a body has geoms that can collide, its other geoms are for display alone, and are skipped. taken: numbers of
    geoms that are in sand already.

    Raises
    ------
    SceneError
        The pattern is no regular expression, no geom fits it, or a geom has no volume, belongs to the world or is in
        sand already.
    """
    try:
        fits = re.compile(pattern)
    except (re.error, TypeError) as error:
        raise SceneError([_fault(f"got {pattern!r}, allowed is a regular expression ({error})")]) from None
    numbers = [g for g in range(model.ngeom) if fits.fullmatch(_name(model, g))]
    if not numbers:
        known = ", ".join(dict.fromkeys(_name(model, g) for g in range(model.ngeom))) or "none"
        raise SceneError([_fault(f"no geom fits {pattern!r}; the model has {known}")])
    with_colliding = {int(model.geom_bodyid[g]) for g in numbers if _collides(model, g)}
    numbers = [g for g in numbers if _collides(model, g) or int(model.geom_bodyid[g]) not in with_colliding]
    if faults := [fault for g in numbers for fault in _faults(model, g, taken)]:
        raise SceneError(faults)
    return [geom_by_number(model, g) for g in numbers]


def geom_by_number(model: Any, number: int) -> Geom:
    """A geom by its number."""
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[number])
    body, position = int(model.geom_bodyid[number]), model.geom_pos[number].copy()
    kind, size = int(model.geom_type[number]), model.geom_size[number].copy()
    return Geom(number, body, _name(model, number), position, rotation.reshape(3, 3), kind, size)


def shape(model: Any, geom: Geom, *, bars: bool, hull: bool) -> shapes.Shape:
    """Shape of a geom, in the frame of the geom; errors are those of the shape.

    bars: whether capsules and cylinders are thin bars. hull: whether the convex hull of a mesh is taken, as in MuJoCo's
    contacts.
    """
    a, b, c = (float(s) for s in geom.size)
    if geom.kind == KIND.mjGEOM_SPHERE:
        return round_shapes.Sphere(2.0 * a)
    if geom.kind in (KIND.mjGEOM_CAPSULE, KIND.mjGEOM_CYLINDER):
        if bars:
            return shapes.Bar([[0.0, 0.0, -b], [0.0, 0.0, b]], 2.0 * a)
        solid = round_shapes.Capsule if geom.kind == KIND.mjGEOM_CAPSULE else round_shapes.Cylinder
        return solid(2.0 * a, 2.0 * b)
    if geom.kind == KIND.mjGEOM_ELLIPSOID:
        return _Ellipsoid((a, b, c))
    if geom.kind == KIND.mjGEOM_BOX:
        return shapes.Box((2.0 * a, 2.0 * b, 2.0 * c))
    return _mesh(model, geom, hull)


class Outside(shapes.Shape):
    """Part of the surface of a geom outside other geoms of its body: the facets whose centroid is outside."""

    def __init__(self, whole: shapes.Shape, geom: Geom, others: Sequence[Geom]) -> None:
        self._whole, self._geom, self._others = whole, geom, others
        self.thin = whole.thin

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        corners = self._whole.corners(size)
        return corners[self._are_outside(corners.mean(axis=1))]

    def facets(self, size: float | None = None, accuracy: float | None = None, share: float = 1.0) -> Facets:
        """As `Shape.facets`."""
        facets = self._whole.facets(size, accuracy, share)
        return facets.subset(self._are_outside(facets.place))

    def rims(self) -> Vector:
        """As `Shape.rims`."""
        return self._whole.rims()

    def _are_outside(self, points: Vector) -> NDArray[np.bool_]:
        """Which points (n, 3) m, in the frame of the geom, are outside all other geoms."""
        body_points = points @ self._geom.rotation.T + self._geom.position
        inside = np.zeros(len(points), dtype=bool)
        for other in self._others:
            inside |= _are_inside(other, body_points)
        return ~inside


def _are_inside(geom: Geom, points: Vector) -> NDArray[np.bool_]:
    """Which points (n, 3) m, in the frame of the body, are inside a primitive; for a mesh none are."""
    x, y, z = ((points - geom.position) @ geom.rotation).T
    a, b, c = geom.size * (1.0 - 1e-9)
    if geom.kind == KIND.mjGEOM_SPHERE:
        inside = x * x + y * y + z * z < a * a
    elif geom.kind == KIND.mjGEOM_CAPSULE:
        inside = x * x + y * y + np.maximum(0.0, np.abs(z) - b) ** 2 < a * a
    elif geom.kind == KIND.mjGEOM_CYLINDER:
        inside = (x * x + y * y < a * a) & (np.abs(z) < b)
    elif geom.kind == KIND.mjGEOM_ELLIPSOID:
        inside = (x / a) ** 2 + (y / b) ** 2 + (z / c) ** 2 < 1.0
    elif geom.kind == KIND.mjGEOM_BOX:
        inside = (np.abs(x) < a) & (np.abs(y) < b) & (np.abs(z) < c)
    else:
        inside = np.zeros(len(points), dtype=bool)
    return np.asarray(inside)


class _Ellipsoid(shapes.Shape):
    """Ellipsoid with the given radii (m) along the axes of its frame."""

    def __init__(self, radii: tuple[float, float, float]) -> None:
        self._radii = np.array(radii)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        smallest, largest = float(self._radii.min()), float(self._radii.max())
        edge = 2.0 * np.sqrt(3.0) * largest / shapes.PARTS if size is None else size
        unit = round_shapes.Sphere(2.0).corners(max(edge / largest, 0.2 * smallest / largest))
        return np.ascontiguousarray(unit * self._radii)

    def cut_facets(self, size: Size) -> Facets:
        """As `Shape.cut_facets`: those of a sphere of radius 1 m, scaled by the radii S along the axes."""
        S, smallest, largest = self._radii, float(self._radii.min()), float(self._radii.max())
        unit = round_shapes.Sphere(2.0).cut_facets(Size(size.edge / largest, size.turn * max(0.3, smallest / largest)))
        a, b, normal = S * unit.a, S * unit.b, unit.normal / S
        length = np.linalg.norm(normal, axis=1)
        curvature = [np.sum(e * e, axis=1) / length / np.sum(f * f, axis=1) for e, f in ((unit.a, a), (unit.b, b))]
        return Facets(
            *(S * unit.place, normal / length[:, None], unit.area * S.prod() * length, a, b),
            *(np.full(len(length), PARALLELOGRAM), np.stack(curvature, axis=1)),
        )


def _mesh(model: Any, geom: Geom, hull: bool) -> shapes.Shape:
    """Shape of a mesh, or of its convex hull; SceneError if it is open."""
    mesh = int(model.geom_dataid[geom.number])
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    vertices = np.asarray(model.mesh_vert[first : first + count], float)
    first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    faces = np.asarray(model.mesh_face[first : first + count], np.int64)
    if hull:
        vertices, faces = _hull(vertices)
    try:
        return Mesh(vertices, faces, scale=1.0, name=f"geom {geom.name}")
    except SceneError as error:
        advice = "add_geoms(..., hull=True) takes its convex hull, as MuJoCo's contacts do"
        raise SceneError([Fault(f.file, f.line, f.key, f"{f.message}; {advice}") for f in error.faults]) from None


def _hull(vertices: Vector) -> tuple[Vector, NDArray[np.int64]]:
    """Convex hull of points (n, 3): the points, and its triangles (k, 3), counter-clockwise seen from outside."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(vertices)
    faces = hull.simplices.astype(np.int64)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    inward = np.sum(np.cross(b - a, c - a) * hull.equations[:, :3], axis=1) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return vertices, faces


# ---- in the plane ----


def section(geom: Geom, s: Vector, t: Vector) -> tuple[Vector, float, Vector | None]:
    """Section of a geom with a plane: corners (k, 2) m, width (m) across the plane, and turns of round sides (rad).

    s, t (3,): axes of the plane in the frame of the body. turns (k,): see `contact_lines.outline`; None if straight.

    Raises
    ------
    SceneError
        A geom of this kind, or in this orientation, has no such section.
    """
    normal = np.cross(t, s)
    axes = geom.rotation.T @ np.column_stack([s, t, normal])  # in the frame of the geom
    a, b, c = (float(size) for size in geom.size)
    centre = np.array([geom.position @ s, geom.position @ t])
    across = int(np.argmax(np.abs(axes[:, 2])))  # axis of the geom that is closest to the normal
    if geom.kind == KIND.mjGEOM_BOX and abs(axes[across, 2]) > 1.0 - 1e-9:
        half = np.array([a, b, c])
        i, j = (across + 1) % 3, (across + 2) % 3
        e, f = half[i] * axes[i, :2], half[j] * axes[j, :2]
        return centre + np.array([-e - f, e - f, e + f, f - e]), 2.0 * half[across], None
    if geom.kind == KIND.mjGEOM_CYLINDER and abs(axes[2, 2]) > 1.0 - 1e-9:
        angles = np.arange(12) * np.pi / 6.0
        return centre + a * np.column_stack([np.cos(angles), np.sin(angles)]), 2.0 * b, np.full(12, np.pi / 6.0)
    allowed = "allowed in a plane are boxes with a side across it, cylinders across it and, for laws of balls, spheres"
    raise SceneError([_fault(f"geom {geom.name}: got one without a section, {allowed}; others by add_outline")])


# ---- checks of geoms ----


def _name(model: Any, number: int) -> str:
    """Name of a geom, or of its body if it has none."""
    name: str | None = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, number)
    return name or name_of(model, "body", int(model.geom_bodyid[number]))


def _collides(model: Any, number: int) -> bool:
    """Whether a geom can collide at all."""
    return bool(model.geom_contype[number] or model.geom_conaffinity[number])


def _faults(model: Any, number: int, taken: Sequence[int]) -> list[Fault]:
    """Faults of a geom that cannot be in sand; taken: numbers of geoms that are in sand already."""
    name, kind = _name(model, number), int(model.geom_type[number])
    if number in taken:
        return [_fault(f"geom {name} is in the sand already")]
    if kind in FLAT:
        return [
            _fault(f"geom {name} is a {FLAT[KIND(kind)]} and has no volume; allowed are primitives and closed meshes")
        ]
    if int(model.body_weldid[model.geom_bodyid[number]]) == 0:
        return [_fault(f"geom {name} is fixed to the world: sand does not move it (a missing <freejoint/>?)")]
    return []


def _fault(message: str) -> Fault:
    return scene_fault("bed.add_geoms", message)
