"""Functions of a law of resistance, which kernels call by the addresses in the record of a medium.

A law is a record type with its coefficients, and compiled functions; `joining` makes both from the class of a law. Laws
for strips have strip_force and drag_anchor, and cap_force if they treat end faces; laws for balls have ball_force and
drag_anchor. A law has up to TERMS terms, which results list separately. Tangents are differences of these forces, see
`lines.differences`.

Kernels depend on no law: `medium` is a record LAW with the addresses of the law's functions and a copy of the law's own
record, and the functions here call by these addresses. So kernels are compiled once for all laws, and a law is compiled
without them. The record also has the addresses of functions that only some media or lines need, which are compiled only
if needed, and of functions that several kernels call, which would else be compiled within each of them. A call by
address takes some 10 ns.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import from_dtype, types

from granular_contact.jit.calls import OWN, address_of, caller
from granular_contact.jit.compiled import part
from granular_contact.jit.records import fields, record_dtype
from granular_contact.sand.kernels.kinematics import STATION
from granular_contact.sand.kernels.strip import strip_type

TERMS = 3

# A contact line:
# - width (m): diameter of a round section or a ball, or width of a plate normal to the plane; mass (kg): of a ball.
# - side: 0 if both faces can lead, else the outward normal of an outline lies to the left (+1) or right (-1) of its
#   direction. turn (rad): angle by which the line turns along each of its strips, counter-clockwise: 0 if strips are
#   straight, else they are chords of one circle.
# - drop (m): how far the line reaches below its stations, the radius of a ball; beside (m): how far it reaches to the
#   sides of its stations in the plane, half the width of a round section or a ball.
# - layered: the medium lies between the depths top and bottom (m) only. cap, resultant: see `strips`.
# - ahead0, ahead1, back0, back1 (m): shear displacements of the medium at the ends 0 and 1 of the current strip, for
#   motion along the strip and against it; infinite if they are not counted, see `path_length`.
# - Of a wheel (see `wheels`): radius (m) of its rim; hub_along, hub_left (m): position of its axle from the first
#   station, along the first strip and to its left; behind (s^2/m): factor of (r omega)^2 in the lowering.
# - Of a medium with scatter (see `scatter`): scatter, standard deviation (-), 0 without scatter; grain, its length (m);
#   place (m) on its lattice at which the line begins; seed, a whole number; static: a bit for each term that scatters.
LINE = record_dtype(
    [
        *fields("f8", "width", "side", "turn", "drop", "beside", "mass", "top", "bottom"),
        *fields("f8", "ahead0", "ahead1", "back0", "back1"),
        *fields("f8", "radius", "hub_along", "hub_left", "behind", "scatter", "grain", "place", "seed"),
        ("static", "i8"),
        *fields("?", "layered", "cap", "resultant"),
    ]
)

# Constants of `friction`; pressed (m): n . q from which on an element of a surface is loaded as a whole, see `plates`.
FRICTION = [("friction", "i8"), *fields("f8", "u_y", "tau", "v_eps", "pressed")]

SIZE = 64  # numbers of a law's record, at most

# Addresses of compiled functions, 0 where there is none, and a copy of the law's own record.
FUNCTIONS = (
    *("forces", "strip_force", "cap_force", "ball_force", "drag_anchor"),
    *("line_force", "line_accept", "count_shear", "count_path", "scattered", "lowering"),
    *("spatial_stations", "spatial_scatter"),
)
LAW = record_dtype([*fields("i8", *FUNCTIONS), ("own", "f8", (SIZE,))])

_LINE, _NUMBER = from_dtype(LINE), types.float64
_ROW, _VECTORS, _PAIR, _ENDS = (types.Array(_NUMBER, n, "C") for n in (1, 2, 2, 3))
_VECTOR = types.UniTuple(_NUMBER, 2)
_STATIONS = types.Array(from_dtype(STATION), 1, "C")


class Contact(NamedTuple):
    """A contact line on a body in one medium, with work arrays: argument of `lines`.

    Parameters
    ----------
    geometry : (n,) array
        Stations, records of `kinematics`.
    line : (1,) array
        Record of LINE.
    profile : (k, 2) array
        Corners of the surface, see `surface`.
    medium : (1,) array
        Record of LAW.
    anchors : (n, 2) array
        Anchors (m) of the bristles at the stations, see `friction`; (n, 6) with the columns of `path_length`.
    P, V, F : (n, 2) array
        Work arrays for positions, velocities and forces of the stations; further columns are not used.
    """

    geometry: Any
    line: Any
    profile: Any
    medium: Any
    anchors: Any
    P: Any
    V: Any
    F: Any


_OF_LINE, _OF_LAW = (types.Array(from_dtype(kind), 1, "C") for kind in (LINE, LAW))
_CONTACT = types.NamedTuple((_STATIONS, _OF_LINE, _VECTORS, _OF_LAW, *[_VECTORS] * 4), Contact)
SIGNATURES: dict[str, tuple[tuple[Any, ...], Any]] = {  # arguments, result
    "forces": ((*[_VECTORS] * 3, _LINE, _VECTORS, from_dtype(LAW), _VECTORS, _VECTORS), types.none),
    "strip_force": ((strip_type(2), _LINE, OWN, _ENDS), types.none),
    "cap_force": ((_VECTOR, _VECTOR, _LINE, OWN, _ENDS), types.none),
    "ball_force": ((_NUMBER, _VECTOR, _VECTOR, _LINE, OWN, _PAIR), types.none),
    "drag_anchor": ((_VECTOR, _VECTOR, OWN), _VECTOR),
    "line_force": ((_ROW, _ROW, _CONTACT, _VECTORS, _ROW), types.none),
    "line_accept": (
        (_ROW, _ROW, _CONTACT, _VECTORS, _ROW, _ROW, types.Array(types.int64, 1, "C"), types.boolean, types.boolean),
        _VECTOR,
    ),
    "count_shear": ((_VECTORS, _VECTORS, types.intp, _LINE), types.none),
    "count_path": ((_VECTORS, _VECTORS, types.intp, _NUMBER, _NUMBER, types.boolean), types.none),
    "scattered": ((_ENDS, _VECTORS, _VECTORS, types.intp, _NUMBER, _NUMBER, _LINE), types.none),
    "lowering": ((_VECTORS, _VECTORS, types.intp, _LINE), _NUMBER),
    "spatial_stations": ((_ROW, _ROW, _STATIONS, _VECTORS, _VECTORS), types.none),
    "spatial_scatter": ((_ROW, _STATIONS, _VECTORS, _ROW), types.none),
}


_forces, _strip, _cap, _ball, _anchor, _line, _accept, _shear, _path, _scattered, _lowering, *_of_spatial = (
    caller(name, *SIGNATURES[name], LAW) for name in FUNCTIONS
)
spatial_stations, spatial_scatter = _of_spatial  # (medium, arguments): functions of `spatial`


@part
def forces(P, V, anchors, line, profile, medium, F, totals):
    """Fill F (n, 2) N with the forces at the stations of a contact line and add to totals (TERMS, 3).

    P (n, 2) m, V (n, 2) m/s: positions and velocities of the stations, world frame, y up; anchors (n, 2) m; line and
    medium records; profile as in `surface`. totals: of each term the resultant F_x, F_y and the moment about the world
    origin (N m, counter-clockwise).
    """
    _forces(medium, (P, V, anchors, line, profile, F, totals))


@part
def strip_force(strip, line, medium, f):
    """Add the forces on the immersed part of a `strip.Strip` to f[term, end, xy] (N), as forces at its ends.

    line and medium: records.
    """
    _strip(medium, (strip, line, f))


@part
def cap_force(c, v, line, medium, f):
    """Add the force on a free end face at end 1 of a strip along c (m), which moves with v (m/s), to f[term, 1, xy]."""
    if medium.cap_force != 0:
        _cap(medium, (c, v, line, f))


@part
def ball_force(z, v, e, line, medium, f):
    """Add the force at the centre of a ball to f[term, xy] (N).

    z: depth of its lowest point (m, positive); v, e: velocity (m/s) and stretch of the bristle (m) at its centre;
    line.width: its diameter.
    """
    _ball(medium, (z, v, e, line, f))


@part
def drag_anchor(p, anchor, medium):
    """Position of an anchor (2,) m after an accepted step that ended with its station at p (2,) m."""
    return _anchor(medium, (p, anchor))


@part
def line_force(q, v, contact, totals, out):
    """`lines.force`."""
    _line(contact.medium[0], (q, v, contact, totals, out))


@part
def line_accept(q, v, contact, totals, out, row, columns, begins, known):
    """`lines.accept`."""
    return _accept(contact.medium[0], (q, v, contact, totals, out, row, columns, begins, known))


@part
def count_shear(P, anchors, i, line, medium):
    """`path_length.count_shear`, if the medium counts shear displacements."""
    _shear(medium, (P, anchors, i, line))


@part
def count_path(P, anchors, i, x, y, immersed, medium):
    """`path_length.count_path`, if the medium counts paths."""
    _path(medium, (P, anchors, i, x, y, immersed))


@part
def scattered(f, P, anchors, i, place, length, line, medium):
    """`scatter.scattered`, if the medium has scatter."""
    _scattered(medium, (f, P, anchors, i, place, length, line))


@part
def lowering(P, V, i, line, medium):
    """`wheels.lowering`, if the line belongs to a wheel that lowers the surface behind it."""
    return _lowering(medium, (P, V, i, line))


LAWS: dict[np.dtype, dict[str, Any]] = {}  # by record type: functions of a law, by their names in LAW


def record_of(own: np.ndarray, forms: dict[str, Any]) -> np.ndarray:
    """Record (1,) of LAW for a law's own record (1,) and further functions by name; compiles those not compiled yet.

    Raises
    ------
    TypeError
        The law has too many numbers, or is from outside the package and can't be compiled.
    """
    return filled(own, LAWS[own.dtype] | forms, LAW, SIGNATURES)


def filled(own: np.ndarray, functions: dict[str, Any], layout: np.dtype, signatures: dict[str, Any]) -> np.ndarray:
    """Record (1,) of a layout with a law's own record (1,) and the addresses of functions; errors as in `record_of`."""
    if own.nbytes > 8 * SIZE:
        raise TypeError(f"got a law with the numbers {own.dtype.names}, allowed are {SIZE} of 8 bytes")
    medium = np.zeros(1, layout)
    medium["own"].view(np.uint8).ravel()[: own.nbytes] = own.view(np.uint8)
    for name, function in functions.items():
        known = function, name, layout, own.dtype
        if known not in _ADDRESSES:
            kinds, result = signatures[name]
            _ADDRESSES[known] = _address_of_law(function, kinds, result, own.dtype)
        medium[name] = _ADDRESSES[known]
    return medium


_ADDRESSES: dict[tuple[Any, str, np.dtype, np.dtype], int] = {}  # numba's types are slow to make and to look up


OWN_LAWS: dict[np.dtype, Any] = {}  # by record type: classes of laws from outside the package


def _address_of_law(function: Any, kinds: tuple[Any, ...], result: Any, own: np.dtype) -> int:
    """`address_of`; raises one sentence if a law from outside the package can't be compiled."""
    try:
        return address_of(function, kinds, result, own)
    except Exception as error:
        if own not in OWN_LAWS:
            raise
        from granular_contact.sand.kernels.own_law import why_not

        raise TypeError(why_not(OWN_LAWS[own], own, error)) from None
