"""Triangles of a mesh: their areas, and what is wrong with the surface they make. Needs numpy alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
NO_AREA = 1e-12  # of the square of the extent


def extent(points: Vector) -> float:
    """Diagonal (m) of the box around points (..., 3)."""
    flat = points.reshape(-1, 3)
    return float(np.linalg.norm(flat.max(axis=0) - flat.min(axis=0))) if len(flat) else 0.0


def areas(corners: Vector) -> Vector:
    """Areas (n,) m^2 of triangles (n, 3, 3) m, times their unit normals: vectors (n, 3)."""
    cross: Vector = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return cross


def joined(vertices: Vector, faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Faces (n, 3) by numbers that are the same for vertices at the same place, as files keep them apart."""
    low = vertices.min(axis=0)
    cell = max(1e-30, float((vertices.max(axis=0) - low).max())) / 2**20
    x, y, z = np.rint((vertices - low) / cell).astype(np.int64).T
    _, numbers = np.unique((x << 42) + (y << 21) + z, return_inverse=True)
    return np.asarray(numbers.reshape(-1)[faces], dtype=np.int64)


def without_area(vertices: Vector, faces: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which faces (n,) have no area, so that no medium acts on them."""
    found: NDArray[np.bool_] = np.linalg.norm(areas(vertices[faces]), axis=1) <= NO_AREA * extent(vertices) ** 2
    return found


def empty_note(empty: NDArray[np.bool_]) -> tuple[str, ...]:
    """What is said of faces (n,) without area: a sentence, or nothing if there are none."""
    if not empty.any():
        return ()
    first = int(np.argmax(empty)) + 1
    return (f"{int(empty.sum())} of its {len(empty)} triangles have no area and are left out, the first is {first}",)


def faults(vertices: Vector, faces: NDArray[np.int64], thin: bool) -> Iterator[str]:
    """What is wrong with a mesh, one sentence each; thin: it is a sheet, and need not enclose anything.

    Triangles without area count for whether it is closed, as they close what is open between their corners.
    """
    if without_area(vertices, faces).all():
        yield f"none of its {len(faces)} triangles has an area"
        return
    corners = vertices[faces]
    cross = areas(corners)
    if thin:
        return
    loose, turned = _edges(joined(vertices, faces))
    if loose:
        yield f"it is open: {loose} edges belong to one triangle only; allowed is a closed surface or a thin sheet"
    if turned:
        yield f"at {turned} edges two triangles are turned opposite ways; allowed is one sense, seen from outside"
    if not (loose or turned) and np.sum(corners[:, 0] * cross) < 0.0:
        yield "it is inside out: seen from outside its triangles turn clockwise, allowed is counter-clockwise"


def _edges(faces: NDArray[np.int64]) -> tuple[int, int]:
    """Number of edges that belong to one triangle only, and of those that two run along in the same sense."""
    kept = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    start, end = kept.ravel(), np.roll(kept, -1, axis=1).ravel()
    key = np.minimum(start, end) * (int(faces.max()) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.diff(key[order], prepend=-1))
    balance = np.add.reduceat(np.where(start < end, 1, -1)[order], first)
    number = np.diff(first, append=len(order))
    return int(np.sum(number == 1)), int(np.sum((balance != 0) & (number > 1)))
