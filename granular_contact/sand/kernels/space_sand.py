"""All media in space, in one call: as `planar_sand`, for bodies in space.

sand (media, addresses): addresses of the arrays of each batch, see `space_bodies`; system_q, system_v: see there.
"""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import kernel
from granular_contact.jit.memory import piece
from granular_contact.sand.kernels import space_bodies
from granular_contact.sand.kernels.proximity import touches_in
from granular_contact.sand.kernels.space_bodies import view


@kernel
def force(sand, system_q, system_v, out):
    """Add the generalised forces on all active clusters to out (coordinates of the bed,)."""
    for b in range(sand.shape[0]):
        space_bodies.force(piece(sand, b, sand.shape[1]), system_q, system_v, out)


@kernel
def tangent(sand, system_q, system_v, fq, fv, triplets):
    """Fill triplets with the entries of fq df/dq + fv df/dv as rows (row, column, value), and return their number."""
    count = np.intp(0)  # (a literal 0 has another type, for which callees would be compiled again)
    for b in range(sand.shape[0]):
        count = space_bodies.tangent(piece(sand, b, sand.shape[1]), system_q, system_v, fq, fv, triplets, count)
    return count


@kernel
def accept(sand, system_q, system_v, row, begins):
    """End a step, see `space_bodies.accept`, and add it to a row of the history."""
    for b in range(sand.shape[0]):
        space_bodies.accept(piece(sand, b, sand.shape[1]), system_q, system_v, row, begins)


@kernel
def update_active(sand, step):
    """Mark the clusters that may touch the surface within a step (s); return whether any may."""
    reached = False
    for b in range(sand.shape[0]):
        reached = space_bodies.update_active(piece(sand, b, sand.shape[1]), step) or reached
    return reached


@kernel
def soonest(sand):
    """Time (s) after `accept` until the first body above the surface may touch it; infinite if none may."""
    least = np.inf
    for b in range(sand.shape[0]):
        least = min(least, touches_in(view(piece(sand, b, sand.shape[1])).proximity))
    return least
