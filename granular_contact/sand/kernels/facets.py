"""Facets of a surface, each with one state of motion, one bristle and the part of it that is immersed.

A facet is a triangle with the corners a, b and -a - b from its centroid, or a parallelogram with half edges a and b,
which can be a patch of a round surface: along a and b its normal turns by the curvatures times their lengths. A row of
`elements`: centroid (m), greatest distance from it to a corner (m), normal, area (m^2), a (m), b (m), side (see
`space_law.facets`), form, the two curvatures (1/m). Of round surfaces there are rims, too, which no point is deeper
than: circles around the normal, and spheres around their points, whose radii (m) stand first in a; they have no area.

A traction of a law is a stress per depth times the depth, and a stress that has no depth in it; over the immersed part
of a facet both are integrated exactly (`facet_parts`), with the state of motion at its centroid. What that leaves out
is second order in the size of facets: how the state of motion and the normal change within one.

They are treated in blocks (`facet_blocks`): `gather` fills one with those of a cluster that are immersed and may lead,
the law fills its tractions in one call, and the forces are added up.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1, room2
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.facet_blocks import (
    AREA,
    AT_FIRST,
    AT_SECOND,
    CENTRE,
    CONSTANT,
    FIRST,
    GROWING,
    LANES,
    ONE_SIDE,
    ROW,
    ROWS,
    SECOND,
    SHEAR,
    SPREAD,
    TURN,
    E,
    N,
    V,
    Z,
    write,
)  # fmt: skip
from granular_contact.sand.kernels.facet_parts import immersed_part
from granular_contact.sand.kernels.ground import PLANE, surface_at
from granular_contact.sand.kernels.space_friction import TINY
from granular_contact.sand.kernels.vectors import (
    at,
    axes,
    cross,
    dot,
    minus,
    moving,
    norm,
    plus,
    put,
    seen,
    times,
    turned,
    vector,
)

COLUMNS = 18
SIDE, FORM, CURVE = 14, 15, 16
TRIANGLE, PARALLELOGRAM, PATCH, RIM = range(4)  # forms


@part(inline=True)
def spread_along(elements, i, q):
    """By how much n . v grows along a and b of a facet, row i, as it turns by q (3,), as seen from the body.

    Of a triangle along the half edges of a parallelogram with its second moments.
    """
    turning = cross(at(elements, i, 4), q)
    za, zb = dot(turning, at(elements, i, 8)), dot(turning, at(elements, i, 11))
    if elements[i, FORM] == TRIANGLE:
        return math.sqrt(0.375) * (za + zb), math.sqrt(0.125) * (za - zb)
    return za, zb


@part(inline=True)
def below_surface(elements, i, z, d, medium):
    """`immersed_part` of a facet, row i, whose depth grows by d (3,) as seen from the body; of that in the layer."""
    a, b = at(elements, i, 8), at(elements, i, 11)
    za, zb = dot(d, a), dot(d, b)
    four = elements[i, FORM] != TRIANGLE
    if medium.layered:
        return law.in_layer(medium, (four, z, za, zb, a, b, medium.top, medium.bottom))
    return immersed_part(four, z, za, zb, a, b)


@part
def gather(elements, anchors, cluster, pose, ground, first, medium, B):
    """Fill a block with facets that are immersed and may lead; the row after those looked at, and their number.

    Looks at the rows of a cluster's elements from `first` on, until the block is full; other arguments as of
    `space_law.forces`. Of a map of heights each facet that may lead sees the plane at its centroid.
    """
    R, v, w, steep = axes(pose), at(pose, 4, 0), at(pose, 5, 0), ground[3]
    x0, y0, z0 = x = at(pose, 3, 0)
    # Seen from the body: how the depth grows, the angular velocity, the velocity.
    d, q, own = seen(R, (ground[1], ground[2], -1.0)), seen(R, w), seen(R, v)
    depth = ground[0] + ground[1] * x0 + ground[2] * y0 - z0  # of the reference point
    mapped, plane = medium.heights != 0, room1(PLANE)
    high = highest(cluster, R, pose[3], ground, medium, plane) if mapped else 0.0
    n, last = np.intp(0), elements.shape[0]  # (as in `space_sand.tangent`)
    for i in range(first, elements.shape[0]):
        if n == LANES:
            last = i
            break
        b = at(elements, i, 0)
        z = depth + d[0] * b[0] + d[1] * b[1] + d[2] * b[2]
        if not mapped and (z + elements[i, 3] * steep <= 0.0 or z + beyond_centre(elements[i], d) <= 0.0):
            continue
        r = turned(R, b)
        if (mapped and high - z0 - r[2] + elements[i, 3] * steep <= 0.0) or elements[i, FORM] == RIM:
            continue
        e = minus(plus(x, r), at(anchors, i, 0))
        u = moving(own, q, b)
        by_motion = elements[i, SIDE] == 0.0 or leads(elements, i, u, q, 1.0)
        if not by_motion and not is_pulled(elements, i, u, seen(R, e), q):
            continue
        deeper = d
        if mapped:
            z = surface_at(x0 + r[0], y0 + r[1], ground, medium, plane) - z0 - r[2]
            deeper = seen(R, (plane[1], plane[2], -1.0))
        below = below_surface(elements, i, z, deeper, medium)
        if below[0] <= 0.0 or below[1] <= 0.0:
            continue
        write(turned(R, at(elements, i, 4)), B, N, n)
        write(moving(v, w, r), B, V, n)
        write(e, B, E, n)
        note_spread(B, n, R, elements, i, q)
        B[ONE_SIDE, n], B[CENTRE, n], B[ROW, n] = elements[i, SIDE], z, i
        B[AREA, n], B[FIRST, n], B[SECOND, n], B[SHEAR, n] = elements[i, 7] * below[0], 1.0, 1.0, np.inf
        note_immersion(B, n, R, r, below)
        n += 1
    if medium.note != 0:
        law.note(medium, (B, n, elements, anchors, cluster))
    if medium.lead != 0 and n > 0:
        law.lead(medium, (B, n))
    return last, n


@part
def highest(cluster, R, x, ground, medium, plane):
    """Bound for the height (m) of a surface with a map over a cluster of a body at x (3,) m with the axes R."""
    cx, cy, _ = turned(R, (cluster.x, cluster.y, cluster.z))
    rise = math.sqrt(ground[3] * ground[3] - 1.0)
    return surface_at(x[0] + cx, x[1] + cy, ground, medium, plane) + rise * cluster.radius


@part(inline=True)
def leads(elements, i, x, q, factor):
    """Whether n . x > 0 anywhere on a facet, row i; x (3,): velocity or bristle of its centroid, as seen from the body.

    Its body turns by q (3,), as seen from there, too; factor: as of `facet_blocks.spread`.
    """
    along = dot(at(elements, i, 4), x)
    if along > 0.0:
        return True
    a, b = spread_along(elements, i, q)
    ax, bx = dot(at(elements, i, 8), x), dot(at(elements, i, 11), x)
    a, b = factor * a + elements[i, CURVE] * ax, factor * b + elements[i, CURVE + 1] * bx
    return a * a + b * b > along * along


@part(inline=True)
def is_pulled(elements, i, u, e, q):
    """Whether anything of a facet, row i, leads by its bristle e (3,); u (3,): velocity; both as seen from the body.

    With all factors that `space_friction.factors_of_facet` may have: the greatest and none.
    """
    if leads(elements, i, e, q, 0.0):
        return True
    along = dot(e, u)
    return along > 0.0 and leads(elements, i, e, q, along / max(TINY, dot(u, u)))


@part(inline=True)
def note_spread(B, n, R, elements, i, q):
    """Fill by how much n . v grows along a and b of a facet, row i, and by how much its normal turns."""
    B[SPREAD, n], B[SPREAD + 1, n] = spread_along(elements, i, q)
    for k in range(2):
        curve, turn = elements[i, CURVE + k], (0.0, 0.0, 0.0)
        if curve != 0.0:
            turn = turned(R, times(curve, at(elements, i, 8 + 3 * k)))
        write(turn, B, TURN + 3 * k, n)


@part(inline=True)
def note_immersion(B, n, R, r, below):
    """Fill the mean depth and where the terms act, of a facet at r (3,) m; below: its moments, see `facet_parts`."""
    s, m, ox, oy, oz, px, py, pz = below
    one, two = 1.0 / m, 1.0 / s
    B[Z, n] = m * two
    write(plus(r, turned(R, (one * px, one * py, one * pz))), B, AT_FIRST, n)
    write(plus(r, turned(R, (two * ox, two * oy, two * oz))), B, AT_SECOND, n)


@part
def facet_forces(elements, anchors, cluster, pose, ground, medium, W):
    """`space_law.forces` of facets."""
    B, first = room2(ROWS, LANES), 0
    while first < elements.shape[0]:
        first, n = law.gather(medium, (elements, anchors, cluster, pose, ground, first, B))
        if n > 0:
            law.facets(medium, (B, n))
            add_up(B, n, W)


@part
def add_up(B, n, W):
    """Add the forces on the facets of a block, and their moments about the reference point, to W (TERMS, 6)."""
    for term in range(2):
        traction, at = (GROWING, AT_FIRST) if term == 0 else (CONSTANT, AT_SECOND)
        s0, s1, s2, s3, s4, s5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(n):
            one = B[AREA, k] * (B[Z, k] * B[FIRST, k] if term == 0 else B[SECOND, k])
            fx, fy, fz = one * B[traction, k], one * B[traction + 1, k], one * B[traction + 2, k]
            x, y, z = B[at, k], B[at + 1, k], B[at + 2, k]
            s0, s1, s2 = s0 + fx, s1 + fy, s2 + fz
            s3, s4, s5 = s3 + y * fz - z * fy, s4 + z * fx - x * fz, s5 + x * fy - y * fx
        W[term, 0] += s0
        W[term, 1] += s1
        W[term, 2] += s2
        W[term, 3] += s3
        W[term, 4] += s4
        W[term, 5] += s5


@part
def follow_facets(elements, anchors, cluster, pose, ground, medium, row):
    """`space_law.follow` of facets, of which most are above the surface and no deeper than one before them."""
    R, x, v, w, steep = axes(pose), at(pose, 3, 0), at(pose, 4, 0), at(pose, 5, 0), ground[3]
    d, down = seen(R, (ground[1], ground[2], -1.0)), seen(R, (0.0, 0.0, -1.0))
    mapped, plane = medium.heights != 0, room1(PLANE)
    high = highest(cluster, R, x, ground, medium, plane) if mapped else 0.0
    for i in range(elements.shape[0]):
        E = elements[i]
        r = turned(R, at(elements, i, 0))
        px, py, pz = a = p = plus(x, r)
        z = high - pz if mapped else ground[0] + ground[1] * px + ground[2] * py - pz
        if mapped and (z + E[3] * steep > min(0.0, row[law.DEPTH]) or medium.count != 0):
            z = surface_at(px, py, ground, medium, plane) - pz
            d = seen(R, (plane[1], plane[2], -1.0))
        if z + E[3] * steep <= min(0.0, row[law.DEPTH]) and medium.count == 0:
            put(p, anchors, i, 0)
            continue
        deepest = z + beyond_centre(E, d)
        if E[FORM] != PATCH:  # whose corners are beyond the round surface; rims have its deepest points
            row[law.DEPTH] = max(row[law.DEPTH], deepest)
            if deepest > 0.0:
                row[law.LOWEST] = min(row[law.LOWEST], pz - beyond_centre(E, down))
        if deepest > 0.0:
            row[law.SPEED] = max(row[law.SPEED], norm(moving(v, w, r)))
            a = law.drag_anchor(medium, (p, at(anchors, i, 0)))
        if medium.count != 0:
            law.count(medium, (anchors, i, p, a, turned(R, at(elements, i, 4)), deepest > 0.0))
        put(a, anchors, i, 0)


@part
def beyond_centre(E, d):
    """By how much the deepest point of a facet (a row) is deeper than its centroid; its depth grows by d (3,).

    With d downward, by how much its lowest point is lower.
    """
    if E[FORM] == RIM:
        along, square = dot(d, vector(E, 4)), dot(d, d)
        return E[8] * math.sqrt(max(0.0, square - along * along)) + E[9] * math.sqrt(square)
    za, zb = dot(d, vector(E, 8)), dot(d, vector(E, 11))
    return max(za, max(zb, -za - zb)) if E[FORM] == TRIANGLE else abs(za) + abs(zb)
