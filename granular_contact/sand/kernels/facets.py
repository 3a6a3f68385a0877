"""Forces on the facets of a surface, each with one state of motion, one bristle and the part of it that is immersed.

A facet is a triangle or a parallelogram, which can be a patch of a round surface: see FACET in `facet_records`, also
for the rims of round bodies, which are records of the same type.

A traction of a law is a stress per depth times the depth, and a stress that does not grow with depth; both are
integrated exactly over the immersed part of a facet (`facet_parts`), with the state of motion at its centroid. The
error is of second order in the size of facets: the state of motion and the normal change within a facet.

Facets are treated in blocks (`facet_blocks`): `gather` fills a block with facets of a cluster that are immersed and
may lead, the law fills in their tractions in one call, and `add_up` adds the forces up.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.facet_blocks import write
from granular_contact.sand.kernels.facet_parts import immersed_part
from granular_contact.sand.kernels.facet_records import LANES, PATCH, RIM, TRIANGLE, as_facets, block_room
from granular_contact.sand.kernels.ground import GROWTH, HEIGHT, PLANE, RISE_X, RISE_Y, surface_at
from granular_contact.sand.kernels.space_friction import TINY
from granular_contact.sand.kernels.vectors import (
    at,
    axes,
    cross,
    dot,
    minus,
    norm,
    plus,
    plus_cross,
    put,
    times,
    turned,
    turned_back,
    xyz,
)


@part(inline=True)
def spread_along(facet, q):
    """By how much n . v grows along a and along b of a facet (m/s) whose body turns by q (3,) rad/s in its own frame.

    For a triangle: along the half edges of a parallelogram with the same second moments.
    """
    turning = cross(xyz(facet.normal), q)
    za, zb = dot(turning, xyz(facet.a)), dot(turning, xyz(facet.b))
    if facet.form == TRIANGLE:
        return math.sqrt(0.375) * (za + zb), math.sqrt(0.125) * (za - zb)
    return za, zb


@part(inline=True)
def below_surface(facet, z, d, medium):
    """`immersed_part` of a facet, in a layer the part within the layer.

    z (m): depth of the centroid; d (3,): gradient of the depth in the frame of the body.
    """
    a, b = xyz(facet.a), xyz(facet.b)
    za, zb = dot(d, a), dot(d, b)
    four = facet.form != TRIANGLE
    if medium.layered:
        return law.in_layer(medium, (four, z, za, zb, a, b, medium.top, medium.bottom))
    return immersed_part(four, z, za, zb, a, b)


@part
def gather(elements, anchors, cluster, pose, ground, first, medium, block):
    """Fill a block with facets that are immersed and may lead; return the next row to look at, and their number n.

    Looks at the rows of a cluster's elements from `first` on, until the block is full; other arguments as of
    `space_law.forces`. On a map of heights each facet sees the tangent plane of the surface at its centroid.
    """
    R, v, w, steep = axes(pose), at(pose, law.VELOCITY, 0), at(pose, law.SPIN, 0), ground[GROWTH]
    x0, y0, z0 = x = at(pose, law.POSITION, 0)
    # In the frame of the body: gradient of the depth, angular velocity, velocity of the reference point.
    d, q, velocity = turned_back(R, (ground[RISE_X], ground[RISE_Y], -1.0)), turned_back(R, w), turned_back(R, v)
    depth = ground[HEIGHT] + ground[RISE_X] * x0 + ground[RISE_Y] * y0 - z0  # of the reference point
    mapped, plane = medium.heights != 0, room1(PLANE)
    high = highest(cluster, R, pose[law.POSITION], ground, medium, plane) if mapped else 0.0
    facets = as_facets(elements)
    n, last = np.intp(0), facets.shape[0]  # (as in `space_sand.tangent`)
    for i in range(first, facets.shape[0]):
        if n == LANES:
            last = i
            break
        facet = facets[i]
        b = xyz(facet.centroid)
        z = depth + d[0] * b[0] + d[1] * b[1] + d[2] * b[2]
        if not mapped and (z + facet.reach * steep <= 0.0 or z + beyond_centre(facet, d) <= 0.0):
            continue
        r = turned(R, b)
        if (mapped and high - z0 - r[2] + facet.reach * steep <= 0.0) or facet.form == RIM:
            continue
        e = minus(plus(x, r), at(anchors, i, 0))
        u = plus_cross(velocity, q, b)
        by_motion = facet.side == 0.0 or leads(facet, u, q, 1.0)
        if not by_motion and not is_pulled(facet, u, turned_back(R, e), q):
            continue
        gradient = d
        if mapped:
            z = surface_at(x0 + r[0], y0 + r[1], ground, medium, plane) - z0 - r[2]
            gradient = turned_back(R, (plane[RISE_X], plane[RISE_Y], -1.0))
        moments = below_surface(facet, z, gradient, medium)
        if moments[0] <= 0.0 or moments[1] <= 0.0:
            continue
        write(turned(R, xyz(facet.normal)), block.normal, n)
        write(plus_cross(v, w, r), block.velocity, n)
        write(e, block.stretch, n)
        block.spread[0, n], block.spread[1, n] = spread_along(facet, q)
        write(normal_turn(R, facet.curvatures[0], facet.a), block.turn_a, n)
        write(normal_turn(R, facet.curvatures[1], facet.b), block.turn_b, n)
        block.side[n], block.centroid_depth[n], block.row[n] = facet.side, z, i
        block.scatter[0, n], block.scatter[1, n], block.shear[n] = 1.0, 1.0, np.inf
        note_immersion(block, n, R, r, moments)
        block.area[n] = facet.area * moments[0]
        n += 1
    if medium.note != 0:
        law.note(medium, (block, n, elements, anchors, cluster))
    if medium.lead != 0 and n > 0:
        law.lead(medium, (block, n))
    return last, n


@part
def highest(cluster, R, x, ground, medium, plane):
    """Upper bound of the height (m) of a surface with a map over a cluster; its body is at x (3,) m with the axes R."""
    cx, cy, _ = turned(R, (cluster.x, cluster.y, cluster.z))
    rise = math.sqrt(ground[GROWTH] * ground[GROWTH] - 1.0)
    return surface_at(x[0] + cx, x[1] + cy, ground, medium, plane) + rise * cluster.radius


@part(inline=True)
def leads(facet, x, q, factor):
    """Return whether n . x > 0 anywhere on a facet; x (3,): velocity or bristle of its centroid.

    q (3,): angular velocity of the body; x and q in the frame of the body. factor: as in `facet_blocks.spread`.
    """
    along = dot(xyz(facet.normal), x)
    if along > 0.0:
        return True
    a, b = spread_along(facet, q)
    ax, bx = dot(xyz(facet.a), x), dot(xyz(facet.b), x)
    a, b = factor * a + facet.curvatures[0] * ax, factor * b + facet.curvatures[1] * bx
    return a * a + b * b > along * along


@part(inline=True)
def is_pulled(facet, u, e, q):
    """Return whether any part of a facet may lead by its bristle e (3,) m; u (3,) m/s: velocity; frame of the body.

    Tried with the least and the greatest factor of the velocity that `space_friction.factors_of_facet` may have.
    """
    if leads(facet, e, q, 0.0):
        return True
    along = dot(e, u)
    return along > 0.0 and leads(facet, e, q, along / max(TINY, dot(u, u)))


@part(inline=True)
def normal_turn(R, curvature, edge):
    """Change (3,) of the normal along an edge (3,) m of a facet, whose body has the axes R."""
    if curvature == 0.0:
        return 0.0, 0.0, 0.0
    return turned(R, times(curvature, xyz(edge)))


@part(inline=True)
def note_immersion(block, n, R, r, moments):
    """Fill in the mean depth and where the terms act, for a facet at r (3,) m; moments: see `facet_parts`."""
    s, m, ox, oy, oz, px, py, pz = moments
    by_m, by_s = 1.0 / m, 1.0 / s
    block.depth[n] = m * by_s
    write(plus(r, turned(R, (by_m * px, by_m * py, by_m * pz))), block.growing_arm, n)
    write(plus(r, turned(R, (by_s * ox, by_s * oy, by_s * oz))), block.constant_arm, n)


@part
def facet_forces(elements, anchors, cluster, pose, ground, medium, W):
    """`space_law.forces` of facets."""
    block, first = block_room(), 0
    while first < elements.shape[0]:
        first, n = law.gather(medium, (elements, anchors, cluster, pose, ground, first, block))
        if n > 0:
            law.facets(medium, (block, n))
            add_up(block, n, W)


@part
def add_up(block, n, W):
    """Add the forces on the n facets of a block, and their moments about the reference point, to W (TERMS, 6)."""
    add_term(block, n, block.growing, block.growing_arm, 0, W)
    add_term(block, n, block.constant, block.constant_arm, 1, W)


@part
def add_term(block, n, traction, arm, term, W):
    """`add_up` of one term of the law; traction, arm (3, LANES): fields of the block."""
    s0, s1, s2, s3, s4, s5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(n):
        weight = block.area[k] * (block.depth[k] * block.scatter[0, k] if term == 0 else block.scatter[1, k])
        fx, fy, fz = weight * traction[0, k], weight * traction[1, k], weight * traction[2, k]
        x, y, z = arm[0, k], arm[1, k], arm[2, k]
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
    """`space_law.follow` of facets; most are above the surface and no deeper than a facet before them."""
    R, x, v, w = axes(pose), at(pose, law.POSITION, 0), at(pose, law.VELOCITY, 0), at(pose, law.SPIN, 0)
    steep = ground[GROWTH]
    d, down = turned_back(R, (ground[RISE_X], ground[RISE_Y], -1.0)), turned_back(R, (0.0, 0.0, -1.0))
    mapped, plane = medium.heights != 0, room1(PLANE)
    high = highest(cluster, R, x, ground, medium, plane) if mapped else 0.0
    facets = as_facets(elements)
    for i in range(facets.shape[0]):
        facet = facets[i]
        r = turned(R, xyz(facet.centroid))
        px, py, pz = anchor = p = plus(x, r)
        z = high - pz if mapped else ground[HEIGHT] + ground[RISE_X] * px + ground[RISE_Y] * py - pz
        if mapped and (z + facet.reach * steep > min(0.0, row[law.DEPTH]) or medium.count != 0):
            z = surface_at(px, py, ground, medium, plane) - pz
            d = turned_back(R, (plane[RISE_X], plane[RISE_Y], -1.0))
        if z + facet.reach * steep <= min(0.0, row[law.DEPTH]) and medium.count == 0:
            put(p, anchors, i, 0)
            continue
        deepest = z + beyond_centre(facet, d)
        if facet.form != PATCH:  # corners of a patch are beyond the round surface, whose deepest points its rims have
            row[law.DEPTH] = max(row[law.DEPTH], deepest)
            if deepest > 0.0:
                row[law.LOWEST] = min(row[law.LOWEST], pz - beyond_centre(facet, down))
        if deepest > 0.0:
            row[law.SPEED] = max(row[law.SPEED], norm(plus_cross(v, w, r)))
            anchor = law.drag_anchor(medium, (p, at(anchors, i, 0)))
        if medium.count != 0:
            law.count(medium, (anchors, i, p, anchor, turned(R, xyz(facet.normal)), deepest > 0.0))
        put(anchor, anchors, i, 0)


@part
def beyond_centre(facet, d):
    """By how much the deepest point of a facet is deeper than its centroid (m); d (3,): gradient of the depth.

    With d downward: by how much its lowest point is lower. d is in the frame of the body.
    """
    if facet.form == RIM:
        along, square = dot(d, xyz(facet.normal)), dot(d, d)
        return facet.a[0] * math.sqrt(max(0.0, square - along * along)) + facet.a[1] * math.sqrt(square)
    za, zb = dot(d, xyz(facet.a)), dot(d, xyz(facet.b))
    return max(za, max(zb, -za - zb)) if facet.form == TRIANGLE else abs(za) + abs(zb)
