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
from granular_contact.sand.space.other_facets import FacetComparison, comparison_with_others

Vector = NDArray[np.float64]
MOST = 256  # instants that are kept; then every second one of them


class Facets:
    """Loads of one bed with other facets, made when they are asked for; load_with: makes one of a share of the size."""

    def __init__(self, load_with: Callable[[float], SpatialLoad]) -> None:
        self._load_with = load_with

    @cached_property
    def pair(self) -> tuple[SpatialLoad, FacetComparison | None]:
        """The load with its own facets, and others; None where there are none."""
        own = self._load_with(1.0)
        return own, comparison_with_others(own, self._load_with)


class Instants:
    """Instants of a motion, as they are at hand: turned into coordinates and rates when an error is asked for."""

    def __init__(self) -> None:
        self._kept: list[tuple[float, Vector, Vector, Vector, Vector]] = []
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

    def note(self, time: float, held: NDArray[np.void], data: Any) -> None:
        """Keep an instant (s); held (bodies,): records of `kernels.held_bodies`."""
        numbers = held["number"]
        place, turn = data.xpos[numbers], data.xquat[numbers]
        self._kept.append((time, place, turn, held["twist"].copy(), data.subtree_com[held["top"]]))
        if len(self._kept) > MOST:
            self._kept, self._every = self._kept[::2], 2 * self._every

    def error(self, facets: Facets) -> float:
        """The work by which facets falsify that of the sand, over all of it."""
        if len(self._kept) < 2:
            return 0.0
        own, other = facets.pair
        if other is None:
            return 0.0
        part = np.zeros(len(self._kept[0][1]))
        for one in own.lines:
            part[one.body.coordinates[0] // 7] = other.error_factor(one.body.name)
        weights = np.gradient(np.array([one[0] for one in self._kept]))
        motion = [_motion(*one[1:]) for one in self._kept]
        powers = np.array([[_powers(load, q, v) for load in (own, other.load)] for q, v in motion])
        whole = float(weights @ np.abs(powers[:, 0]).sum(axis=1))
        off = float(weights @ (np.abs(powers[:, 1] - powers[:, 0]) @ part))
        return off / whole if whole > 0.0 else 0.0


def _motion(place: Vector, turn: Vector, twists: Vector, centres: Vector) -> tuple[Vector, Vector]:
    """Coordinates and their rates, seven of each body, from places (m), quaternions and twists about centres (m)."""
    speed = twists[:, 3:] + np.cross(twists[:, :3], place - centres)
    rates = quaternion_rates(turn, twists[:, :3])
    return np.hstack([place, turn]).ravel(), np.hstack([speed, rates]).ravel()


def _powers(load: Any, q: Vector, v: Vector) -> Vector:
    """Power (bodies,) W of the sand on each body."""
    force = load.force(q, v, np.zeros_like(q))
    return np.asarray((force * v).reshape(-1, 7).sum(axis=1))
