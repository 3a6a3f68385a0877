"""The surface in space: its height and its tangent plane at a position.

ground (4,): HEIGHT (m) of a plane above the origin, its RISE_X and RISE_Y per length along x and y, and GROWTH, the
greatest growth of a depth with a distance, sqrt(1 + rise^2). A map of heights adds its CELL (m), the position FIRST_X,
FIRST_Y of its first point (m), its numbers of ROWS and COLUMNS, and, from MAP on, the heights (m) above the plane, row
by row; GROWTH is then that of its steepest point. Between its points the map is a Catmull-Rom surface, with a
continuous slope; beyond its edge it continues level. It is compiled only for a bed with a map, see `space_joining`.
"""

from __future__ import annotations

from granular_contact.geometry import catmull_rom
from granular_contact.jit.compiled import part
from granular_contact.sand.kernels import space_law as law

# Entries of ground and of a plane; entries of a map; size of a plane, and first height of a map.
HEIGHT, RISE_X, RISE_Y, GROWTH = 0, 1, 2, 3
CELL, FIRST_X, FIRST_Y, ROWS, COLUMNS = 4, 5, 6, 7, 8
PLANE, MAP = 4, 9


@part
def surface_at(x, y, ground, medium, plane):
    """Fill plane (4,) with the tangent plane of the surface at x, y (m), as `ground`; return its height (m) there."""
    if medium.heights != 0:
        law.tangent_plane(medium, (ground, x, y, plane))
    else:
        for i in range(PLANE):
            plane[i] = ground[i]
    return plane[HEIGHT] + plane[RISE_X] * x + plane[RISE_Y] * y


_weights, _slopes = part(inline=True)(catmull_rom.weights), part(inline=True)(catmull_rom.slopes)


@part
def tangent_plane(ground, x, y, plane):
    """`surface_at` for a surface with a map; fills plane alone."""
    for i in range(PLANE):
        plane[i] = ground[i]
    cell, rows, columns = ground[CELL], int(ground[ROWS]), int(ground[COLUMNS])
    u, v = (x - ground[FIRST_X]) / cell, (y - ground[FIRST_Y]) / cell
    a, b = min(max(u, 0.0), columns - 1.0), min(max(v, 0.0), rows - 1.0)
    i, j = min(int(a), columns - 2), min(int(b), rows - 2)
    wx, dx, wy, dy = _weights(a - i), _slopes(a - i), _weights(b - j), _slopes(b - j)
    before, after = max(i - 1, 0), min(i + 2, columns - 1)
    height = along = across = 0.0
    for k in range(4):
        row = MAP + columns * min(max(j + k - 1, 0), rows - 1)
        h0, h1, h2, h3 = ground[row + before], ground[row + i], ground[row + i + 1], ground[row + after]
        in_row = wx[0] * h0 + wx[1] * h1 + wx[2] * h2 + wx[3] * h3
        height += wy[k] * in_row
        along += wy[k] * (dx[0] * h0 + dx[1] * h1 + dx[2] * h2 + dx[3] * h3)
        across += dy[k] * in_row
    along = along / cell if u == a else 0.0
    across = across / cell if v == b else 0.0
    plane[HEIGHT] += height - along * x - across * y
    plane[RISE_X] += along
    plane[RISE_Y] += across
