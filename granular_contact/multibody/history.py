"""What a bed did during a solve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class LoadHistory:
    """One entry per accepted step, the start included.

    time (n,) s; work (n,) J done by all media on the bodies so far, negative when they lose energy; power (n,) W;
    depth (n,) m of the deepest point, negative above the surface; speed (n,) m/s of the fastest immersed station;
    terms (n, terms, 3): for each of `term_names` its resultant x, y (N) and its moment about the world origin (N m,
    counter-clockwise); bodies (n, bodies, 3): the same of all terms together, for each of `body_names`.
    """

    time: Vector
    work: Vector
    power: Vector
    depth: Vector
    speed: Vector
    terms: Vector
    bodies: Vector
    term_names: tuple[str, ...]
    body_names: tuple[str, ...]
