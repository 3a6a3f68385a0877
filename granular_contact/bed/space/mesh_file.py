"""Meshes from files, by trimesh, which is loaded for this alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import scene_error

FORMATS = ("stl", "obj", "ply")


def read(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices (n, 3) and faces (m, 3) of a file, in its own unit.

    Raises
    ------
    SceneError
        There is no such file, it is of another format or can't be read, or trimesh is not installed.
    """
    if path.suffix[1:].lower() not in FORMATS:
        raise scene_error(str(path), f"got a {path.suffix or 'nameless'} file, allowed are {', '.join(FORMATS)}")
    if not path.is_file():
        raise scene_error(str(path), f"there is no such file (looked for {path.resolve()})")
    try:
        import trimesh
    except ImportError:
        raise scene_error(str(path), "mesh files are read by trimesh: pip install 'granular-contact[robot]'") from None
    try:
        found = trimesh.load(path, force="mesh", process=False)
        return np.asarray(found.vertices, float), np.asarray(found.faces, np.int64)
    except Exception as error:  # whatever its readers raise on a broken file
        raise scene_error(str(path), f"can't be read: {type(error).__name__}: {error}") from None
