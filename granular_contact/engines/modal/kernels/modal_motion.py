"""Right-hand side of the modal pendulum, and the regime of its static law: components that slip, and that stick.

State y: q (n + 1,), q' (n + 1,), work of the medium so far (J), work of the internal damping so far (J). Regime s:
direction -1 or 1 of each component that slips, 0 of each that sticks; see `slip`.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.engines.modal.kernels import modal_calls
from granular_contact.engines.modal.kernels.modal import MOST, SIZE
from granular_contact.engines.modal.kernels.modal_load import load_at
from granular_contact.engines.modal.kernels.pendulum import accelerate, damping_power, own_forces, own_forces_at
from granular_contact.engines.modal.kernels.slip import along, slip_bias, slip_rows, slip_velocity
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, copy, piece, room1, room2, rows

BOUND_SLACK = 1e-6  # a multiplier may exceed its bound by this before the component slips


@kernel
def rates(y, s, w, sigma, totals, dy):
    """Fill dy with y', sigma with the directions of the static force, totals (3, 3) with the forces of the medium."""
    m = w.pendulum[0].modes + 1
    q, v = rows(y, 0, m), rows(y, m, m)
    f, Q = rows(room1(MOST), 0, m), rows(room1(MOST), 0, m)
    cos, sin = math.cos(q[0]), math.sin(q[0])
    own_forces_at(cos, sin, q, v, w.pendulum[0], f)
    clear(Q)
    if w.lines.shape[0] > 0:
        for c in range(s.shape[0]):
            sigma[c] = s[c]
        if w.pendulum[0].true_sign:
            modal_calls.hold(q, v, f, s, w, sigma)
        load_at(cos, sin, q, v, sigma, w, totals, Q)
    power = 0.0
    for i in range(m):
        power += Q[i] * v[i]
        dy[i] = v[i]
        f[i] += Q[i]
    accelerate(q, f, w.pendulum[0])
    for i in range(m):
        dy[m + i] = f[i]
    dy[2 * m] = power
    dy[2 * m + 1] = damping_power(v, w.pendulum[0])


@part
def margins(y, s, w, margin):
    """Fill margin with the distance of each component from the end of its regime; negative beyond the end."""
    m = w.pendulum[0].modes + 1
    q, v = rows(y, 0, m), rows(y, m, m)
    g, sigma = rows(room1(2), 0, s.shape[0]), rows(room1(2), 0, s.shape[0])
    if not slip_velocity(q, v, w, g):
        for c in range(s.shape[0]):
            margin[c] = 1.0
        return
    sticks = False
    for c in range(s.shape[0]):
        sigma[c], sticks = 0.0, sticks or s[c] == 0.0
    if sticks:
        h = rows(room1(MOST), 0, m)
        own_forces(q, v, w.pendulum[0], h)
        modal_calls.hold(q, v, h, s, w, sigma)
    for c in range(s.shape[0]):
        slipping = s[c] * g[c] + w.pendulum[0].still
        margin[c] = slipping if s[c] != 0.0 else 1.0 + BOUND_SLACK - abs(sigma[c])


@kernel
def follow(y, s, w):
    """Above the surface, set the regime to the direction of motion; return whether it changed."""
    m, changed = w.pendulum[0].modes + 1, False
    g = rows(room1(2), 0, s.shape[0])
    if slip_velocity(rows(y, 0, m), rows(y, m, m), w, g):
        return False
    for c in range(s.shape[0]):
        way = 1.0 if g[c] > 0.0 else -1.0
        if g[c] != 0.0 and s[c] != way:
            s[c], changed = way, True
    return changed


@part
def violation(y, s, open_, w):
    """Contradiction of a regime with the motion that it causes, 0 for none.

    A component that sticks must be held within the bound. One that slips from rest must accelerate in its direction.
    open_ (components,): 1 for components that may change, else 0.
    """
    m = w.pendulum[0].modes + 1
    q, v, count = rows(y, 0, m), rows(y, m, m), s.shape[0]
    dy, sigma, totals = rows(room1(SIZE), 0, y.shape[0]), rows(room1(2), 0, count), room2(3, 3)
    clear(sigma)
    clear(totals)
    modal_calls.rates(y, s, w, sigma, totals, dy)
    J, bias = room2(2, MOST), rows(room1(2), 0, count)
    slip_rows(q, w, J)
    slip_bias(q, v, w, bias)
    worst = 0.0
    for c in range(count):
        if s[c] == 0.0:
            worst = max(worst, abs(sigma[c]) - 1.0)
        elif open_[c] != 0.0:
            worst = max(worst, -s[c] * (along(J, c, rows(dy, m, m)) + bias[c]))
    return worst


@kernel
def decide(y, s, stopped, w):
    """Choose the next regime s, after components stopped, or sticking components passed their bound.

    stopped (components,): components that are known to stand still. The regimes are tried in turn, first the one in
    which all components stick that may. The first regime without contradiction is chosen, else the one with the least
    contradiction. The velocity of sticking components is set to zero exactly.
    """
    m, count = w.pendulum[0].modes + 1, s.shape[0]
    g, open_ = rows(room1(2), 0, count), rows(room1(2), 0, count)
    slip_velocity(rows(y, 0, m), rows(y, m, m), w, g)
    best, trial, least = rows(room1(2), 0, count), rows(room1(2), 0, count), np.inf
    for c in range(count):
        open_[c] = s[c] == 0.0 or stopped[c] or abs(g[c]) <= 2.0 * w.pendulum[0].still
        best[c] = s[c]
    for code in range(3**count):
        digits, allowed = code, True
        for c in range(count):
            option = float(digits % 3)
            option = option if option < 2.0 else -1.0
            digits //= 3
            allowed = allowed and (open_[c] != 0.0 or option == 1.0)
            trial[c] = option if open_[c] != 0.0 else np.sign(g[c])
        if not allowed:
            continue
        contradiction = violation(y, trial, open_, w)
        if contradiction < least:
            copy(best, trial)
            least = contradiction
    copy(s, best)
    halt(y, s, w)


@part
def halt(y, s, w):
    """Remove round-off speeds of sticking components, one by one: q' less M^-1 J^T (J M^-1 J^T)^-1 g."""
    m = w.pendulum[0].modes + 1
    q, v = rows(y, 0, m), rows(y, m, m)
    if m == 1:
        if s[0] == 0.0:
            v[0] = 0.0
        return
    J, g, push = room2(2, MOST), room1(2), rows(room1(MOST), 0, m)
    for _ in range(3):
        slip_velocity(q, v, w, g)
        slip_rows(q, w, J)
        for c in range(2):
            if s[c] != 0.0:
                continue
            copy(push, piece(J, c, m))
            accelerate(q, push, w.pendulum[0])
            share = along(J, c, v) / along(J, c, push)
            for k in range(m):
                v[k] -= share * push[k]
