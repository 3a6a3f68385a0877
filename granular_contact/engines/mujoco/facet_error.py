"""What the facets of bodies in space falsify of the work of the sand, in the motion of one MjData.

At instants of the motion, a few hundred at the most, the power of the sand on each body is found with its own facets
and with others, as sliding has it: the static resistance whole, and in the direction of the motion. Errors go with the
square of facets, so with one over their number: of N facets and N* others it is |N* / (N* - N)| of what the two differ
by (Richardson's extrapolation).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry.rotations import quaternion_rates

Vector = NDArray[np.float64]
Indices = NDArray[np.int64]
MOST = 256  # instants that are kept; then every second one of them
SHARES = 2.0**0.5, 0.5, 0.25  # of the edges of the facets: the first that changes their number by a third
OTHER = 0.67


class Facets:
    """Loads of one bed with other facets, made when they are asked for; load_with: makes one of a share of the size."""

    def __init__(self, load_with: Callable[[float], Any]) -> None:
        self._load_with = load_with
        self._pair: tuple[Any, Any, float] | None = None

    def pair(self) -> tuple[Any, Any, float]:
        """The load with its own facets, with others, and what part of their difference the error is."""
        if self._pair is None:
            own = other = self._load_with(1.0)
            n, m = (_number(one) for one in (own, other))
            for share in SHARES if n else ():
                other = self._load_with(share)
                if min(n, m := _number(other)) < OTHER * max(n, m):
                    break
            self._pair = own, other, abs(m / (m - n)) if m != n else 0.0
        return self._pair


def _number(load: Any) -> int:
    return sum(len(one.rows) for one in load.lines if one.meets == "surface")


class Instants:
    """Instants of a motion: time (s), coordinates q and rates v of bodies, seven each."""

    def __init__(self) -> None:
        self._kept: list[tuple[float, Vector, Vector]] = []
        self._every, self._passed = 1, 0

    def clear(self) -> None:
        """Begin anew."""
        self._kept, self._every, self._passed = [], 1, 0

    def back_to(self, time: float) -> None:
        """Forget what came after a time (s)."""
        self._kept = [one for one in self._kept if one[0] <= time]

    def due(self) -> bool:
        """Whether the next instant is to be noted."""
        self._passed += 1
        return self._passed % self._every == 0

    def note(self, time: float, numbers: Indices, tops: Indices, twists: Vector, data: Any) -> None:
        """Keep an instant; arrays as of `kernels.added_mass.place_bodies`."""
        place, turn, w = data.xpos[numbers], data.xquat[numbers], twists[:, :3]
        speed = twists[:, 3:] + np.cross(w, place - data.subtree_com[tops])
        rates = quaternion_rates(turn, w)
        self._kept.append((time, np.hstack([place, turn]).ravel(), np.hstack([speed, rates]).ravel()))
        if len(self._kept) > MOST:
            self._kept, self._every = self._kept[::2], 2 * self._every

    def error(self, facets: Facets) -> float:
        """The work by which facets falsify that of the sand, over all of it."""
        if len(self._kept) < 2:
            return 0.0
        own, other, part = facets.pair()
        if part == 0.0:
            return 0.0
        weights = np.gradient(np.array([time for time, _, _ in self._kept]))
        powers = np.array([[_powers(load, q, v) for load in (own, other)] for _, q, v in self._kept])
        whole = float(weights @ np.abs(powers[:, 0]).sum(axis=1))
        off = float(weights @ np.abs(powers[:, 1] - powers[:, 0]).sum(axis=1))
        return part * off / whole if whole > 0.0 else 0.0


def _powers(load: Any, q: Vector, v: Vector) -> Vector:
    """Power (bodies,) W of the sand on each body."""
    force = load.force(q, v, np.zeros_like(q))
    return np.asarray((force * v).reshape(-1, 7).sum(axis=1))
