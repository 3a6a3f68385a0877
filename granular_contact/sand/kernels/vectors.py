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
