"""Triangles of a mesh: areas, faults of the surface that they form, and mesh files.

The module needs NumPy only. Files other than binary STL are read by trimesh, which is imported only for them.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import scene_error
from granular_contact.geometry.rotations import vector_products

Vector = NDArray[np.float64]
NO_AREA = 1e-12  # greatest area, divided by the square of the extent, that counts as none


def extent(points: Vector) -> float:
    """Diagonal (m) of the bounding box of points (..., 3) m."""
    flat = points.reshape(-1, 3)
    return float(np.linalg.norm(flat.max(axis=0) - flat.min(axis=0))) if len(flat) else 0.0


def areas(corners: Vector) -> Vector:
    """Area vectors of triangles: unit normal times area.

    Parameters
    ----------
    corners : (n, 3, 3) array
        Corners (m).

    Returns
    -------
    (n, 3) array
        Vectors (m^2); the normal is that of a counter-clockwise triangle.
    """
    cross: Vector = 0.5 * vector_products(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return cross


def joined(vertices: Vector, faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Faces in which vertices at the same place have the same number, as files may store them several times.

    Parameters
    ----------
    vertices : (k, 3) array
        Vertices (m).
    faces : (n, 3) array of int
        Triangles by the numbers of their vertices.

    Returns
    -------
    (n, 3) array of int
    """
    low = vertices.min(axis=0)
    cell = max(1e-30, float((vertices.max(axis=0) - low).max())) / 2**20
    x, y, z = np.rint((vertices - low) / cell).astype(np.int64).T
    _, numbers = np.unique((x << 42) + (y << 21) + z, return_inverse=True)
    return np.asarray(numbers.reshape(-1)[faces], dtype=np.int64)


def without_area(vertices: Vector, faces: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Mark the faces that have no area, on which no medium acts.

    Parameters
    ----------
    vertices : (k, 3) array
        Vertices (m).
    faces : (n, 3) array of int
        Triangles.

    Returns
    -------
    (n,) array of bool
    """
    marks: NDArray[np.bool_] = np.linalg.norm(areas(vertices[faces]), axis=1) <= NO_AREA * extent(vertices) ** 2
    return marks


def empty_note(empty: NDArray[np.bool_]) -> tuple[str, ...]:
    """Sentence on faces without area, if there are any.

    Parameters
    ----------
    empty : (n,) array of bool
        Marks of `without_area`.

    Returns
    -------
    tuple of str
        One sentence or none.
    """
    if not empty.any():
        return ()
    first = int(np.argmax(empty)) + 1
    return (f"{int(empty.sum())} of its {len(empty)} triangles have no area and are left out, the first is {first}",)


def faults(vertices: Vector, faces: NDArray[np.int64], thin: bool) -> Iterator[str]:
    """Faults of a mesh, one sentence each.

    Triangles without area count when it is checked whether the mesh is closed, as they close gaps between their
    corners.

    Parameters
    ----------
    vertices : (k, 3) array
        Vertices (m).
    faces : (n, 3) array of int
        Triangles.
    thin : bool
        Whether the mesh is a sheet, which need not enclose a volume.

    Yields
    ------
    str
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
    """Number of edges that belong to one triangle only, and of edges along which two triangles run the same way."""
    kept = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    start, end = kept.ravel(), np.roll(kept, -1, axis=1).ravel()
    key = np.minimum(start, end) * (int(faces.max()) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.diff(key[order], prepend=-1))
    balance = np.add.reduceat(np.where(start < end, 1, -1)[order], first)
    number = np.diff(first, append=len(order))
    return int(np.sum(number == 1)), int(np.sum((balance != 0) & (number > 1)))


FORMATS = ("stl", "obj", "ply", "dae", "glb", "gltf")
MOST_BYTES = 300_000_000
# Record of a facet in a binary STL file.
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


def read(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices and faces of a mesh file, in the unit of the file; in m if the file states its unit (Collada, glTF).

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    (n, 3) array, (m, 3) array of int
        Vertices and faces. They can't be written to.

    Raises
    ------
    SceneError
        The file does not exist, has another format, is too large or can't be read, or trimesh is not installed.
    """
    if path.suffix[1:].lower() not in FORMATS:
        raise scene_error(str(path), f"got a {path.suffix or 'nameless'} file, allowed are {', '.join(FORMATS)}")
    if not path.is_file():
        raise scene_error(str(path), f"there is no such file (looked for {path.resolve()})")
    if path.stat().st_size > MOST_BYTES:
        raise scene_error(str(path), f"is larger than {MOST_BYTES // 10**6} MB, the most that is read")
    return _read(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=64)  # many bodies share a mesh, and all runs of a sweep share them
def _read(path: Path, changed: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Cached part of `read`; changed: time of the last change of the file, for the cache."""
    del changed
    points, faces = _binary_stl(path) or _by_trimesh(path)
    if len(faces) == 0 or not np.isfinite(points).all():
        fault = "has no triangles" if len(faces) == 0 else "has vertices that are not finite numbers"
        raise scene_error(str(path), _unread(path, f"it {fault}"))
    points.setflags(write=False)
    faces.setflags(write=False)
    return points, faces


def _binary_stl(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """Mesh of a binary STL file; None for other files. The length of the file tells whether it is one.

    To read it here takes less time than to load trimesh.
    """
    if path.suffix.lower() != ".stl":
        return None
    raw = path.read_bytes()
    count = int.from_bytes(raw[80:84], "little")
    if len(raw) < 84 or len(raw) != 84 + _FACET.itemsize * count:
        return None
    corners = np.frombuffer(raw, _FACET, offset=84)["corners"].reshape(-1, 3)
    return corners.astype(float), np.arange(3 * count).reshape(-1, 3)


def _by_trimesh(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Mesh of a file that trimesh reads, in m if the file states its unit."""
    try:
        import trimesh
    except ImportError:
        raise scene_error(str(path), "mesh files are read by trimesh: pip install 'granular-contact[robot]'") from None
    try:
        logging.getLogger("trimesh").setLevel(logging.CRITICAL)  # it has long warnings on missing textures
        loaded = trimesh.load_mesh(path, process=False)
        return np.asarray(loaded.vertices, float) * _unit(loaded), np.array(loaded.faces, np.int64)
    except Exception as error:  # its readers raise many types of error on a broken file
        reason = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
        raise scene_error(str(path), _unread(path, reason)) from None


def _unread(path: Path, reason: str) -> str:
    """Reason why a file can't be read, in one line. A repository may hold pointers of Git LFS in place of files."""
    with path.open("rb") as file:
        if file.read(40).startswith(b"version https://git-lfs"):
            return "is a pointer of Git LFS in place of a mesh; fetch the file with `git lfs pull`"
    return f"can't be read: {reason}"


def _unit(loaded: Any) -> float:
    """Length (m) of the unit that a Collada file states, as `0.01 * meters`; 1 if none is stated."""
    stated = re.fullmatch(r"([0-9.eE+-]+) \* meters", str(loaded.units or ""))
    return float(stated[1]) if stated else 1.0
