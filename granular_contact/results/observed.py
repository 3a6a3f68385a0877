"""What is seen of a scene at one instant, by name: the same names, units and signs as the columns of the results."""

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
COORDINATES, RATES, POSES, VELOCITIES, FORCES, DEPTHS = range(6)  # in pairs, as in an `Instant`
Place = tuple[int, int, int, float]  # array, row, column and factor of the unit of a name


@dataclass(frozen=True)
class Seen:
    """Whose numbers stand where in observations.

    joints: of hinges and sliders; hinges: which of them are hinges; bodies: by the label of their columns; met: those
    that can meet the medium; welded: bodies that go by the label of the one that they are welded to, and this.
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
        found: dict[str, Place] = {}
        for i, (name, is_hinge) in enumerate(zip(self.joints, self.hinges, strict=True)):
            found |= _of_joint(name, is_hinge, i)
        for i, name in enumerate(self.bodies):
            found |= self._of_body(name, i)
        for i, name in enumerate(self.met):
            found |= in_a_row(f"{name}_granular", self._WRENCH, FORCES, i)
            found[f"{name}_depth_m"] = (DEPTHS, i, 0, 1.0)
        return found

    @staticmethod
    def _of_body(name: str, i: int) -> dict[str, Place]:
        found = in_a_row(name, ("x_m", "y_m"), POSES, i) | angle(f"{name}_orientation", POSES, i, 2)
        return found | in_a_row(name, ("vx_m_s", "vy_m_s", "spin_rad_s"), VELOCITIES, i)


def _of_joint(name: str, is_hinge: bool, i: int) -> dict[str, Place]:
    if is_hinge:
        return angle(f"{name}_angle", COORDINATES, i, 0) | {f"{name}_rate_rad_s": (RATES, i, 0, 1.0)}
    return {f"{name}_position_m": (COORDINATES, i, 0, 1.0), f"{name}_speed_m_s": (RATES, i, 0, 1.0)}


def in_a_row(name: str, ends: Sequence[str], array: int, row: int) -> dict[str, Place]:
    """Names with these ends, for the columns of a row from its first on."""
    return {f"{name}_{end}": (array, row, column, 1.0) for column, end in enumerate(ends)}


def angle(name: str, array: int, row: int, column: int) -> dict[str, Place]:
    """Both names of an angle, in degrees and in radians."""
    return {f"{name}_deg": (array, row, column, DEGREES), f"{name}_rad": (array, row, column, 1.0)}


class Instant(NamedTuple):
    """One instant of a solve, each part of which is computed when it is asked for; arrays as of `Observations`.

    joints: coordinates and rates; bodies: poses and velocities; forces: of the medium, of the poses; depths.
    """

    joints: Callable[[], Pair]
    bodies: Callable[[], Pair]
    forces: Callable[[Vector], Vector]
    depths: Callable[[], Vector]


class Observations(Mapping[str, float]):
    """One instant: arrays in SI units, and every single number by its name, `observations["hip_angle_deg"]`.

    Angles, rates and moments are clockwise positive, in space right-handed. Names are those of the columns of the
    results, angles also in radians (`hip_angle_rad`); and `BODY_depth_m`, `BODY_contact` (1 or 0) and `depth_m` of what
    can meet the medium.
    What is not asked for is not computed; what was is kept.

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
        """Of hinges (rad) and sliders (m), (joints,)."""
        return self._joints[0]

    @property
    def rates(self) -> Vector:
        """Of hinges (rad/s) and sliders (m/s), (joints,)."""
        return self._joints[1]

    @property
    def poses(self) -> Vector:
        """Centres of mass x, y (m) and angles (rad), of a link that bends the angle of its root, (bodies, 3).

        In space x, y, z (m), then roll, pitch and yaw (rad), (bodies, 6).
        """
        return self._bodies[0]

    @property
    def velocities(self) -> Vector:
        """Rates of poses (m/s, rad/s), (bodies, 3).

        In space velocities, then angular velocities about the axes of the world, (bodies, 6).
        """
        return self._bodies[1]

    @cached_property
    def forces(self) -> Vector:
        """Of the medium on bodies: x, y (N) and moment about the centre of mass (N m), (met, 3).

        In space x, y, z (N), then the moment about the same axes (N m), (met, 6).
        """
        return self._instant.forces(self.poses)

    @cached_property
    def depths(self) -> Vector:
        """Of the deepest point of bodies that can meet the medium (m), negative above the surface, (met,)."""
        return self._instant.depths()

    @property
    def contacts(self) -> NDArray[np.bool_]:
        """Whether each body that can meet the medium is in it, (met,)."""
        return self.depths > 0.0

    def computed(self) -> Observations:
        """The same, with all of it computed now."""
        _ = self._joints, self._bodies, self.forces, self.depths
        return self

    def __getstate__(self) -> dict[str, Any]:
        """Arrays only, so that it can go to another process."""
        return {key: held for key, held in vars(self.computed()).items() if key != "_instant"}

    def __getitem__(self, name: str) -> float:
        """A number by its name; KeyError says which are nearest, or what there is."""
        place = self.seen.places.get(name)
        if place is None:
            return self._other(name)
        array, row, column, factor = place
        if array >= FORCES:
            held = self.forces if array == FORCES else self.depths
        else:
            held = (self._joints, self._bodies)[array // 2][array % 2]
        return float(held[row, column] if held.ndim == 2 else held[row]) * factor

    def _other(self, name: str) -> float:
        if name == "time_s":
            return self.time
        if name == "depth_m" and self.seen.met:
            return float(self.depths.max())
        body = name.removesuffix("_contact")
        if body != name and body in self.seen.met:
            return float(self.depths[self.seen.met.index(body)] > 0.0)
        raise KeyError(unknown_name("observation", name, self, dict(self.seen.welded)))

    def array(self, names: Iterable[str]) -> Vector:
        """Numbers of some names, in their order, (names,)."""
        return np.array([self[name] for name in names])

    def __iter__(self) -> Iterator[str]:
        """Names, as of a mapping."""
        yield "time_s"
        yield from self.seen.places
        if self.seen.met:
            yield "depth_m"
            yield from (f"{name}_contact" for name in self.seen.met)

    def __len__(self) -> int:
        """How many names there are."""
        return sum(1 for _ in self)

    def __repr__(self) -> str:
        """All names with their numbers, one in a line."""
        return "\n".join(f"{name:32} {self[name]: .6g}" for name in self)
