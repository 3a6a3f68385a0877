"""Kinematics of a pendulum that bends in modes: positions and velocities of stations, and generalised forces.

The coordinates are the angle q_1 of the undeformed axis below the horizontal (rad), and the deflections q_{1+i} of the
tip in mode i (m). With e = (cos q_1, -sin q_1) along the axis and n = de/dq_1 across it, a station at (along, across)
in the undeformed pendulum has

    r = pivot + along e + x n,         x = across + sum_i Phi_i q_{1+i},
    v = (along q_1' + x') n - x q_1' e.

Stations of rigid parts have Phi = 0.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.jit.records import record_dtype

MOST_MODES = 20
MOST = MOST_MODES + 1  # coordinates
SIZE = 2 * MOST + 2  # length of a state, see `modal_motion`
ROUND_OFF = 1e-6  # of an index along stations

# along, across: place in the undeformed pendulum, seen from the pivot (m); phi: mode shapes there; pivot: (x, y), m.
MODAL_STATION = record_dtype([("along", "f8"), ("across", "f8"), ("pivot", "f8", (2,)), ("phi", "f8", (MOST_MODES,))])


@part
def modal_stations(q, v, geometry, P, V):
    """Fill P (n, 2) m and V (n, 2) m/s from the coordinates q and rates v; geometry: (n,) records of MODAL_STATION."""
    place_stations(math.cos(q[0]), math.sin(q[0]), q, v, geometry, P, V)


@part(inline=True)
def place_stations(c, s, q, v, geometry, P, V):
    """`modal_stations`, given the cosine and the sine of q_1."""
    for i in range(geometry.shape[0]):
        along = geometry[i].along
        x, x_t = geometry[i].across, 0.0
        for k in range(1, q.shape[0]):
            x += geometry[i].phi[k - 1] * q[k]
            x_t += geometry[i].phi[k - 1] * v[k]
        P[i, 0] = geometry[i].pivot[0] + along * c - x * s
        P[i, 1] = geometry[i].pivot[1] - along * s - x * c
        across_rate, along_rate = along * v[0] + x_t, -x * v[0]
        V[i, 0] = along_rate * c - across_rate * s
        V[i, 1] = -along_rate * s - across_rate * c


@part(inline=True)
def modal_scatter(c, s, q, geometry, P, F, out):
    """Add the generalised forces J^T F of station forces F (n, 2) N to out (n + 1,); c, s: cosine, sine of q_1."""
    for i in range(P.shape[0]):
        if F[i, 0] == 0.0 and F[i, 1] == 0.0:
            continue
        # dr/dq_1 is the arm turned clockwise; dr/dq_{1+k} = Phi_k n.
        out[0] += (P[i, 1] - geometry[i].pivot[1]) * F[i, 0] - (P[i, 0] - geometry[i].pivot[0]) * F[i, 1]
        across = -s * F[i, 0] - c * F[i, 1]
        for k in range(1, q.shape[0]):
            out[k] += geometry[i].phi[k - 1] * across


@part(inline=True)
def within_reach(c, s, q, geometry, surface):
    """First station of a line that can be at an end of an immersed strip, and the number of such stations.

    The stations lie at equal distances on a straight line, deflected by at most the sum of the tip's deflections in all
    modes. surface: its height (m); the surface is level.
    """
    last, bend = geometry.shape[0] - 1, 0.0
    for k in range(1, q.shape[0]):
        bend += abs(q[k] * c)
    begin, end = geometry[0], geometry[last]
    low = surface - begin.pivot[1] + begin.along * s + begin.across * c + bend
    high = surface - end.pivot[1] + end.along * s + end.across * c + bend
    if low <= 0.0 and high <= 0.0:
        return 0, 0
    if low > 0.0 and high > 0.0:
        return 0, last + 1
    crossing = last * (low / (low - high))
    if high > 0.0:
        first = max(0, int(crossing - ROUND_OFF))
        return first, last + 1 - first
    return 0, min(last, int(crossing + ROUND_OFF) + 1) + 1
