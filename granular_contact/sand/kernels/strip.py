"""A straight strip between two stations of a line, as laws see it, in the plane and in space.

Its points are named by xi in [0, 1] from end 0 to end 1. Depth, velocity and stretch of the bristles vary linearly
along it. Vectors have two components in the plane (y up), three in space (z up).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba import types


class Strip(NamedTuple):
    """The part of a strip that lies in the medium, from xi = a to xi = b, and how the whole strip moves.

    Parameters
    ----------
    a, b : float
        0 <= a < b <= 1; depths between them are not negative.
    z0, z1 : float
        Depths at the ends of the strip (m), positive below the surface.
    c : tuple of float
        Vector from end 0 to end 1 (m).
    v0, v1 : tuple of float
        Velocities of the ends (m/s).
    e0, e1 : tuple of float
        Stretch of the bristles at the ends (m), see `friction`.
    """

    a: float
    b: float
    z0: float
    z1: float
    c: tuple[float, ...]
    v0: tuple[float, ...]
    v1: tuple[float, ...]
    e0: tuple[float, ...]
    e1: tuple[float, ...]


def strip_type(dimensions: int) -> Any:
    """Numba's type of a strip with vectors of two or three components."""
    vector = types.UniTuple(types.float64, dimensions)
    return types.NamedTuple((*[types.float64] * 4, *[vector] * 5), Strip)
