"""`space_sand` of a bed with walls: how far what is immersed reaches stands in the history, too."""

from __future__ import annotations

from granular_contact.jit.compiled import kernel
from granular_contact.jit.memory import piece, rows
from granular_contact.sand.kernels import space_sand
from granular_contact.sand.kernels.lines import LEFT
from granular_contact.sand.kernels.space_bodies import view
from granular_contact.sand.kernels.space_reach import reach
from granular_contact.sand.kernels.space_sand import force, soonest, tangent, update_active

__all__ = ["accept", "force", "soonest", "tangent", "update_active"]


@kernel
def accept(sand, system_q, system_v, row, begins):
    """As of `space_sand`."""
    space_sand.accept(sand, system_q, system_v, row, begins)
    if begins:
        return
    for b in range(sand.shape[0]):
        w = view(piece(sand, b, sand.shape[1]))
        reach(
            w.bodies, w.clusters, w.elements, w.active,
            w.ground, w.medium, w.poses, rows(row, LEFT, 4),
        )  # fmt: skip
