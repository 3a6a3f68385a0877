"""What a bed did during a solve."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class LoadHistory:
    """One entry per accepted step, the start included.

    time (n,) s; work (n,) J done by all media on the bodies so far, negative when they lose energy; power (n,) W;
    floor_work (n,) J: of the floor's contact alone, which is not in the two before; depth (n,) m of the deepest point,
    negative above the surface; of the immersed stations speed (n,) m/s of the fastest, lowest (n,) m height of the
    lowest point, left, right (n,) m the extreme x, infinite while none is immersed;
    terms (n, terms, 3): for each of `term_names` its resultant x, y (N) and its moment about the world origin (N m,
    counter-clockwise); bodies (n, bodies, 3): the same of all terms together, for each of `body_names`.
    """

    time: Vector
    work: Vector
    power: Vector
    floor_work: Vector
    depth: Vector
    speed: Vector
    lowest: Vector
    left: Vector
    right: Vector
    terms: Vector
    bodies: Vector
    term_names: tuple[str, ...]
    body_names: tuple[str, ...]

    def since(self, start: float) -> LoadHistory:
        """The entries from a time (s) on, with the work counted from there."""
        first = int(np.searchsorted(self.time, start))
        if first == 0:
            return self
        arrays = ("time", "power", "depth", "speed", "terms", "bodies")
        later = {name: getattr(self, name)[first:] for name in arrays}
        return replace(self, work=self.work[first:] - self.work[first : first + 1], **later)
