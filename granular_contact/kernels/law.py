"""What a law of resistance provides, and how kernels find it: by the type of the law's record.

A law is a record type with its coefficients and compiled functions that stand in for the stubs below where a medium
record `m` of that type comes in. Laws for strips provide strip_force, strip_tangent and drag_anchor (and the two for
end caps, if they know them) and are joined to a run by `strips.line_law`; laws for balls provide ball_force,
ball_tangent and drag_anchor, and are joined by `balls.ball_law`. A law has up to TERMS terms, told apart in results.

The choice is made when a caller is compiled, from types alone, so one set of kernels serves every law and every kind of
body, at no cost per call and with numba's cache on disk.
"""

from __future__ import annotations

import inspect

import numpy as np
from numba import from_dtype
from numba.extending import overload

TERMS = 3

# A run: width (m) is the diameter of a round section or a ball, or the width of a plate normal to the plane. side: 0
# where both faces can lead, else the outward normal of an outline lies to the left (+1) or right (-1) of its direction.
# drop (m): how far below its stations a run reaches, the radius of a ball; beside (m): how far to their sides in the
# plane, half the width of a round section or a ball; mass (kg): of a ball. layered: the medium lies between the depths
# top and bottom (m) only.
RUN = np.dtype(
    [
        ("width", "f8"),
        ("side", "f8"),
        ("drop", "f8"),
        ("beside", "f8"),
        ("mass", "f8"),
        ("top", "f8"),
        ("bottom", "f8"),
        ("layered", "?"),
        ("cap", "?"),
        ("resultant", "?"),
    ]
)


def strip_force(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, f):
    """Add the end forces of a strip to f[term, end, xy] (N).

    z0, z1 end depths (m, positive below); (cx, cy) = p_1 - p_0 (m); end velocities (m/s); (ex, ey) stretch of the
    bristle at mid-strip (m), see `friction`; run record; m medium record.
    """
    raise NotImplementedError


def strip_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, kp, kz, kv):
    """Add the derivatives of a strip's end forces (f_0x, f_0y, f_1x, f_1y), summed over the terms.

    kp (4, 4) N/m by the end positions with the depths held, kz (4, 2) N/m by the depths z0, z1, kv (4, 4) N s/m by the
    end velocities; other arguments as in `strip_force`.
    """
    raise NotImplementedError


def cap_force(cx, cy, vx, vy, run, m, f):
    """Add the force on a free end face at end 1 of a strip, which moves with (vx, vy), to f[term, 1, xy] (N)."""
    raise NotImplementedError


def cap_tangent(cx, cy, vx, vy, run, m, kp, kv):
    """Add the derivatives of `cap_force` to kp, kv (4, 4)."""
    raise NotImplementedError


def ball_force(z, vx, vy, ex, ey, run, m, f):
    """Add the force at the centre of a ball to f[term, xy] (N).

    z depth of its lowest point (m, positive); velocity (m/s) and stretch of the bristle (m) at its centre; run.width is
    its diameter.
    """
    raise NotImplementedError


def ball_tangent(z, vx, vy, ex, ey, run, m, kp, kz, kv):
    """Add the derivatives of `ball_force`: kp (2, 2) by the position with the depth held, kz (2,), kv (2, 2)."""
    raise NotImplementedError


def drag_anchor(px, py, ax, ay, m):
    """Where an anchor at (ax, ay) m is after an accepted step that ended with its strip or ball at (px, py) m."""
    raise NotImplementedError


def forces(P, V, anchors, run, profile, m, F, totals):
    """Fill F (n, 2) N with the forces at the stations of a run and add to totals (TERMS, 3).

    P (n, 2) m, V (n, 2) m/s: positions and velocities of the stations, world frame, y up; anchors (n - 1, 2) m; profile
    as in `surface`. totals: of each term the resultant F_x, F_y and the moment about the world origin (N m,
    counter-clockwise).
    """
    raise NotImplementedError


def tangents(P, V, anchors, run, profile, m, KP, KV):
    """Fill KP, KV (n - 1, 4, 4): derivatives of the forces (f_0x, f_0y, f_1x, f_1y) of each pair of neighbouring
    stations by the positions (N/m) and velocities (N s/m) of the pair.
    """
    raise NotImplementedError


_KNOWN: dict[np.dtype, str] = {}  # record types of laws, with the function that came first


def _fields(dtype):
    """Names of the fields of a record type, with their types and places."""
    return [(name, dtype.fields[name]) for name in dtype.names]


def _keep_apart(dtype: np.dtype, name: str) -> None:
    """Refuse a record type that numba would take for another: one that begins with all the fields of the other."""
    for other, known in _KNOWN.items():
        one, two = _fields(dtype), _fields(other)
        if dtype != other and all(a == b for a, b in zip(one, two, strict=False)):
            names, others = ([field for field, _ in each] for each in (one, two))
            raise TypeError(
                f"the records of {name}, {names}, and of {known}, {others}, begin alike to the "
                "end of the shorter one, so kernels would take one for the other: let them begin with different fields"
            )
    _KNOWN.setdefault(dtype, name)


def provide(stub, argument: str, dtype: np.dtype):
    """Decorate a compiled function to be what `stub` means where its `argument` has the record type `dtype`.

    Raises
    ------
    TypeError
        One record type begins with all the fields of another.
    """
    wanted = from_dtype(dtype)

    def decorate(implementation):
        _keep_apart(dtype, f"{implementation.py_func.__module__}.{implementation.py_func.__name__}")
        names = tuple(inspect.signature(stub).parameters)

        def choose(*arguments):
            given = arguments[names.index(argument)]
            return implementation.py_func if getattr(given, "dtype", given) == wanted else None

        choose.__signature__ = inspect.signature(stub)  # type: ignore[attr-defined]
        overload(stub)(choose)
        return implementation

    return decorate
