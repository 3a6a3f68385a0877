"""Vectors as tuples, in compiled functions."""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part


@part
def norm(a):
    """Length of a vector in the plane or in space: a plain root of the sum of squares, see `planar_friction`."""
    square = 0.0
    for x in a:
        square += x * x
    return math.sqrt(square)


@part
def dot(a, b):
    """A . b of vectors (3,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@part
def cross(a, b):
    """A x b (3,)."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@part(inline=True)
def turned(R, a):
    """R a (3,) of a matrix R, row by row (9,): a vector of the frame of a body, whose axes they are, in that around."""
    return (
        R[0] * a[0] + R[1] * a[1] + R[2] * a[2],
        R[3] * a[0] + R[4] * a[1] + R[5] * a[2],
        R[6] * a[0] + R[7] * a[1] + R[8] * a[2],
    )


@part(inline=True)
def seen(R, a):
    """R^T a (3,): back."""
    return (
        R[0] * a[0] + R[3] * a[1] + R[6] * a[2],
        R[1] * a[0] + R[4] * a[1] + R[7] * a[2],
        R[2] * a[0] + R[5] * a[1] + R[8] * a[2],
    )
