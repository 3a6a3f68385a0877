"""What a law provides in space, and how kernels call it there: as in `law`, by the addresses in a record.

Elements of a rigid body are kept in its frame, in clusters of one kind: facets of a surface, stations of a bar, a ball.
Kernels work in the frame of the bed, with z up: its origin is that of the world, see `space_bodies`.

pose (6, 3): the rotation R of a body, row by row, then the position of its reference point (m), its velocity (m/s) and
angular velocity (rad/s). ground (4,): height (m) of the surface above the origin, its rise per length along x and y,
and by how much a depth may grow with a distance, sqrt(1 + rise^2). W (TERMS, 6): of each term the force (N) and the
moment about the reference point (N m). anchors (n, 3) m: one for each element, see `space_friction`; (n, 4) with the
shear displacement of `path_length`, (n, 10) with what `facet_scatter` keeps, (n, 11) with both.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import from_dtype, types

from granular_contact.kernels.compiled import part
from granular_contact.kernels.law import OWN, SIZE, caller, filled
from granular_contact.kernels.records import fields

# A cluster: sphere around it in the frame of its body (m), its first element and the one after its last, its body;
# width (m): diameter of a bar or a ball; mass (kg) of a ball; cap: whether the end of a bar is a free face. scatter,
# grain (m), seed, static: of the medium, see `scatter`; static has a bit for each term that scatters.
CLUSTER = np.dtype(
    [
        *fields("f8", "x", "y", "z", "radius"),
        *fields("i8", "first", "last", "body"),
        *fields("f8", "width", "mass"),
        ("cap", "?"),
        *fields("f8", "scatter", "grain"),
        *fields("i8", "seed", "static"),
    ]
)
# size: number of coordinates, from `start` on; first, last: clusters; x, y, z, radius (m): sphere around all of them.
BODY = np.dtype([*fields("i8", "size", "start", "first", "last"), *fields("f8", "x", "y", "z", "radius")])
# Of a row that `follow` fills: depth of the deepest point (m), greatest speed (m/s) and least height (m) of what is
# immersed.
DEPTH, SPEED, LOWEST = 0, 1, 2

FUNCTIONS = ("forces", "follow", "gather", "facets", "layer", "bar", "cap", "ball", "anchor", "body")
# layered: the medium lies between the depths top and bottom (m) only.
LAYER = [("layered", "i8"), ("top", "f8"), ("bottom", "f8")]
SPACE_LAW = np.dtype([*fields("i8", *FUNCTIONS), *LAYER, ("own", "f8", (SIZE,))])

_NUMBER, _CLUSTER = types.float64, from_dtype(CLUSTER)
_ROW, _ROWS, _ENDS = (types.Array(_NUMBER, n, "C") for n in (1, 2, 3))
_MARKS, _BODIES = types.Array(types.boolean, 1, "C"), (from_dtype(BODY), _ROWS, types.Array(_CLUSTER, 1, "C"))
_OF_CLUSTER = (_ROWS, _ROWS, _CLUSTER, _ROWS, _ROW, from_dtype(SPACE_LAW))
SIGNATURES: dict[str, tuple[tuple[Any, ...], Any]] = {  # arguments, result
    "forces": ((*_OF_CLUSTER, _ROWS), types.none),
    "follow": ((*_OF_CLUSTER, _ROW), types.none),
    "gather": (
        (_ROWS, _ROWS, _CLUSTER, _ROWS, _ROW, types.intp, from_dtype(SPACE_LAW), _ROWS),
        types.UniTuple(types.intp, 2),
    ),
    "facets": ((_ROWS, types.intp, OWN), types.none),
    "layer": ((_NUMBER,) * 11, types.UniTuple(_NUMBER, 8)),
    "bar": ((*[_NUMBER] * 19, _CLUSTER, OWN, _ENDS), types.none),
    "cap": ((*[_NUMBER] * 6, _CLUSTER, OWN, _ENDS), types.none),
    "ball": ((*[_NUMBER] * 7, _CLUSTER, OWN, _ROWS), types.none),
    "anchor": ((*[_NUMBER] * 6, OWN), types.UniTuple(_NUMBER, 3)),
    "body": ((_ROW, _ROW, *_BODIES, _ROWS, _ROWS, _MARKS, _ROW, from_dtype(SPACE_LAW), _ROWS, _ROWS, _ROW), types.none),
}
_forces, _follow, _gather, _facets, _layer, _bar, _cap, _ball, _anchor, _body = (
    caller(name, *SIGNATURES[name], SPACE_LAW) for name in FUNCTIONS
)


@part
def forces(elements, anchors, cluster, pose, ground, medium, W):
    """Add the wrench on a cluster to W (TERMS, 6)."""
    _forces(medium, (elements, anchors, cluster, pose, ground, W))


@part
def follow(elements, anchors, cluster, pose, ground, medium, row):
    """End of a step: the anchors of a cluster follow, or are released above the surface; row (3,) see DEPTH."""
    _follow(medium, (elements, anchors, cluster, pose, ground, row))


@part
def gather(elements, anchors, cluster, pose, ground, first, medium, B):
    """`facets.gather`, which several kernels call."""
    return _gather(medium, (elements, anchors, cluster, pose, ground, first, B))


@part
def facets(B, n, medium):
    """Fill tractions on the first n facets of a block, see `kernels.facets`.

    Of what grows with depth the stress per depth N/m^3, of the rest the stress Pa. What is told of a facet: z > 0 mean
    depth (m) of what is immersed of it; n unit normal; velocity v (m/s) and stretch e (m) of the bristle at its
    centroid; spread (m/s): by how much n . v differs from there to a corner, at most; side 1: only what n . v > 0 is
    loaded, n pointing outward; 0: a thin plate, either face can lead; j (m): shear displacement, see `path_length`.
    """
    _facets(medium, (B, n))


@part
def in_layer(z, za, zb, ax, ay, az, bx, by, bz, medium):
    """`facets.immersion` of what of a facet lies in the layer of a medium; depths stay those below the surface."""
    return _layer(medium, (z, za, zb, ax, ay, az, bx, by, bz, medium.top, medium.bottom))


@part
def bar_force(a, b, z0, z1, cx, cy, cz, v0x, v0y, v0z, v1x, v1y, v1z, e0x, e0y, e0z, e1x, e1y, e1z, cluster, medium, f):
    """Add the forces on a strip of a bar to f[term, end, xyz] (N); as `law.strip_force`, with vectors in space."""
    _bar(
        medium,
        (a, b, z0, z1, cx, cy, cz, v0x, v0y, v0z, v1x, v1y, v1z, e0x, e0y, e0z, e1x, e1y, e1z, cluster, f),
    )


@part
def cap_force(cx, cy, cz, vx, vy, vz, cluster, medium, f):
    """Add the force on the free end face at end 1 of a strip to f[term, 1, xyz] (N), if the law knows one."""
    if medium.cap != 0:
        _cap(medium, (cx, cy, cz, vx, vy, vz, cluster, f))


@part
def ball_force(z, vx, vy, vz, ex, ey, ez, cluster, medium, f):
    """Add the force at the centre of a ball to f[term, xyz] (N); as `law.ball_force`, with vectors in space."""
    _ball(medium, (z, vx, vy, vz, ex, ey, ez, cluster, f))


@part
def drag_anchor(px, py, pz, ax, ay, az, medium):
    """Where an anchor at (ax, ay, az) m is after an accepted step that ended with its element at (px, py, pz) m."""
    return _anchor(medium, (px, py, pz, ax, ay, az))


@part
def body_forces(q, v, body, turn, clusters, elements, anchors, active, ground, medium, pose, W, out):
    """`space_bodies.body_forces`, which several kernels call."""
    _body(medium, (q, v, body, turn, clusters, elements, anchors, active, ground, pose, W, out))


def record_of(own: np.ndarray, functions: dict[str, Any]) -> np.ndarray:
    """Record (1,) of SPACE_LAW for a law's own record (1,) and its compiled functions by name."""
    return filled(own, functions, SPACE_LAW, SIGNATURES)


@part
def nothing(W):
    """Whether a wrench (TERMS, 6) is none at all."""
    for term in range(W.shape[0]):
        for k in range(W.shape[1]):
            if W[term, k] != 0.0:
                return False
    return True
