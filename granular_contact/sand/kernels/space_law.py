"""Functions of a law in space, which kernels call by the addresses in a record, as in `law`.

Elements of a rigid body are kept in its frame, in clusters of one kind: facets of a surface, stations of a bar, a ball.
Kernels work in the frame of the bed, with z up, whose origin is the world origin, see `space_bodies`.

pose (6, 3): the rotation R of a body, row by row, then the POSITION of its reference point (m), its VELOCITY (m/s), and
its angular velocity SPIN (rad/s). ground (4,): height (m) of the surface above the origin, its rise per length along x
and y, and the greatest growth of a depth with a distance, sqrt(1 + rise^2); a map of heights may follow, see `ground`.
W (TERMS, 6): force (N) of each term and its moment about the reference point (N m). anchors (n, 3) m: one for each
element, see `space_friction`. `facet_paths` keeps paths in more columns: (n, 6) with shear displacements, (n, 10) with
scatter, (n, 13) with both.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import from_dtype, types

from granular_contact.jit.calls import OWN, caller
from granular_contact.jit.layout import Layout
from granular_contact.jit.records import fields, record_dtype
from granular_contact.sand.kernels.facet_records import BLOCK
from granular_contact.sand.kernels.law import FRICTION, SIZE, filled
from granular_contact.sand.kernels.strip import strip_type

# A cluster: bounding sphere in the frame of its body (m), and half the sides of a bounding box with the same centre,
# along the axes of that frame (m); first and last: its first element and the element after its last; body: index of
# its body; width (m): diameter of a bar or a ball; mass (kg) of a ball; cap: whether the end of a bar is a free face.
# scatter, grain (m), seed, static: of the medium, see `scatter`; static has a bit for each term that scatters.
CLUSTER = record_dtype(
    [
        *fields("f8", "x", "y", "z", "radius", "along_x", "along_y", "along_z"),
        *fields("i8", "first", "last", "body"),
        *fields("f8", "width", "mass"),
        ("cap", "?"),
        *fields("f8", "scatter", "grain"),
        *fields("i8", "seed", "static"),
    ]
)
# A body: size: number of its coordinates; places: number of the system's coordinates that they follow from, whose rows
# of the array `places` begin at `start`; first, last: its clusters; x, y, z, radius (m): bounding sphere. A piece of a
# cable has 6 coordinates that follow from 12: shape (8,) are the Hermite polynomials at its middle, then their
# derivatives, and axis (3,) is the direction of the cable there in the reference configuration.
BODY = record_dtype(
    [
        *fields("i8", "size", "places", "start", "first", "last"),
        *fields("f8", "x", "y", "z", "radius"),
        *(("shape", "f8", (8,)), ("axis", "f8", (3,))),
    ]
)
POSITION, VELOCITY, SPIN = 3, 4, 5  # rows of a pose
# Entries of a row that `follow` fills: depth of the deepest point (m), greatest speed (m/s) and least height (m) of
# immersed elements.
DEPTH, SPEED, LOWEST = 0, 1, 2

FUNCTIONS = (
    *("forces", "follow", "gather", "facets", "layer", "bar", "cap", "ball", "anchor", "body"),
    *("note", "count", "begin", "heights", "six", "lead", "tangent", "slopes"),
)
# layered: the medium lies between the depths top and bottom (m) only. The constants of friction are copied from the
# law's own record, so that functions that need nothing else of a law are compiled once for all laws.
LAYER = [("layered", "i8"), ("top", "f8"), ("bottom", "f8")]
SPACE_LAW = record_dtype([*fields("i8", *FUNCTIONS), *LAYER, *FRICTION, ("own", "f8", (SIZE,))])
# Arrays of all elements of one kind in one medium, see `space_bodies`.
BODIES = Layout(
    "bodies",
    **dict.fromkeys(("reference", "ground"), (float, 1)),
    **dict.fromkeys(("turn", "elements", "anchors", "proximity"), (float, 2)),
    **dict.fromkeys(("places", "columns"), (np.int64, 2)),
    bodies=(BODY, 1),
    clusters=(CLUSTER, 1),
    active=(np.bool_, 1),
    medium=(SPACE_LAW, 1),
    **dict.fromkeys(("poses", "asked", "wrenches"), (float, 3)),
)

_NUMBER, _CLUSTER = types.float64, from_dtype(CLUSTER)
_ROW, _ROWS, _ENDS = (types.Array(_NUMBER, n, "C") for n in (1, 2, 3))
_BLOCK = from_dtype(BLOCK), types.intp  # with the number of its facets
_VECTOR = types.UniTuple(_NUMBER, 3)
_OF_BODY = (_ROW, _ROW, from_dtype(BODY), BODIES.kind, from_dtype(SPACE_LAW))
_OF_CLUSTER = (_ROWS, _ROWS, _CLUSTER, _ROWS, _ROW, from_dtype(SPACE_LAW))
SIGNATURES: dict[str, tuple[tuple[Any, ...], Any]] = {  # arguments, result
    "forces": ((*_OF_CLUSTER, _ROWS), types.none),
    "follow": ((*_OF_CLUSTER, _ROW), types.none),
    "gather": (
        (_ROWS, _ROWS, _CLUSTER, _ROWS, _ROW, types.intp, from_dtype(SPACE_LAW), _BLOCK[0]),
        types.UniTuple(types.intp, 2),
    ),
    "facets": ((*_BLOCK, OWN), types.none),
    "lead": ((*_BLOCK, from_dtype(SPACE_LAW)), types.none),
    "layer": ((types.boolean, *[_NUMBER] * 3, _VECTOR, _VECTOR, _NUMBER, _NUMBER), types.UniTuple(_NUMBER, 8)),
    "bar": ((strip_type(3), _CLUSTER, OWN, _ENDS), types.none),
    "cap": ((_VECTOR, _VECTOR, _CLUSTER, OWN, _ENDS), types.none),
    "ball": ((_NUMBER, _VECTOR, _VECTOR, _CLUSTER, OWN, _ROWS), types.none),
    "anchor": ((_VECTOR, _VECTOR, from_dtype(SPACE_LAW)), _VECTOR),
    "note": ((*_BLOCK, _ROWS, _ROWS, _CLUSTER), types.none),
    "count": ((_ROWS, types.intp, *[_VECTOR] * 3, types.boolean), types.none),
    "begin": ((_ROWS, types.intp, types.intp, types.boolean), types.none),
    "six": ((_ROW, from_dtype(BODY), _ROWS, _ROWS), types.none),
    "heights": ((_ROW, _NUMBER, _NUMBER, _ROW), types.none),
    "body": ((*_OF_BODY, _ROWS, _ROWS, _ROW), types.boolean),
    "tangent": ((*_OF_BODY, _NUMBER, _NUMBER, _ROWS, _ROWS), types.boolean),
    "slopes": ((*_OF_CLUSTER, _NUMBER, _NUMBER, _ROWS, _ROWS), types.none),
}
# Callers of the functions of a medium, with the arguments (medium, (the function's other arguments)):
#
# forces    elements, anchors, cluster, pose, ground, W: add the wrench on a cluster to W
# follow    elements, anchors, cluster, pose, ground, row (3,): end a step: anchors follow their elements, or are
#           released above the surface; for row see DEPTH
# gather    `facets.gather`, which several kernels call
# facets    block, n: fill in the tractions on the first n facets of a block, see BLOCK in `facet_records`
# lead      `facet_blocks.lead`, if the law has no forces of its own on facets
# layer     `facet_parts.between`, if the medium is a layer
# bar       strip, cluster, f: add the forces on a `strip.Strip` to f[term, end, xyz] (N)
# cap       c of a strip, velocity at its end 1, cluster, f: add the force on a free end face there to f[term, 1, xyz]
#           (N), if the law has one
# ball      z, v, e, cluster, f: as `law.ball_force`, to f[term, xyz] (N)
# anchor    p (3,) m, anchor (3,) m: position of the anchor after an accepted step that ended with its element at p
# body      `space_bodies.body_forces`, which several kernels call
# tangent   q, v, body, w, fq, fv, K, W: fill K (7, 7) with fq df/dq + fv df/dv of the generalised forces f on a body,
#           and W (TERMS, 6) with its wrench; return whether it is loaded; w: a view of BODIES; see `space_tangents`
# slopes    elements, anchors, cluster, pose, ground, fq, fv, S, W: add the wrench on a cluster to W, and to S (6, 6)
#           its derivative by a motion m (6,) of the body at its reference point, whose pose moves by fq m and whose
#           velocity changes by fv m
# note, count, begin    functions of `facet_paths`, for media whose facets have paths
# heights   `ground.tangent_plane`, for a bed with a map of heights
# six       `space_coordinates.by_six`, if any body has six coordinates
forces, follow, gather, facets, in_layer, bar_force, cap_force, ball_force, drag_anchor, body_forces, *_others = (
    caller(name, *SIGNATURES[name], SPACE_LAW) for name in FUNCTIONS
)
note, count, begin, tangent_plane, by_six, lead, tangent, slopes = _others


def record_of(own: np.ndarray, functions: dict[str, Any]) -> np.ndarray:
    """Record (1,) of SPACE_LAW for a law's own record (1,) and its compiled functions by name."""
    medium = filled(own, functions, SPACE_LAW, SIGNATURES)
    for name, _ in FRICTION:
        medium[name] = own[name]
    return medium
