"""Static resistance of a round bar along its axis, by components; terms of several laws.

With depth z, unit tangent t, and the regularised signs sigma of `friction`, per unit of arc length:

    dF_x/ds = -2 k z |t_y| sigma_x                       over a bar that pierces the surface: -k z_T^2 sigma_x
    dF_y/ds = -(lam + 1) k (z/l)^lam sigma_y             likewise: -k (z_T/l)^lam L_i sigma_y

A strip has c = p_1 - p_0, so |t_y| ds = |c_y| dxi and ds = |c| dxi. Along a strip s is linear, and sigma(s) is s where
|s| < 1, else the sign of s; all integrals are closed forms.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.friction import SMOOTH, direction, drag_component, drive
from granular_contact.sand.kernels.immersion import THREE_POINTS, moments, part_integrals, sign_change
from granular_contact.sand.kernels.vectors import norm


@part
def mobilised_integrals(a, b, z0, z1, lam, s0, s1, m):
    """Integrals of sigma z^lam N_e from a to b (m^lam), as in `immersion`; s is s0 and s1 at the ends of the strip.

    s has one sign between a and b.
    """
    if a == b:
        return 0.0, 0.0
    if m.friction == SMOOTH:
        return smooth_integrals(a, b, z0, z1, lam, s0, s1, m)
    sa, sb = s0 + a * (s1 - s0), s0 + b * (s1 - s0)
    sign = math.copysign(1.0, sa + sb)
    first, last = sign * sa >= 1.0, sign * sb >= 1.0
    if not first and not last:
        return linear_integrals(a, b, z0, z1, lam, sa, sb)
    if first and last:
        j0, j1 = part_integrals(a, b, z0, z1, lam)
        return sign * j0, sign * j1
    c = min(b, max(a, (sign - s0) / (s1 - s0)))
    if first:
        j0, j1 = part_integrals(a, c, z0, z1, lam)
        i0, i1 = linear_integrals(c, b, z0, z1, lam, sign, sb)
    else:
        j0, j1 = part_integrals(c, b, z0, z1, lam)
        i0, i1 = linear_integrals(a, c, z0, z1, lam, sa, sign)
    return sign * j0 + i0, sign * j1 + i1


@part
def linear_integrals(a, b, z0, z1, lam, sa, sb):
    """`mobilised_integrals` where sigma = s, with sa and sb at a and b."""
    dz = z1 - z0
    za, zb = max(0.0, z0 + a * dz), max(0.0, z0 + b * dz)
    j0, j1, k11 = moments(za, zb, lam)
    k01 = j1 - k11
    i0, i1 = sa * (j0 - k01) + sb * k01, sa * k01 + sb * k11
    return (b - a) * ((1.0 - a) * i0 + (1.0 - b) * i1), (b - a) * (a * i0 + b * i1)


@part
def smooth_integrals(a, b, z0, z1, lam, s0, s1, m):
    """`mobilised_integrals` of a smooth sigma, by three Gauss points."""
    j0, j1 = 0.0, 0.0
    for at, weight in THREE_POINTS:
        xi = a + (b - a) * at
        k = (b - a) * weight * max(0.0, z0 + xi * (z1 - z0)) ** lam * direction(s0 + xi * (s1 - s0), m)
        j0 += (1.0 - xi) * k
        j1 += xi * k
    return j0, j1


@part
def horizontal_force(strip, k, m, f):
    """Add the horizontal term to f[end, xy] (N); k in N/m^2, strip as in `law.strip_force`."""
    s0, s1 = drive(strip.e0[0], strip.v0[0], m), drive(strip.e1[0], strip.v1[0], m)
    k *= 2.0 * abs(strip.c[1])
    c = sign_change(strip.a, strip.b, s0, s1)
    for start, end in ((strip.a, c), (c, strip.b)):
        j0, j1 = mobilised_integrals(start, end, strip.z0, strip.z1, 1.0, s0, s1, m)
        f[0, 0] -= k * j0
        f[1, 0] -= k * j1


@part
def vertical_force(strip, k, eta, lam, scale, m, f):
    """Add the vertical term to f[end, xy] (N); strip as in `law.strip_force`.

    k (N/m) times eta is the k of the equation; eta and lam: pairs, for plunging and withdrawing; scale: length l (m).
    """
    add_vertical_force(strip, 1, k, eta, lam, scale, m, f)


@part
def add_vertical_force(strip, up, k, eta, lam, scale, m, f):
    """`vertical_force` in the plane and in space; up: index of the upward component of vectors."""
    s0, s1 = drive(strip.e0[up], strip.v0[up], m), drive(strip.e1[up], strip.v1[up], m)
    k *= norm(strip.c)
    c = sign_change(strip.a, strip.b, s0, s1)
    for start, end in ((strip.a, c), (c, strip.b)):
        phase = 0 if s0 + 0.5 * (start + end) * (s1 - s0) < 0.0 else 1
        if eta[phase] == 0.0:
            continue
        j0, j1 = mobilised_integrals(start, end, strip.z0 / scale, strip.z1 / scale, lam[phase], s0, s1, m)
        f[0, up] -= k * eta[phase] * (lam[phase] + 1.0) * j0
        f[1, up] -= k * eta[phase] * (lam[phase] + 1.0) * j1


@part
def component_return(p, anchor, m):
    """Anchor after an accepted step that ended at p (2,) m: each component within u_y of the station."""
    return drag_component(p[0], anchor[0], m), drag_component(p[1], anchor[1], m)
