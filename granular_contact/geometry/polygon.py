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


def ears(corners: Sequence[Corner]) -> list[tuple[int, int, int]]:
    """Triangles of a polygon whose sides do not cross, by the numbers of its corners, counter-clockwise each."""
    left = list(range(len(corners)))
    if doubled_area((*corners, corners[0])) < 0.0:
        left.reverse()
    found = []
    while len(left) > 3:
        k = next((k for k in range(len(left)) if _is_ear(corners, left, k)), 0)
        found.append((left[k - 1], left[k], left[(k + 1) % len(left)]))
        del left[k]
    found.append((left[0], left[1], left[2]))
    return [one for one in found if _turn(*(corners[i] for i in one)) > 0.0]


def _is_ear(corners: Sequence[Corner], left: Sequence[int], k: int) -> bool:
    """Whether the corner number k of those left, between its neighbours, is convex with no other corner inside."""
    ids = left[k - 1], left[k], left[(k + 1) % len(left)]
    a, b, c = (corners[i] for i in ids)
    if _turn(a, b, c) <= 0.0:
        return False
    return not any(
        _turn(a, b, p) >= 0.0 and _turn(b, c, p) >= 0.0 and _turn(c, a, p) >= 0.0
        for p in (corners[i] for i in left if i not in ids)
        if p not in (a, b, c)
    )
