"""Thin round bars in space: strips between stations on a polyline, and the terms of which laws of bars consist.

With depth z, unit tangent t, velocity v, and the regularised signs of `space_friction` (sigma_h along the horizontal
direction r of the motion, sigma_v along the vertical), per unit of arc length:

    dF_d/ds = -k |t x v| v
    dF_h/ds = -2 k z |t x r| sigma_h r          |t x r| ds: length of the bar as its horizontal motion sees it [ours]
    dF_v/ds = -(lam + 1) k (z/l)^lam sigma_v

If a bar moves in its own vertical plane these are the terms and the integrals of `bar_statics`: exact in pieces between
the surface, the points where a bristle reaches its yield, and the point where the motion changes its direction.

A row of `elements` is a station (m); strips of a cluster lie between neighbouring stations.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, room1, room3
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.bar_statics import add_vertical_force
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.ground import PLANE, surface_at
from granular_contact.sand.kernels.immersion import GAUSS_HIGH, GAUSS_LOW, THREE_POINTS, inside
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.planar_friction import drive, mobilised
from granular_contact.sand.kernels.strip import Strip
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
)


@part
def station(E, pose, ground, medium):
    """Position (3,) m, velocity (3,) m/s and depth (m) of a station at E (3,) m in the frame of its body."""
    x, v, w = pose[law.POSITION], pose[law.VELOCITY], pose[law.SPIN]
    r = turned(axes(pose), E)
    p = plus(x, r)
    return p, plus_cross(v, w, r), surface_at(p[0], p[1], ground, medium, room1(PLANE)) - p[2]


@part
def add(f, r, W, term):
    """Add a force (3,) N that acts at r (3,) m from the reference point to the wrench of a term."""
    moment = cross(r, f)
    for i in range(3):
        W[term, i] += f[i]
        W[term, 3 + i] += moment[i]


@part
def bar_forces(elements, anchors, cluster, pose, ground, medium, W):
    """`space_law.forces` of a bar."""
    x, n, f = pose[law.POSITION], elements.shape[0], room3(TERMS, 2, 3)
    q, v1, z1 = station(elements[0], pose, ground, medium)
    p = q
    for i in range(n - 1):
        p, v0, z0 = q, v1, z1
        q, v1, z1 = station(elements[i + 1], pose, ground, medium)
        a, b = inside(z0, z1, medium)
        if a == b:
            continue
        clear(f)
        e0, e1 = minus(p, anchors[i]), minus(q, anchors[i + 1])
        law.bar_force(medium, (Strip(a, b, z0, z1, minus(q, p), v0, v1, e0, e1), cluster, f))
        for term in range(TERMS):
            add(f[term, 0], minus(p, x), W, term)
            add(f[term, 1], minus(q, x), W, term)
    within = z1 > 0.0 and (not medium.layered or medium.top < z1 <= medium.bottom)
    if within and cluster.cap and medium.cap != 0:
        clear(f)
        law.cap_force(medium, (minus(q, p), v1, cluster, f))
        for term in range(TERMS):
            add(f[term, 1], minus(q, x), W, term)


@part
def follow_stations(elements, anchors, cluster, pose, ground, medium, row):
    """`space_law.follow` of the stations of bars; anchors are free unless a strip beside them is immersed."""
    n = elements.shape[0]
    p, v, z = station(elements[0], pose, ground, medium)
    before = z
    for i in range(n):
        q, v1, after = station(elements[min(n - 1, i + 1)], pose, ground, medium)
        row[law.DEPTH] = max(row[law.DEPTH], z)
        if z > 0.0:
            row[law.SPEED] = max(row[law.SPEED], norm(v))
            row[law.LOWEST] = min(row[law.LOWEST], p[2])
        if before > 0.0 or z > 0.0 or after > 0.0:
            p = law.drag_anchor(medium, (p, at(anchors, i, 0)))
        put(p, anchors, i, 0)
        before, p, v, z = z, q, v1, after


# ---- terms of laws ----


@part
def shortest_at(a, b, p, q):
    """Position in [a, b] along a strip at which a vector (3,) that varies linearly from p to q is shortest."""
    d = minus(q, p)
    square = dot(d, d)
    return b if square == 0.0 else min(b, max(a, -dot(p, d) / square))


@part
def interpolated(xi, p, q):
    """Linear interpolation (3,) at xi between p and q at the ends of a strip."""
    return plus(times(1.0 - xi, p), times(xi, q))


@part
def drag_force(strip, k, f):
    """Add the drag to f[end, xyz] (N); k in kg/m^2."""
    w0, w1 = cross(strip.c, strip.v0), cross(strip.c, strip.v1)
    turn = shortest_at(strip.a, strip.b, w0, w1)
    for start, end in ((strip.a, turn), (turn, strip.b)):
        if start == end:
            continue
        for gauss in (GAUSS_LOW, GAUSS_HIGH):
            xi = start + (end - start) * gauss
            kw = k * 0.5 * (end - start) * norm(interpolated(xi, w0, w1))
            vx, vy, vz = interpolated(xi, strip.v0, strip.v1)
            for e, share in ((0, (1.0 - xi) * kw), (1, xi * kw)):
                f[e, 0] -= share * vx
                f[e, 1] -= share * vy
                f[e, 2] -= share * vz


@part
def horizontal_force(strip, k, m, f):
    """Add the horizontal term to f[end, xyz] (N); k in N/m^2."""
    a, b, z0, z1 = strip.a, strip.b, strip.z0, strip.z1
    cx, cy, cz = strip.c
    q0x, q0y = drive((strip.e0[0], strip.e0[1]), (strip.v0[0], strip.v0[1]), m)
    q1x, q1y = drive((strip.e1[0], strip.e1[1]), (strip.v1[0], strip.v1[1]), m)
    turn = shortest_at(a, b, (q0x, q0y, 0.0), (q1x, q1y, 0.0))
    first, last = turn, turn  # bristles between these positions are below their yield
    if m.friction != SMOOTH:
        dx, dy = q1x - q0x, q1y - q0y
        square = dx * dx + dy * dy
        if square > 0.0:
            middle = -(q0x * dx + q0y * dy) / square
            x, y = q0x + middle * dx, q0y + middle * dy
            half = math.sqrt(max(0.0, m.u_y * m.u_y - x * x - y * y) / square)
            first, last = min(b, max(a, middle - half)), min(b, max(a, middle + half))
    for start, end in ((a, first), (first, turn), (turn, last), (last, b)):
        if start >= end:
            continue
        for gauss, weight in THREE_POINTS:
            xi = start + (end - start) * gauss
            (rx, ry), share = mobilised(((1.0 - xi) * q0x + xi * q1x, (1.0 - xi) * q0y + xi * q1y), m)
            across = cx * ry - cy * rx
            projected = math.sqrt(cz * cz + across * across)
            load = 2.0 * k * (end - start) * weight * projected * max(0.0, z0 + xi * (z1 - z0)) * share
            f[0, 0] -= (1.0 - xi) * load * rx
            f[0, 1] -= (1.0 - xi) * load * ry
            f[1, 0] -= xi * load * rx
            f[1, 1] -= xi * load * ry


@part
def vertical_force(strip, k, eta, lam, scale, m, f):
    """Add the vertical term to f[end, xyz] (N); arguments as in `bar_statics.vertical_force`."""
    add_vertical_force(strip, 2, k, eta, lam, scale, m, f)
