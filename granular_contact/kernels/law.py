"""What a law of resistance provides, and how kernels find it: by the type of the law's record.

A law is a record type with its coefficients and functions that stand in for the stubs below where a medium record `m`
of that type comes in; `joining` makes both of the class of a law. Laws for strips provide strip_force and drag_anchor
(and cap_force, if they know it) and are joined to a run by `strips.line_law`; laws for balls provide ball_force and
drag_anchor, and are joined by `balls.ball_law`. A law has up to TERMS terms, told apart in results. Tangents are
differences of these forces, see `lines.tangent`.

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
# turn (rad): angle by which the line turns along each of its strips, counter-clockwise: 0 where they are straight, else
# they are chords of one circle. drop (m): how far below its stations a run reaches, the radius of a ball; beside (m):
# how far to their sides in the plane, half the width of a round section or a ball; mass (kg): of a ball. layered: the
# medium lies between the depths top and bottom (m) only.
RUN = np.dtype(
    [
        ("width", "f8"),
        ("side", "f8"),
        ("turn", "f8"),
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


def strip_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y, run, m, f):
    """Add the forces on the part of a strip between xi = a and xi = b, as end forces of the strip, to f[term, end, xy].

    Forces in N. a < b in [0, 1]: the part that lies in the medium, so that no depth there is negative; z0, z1 end
    depths (m, positive below); (cx, cy) = p_1 - p_0 (m); end velocities (m/s); stretch of the bristles at both ends
    (m), see `friction`; run record; m medium record. Depth, velocity and stretch vary linearly along the strip.
    """
    raise NotImplementedError


def cap_force(cx, cy, vx, vy, run, m, f):
    """Add the force on a free end face at end 1 of a strip, which moves with (vx, vy), to f[term, 1, xy] (N)."""
    raise NotImplementedError


def ball_force(z, vx, vy, ex, ey, run, m, f):
    """Add the force at the centre of a ball to f[term, xy] (N).

    z depth of its lowest point (m, positive); velocity (m/s) and stretch of the bristle (m) at its centre; run.width is
    its diameter.
    """
    raise NotImplementedError


def drag_anchor(px, py, ax, ay, m):
    """Where an anchor at (ax, ay) m is after an accepted step that ended with its station at (px, py) m."""
    raise NotImplementedError


def forces(P, V, anchors, run, profile, m, F, totals):
    """Fill F (n, 2) N with the forces at the stations of a run and add to totals (TERMS, 3).

    P (n, 2) m, V (n, 2) m/s: positions and velocities of the stations, world frame, y up; anchors (n, 2) m; profile
    as in `surface`. totals: of each term the resultant F_x, F_y and the moment about the world origin (N m,
    counter-clockwise).
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
    """Decorate a function, plain or compiled, to be what `stub` means where its `argument` has the record type `dtype`.

    Raises
    ------
    TypeError
        One record type begins with all the fields of another.
    """
    wanted = from_dtype(dtype)

    def decorate(implementation):
        function = getattr(implementation, "py_func", implementation)
        _keep_apart(dtype, f"{function.__module__}.{function.__name__}")
        names = tuple(inspect.signature(stub).parameters)

        def choose(*arguments):
            given = arguments[names.index(argument)]
            return function if getattr(given, "dtype", given) == wanted else None

        choose.__signature__ = inspect.signature(stub)  # type: ignore[attr-defined]
        overload(stub)(choose)
        return implementation

    return decorate
