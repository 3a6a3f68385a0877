"""What a bed did during a solve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class LoadHistory:
    """One entry per accepted step, the start included.

    time (n,) s; work (n,) J done by the medium on the bodies so far, negative when they lose energy; power (n,) W;
    depth (n,) m of the deepest point, negative above the surface; terms (n, 3, 3): for drag, horizontal static and
    vertical static force its resultant x, y (N) and its moment about the world origin (N m, counter-clockwise).
    """

    time: Vector
    work: Vector
    power: Vector
    depth: Vector
    terms: Vector
