"""Shapes of a robot file -> triangles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import SceneError
from granular_contact.geometry import mesh
from granular_contact.robot.types import Geometry, Vector

Faces = NDArray[np.int64]
Arrays = tuple[Vector, Faces]


class Surfaces:
    """Triangles of geometries; each mesh file is read once."""

    def __init__(self) -> None:
        self._files: dict[Path, Arrays | str] = {}

    def of(self, geometry: Geometry, path: Path | None) -> Arrays | str:
        """Vertices (n, 3) m and faces (m, 3) of a geometry in its own frame, or why there are none.

        path: the file of a mesh.
        """
        if path is None:
            return primitive(geometry)
        if path not in self._files:
            try:
                self._files[path] = mesh.read(path)
            except SceneError as error:
                self._files[path] = "; ".join(f"got {path.name!r}: {one.message}" for one in error.faults)
        found = self._files[path]
        return found if isinstance(found, str) else scaled(*found, geometry.scale)


def scaled(vertices: Vector, faces: Faces, scale: tuple[float, float, float]) -> Arrays:
    """A mesh with its axes scaled; the triangles of a mirrored one are turned, so that they go on looking outward."""
    return vertices * scale, faces[:, ::-1] if np.prod(scale) < 0.0 else faces


def primitive(geometry: Geometry) -> Arrays:
    """A box, cylinder, sphere or capsule around the origin, its axis along z."""
    from trimesh import creation

    size = geometry.size
    if geometry.kind == "box":
        found = creation.box(size)
    elif geometry.kind == "sphere":
        found = creation.icosphere(subdivisions=3, radius=0.5 * size[0])
    else:
        make = creation.cylinder if geometry.kind == "cylinder" else creation.capsule
        found = make(radius=0.5 * size[0], height=size[1])
    points = np.asarray(found.vertices, float)
    return points - 0.5 * (points.min(axis=0) + points.max(axis=0)), np.asarray(found.faces, np.int64)
