"""Elastic and damping moment between two rigid elements of a flexible link, by their relative rotation.

With the rotation vector t from the reference configuration, the angle s = |t| and the relative angular velocity w, all
in the frame of the joint,

    m = -T^-T (K t + D t'),    t' = T^-1 w,    T^-1 = 1 - t^ / 2 + c t^ t^,    c = (1 - (s/2) cot(s/2)) / s^2

with the inverse T^-1 of the left Jacobian of SO(3) (`space_rotations`). So m . w = -d/dt (t . K t) / 2 - t' . D t'.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.vectors import cross, dot, plus, times

SMALL = 1e-2  # rad, angle below which c is computed by its series


@part
def moment(t, w, joint):
    """Moment m (3,) N m on the outer element; joint: record with the diagonals bends of K and damps of D, (3,) each."""
    square, K, D = dot(t, t), joint.bends, joint.damps
    s = math.sqrt(square)
    c = 1.0 / 12.0 + square / 720.0 if s < SMALL else (1.0 - 0.5 * s / math.tan(0.5 * s)) / square
    rate = mapped(t, w, -0.5, c)
    f = K[0] * t[0] + D[0] * rate[0], K[1] * t[1] + D[1] * rate[1], K[2] * t[2] + D[2] * rate[2]
    return times(-1.0, mapped(t, f, 0.5, c))


@part
def mapped(t, a, half, c):
    """Sum a + half t x a + c t x (t x a): with half = -0.5 T^-1 a, with 0.5 T^-T a."""
    x = cross(t, a)
    return plus(a, plus(times(half, x), times(c, cross(t, x))))
