"""Rotations in space for compiled code: unit quaternions, rotation vectors and the left Jacobian of SO(3).

Vectors are tuples. A rotation vector u means the rotation exp(u) about u by the angle |u|. If u has the rate u', the
angular velocity is J(u) u' with the left Jacobian J (Sola et al. 2018),

    J u' = u' + a u x u' + b u x (u x u'),    a = (1 - cos |u|) / |u|^2,    b = (|u| - sin |u|) / |u|^3,

in the frame before the rotation exp(u). J is regular below a whole turn. Near 0 its coefficients are computed by series
in |u|^2; the first neglected term is below 2e-15.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.vectors import cross, dot, plus, times

UNTURNED = (1.0, 0.0, 0.0, 0.0)
ALONG_WORLD = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
SERIES = 0.1  # rad^2: square of the angle below which series are used


@part
def quaternion(array, i, first):
    """Quaternion in row i of an array, which begins at column `first`."""
    return array[i, first], array[i, first + 1], array[i, first + 2], array[i, first + 3]


@part
def as_quaternion(q):
    """Quaternion as a tuple, from a field (4,) of a record."""
    return q[0], q[1], q[2], q[3]


@part
def product(p, q):
    """Quaternion of the rotation q followed by p."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


@part
def matrix_of(q):
    """Rotation matrix (9,), row by row, of a unit quaternion (4,)."""
    a, b, c, d = q[0], q[1], q[2], q[3]
    return (
        a * a + b * b - c * c - d * d, 2.0 * (b * c - a * d), 2.0 * (b * d + a * c),
        2.0 * (b * c + a * d), a * a - b * b + c * c - d * d, 2.0 * (c * d - a * b),
        2.0 * (b * d - a * c), 2.0 * (c * d + a * b), a * a - b * b - c * c + d * d,
    )  # fmt: skip


@part
def rates_of(q, w):
    """Rates (4,) of the quaternion of a frame with angular velocity w (3,), in the frame outside."""
    x, y, z = plus(times(q[0], w), cross(w, (q[1], q[2], q[3])))
    return -0.5 * (w[0] * q[1] + w[1] * q[2] + w[2] * q[3]), 0.5 * x, 0.5 * y, 0.5 * z


@part
def spin_by(q, f, g):
    """Angular velocity (3,) of a frame, from its quaternion q and the rates f of q[0] and g (3,) of q[1:]."""
    e = q[1], q[2], q[3]
    return times(2.0, plus(plus(times(-f, e), times(q[0], g)), cross(e, g)))


@part
def exponential(u):
    """Quaternion of the rotation exp(u), the exponential map."""
    square = dot(u, u)
    half = 0.5 * math.sqrt(square)
    share = 0.5 - square / 48.0 if half < 1e-3 else math.sin(half) / (2.0 * half)
    return math.cos(half), share * u[0], share * u[1], share * u[2]


@part
def jacobian_coefficients(u):
    """Coefficients a and b of J(u), and their rates divided by u . u'."""
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
def jacobian_times(u, rate, coefficients):
    """Product J(u) u'; coefficients: of `jacobian_coefficients`."""
    v = cross(u, rate)
    return plus(rate, plus(times(coefficients[0], v), times(coefficients[1], cross(u, v))))


@part
def jacobian_rate_times(u, rate, coefficients):
    """Product J' u', the angular acceleration without u''; coefficients: of `jacobian_coefficients`."""
    _, b, a_rate, b_rate = coefficients
    v, along = cross(u, rate), dot(u, rate)
    by_coefficients = plus(times(a_rate * along, v), times(b_rate * along, cross(u, v)))
    return plus(by_coefficients, times(b, cross(rate, v)))
