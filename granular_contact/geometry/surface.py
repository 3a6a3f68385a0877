"""The free surface by its corners (k, 2) m with rising x. It is straight between them; the end pieces are infinite.

A single corner is a level surface. `sand.kernels.surface` has the same functions for kernels; this module needs no
compiler.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

FAR = 1e3  # distance of the two corners of a slope (m): round-off of their heights then does not change the slope
LEVEL = 1.0  # length of the level pieces at the ends of a profile (m)


def surface(corners: Vector, slope: float = 0.0) -> Vector:
    """Corners of a plane surface, or of a profile that is level beyond its ends.

    Parameters
    ----------
    corners : (k, 2) array
        A point of the plane, k = 1, or the corners of a profile (m).
    slope : float
        Rise per length of the plane.

    Returns
    -------
    (n, 2) array
        Corners (m).
    """
    if len(corners) > 1:
        return np.vstack([corners[0] - (LEVEL, 0.0), corners, corners[-1] + (LEVEL, 0.0)])
    return corners if slope == 0.0 else np.vstack([corners, corners + np.array([FAR, FAR * slope])])


def pieces(corners: Vector) -> Iterator[tuple[float, float]]:
    """Rise per length, and length (m), of the pieces between given corners; none for a plane."""
    run, rise = np.diff(corners, axis=0).T
    yield from zip((rise / run).tolist(), run.tolist(), strict=True)


def height_at(corners: Vector, x: Vector) -> Vector:
    """Height of the surface (m) at x (m), of any shape."""
    if len(corners) == 1:
        return np.full(np.shape(x), corners[0, 1])
    low = _pieces(corners, x)
    height: Vector = corners[low, 1] + slopes(corners)[low] * (x - corners[low, 0])
    return height


def slope_at(corners: Vector, x: Vector) -> Vector:
    """Slope of the surface at x (m), of any shape; at a corner the slope of the piece to its right."""
    slope: Vector = slopes(corners)[_pieces(corners, x)]
    return slope


def _pieces(corners: Vector, x: Vector) -> NDArray[np.intp]:
    """Number of the straight piece at x (m), of any shape."""
    return np.clip(np.searchsorted(corners[:, 0], x, side="right") - 1, 0, max(0, len(corners) - 2))


def slopes(corners: Vector) -> Vector:
    """Rise per length of the pieces (k - 1,); of a level surface 0, (1,)."""
    if len(corners) == 1:
        return np.zeros(1)
    rise: Vector = np.diff(corners[:, 1]) / np.diff(corners[:, 0])
    return rise


def greatest_depth(corners: Vector, center: Vector, radius: float) -> float:
    """Greatest depth of a circle below the surface.

    On each straight piece of the surface the depth of the lower half of the circle has one maximum, where circle and
    surface are parallel. The greatest depth is at such a point, at a corner, or at an end of the horizontal diameter.

    Parameters
    ----------
    corners : (k, 2) array
        Corners of the surface (m).
    center : (2,) array
        Centre of the circle (m).
    radius : float
        Radius (m).

    Returns
    -------
    float
        Depth (m), vertical, negative above the surface; infinite if the radius is.
    """
    if not np.isfinite(radius):
        return float("inf")
    if len(corners) == 1:  # level
        return float(corners[0, 1] + radius - center[1])
    rise = slopes(corners)
    offsets = np.concatenate([corners[:, 0] - center[0], radius * rise / np.hypot(1.0, rise), [-radius, 0.0, radius]])
    offsets = offsets[np.abs(offsets) <= radius]
    half_heights = np.sqrt(np.maximum(radius**2 - offsets**2, 0.0))
    return float(np.max(height_at(corners, center[0] + offsets) + half_heights) - center[1])
