"""Facets of a surface, each with one state of motion, one bristle and the part of it that is immersed.

A facet is a triangle with the corners a, b and -a - b from its centroid, or a parallelogram with half edges a and b,
which can be a patch of a round surface: along a and b its normal turns by the curvatures times their lengths. A row of
`elements`: centroid (m), greatest distance from it to a corner (m), normal, area (m^2), a (m), b (m), side (see
`space_law.facets`), form, the two curvatures (1/m). Of round surfaces there are rims, too, which no point is deeper
than: circles around the normal, and spheres around their points, whose radii (m) stand first in a; they have no area.

A traction of a law is a stress per depth times the depth, and a stress that has no depth in it; over the immersed part
of a facet both are integrated exactly (`facet_parts`), with the state of motion at its centroid. What that leaves out
is second order in the size of facets: how the state of motion and the normal change within one.

Only what leads is loaded. With the direction of motion u at the centroid, n . u grows along a and b by s_a and s_b, as
the body turns and as the surface does. A facet counts with g = clip((n . u + s) / (edge + 2 s), 0, 1), s^2 = s_a^2 +
s_b^2: the share of it that leads, n . u being spread evenly over as much as has its mean square, and the fading in of
`plates` where nothing turns. Of a body that rests, with bristles below their yield, the faces beside
it would be loaded or not within a hundredth of a micrometre; so there edge is no angle, but n . q reaches `pressed`, a
part of the yield displacement, before the face is loaded as a whole [ours]. A ball that slides along slowly has up to
1 % less resistance by it, and 4 % less lift, as the flat parts of its underside are loaded in part; at 10 mm/s it has
all.

Facets are treated in blocks: `gather` fills one with those of a cluster that are immersed and may lead, the law fills
its tractions in one call, and the forces are added up. What a law needs of a facet stands in columns of the block, one
number after another for the facets, and its equations are written for one facet in a loop over them, all inlined and
without branches where that is easy: so compilers make vector instructions of it, which hide how long roots and
quotients take.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.chosen import chosen_by
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1, room2
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.facet_parts import immersed_part
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.ground import PLANE, surface_at
from granular_contact.sand.kernels.plates import EDGE
from granular_contact.sand.kernels.space_friction import stretched

COLUMNS = 18
SIDE, FORM, CURVE = 14, 15, 16
TRIANGLE, PARALLELOGRAM, PATCH, RIM = range(4)  # forms

# A block (ROWS, LANES): facets that are loaded, in columns, so that a law treats several of them in one instruction.
LANES = 32
# What a law is told, see `space_law.facets`: mean depth of what is immersed, normal, velocity, stretch of the bristle,
# spread along a and b, side, shear displacement. Three rows each where vectors are.
Z, N, V, E, SPREAD, ONE_SIDE, SHEAR = 0, 1, 4, 7, 10, 12, 13
# The immersed area (m^2), by how much the terms of the law scatter, where they act from the reference point (m), the
# depth of the centroid (m), the row in elements; and what the law fills, its tractions.
AREA, FIRST, SECOND, AT_FIRST, AT_SECOND, CENTRE, ROW = 14, 15, 16, 17, 20, 23, 24
GROWING, CONSTANT = 25, 28
# What `lead` fills: the direction in which the law sees the facet move, and the share of its static force. By how much
# the normal of the facet turns along a and along b, three rows each.
U, SHARE, TURN = 31, 34, 35
ROWS = 41
NOTED = GROWING  # rows that `facet_paths` works in before the law fills them


@chosen_by("m")
def stress(n, u, m):
    """Stress per depth (3,) N/m^3 on an element with the normal n that moves in the direction u, z up; even in n."""


@chosen_by("m")
def traction(z, n, u, side, j, m):
    """Stresses (3,) Pa of the first and of the second term of a law at a depth z > 0 (m), else as of `stress`.

    side as of `space_law.facets`; j (m): shear displacement.
    """


@chosen_by("m")
def inertia(n, v, side, m):
    """Stress (3,) Pa of the second term of a law with a `stress`, which the velocity v (m/s) makes; side as there."""


@chosen_by("m")
def force(z, n, v, e, spread, side, j, m):
    """Tractions, two of (3,), of a law that says all of them by itself, on one facet; see `space_law.facets`."""


@part(inline=True)
def spread(B, k, x, y, z, factor):
    """By how much n . (x, y, z) differs within a facet: s as above, m/s of a velocity.

    factor: that of the velocity in (x, y, z), 0 of what does not differ where the body turns.
    """
    a = factor * B[SPREAD, k] + B[TURN, k] * x + B[TURN + 1, k] * y + B[TURN + 2, k] * z
    b = factor * B[SPREAD + 1, k] + B[TURN + 3, k] * x + B[TURN + 4, k] * y + B[TURN + 5, k] * z
    return math.sqrt(a * a + b * b)


@part(inline=True)
def vector(B, row, k):
    """A vector (3,) of a facet of a block."""
    return B[row, k], B[row + 1, k], B[row + 2, k]


@part
def lead(B, n, m):
    """Fill rows U and SHARE of a block: the directions u in which a law sees facets move, and the shares g s."""
    rest = m.v_eps if m.friction == SMOOTH else m.u_y
    Q = room2(5, LANES)  # q and its factor of v, see `space_friction.drive`; 1 / |q|
    D = room2(4, LANES)  # what is filled
    if m.friction == SMOOTH:
        for k in range(n):
            Q[0, k], Q[1, k], Q[2, k], Q[3, k] = B[V, k], B[V + 1, k], B[V + 2, k], 1.0
    else:
        for k in range(n):
            (Q[0, k], Q[1, k], Q[2, k]), Q[3, k] = stretched(vector(B, E, k), vector(B, V, k), m)
    for k in range(n):
        x, y, z = Q[0, k], Q[1, k], Q[2, k]
        h = math.sqrt(x * x + y * y + z * z)
        still = h == 0.0  # then any direction will do
        one = 0.0 if still else 1.0 / h
        D[0, k] = B[N, k] if still else one * x
        D[1, k] = B[N + 1, k] if still else one * y
        D[2, k] = B[N + 2, k] if still else one * z
        D[3, k] = min(1.0, h / rest)
        Q[4, k] = one
    if m.friction == SMOOTH:
        for k in range(n):
            D[3, k] = math.tanh(math.sqrt(Q[0, k] ** 2 + Q[1, k] ** 2 + Q[2, k] ** 2) / rest)
    for k in range(n):
        one = Q[4, k]
        s = spread(B, k, D[0, k], D[1, k], D[2, k], Q[3, k] * one)
        along = B[N, k] * D[0, k] + B[N + 1, k] * D[1, k] + B[N + 2, k] * D[2, k]
        g = min(1.0, max(0.0, (along + s) / (max(EDGE, m.pressed * one) + 2.0 * s)))
        D[3, k] *= 1.0 if B[ONE_SIDE, k] == 0.0 else g
    for row in range(4):
        for k in range(n):
            B[U + row, k] = D[row, k]


@part
def traction_facets(B, n, m):
    """Static tractions of a law with a `traction`; arguments and result as of `space_law.facets`.

    Over a facet the first term counts as growing in proportion to the depth, which errs by the square of its size.
    """
    for k in range(n):
        share, z = B[SHARE, k], B[Z, k]
        first, second = traction(z, vector(B, N, k), vector(B, U, k), B[ONE_SIDE, k], B[SHEAR, k], m)
        (px, py, pz), (sx, sy, sz) = first, second
        one = share / z
        B[GROWING, k], B[GROWING + 1, k], B[GROWING + 2, k] = one * px, one * py, one * pz
        B[CONSTANT, k], B[CONSTANT + 1, k], B[CONSTANT + 2, k] = share * sx, share * sy, share * sz


@part
def static_facets(B, n, m):
    """Static tractions of a law with a `stress`; arguments and result as of `space_law.facets`."""
    S = room2(3, LANES)
    for k in range(n):
        share = B[SHARE, k]
        x, y, z = stress(vector(B, N, k), vector(B, U, k), m)
        S[0, k], S[1, k], S[2, k] = share * x, share * y, share * z
    for row in range(3):
        for k in range(n):
            B[GROWING + row, k], B[CONSTANT + row, k] = S[row, k], 0.0


@part
def own_facets(B, n, m):
    """Tractions of a law with a `force`; arguments and result as of `space_law.facets`."""
    for k in range(n):
        v = vector(B, V, k)
        s = spread(B, k, v[0], v[1], v[2], 1.0)
        first, second = force(B[Z, k], vector(B, N, k), v, vector(B, E, k), s, B[ONE_SIDE, k], B[SHEAR, k], m)
        B[GROWING, k], B[GROWING + 1, k], B[GROWING + 2, k] = first
        B[CONSTANT, k], B[CONSTANT + 1, k], B[CONSTANT + 2, k] = second


@part
def inertial_facets(B, n, m):
    """Tractions of a law with a `stress` and an `inertia`; arguments and result as of `space_law.facets`."""
    static_facets(B, n, m)
    for k in range(n):
        B[CONSTANT, k], B[CONSTANT + 1, k], B[CONSTANT + 2, k] = inertia(
            vector(B, N, k), vector(B, V, k), B[ONE_SIDE, k], m
        )


@part(inline=True)
def axes(pose):
    """Axes of a body as seen from the bed, row by row (9,), as numbers that stay in registers."""
    x, y, z = pose[0], pose[1], pose[2]
    return x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]


@part(inline=True)
def turned(R, x, y, z):
    """A vector (3,) of the frame of a body in that of the bed; R: its `axes`."""
    return R[0] * x + R[1] * y + R[2] * z, R[3] * x + R[4] * y + R[5] * z, R[6] * x + R[7] * y + R[8] * z


@part(inline=True)
def seen(R, x, y, z):
    """A vector (3,) of the frame of the bed in that of a body; R: its `axes`."""
    return R[0] * x + R[3] * y + R[6] * z, R[1] * x + R[4] * y + R[7] * z, R[2] * x + R[5] * y + R[8] * z


@part(inline=True)
def spread_along(elements, i, q):
    """By how much n . v grows along a and b of a facet, row i, as it turns by q (3,), as seen from the body.

    Of a triangle along the half edges of a parallelogram with its second moments.
    """
    cx, cy, cz = elements[i, 4], elements[i, 5], elements[i, 6]
    tx, ty, tz = cy * q[2] - cz * q[1], cz * q[0] - cx * q[2], cx * q[1] - cy * q[0]
    za = tx * elements[i, 8] + ty * elements[i, 9] + tz * elements[i, 10]
    zb = tx * elements[i, 11] + ty * elements[i, 12] + tz * elements[i, 13]
    if elements[i, FORM] == TRIANGLE:
        return math.sqrt(0.375) * (za + zb), math.sqrt(0.125) * (za - zb)
    return za, zb


@part(inline=True)
def below_surface(elements, i, z, d, medium):
    """`immersed_part` of a facet, row i, whose depth grows by d (3,) as seen from the body; of that in the layer."""
    a = elements[i, 8], elements[i, 9], elements[i, 10]
    b = elements[i, 11], elements[i, 12], elements[i, 13]
    za, zb = d[0] * a[0] + d[1] * a[1] + d[2] * a[2], d[0] * b[0] + d[1] * b[1] + d[2] * b[2]
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
    R, x0, y0, z0, steep = axes(pose), pose[3, 0], pose[3, 1], pose[3, 2], ground[3]
    v, w = (pose[4, 0], pose[4, 1], pose[4, 2]), (pose[5, 0], pose[5, 1], pose[5, 2])
    # Seen from the body: how the depth grows, and the angular velocity.
    d, q = seen(R, ground[1], ground[2], -1.0), seen(R, w[0], w[1], w[2])
    depth = ground[0] + ground[1] * x0 + ground[2] * y0 - z0  # of the reference point
    mapped, plane = medium.heights != 0, room1(PLANE)
    high = highest(cluster, R, pose[3], ground, medium, plane) if mapped else 0.0
    n, last = np.intp(0), elements.shape[0]  # (as in `space_sand.tangent`)
    for i in range(first, elements.shape[0]):
        if n == LANES:
            last = i
            break
        bx, by, bz = elements[i, 0], elements[i, 1], elements[i, 2]
        r = turned(R, bx, by, bz)
        z = high - z0 - r[2] if mapped else depth + d[0] * bx + d[1] * by + d[2] * bz
        if z + elements[i, 3] * steep <= 0.0 or elements[i, FORM] == RIM:
            continue
        normal = turned(R, elements[i, 4], elements[i, 5], elements[i, 6])
        e = x0 + r[0] - anchors[i, 0], y0 + r[1] - anchors[i, 1], z0 + r[2] - anchors[i, 2]
        note_motion(B, n, r, normal, v, w, e)
        note_spread(B, n, R, elements, i, q)
        if elements[i, SIDE] != 0.0 and trails(B, n):
            continue
        deeper = d
        if mapped:
            z = surface_at(x0 + r[0], y0 + r[1], ground, medium, plane) - z0 - r[2]
            deeper = seen(R, plane[1], plane[2], -1.0)
        below = below_surface(elements, i, z, deeper, medium)
        if below[0] <= 0.0 or below[1] <= 0.0:
            continue
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
    cx, cy, _ = turned(R, cluster.x, cluster.y, cluster.z)
    rise = math.sqrt(ground[3] * ground[3] - 1.0)
    return surface_at(x[0] + cx, x[1] + cy, ground, medium, plane) + rise * cluster.radius


@part(inline=True)
def trails(B, n):
    """Whether nothing of a facet of a block leads, neither by its motion nor by its bristle."""
    vx, vy, vz, ex, ey, ez = B[V, n], B[V + 1, n], B[V + 2, n], B[E, n], B[E + 1, n], B[E + 2, n]
    along = B[N, n] * vx + B[N + 1, n] * vy + B[N + 2, n] * vz
    if along > 0.0 or along + spread(B, n, vx, vy, vz, 1.0) > 0.0:
        return False
    along = B[N, n] * ex + B[N + 1, n] * ey + B[N + 2, n] * ez
    return along <= 0.0 and along + spread(B, n, ex, ey, ez, 0.0) <= 0.0


@part(inline=True)
def note_motion(B, n, r, normal, v, w, e):
    """Fill normal, velocity and stretch of the bristle of a facet at r (3,) m from the reference point of its body."""
    B[N, n], B[N + 1, n], B[N + 2, n] = normal
    B[V, n] = v[0] + w[1] * r[2] - w[2] * r[1]
    B[V + 1, n] = v[1] + w[2] * r[0] - w[0] * r[2]
    B[V + 2, n] = v[2] + w[0] * r[1] - w[1] * r[0]
    B[E, n], B[E + 1, n], B[E + 2, n] = e


@part(inline=True)
def note_spread(B, n, R, elements, i, q):
    """Fill by how much n . v grows along a and b of a facet, row i, and by how much its normal turns."""
    B[SPREAD, n], B[SPREAD + 1, n] = spread_along(elements, i, q)
    for k in range(2):
        curve, first, at = elements[i, CURVE + k], 8 + 3 * k, TURN + 3 * k
        B[at, n], B[at + 1, n], B[at + 2, n] = 0.0, 0.0, 0.0
        if curve != 0.0:
            x, y, z = elements[i, first], elements[i, first + 1], elements[i, first + 2]
            B[at, n], B[at + 1, n], B[at + 2, n] = turned(R, curve * x, curve * y, curve * z)


@part(inline=True)
def note_immersion(B, n, R, r, below):
    """Fill the mean depth and where the terms act, of a facet at r (3,) m; below: its moments, see `facet_parts`."""
    s, m, ox, oy, oz, px, py, pz = below
    one, two = 1.0 / m, 1.0 / s
    x, y, z = turned(R, one * px, one * py, one * pz)
    B[Z, n], B[AT_FIRST, n], B[AT_FIRST + 1, n], B[AT_FIRST + 2, n] = m * two, r[0] + x, r[1] + y, r[2] + z
    x, y, z = turned(R, two * ox, two * oy, two * oz)
    B[AT_SECOND, n], B[AT_SECOND + 1, n], B[AT_SECOND + 2, n] = r[0] + x, r[1] + y, r[2] + z


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
    R, x, v, w, steep = axes(pose), pose[3], pose[4], pose[5], ground[3]
    mapped, plane, d = medium.heights != 0, room1(PLANE), seen(axes(pose), ground[1], ground[2], -1.0)
    high = highest(cluster, R, x, ground, medium, plane) if mapped else 0.0
    for i in range(elements.shape[0]):
        E = elements[i]
        rx, ry, rz = turned(R, E[0], E[1], E[2])
        px, py, pz = x[0] + rx, x[1] + ry, x[2] + rz
        ax, ay, az = px, py, pz
        z = high - pz if mapped else ground[0] + ground[1] * px + ground[2] * py - pz
        if mapped and (z + E[3] * steep > min(0.0, row[law.DEPTH]) or medium.count != 0):
            z = surface_at(px, py, ground, medium, plane) - pz
            d = seen(R, plane[1], plane[2], -1.0)
        if z + E[3] * steep <= min(0.0, row[law.DEPTH]) and medium.count == 0:
            anchors[i, 0], anchors[i, 1], anchors[i, 2] = ax, ay, az
            continue
        lowest = beyond_centre(E, d)
        deepest = z + lowest
        if E[FORM] != PATCH:
            row[law.DEPTH] = max(row[law.DEPTH], deepest)
        if deepest > 0.0:
            row[law.LOWEST] = min(row[law.LOWEST], pz - lowest)
            vx, vy, vz = v[0] + w[1] * rz - w[2] * ry, v[1] + w[2] * rx - w[0] * rz, v[2] + w[0] * ry - w[1] * rx
            row[law.SPEED] = max(row[law.SPEED], math.sqrt(vx * vx + vy * vy + vz * vz))
            ax, ay, az = law.drag_anchor(medium, ((px, py, pz), (anchors[i, 0], anchors[i, 1], anchors[i, 2])))
        if medium.count != 0:
            n = turned(R, E[4], E[5], E[6])
            law.count(medium, (anchors, i, (px, py, pz), (ax, ay, az), n, deepest > 0.0))
        anchors[i, 0], anchors[i, 1], anchors[i, 2] = ax, ay, az


@part
def beyond_centre(E, d):
    """By how much the deepest point of a facet (a row) is deeper than its centroid; its depth grows by d (3,)."""
    dx, dy, dz = d
    if E[FORM] == RIM:
        along, square = dx * E[4] + dy * E[5] + dz * E[6], dx * dx + dy * dy + dz * dz
        return E[8] * math.sqrt(max(0.0, square - along * along)) + E[9] * math.sqrt(square)
    za, zb = dx * E[8] + dy * E[9] + dz * E[10], dx * E[11] + dy * E[12] + dz * E[13]
    return max(za, max(zb, -za - zb)) if E[FORM] == TRIANGLE else abs(za) + abs(zb)
