"""Shapes of bodies in space, each in its own frame: the base class, and shapes with straight edges.

A shape provides its triangles and its facets. A new shape is a class here, or in `round_shapes`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import scene_error
from granular_contact.geometry import mesh
from granular_contact.sand.space import facets, triangles
from granular_contact.sand.space.facets import Facets, Size, rectangle_facets

Vector = NDArray[np.float64]
PARTS = 8  # default number of triangles along the diagonal of a shape


class Shape(ABC):
    """Base class of shapes on which a medium acts in space. Lengths are in m.

    Attributes
    ----------
    thin : bool
        Whether the shape is a sheet, of which either face can lead.
    """

    thin: bool = False

    def facets(self, size: float | None = None, accuracy: float | None = None, share: float = 1.0) -> Facets:
        """Facets of the surface, on which the medium acts.

        Parameters
        ----------
        size : float, optional
            Greatest edge (m).
        accuracy : float, optional
            Without a size: allowed error of a motion by the facets, relative to the path; by default 0.3 %.
        share : float
            Factor of the size.

        Returns
        -------
        Facets
            In the frame of the shape.

        Raises
        ------
        SceneError
            There would be more than `triangles.MOST_FACETS`.
        """
        whole = self.corners(np.inf)
        if size is None:
            return self.cut_facets(facets.size_for_accuracy(mesh.extent(whole), accuracy, share))
        size *= share
        area = float(np.linalg.norm(mesh.areas(whole), axis=1).sum())
        triangles.check_number(area / size**2 if size > 1e-150 else np.inf, size, area)
        return self.cut_facets(facets.Size(size))

    def rims(self) -> Vector:
        """Rims (k, 8) that bound the depth of a round shape, see `facets.rim`; none for others, whose corners do so."""
        return np.zeros((0, 8))

    def cut_facets(self, size: Size) -> Facets:
        """Facets of a size; by default triangles.

        Parameters
        ----------
        size : Size
            The size.

        Returns
        -------
        Facets
            In the frame of the shape.

        Raises
        ------
        SceneError
            There would be more than `triangles.MOST_FACETS`.
        """
        return facets.triangle_facets(self.corners(size.edge))

    def drawn(self) -> Vector:
        """Triangles (n, 3, 3) m for drawings: flat faces are whole, and round faces have many sides."""
        return self.corners(np.inf)

    @abstractmethod
    def corners(self, size: float | None = None) -> Vector:
        """Triangles of the surface.

        Parameters
        ----------
        size : float, optional
            Greatest edge (m); by default an eighth of the diagonal.

        Returns
        -------
        (n, 3, 3) array
            Corners (m) in the frame of the shape, counter-clockwise seen from outside.

        Raises
        ------
        SceneError
            There would be more than `triangles.MOST_FACETS`.
        """


@dataclass(frozen=True)
class Box(Shape):
    """Box around the origin with sides along the axes.

    Parameters
    ----------
    size : (3,) sequence
        Lengths along x, y, z (m), above 0.
    """

    size: tuple[float, float, float]

    def __post_init__(self) -> None:
        positive("Box", 3, size=self.size)

    def corners(self, size: float | None = None) -> Vector:
        """Triangles of the six faces; see `Shape.corners`."""
        low = -0.5 * np.array(self.size)
        return _cut(_BOX[_BOX_FACES] * -2.0 * low + low, size)

    def cut_facets(self, size: Size) -> Facets:
        """Rectangles on the six faces; see `Shape.cut_facets`."""
        half = 0.5 * np.diag(self.size)
        faces = [(half[i], half[i - 2], half[i - 1]) for i in range(3)]
        pairs = [((n, a, b), (-n, b, a)) for n, a, b in faces]
        return facets.joined([rectangle_facets(*side, size) for pair in pairs for side in pair])


@dataclass(frozen=True)
class Plate(Shape):
    """Thin rectangle in the x-y plane around the origin, of which either face can lead.

    Parameters
    ----------
    size : (2,) sequence
        Lengths along x and y (m), above 0.
    """

    size: tuple[float, float]
    thin = True

    def __post_init__(self) -> None:
        positive("Plate", 2, size=self.size)

    def corners(self, size: float | None = None) -> Vector:
        """Triangles of one face, whose normal is along +z; see `Shape.corners`."""
        x, y = 0.5 * self.size[0], 0.5 * self.size[1]
        square = np.array([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]])
        return _cut(square[np.array([[0, 1, 2], [0, 2, 3]])], size)

    def cut_facets(self, size: Size) -> Facets:
        """Rectangles on one face, whose normal is along +z; see `Shape.cut_facets`."""
        x, y = 0.5 * self.size[0], 0.5 * self.size[1]
        return rectangle_facets(np.zeros(3), np.array([x, 0.0, 0.0]), np.array([0.0, y, 0.0]), size)


@dataclass(frozen=True)
class Bar(Shape):
    """Thin round bar along a polyline, for laws of bars.

    Parameters
    ----------
    points : (k, 3) array
        Corners of its centre line (m), two or more.
    diameter : float
        Diameter (m), above 0.
    strips : int
        Approximate number of strips on the whole bar.
    free_end : bool
        Whether the face at the last point is free.

    Raises
    ------
    SceneError
        A number is not above 0, or the points are not a line. All shapes raise such errors.
    """

    points: ArrayLike
    diameter: float
    strips: int = 16
    free_end: bool = True
    line: Vector = field(init=False, repr=False)

    def __post_init__(self) -> None:
        positive("Bar", diameter=self.diameter, strips=self.strips)
        line = np.asarray(self.points, float)
        if line.ndim != 2 or line.shape[1] != 3 or len(line) < 2 or not np.isfinite(line).all():
            raise scene_error("Bar", f"points: got an array of shape {line.shape}, allowed are (k, 3) finite numbers")
        if (np.linalg.norm(np.diff(line, axis=0), axis=1) == 0.0).any():
            raise scene_error("Bar", "points: got the same point twice in a row; allowed are points apart")
        object.__setattr__(self, "line", line)

    def corners(self, size: float | None = None) -> Vector:  # noqa: ARG002
        """Raise SceneError, as a bar has no surface; see `Shape.corners`."""
        raise scene_error("Bar", "it has no surface; a Cylinder has")

    def stations(self) -> Vector:
        """Ends (n, 3) m of strips of similar length along the bar.

        Every side of the polyline has at least one strip.
        """
        lengths = np.linalg.norm(np.diff(self.line, axis=0), axis=1)
        shares = np.maximum(1, np.rint(self.strips * lengths / lengths.sum())).astype(int)
        pieces = [
            np.linspace(a, b, n, endpoint=False) for a, b, n in zip(self.line, self.line[1:], shares, strict=False)
        ]
        return np.vstack([*pieces, self.line[-1:]])


# ---- parts of shapes ----

_BOX = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
_SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
_BOX_FACES = np.array([half for a, b, c, d in _SIDES for half in ((a, b, c), (a, c, d))])


def greatest_edge(extent: float, size: float | None) -> float:
    """Greatest edge of facets: the given size, or a part of the extent.

    Parameters
    ----------
    extent : float
        Diagonal of the shape (m).
    size : float or None
        The size (m), if given.

    Returns
    -------
    float
        m.
    """
    return extent / PARTS if size is None else size


def _cut(corners: Vector, size: float | None) -> Vector:
    """Triangles (n, 3, 3) m, cut to a size or to the default size."""
    return triangles.cut(corners, greatest_edge(mesh.extent(corners), size))


# ---- checks of shapes ----


def positive(shape: str, count: int = 1, /, **sizes: float | tuple[float, ...]) -> None:
    """Refuse sizes of a shape that are not numbers above 0.

    Parameters
    ----------
    shape : str
        Name of the shape, for the message.
    count : int
        Number of numbers in each size.
    **sizes
        The sizes, by their names.

    Raises
    ------
    SceneError
        A size is not above 0, or not so many numbers.
    """
    allowed = "is a number" if count == 1 else f"are {count} numbers"
    for name, value in sizes.items():
        try:
            numbers = np.asarray(value, float)
        except (TypeError, ValueError):  # such as a word
            numbers = np.zeros(0)
        if numbers.shape != (() if count == 1 else (count,)) or not (np.isfinite(numbers) & (numbers > 0.0)).all():
            got = repr(value) if isinstance(value, str) else value
            raise scene_error(shape, f"{name}: got {got}, allowed {allowed} above 0")
