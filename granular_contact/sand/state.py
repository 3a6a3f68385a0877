"""State of a granular load after an accepted step: all that its future and its history so far depend on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from granular_contact.sand.batch import Batch
    from granular_contact.sand.load import GranularLoad

Vector = NDArray[np.float64]


BatchState = tuple[NDArray[Any], ...]  # of `Batch.state`


@dataclass(frozen=True)
class LoadState:
    """Of a load: time (s) of the last accepted state, `active`, rows of its history with what is summed up of them."""

    time: float | None
    active: bool
    rows: Vector
    summed: tuple[int, float]
    batches: tuple[BatchState, ...]


def state(load: GranularLoad) -> LoadState:
    """A copy of the state of a load."""
    return LoadState(load.time, load.active, *load.table.kept(), batch_states(load.batches))


def restore(load: GranularLoad, kept: LoadState) -> None:
    """Bring a load of the same lines in the same media to a state; it has been started before."""
    load.time, load.active = kept.time, kept.active
    load.table.restore(kept.rows, kept.summed)
    restore_batches(load.batches, kept.batches)


def batch_states(batches: Sequence[Batch]) -> tuple[BatchState, ...]:
    """Copies of the states of batches."""
    return tuple(tuple(array.copy() for array in batch.state()) for batch in batches)


def restore_batches(batches: Sequence[Batch], states: Sequence[BatchState]) -> None:
    """Bring batches to their states, in the arrays that they have."""
    for batch, kept in zip(batches, states, strict=True):
        for array, old in zip(batch.state(), kept, strict=True):
            array[:] = old
        batch.forget()
