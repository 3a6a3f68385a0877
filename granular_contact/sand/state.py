"""State of a granular load after an accepted step: everything on which its future and its history depend."""

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


BatchState = tuple[NDArray[Any], ...]  # copies of the arrays of `Batch.state`


@dataclass(frozen=True)
class LoadState:
    """State of a load.

    Parameters
    ----------
    time : float or None
        Time (s) of the last accepted state.
    active : bool
        Whether anything can touch the surface in this step.
    rows : (n, columns) array
        Rows of the history.
    summed : tuple
        Running sum of work, see `HistoryTable.restore`.
    batches : tuple of BatchState
        States of the batches.
    """

    time: float | None
    active: bool
    rows: Vector
    summed: tuple[int, float]
    batches: tuple[BatchState, ...]


def state(load: GranularLoad) -> LoadState:
    """Copy of the state of a load.

    Parameters
    ----------
    load : GranularLoad
        The load.
    """
    return LoadState(load.time, load.active, *load.table.snapshot(), batch_states(load.batches))


def restore(load: GranularLoad, saved: LoadState) -> None:
    """Bring a load to a state.

    Parameters
    ----------
    load : GranularLoad
        A load of the same lines in the same media, which has been started.
    saved : LoadState
        The state.
    """
    load.time, load.active = saved.time, saved.active
    load.table.restore(saved.rows, saved.summed)
    restore_batches(load.batches, saved.batches)


def batch_states(batches: Sequence[Batch]) -> tuple[BatchState, ...]:
    """Copies of the states of batches.

    Parameters
    ----------
    batches : sequence of Batch
        The batches.
    """
    return tuple(tuple(array.copy() for array in batch.state()) for batch in batches)


def restore_batches(batches: Sequence[Batch], states: Sequence[BatchState]) -> None:
    """Copy states into the arrays of batches.

    Parameters
    ----------
    batches : sequence of Batch
        The batches.
    states : sequence of BatchState
        Their states, see `batch_states`.
    """
    for batch, batch_state in zip(batches, states, strict=True):
        for array, values in zip(batch.state(), batch_state, strict=True):
            array[:] = values
        batch.forget()
