"""Rotations in space for compiled code: quaternions, and rotation vectors as a chart of them. Vectors are tuples.

A rotation vector u is the rotation exp(u) about u by its length. With the rate u' it turns at the angular velocity
J(u) u' (the left Jacobian of SO(3), see Sola et al. 2018),

    J u' = u' + a u x u' + b u x (u x u'),    a = (1 - cos |u|) / |u|^2,    b = (|u| - sin |u|) / |u|^3,

both in the frame that exp(u) turns from. J is regular below a whole turn; near 0 its coefficients are taken from series
in |u|^2, whose first term left out is below 2e-15.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.vectors import cross, dot, plus, times

UNTURNED = (1.0, 0.0, 0.0, 0.0)
ALONG_WORLD = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
SERIES = 0.1  # rad^2: squares of the angle below which coefficients are taken from series


@part
def quaternion(array, i, first):
    """Four numbers of row i, from one on."""
    return array[i, first], array[i, first + 1], array[i, first + 2], array[i, first + 3]


@part
def four(q):
    """A quaternion of a record."""
    return q[0], q[1], q[2], q[3]


@part
def product(p, q):
    """Quaternion of the rotation q and then p."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


@part
def matrix_of(q):
    """Matrix (9,), row by row, of a quaternion (4,)."""
    a, b, c, d = q[0], q[1], q[2], q[3]
    return (
        a * a + b * b - c * c - d * d, 2.0 * (b * c - a * d), 2.0 * (b * d + a * c),
        2.0 * (b * c + a * d), a * a - b * b + c * c - d * d, 2.0 * (c * d - a * b),
        2.0 * (b * d - a * c), 2.0 * (c * d + a * b), a * a - b * b - c * c + d * d,
    )  # fmt: skip


@part
def rates_of(q, w):
    """Rates (4,) of a quaternion whose frame turns at the angular velocity w, as seen from outside."""
    x, y, z = plus(times(q[0], w), cross(w, (q[1], q[2], q[3])))
    return -0.5 * (w[0] * q[1] + w[1] * q[2] + w[2] * q[3]), 0.5 * x, 0.5 * y, 0.5 * z


@part
def spin_by(q, f, g):
    """Angular velocity (3,) of a frame whose quaternion q has the rates f and g (3,)."""
    e = q[1], q[2], q[3]
    return times(2.0, plus(plus(times(-f, e), times(q[0], g)), cross(e, g)))


@part
def by_vector(u):
    """Quaternion of exp(u)."""
    square = dot(u, u)
    half = 0.5 * math.sqrt(square)
    share = 0.5 - square / 48.0 if half < 1e-3 else math.sin(half) / (2.0 * half)
    return math.cos(half), share * u[0], share * u[1], share * u[2]


@part
def chart(u):
    """Coefficients a and b of J(u), and what they change by with u . u' in a unit of time."""
    x = dot(u, u)
    if x < SERIES:
        return (
            0.5 - x * (1.0 / 24.0 - x * (1.0 / 720.0 - x * (1.0 / 40320.0 - x * (1.0 / 3628800.0 - x / 479001600.0)))),
            1.0 / 6.0 - x * (1.0 / 120.0 - x * (1.0 / 5040.0 - x * (1.0 / 362880.0 - x / 39916800.0))),
            -1.0 / 12.0 + x * (1.0 / 180.0 - x * (1.0 / 6720.0 - x * (1.0 / 453600.0 - x / 47900160.0))),
            -1.0 / 60.0 + x * (1.0 / 1260.0 - x * (1.0 / 60480.0 - x * (1.0 / 4989600.0 - x / 622702080.0))),
        )
    angle = math.sqrt(x)
    s, c = math.sin(angle), math.cos(angle)
    return (
        (1.0 - c) / x,
        (angle - s) / (x * angle),
        (angle * s - 2.0 * (1.0 - c)) / (x * x),
        (3.0 * s - angle * (2.0 + c)) / (x * x * angle),
    )


@part
def spin_of(u, rate, of):
    """J(u) times a rate; of: `chart`."""
    v = cross(u, rate)
    return plus(rate, plus(times(of[0], v), times(of[1], cross(u, v))))


@part
def drift_of(u, rate, of):
    """What the rate of J(u) does to it, J' u': the angular acceleration without u''; of: `chart`."""
    v, along = cross(u, rate), dot(u, rate)
    more = plus(times(of[2] * along, v), times(of[3] * along, cross(u, v)))
    return plus(more, times(of[1], cross(rate, v)))
