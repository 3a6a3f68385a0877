"""`space_sand` of a bed with walls: how far what is immersed reaches stands in the history, too."""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import kernel
from granular_contact.jit.lending import lender
from granular_contact.jit.memory import piece, rows
from granular_contact.sand.kernels import space_bodies as one
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels import space_sand
from granular_contact.sand.kernels.lines import LEFT
from granular_contact.sand.kernels.space_reach import reach
from granular_contact.sand.kernels.space_sand import force, soonest, tangent, update_active

__all__ = ["accept", "force", "soonest", "tangent", "update_active"]

_row, _rows, _poses = (lender(np.float64, axes) for axes in (1, 2, 3))
_marks = lender(np.bool_, 1)
_bodies, _clusters, _media = (lender(kind, 1) for kind in (law.BODY, law.CLUSTER, law.SPACE_LAW))


@kernel
def accept(sand, system_q, system_v, row, begins):
    """As of `space_sand`."""
    space_sand.accept(sand, system_q, system_v, row, begins)
    if begins:
        return
    for b in range(sand.shape[0]):
        w = piece(sand, b, sand.shape[1])
        reach(
            _bodies(w, one.BODIES), _clusters(w, one.CLUSTERS), _rows(w, one.ELEMENTS), _marks(w, one.ACTIVE),
            _row(w, one.GROUND), _media(w, one.MEDIUM), _poses(w, one.POSES), rows(row, LEFT, 4),
        )  # fmt: skip
