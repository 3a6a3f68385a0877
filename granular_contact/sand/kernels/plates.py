"""Laws of a surface element: a stress that grows with depth and depends on the element's orientation and motion.

A strip is a plate of width b normal to the plane. With its unit tangent t, its direction of motion u and the depth z, a
law gives the stress z S(t, u) (Pa), S in N/m^3. The direction is regularised as in `planar_friction` (vector q, share
s), and varies along the strip:

    f_e = b |c| int s g z S(t, u) N_e dxi.

The integral is split where q . n changes its sign along the strip; on either side two Gauss points are exact for depth
and stress linear in xi. S contains both faces of a plate, so S(-t, u) = S(t, u). A round bar counts as a plate of width
d [ours].

On a one-sided outline with the outward normal n only the part with n . v > 0 is loaded. S does not vanish where n . v
does, so an outline that slides along one of its flat sides would be loaded there or not by round-off: the stress is
faded in over the first EDGE of n . u, g = clip(n . u / EDGE, 0, 1) [ours], too narrow to change the load on bodies that
turn (0.1 % of the force on a turning disc). On a body at rest, with bristles below their yield, EDGE would mean a
hundredth of a micrometre, a spring so stiff that Newton's method cycles. So an element is loaded as a whole once n . q
reaches PRESSED times the yield displacement [ours].

A law whose stress is another function of the depth gives a `traction`, which is integrated by three Gauss points: for a
stress z^1.3 from the surface down the error is 0.05 %, in the one strip that pierces the surface.

A strip of a curved line turns by the angle `turn` of the line: its tangent and its depth are those of the arc.
"""

from __future__ import annotations

import math

from granular_contact.jit.chosen import chosen_by
from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.immersion import GAUSS_HIGH, GAUSS_LOW, THREE_POINTS, sign_change
from granular_contact.sand.kernels.planar_friction import drive, mobilised
from granular_contact.sand.kernels.vectors import norm

STATIC, SHEAR = 0, 1
SMALL = 0.2  # rad, up to which the series of sine and cosine below are exact to round-off
EDGE = 1e-3  # sine of the angle between an element and its motion up to which the stress is faded in: 0.06 degrees
PRESSED = 0.1  # of the yield displacement: least n . q at which an element is loaded as a whole


@chosen_by("m")
def stress(t, u, m):
    """Stress per depth (S_x, S_y), N/m^3, on an element along t that moves in the direction u, unit vectors (2,)."""


@chosen_by("m")
def traction(z, t, u, width, side, j, m):
    """Stresses (p_x, p_y) and (s_x, s_y) Pa of the first and of the second term of a law, at a depth z > 0 (m).

    On an element along t that moves in the direction u, unit vectors (2,); width (m), side: see `law.LINE`; j (m):
    shear displacement, see `path_length`.
    """


@part
def leading(t, q, side, m):
    """Factor g in [0, 1] of an element along t of an outline, by q; 1 for a thin plate (side 0)."""
    if side == 0:
        return 1.0
    across = side * (t[0] * q[1] - t[1] * q[0])
    if across <= 0.0:
        return 0.0
    edge = max(EDGE * norm(q), m.pressed)
    return across / edge if across < edge else 1.0


@part
def cosine_and_sine(x):
    """Cosine and sine of an angle x (rad), up to SMALL by series, which takes a third of the library's time."""
    if abs(x) > SMALL:
        return math.cos(x), math.sin(x)
    w = x * x
    c = 1.0 + w * (-1.0 / 2.0 + w * (1.0 / 24.0 + w * (-1.0 / 720.0 + w * (1.0 / 40320.0))))
    s = 1.0 + w * (-1.0 / 6.0 + w * (1.0 / 120.0 + w * (-1.0 / 5040.0 + w * (1.0 / 362880.0))))
    return c, x * s


@part
def tangent_at(t, turn, xi):
    """Unit tangent at xi of a strip with the chord t that turns by `turn` (rad) from end to end."""
    if turn == 0.0:
        return t
    c, s = cosine_and_sine((xi - 0.5) * turn)
    return c * t[0] - s * t[1], s * t[0] + c * t[1]


@part(inline=True)
def turning_point(strip, t, turn, m):
    """Vectors q at both ends of a strip with the chord t, and the position at which q . n changes its sign."""
    q0, q1 = drive(strip.e0, strip.v0, m), drive(strip.e1, strip.v1, m)
    t0, t1 = tangent_at(t, turn, 0.0), tangent_at(t, turn, 1.0)
    return q0, q1, sign_change(strip.a, strip.b, t0[0] * q0[1] - t0[1] * q0[0], t1[0] * q1[1] - t1[1] * q1[0])


@part(inline=True)
def element(strip, xi, chord, bulge, q0, q1, line, m):
    """Depth z (m), tangent t, q, direction u and share g s of the element at xi of a strip.

    bulge (m): the arc is bulge xi (1 - xi) deeper than its chord.
    """
    q = (1.0 - xi) * q0[0] + xi * q1[0], (1.0 - xi) * q0[1] + xi * q1[1]
    z, t = strip.z0 + xi * (strip.z1 - strip.z0) + bulge * xi * (1.0 - xi), tangent_at(chord, line.turn, xi)
    g = leading(t, q, line.side, m)
    if g == 0.0:
        return z, t, q, (0.0, 0.0), 0.0
    u, share = mobilised(q, m)
    return z, t, q, u, g * share


@part
def static_force(strip, line, m, f):
    """Add the static term to f[STATIC]; arguments as in `law.strip_force`."""
    length = norm(strip.c)
    if length == 0.0:  # has no surface
        return
    chord = strip.c[0] / length, strip.c[1] / length
    q0, q1, c = turning_point(strip, chord, line.turn, m)
    bulge = 0.5 * line.turn * length * chord[0]
    for start, end in ((strip.a, c), (c, strip.b)):
        if start == end:
            continue
        for gauss in (GAUSS_LOW, GAUSS_HIGH):
            xi = start + (end - start) * gauss
            z, t, _, u, share = element(strip, xi, chord, bulge, q0, q1, line, m)
            if share == 0.0 or z <= 0.0:
                continue
            sx, sy = stress(t, u, m)
            k = 0.5 * (end - start) * line.width * length * share * z
            f[STATIC, 0, 0] += (1.0 - xi) * k * sx
            f[STATIC, 0, 1] += (1.0 - xi) * k * sy
            f[STATIC, 1, 0] += xi * k * sx
            f[STATIC, 1, 1] += xi * k * sy


@part
def traction_force(strip, line, m, f):
    """Add the terms of a law with a `traction` to f[STATIC] and f[SHEAR]; arguments as in `law.strip_force`."""
    length = norm(strip.c)
    if length == 0.0:
        return
    chord = strip.c[0] / length, strip.c[1] / length
    q0, q1, c = turning_point(strip, chord, line.turn, m)
    bulge = 0.5 * line.turn * length * chord[0]
    for start, end in ((strip.a, c), (c, strip.b)):
        if start == end:
            continue
        for at, weight in THREE_POINTS:
            xi = start + (end - start) * at
            z, t, q, u, share = element(strip, xi, chord, bulge, q0, q1, line, m)
            if share == 0.0 or z <= 0.0:
                continue
            j0, j1 = (line.ahead0, line.ahead1) if t[0] * q[0] + t[1] * q[1] > 0.0 else (line.back0, line.back1)
            j = (1.0 - xi) * j0 + xi * j1
            (px, py), (sx, sy) = traction(z, t, u, line.width, line.side, j, m)
            k = weight * (end - start) * line.width * length * share
            for e, n in ((0, (1.0 - xi) * k), (1, xi * k)):
                f[STATIC, e, 0] += n * px
                f[STATIC, e, 1] += n * py
                f[SHEAR, e, 0] += n * sx
                f[SHEAR, e, 1] += n * sy
