"""Granular forces on a line of stations from their motion, in two forms.

Between two neighbouring stations of a contact line lies a straight strip. `distributed_forces` integrates a law along
each strip. `resultant_forces` has the form of the source paper: the immersed part is one straight segment that moves
with the velocity of its middle, where the whole force acts. Arguments: as in `law.forces`.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, room3
from granular_contact.sand.kernels import law
from granular_contact.sand.kernels.immersion import immersed_interval, inside
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.strip import Strip
from granular_contact.sand.kernels.surface import depth
from granular_contact.sand.kernels.vectors import norm


@part
def collect(f, i, P, F, totals):
    """Add the end forces f[term, end, xy] of strip i to the station forces F and to the totals."""
    for end in range(2):
        x, y = P[i + end, 0], P[i + end, 1]
        for term in range(TERMS):
            fx, fy = f[term, end, 0], f[term, end, 1]
            F[i + end, 0] += fx
            F[i + end, 1] += fy
            totals[term, 0] += fx
            totals[term, 1] += fy
            totals[term, 2] += x * fy - y * fx


@part
def apart(A, i, B, j):
    """Vector (2,) from row i of A to row j of B."""
    return B[j, 0] - A[i, 0], B[j, 1] - A[i, 1]


@part
def distributed_forces(P, V, anchors, line, profile, medium, F, totals):
    """Integrate the law strip by strip."""
    f, length = room3(TERMS, 2, 2), 0.0
    clear(F)
    last = P.shape[0] - 1
    line.ahead0, line.ahead1, line.back0, line.back1, place = np.inf, np.inf, np.inf, np.inf, line.place
    z1 = depth(profile, P[0, 0], P[0, 1])
    if line.behind > 0.0:
        z1 -= law.lowering(P, V, 0, line, medium)
    for i in range(last):
        z0, z1 = z1, depth(profile, P[i + 1, 0], P[i + 1, 1])
        if line.behind > 0.0:
            z1 -= law.lowering(P, V, i + 1, line, medium)
        if line.scatter > 0.0:
            length = norm(apart(P, i, P, i + 1))
            place += length
        a, b = inside(z0, z1, line)
        if a == b:
            continue
        clear(f)
        if anchors.shape[1] > 2:
            law.count_shear(P, anchors, i, line, medium)
        c, v0, v1 = apart(P, i, P, i + 1), (V[i, 0], V[i, 1]), (V[i + 1, 0], V[i + 1, 1])
        e0, e1 = apart(anchors, i, P, i), apart(anchors, i + 1, P, i + 1)
        law.strip_force(Strip(a, b, z0, z1, c, v0, v1, e0, e1), line, medium, f)
        if line.scatter > 0.0:
            law.scattered(f, P, anchors, i, place - 0.5 * length, length, line, medium)
        collect(f, i, P, F, totals)
    if line.cap and z1 > 0.0 and (not line.layered or line.top < z1 <= line.bottom):
        clear(f)
        law.cap_force(apart(P, last - 1, P, last), (V[last, 0], V[last, 1]), line, medium, f)
        collect(f, last - 1, P, F, totals)


@part
def immersed_segment(P, profile):
    """First and last immersed point of a line with stations P (n, 2) m, as positions i + xi; else (0, 0)."""
    first, last = 0.0, 0.0
    begun, z1 = False, depth(profile, P[0, 0], P[0, 1])
    for i in range(P.shape[0] - 1):
        z0, z1 = z1, depth(profile, P[i + 1, 0], P[i + 1, 1])
        a, b = immersed_interval(z0, z1)
        if b > a:
            if not begun:
                first = i + a
                begun = True
            last = i + b
    return first, last


@part
def length_within(P, i, first, last):
    """Length (m) of the part of strip i between two positions i + xi."""
    share = min(last, i + 1.0) - max(first, float(i))
    return share * math.hypot(P[i + 1, 0] - P[i, 0], P[i + 1, 1] - P[i, 1]) if share > 0.0 else 0.0


@part
def halfway(P, first, last):
    """Middle position by length, between two positions i + xi along the stations P (n, 2) m."""
    left = 0.0
    for i in range(P.shape[0] - 1):
        left += 0.5 * length_within(P, i, first, last)
    for i in range(P.shape[0] - 1):
        length = length_within(P, i, first, last)
        if left < length:
            start, end = max(first, float(i)), min(last, i + 1.0)
            return start + left / length * (end - start)
        left -= length
    return last


@part
def at(A, position):
    """Linear interpolation of the rows of A (n, 2) at position i + xi along the stations."""
    i = min(int(position), A.shape[0] - 2)
    xi = position - i
    return (1.0 - xi) * A[i, 0] + xi * A[i + 1, 0], (1.0 - xi) * A[i, 1] + xi * A[i + 1, 1]


@part
def resultant_forces(P, V, anchors, line, profile, medium, F, totals):
    """Law for the immersed part as one straight segment, with the velocity and the bristle of its middle."""
    clear(F)
    first, last = immersed_segment(P, profile)
    if last == first:
        return
    middle = halfway(P, first, last)
    i = min(int(middle), P.shape[0] - 2)
    x0, y0 = at(P, first)
    x1, y1 = at(P, last)
    v, p, anchor = at(V, middle), at(P, middle), at(anchors, middle)
    c, e = (x1 - x0, y1 - y0), (p[0] - anchor[0], p[1] - anchor[1])
    f = room3(TERMS, 2, 2)
    clear(f)
    # The ends of the segment lie on the surface only up to round-off; the depth there is zero by definition.
    z0, z1 = max(0.0, depth(profile, x0, y0)), max(0.0, depth(profile, x1, y1))
    law.strip_force(Strip(0.0, 1.0, z0, z1, c, v, v, e, e), line, medium, f)
    if line.cap and depth(profile, P[-1, 0], P[-1, 1]) > 0.0:
        law.cap_force(c, v, line, medium, f)
    xi = middle - i
    for term in range(TERMS):
        for xy in range(2):
            total = f[term, 0, xy] + f[term, 1, xy]
            f[term, 0, xy] = (1.0 - xi) * total
            f[term, 1, xy] = xi * total
    collect(f, i, P, F, totals)
