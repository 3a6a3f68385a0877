"""Meshes from files, by trimesh, which is loaded for this alone."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import scene_error

FORMATS = ("stl", "obj", "ply", "dae", "glb", "gltf")
MOST_BYTES = 300_000_000


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
    try:
        import trimesh
    except ImportError:
        raise scene_error(str(path), "mesh files are read by trimesh: pip install 'granular-contact[robot]'") from None
    try:
        found = trimesh.load_mesh(path, process=False)
        points, faces = np.asarray(found.vertices, float), np.asarray(found.faces, np.int64)
    except Exception as error:  # whatever its readers raise on a broken file
        raise scene_error(str(path), _unread(path, error)) from None
    if len(faces) == 0 or not np.isfinite(points).all():
        what = "has no triangles" if len(faces) == 0 else "has vertices that are not finite numbers"
        raise scene_error(str(path), f"can't be read: it {what}")
    points, faces = points * _unit(found), faces.copy()
    points.setflags(write=False)
    faces.setflags(write=False)
    return points, faces


def _unread(path: Path, error: Exception) -> str:
    """Why a file can't be read, in one line; a repository may hold pointers of Git LFS in place of its files."""
    with path.open("rb") as file:
        if file.read(40).startswith(b"version https://git-lfs"):
            return "is a pointer of Git LFS in place of a mesh; fetch the file with `git lfs pull`"
    return f"can't be read: {type(error).__name__}: {' '.join(str(error).split())[:200]}"


def _unit(found: Any) -> float:
    """Length (m) of the unit that a Collada file states, as `0.01 * meters`."""
    stated = re.fullmatch(r"([0-9.eE+-]+) \* meters", str(found.units or ""))
    return float(stated[1]) if stated else 1.0
