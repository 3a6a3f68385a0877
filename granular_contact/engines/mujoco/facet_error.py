"""What the facets of bodies in space falsify of the work of the sand, in the motion of one MjData.

At instants of the motion, a few hundred at the most, the power of the sand on each body is found with its own facets
and with others (`sand.space.other_facets`), as sliding has it: the static resistance whole, and in the direction of the
motion.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry.rotations import quaternion_rates
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.other_facets import Others, others

Vector = NDArray[np.float64]
Indices = NDArray[np.int64]
MOST = 256  # instants that are kept; then every second one of them


class Facets:
    """Loads of one bed with other facets, made when they are asked for; load_with: makes one of a share of the size."""

    def __init__(self, load_with: Callable[[float], SpatialLoad]) -> None:
        self._load_with = load_with

    @cached_property
    def pair(self) -> tuple[SpatialLoad, Others | None]:
        """The load with its own facets, and others; None where there are none."""
        own = self._load_with(1.0)
        return own, others(own, self._load_with)


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
        own, other = facets.pair
        if other is None:
            return 0.0
        part = np.zeros(len(self._kept[0][1]) // 7)
        for one in own.lines:
            part[one.body.coordinates[0] // 7] = other.part_of(one.body.name)
        weights = np.gradient(np.array([time for time, _, _ in self._kept]))
        powers = np.array([[_powers(load, q, v) for load in (own, other.load)] for _, q, v in self._kept])
        whole = float(weights @ np.abs(powers[:, 0]).sum(axis=1))
        off = float(weights @ (np.abs(powers[:, 1] - powers[:, 0]) @ part))
        return off / whole if whole > 0.0 else 0.0


def _powers(load: Any, q: Vector, v: Vector) -> Vector:
    """Power (bodies,) W of the sand on each body."""
    force = load.force(q, v, np.zeros_like(q))
    return np.asarray((force * v).reshape(-1, 7).sum(axis=1))
