"""Geoms of a model -> shapes in space, or sections in the plane, in the frames of their bodies."""

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
    """A geom: its number, that of its body, its name, kind and sizes; place (3,) m and turn (3, 3) in its frame."""

    number: int
    body: int
    name: str
    place: Vector
    turn: Vector
    kind: int
    size: Vector


def chosen(model: Any, pattern: str, taken: Sequence[int]) -> list[Geom]:
    """Geoms whose name, or that of their body if they have none, fits a regular expression as a whole.

    Of a body with geoms that can collide those that can not are pictures, and are left out.

    Raises
    ------
    SceneError
        It is no regular expression; none fits, one has no volume, belongs to the world or is in the sand already.
    """
    try:
        fits = re.compile(pattern)
    except (re.error, TypeError) as error:
        raise SceneError([_fault(f"got {pattern!r}, allowed is a regular expression ({error})")]) from None
    found = [g for g in range(model.ngeom) if fits.fullmatch(_called(model, g))]
    if not found:
        known = ", ".join(dict.fromkeys(_called(model, g) for g in range(model.ngeom))) or "none"
        raise SceneError([_fault(f"no geom fits {pattern!r}; the model has {known}")])
    solid = {int(model.geom_bodyid[g]) for g in found if _collides(model, g)}
    found = [g for g in found if _collides(model, g) or int(model.geom_bodyid[g]) not in solid]
    if faults := [fault for g in found for fault in _faults(model, g, taken)]:
        raise SceneError(faults)
    return [geom(model, g) for g in found]


def geom(model: Any, number: int) -> Geom:
    """A geom by its number."""
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.geom_quat[number])
    body, place, size = int(model.geom_bodyid[number]), model.geom_pos[number].copy(), model.geom_size[number].copy()
    return Geom(number, body, _called(model, number), place, turn.reshape(3, 3), int(model.geom_type[number]), size)


def shape(model: Any, one: Geom, *, bars: bool, hull: bool) -> tuple[shapes.Shape, Vector]:
    """Shape of a geom, and the turn (3, 3) from its frame to the body's; errors as of the shape.

    bars: capsules and cylinders are thin bars; hull: of meshes the convex hull counts, as MuJoCo collides them.
    """
    a, b, c = (float(s) for s in one.size)
    if one.kind == KIND.mjGEOM_SPHERE:
        return round_shapes.Sphere(2.0 * a), one.turn
    if one.kind in (KIND.mjGEOM_CAPSULE, KIND.mjGEOM_CYLINDER):
        if bars:
            return shapes.Bar([[0.0, 0.0, -b], [0.0, 0.0, b]], 2.0 * a), one.turn
        solid = round_shapes.Capsule if one.kind == KIND.mjGEOM_CAPSULE else round_shapes.Cylinder
        return solid(2.0 * a, 2.0 * b), one.turn
    if one.kind == KIND.mjGEOM_ELLIPSOID:
        return _Ellipsoid((a, b, c)), one.turn
    if one.kind == KIND.mjGEOM_BOX:
        return shapes.Box((2.0 * a, 2.0 * b, 2.0 * c)), one.turn
    return _mesh(model, one, hull), one.turn


class Outside(shapes.Shape):
    """What of the surface of a geom lies outside others of its body: facets whose centroid does."""

    def __init__(self, whole: shapes.Shape, one: Geom, others: Sequence[Geom]) -> None:
        self._whole, self._one, self._others = whole, one, others
        self.thin = whole.thin

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        made = self._whole.corners(size)
        return made[self._shown(made.mean(axis=1))]

    def facets(self, size: float | None = None, accuracy: float | None = None, share: float = 1.0) -> Facets:
        """As `Shape.facets`."""
        made = self._whole.facets(size, accuracy, share)
        return made.subset(self._shown(made.place))

    def rims(self) -> Vector:
        """As `Shape.rims`."""
        return self._whole.rims()

    def _shown(self, places: Vector) -> NDArray[np.bool_]:
        """Which places (n, 3) m in the frame of the geom are outside all others."""
        placed = places @ self._one.turn.T + self._one.place
        hidden = np.zeros(len(places), dtype=bool)
        for other in self._others:
            hidden |= _inside(other, placed)
        return ~hidden


def _inside(one: Geom, places: Vector) -> NDArray[np.bool_]:
    """Which of some places (n, 3) m of the body's frame lie in a primitive; none in a mesh."""
    x, y, z = ((places - one.place) @ one.turn).T
    a, b, c = one.size * (1.0 - 1e-9)
    if one.kind == KIND.mjGEOM_SPHERE:
        found = x * x + y * y + z * z < a * a
    elif one.kind == KIND.mjGEOM_CAPSULE:
        found = x * x + y * y + np.maximum(0.0, np.abs(z) - b) ** 2 < a * a
    elif one.kind == KIND.mjGEOM_CYLINDER:
        found = (x * x + y * y < a * a) & (np.abs(z) < b)
    elif one.kind == KIND.mjGEOM_ELLIPSOID:
        found = (x / a) ** 2 + (y / b) ** 2 + (z / c) ** 2 < 1.0
    elif one.kind == KIND.mjGEOM_BOX:
        found = (np.abs(x) < a) & (np.abs(y) < b) & (np.abs(z) < c)
    else:
        found = np.zeros(len(places), dtype=bool)
    return np.asarray(found)


class _Ellipsoid(shapes.Shape):
    """Sphere of which each axis has its own radius (m)."""

    def __init__(self, radii: tuple[float, float, float]) -> None:
        self._radii = np.array(radii)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        least, most = float(self._radii.min()), float(self._radii.max())
        fine = 2.0 * np.sqrt(3.0) * most / shapes.PARTS if size is None else size
        unit = round_shapes.Sphere(2.0).corners(max(fine / most, 0.2 * least / most))
        return np.ascontiguousarray(unit * self._radii)

    def cut_facets(self, size: Size) -> Facets:
        """As `Shape.cut_facets`: those of a sphere of radius 1 m, stretched along the axes."""
        S, least, most = self._radii, float(self._radii.min()), float(self._radii.max())
        unit = round_shapes.Sphere(2.0).cut_facets(Size(size.edge / most, size.turn * max(0.3, least / most)))
        a, b, normal = S * unit.a, S * unit.b, unit.normal / S
        grown = np.linalg.norm(normal, axis=1)
        curve = [np.sum(e * e, axis=1) / grown / np.sum(f * f, axis=1) for e, f in ((unit.a, a), (unit.b, b))]
        return Facets(
            *(S * unit.place, normal / grown[:, None], unit.area * S.prod() * grown, a, b),
            *(np.full(len(grown), PARALLELOGRAM), np.stack(curve, axis=1)),
        )


def _mesh(model: Any, one: Geom, hull: bool) -> shapes.Shape:
    mesh = int(model.geom_dataid[one.number])
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    vertices = np.asarray(model.mesh_vert[first : first + count], float)
    first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    faces = np.asarray(model.mesh_face[first : first + count], np.int64)
    if hull:
        vertices, faces = _hull(vertices)
    try:
        return Mesh(vertices, faces, scale=1.0, name=f"geom {one.name}")
    except SceneError as error:
        more = "add_geoms(..., hull=True) takes its convex hull, as MuJoCo's contacts do"
        raise SceneError([Fault(f.file, f.line, f.key, f"{f.message}; {more}") for f in error.faults]) from None


def _hull(vertices: Vector) -> tuple[Vector, NDArray[np.int64]]:
    """Convex hull of points (n, 3), its triangles counter-clockwise seen from outside."""
    from scipy.spatial import ConvexHull

    found = ConvexHull(vertices)
    faces = found.simplices.astype(np.int64)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    inward = np.sum(np.cross(b - a, c - a) * found.equations[:, :3], axis=1) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return vertices, faces


# ---- in the plane ----


def section(one: Geom, along: Vector, up: Vector) -> tuple[Vector, float, Vector | None]:
    """Section of a geom in a plane: corners (k, 2) m, width across (m), and the turns of its sides (rad) if round.

    along, up (3,): the axes of the plane in the body's frame.

    Raises
    ------
    SceneError
        A geom of this kind, or in this position, has no such section.
    """
    across = np.cross(up, along)
    axes = one.turn.T @ np.column_stack([along, up, across])  # in the frame of the geom
    a, b, c = (float(s) for s in one.size)
    centre = np.array([one.place @ along, one.place @ up])
    which = int(np.argmax(np.abs(axes[:, 2])))
    if one.kind == KIND.mjGEOM_BOX and abs(axes[which, 2]) > 1.0 - 1e-9:
        half = np.array([a, b, c])
        i, j = (which + 1) % 3, (which + 2) % 3
        s, t = half[i] * axes[i, :2], half[j] * axes[j, :2]
        return centre + np.array([-s - t, s - t, s + t, t - s]), 2.0 * half[which], None
    if one.kind == KIND.mjGEOM_CYLINDER and abs(axes[2, 2]) > 1.0 - 1e-9:
        angles = np.arange(12) * np.pi / 6.0
        return centre + a * np.column_stack([np.cos(angles), np.sin(angles)]), 2.0 * b, np.full(12, np.pi / 6.0)
    allowed = "allowed in a plane are boxes with a side across it, cylinders across it and, for laws of balls, spheres"
    raise SceneError([_fault(f"geom {one.name}: got one without a section, {allowed}; others by add_outline")])


# ---- whether a geom can be in the sand ----


def _called(model: Any, number: int) -> str:
    named: str | None = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, number)
    return named or name_of(model, "body", int(model.geom_bodyid[number]))


def _collides(model: Any, number: int) -> bool:
    return bool(model.geom_contype[number] or model.geom_conaffinity[number])


def _faults(model: Any, number: int, taken: Sequence[int]) -> list[Fault]:
    name, kind = _called(model, number), int(model.geom_type[number])
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
