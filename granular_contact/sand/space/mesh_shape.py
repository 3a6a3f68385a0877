"""Meshes as shapes: closed surfaces of triangles, or thin sheets; and extrusions along y."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import Fault, SceneError
from granular_contact.geometry import mesh
from granular_contact.sand.space import triangles
from granular_contact.sand.space.facets import (
    Facets,
    Size,
    joined,
    rectangle_facets,
    size_for_accuracy,
    triangle_facets,
)
from granular_contact.sand.space.shapes import PARTS, Shape

Vector = NDArray[np.float64]
METRES = 3.0  # greatest size (m) of a mesh without a stated scale: a larger one is probably in another unit


class Mesh(Shape):
    """Closed surface of triangles, or a thin sheet.

    Parameters
    ----------
    vertices : (n, 3) array
        Corners (m), multiplied by `scale`.
    faces : (m, 3) array of int
        Triangles by the numbers of their corners, counter-clockwise seen from outside.
    scale : float or (3,) array, optional
        Length of the unit of the vertices in m, or one for each axis. A negative scale mirrors the mesh, and the sense
        of its triangles is reversed so that they still face outward. Without a scale the vertices are in m, and a mesh
        of more than 3 m is refused.
    thin : bool
        Whether it is a sheet of which either face can lead. A sheet need not be closed.
    name : str
        Name in messages.

    Raises
    ------
    SceneError
        The mesh is open, inside out or without any area; or it is too large to be in metres.

    Notes
    -----
    Triangles without area carry no force and are left out; `notes` says how many.
    """

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        scale: float | ArrayLike | None = None,
        thin: bool = False,
        name: str = "Mesh",
    ) -> None:
        points, indices = np.asarray(vertices, float), np.asarray(faces)
        if faults := list(_array_faults(points, indices)):
            raise _error(name, faults)
        factors = np.broadcast_to(np.asarray(1.0 if scale is None else scale, float), (3,))
        indices = indices[:, ::-1] if np.prod(factors) < 0.0 else indices
        self.vertices, self.faces = points * factors, indices.astype(np.int64)
        self.thin = thin
        faults = list(mesh.faults(self.vertices, self.faces, thin))
        sides = np.ptp(self.vertices[self.faces].reshape(-1, 3), axis=0)
        if scale is None and sides.max() > METRES:
            got = " x ".join(f"{side:.4g}" for side in sides)
            faults.append(f"it is {got} m: if it is in millimetres, give the scale 0.001; if it is in metres, 1")
        if faults:
            raise _error(name, faults)
        empty = mesh.without_area(self.vertices, self.faces)
        self.notes, self.faces = mesh.empty_note(empty), self.faces[~empty]

    @classmethod
    def read(cls, path: str | Path, *, scale: float | ArrayLike | None = None, thin: bool = False) -> Mesh:
        """Mesh of a file in STL, OBJ or PLY. It is read by trimesh, of the extra `[robot]`.

        Parameters
        ----------
        path : str or path
            The file.
        scale : float or (3,) array, optional
            Length of its unit in m, or one for each axis.
        thin : bool
            Whether it is a sheet, on both sides of which the medium acts.

        Returns
        -------
        Mesh

        Raises
        ------
        SceneError
            The file can't be read, or the mesh is refused, see `Mesh`.
        """
        from granular_contact.geometry.mesh import read

        return cls(*read(Path(path)), scale=scale, thin=thin, name=str(path))

    def corners(self, size: float | None = None) -> Vector:
        """Triangles of the mesh, cut to the size; see `Shape.corners`."""
        corners = self.vertices[self.faces]
        return triangles.cut(corners, mesh.extent(corners) / PARTS if size is None else size)

    def facets(self, size: float | None = None, accuracy: float | None = None, share: float = 1.0) -> Facets:
        """Facets of the surface; see `Shape.facets`.

        Triangles have twice the edge of parallelograms of the same area.
        """
        if size is None:
            size = 2.0 * size_for_accuracy(mesh.extent(self.vertices[self.faces]), accuracy).edge
        return triangle_facets(self.corners(share * size))


class Extrusion(Mesh):
    """Body with a constant section along y: a solid within a polygon, or a thin sheet along a line.

    Parameters
    ----------
    line : (k, 2) array
        Corners x, z of the section (m), of a polygon counter-clockwise.
    width : float
        Length along y (m), half of it to each side of the origin.
    ends : (m, 3) array of int, optional
        Triangles within the polygon by the numbers of its corners, counter-clockwise; a sheet has none.
    name : str
        Name in messages.

    Notes
    -----
    The sides are parallelograms, which are symmetric about the middle of the width; triangles would not be.
    """

    def __init__(self, line: Vector, width: float, ends: ArrayLike | None = None, *, name: str) -> None:
        n, thin = len(line), ends is None
        i = np.arange(n - 1 if thin else n)
        j = (i + 1) % n
        sides = np.concatenate([np.column_stack([i, i + n, j]), np.column_stack([j, i + n, j + n])])
        self.ends = np.zeros((0, 3), np.int64) if ends is None else np.asarray(ends)
        self.along = np.column_stack([i, j])
        right, left = (np.insert(line, 1, y, axis=1) for y in (-0.5 * width, 0.5 * width))
        # Counter-clockwise in x and z is seen from -y: the first end looks there.
        faces = np.concatenate([self.ends, self.ends[:, ::-1] + n, sides])
        super().__init__(np.concatenate([right, left]), faces, scale=1.0, thin=thin, name=name)
        self.ends = self.ends[~mesh.without_area(self.vertices, self.ends)]  # collinear corners: no normal

    def facets(self, size: float | None = None, accuracy: float | None = None, share: float = 1.0) -> Facets:
        """Facets of the surface: parallelograms on the sides, triangles on the ends; see `Shape.facets`."""
        edge, n = size, len(self.vertices) // 2
        if edge is None:
            edge = size_for_accuracy(mesh.extent(self.vertices[self.faces]), accuracy).edge
        across, pieces = 0.5 * (self.vertices[0] - self.vertices[n]), []
        for i, j in self.along:
            start, end = self.vertices[i] - across, self.vertices[j] - across
            pieces.append(rectangle_facets(0.5 * (start + end), 0.5 * (end - start), across, Size(share * edge)))
        if len(self.ends):
            corners = self.vertices[np.concatenate([self.ends, self.ends[:, ::-1] + n])]
            pieces.append(triangle_facets(triangles.cut(corners, share * edge * (1.0 if size is not None else 2.0))))
        return joined(pieces)


def _array_faults(points: Vector, faces: NDArray[np.int64]) -> list[str]:
    """Faults of the arrays of a mesh."""
    messages = []
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        messages.append(f"vertices: got an array of shape {points.shape}, allowed is (n, 3)")
    elif not np.isfinite(points).all():
        messages.append("vertices: got numbers that are not finite")
    if faces.ndim != 2 or faces.shape[1] != 3 or len(faces) == 0 or not np.issubdtype(faces.dtype, np.integer):
        got = f"got an array of shape {faces.shape} of {faces.dtype}"
        messages.append(f"faces: {got}, allowed is (m, 3) of whole numbers")
    elif not messages and (faces.min() < 0 or faces.max() >= len(points)):
        messages.append(f"faces: got numbers from {faces.min()} to {faces.max()}, allowed are 0 to {len(points) - 1}")
    return messages


def _error(name: str, messages: list[str]) -> SceneError:
    """Error with these faults of a mesh."""
    return SceneError([Fault(file="", line=None, key=name, message=message) for message in messages])
