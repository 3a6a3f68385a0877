"""How far a motion with other strips departs from one that is known: solving for the correction, in few long steps.

Of a motion q, v with the forces Q of its own strips, and the forces Q* of others, the departure W x of all coordinates,
x in the freedoms of the mechanism, has

    M x'' = W^T [Q*(q + W x, v + W x') - Q(q, v)] - K x - D x'

with the mass matrix M, and K and D of what acts in joints. Both media keep friction states of their own, led along the
motion and along what departs from it. What long steps leave out of the motion is the same in both, so it cancels.
Backward Euler, first order in the step, with Newton's method, of which a step is shortened where it leads farther away;
some ten evaluations of the forces a step. Left out: how W changes with x.

Source: R. D. Skeel, "Thirteen ways to estimate global error", Numer. Math. 48 (1986), 1-20: solving for the correction.

Arguments that they share:

    called      (1,) record of CALLED
    sand        a medium with its lines, as of `planar_sand`
    i           the instant at the end of a step, of the motion's
    motion      `Motion`
    room        `Room`
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numpy.typing import NDArray

from granular_contact.jit.calls import address_of, caller
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, piece
from granular_contact.jit.records import record_dtype
from granular_contact.sand.kernels import planar_sand

ITERATIONS, SHORTENED, SHARE = 8, 4, 0.4  # most of them; most shares of a step, each so much of the one before
CLOSE, RENEW = 1e-4, 0.3  # part of the motion's speed; what of the residual (its root) may be left by an old matrix
_ROW, _ROWS = (types.Array(types.float64, axes, "C") for axes in (1, 2))
_SAND = types.Array(types.int64, 2, "C")
_SIGNATURES: dict[str, tuple[tuple[Any, ...], Any]] = {  # of functions of `planar_sand`: arguments, result
    "force": ((_SAND, _ROW, _ROW, _ROW), types.none),
    "tangent": ((_SAND, _ROW, _ROW, types.float64, types.float64, _ROWS), types.int64),
    "accept": ((_SAND, _ROW, _ROW, _ROW, types.boolean), types.none),
}
CALLED = record_dtype([(name, "i8") for name in _SIGNATURES])
_force, _tangent, _accept = (caller(name, *_SIGNATURES[name], CALLED) for name in _SIGNATURES)
X0, V0, X, V, MISSING, STEP, BEFORE = range(7)  # rows of `Room.freedoms`
THERE, RATES, FORCES, OWN, LAST = range(5)  # rows of `Room.coordinates`


class Motion(NamedTuple):
    """A motion at n instants, of m coordinates with d freedoms.

    time (n,) s; q, v (n, m); W (n, m, d): rates of the coordinates by those of the freedoms; A (n, d, m): of any rates
    the freedoms that have their momentum; M, K, D (n, d, d): mass, stiffness and damping of joints.
    """

    time: NDArray[np.float64]
    q: NDArray[np.float64]
    v: NDArray[np.float64]
    W: NDArray[np.float64]
    A: NDArray[np.float64]
    M: NDArray[np.float64]
    K: NDArray[np.float64]
    D: NDArray[np.float64]


class Room(NamedTuple):
    """To work in.

    triplets: for tangents; own_row, other_row: for rows of both histories; freedoms (7, d): x and x' before a step,
    at its end, the impulses that are missing, steps of Newton's method; coordinates (5, m): coordinates, rates and
    forces of what departs, forces of the motion's own strips, rates of the departure; matrix, S (d, d).
    """

    triplets: NDArray[np.float64]
    own_row: NDArray[np.float64]
    other_row: NDArray[np.float64]
    freedoms: NDArray[np.float64]
    coordinates: NDArray[np.float64]
    matrix: NDArray[np.float64]
    S: NDArray[np.float64]


def called() -> NDArray[np.void]:
    """Record (1,) of CALLED with the addresses of functions, which are compiled where they are not yet."""
    found = np.zeros(1, CALLED)
    for name, signature in _SIGNATURES.items():
        found[name] = address_of(getattr(planar_sand, name), *signature)
    return found


@part
def solve(matrix, S, b):
    """Solve matrix x = b in place of b, by elimination with pivots in S; whether it was regular."""
    n = b.shape[0]
    for i in range(n):
        for j in range(n):
            S[i, j] = matrix[i, j]
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(S[i, k]) > abs(S[best, k]):
                best = i
        if not abs(S[best, k]) > 0.0:
            return False
        for j in range(n):
            S[k, j], S[best, j] = S[best, j], S[k, j]
        b[k], b[best] = b[best], b[k]
        for i in range(k + 1, n):
            factor = S[i, k] / S[k, k]
            for j in range(k, n):
                S[i, j] -= factor * S[k, j]
            b[i] -= factor * b[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            b[k] -= S[k, j] * b[j]
        b[k] /= S[k, k]
        if not abs(b[k]) < math.inf:
            return False
    return True


@part
def by_freedoms(i, W, x, out):
    """Fill out (m,) with W x."""
    for k in range(W.shape[1]):
        out[k] = 0.0
        for j in range(W.shape[2]):
            out[k] += W[i, k, j] * x[j]


@part
def residual(called, sand, i, motion, room):
    """Fill the impulses that are missing at the end of a step; their square over the masses.

    It goes there by x' as it is in the room, and fills x and what departs.
    """
    x, c, h = room.freedoms, room.coordinates, motion.time[i] - motion.time[i - 1]
    d, m = x.shape[1], c.shape[1]
    for j in range(d):
        x[X, j] = x[X0, j] + h * x[V, j]
    by_freedoms(i, motion.W, piece(x, X, d), piece(c, THERE, m))
    by_freedoms(i, motion.W, piece(x, V, d), piece(c, RATES, m))
    for k in range(m):
        c[THERE, k] += motion.q[i, k]
        c[RATES, k] += motion.v[i, k]
        c[FORCES, k] = 0.0
    _force(called[0], (sand, piece(c, THERE, m), piece(c, RATES, m), piece(c, FORCES, m)))
    size = 0.0
    for j in range(d):
        missing = 0.0
        for k in range(d):
            missing += motion.M[i, j, k] * (x[V, k] - x[V0, k])
            missing += h * (motion.K[i, j, k] * x[X, k] + motion.D[i, j, k] * x[V, k])
        for k in range(m):
            missing -= h * motion.W[i, k, j] * (c[FORCES, k] - c[OWN, k])
        x[MISSING, j] = missing
        size += missing * missing / motion.M[i, j, j]
    return size


@part
def matrix(called, sand, i, motion, room):
    """Fill the matrix with the derivative of the missing impulses by x'."""
    S, c, h = room.matrix, room.coordinates, motion.time[i] - motion.time[i - 1]
    d, m = S.shape[0], c.shape[1]
    for j in range(d):
        for k in range(d):
            S[j, k] = motion.M[i, j, k] + h * (h * motion.K[i, j, k] + motion.D[i, j, k])
    there, rates = piece(c, THERE, m), piece(c, RATES, m)
    for t in range(_tangent(called[0], (sand, there, rates, h, 1.0, room.triplets))):
        line, column = int(room.triplets[t, 0]), int(room.triplets[t, 1])
        for j in range(d):
            of_line = h * room.triplets[t, 2] * motion.W[i, line, j]
            for k in range(d):
                S[j, k] -= of_line * motion.W[i, column, k]


@part
def nearer(called, sand, i, motion, room, size):
    """Go along a step of Newton's method, or a share of it, to where less is missing: the share, and what is missing.

    A share of 0: it stays where it was.
    """
    x, share = room.freedoms, 1.0
    for _ in range(SHORTENED):
        for j in range(x.shape[1]):
            x[V, j] = x[BEFORE, j] + share * x[STEP, j]
        now = residual(called, sand, i, motion, room)
        if now < size:
            return share, now
        share *= SHARE
    for j in range(x.shape[1]):
        x[V, j] = x[BEFORE, j]
    return 0.0, residual(called, sand, i, motion, room)


@part
def iterate(called, sand, i, motion, room, speed):
    """Newton's method for x' at the end of a step, to a part of a speed (m/s); its matrix is kept while it serves."""
    x, old = room.freedoms, False
    size = residual(called, sand, i, motion, room)
    for _ in range(ITERATIONS):
        if not old:
            matrix(called, sand, i, motion, room)
        for j in range(x.shape[1]):
            x[STEP, j], x[BEFORE, j] = -x[MISSING, j], x[V, j]
        if not solve(room.matrix, room.S, piece(x, STEP, x.shape[1])):
            return
        share, now = nearer(called, sand, i, motion, room, size)
        most = 0.0
        for k in range(motion.W.shape[1]):
            change = 0.0
            for j in range(x.shape[1]):
                change += motion.W[i, k, j] * share * x[STEP, j]
            most = max(most, abs(change))
        if most <= CLOSE * speed and (share == 1.0 or not old):
            return
        old, size = share == 1.0 and now < RENEW * RENEW * size, now


@kernel
def depart(called, own, other, motion, room, speed, out):
    """Fill out (n, m) with the departure of all coordinates.

    own, other: the media, with the motion's strips and with others; speed (m/s): of the motion.
    """
    x, c, W, A = room.freedoms, room.coordinates, motion.W, motion.A
    d, m = x.shape[1], c.shape[1]
    last, there = piece(c, LAST, m), piece(c, THERE, m)
    clear(last)
    clear(out)
    _accept(called[0], (own, piece(motion.q, 0, m), last, room.own_row, True))
    _accept(called[0], (other, piece(motion.q, 0, m), last, room.other_row, True))
    for i in range(1, W.shape[0]):
        q, v = piece(motion.q, i, m), piece(motion.v, i, m)
        for j in range(d):
            x[X0, j], x[V0, j] = 0.0, 0.0
            for k in range(m):
                x[X0, j] += A[i, j, k] * out[i - 1, k]
                x[V0, j] += A[i, j, k] * last[k]
            x[V, j] = x[V0, j]
        clear(piece(c, OWN, m))
        _force(called[0], (own, q, v, piece(c, OWN, m)))
        iterate(called, other, i, motion, room, speed)
        by_freedoms(i, W, piece(x, X, d), piece(out, i, m))
        by_freedoms(i, W, piece(x, V, d), last)
        _accept(called[0], (own, q, v, room.own_row, False))
        _accept(called[0], (other, there, piece(c, RATES, m), room.other_row, False))
