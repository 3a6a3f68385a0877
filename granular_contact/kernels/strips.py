"""From the motion of a line of stations to the granular forces on it, in two forms.

A run is a line of stations with positions P (n, 2) in m and velocities V (n, 2) in m/s, world frame, y up; between two
neighbours lies a strip of a cylinder. `distributed` integrates a law along every strip. `resultant` is the source
paper's form: the immersed part is one straight piece that moves with the velocity of its middle, and the whole force
acts there.

Both forms fill F (n, 2), the forces at the stations
(N), and add to totals (3, 3): for each term of the law its resultant F_x, F_y and its moment about the world origin
(N m, counter-clockwise).
"""

from __future__ import annotations

import inspect

import numpy as np
from numba import from_dtype, njit
from numba.extending import overload

from granular_contact.kernels.immersion import immersed_interval


def strip_force(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, d, m, f):
    """Add the end forces of a strip to f[term, end, xy] (N); each law overloads it for the type of its record m.

    z0, z1 end depths (m, positive below); (cx, cy) = p_1 - p_0 (m); end velocities (m/s); (ex, ey) stretch of the
    bristle at mid-strip (m), see `friction`; d diameter (m).
    """
    raise NotImplementedError


def strip_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, d, m, kp, kv):
    """Add to kp, kv (4, 4) the derivatives of end forces (f_0x, f_0y, f_1x, f_1y) by end positions and velocities."""
    raise NotImplementedError


def cap_force(cx, cy, vx, vy, d, m, f):
    """Add the force on a free end face at end 1 of a strip, which moves with (vx, vy), to f[term, 1, xy] (N)."""
    raise NotImplementedError


def cap_tangent(cx, cy, vx, vy, d, m, kp, kv):
    """Add the derivatives of `cap_force` to kp, kv (4, 4)."""
    raise NotImplementedError


def provide(stub, argument: str, dtype: np.dtype):
    """Decorate a compiled function to be what `stub` means where its `argument` has the record type `dtype`.

    The choice is made when a caller is compiled, from types alone, so one set of kernels serves every law and every
    kind of body, at no cost per call and with numba's cache on disk.
    """
    wanted = from_dtype(dtype)

    def decorate(implementation):
        names = tuple(inspect.signature(stub).parameters)

        def choose(*arguments):
            given = arguments[names.index(argument)]
            return implementation.py_func if getattr(given, "dtype", given) == wanted else None

        choose.__signature__ = inspect.signature(stub)  # type: ignore[attr-defined]
        overload(stub)(choose)
        return implementation

    return decorate


@njit(cache=True)
def collect(f, i, P, F, totals):
    """Add the end forces f[term, end, xy] of strip i to the station forces F and to the totals."""
    for end in range(2):
        x, y = P[i + end, 0], P[i + end, 1]
        for term in range(3):
            fx, fy = f[term, end, 0], f[term, end, 1]
            F[i + end, 0] += fx
            F[i + end, 1] += fy
            totals[term, 0] += fx
            totals[term, 1] += fy
            totals[term, 2] += x * fy - y * fx


@njit(cache=True)
def distributed_forces(P, V, anchors, run, m, F, totals):
    """Integrate the law strip by strip: fill F, add to totals."""
    diameter, surface = run.diameter, run.surface
    f = np.zeros((3, 2, 2))
    F[:] = 0.0
    last = P.shape[0] - 1
    for i in range(last):
        z0, z1 = surface - P[i, 1], surface - P[i + 1, 1]
        if z0 <= 0.0 and z1 <= 0.0:
            continue
        cx, cy = P[i + 1, 0] - P[i, 0], P[i + 1, 1] - P[i, 1]
        ex, ey = P[i, 0] + 0.5 * cx - anchors[i, 0], P[i, 1] + 0.5 * cy - anchors[i, 1]
        f[:] = 0.0
        strip_force(z0, z1, cx, cy, V[i, 0], V[i, 1], V[i + 1, 0], V[i + 1, 1], ex, ey, diameter, m, f)
        collect(f, i, P, F, totals)
    if run.cap and P[last, 1] < surface:
        cx, cy = P[last, 0] - P[last - 1, 0], P[last, 1] - P[last - 1, 1]
        f[:] = 0.0
        cap_force(cx, cy, V[last, 0], V[last, 1], diameter, m, f)
        collect(f, last - 1, P, F, totals)


@njit(cache=True)
def distributed_tangents(P, V, anchors, run, m, KP, KV):
    """Fill KP, KV (n - 1, 4, 4): derivatives of a strip's end forces by its end positions and velocities."""
    diameter, surface = run.diameter, run.surface
    KP[:] = 0.0
    KV[:] = 0.0
    last = P.shape[0] - 1
    for i in range(last):
        z0, z1 = surface - P[i, 1], surface - P[i + 1, 1]
        if z0 <= 0.0 and z1 <= 0.0:
            continue
        cx, cy = P[i + 1, 0] - P[i, 0], P[i + 1, 1] - P[i, 1]
        ex, ey = P[i, 0] + 0.5 * cx - anchors[i, 0], P[i, 1] + 0.5 * cy - anchors[i, 1]
        strip_tangent(z0, z1, cx, cy, V[i, 0], V[i, 1], V[i + 1, 0], V[i + 1, 1], ex, ey, diameter, m, KP[i], KV[i])
    if run.cap and P[last, 1] < surface:
        cx, cy = P[last, 0] - P[last - 1, 0], P[last, 1] - P[last - 1, 1]
        cap_tangent(cx, cy, V[last, 0], V[last, 1], diameter, m, KP[last - 1], KV[last - 1])


@njit(cache=True)
def immersed_segment(P, surface):
    """First and last immersed point of a run as positions i + xi along its stations; (0, 0) when none is immersed."""
    first, last = 0.0, 0.0
    found = False
    for i in range(P.shape[0] - 1):
        a, b = immersed_interval(surface - P[i, 1], surface - P[i + 1, 1])
        if b > a:
            if not found:
                first = i + a
                found = True
            last = i + b
    return first, last


@njit(cache=True)
def at(A, position):
    """Linear interpolation of the rows of A (n, 2) at position i + xi along the stations."""
    i = min(int(position), A.shape[0] - 2)
    xi = position - i
    return (1.0 - xi) * A[i, 0] + xi * A[i + 1, 0], (1.0 - xi) * A[i, 1] + xi * A[i + 1, 1]


@njit(cache=True)
def resultant_forces(P, V, anchors, run, m, F, totals):
    """Law for the immersed part as one straight piece; the strip that holds its middle lends it the bristle."""
    diameter, surface = run.diameter, run.surface
    F[:] = 0.0
    first, last = immersed_segment(P, surface)
    if last == first:
        return
    middle = 0.5 * (first + last)
    i = min(int(middle), P.shape[0] - 2)
    x0, y0 = at(P, first)
    x1, y1 = at(P, last)
    vx, vy = at(V, middle)
    ex = 0.5 * (P[i, 0] + P[i + 1, 0]) - anchors[i, 0]
    ey = 0.5 * (P[i, 1] + P[i + 1, 1]) - anchors[i, 1]
    f = np.zeros((3, 2, 2))
    # The ends of the segment lie on the surface only up to round-off; the depth there is zero by definition.
    z0, z1 = max(0.0, surface - y0), max(0.0, surface - y1)
    strip_force(z0, z1, x1 - x0, y1 - y0, vx, vy, vx, vy, ex, ey, diameter, m, f)
    if run.cap and P[P.shape[0] - 1, 1] < surface:
        cap_force(x1 - x0, y1 - y0, vx, vy, diameter, m, f)
    xi = middle - i
    for term in range(3):
        for xy in range(2):
            total = f[term, 0, xy] + f[term, 1, xy]
            f[term, 0, xy] = (1.0 - xi) * total
            f[term, 1, xy] = xi * total
    collect(f, i, P, F, totals)
