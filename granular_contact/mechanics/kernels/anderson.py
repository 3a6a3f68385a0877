"""Anderson acceleration of modified Newton iterations (type II, depth `DEPTH`), and the start of the iterations.

An iteration of modified Newton leads from x to x + g(x). With the differences G of g and E of x + g between successive
iterations, the next iteration starts from (Anderson 1965; Walker and Ni 2011)

    x + g - E c,    where c minimises |g - G c|^2 + r |diag(G) c|^2,

by the normal equations with columns scaled to unit length; r: `REGULARISATION`. Differences are compared as speeds, as
rates times levers. Pairs of differences are kept over steps, for as long as the Jacobian and the step length stay the
same.

The iterations of a step start from the accelerations and multipliers of the last step. Arnold and Bruels (2007) start
from zero, which costs an iteration more, and several where bristles are.

Cost: DEPTH + 2 products of vectors an iteration. Limits: g must be nearly linear over the last iterations. Where a
bristle yields it is not; the next Jacobian then drops all pairs. Arrays: `iterations`.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, copy, room1, room2
from granular_contact.mechanics.kernels.iterations import ITERATIONS
from granular_contact.mechanics.kernels.numerics import CONTRACTION, DEPTH, LEAST_DIFFERENCE, REGULARISATION

view = ITERATIONS.view
_SAME_STEP = 1e-6  # of a step: relative difference of two lengths that is round-off


@kernel
def begin(addresses, dq_da, dv_da):
    """Begin a step with the accelerations and multipliers of the last one; dq_da (s2), dv_da (s): see PROGRESS."""
    w = view(addresses)
    q, v, a, a_before, progress = w.q, w.v, w.a, w.a_before, w.progress[0]
    if abs(dv_da - progress.dv_da) > _SAME_STEP * dv_da:
        progress.pairs, progress.column = 0, 0
    progress.dq_da, progress.dv_da, progress.change, progress.follows = dq_da, dv_da, math.inf, 0
    for i in range(a.shape[0]):
        q[i] += dq_da * a_before[i]
        v[i] += dv_da * a_before[i]
        a[i] += a_before[i]
    copy(w.multipliers, w.multipliers_before)
    keep_start(w)


@part
def keep_start(w):
    """Keep the accelerations and multipliers that the next iteration starts from."""
    copy(w.start, w.a)
    copy(w.start_multipliers, w.multipliers)


@part
def keep_end(w):
    """Keep the accelerations and multipliers that the last iteration led to."""
    copy(w.end, w.a)
    copy(w.end_multipliers, w.multipliers)


@part
def keep_pair(w, column):
    """Fill a column of G and E with the differences between the last two iterations, and update G^T G."""
    a, multipliers, lever, start, end, end_multipliers = w.a, w.multipliers, w.lever, w.start, w.end, w.end_multipliers
    g, G, E, E_multipliers, GTG = w.g, w.G, w.E, w.E_multipliers, w.GTG
    sums = room1(DEPTH)
    clear(sums)
    for i in range(a.shape[0]):
        E[i, column] = a[i] - end[i]
        G[i, column] = difference = lever[i] * (a[i] - start[i]) - g[i]
        for k in range(DEPTH):
            sums[k] += difference * G[i, k]
    for i in range(multipliers.shape[0]):
        E_multipliers[i, column] = multipliers[i] - end_multipliers[i]
    for k in range(DEPTH):
        GTG[column, k] = GTG[k, column] = sums[k]


@part
def coefficients(w, pairs, change, c):
    """Fill c (DEPTH,) with the least-squares coefficients, by elimination; change: size of g (m/s2)."""
    g, G, GTG = w.g, w.G, w.GTG
    M, scale = room2(DEPTH, DEPTH), room1(DEPTH)
    clear(c)
    for i in range(g.shape[0]):
        for k in range(DEPTH):
            c[k] += G[i, k] * g[i]
    for k in range(pairs):
        counts = GTG[k, k] > (LEAST_DIFFERENCE * change) ** 2
        scale[k] = 1.0 / math.sqrt(GTG[k, k]) if counts else 0.0
    for k in range(pairs):
        c[k] *= scale[k]
        for j in range(pairs):
            M[k, j] = scale[k] * scale[j] * GTG[k, j]
        M[k, k] = 1.0 + REGULARISATION
    for k in range(pairs):
        for j in range(k + 1, pairs):
            factor = M[j, k] / M[k, k]
            for i in range(k, pairs):
                M[j, i] -= factor * M[k, i]
            c[j] -= factor * c[k]
    for back in range(pairs):
        k = pairs - 1 - back
        for j in range(k + 1, pairs):
            c[k] -= M[k, j] * c[j]
        c[k] /= M[k, k]
    for k in range(DEPTH):
        c[k] = scale[k] * c[k] if k < pairs else 0.0


@part
def extrapolate(w, c):
    """Move the unknowns from x + g to x + g - E c."""
    q, v, a, multipliers, progress = w.q, w.v, w.a, w.multipliers, w.progress[0]
    E, E_multipliers, dq_da, dv_da = w.E, w.E_multipliers, progress.dq_da, progress.dv_da
    for i in range(a.shape[0]):
        change = 0.0
        for k in range(DEPTH):
            change -= c[k] * E[i, k]
        q[i] += dq_da * change
        v[i] += dv_da * change
        a[i] += change
    for i in range(multipliers.shape[0]):
        for k in range(DEPTH):
            multipliers[i] -= c[k] * E_multipliers[i, k]


@part
def update_change(w):
    """Fill g with the change by the last iteration; return its size (m/s2) and whether it reverses the change before.

    It reverses where the scalar product of the two changes is negative.
    """
    a, lever, start, g = w.a, w.lever, w.start, w.g
    square, along = 0.0, 0.0
    for i in range(a.shape[0]):
        change = lever[i] * (a[i] - start[i])
        square, along = square + change * change, along + change * g[i]
        g[i] = change
    return math.sqrt(square), along < 0.0


@kernel
def accelerate(addresses, jacobians):
    """Move the unknowns to the start of the next iteration; return whether that one needs a new Jacobian.

    It does where the last iteration contracted too little: its change is above CONTRACTION times the change before. A
    change that reverses the one before is exempt. The iteration before then went past the solution, because resistance
    grew on the way. Its Jacobian had the right direction, and the two changes give the length of the way better than a
    new Jacobian would. jacobians: number of Jacobians computed so far.
    """
    w = view(addresses)
    progress = w.progress[0]
    if jacobians != progress.jacobian:
        progress.jacobian, progress.pairs, progress.column, progress.follows = jacobians, 0, 0, 0
        progress.change = math.inf
    if progress.follows:
        keep_pair(w, progress.column)
        progress.column = (progress.column + 1) % DEPTH
        progress.pairs = min(progress.pairs + 1, DEPTH)
    change, reverses = update_change(w)
    slow = change > CONTRACTION * progress.change and not reverses
    keep_end(w)
    progress.follows, progress.change = 1, change
    if progress.pairs > 0:
        c = room1(DEPTH)
        coefficients(w, progress.pairs, change, c)
        extrapolate(w, c)
    keep_start(w)
    return slow
