"""Shapes of bodies in space, each in a frame of its own: what all give, and those with straight edges.

A shape gives its triangles and its facets. A new shape is a class here, or in `round_shapes`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import scene_error
from granular_contact.geometry import mesh
from granular_contact.sand.space import facets, triangles
from granular_contact.sand.space.facets import Facets, Size, of_rectangle

Vector = NDArray[np.float64]
PARTS = 8  # facets along the diagonal of a shape, unless their size is given


class Shape(ABC):
    """What a medium meets in space; lengths in m.

    thin: whether it is a sheet, of which either face can lead.
    """

    thin: bool = False

    def facets(self, size: float | None = None, accuracy: float | None = None, share: float = 1.0) -> Facets:
        """What a medium meets.

        Parameters
        ----------
        size : float, optional
            Greatest edge (m).
        accuracy : float, optional
            Unless a size is given: the error of a motion that its facets may cause, as a part of the way; 0.3 % unless
            given.
        share : float
            Of that size, which is taken.

        Raises
        ------
        SceneError
            There would be more than `triangles.MOST_FACETS`.

        Returns
        -------
        Facets
            In the frame of the shape.
        """
        whole = self.corners(np.inf)
        if size is None:
            return self.facets_of(facets.chosen(mesh.extent(whole), accuracy, share))
        size *= share
        area = float(np.linalg.norm(mesh.areas(whole), axis=1).sum())
        triangles.check_number(area / size**2 if size > 1e-150 else np.inf, size, area)
        return self.facets_of(facets.Size(size))

    def rims(self) -> Vector:
        """Of a round shape what no point is deeper than (k, 8), see `facets.rim`; else none, as its corners say it."""
        return np.zeros((0, 8))

    def facets_of(self, size: Size) -> Facets:
        """Facets of a size; of a shape that has no others its triangles."""
        return facets.of_triangles(self.corners(size.edge))

    def drawn(self) -> Vector:
        """Triangles (n, 3, 3) m to be drawn: flat faces are whole, and round ones look so."""
        return self.corners(np.inf)

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
        positive("Box", 3, size=self.size)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        low = -0.5 * np.array(self.size)
        return _cut(_BOX[_BOX_FACES] * -2.0 * low + low, size)

    def facets_of(self, size: Size) -> Facets:
        """As `Shape.facets_of`."""
        half = 0.5 * np.diag(self.size)
        turned = [(half[i], half[i - 2], half[i - 1]) for i in range(3)]
        pairs = [((n, a, b), (-n, b, a)) for n, a, b in turned]
        return facets.joined([of_rectangle(*side, size) for pair in pairs for side in pair])


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
        positive("Plate", 2, size=self.size)

    def corners(self, size: float | None = None) -> Vector:
        """As `Shape.corners`."""
        x, y = 0.5 * self.size[0], 0.5 * self.size[1]
        square = np.array([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]])
        return _cut(square[np.array([[0, 1, 2], [0, 2, 3]])], size)

    def facets_of(self, size: Size) -> Facets:
        """As `Shape.facets_of`."""
        x, y = 0.5 * self.size[0], 0.5 * self.size[1]
        return of_rectangle(np.zeros(3), np.array([x, 0.0, 0.0]), np.array([0.0, y, 0.0]), size)


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
        positive("Bar", diameter=self.diameter, strips=self.strips)
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


# ---- what they are made of ----

_BOX = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
_SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
_BOX_FACES = np.array([half for a, b, c, d in _SIDES for half in ((a, b, c), (a, c, d))])


def edge_of(extent: float, size: float | None) -> float:
    """Greatest edge of facets (m) of a shape of this extent, unless it is given."""
    return extent / PARTS if size is None else size


def _cut(corners: Vector, size: float | None) -> Vector:
    return triangles.cut(corners, edge_of(mesh.extent(corners), size))


# ---- whether a shape can be ----


def positive(shape: str, count: int = 1, /, **sizes: float | tuple[float, ...]) -> None:
    """Refuse a shape with a size that is not a number above 0, or not so many of them."""
    allowed = "is a number" if count == 1 else f"are {count} numbers"
    for name, value in sizes.items():
        try:
            numbers = np.asarray(value, float)
        except (TypeError, ValueError):  # as of a word
            numbers = np.zeros(0)
        if numbers.shape != (() if count == 1 else (count,)) or not (np.isfinite(numbers) & (numbers > 0.0)).all():
            got = repr(value) if isinstance(value, str) else value
            raise scene_error(shape, f"{name}: got {got}, allowed {allowed} above 0")
