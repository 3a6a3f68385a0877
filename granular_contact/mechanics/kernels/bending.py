"""The moment between two elements of a link that bends, by how one is turned against the other.

With the rotation vector t from home, by the angle s, and the relative angular velocity w, in the frame of the joint,

    m = -T^-T (K t + D t'),    t' = T^-1 w,    T^-1 = 1 - t^ / 2 + c t^ t^,    c = (1 - (s/2) cot(s/2)) / s^2

of the exponential map, so that m . w = -d/dt (t . K t) / 2 - t' . D t'.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.vectors import cross, dot, plus, times

SMALL = 1e-2  # rad, below which c is taken from its series


@part
def moment(t, w, of):
    """Moment m (3,) N m on the outer element; of: record with bends and damps (3,), the diagonals of K and D."""
    square, K, D = dot(t, t), of.bends, of.damps
    s = math.sqrt(square)
    c = 1.0 / 12.0 + square / 720.0 if s < SMALL else (1.0 - 0.5 * s / math.tan(0.5 * s)) / square
    v = mapped(t, w, -0.5, c)
    f = K[0] * t[0] + D[0] * v[0], K[1] * t[1] + D[1] * v[1], K[2] * t[2] + D[2] * v[2]
    return times(-1.0, mapped(t, f, 0.5, c))


@part
def mapped(t, a, half, c):
    """A + half t x a + c t x (t x a)."""
    x = cross(t, a)
    return plus(a, plus(times(half, x), times(c, cross(t, x))))
