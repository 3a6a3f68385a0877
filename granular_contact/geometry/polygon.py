"""Polygons by their corners: area, crossing sides, triangulation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

Corner = tuple[float, float]


def doubled_area(corners: Sequence[Corner]) -> float:
    """Twice the area (m2) of a polygon, negative for a clockwise one. The first corner need not be repeated.

    Coordinates are relative to the first corner: far from the origin the products, and their round-off, would be large.
    """
    relative = [(x - corners[0][0], y - corners[0][1]) for x, y in corners]
    return math.fsum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairwise(relative))


def extent(corners: Sequence[Corner]) -> float:
    """Greater side (m) of the bounding box."""
    x, y = [p[0] for p in corners], [p[1] for p in corners]
    return max(max(x) - min(x), max(y) - min(y))


def crossing(corners: Sequence[Corner]) -> tuple[int, int] | None:
    """Two sides that cross, by the numbers of their first corners; None if no two do.

    The first corner is not repeated.
    """
    sides = list(enumerate(pairwise((*corners, corners[0]))))
    sides.sort(key=lambda side: min(side[1][0][0], side[1][1][0]))
    for i, (first, (a, b)) in enumerate(sides):
        right = max(a[0], b[0])
        for second, (c, d) in sides[i + 1 :]:
            if min(c[0], d[0]) > right:
                break  # this side and all that follow lie further to the right
            if _turn(a, b, c) * _turn(a, b, d) < 0.0 and _turn(c, d, a) * _turn(c, d, b) < 0.0:
                return min(first, second), max(first, second)
    return None


def _turn(a: Corner, b: Corner, c: Corner) -> float:
    """Side of the line from a to b on which c lies: 1 left, -1 right, 0 on the line."""
    turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return math.copysign(1.0, turn) if turn else 0.0


def ears(corners: Sequence[Corner]) -> list[tuple[int, int, int]]:
    """Triangulation of a polygon without crossing sides, by cutting ears.

    Parameters
    ----------
    corners : sequence of tuple of float
        Corners; the first is not repeated.

    Returns
    -------
    list of tuple of int
        Counter-clockwise triangles by the numbers of their corners.
    """
    remaining = list(range(len(corners)))
    if doubled_area((*corners, corners[0])) < 0.0:
        remaining.reverse()
    triangles = []
    while len(remaining) > 3:
        k = next((k for k in range(len(remaining)) if _is_ear(corners, remaining, k)), 0)
        triangles.append((remaining[k - 1], remaining[k], remaining[(k + 1) % len(remaining)]))
        del remaining[k]
    triangles.append((remaining[0], remaining[1], remaining[2]))
    return [triangle for triangle in triangles if _turn(*(corners[i] for i in triangle)) > 0.0]


def _is_ear(corners: Sequence[Corner], remaining: Sequence[int], k: int) -> bool:
    """Return whether a corner is convex, and its triangle with both neighbours contains no other corner.

    remaining: numbers of the corners that are not cut yet; k: place of the corner among them.
    """
    ids = remaining[k - 1], remaining[k], remaining[(k + 1) % len(remaining)]
    a, b, c = (corners[i] for i in ids)
    if _turn(a, b, c) <= 0.0:
        return False
    return not any(
        _turn(a, b, p) >= 0.0 and _turn(b, c, p) >= 0.0 and _turn(c, a, p) >= 0.0
        for p in (corners[i] for i in remaining if i not in ids)
        if p not in (a, b, c)
    )
