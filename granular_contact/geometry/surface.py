"""The free surface by its corners (k, 2) m, x rising: straight between them, its first and last pieces without end.

One corner is a level surface. The same as `sand.kernels.surface`, for those who need no compiler.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

FAR = 1e3  # between the two corners that give a slope (m): the round-off in their heights is then none in the slope
LEVEL = 1.0  # length of the level pieces by whose corners a profile goes on (m)


def surface(corners: Vector, slope: float = 0.0) -> Vector:
    """Corners of a plane through one corner (1, 2) m with a slope (-), or of a profile (k, 2) m, level beyond it."""
    if len(corners) > 1:
        return np.vstack([corners[0] - (LEVEL, 0.0), corners, corners[-1] + (LEVEL, 0.0)])
    return corners if slope == 0.0 else np.vstack([corners, corners + np.array([FAR, FAR * slope])])


def pieces(corners: Vector) -> Iterator[tuple[float, float]]:
    """Rise per length, and length (m), of the pieces between corners as they are given: none of a plane."""
    run, rise = np.diff(corners, axis=0).T
    yield from zip((rise / run).tolist(), run.tolist(), strict=True)


def height_at(corners: Vector, x: Vector) -> Vector:
    """Height of the surface (m) at x (m), any shape."""
    if len(corners) == 1:
        return np.full(np.shape(x), corners[0, 1])
    low = _pieces(corners, x)
    height: Vector = corners[low, 1] + slopes(corners)[low] * (x - corners[low, 0])
    return height


def slope_at(corners: Vector, x: Vector) -> Vector:
    """Slope of the surface at x (m), any shape; at a corner that of the piece to its right."""
    slope: Vector = slopes(corners)[_pieces(corners, x)]
    return slope


def _pieces(corners: Vector, x: Vector) -> NDArray[np.intp]:
    """Number of the straight piece at x (m), any shape."""
    return np.clip(np.searchsorted(corners[:, 0], x, side="right") - 1, 0, max(0, len(corners) - 2))


def slopes(corners: Vector) -> Vector:
    """Rise per length of the pieces (k - 1,); of a level surface 0, (1,)."""
    if len(corners) == 1:
        return np.zeros(1)
    rise: Vector = np.diff(corners[:, 1]) / np.diff(corners[:, 0])
    return rise


def greatest_depth(corners: Vector, center: Vector, radius: float) -> float:
    """Greatest depth (m, vertical, negative above) below the surface within a circle; infinite if its radius (m) is.

    On every straight piece of the surface the depth of the lower half of the circle has one maximum, where the two run
    side by side; the greatest of all is there, or at a corner, or at an end of the circle's width.
    """
    if not np.isfinite(radius):
        return float("inf")
    if len(corners) == 1:  # level
        return float(corners[0, 1] + radius - center[1])
    rise = slopes(corners)
    beside = np.concatenate([corners[:, 0] - center[0], radius * rise / np.hypot(1.0, rise), [-radius, 0.0, radius]])
    beside = beside[np.abs(beside) <= radius]
    below = np.sqrt(np.maximum(radius**2 - beside**2, 0.0))
    return float(np.max(height_at(corners, center[0] + beside) + below) - center[1])
