"""Observations of a scene at one instant, by name, with the names, units and signs of the columns of the results."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import unknown_name
from granular_contact.values.arrays import Vector

Pair = tuple[Vector, Vector]
DEGREES = math.degrees(1.0)
COORDINATES, RATES, POSES, VELOCITIES, FORCES, DEPTHS = range(6)  # the first four in pairs, as in an `Instant`
Place = tuple[int, int, int, float]  # of a named number: array, row, column, and the factor of its unit


@dataclass(frozen=True)
class Seen:
    """Names of joints and bodies, in the order of the arrays of observations.

    joints: hinges and sliders; hinges: which of the joints are hinges; bodies: labels of their columns; met: bodies
    that can meet the medium; welded: pairs of a welded body and the body under whose label it is observed.
    """

    _WRENCH: ClassVar[Sequence[str]] = ("x_N", "y_N", "moment_Nm")

    joints: tuple[str, ...]
    hinges: tuple[bool, ...]
    bodies: tuple[str, ...]
    met: tuple[str, ...]
    welded: tuple[tuple[str, str], ...] = ()

    @cached_property
    def places(self) -> dict[str, Place]:
        """Array, row, column and factor of the unit of each name."""
        places: dict[str, Place] = {}
        for i, (name, is_hinge) in enumerate(zip(self.joints, self.hinges, strict=True)):
            places |= _joint_places(name, is_hinge, i)
        for i, name in enumerate(self.bodies):
            places |= self._body_places(name, i)
        for i, name in enumerate(self.met):
            places |= in_a_row(f"{name}_granular", self._WRENCH, FORCES, i)
            places[f"{name}_depth_m"] = (DEPTHS, i, 0, 1.0)
        return places

    @staticmethod
    def _body_places(name: str, i: int) -> dict[str, Place]:
        pose = in_a_row(name, ("x_m", "y_m"), POSES, i) | angle(f"{name}_orientation", POSES, i, 2)
        return pose | in_a_row(name, ("vx_m_s", "vy_m_s", "spin_rad_s"), VELOCITIES, i)


def _joint_places(name: str, is_hinge: bool, i: int) -> dict[str, Place]:
    if is_hinge:
        return angle(f"{name}_angle", COORDINATES, i, 0) | {f"{name}_rate_rad_s": (RATES, i, 0, 1.0)}
    return {f"{name}_position_m": (COORDINATES, i, 0, 1.0), f"{name}_speed_m_s": (RATES, i, 0, 1.0)}


def in_a_row(name: str, ends: Sequence[str], array: int, row: int) -> dict[str, Place]:
    """Places of the first columns of a row; each name is `name` followed by one of the ends."""
    return {f"{name}_{end}": (array, row, column, 1.0) for column, end in enumerate(ends)}


def angle(name: str, array: int, row: int, column: int) -> dict[str, Place]:
    """Places of an angle under both of its names, in degrees and in radians."""
    return {f"{name}_deg": (array, row, column, DEGREES), f"{name}_rad": (array, row, column, 1.0)}


class Instant(NamedTuple):
    """Functions of an engine that compute the arrays of `Observations` at one instant.

    joints: coordinates and rates; bodies: poses and velocities; forces: forces of the medium, from the poses; depths.
    """

    joints: Callable[[], Pair]
    bodies: Callable[[], Pair]
    forces: Callable[[Vector], Vector]
    depths: Callable[[], Vector]


class Observations(Mapping[str, float]):
    """Observations at one instant: arrays in SI units, and single numbers by name, `observations["hip_angle_deg"]`.

    Angles, rates and moments are positive clockwise, in space right-handed. Names are those of the columns of the
    results; angles exist in radians too (`hip_angle_rad`). Bodies that can meet the medium have `BODY_depth_m` and
    `BODY_contact` (1 or 0); `depth_m` is the depth of the deepest point of all.
    Arrays are computed at the first access and then kept.

    Attributes
    ----------
    time : float
        Time (s).
    seen : Seen
        Names of joints and bodies, in the order of the arrays.
    """

    def __init__(self, seen: Seen, time: float, instant: Instant) -> None:
        self.seen, self.time, self._instant = seen, time, instant

    @cached_property
    def _joints(self) -> tuple[Vector, Vector]:
        return self._instant.joints()

    @cached_property
    def _bodies(self) -> tuple[Vector, Vector]:
        return self._instant.bodies()

    @property
    def coordinates(self) -> Vector:
        """Coordinates of hinges (rad) and sliders (m), (joints,)."""
        return self._joints[0]

    @property
    def rates(self) -> Vector:
        """Rates of hinges (rad/s) and sliders (m/s), (joints,)."""
        return self._joints[1]

    @property
    def poses(self) -> Vector:
        """Centre of mass x, y (m) and angle (rad) of each body, (bodies, 3); a flexible link has the angle of its root.

        In space x, y, z (m), then roll, pitch and yaw (rad), (bodies, 6).
        """
        return self._bodies[0]

    @property
    def velocities(self) -> Vector:
        """Rates of the poses (m/s, rad/s), (bodies, 3).

        In space velocities, then angular velocities about the axes of the world frame, (bodies, 6).
        """
        return self._bodies[1]

    @cached_property
    def forces(self) -> Vector:
        """Forces of the medium on bodies: x, y (N) and moment about the centre of mass (N m), (met, 3).

        In space x, y, z (N), then the moment about the same axes (N m), (met, 6).
        """
        return self._instant.forces(self.poses)

    @cached_property
    def depths(self) -> Vector:
        """Depth (m) of the deepest point of each body that can meet the medium, negative above the surface, (met,)."""
        return self._instant.depths()

    @property
    def contacts(self) -> NDArray[np.bool_]:
        """Whether each body that can meet the medium touches it, (met,)."""
        return self.depths > 0.0

    def computed(self) -> Observations:
        """Compute all arrays and return the object itself."""
        _ = self._joints, self._bodies, self.forces, self.depths
        return self

    def __getstate__(self) -> dict[str, Any]:
        """Compute all arrays and leave out the functions of the engine, so that the object can be pickled."""
        return {key: value for key, value in vars(self.computed()).items() if key != "_instant"}

    def __getitem__(self, name: str) -> float:
        """Return a number by name; the KeyError of an unknown name suggests similar names, or lists all."""
        place = self.seen.places.get(name)
        if place is None:
            return self._derived(name)
        array, row, column, factor = place
        if array >= FORCES:
            values = self.forces if array == FORCES else self.depths
        else:
            values = (self._joints, self._bodies)[array // 2][array % 2]
        return float(values[row, column] if values.ndim == 2 else values[row]) * factor

    def _derived(self, name: str) -> float:
        if name == "time_s":
            return self.time
        if name == "depth_m" and self.seen.met:
            return float(self.depths.max())
        body = name.removesuffix("_contact")
        if body != name and body in self.seen.met:
            return float(self.depths[self.seen.met.index(body)] > 0.0)
        raise KeyError(unknown_name("observation", name, self, dict(self.seen.welded)))

    def array(self, names: Iterable[str]) -> Vector:
        """Return the numbers of the given names in this order, (names,)."""
        return np.array([self[name] for name in names])

    def __iter__(self) -> Iterator[str]:
        """Iterate over all names."""
        yield "time_s"
        yield from self.seen.places
        if self.seen.met:
            yield "depth_m"
            yield from (f"{name}_contact" for name in self.seen.met)

    def __len__(self) -> int:
        """Return the number of names."""
        return sum(1 for _ in self)

    def __repr__(self) -> str:
        """List all names with their numbers, one per line."""
        return "\n".join(f"{name:32} {self[name]: .6g}" for name in self)
