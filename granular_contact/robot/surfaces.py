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
    """Triangles of geometries, with a cache of mesh files."""

    def __init__(self) -> None:
        self._files: dict[Path, Arrays | str] = {}

    def of(self, geometry: Geometry, path: Path | None) -> Arrays | str:
        """Vertices (n, 3) m and faces (m, 3) of a geometry in its own frame, or a sentence on why it can't be read.

        path: of a mesh file; None for a primitive.
        """
        if path is None:
            return primitive(geometry)
        if path not in self._files:
            try:
                self._files[path] = mesh.read(path)
            except SceneError as error:
                self._files[path] = "; ".join(f"got {path.name!r}: {fault.message}" for fault in error.faults)
        arrays = self._files[path]
        return arrays if isinstance(arrays, str) else scaled(*arrays, geometry.scale)


def scaled(vertices: Vector, faces: Faces, scale: tuple[float, float, float]) -> Arrays:
    """Scale a mesh along its axes; the triangles of a mirrored mesh are reversed, so that they still face outward."""
    return vertices * scale, faces[:, ::-1] if np.prod(scale) < 0.0 else faces


def primitive(geometry: Geometry) -> Arrays:
    """Vertices (n, 3) m and faces (m, 3) of a box, cylinder, sphere or capsule around the origin, its axis along z."""
    from trimesh import creation

    size = geometry.size
    if geometry.kind == "box":
        solid = creation.box(size)
    elif geometry.kind == "sphere":
        solid = creation.icosphere(subdivisions=3, radius=0.5 * size[0])
    else:
        create = creation.cylinder if geometry.kind == "cylinder" else creation.capsule
        solid = create(radius=0.5 * size[0], height=size[1])
    points = np.asarray(solid.vertices, float)
    return points - 0.5 * (points.min(axis=0) + points.max(axis=0)), np.asarray(solid.faces, np.int64)
