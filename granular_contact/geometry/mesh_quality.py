"""Quality of a mesh as the surface of a body: closed, outward, in one piece, without faces inside."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry import mesh

Vector = NDArray[np.float64]
Faces = NDArray[np.int64]
LARGEST = 3.0  # greatest size (m): a larger mesh is probably in another unit
SMALLEST = 1e-3  # least length (m) of the largest side
INNER = 0.01  # share of the area inside above which there is a note
_WORK = 2_000_000  # number of triangles times number of sample points
_WORK_AT_ONCE, _FEWEST, _ENOUGH = 40_000, 8, 64  # the same where a model is loaded; least and greatest number of points
_NEAR = 1e-4  # distance of a sample point from its face, divided by the extent


@dataclass(frozen=True)
class Quality:
    """Quality of a mesh in m.

    Parameters
    ----------
    triangles : int
        Number of triangles.
    size : (3,) array
        Sides of the bounding box (m).
    area : float
        Area (m^2).
    volume : float
        Volume (m^3), negative if the mesh is inside out.
    parts : int
        Number of pieces that share no vertex.
    inner : float
        Share of the area that lies inside the body, estimated from sample points.
    faults : tuple of str
        Reasons why laws of surfaces can't use the mesh.
    notes : tuple of str
        Reasons why forces on it may be wrong.
    """

    triangles: int
    size: Vector
    area: float
    volume: float
    parts: int
    inner: float
    faults: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def closed(self) -> bool:
        """Whether every edge belongs to at least two triangles."""
        return not any(fault.startswith("it is open") for fault in self.faults)

    @property
    def outward(self) -> bool:
        """Whether the triangles are counter-clockwise seen from outside."""
        return self.volume > 0.0 and not any("turned opposite" in fault for fault in self.faults)


def quality(vertices: Vector, faces: Faces) -> Quality:
    """Quality of a mesh.

    Parameters
    ----------
    vertices : (n, 3) array
        Vertices (m).
    faces : (m, 3) array of int
        Triangles.
    """
    size = np.ptp(vertices[faces].reshape(-1, 3), axis=0)
    faults = list(mesh.faults(vertices, faces, thin=False))
    empty = mesh.without_area(vertices, faces)
    if empty.all():
        return Quality(len(faces), size, 0.0, 0.0, 0, 0.0, tuple(faults), ())
    count, faces = len(faces), faces[~empty]
    corners = vertices[faces]
    cross = mesh.areas(corners)
    area = np.linalg.norm(cross, axis=1)
    volumes = np.einsum("ij,ij->i", corners.mean(axis=1) - corners[0, 0], cross) / 3.0
    joined = mesh.joined(vertices, faces)
    piece, parts = _pieces(joined)
    inner = _inner(corners, cross, area, _piece_volumes(piece, volumes), max(16, min(256, _WORK // len(corners))))
    notes = [*mesh.empty_note(empty), *_notes(size, parts, inner, joined)]
    if size.max() > LARGEST:
        faults.append(f"it is {sides(size)} m large: if it is in millimetres, give it the scale 0.001")
    return Quality(
        count, size, float(area.sum()), float(volumes.sum()), parts, inner, tuple(faults), tuple(notes)
    )  # fmt: skip


def quality_notes(vertices: Vector, faces: Faces) -> tuple[str, ...]:
    """Notes of `quality` on a closed mesh at a small part of its cost, for every mesh that is loaded.

    Faces inside are estimated from fewer sample points, and not at all in a large mesh of one piece.

    Parameters
    ----------
    vertices : (n, 3) array
        Vertices (m).
    faces : (m, 3) array of int
        Triangles.
    """
    corners = vertices[faces]
    joined = mesh.joined(vertices, faces)
    piece, parts = _pieces(joined)
    count, inner = min(_ENOUGH, _WORK_AT_ONCE // len(faces)), 0.0
    if parts > 1 or count >= _FEWEST:
        cross = mesh.areas(corners)
        volumes = np.einsum("ij,ij->i", corners.mean(axis=1) - corners[0, 0], cross) / 3.0
        area = np.linalg.norm(cross, axis=1)
        inner = _inner(corners, cross, area, _piece_volumes(piece, volumes), max(_FEWEST, count))
    return tuple(_notes(np.ptp(corners.reshape(-1, 3), axis=0), parts, inner, joined))


def _notes(size: Vector, parts: int, inner: float, faces: Faces) -> Iterator[str]:
    """Sentences on a mesh that can be used, but on which forces may be wrong."""
    if size.max() < SMALLEST:
        yield f"it is {sides(1e3 * size)} mm small: is its scale right?"
    a, b, c = np.sort(faces, axis=1).T
    count = int(faces.max()) + 1
    if duplicates := len(faces) - len(np.unique((a * count + b) * count + c)):
        yield f"{duplicates} triangles stand there twice, and the medium acts on each"
    if inner > INNER:
        yield f"about {100 * inner:.0f} % of its area lies inside it, where the medium acts, too"
    if parts > 1:
        yield f"it is made of {parts} loose parts"


def sides(size: Vector) -> str:
    """Sides (3,) of a box as text, without a unit."""
    return " x ".join(f"{side:.4g}" for side in size)


def _pieces(faces: Faces) -> tuple[Faces, int]:
    """Number of the piece of each face (m, 3), and the number of pieces.

    Every vertex points to a vertex of its piece with a lower number, or to itself, until all point to the lowest one.
    """
    lowest, before = np.arange(int(faces.max()) + 1), np.zeros(0, np.int64)
    while not np.array_equal(lowest, before):
        before = lowest.copy()
        np.minimum.at(lowest, faces.ravel(), np.repeat(lowest[faces].min(axis=1), 3))
        lowest = lowest[lowest]
    labels, piece = np.unique(lowest[faces[:, 0]], return_inverse=True)
    return piece.reshape(-1), len(labels)


def _piece_volumes(piece: Faces, volumes: Vector) -> Vector:
    """Volume of the piece of each face."""
    face_volumes: Vector = np.bincount(piece, volumes).astype(float)[piece]
    return face_volumes


def _inner(corners: Vector, cross: Vector, area: Vector, part_volume: Vector, points: int) -> float:
    """Share of the area inside the body, in cavities or within another piece, estimated from so many sample points.

    part_volume (m,): signed volume of the piece of each face.
    """
    sense = 1.0 if part_volume.sum() >= 0.0 else -1.0
    hollow = part_volume * sense < 0.0
    if hollow.all() or area.sum() == 0.0:
        return 0.0
    chosen = _sample(area, points)
    offset = _NEAR * mesh.extent(corners)
    before = corners[chosen].mean(axis=1) + sense * offset * cross[chosen] / area[chosen, None]
    within = np.abs(winding(before, corners)) > 0.5
    return float(np.mean(within | hollow[chosen]))


def _sample(area: Vector, count: int) -> Faces:
    """Faces at equal steps of the cumulative area, so that each sample stands for the same area."""
    upto = np.cumsum(area)
    return np.asarray(np.searchsorted(upto, (np.arange(count) + 0.5) / count * upto[-1]), np.int64)


def winding(points: Vector, corners: Vector) -> Vector:
    """Winding number of a surface around points: 0 outside a closed surface, 1 inside.

    The solid angles are those of van Oosterom and Strackee (1983), IEEE Trans. Biomed. Eng. 30, 125.

    Parameters
    ----------
    points : (n, 3) array
        Points (m).
    corners : (m, 3, 3) array
        Triangles (m).

    Returns
    -------
    (n,) array
    """
    windings = np.empty(len(points))
    rows = [np.ascontiguousarray(corners[:, k].T) for k in range(3)]  # contiguous x, y and z: several times faster
    for i, point in enumerate(points):
        a, b, c = (row - point[:, None] for row in rows)
        la, lb, lc = (np.sqrt(_dot(v, v)) for v in (a, b, c))
        numerator = a[0] * (b[1] * c[2] - b[2] * c[1])
        numerator += a[1] * (b[2] * c[0] - b[0] * c[2])
        numerator += a[2] * (b[0] * c[1] - b[1] * c[0])
        denominator = la * lb * lc + _dot(a, b) * lc + _dot(b, c) * la + _dot(c, a) * lb
        windings[i] = np.arctan2(numerator, denominator).sum() / (2.0 * np.pi)
    return windings


def _dot(v: Vector, w: Vector) -> Vector:
    """Scalar products (m,) of vectors (3, m)."""
    product: Vector = v[0] * w[0] + v[1] * w[1] + v[2] * w[2]
    return product


def share_inside(corners: Vector, others: Vector) -> float:
    """Share of the area of a surface that lies inside a closed surface.

    Parameters
    ----------
    corners : (m, 3, 3) array
        Triangles of the surface (m).
    others : (k, 3, 3) array
        Triangles of the closed surface (m).
    """
    low, high = others.min(axis=(0, 1)), others.max(axis=(0, 1))
    middles = corners.mean(axis=1)
    near = ((middles > low) & (middles < high)).all(axis=1)
    area = np.linalg.norm(mesh.areas(corners), axis=1)
    if not near.any() or area.sum() == 0.0:
        return 0.0
    chosen = _sample(area, max(16, min(256, _WORK // len(others))))
    points = middles[chosen][near[chosen]]
    return float(np.sum(np.abs(winding(points, others)) > 0.5) / len(chosen))
