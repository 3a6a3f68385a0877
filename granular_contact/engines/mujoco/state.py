"""What a bed is at one instant of one MjData, and all instants that were recorded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class BedState:
    """All that the future of a bed with one MjData depends on beside MuJoCo's own state, see `BedData.state`.

    arrays: as `Step.kept`; rows: of the history.
    """

    time: float | None
    accepted: int
    arrays: tuple[NDArray[Any], ...]
    rows: Vector


@dataclass(frozen=True)
class History:
    """One entry a step (`MujocoBed(..., record=True)`).

    time (n,) s of its start; work (n,) J done on all bodies before it; depth (n,) m of the deepest point then; bodies
    (n, bodies, 6): force (N) and moment about the world origin (N m) during the step, for each of `body_names`.
    """

    time: Vector
    work: Vector
    depth: Vector
    bodies: Vector
    body_names: tuple[str, ...]
