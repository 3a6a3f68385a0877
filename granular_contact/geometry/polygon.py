"""Polygons by their corners: area, and whether sides cross."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

Corner = tuple[float, float]


def doubled_area(corners: Sequence[Corner]) -> float:
    """Twice the area (m2) of a polygon, negative for a clockwise one; the first corner need not be repeated.

    Seen from its first corner: far from the frame's origin the products are large, and their round-off with them.
    """
    seen = [(x - corners[0][0], y - corners[0][1]) for x, y in corners]
    return math.fsum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairwise(seen))


def extent(corners: Sequence[Corner]) -> float:
    """Greater side (m) of the box around it."""
    x, y = [p[0] for p in corners], [p[1] for p in corners]
    return max(max(x) - min(x), max(y) - min(y))


def crossing(corners: Sequence[Corner]) -> tuple[int, int] | None:
    """Two sides that cross, by their first corners; None if no two do. The first corner is not repeated."""
    sides = list(enumerate(pairwise((*corners, corners[0]))))
    sides.sort(key=lambda side: min(side[1][0][0], side[1][1][0]))
    for i, (first, (a, b)) in enumerate(sides):
        right = max(a[0], b[0])
        for second, (c, d) in sides[i + 1 :]:
            if min(c[0], d[0]) > right:
                break  # it and all that follow lie further to the right
            if _turn(a, b, c) * _turn(a, b, d) < 0.0 and _turn(c, d, a) * _turn(c, d, b) < 0.0:
                return min(first, second), max(first, second)
    return None


def _turn(a: Corner, b: Corner, c: Corner) -> float:
    """Side of c relative to the line from a to b: positive left, zero on it; only the sign is meaningful."""
    turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return math.copysign(1.0, turn) if turn else 0.0
