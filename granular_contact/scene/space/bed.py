"""Where the media lie in space: a level or sloped surface, or a map of heights."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.bed.space.heights import Heights
from granular_contact.config.schema import space as schema
from granular_contact.errors import Fault, scene_fault
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer
from granular_contact.scene.space.height_map import heights_of
from granular_contact.scene.space.types import Part, SpatialRigidBody

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class SpatialBed:
    """origin: height (m) of the surface at the world's origin, or of the zero of a map; rise (2,) per length along x
    and y.
    """

    origin: float
    rise: tuple[float, float]
    layers: tuple[Layer, ...]
    heights: Heights | None = None
    # What a bed in the plane has, for those who ask both.
    floor = None
    container = None

    @property
    def media(self) -> tuple[Law, ...]:
        """The media of all layers."""
        return tuple(layer.medium for layer in self.layers)

    @property
    def level(self) -> bool:
        """Whether the surface is level."""
        return self.rise == (0.0, 0.0) and self.heights is None

    def height(self, x: Vector, y: Vector) -> Vector:
        """Height of the surface (m) at x, y (m), of any shape."""
        level: Vector = self.origin + self.rise[0] * np.asarray(x) + self.rise[1] * np.asarray(y)
        return level if self.heights is None else level + self.heights.at(x, y)

    def slope(self, x: Vector, y: Vector) -> tuple[Vector, Vector]:
        """Rise of the surface per length along x and y, at x, y (m)."""
        nothing = np.zeros_like(np.asarray(x, float))
        if self.heights is None:
            return nothing + self.rise[0], nothing + self.rise[1]
        h = 1e-3 * self.heights.cell
        along = (self.height(x + h, y) - self.height(x - h, y)) / (2.0 * h)
        return along, (self.height(x, y + h) - self.height(x, y - h)) / (2.0 * h)

    @property
    def corners(self) -> Vector:
        """Corners (k, 2) m, x and z, of the section through the surface at y = 0, its first and last pieces without
        end.
        """
        x = np.array([0.0, 1.0])
        if self.heights is not None:
            x = self.heights.corner[0] + self.heights.cell * np.arange(-1, self.heights.values.shape[1] + 1)
        return np.column_stack([x, self.height(x, np.zeros_like(x))])


def bed(
    scenario: schema.SpatialScenario, rigid: tuple[SpatialRigidBody, ...], faults: list[Fault]
) -> SpatialBed | None:
    """Bed of a scene; None without a medium and without a surface. Faults are appended."""
    spec = scenario.bed or schema.SpatialBed()
    if not scenario.media and scenario.surface_height_m is None and scenario.bed is None:
        return None
    slope, toward = math.tan(math.radians(spec.slope_deg)), math.radians(spec.slope_direction_deg)
    rise = (slope * math.cos(toward), slope * math.sin(toward)) if slope else (0.0, 0.0)
    heights = None if spec.height_map is None else heights_of(spec.height_map, faults)
    placed = SpatialBed(0.0, rise, tuple(_layers(scenario, faults)), heights)
    height = scenario.surface_height_m if spec.height_m is None else spec.height_m
    if height is None:
        height = min((_above(placed, body, part) for body in rigid for part in body.parts if part.in_sand), default=0.0)
    return SpatialBed(height, rise, placed.layers, heights)


def _above(placed: SpatialBed, body: SpatialRigidBody, part: Part) -> float:
    """How high (m) the lowest point of a part is above a surface."""
    x, y, z = body.motion.world(part.points).T
    return float((z - part.drop - placed.height(x, y)).min())


def _layers(scenario: schema.SpatialScenario, faults: list[Fault]) -> Iterator[Layer]:
    for key, one in keys_of_media(scenario).items():
        lacking = [
            scene_fault(
                f"{key}.{name}",
                f"got null: the source of {one.name} does not state it; give the number of your case, as "
                f"{{from: {one.name}, {name}: ...}}",
            )
            for name in one.lacking
        ]
        lacking += [
            scene_fault(f"{key}.{name}", f"got null, but in space {one.name} needs a number there")
            for name in one.lacking_in_space
        ]
        faults += lacking
        if not lacking:
            yield Layer(one)


def keys_of_media(scenario: schema.SpatialScenario) -> dict[str, Law]:
    """The media of a scenario by their keys."""
    several = isinstance(scenario.medium, tuple)
    return {f"medium.{i}" if several else "medium": one for i, one in enumerate(scenario.media)}
