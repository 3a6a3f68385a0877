"""What all media in space do, in one call: `planar_sand` for bodies in space.

sand (media, addresses): addresses of the arrays of each batch, see `space_bodies`; system_q, system_v: see there.
"""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import kernel
from granular_contact.jit.memory import piece
from granular_contact.sand.kernels import space_bodies as one
from granular_contact.sand.kernels.proximity import touches_in
from granular_contact.sand.kernels.space_bodies import view


@kernel
def force(sand, system_q, system_v, out):
    """Add the generalised forces of all active clusters to out, the coordinates of the bed."""
    for b in range(sand.shape[0]):
        one.force(piece(sand, b, sand.shape[1]), system_q, system_v, out)


@kernel
def tangent(sand, system_q, system_v, fq, fv, triplets):
    """Fill triplets with the entries of fq df/dq + fv df/dv as rows (row, column, value), and return their number."""
    count = np.intp(0)  # (a literal 0 would be a type of its own, and all that takes it be compiled for both)
    for b in range(sand.shape[0]):
        count = one.tangent(piece(sand, b, sand.shape[1]), system_q, system_v, fq, fv, triplets, count)
    return count


@kernel
def accept(sand, system_q, system_v, row, begins):
    """End of a step, added to a row of the history, see `space_bodies.accept`."""
    for b in range(sand.shape[0]):
        one.accept(piece(sand, b, sand.shape[1]), system_q, system_v, row, begins)


@kernel
def update_active(sand, step):
    """Mark the clusters that may touch the surface within a step (s); whether there are any."""
    some = False
    for b in range(sand.shape[0]):
        some = one.update_active(piece(sand, b, sand.shape[1]), step) or some
    return some


@kernel
def soonest(sand):
    """Time (s) after `accept` until the first of the bodies above the surface may touch it; infinite of none."""
    least = np.inf
    for b in range(sand.shape[0]):
        least = min(least, touches_in(view(piece(sand, b, sand.shape[1])).proximity))
    return least
