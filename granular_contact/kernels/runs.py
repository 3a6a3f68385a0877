"""The three calls that the engine makes for a run of strips on a body: force, tangent, accept.

Arguments that they share:
    system_q, system_v   coordinates (without reference values) and rates of the whole system, views of the engine's
                         memory
    where, reference     (m,) places of the body's coordinates in them, and their reference values
    geometry             (n,) station records of `kinematics`
    run                  (1,) record: surface height and diameter (m), whether the last end is a free face, form of the
                         law
    medium               (1,) record of the law
    anchors              (n - 1, 2) anchors of the static law (m), see `friction`
    totals               (3, 3), see `strips`
"""

from __future__ import annotations

import numpy as np
from numba import njit

from granular_contact.kernels.friction import drag_anchor
from granular_contact.kernels.kinematics import scatter, scatter_tangent, stations
from granular_contact.kernels.strips import distributed_forces, distributed_tangents, resultant_forces

# Columns of a history row: time (s), work done on the bodies so far (J), power (W), depth of the deepest station (m),
# then resultant x, y (N) and moment about the origin (N m) of each of the three terms.
TIME, WORK, POWER, DEPTH, TOTALS = 0, 1, 2, 3, 4
ROW = TOTALS + 9

RUN = np.dtype([("surface", "f8"), ("diameter", "f8"), ("cap", "?"), ("resultant", "?")])


@njit(cache=True)
def gather(system, where):
    """Entries `where` of a system vector."""
    out = np.empty(where.shape[0])
    for i in range(where.shape[0]):
        out[i] = system[where[i]]
    return out


@njit(cache=True)
def drag_anchors(P, anchors, surface, m):
    """Move the anchors after an accepted step: dragged along below the surface, free above it."""
    for i in range(P.shape[0] - 1):
        x, y = 0.5 * (P[i, 0] + P[i + 1, 0]), 0.5 * (P[i, 1] + P[i + 1, 1])
        if P[i, 1] < surface or P[i + 1, 1] < surface:
            x = drag_anchor(x, anchors[i, 0], m)
            y = drag_anchor(y, anchors[i, 1], m)
        anchors[i, 0] = x
        anchors[i, 1] = y


@njit(cache=True)
def release(system_q, where, reference, geometry, anchors):
    """Rest the bristles: every anchor in the middle of its strip."""
    n = geometry.shape[0]
    P, V = np.empty((n, 2)), np.empty((n, 2))
    q = gather(system_q, where) + reference
    stations(q, np.zeros_like(q), geometry, P, V)
    for i in range(n - 1):
        anchors[i, 0] = 0.5 * (P[i, 0] + P[i + 1, 0])
        anchors[i, 1] = 0.5 * (P[i, 1] + P[i + 1, 1])


@njit(cache=True)
def forces(P, V, anchors, run, m, F, totals):
    """Station forces in the form that the run asks for."""
    if run.resultant:
        resultant_forces(P, V, anchors, run, m, F, totals)
    else:
        distributed_forces(P, V, anchors, run, m, F, totals)


@njit(cache=True)
def force(system_q, system_v, where, reference, geometry, run, medium, anchors, totals, out):
    """Fill out (m,) with the generalised forces at the current state."""
    n = geometry.shape[0]
    P, V, F = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    q = gather(system_q, where) + reference
    stations(q, gather(system_v, where), geometry, P, V)
    forces(P, V, anchors, run[0], medium[0], F, totals)
    out[:] = 0.0
    scatter(q, geometry, P, F, out)


@njit(cache=True)
def accept(system_q, system_v, where, reference, geometry, run, medium, anchors, totals, row):
    """End of a step: the anchors follow; power, depth and totals go into a history row.

    Returns the run's depth (m, negative above the surface) and greatest vertical speed (m/s).
    """
    n = geometry.shape[0]
    P, V, F = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    stations(gather(system_q, where) + reference, gather(system_v, where), geometry, P, V)
    totals[:] = 0.0
    forces(P, V, anchors, run[0], medium[0], F, totals)
    drag_anchors(P, anchors, run[0].surface, medium[0])
    depth, speed = -np.inf, 0.0
    for i in range(n):
        row[POWER] += F[i, 0] * V[i, 0] + F[i, 1] * V[i, 1]
        depth = max(depth, run[0].surface - P[i, 1])
        speed = max(speed, abs(V[i, 1]))
    row[DEPTH] = max(row[DEPTH], depth)
    for term in range(3):
        for part in range(3):
            row[TOTALS + 3 * term + part] += totals[term, part]
    return depth, speed


@njit(cache=True)
def difference_tangent(system_q, system_v, where, reference, geometry, run, medium, anchors, fq, fv, out):
    """`tangent` by forward differences, for the form in which every coordinate moves the one point of the force."""
    n, size = geometry.shape[0], where.shape[0]
    P, V, F = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    state = np.empty((2, size))
    state[0] = gather(system_q, where) + reference
    state[1] = gather(system_v, where)
    at_state, moved, totals = np.zeros(size), np.empty(size), np.zeros((3, 3))
    out[:] = 0.0
    for column in range(-1, 2 * size):
        level, j = divmod(max(column, 0), size)
        kept = state[level, j]
        step = 1e-8 * max(1.0, abs(kept)) if column >= 0 else 0.0
        state[level, j] = kept + step
        stations(state[0], state[1], geometry, P, V)
        forces(P, V, anchors, run[0], medium[0], F, totals)
        moved[:] = 0.0
        scatter(state[0], geometry, P, F, moved)
        state[level, j] = kept
        if column < 0:
            at_state[:] = moved
            continue
        factor = (fq if level == 0 else fv) / step
        for i in range(size):
            out[i, j] += factor * (moved[i] - at_state[i])


@njit(cache=True)
def tangent(system_q, system_v, where, reference, geometry, run, medium, anchors, fq, fv, out):
    """Fill out (m, m) with fq df/dq + fv df/dv of the generalised forces f."""
    if run[0].resultant:
        difference_tangent(system_q, system_v, where, reference, geometry, run, medium, anchors, fq, fv, out)
        return
    n = geometry.shape[0]
    P, V, F = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    KP, KV = np.empty((n - 1, 4, 4)), np.empty((n - 1, 4, 4))
    q, v = gather(system_q, where) + reference, gather(system_v, where)
    stations(q, v, geometry, P, V)
    forces(P, V, anchors, run[0], medium[0], F, np.zeros((3, 3)))
    distributed_tangents(P, V, anchors, run[0], medium[0], KP, KV)
    out[:] = 0.0
    scatter_tangent(q, v, geometry, P, F, KP, KV, fq, fv, out)
