"""Forces of the medium on the modal pendulum, of all its contact lines, as generalised forces.

The laws are those of `sand.kernels`. Under the true sign they get the deflection of a bristle, too: `aim` puts the
anchor of a bristle with yield displacement 1 and no damping where its deflection is the wanted direction of the static
force.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from granular_contact.engines.modal.kernels.modal import modal_scatter, modal_stations, place_stations, within_reach
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, piece, rows
from granular_contact.sand.kernels.law import forces
from granular_contact.sand.kernels.lines import drag_anchors


class PendulumArrays(NamedTuple):
    """Arrays that the kernels of the modal pendulum read.

    pendulum: (1,) record of `pendulum`; geometry: stations of all lines, one line after another; starts: (lines + 1,)
    first station of each line; lines: (lines,) records of `sand.kernels.law`; profile: (k, 2) of
    `sand.kernels.surface`; medium: (1,) record of the law; anchors: (stations, 2) m; room: (6, stations of the longest
    line, 2), work space.
    """

    pendulum: Any
    geometry: Any
    starts: Any
    lines: Any
    profile: Any
    medium: Any
    anchors: Any
    room: Any


@part(inline=True)
def stations_of(w, r):
    """First station of line r among all stations, and the number of its stations."""
    return w.starts[r], w.starts[r + 1] - w.starts[r]


@part
def aim(P, pivot, modes, sigma, anchors):
    """Put the anchors where the deflection of each bristle is the wanted direction of the static force, in [-1, 1].

    With modes sigma (2,) has the directions of v_x and v_y. Without modes sigma (1,) has the direction of q_1': each
    station moves with it, perpendicular to its arm.
    """
    for i in range(P.shape[0]):
        x, y = P[i, 0], P[i, 1]
        if modes == 0:
            anchors[i, 0] = x - sigma[0] * np.sign(y - pivot[1])
            anchors[i, 1] = y + sigma[0] * np.sign(x - pivot[0])
        else:
            anchors[i, 0] = x - sigma[0]
            anchors[i, 1] = y - sigma[1]


@part(inline=True)
def load(q, v, sigma, w, totals, Q):
    """Fill Q (n + 1,) with generalised forces of the medium, and totals (3, 3) as in `law`; sigma: see `aim`."""
    load_at(math.cos(q[0]), math.sin(q[0]), q, v, sigma, w, totals, Q)


@part(inline=True)
def load_at(c, s, q, v, sigma, w, totals, Q):
    """`load`, given the cosine and the sine of q_1."""
    pendulum = w.pendulum[0]
    for i in range(Q.shape[0]):
        Q[i] = 0.0
    clear(totals)
    for r in range(w.lines.shape[0]):
        begin, n = stations_of(w, r)
        first, n = within_reach(c, s, q, rows(w.geometry, begin, n), w.profile[0, 1])
        if n == 0:
            continue
        geometry, anchors = rows(w.geometry, begin + first, n), rows(w.anchors, begin + first, n)
        P, V, F = piece(w.room, 0, n), piece(w.room, 1, n), piece(w.room, 2, n)
        place_stations(c, s, q, v, geometry, P, V)
        if pendulum.true_sign:
            aim(P, geometry[0].pivot, pendulum.modes, sigma, anchors)
        forces(P, V, anchors, w.lines[r], w.profile, w.medium[0], F, totals)
        modal_scatter(c, s, q, geometry, P, F, Q)


@part
def drag(q, v, w):
    """Move the anchors after an accepted step (return mapping)."""
    for r in range(w.lines.shape[0]):
        first, n = stations_of(w, r)
        P, V = piece(w.room, 0, n), piece(w.room, 1, n)
        modal_stations(q, v, rows(w.geometry, first, n), P, V)
        drag_anchors(P, rows(w.anchors, first, n), w.lines[r], w.profile, w.medium[0])


@kernel(allocates=True)
def rest(q, geometry, anchors):
    """Put the anchors (n, 2) m of a line at its stations, so that no bristle is deflected."""
    modal_stations(q, np.zeros_like(q), geometry, anchors, np.empty_like(anchors))
