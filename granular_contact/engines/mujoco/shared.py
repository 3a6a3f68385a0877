"""What of a bed is the same for all data of a model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.engine import name_of
from granular_contact.engines.mujoco.facet_error import Facets
from granular_contact.engines.mujoco.sand import Sand

Vector = NDArray[np.float64]


class Shared:
    """Bodies in the sand, the sand, and how a bed was asked to go about it.

    names, numbers (bodies,): of the bodies in the sand; tops (bodies,): of the first body of the mechanism of each, at
    whose centre of mass MuJoCo's twists are; last (bodies,): the last degree of freedom that moves each, -1 if none;
    turn (3, 3): from the world to the frame of the bed; facets: by which their error is found, None in the plane.
    """

    def __init__(
        self,
        model: Any,
        numbers: Sequence[int],
        sand: Sand,
        turn: Vector,
        *,
        facets: Facets | None,
        record: bool,
        lenient: bool,
    ) -> None:
        self.names = tuple(name_of(model, "body", n) for n in numbers)
        self.numbers = np.array(numbers, dtype=np.int64)
        self.tops = np.array([model.body_rootid[n] for n in numbers], dtype=np.int64)
        self.last = np.array([_last_freedom(model, n) for n in numbers], dtype=np.int64)
        self.sand, self.turn = sand, np.ascontiguousarray(turn)
        self.facets, self.record, self.lenient = facets, record, lenient


def _last_freedom(model: Any, number: int) -> int:
    """The last degree of freedom of a body, or of the next body before it that has any."""
    while number > 0 and model.body_dofnum[number] == 0:
        number = int(model.body_parentid[number])
    return int(model.body_dofadr[number] + model.body_dofnum[number] - 1) if number > 0 else -1
