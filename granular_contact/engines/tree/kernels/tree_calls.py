"""Functions that the march of a tree calls by their addresses in a record of CALL, as laws are called in `law`.

Reason: Numba optimises a function together with all that it calls, again for each caller. These functions have several
callers, or would be a large part of each caller in a chain of calls.
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
    "ball_efforts": ((TREE.kind,), types.none),
    "ball_stiffness": ((_NUMBER, _NUMBER, TREE.kind), types.none),
}
_OF_SAND = "force", "tangent", "accept", "update_active", "soonest"
_force, _tangent, _accept, _update_active, _soonest = (caller(name, *_SIGNATURES[name], CALL) for name in _OF_SAND)
_begin, _accelerate, _iterate, _end, _attempt, _ball_efforts, _ball_stiffness = (
    caller(name, *_SIGNATURES[name], CALL) for name in _SIGNATURES if name not in _OF_SAND
)


@cache
def record(load: Any, attempt: Any, sand: Any, joints: Any = None) -> NDArray[np.void]:
    """Return a record (1,) of CALL with the addresses of functions, which are compiled first if necessary.

    load: module of the forces on the tree, `tree_load` in the plane; attempt: `tree_newton.attempt`; sand: module of
    the medium; joints: `space_ball_joints` if an effort acts in a ball joint.
    """
    functions = {name: getattr(sand, name) for name in _OF_SAND}
    functions |= {"begin": anderson.begin, "accelerate": anderson.accelerate, "attempt": attempt}
    functions |= {"iterate": load.iteration, "end": load.accept}
    if joints is not None:
        functions |= {"ball_efforts": joints.ball_efforts, "ball_stiffness": joints.ball_stiffness}
    addresses = np.zeros(1, CALL)
    for name, function in functions.items():
        addresses[name] = address_of(function, *_SIGNATURES[name])
    return addresses


@part
def sand_forces(force, w):
    """Add the generalised forces of the medium to `force`, in the coordinates of the poses of nodes."""
    if w.sand.shape[0] > 0:
        arguments = w.sand, flat(w.pose), flat(w.pose_rates), flat(force)
        _force(w.calls[0], arguments)


@part
def sand_tangent(fq, fv, w):
    """Fill the triplets of the tangent of these forces, see `planar_sand.tangent`; return how many they are."""
    if w.sand.shape[0] == 0:
        return 0
    arguments = w.sand, flat(w.pose), flat(w.pose_rates), fq, fv, w.triplets
    return _tangent(w.calls[0], arguments)


@part
def sand_accept(w, history, begins):
    """End a step in the medium, see `planar_sand.accept`."""
    if w.sand.shape[0] > 0:
        arguments = w.sand, flat(w.pose), flat(w.pose_rates), history, begins
        _accept(w.calls[0], arguments)


@part
def update_active(step, w):
    """Mark the contact lines that can touch the surface within a step (s)."""
    _update_active(w.calls[0], (w.sand, step))


@part
def soonest(w):
    """Earliest time (s) until a part above the surface can touch it."""
    return _soonest(w.calls[0], (w.sand,))


@part
def begin_iterations(of_q, of_v, w):
    """Call `anderson.begin`."""
    _begin(w.calls[0], (w.iterations, of_q, of_v))


@part
def accelerate(w):
    """Call `anderson.accelerate`; return whether the matrix is to be renewed."""
    return _accelerate(w.calls[0], (w.iterations, w.newton[0].matrices))


@part
def iterate(of_q, of_v, w):
    """Call `tree_load.iteration`, or its counterpart in space."""
    return _iterate(w.calls[0], (of_q, of_v, w))


@part
def end(w, history, begins):
    """Call `tree_load.accept`, or its counterpart in space."""
    _end(w.calls[0], (w, history, begins))


@part
def ball_efforts(w):
    """Call `space_ball_joints.ball_efforts` if an effort acts in a ball joint."""
    if w.calls[0].ball_efforts != 0:
        _ball_efforts(w.calls[0], (w,))


@part
def ball_stiffness(fq, fv, w):
    """Call `space_ball_joints.ball_stiffness` if an effort acts in a ball joint."""
    if w.calls[0].ball_stiffness != 0:
        _ball_stiffness(w.calls[0], (fq, fv, w))


@part
def attempt(h, allowed, w):
    """Call `tree_newton.attempt`."""
    return _attempt(w.calls[0], (h, allowed, w))
