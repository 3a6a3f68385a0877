"""What a law provides in space, and how kernels call it there: as in `law`, by the addresses in a record.

Elements of a rigid body are kept in its frame, in clusters of one kind: facets of a surface, stations of a bar, a ball.
Kernels work in the frame of the bed, with z up: its origin is that of the world, see `space_bodies`.

pose (6, 3): the rotation R of a body, row by row, then the position of its reference point (m), its velocity (m/s) and
angular velocity (rad/s). ground (4,): height (m) of the surface above the origin, its rise per length along x and y,
and by how much a depth may grow with a distance, sqrt(1 + rise^2). W (TERMS, 6): of each term the force (N) and the
moment about the reference point (N m). anchors (n, 3) m: one for each element, see `space_friction`; more columns
where `facet_paths` keeps paths: (n, 6) with those of the shear displacement, (n, 10) of scatter, (n, 13) of both.
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

# A cluster: sphere around it in the frame of its body (m), and half the sides of a box around the same centre, along
# the axes of that frame (m); its first element and the one after its last, its body; width (m): diameter of a bar or a
# ball; mass (kg) of a ball; cap: whether the end of a bar is a free face. scatter, grain (m), seed, static: of the
# medium, see `scatter`; static has a bit for each term that scatters.
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
# size: number of coordinates; places: of those of the system that they are, from `start` on; first, last: clusters;
# x, y, z, radius (m): sphere around all of them. Of a piece of a cable 6 coordinates are at 12 places: shape (8,) are
# the Hermite polynomials of its middle, then their derivatives, and axis (3,) the direction there in the reference.
BODY = record_dtype(
    [
        *fields("i8", "size", "places", "start", "first", "last"),
        *fields("f8", "x", "y", "z", "radius"),
        *(("shape", "f8", (8,)), ("axis", "f8", (3,))),
    ]
)
# Of a row that `follow` fills: depth of the deepest point (m), greatest speed (m/s) and least height (m) of what is
# immersed.
DEPTH, SPEED, LOWEST = 0, 1, 2

FUNCTIONS = (
    *("forces", "follow", "gather", "facets", "layer", "bar", "cap", "ball", "anchor", "body"),
    *("note", "count", "begin", "heights", "six", "lead", "tangent", "slopes"),
)
# layered: the medium lies between the depths top and bottom (m) only. Of friction there is a copy of what the law's own
# record has, so that what needs nothing else of a law is compiled once for all of them.
LAYER = [("layered", "i8"), ("top", "f8"), ("bottom", "f8")]
SPACE_LAW = record_dtype([*fields("i8", *FUNCTIONS), *LAYER, *FRICTION, ("own", "f8", (SIZE,))])
# What `space_bodies` does with all elements of one kind in one medium, see there.
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
# What calls a function of the medium: (medium, its other arguments).
#
# forces    elements, anchors, cluster, pose, ground, W: add the wrench on a cluster to W
# follow    elements, anchors, cluster, pose, ground, row (3,): end of a step, anchors follow, or are released above the
#           surface; row see DEPTH
# gather    `facets.gather`, which several kernels call
# facets    block, n: fill in the tractions on the first n facets of a block, see BLOCK in `facet_records`
# lead      `facet_blocks.lead`, where the law asks for it
# layer     `facet_parts.between`, of a medium in a layer
# bar       strip, cluster, f: add the forces on a `strip.Strip` to f[term, end, xyz] (N)
# cap       c of a strip, velocity at its end 1, cluster, f: add the force on a free end face there to f[term, 1, xyz]
#           (N); of laws that know one
# ball      z, v, e, cluster, f: as `law.ball_force`, to f[term, xyz] (N)
# anchor    p (3,) m, anchor (3,) m: where it is after an accepted step that ended with its element at p
# body      `space_bodies.body_forces`, which several kernels call
# tangent   q, v, body, w, fq, fv, K, W: fill K (7, 7) with fq df/dq + fv df/dv of the generalised forces f on a body,
#           and W (TERMS, 6) with its wrench; whether there are any; w: a view of BODIES; of `space_tangents`
# slopes    elements, anchors, cluster, pose, ground, fq, fv, S, W: add the wrench on a cluster to W, to S (6, 6) how
#           it follows a small motion m (6,) of its body at the reference point, moved by fq m, its velocities by fv m
# note, count, begin    those of `facet_paths`, of media whose facets have paths
# heights   `ground.tangent_plane`, of a bed with a map of heights
# six       `space_coordinates.by_six`, where bodies have six coordinates
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
