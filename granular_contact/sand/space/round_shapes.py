"""Shapes of revolution about their z axis: cylinder, sphere, capsule, cone.

Their triangles are those of a body with many sides, whose sections have the same area as the true ones [ours].
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from granular_contact.sand.space import facets, triangles
from granular_contact.sand.space.facets import Facets, Size
from granular_contact.sand.space.revolution import arc, line, revolved
from granular_contact.sand.space.shapes import Shape, greatest_edge, positive

Vector = NDArray[np.float64]
MOST_CHORDS = 10_000  # greatest number of chords of a profile: with as many facets around z there are too many facets
SIDES = 48  # sides of a drawn circle; a sphere has half as many


class _Straight(Shape):
    """Shape whose profile has straight sides only."""

    @abstractmethod
    def _profile(self) -> list[tuple[float, float]]:
        """Points r, z (m) of the profile, from the bottom to the top."""

    def corners(self, size: float | None = None) -> Vector:
        """Triangles of a body with 12 sides around z or more; see `Shape.corners`."""
        return _revolve(self._profile(), size)

    def drawn(self) -> Vector:
        """Triangles for drawings; see `Shape.drawn`."""
        return _revolve(self._profile(), np.inf, SIDES)


@dataclass(frozen=True)
class Cylinder(_Straight):
    """Cylinder around the z axis, from -length/2 to length/2.

    Parameters
    ----------
    diameter, length : float
        Diameter and length (m), above 0.
    """

    diameter: float
    length: float

    def __post_init__(self) -> None:
        positive("Cylinder", diameter=self.diameter, length=self.length)

    def rims(self) -> Vector:
        """Rims of both ends; see `Shape.rims`."""
        return np.array([facets.rim(z, circle=0.5 * self.diameter) for z in (-0.5 * self.length, 0.5 * self.length)])

    def cut_facets(self, size: Size) -> Facets:
        """Patches of the mantle and of both ends; see `Shape.cut_facets`."""
        return revolved([strip for start, end in pairwise(self._profile()) for strip in line(start, end, size)])

    def _profile(self) -> list[tuple[float, float]]:
        r, h = 0.5 * self.diameter, 0.5 * self.length
        return [(0.0, -h), (r, -h), (r, h), (0.0, h)]


@dataclass(frozen=True)
class Sphere(Shape):
    """Sphere around the origin.

    Parameters
    ----------
    diameter : float
        Diameter (m), above 0.
    mass : float, optional
        Mass of the sphere itself (kg), for laws of balls that use it; by default the mass of the body.
    """

    diameter: float
    mass: float | None = None

    def __post_init__(self) -> None:
        positive("Sphere", diameter=self.diameter, mass=1.0 if self.mass is None else self.mass)

    def corners(self, size: float | None = None) -> Vector:
        """Triangles of a body with 12 sides around z or more; see `Shape.corners`."""
        d = self.diameter
        return _revolve(_arc_points(0.5 * d, -0.5 * np.pi, 0.5 * np.pi, greatest_edge(np.sqrt(3.0) * d, size)), size)

    def drawn(self) -> Vector:
        """Triangles for drawings; see `Shape.drawn`."""
        r = 0.5 * self.diameter
        return _revolve(_arc_points(r, -0.5 * np.pi, 0.5 * np.pi, 4.0 * np.pi * r / SIDES), np.inf, SIDES // 2)

    def rims(self) -> Vector:
        """The sphere itself as a rim; see `Shape.rims`."""
        return np.array([facets.rim(0.0, ball=0.5 * self.diameter)])

    def cut_facets(self, size: Size) -> Facets:
        """Patches between meridians and parallels; see `Shape.cut_facets`."""
        return revolved(arc(0.5 * self.diameter, 0.0, -0.5 * np.pi, 0.5 * np.pi, size))


@dataclass(frozen=True)
class Capsule(Shape):
    """Cylinder around the z axis with half spheres at its ends.

    Parameters
    ----------
    diameter : float
        Diameter (m), above 0.
    length : float
        Distance of the centres of the half spheres (m), above 0.
    """

    diameter: float
    length: float

    def __post_init__(self) -> None:
        positive("Capsule", diameter=self.diameter, length=self.length)

    def corners(self, size: float | None = None) -> Vector:
        """Triangles of a body with 12 sides around z or more; see `Shape.corners`."""
        r, h = 0.5 * self.diameter, 0.5 * self.length
        return _revolve(self._profile(greatest_edge(float(np.hypot(np.sqrt(8.0) * r, 2.0 * (r + h))), size)), size)

    def drawn(self) -> Vector:
        """Triangles for drawings; see `Shape.drawn`."""
        return _revolve(self._profile(2.0 * np.pi * self.diameter / SIDES), np.inf, SIDES // 2)

    def rims(self) -> Vector:
        """Both spheres as rims; see `Shape.rims`."""
        return np.array([facets.rim(z, ball=0.5 * self.diameter) for z in (-0.5 * self.length, 0.5 * self.length)])

    def cut_facets(self, size: Size) -> Facets:
        """Patches of both half spheres and of the mantle; see `Shape.cut_facets`."""
        r, h = 0.5 * self.diameter, 0.5 * self.length
        side = line((r, -h), (r, h), size)
        return revolved([*arc(r, -h, -0.5 * np.pi, 0.0, size), *side, *arc(r, h, 0.0, 0.5 * np.pi, size)])

    def _profile(self, step: float) -> list[tuple[float, float]]:
        """Points r, z (m) of the profile, with chords of about `step` (m)."""
        r, h = 0.5 * self.diameter, 0.5 * self.length
        up = [(r, h), *((x, z + h) for x, z in _arc_points(r, 0.0, 0.5 * np.pi, step)[1:])]
        return [*[(x, -z) for x, z in reversed(up)], *up]


@dataclass(frozen=True)
class Cone(_Straight):
    """Cone around the z axis: its tip at the origin, its base at z = height.

    Parameters
    ----------
    diameter : float
        Diameter of the base (m), above 0.
    height : float
        Height (m), above 0.
    """

    diameter: float
    height: float

    def __post_init__(self) -> None:
        positive("Cone", diameter=self.diameter, height=self.height)

    def rims(self) -> Vector:
        """Tip and edge of the base as rims; see `Shape.rims`."""
        return np.array([facets.rim(0.0), facets.rim(self.height, circle=0.5 * self.diameter)])

    def cut_facets(self, size: Size) -> Facets:
        """Patches of the mantle and of the base; see `Shape.cut_facets`."""
        tip, rim, top = self._profile()
        return revolved([*line(tip, rim, size), *line(rim, top, size)])

    def _profile(self) -> list[tuple[float, float]]:
        return [(0.0, 0.0), (0.5 * self.diameter, self.height), (0.0, self.height)]


def _arc_points(radius: float, start: float, end: float, size: float) -> list[tuple[float, float]]:
    """Points r, z (m) on a circle about the origin between two elevations (rad), with chords of about `size` (m)."""
    count = max(2, int(np.ceil(min((end - start) * radius / size, MOST_CHORDS))))
    step = (end - start) / count
    rho = radius * np.sqrt(step / np.sin(step))  # as much area below the chords as below the arc
    angles = start + step * np.arange(count + 1)
    return [
        (max(0.0, float(rho * np.cos(a))) if abs(np.cos(a)) > 1e-12 else 0.0, float(rho * np.sin(a))) for a in angles
    ]


def _revolve(profile: list[tuple[float, float]], size: float | None, least: int = 12) -> Vector:
    """Triangles of the surface that a profile generates by rotation about z.

    profile: points r, z (m), from the bottom to the top. The body has `least` sides or more.
    """
    line = np.array(profile)
    widest = float(line[:, 0].max())
    edge = greatest_edge(float(np.hypot(np.sqrt(8.0) * widest, np.ptp(line[:, 1]))), size)
    around = max(least, int(np.ceil(min(2.0 * np.pi * widest / edge, triangles.MOST_FACETS))))
    if around * (len(line) - 1) > triangles.MOST_FACETS:
        raise triangles.too_many(edge, _revolve(profile[:: len(profile) // 50 + 1], np.inf))
    turn = 2.0 * np.pi / around
    angles = turn * np.arange(around + 1)
    ring = np.sqrt(turn / np.sin(turn)) * np.column_stack([np.cos(angles), np.sin(angles)])
    pieces = []
    for (r0, z0), (r1, z1) in pairwise(line):
        low, high = (np.column_stack([r * ring, np.full(around + 1, z)]) for r, z in ((r0, z0), (r1, z1)))
        a, b, c, d = low[:-1], low[1:], high[1:], high[:-1]
        if r0 > 0.0:
            pieces.append(np.stack([a, b, c], axis=1))
        if r1 > 0.0:
            pieces.append(np.stack([a, c, d], axis=1))
    return triangles.cut(np.concatenate(pieces), edge)
