"""The part of a bed that all MjData of a model share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.engine import name_of
from granular_contact.engines.mujoco.facet_error import ComparedLoads
from granular_contact.engines.mujoco.sand import Sand

Vector = NDArray[np.float64]


class Shared:
    """Bodies in sand, the sand that acts on them, and the options of the bed.

    names, numbers (bodies,): of the bodies in sand. roots (bodies,): number of the first body of the mechanism of each,
    about whose centre of mass of the subtree MuJoCo has twists. last_dofs (bodies,): last degree of freedom that moves
    each, -1 if none does. turn (3, 3): rotation from the world to the frame of the bed. compared_loads: by which the
    error of the facets is estimated; None in the plane. record, lenient: see `MujocoBed`.
    """

    def __init__(
        self,
        model: Any,
        numbers: Sequence[int],
        sand: Sand,
        turn: Vector,
        *,
        compared_loads: ComparedLoads | None,
        record: bool,
        lenient: bool,
    ) -> None:
        self.names = tuple(name_of(model, "body", n) for n in numbers)
        self.numbers = np.array(numbers, dtype=np.int64)
        self.roots = np.array([model.body_rootid[n] for n in numbers], dtype=np.int64)
        self.last_dofs = np.array([_last_dof(model, n) for n in numbers], dtype=np.int64)
        self.sand, self.turn = sand, np.ascontiguousarray(turn)
        self.compared_loads, self.record, self.lenient = compared_loads, record, lenient


def _last_dof(model: Any, number: int) -> int:
    """Last degree of freedom of a body, or of its nearest ancestor that has any; -1 if none has."""
    while number > 0 and model.body_dofnum[number] == 0:
        number = int(model.body_parentid[number])
    return int(model.body_dofadr[number] + model.body_dofnum[number] - 1) if number > 0 else -1
