"""What a bed did during a solve."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class LoadHistory:
    """One entry per accepted step, the start included.

    time (n,) s; work (n,) J done by all media on the bodies so far, negative when they lose energy; power (n,) W;
    floor_work (n,) J: of the floor's contact alone, which is not in the two before; depth (n,) m of the deepest point,
    negative above the surface; of the immersed stations speed (n,) m/s of the fastest, lowest (n,) m height of the
    lowest point, left, right (n,) m the extreme x, infinite while none is immersed; coarser (n, 3): by how much the
    power (W) and the resultant x, y (N) would change with strips of twice the length;
    terms (n, terms, 3): for each of `term_names` its resultant x, y (N) and its moment about the world origin (N m,
    right-handed about z as the engine has it, so counter-clockwise; tables of runs have it clockwise); bodies
    (n, bodies, 3): the same of all terms together, for each of `body_names`.
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
    coarser: Vector
    terms: Vector
    bodies: Vector
    term_names: tuple[str, ...]
    body_names: tuple[str, ...]

    def at_end(self) -> LoadHistory:
        """The last entry alone, if there is one."""
        last: dict[str, Any] = {k: values[-1:] for k, values in vars(self).items() if isinstance(values, np.ndarray)}
        return replace(self, **last)

    def since(self, start: float) -> LoadHistory:
        """The entries from a time (s) on, with both works counted from there."""
        first = int(np.searchsorted(self.time, start))
        if first == 0:
            return self
        later: dict[str, Any] = {
            name: values[first:] for name, values in vars(self).items() if isinstance(values, np.ndarray)
        }
        for name in ("work", "floor_work"):
            later[name] = later[name] - later[name][:1]
        return replace(self, **later)
