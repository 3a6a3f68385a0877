"""Shapes of bodies in space, each in a frame of its own: primitives, meshes, bars.

A shape says which `kind` of elements it has and gives its triangles. Round ones are many-sided, with as much area in
every section as the true one [ours]. A new shape is a class here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import Fault, SceneError, scene_error
from granular_contact.geometry import mesh
from granular_contact.sand.space import triangles

Vector = NDArray[np.float64]
METRES = 3.0  # above it a mesh without a stated scale is taken for one in another unit
MOST_CHORDS = 10_000  # of a profile: with as many facets around it there are too many in any case
PARTS = 8  # facets along the diagonal of a shape, unless their size is given


class Shape(ABC):
    """What a medium meets in space; lengths in m.

    thin: whether it is a sheet, of which either face can lead.
    """

    thin: bool = False

    @abstractmethod
    def corners(self, size: float | None = None) -> Vector:
        """Triangles of its surface.

        Parameters
        ----------
        size : float, optional
            Greatest edge (m); an eighth of the diagonal unless given.

        Raises
        ------
        SceneError
            There would be more than `triangles.MOST_FACETS`.

        Returns
        -------
        (n, 3, 3) array
            Corners (m) in the frame of the shape, counter-clockwise seen from outside.
        """


@dataclass(frozen=True)
class Box(Shape):
    """Box around the origin with sides along the axes.

    Parameters
    ----------
    size : (3,) sequence
        Along x, y, z (m), above 0.
    """

    size: tuple[float, float, float]

    def __post_init__(self) -> None:
        _positive("Box", size=self.size)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        low = -0.5 * np.array(self.size)
        return _cut(_BOX[_BOX_FACES] * -2.0 * low + low, size)


@dataclass(frozen=True)
class Cylinder(Shape):
    """Cylinder around the z axis, from -length/2 to length/2.

    Parameters
    ----------
    diameter, length : float
        m, above 0.
    """

    diameter: float
    length: float

    def __post_init__(self) -> None:
        _positive("Cylinder", diameter=self.diameter, length=self.length)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        r, h = 0.5 * self.diameter, 0.5 * self.length
        return _turned([(0.0, -h), (r, -h), (r, h), (0.0, h)], size)


@dataclass(frozen=True)
class Sphere(Shape):
    """Sphere around the origin.

    Parameters
    ----------
    diameter : float
        m, above 0.
    mass : float, optional
        Its own (kg), for laws of balls that know it; that of the body unless given.
    """

    diameter: float
    mass: float | None = None

    def __post_init__(self) -> None:
        _positive("Sphere", diameter=self.diameter, mass=1.0 if self.mass is None else self.mass)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        d = self.diameter
        return _turned(_arc(0.5 * d, -0.5 * np.pi, 0.5 * np.pi, _size(np.sqrt(3.0) * d, size)), size)


@dataclass(frozen=True)
class Capsule(Shape):
    """Cylinder around the z axis with half spheres at its ends.

    Parameters
    ----------
    diameter : float
        m, above 0.
    length : float
        Between the centres of the half spheres (m), above 0.
    """

    diameter: float
    length: float

    def __post_init__(self) -> None:
        _positive("Capsule", diameter=self.diameter, length=self.length)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        r, h = 0.5 * self.diameter, 0.5 * self.length
        step = _size(float(np.hypot(np.sqrt(8.0) * r, 2.0 * (r + h))), size)
        up = [(r, h), *((x, z + h) for x, z in _arc(r, 0.0, 0.5 * np.pi, step)[1:])]
        return _turned([*[(x, -z) for x, z in reversed(up)], *up], size)


@dataclass(frozen=True)
class Cone(Shape):
    """Cone around the z axis: its tip at the origin, its base at z = height.

    Parameters
    ----------
    diameter : float
        Of the base (m), above 0.
    height : float
        m, above 0.
    """

    diameter: float
    height: float

    def __post_init__(self) -> None:
        _positive("Cone", diameter=self.diameter, height=self.height)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        return _turned([(0.0, 0.0), (0.5 * self.diameter, self.height), (0.0, self.height)], size)


@dataclass(frozen=True)
class Plate(Shape):
    """Thin rectangle in the x-y plane around the origin, of which either face can lead.

    Parameters
    ----------
    size : (2,) sequence
        Along x and y (m), above 0.
    """

    size: tuple[float, float]
    thin = True

    def __post_init__(self) -> None:
        _positive("Plate", size=self.size)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        x, y = 0.5 * self.size[0], 0.5 * self.size[1]
        square = np.array([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]])
        return _cut(square[np.array([[0, 1, 2], [0, 2, 3]])], size)


@dataclass(frozen=True)
class Bar(Shape):
    """Thin round bar along a polyline, for laws of bars.

    Parameters
    ----------
    points : (k, 3) array
        Corners of its middle line (m), two or more.
    diameter : float
        m, above 0.
    strips : int
        About how many there are in all.
    free_end : bool
        Whether the face at the last point is free.

    Raises
    ------
    SceneError
        A number is not above 0, or the points are no line; of all shapes.
    """

    points: ArrayLike
    diameter: float
    strips: int = 16
    free_end: bool = True
    line: Vector = field(init=False, repr=False)

    def __post_init__(self) -> None:
        _positive("Bar", diameter=self.diameter, strips=self.strips)
        line = np.asarray(self.points, float)
        if line.ndim != 2 or line.shape[1] != 3 or len(line) < 2 or not np.isfinite(line).all():
            raise scene_error("Bar", f"points: got an array of shape {line.shape}, allowed are (k, 3) finite numbers")
        if (np.linalg.norm(np.diff(line, axis=0), axis=1) == 0.0).any():
            raise scene_error("Bar", "points: got the same point twice in a row; allowed are points apart")
        object.__setattr__(self, "line", line)

    def corners(self, size: float | None = None) -> Vector:  # noqa: ARG002
        """A bar has no facets."""
        raise scene_error("Bar", "it has no surface; a Cylinder has")

    def stations(self) -> Vector:
        """Ends (n, 3) m of about `strips` strips of like length; every piece of the line has at least one."""
        lengths = np.linalg.norm(np.diff(self.line, axis=0), axis=1)
        shares = np.maximum(1, np.rint(self.strips * lengths / lengths.sum())).astype(int)
        pieces = [
            np.linspace(a, b, n, endpoint=False) for a, b, n in zip(self.line, self.line[1:], shares, strict=False)
        ]
        return np.vstack([*pieces, self.line[-1:]])


class Mesh(Shape):
    """Closed surface of triangles, or a thin sheet.

    Parameters
    ----------
    vertices : (n, 3) array
        Corners (m), times `scale`.
    faces : (m, 3) array of int
        Triangles by the numbers of their corners, counter-clockwise seen from outside.
    scale : float or (3,) array, optional
        Length of the vertices' unit in m, or one along each axis; a negative one mirrors the mesh, and its triangles
        are turned so that they go on looking outward. Unless given they are in m, and a mesh of more than 3 m is
        refused.
    thin : bool
        Whether it is a sheet of which either face can lead; it need not be closed then.
    name : str
        For messages.

    Raises
    ------
    SceneError
        The mesh is open, inside out or without any area; or it is too large to be in metres.

    Notes
    -----
    Triangles without area carry no force, and are left out; `notes` says how many.
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
        points, numbers = np.asarray(vertices, float), np.asarray(faces)
        if found := list(_arrays(points, numbers)):
            raise _refused(name, found)
        factors = np.broadcast_to(np.asarray(1.0 if scale is None else scale, float), (3,))
        numbers = numbers[:, ::-1] if np.prod(factors) < 0.0 else numbers
        self.vertices, self.faces = points * factors, numbers.astype(np.int64)
        self.thin = thin
        found = list(mesh.faults(self.vertices, self.faces, thin))
        sides = np.ptp(self.vertices[self.faces].reshape(-1, 3), axis=0)
        if scale is None and sides.max() > METRES:
            got = " x ".join(f"{side:.4g}" for side in sides)
            found.append(f"it is {got} m: if it is in millimetres, give the scale 0.001; if it is in metres, 1")
        if found:
            raise _refused(name, found)
        empty = mesh.without_area(self.vertices, self.faces)
        self.notes, self.faces = mesh.empty_note(empty), self.faces[~empty]

    @classmethod
    def read(cls, path: str | Path, *, scale: float | ArrayLike | None = None, thin: bool = False) -> Mesh:
        """Mesh of a file, STL, OBJ or PLY; it is read by trimesh, of the extra `[robot]`.

        Parameters
        ----------
        path : str or path
            The file.
        scale : float or (3,) array, optional
            Its unit in m, or one along each axis.
        thin : bool
            Whether it is a sheet that the medium meets on both sides.

        Returns
        -------
        Mesh

        Raises
        ------
        SceneError
            The file can't be read, or as of `Mesh`.
        """
        from granular_contact.geometry.mesh import read

        return cls(*read(Path(path)), scale=scale, thin=thin, name=str(path))

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        return _cut(self.vertices[self.faces], size)


# ---- what they are made of ----

_BOX = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
_SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
_BOX_FACES = np.array([half for a, b, c, d in _SIDES for half in ((a, b, c), (a, c, d))])


def _size(extent: float, size: float | None) -> float:
    """Greatest edge of facets (m) of a shape of this extent, unless it is given."""
    return extent / PARTS if size is None else size


def _cut(corners: Vector, size: float | None) -> Vector:
    return triangles.cut(corners, _size(mesh.extent(corners), size))


def _arc(radius: float, start: float, end: float, size: float) -> list[tuple[float, float]]:
    """Points r, z (m) on a circle about the origin between two elevations (rad), of chords of about `size` (m)."""
    count = max(2, int(np.ceil(min((end - start) * radius / size, MOST_CHORDS))))
    step = (end - start) / count
    rho = radius * np.sqrt(step / np.sin(step))  # as much area below the chords as below the arc
    angles = start + step * np.arange(count + 1)
    return [
        (max(0.0, float(rho * np.cos(a))) if abs(np.cos(a)) > 1e-12 else 0.0, float(rho * np.sin(a))) for a in angles
    ]


def _turned(profile: list[tuple[float, float]], size: float | None) -> Vector:
    """Triangles of the body that a profile of points r, z (m), from the bottom to the top, has when turned about z."""
    line = np.array(profile)
    widest = float(line[:, 0].max())
    edge = _size(float(np.hypot(np.sqrt(8.0) * widest, np.ptp(line[:, 1]))), size)
    around = max(12, int(np.ceil(min(2.0 * np.pi * widest / edge, triangles.MOST_FACETS))))
    if around * (len(line) - 1) > triangles.MOST_FACETS:
        raise triangles.too_many(edge, _turned(profile[:: len(profile) // 50 + 1], np.inf))
    turn = 2.0 * np.pi / around
    angles = turn * np.arange(around + 1)
    ring = np.sqrt(turn / np.sin(turn)) * np.column_stack([np.cos(angles), np.sin(angles)])
    made = []
    for (r0, z0), (r1, z1) in pairwise(line):
        low, high = (np.column_stack([r * ring, np.full(around + 1, z)]) for r, z in ((r0, z0), (r1, z1)))
        a, b, c, d = low[:-1], low[1:], high[1:], high[:-1]
        if r0 > 0.0:
            made.append(np.stack([a, b, c], axis=1))
        if r1 > 0.0:
            made.append(np.stack([a, c, d], axis=1))
    return triangles.cut(np.concatenate(made), edge)


# ---- whether a shape can be ----


def _positive(shape: str, **sizes: float | tuple[float, ...]) -> None:
    for name, value in sizes.items():
        if not (np.isfinite(value).all() and np.all(np.asarray(value) > 0.0)):
            raise scene_error(shape, f"{name}: got {value}, allowed are numbers above 0")


def _arrays(points: Vector, faces: NDArray[np.int64]) -> list[str]:
    """What is wrong with the arrays of a mesh."""
    found = []
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        found.append(f"vertices: got an array of shape {points.shape}, allowed is (n, 3)")
    elif not np.isfinite(points).all():
        found.append("vertices: got numbers that are not finite")
    if faces.ndim != 2 or faces.shape[1] != 3 or len(faces) == 0 or not np.issubdtype(faces.dtype, np.integer):
        found.append(f"faces: got an array of shape {faces.shape} of {faces.dtype}, allowed is (m, 3) of whole numbers")
    elif not found and (faces.min() < 0 or faces.max() >= len(points)):
        found.append(f"faces: got numbers from {faces.min()} to {faces.max()}, allowed are 0 to {len(points) - 1}")
    return found


def _refused(name: str, found: list[str]) -> SceneError:
    return SceneError([Fault(file="", line=None, key=name, message=message) for message in found])
