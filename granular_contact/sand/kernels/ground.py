"""The surface in space: height and rise at a place, as a plane that elements near it see.

ground (4,): height (m) of a plane above the origin, its rise per length along x and y, and by how much a depth may grow
with a distance. A map of heights adds, from MAP on, its cell (m), the place x, y of its first point (m), its numbers of
rows and columns, and the heights (m) above the plane, row by row; ground[3] is then that of its steepest place. Between
its points the map is that of Catmull and Rom, with a rise that does not jump; beyond its edge it goes on level. It is
compiled for a bed that has one alone, see `space_joining`.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1

PLANE, MAP = 4, 9


@part
def _weights(t, w, dw):
    """Weights (4,) of four neighbours at a share t of the middle interval, and their derivatives by t."""
    w[0], dw[0] = 0.5 * t * (-1.0 + t * (2.0 - t)), 0.5 * (-1.0 + t * (4.0 - 3.0 * t))
    w[1], dw[1] = 1.0 + 0.5 * t * t * (3.0 * t - 5.0), 0.5 * t * (9.0 * t - 10.0)
    w[2], dw[2] = 0.5 * t * (1.0 + t * (4.0 - 3.0 * t)), 0.5 * (1.0 + t * (8.0 - 9.0 * t))
    w[3], dw[3] = 0.5 * t * t * (t - 1.0), 0.5 * t * (3.0 * t - 2.0)


@part
def tangent_plane(ground, x, y, plane):
    """Fill plane (4,) with the one that touches a surface with a map at x, y (m), as `ground` of a plane."""
    for i in range(PLANE):
        plane[i] = ground[i]
    cell, rows, columns = ground[4], int(ground[7]), int(ground[8])
    u, v = (x - ground[5]) / cell, (y - ground[6]) / cell
    a, b = min(max(u, 0.0), columns - 1.0), min(max(v, 0.0), rows - 1.0)
    i, j = min(int(a), columns - 2), min(int(b), rows - 2)
    wx, dx, wy, dy = room1(4), room1(4), room1(4), room1(4)
    _weights(a - i, wx, dx)
    _weights(b - j, wy, dy)
    height = along = across = 0.0
    for k in range(4):
        row = MAP + columns * min(max(j + k - 1, 0), rows - 1)
        for m in range(4):
            h = ground[row + min(max(i + m - 1, 0), columns - 1)]
            height += wy[k] * wx[m] * h
            along += wy[k] * dx[m] * h
            across += dy[k] * wx[m] * h
    along = along / cell if u == a else 0.0
    across = across / cell if v == b else 0.0
    plane[0] += height - along * x - across * y
    plane[1] += along
    plane[2] += across
