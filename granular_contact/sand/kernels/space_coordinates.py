"""Rotation and angular velocity of a body in space from its coordinates.

A body has seven coordinates, its position and Euler parameters, or six, its position and Tait-Bryan angles with
R = R_x R_y R_z, or position and slope of a cable. Its angular velocity is w = G q', with the rates q' of its
coordinates after the position, so a moment M gives the generalised forces G^T M.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear


@part
def by_parameters(q, R, G):
    """Fill R (3, 3) and G (3, 4) from coordinates (7,) with Euler parameters."""
    a, b, c, d = q[3], q[4], q[5], q[6]
    R[0, 0], R[1, 1], R[2, 2] = (
        a * a + b * b - c * c - d * d,
        a * a - b * b + c * c - d * d,
        a * a - b * b - c * c + d * d,
    )
    _by_axis(0, 1, 2, a, b, c, d, R, G)
    _by_axis(1, 2, 0, a, c, d, b, R, G)
    _by_axis(2, 0, 1, a, d, b, c, R, G)


@part
def _by_axis(i, j, k, a, x, y, z, R, G):
    """Row i of R without its diagonal, and row i of G; x, y, z: Euler parameters of the axes i, j, k."""
    R[i, j], R[i, k] = 2.0 * (x * y - a * z), 2.0 * (x * z + a * y)
    G[i, 0], G[i, 1 + i], G[i, 1 + j], G[i, 1 + k] = -2.0 * x, 2.0 * a, -2.0 * z, 2.0 * y


@part
def by_six(q, body, R, G):
    """As `by_parameters`, for bodies with six coordinates; compiled only for beds with such bodies."""
    if body.places > body.size:
        by_slope(q, body, R, G)
    else:
        by_angles(q, R, G)


@part
def by_slope(q, body, R, G):
    """As `by_parameters`, from position and slope y, (6,), with w = y x y' / |y|^2: no turn about the axis of a cable.

    R is the smallest rotation from the direction of the slope in the reference configuration, where R is the identity.
    """
    x, y, z = q[3], q[4], q[5]
    square = x * x + y * y + z * z
    long = math.sqrt(square)
    a, b, c = body.axis[0], body.axis[1], body.axis[2]
    u, v, w = (b * z - c * y) / long, (c * x - a * z) / long, (a * y - b * x) / long
    cosine = (a * x + b * y + c * z) / long
    k = 1.0 / max(1.0 + cosine, 1e-12)
    R[0, 0], R[1, 1], R[2, 2] = cosine + k * u * u, cosine + k * v * v, cosine + k * w * w
    R[0, 1], R[0, 2], R[1, 2] = k * u * v - w, k * u * w + v, k * v * w - u
    R[1, 0], R[2, 0], R[2, 1] = k * u * v + w, k * u * w - v, k * v * w + u
    clear(G)
    G[0, 1], G[0, 2], G[1, 2] = -z / square, y / square, -x / square
    G[1, 0], G[2, 0], G[2, 1] = z / square, -y / square, x / square


@part
def by_angles(q, R, G):
    """As `by_parameters`, from coordinates (6,) with Tait-Bryan angles."""
    sa, ca, sb, cb = math.sin(q[3]), math.cos(q[3]), math.sin(q[4]), math.cos(q[4])
    sc, cc = math.sin(q[5]), math.cos(q[5])
    R[0, 0], R[0, 1], R[0, 2] = cb * cc, -cb * sc, sb
    R[1, 0], R[1, 1], R[1, 2] = ca * sc + sa * sb * cc, ca * cc - sa * sb * sc, -sa * cb
    R[2, 0], R[2, 1], R[2, 2] = sa * sc - ca * sb * cc, sa * cc + ca * sb * sc, ca * cb
    clear(G)
    G[0, 0], G[0, 2] = 1.0, sb
    G[1, 1], G[1, 2] = ca, -sa * cb
    G[2, 1], G[2, 2] = sa, ca * cb
