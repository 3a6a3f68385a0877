"""Estimate of the error that the size of facets makes in the work of the sand, in the motion of one MjData in space.

At samples of the motion, a few hundred at most, the power of the sand on each body is computed with the facets of the
bed and with other facets (`sand.space.facet_comparison`). All facets are taken to slide: static resistance is fully
mobilised, against the direction of the motion.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry.rotations import quaternion_rates
from granular_contact.sand.space.facet_comparison import FacetComparison, comparison_with_others
from granular_contact.sand.space.load import SpatialLoad

Vector = NDArray[np.float64]
MOST = 256  # most samples that are kept; with more, every second sample is dropped


class ComparedLoads:
    """Load of a bed with its facets, and the same with other facets; both are made at the first use.

    load_with: makes the load with a share of the size of the facets.
    """

    def __init__(self, load_with: Callable[[float], SpatialLoad]) -> None:
        self._load_with = load_with

    @cached_property
    def pair(self) -> tuple[SpatialLoad, FacetComparison | None]:
        """The load with the facets of the bed, and with others; None if there can be no others."""
        load = self._load_with(1.0)
        return load, comparison_with_others(load, self._load_with)


class _Sample(NamedTuple):
    """Bodies in sand at an instant, world frame.

    time (s). positions (bodies, 3) m and quaternions (bodies, 4) of their frames; twists (bodies, 6) about centres
    (bodies, 3) m, see `kernels.held_bodies`.
    """

    time: float
    positions: Vector
    quaternions: Vector
    twists: Vector
    centres: Vector


class MotionSamples:
    """Samples of the motion of one MjData; coordinates are computed from them when an error is asked for."""

    def __init__(self) -> None:
        self._samples: list[_Sample] = []
        self._every, self._calls = 1, 0  # every how many calls a sample is due, and calls so far

    def clear(self) -> None:
        """Drop all samples."""
        self._samples, self._every, self._calls = [], 1, 0

    def drop_after(self, time: float) -> None:
        """Drop the samples after a time (s)."""
        self._samples = [sample for sample in self._samples if sample.time <= time]

    def is_due(self) -> bool:
        """Whether a sample is due in this step; to be called once a step."""
        self._calls += 1
        return self._calls % self._every == 0

    def add(self, time: float, held: NDArray[np.void], data: Any) -> None:
        """Add a sample at a time (s); held (bodies,): records of `kernels.held_bodies`."""
        numbers = held["number"]
        positions, quaternions = data.xpos[numbers], data.xquat[numbers]
        centres = data.subtree_com[held["root"]]
        self._samples.append(_Sample(time, positions, quaternions, held["twist"].copy(), centres))
        if len(self._samples) > MOST:
            self._samples, self._every = self._samples[::2], 2 * self._every

    def error(self, compared: ComparedLoads) -> float:
        """Relative error of the work of the sand that the size of the facets makes."""
        if len(self._samples) < 2:
            return 0.0
        load, other = compared.pair
        if other is None:
            return 0.0
        factors = np.zeros(len(self._samples[0].positions))
        for elements in load.lines:
            factors[elements.body.coordinates[0] // 7] = other.error_factor(elements.body.name)
        weights = np.gradient(np.array([sample.time for sample in self._samples]))
        motion = [_coordinates(sample) for sample in self._samples]
        powers = np.array([[_powers(each, q, v) for each in (load, other.load)] for q, v in motion])
        work = float(weights @ np.abs(powers[:, 0]).sum(axis=1))
        error = float(weights @ (np.abs(powers[:, 1] - powers[:, 0]) @ factors))
        return error / work if work > 0.0 else 0.0


def _coordinates(sample: _Sample) -> tuple[Vector, Vector]:
    """Coordinates q and rates v of all bodies, seven each: position (m) and quaternion."""
    _, positions, quaternions, twists, centres = sample
    velocities = twists[:, 3:] + np.cross(twists[:, :3], positions - centres)
    rates = quaternion_rates(quaternions, twists[:, :3])
    return np.hstack([positions, quaternions]).ravel(), np.hstack([velocities, rates]).ravel()


def _powers(load: Any, q: Vector, v: Vector) -> Vector:
    """Power (bodies,) W of the sand on each body."""
    force = load.force(q, v, np.zeros_like(q))
    return np.asarray((force * v).reshape(-1, 7).sum(axis=1))
