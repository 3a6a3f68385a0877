"""Map of heights of the surface, as `kernels.ground` reads it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Heights:
    """Heights of the surface at the points of a square grid.

    Between the points the surface is smooth, by splines of Catmull and Rom. Beyond the edge it is level.

    Parameters
    ----------
    values : (rows, columns) array
        Heights (m); rows along y, columns along x.
    corner : (2,) tuple of float
        x, y of the first point (m).
    cell : float
        Distance of neighbouring points (m).
    """

    values: Vector
    corner: tuple[float, float]
    cell: float

    @property
    def numbers(self) -> Vector:
        """The map as the numbers that follow the plane in `kernels.ground`."""
        rows, columns = self.values.shape
        return np.array([self.cell, *self.corner, rows, columns, *self.values.ravel()], float)

    @property
    def extent(self) -> tuple[Vector, Vector]:
        """Least and greatest x, y of the points, (2,) m each."""
        low = np.array(self.corner)
        return low, low + self.cell * (np.array(self.values.shape)[::-1] - 1.0)

    @property
    def steepest(self) -> float:
        """Upper bound of the rise per length: a spline is at most 1.5 times as steep as the steps between points."""
        step = max(float(np.abs(np.diff(self.values, axis=axis)).max()) for axis in (0, 1))
        return float(1.5 * np.sqrt(2.0) * step / self.cell)

    def pieces(self) -> Iterator[tuple[float, float]]:
        """Rise per length of each cell between four points, and its area (m2)."""
        across, along = np.diff(self.values, axis=1), np.diff(self.values, axis=0)
        rise = np.hypot(0.5 * (across[1:] + across[:-1]), 0.5 * (along[:, 1:] + along[:, :-1])) / self.cell
        yield from ((slope, self.cell**2) for slope in rise.ravel().tolist())

    def at(self, x: Vector, y: Vector) -> Vector:
        """Height of the surface.

        Parameters
        ----------
        x, y : array
            Places (m), of any shape.

        Returns
        -------
        array
            Heights (m).
        """
        rows, columns = self.values.shape
        u = np.clip((np.asarray(x, float) - self.corner[0]) / self.cell, 0.0, columns - 1.0)
        v = np.clip((np.asarray(y, float) - self.corner[1]) / self.cell, 0.0, rows - 1.0)
        i, j = np.minimum(u.astype(int), columns - 2), np.minimum(v.astype(int), rows - 2)
        height = np.zeros(np.broadcast(u, v).shape)
        for wy, row in zip(_spline_weights(v - j), range(-1, 3), strict=True):
            for wx, column in zip(_spline_weights(u - i), range(-1, 3), strict=True):
                indices = np.clip(j + row, 0, rows - 1), np.clip(i + column, 0, columns - 1)
                height = height + wy * wx * self.values[indices]
        return height


def _spline_weights(t: Vector) -> tuple[Vector, Vector, Vector, Vector]:
    """Weights of the four neighbouring points at a relative place t of the middle interval."""
    return (
        0.5 * t * (-1.0 + t * (2.0 - t)),
        1.0 + 0.5 * t * t * (3.0 * t - 5.0),
        0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
        0.5 * t * t * (t - 1.0),
    )
