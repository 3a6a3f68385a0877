"""A map of heights of the surface, as `kernels.ground` reads it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Heights:
    """Heights (rows along y, columns along x) m at the points of a square grid; corner: x, y of the first (m).

    Between the points smooth, by the splines of Catmull and Rom; beyond the edge level.
    """

    values: Vector
    corner: tuple[float, float]
    cell: float

    @property
    def numbers(self) -> Vector:
        """The map as it follows a plane in `kernels.ground`."""
        rows, columns = self.values.shape
        return np.array([self.cell, *self.corner, rows, columns, *self.values.ravel()], float)

    @property
    def extent(self) -> tuple[Vector, Vector]:
        """Lowest and highest x, y (2,) m of its points."""
        low = np.array(self.corner)
        return low, low + self.cell * (np.array(self.values.shape)[::-1] - 1.0)

    @property
    def steepest(self) -> float:
        """A bound of the rise per length: a spline is at most half as steep again as the steps between its points."""
        step = max(float(np.abs(np.diff(self.values, axis=axis)).max()) for axis in (0, 1))
        return float(1.5 * np.sqrt(2.0) * step / self.cell)

    def pieces(self) -> Iterator[tuple[float, float]]:
        """Rise per length of each cell between four points, and its area (m2)."""
        across, along = np.diff(self.values, axis=1), np.diff(self.values, axis=0)
        rise = np.hypot(0.5 * (across[1:] + across[:-1]), 0.5 * (along[:, 1:] + along[:, :-1])) / self.cell
        yield from ((one, self.cell**2) for one in rise.ravel().tolist())

    def at(self, x: Vector, y: Vector) -> Vector:
        """Height (m) at x, y (m), of any shape."""
        rows, columns = self.values.shape
        u = np.clip((np.asarray(x, float) - self.corner[0]) / self.cell, 0.0, columns - 1.0)
        v = np.clip((np.asarray(y, float) - self.corner[1]) / self.cell, 0.0, rows - 1.0)
        i, j = np.minimum(u.astype(int), columns - 2), np.minimum(v.astype(int), rows - 2)
        found = np.zeros(np.broadcast(u, v).shape)
        for wy, row in zip(_weights(v - j), range(-1, 3), strict=True):
            for wx, column in zip(_weights(u - i), range(-1, 3), strict=True):
                at = np.clip(j + row, 0, rows - 1), np.clip(i + column, 0, columns - 1)
                found = found + wy * wx * self.values[at]
        return found


def _weights(t: Vector) -> tuple[Vector, Vector, Vector, Vector]:
    """Weights of four neighbours at a share t of the middle interval."""
    return (
        0.5 * t * (-1.0 + t * (2.0 - t)),
        1.0 + 0.5 * t * t * (3.0 * t - 5.0),
        0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
        0.5 * t * t * (t - 1.0),
    )
