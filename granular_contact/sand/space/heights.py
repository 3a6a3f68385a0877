"""Map of heights of the surface, as `kernels.ground` reads it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry.catmull_rom import slopes, weights

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
    def place(self) -> str:
        """Where the map lies, in words."""
        (a, b), (c, d) = self.extent
        return f"the map is from x = {a:g} to {c:g} m and from y = {b:g} to {d:g} m, and the ground is level beyond it"

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
        return self.tangent(x, y)[0]

    def tangent(self, x: Vector, y: Vector) -> tuple[Vector, Vector, Vector]:
        """Height of the surface and its slopes.

        Parameters
        ----------
        x, y : array
            Places (m), of any shape.

        Returns
        -------
        tuple of three arrays
            Height (m), and rise per length along x and along y; beyond the edge the surface is level.
        """
        (i, u, in_x), (j, v, in_y) = self._intervals(x, y)
        height, along, across = np.zeros((3, *np.broadcast(u, v).shape))
        columns = list(self._around(i, 1))
        for wy, dy, row in zip(weights(v), slopes(v), self._around(j, 0), strict=True):
            values = [self.values[row, column] for column in columns]
            in_row = sum(w * value for w, value in zip(weights(u), values, strict=True))
            height += wy * in_row
            along += wy * sum(d * value for d, value in zip(slopes(u), values, strict=True))
            across += dy * in_row
        return height, along * in_x / self.cell, across * in_y / self.cell

    def _intervals(self, x: Vector, y: Vector) -> Iterator[tuple[NDArray[np.int64], Vector, NDArray[np.bool_]]]:
        """Yield for x and y: index of the interval, relative place within it, and whether the place is on the map."""
        for place, first, count in zip((x, y), self.corner, self.values.shape[::-1], strict=True):
            cells = (np.asarray(place, float) - first) / self.cell
            on_map = np.clip(cells, 0.0, count - 1.0)
            interval = np.minimum(on_map.astype(int), count - 2)
            yield interval, on_map - interval, on_map == cells

    def _around(self, interval: NDArray[np.int64], axis: int) -> Iterator[NDArray[np.int64]]:
        """Yield the indices of the four points around intervals along an axis of `values`."""
        yield from (np.clip(interval + k, 0, self.values.shape[axis] - 1) for k in range(-1, 3))
