"""Meshes from files, but for binary STL by trimesh, which is loaded for this alone."""

from __future__ import annotations

import logging
import re
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import scene_error

FORMATS = ("stl", "obj", "ply", "dae", "glb", "gltf")
MOST_BYTES = 300_000_000
# A facet of a binary STL file.
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


def read(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices (n, 3) and faces (m, 3) of a file, in its own unit; in m if the file states one (Collada, glTF).

    Raises
    ------
    SceneError
        There is no such file, it is of another format, too large or can't be read, or trimesh is not installed.
    """
    if path.suffix[1:].lower() not in FORMATS:
        raise scene_error(str(path), f"got a {path.suffix or 'nameless'} file, allowed are {', '.join(FORMATS)}")
    if not path.is_file():
        raise scene_error(str(path), f"there is no such file (looked for {path.resolve()})")
    if path.stat().st_size > MOST_BYTES:
        raise scene_error(str(path), f"is larger than {MOST_BYTES // 10**6} MB, the most that is read")
    return _read(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=64)  # many bodies share a mesh, and the runs of a sweep share all
def _read(path: Path, changed: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """As `read`; changed: when the file was, for the cache. The arrays can't be written to."""
    del changed
    points, faces = _binary_stl(path) or _by_trimesh(path)
    if len(faces) == 0 or not np.isfinite(points).all():
        what = "has no triangles" if len(faces) == 0 else "has vertices that are not finite numbers"
        raise scene_error(str(path), _unread(path, f"it {what}"))
    points.setflags(write=False)
    faces.setflags(write=False)
    return points, faces


def _binary_stl(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """Mesh of a binary STL file, whose length says whether it is one; to load trimesh takes longer than to read it."""
    if path.suffix.lower() != ".stl":
        return None
    raw = path.read_bytes()
    count = int.from_bytes(raw[80:84], "little")
    if len(raw) < 84 or len(raw) != 84 + _FACET.itemsize * count:
        return None
    corners = np.frombuffer(raw, _FACET, offset=84)["corners"].reshape(-1, 3)
    return corners.astype(float), np.arange(3 * count).reshape(-1, 3)


def _by_trimesh(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    try:
        import trimesh
    except ImportError:
        raise scene_error(str(path), "mesh files are read by trimesh: pip install 'granular-contact[robot]'") from None
    try:
        logging.getLogger("trimesh").setLevel(logging.CRITICAL)  # it warns at length of missing textures
        found = trimesh.load_mesh(path, process=False)
        return np.asarray(found.vertices, float) * _unit(found), np.array(found.faces, np.int64)
    except Exception as error:  # whatever its readers raise on a broken file
        words = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
        raise scene_error(str(path), _unread(path, words)) from None


def _unread(path: Path, words: str) -> str:
    """Why a file can't be read, in one line; a repository may hold pointers of Git LFS in place of its files."""
    with path.open("rb") as file:
        if file.read(40).startswith(b"version https://git-lfs"):
            return "is a pointer of Git LFS in place of a mesh; fetch the file with `git lfs pull`"
    return f"can't be read: {words}"


def _unit(found: Any) -> float:
    """Length (m) of the unit that a Collada file states, as `0.01 * meters`."""
    stated = re.fullmatch(r"([0-9.eE+-]+) \* meters", str(found.units or ""))
    return float(stated[1]) if stated else 1.0
