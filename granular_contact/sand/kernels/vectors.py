"""Vectors as tuples, in compiled functions."""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part


@part
def vector(array, first):
    """Vector (3,) from an array, from entry `first` on."""
    return array[first], array[first + 1], array[first + 2]


@part
def xyz(array):
    """Vector from an array (3,)."""
    return array[0], array[1], array[2]


@part
def at(array, i, first):
    """Vector (3,) from row i of an array, from column `first` on."""
    return array[i, first], array[i, first + 1], array[i, first + 2]


@part
def fill(a, array, first):
    """Write a vector (3,) into an array, from entry `first` on."""
    array[first], array[first + 1], array[first + 2] = a


@part
def put(a, array, i, first):
    """Write a vector (3,) into row i of an array, from column `first` on."""
    array[i, first], array[i, first + 1], array[i, first + 2] = a


@part
def unit(k):
    """Unit vector along axis k."""
    return 1.0 * (k == 0), 1.0 * (k == 1), 1.0 * (k == 2)


@part
def plus(a, b):
    """Sum of two vectors (3,)."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@part
def minus(a, b):
    """Difference of two vectors (3,)."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@part
def times(x, a):
    """A vector (3,), x times as long."""
    return x * a[0], x * a[1], x * a[2]


@part
def norm(a):
    """Length of a vector in the plane or in space, by a plain square root, see `planar_friction`."""
    square = 0.0
    for x in a:
        square += x * x
    return math.sqrt(square)


@part
def dot(a, b):
    """Product of two vectors (3,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@part
def cross(a, b):
    """Vector product (3,)."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@part(inline=True)
def plus_cross(v, w, r):
    """Sum v + w x r (3,), as the velocity of a point at r of a body with velocity v and angular velocity w."""
    x, y, z = cross(w, r)
    return v[0] + x, v[1] + y, v[2] + z


@part(inline=True)
def axes(R):
    """Entries (9,) of a matrix (3, 3), or of the rotation in a pose, row by row: numbers that stay in registers."""
    x, y, z = R[0], R[1], R[2]
    return x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]


@part(inline=True)
def turned(R, a):
    """R a (3,), with R (9,) row by row: from the frame of a body with the axes R to the frame around the body."""
    return (
        R[0] * a[0] + R[1] * a[1] + R[2] * a[2],
        R[3] * a[0] + R[4] * a[1] + R[5] * a[2],
        R[6] * a[0] + R[7] * a[1] + R[8] * a[2],
    )


@part(inline=True)
def turned_back(R, a):
    """R^T a (3,), with R (9,) row by row: from the frame around a body to the frame of the body."""
    return (
        R[0] * a[0] + R[3] * a[1] + R[6] * a[2],
        R[1] * a[0] + R[4] * a[1] + R[7] * a[2],
        R[2] * a[0] + R[5] * a[1] + R[8] * a[2],
    )


@part
def column(R, k):
    """Axis k (3,) of a frame: column k of R (9,), which is row by row."""
    return R[k], R[3 + k], R[6 + k]


@part
def framed(R, P):
    """R P (9,), row by row: axes of a frame P (3, 3) in the frame of a body with the axes R (9,)."""
    a = turned(R, (P[0, 0], P[1, 0], P[2, 0]))
    b = turned(R, (P[0, 1], P[1, 1], P[2, 1]))
    c = turned(R, (P[0, 2], P[1, 2], P[2, 2]))
    return a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]
