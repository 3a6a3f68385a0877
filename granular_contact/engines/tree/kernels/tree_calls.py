"""What the march of a tree calls by addresses in a record of CALLS, as laws are called in `law`.

Numba optimises a function together with all that it calls, again for each caller. These are called from several places,
or are a large part of what would be optimised with each of their callers in turn.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from granular_contact.engines.tree.kernels.tree_arrays import CALL, TREE
from granular_contact.jit.calls import address_of, caller
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import flat
from granular_contact.mechanics.kernels import anderson

_ROW, _ROWS = (types.Array(types.float64, axes, "C") for axes in (1, 2))
_ADDRESSES, _SAND, _NUMBER, _WHOLE, _TRUTH = (
    types.Array(types.int64, 1, "C"), types.Array(types.int64, 2, "C"), types.float64, types.int64, types.boolean,
)  # fmt: skip
_SIGNATURES: dict[str, tuple[tuple[Any, ...], Any]] = {  # arguments, result
    "force": ((_SAND, _ROW, _ROW, _ROW), types.none),
    "tangent": ((_SAND, _ROW, _ROW, _NUMBER, _NUMBER, _ROWS), _WHOLE),
    "accept": ((_SAND, _ROW, _ROW, _ROW, _TRUTH), types.none),
    "update_active": ((_SAND, _NUMBER), _TRUTH),
    "soonest": ((_SAND,), _NUMBER),
    "begin": ((_ADDRESSES, _NUMBER, _NUMBER), types.none),
    "accelerate": ((_ADDRESSES, _WHOLE), _TRUTH),
    "iterate": ((_NUMBER, _NUMBER, TREE.kind), _NUMBER),
    "end": ((TREE.kind, _ROW, _TRUTH), types.none),
    "attempt": ((_NUMBER, _NUMBER, TREE.kind), _TRUTH),
    "push": ((TREE.kind,), types.none),
    "stiffen": ((_NUMBER, _NUMBER, TREE.kind), types.none),
}
_force, _tangent, _accept, _update_active, _soonest, _begin, _accelerate, _iterate, _end, _attempt, _push, _stiffen = (
    caller(name, *_SIGNATURES[name], CALL) for name in _SIGNATURES
)
_OF_SAND = "force", "tangent", "accept", "update_active", "soonest"


@cache
def record(load: Any, attempt: Any, sand: Any, joints: Any = None) -> NDArray[np.void]:
    """Record (1,) of CALL with the addresses of functions, which are compiled where they are not yet.

    load: the module of what acts on a tree, `tree_load` in the plane; sand: that of the medium; joints:
    `space_ball_joints`, where something acts in such.
    """
    functions = {name: getattr(sand, name) for name in _OF_SAND}
    functions |= {"begin": anderson.begin, "accelerate": anderson.accelerate, "attempt": attempt}
    functions |= {"iterate": load.iteration, "end": load.accept}
    if joints is not None:
        functions |= {"push": joints.push_balls, "stiffen": joints.stiffen_balls}
    found = np.zeros(1, CALL)
    for name, function in functions.items():
        found[name] = address_of(function, *_SIGNATURES[name])
    return found


@part
def sand_force(force, w):
    """Add the generalised forces of the medium to those on the nodes, in the coordinates of their poses."""
    if w.sand.shape[0] > 0:
        given = w.sand, flat(w.pose), flat(w.pose_rates), flat(force)
        _force(w.calls[0], given)


@part
def sand_tangent(fq, fv, w):
    """Fill triplets with the tangent of these forces, see `planar_sand.tangent`; their number."""
    if w.sand.shape[0] == 0:
        return 0
    given = w.sand, flat(w.pose), flat(w.pose_rates), fq, fv, w.triplets
    return _tangent(w.calls[0], given)


@part
def sand_accept(w, history, begins):
    """End of a step in the medium, see `planar_sand.accept`."""
    if w.sand.shape[0] > 0:
        given = w.sand, flat(w.pose), flat(w.pose_rates), history, begins
        _accept(w.calls[0], given)


@part
def update_active(step, w):
    """Mark the lines that may touch the surface within a step (s)."""
    _update_active(w.calls[0], (w.sand, step))


@part
def soonest(w):
    """Time (s) until something above the surface may touch it."""
    return _soonest(w.calls[0], (w.sand,))


@part
def begin_iterations(of_q, of_v, w):
    """`anderson.begin`."""
    _begin(w.calls[0], (w.iterations, of_q, of_v))


@part
def accelerate(w):
    """`anderson.accelerate`: whether the matrix is to be new."""
    return _accelerate(w.calls[0], (w.iterations, w.newton[0].matrices))


@part
def iterate(of_q, of_v, w):
    """`tree_load.iteration`, or that of space."""
    return _iterate(w.calls[0], (of_q, of_v, w))


@part
def end(w, history, begins):
    """`tree_load.accept`, or that of space."""
    _end(w.calls[0], (w, history, begins))


@part
def push_balls(w):
    """`space_ball_joints.push_balls`, where something acts in such joints."""
    if w.calls[0].push != 0:
        _push(w.calls[0], (w,))


@part
def stiffen_balls(fq, fv, w):
    """`space_ball_joints.stiffen_balls`, likewise."""
    if w.calls[0].stiffen != 0:
        _stiffen(w.calls[0], (fq, fv, w))


@part
def attempt(h, allowed, w):
    """`tree_newton.attempt`."""
    return _attempt(w.calls[0], (h, allowed, w))
