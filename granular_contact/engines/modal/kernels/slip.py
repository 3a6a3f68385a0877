"""Coulomb-like static resistance with its true sign: directions of slip, and multipliers of components that stick.

The static law considers one point, the middle of the immersed segment, at which the source paper applies its force; and
the two velocity components of that point, each by itself. Without modes the only component is q_1', as all points
rotate together. With the component g_c = J_c(q) q' (c = x, y) and the generalised force Q_c of the whole static term at
its bound:

    slip     Q = sigma_c Q_c,  sigma_c = sgn(g_c)
    stick    g_c' = J_c M^-1 (h + Q) + J_c' q' = 0 gives sigma_c, and it holds while |sigma_c| <= 1

For sticking, sigma_c is thus the Lagrange multiplier of g_c = 0, in units of the bound. Bounds differ between plunging
and withdrawing, so the multiplier is sought on both sides of zero.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.engines.modal.kernels.modal import MOST, modal_scatter, modal_stations
from granular_contact.engines.modal.kernels.modal_load import load, stations_of
from granular_contact.engines.modal.kernels.pendulum import accelerate
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, copy, piece, room1, room2, rows
from granular_contact.sand.kernels.strips import at, halfway, immersed_segment
from granular_contact.sand.kernels.surface import depth

NONE_HOLDS = 1e30  # multiplier if no static force can hold a component


@part
def middle(q, w):
    """Middle of the immersed segment: its line, its place along the stations, and whether any line is immersed.

    If several lines are immersed, the last one is taken, the flexible link; if none is, the deepest station.
    """
    line, place, deepest = 0, 0.0, -np.inf
    for r in range(w.lines.shape[0] - 1, -1, -1):
        first, n = stations_of(w, r)
        P, V = piece(w.room, 3, n), piece(w.room, 4, n)
        modal_stations(q, q, rows(w.geometry, first, n), P, V)
        above, below = immersed_segment(P, w.profile)
        if below > above:
            return r, halfway(P, above, below), True
        for i in range(n):
            z = depth(w.profile, P[i, 0], P[i, 1])
            if z > deepest:
                line, place, deepest = r, float(i), z
    return line, place, False


@part
def slip_velocity(q, v, w, g):
    """Fill g with the velocity components of the static law; return whether any line is immersed."""
    r, place, immersed = middle(q, w)
    if q.shape[0] == 1:
        g[0] = v[0]
        return immersed
    first, n = stations_of(w, r)
    P, V = piece(w.room, 3, n), piece(w.room, 4, n)
    modal_stations(q, v, rows(w.geometry, first, n), P, V)
    g[0], g[1] = at(V, place)
    return immersed


@part
def slip_rows(q, w, J):
    """Fill J (components, at least n + 1), so that g = J q'."""
    if q.shape[0] == 1:
        J[0, 0] = 1.0
        return
    r, place, _ = middle(q, w)
    first, n = stations_of(w, r)
    geometry = rows(w.geometry, first, n)
    P, V, F = piece(w.room, 3, n), piece(w.room, 4, n), piece(w.room, 5, n)
    modal_stations(q, q, geometry, P, V)
    i, cos, sin = min(int(place), n - 2), math.cos(q[0]), math.sin(q[0])
    clear(F)
    clear(J)
    for c in range(2):
        F[i, c], F[i + 1, c] = 1.0 - (place - i), place - i
        modal_scatter(cos, sin, q, geometry, P, F, piece(J, c, q.shape[0]))
        F[i, c], F[i + 1, c] = 0.0, 0.0


@part
def along(J, c, v):
    """Product J_c v of row c of J and v (n + 1,)."""
    total = 0.0
    for k in range(v.shape[0]):
        total += J[c, k] * v[k]
    return total


@part
def slip_bias(q, v, w, bias):
    """Fill bias with J' q', by central differences along the motion, in which the middle moves along the link, too."""
    clear(bias)
    if q.shape[0] == 1:
        return
    velocity, moved, time = room1(2), rows(room1(MOST), 0, q.shape[0]), 1e-6 / max(1.0, abs(v[0]))
    for side in (1.0, -1.0):
        for k in range(q.shape[0]):
            moved[k] = q[k] + side * time * v[k]
        slip_velocity(moved, v, w, velocity)
        for c in range(2):
            bias[c] += side * velocity[c]
    for c in range(2):
        bias[c] /= 2.0 * time


@part
def solve_small(A, b, count):
    """Solution of the leading count x count part of A x = b; NONE_HOLDS where friction cannot act."""
    if count == 1:
        return b[0] / A[0, 0] if A[0, 0] < 0.0 else -np.copysign(NONE_HOLDS, b[0]), 0.0
    det = A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0]
    if abs(det) < 1e-14 * (abs(A[0, 0] * A[1, 1]) + abs(A[0, 1] * A[1, 0])) or det == 0.0:
        return NONE_HOLDS, NONE_HOLDS
    return (b[0] * A[1, 1] - b[1] * A[0, 1]) / det, (b[1] * A[0, 0] - b[0] * A[1, 0]) / det


@part
def hold_rigid(q, v, h, s, w, sigma):
    """`hold` without modes, for the one component: the static force at its bound opposes the force to be held."""
    copy(sigma, s)
    if s[0] != 0.0:
        return
    totals, free, pull = room2(3, 3), room1(1), room1(1)
    load(q, v, sigma, w, totals, free)
    held = h[0] + free[0]
    side = 1.0 if held > 0.0 else -1.0
    sigma[0] = side
    load(q, v, sigma, w, totals, pull)
    gain = (pull[0] - free[0]) * side
    sigma[0] = -held / gain if gain < 0.0 else np.copysign(NONE_HOLDS, held)


@part
def hold(q, v, h, s, w, sigma):
    """Fill sigma with the directions s, and with the multiplier of each component that sticks (s = 0).

    h: generalised forces other than those of the medium. For a pendulum with modes; else see `hold_rigid`.
    """
    copy(sigma, s)
    if s[0] == 0.0 or s[1] == 0.0:
        multipliers(q, v, h, s, w, 0 if s[0] == 0.0 else 1, 2 if s[0] == s[1] else 1, sigma)


@part
def multipliers(q, v, h, s, w, first, count, sigma):
    """Fill sigma with the multipliers of `count` sticking components, from component `first` on."""
    m = q.shape[0]
    J, bias, totals, A, b = room2(2, MOST), room1(2), room2(3, 3), room2(2, 2), room1(2)
    Q, free, pull, probe = rows(room1(MOST), 0, m), rows(room1(MOST), 0, m), rows(room1(MOST), 0, m), room1(2)
    slip_rows(q, w, J)
    slip_bias(q, v, w, bias)
    load(q, v, s, w, totals, Q)
    for k in range(m):
        free[k] = h[k] + Q[k]
    accelerate(q, free, w.pendulum[0])
    for i in range(count):
        b[i] = -(along(J, first + i, free) + bias[first + i])
    copy(probe, s)
    for side in (-1.0, 1.0):
        for j in range(count):
            probe[first + j] = side
            load(q, v, probe, w, totals, pull)
            probe[first + j] = 0.0
            for k in range(m):
                pull[k] -= Q[k]
            accelerate(q, pull, w.pendulum[0])
            for i in range(count):
                A[i, j] = along(J, first + i, pull) * side
        x = solve_small(A, b, count)
        sigma[first] = x[0]
        if count == 2:
            sigma[1] = x[1]
        if side * (x[1] if count == 2 else x[0]) >= 0.0:
            return
