"""Where the media lie: the free surface, layers, floor and container of a scene."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import schema
from granular_contact.errors import Fault, scene_fault
from granular_contact.geometry.surface import greatest_depth, height_at, pieces, slope_at, surface
from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.floor import Floor
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer

Vector = NDArray[np.float64]

ROUND_OFF = 1e-9  # a depth that is round-off (m)


@dataclass(frozen=True)
class Bed:
    """profile: corners (k, 2) m of the free surface, level beyond them, or one corner and a slope (-) without end;
    layers: none in vacuum; container: x of both walls (m).
    """

    profile: Vector
    slope: float
    layers: tuple[Layer, ...]
    floor: Floor | None = None
    container: tuple[float, float] | None = None

    @property
    def media(self) -> tuple[Law, ...]:
        """The media of all layers."""
        return tuple(layer.medium for layer in self.layers)

    @property
    def corners(self) -> Vector:
        """Corners (k, 2) m of the surface, its first and last pieces without end."""
        return surface(self.profile, self.slope)

    @property
    def walls(self) -> list[tuple[str, int, float, float]]:
        """Walls of the container: name, axis, place (m), and the sign of what lies beyond."""
        return [] if self.container is None else walls_of(("left", "right"), 0, self.container)

    @property
    def level(self) -> bool:
        """Whether the surface is level."""
        return len(self.profile) == 1 and self.slope == 0.0

    @property
    def plain(self) -> bool:
        """Whether it is level, of one medium and without a stiff floor."""
        carries = self.floor is not None and self.floor.stiffness is not None
        return self.level and len(self.layers) <= 1 and not carries

    def height(self, x: Vector) -> Vector:
        """Height of the surface (m) at x (m), any shape."""
        return height_at(self.corners, x)

    def greatest_depth(self, center: Vector, radius: float) -> float:
        """Greatest depth (m, negative above) below the surface of what is within a radius (m) of a place (2,) m."""
        return greatest_depth(self.corners, center, radius)

    def pieces(self) -> Iterator[tuple[float, float]]:
        """Rise per length, and length (m), of the pieces between the corners of a profile."""
        yield from pieces(self.profile)

    def slope_at(self, x: Vector) -> Vector:
        """Slope of the surface at x (m), any shape."""
        return slope_at(self.corners, x)


def bed(scenario: schema.Scenario, ends: Sequence[Vector], faults: list[Fault]) -> Bed | None:
    """Bed of a scene; None without a medium and without a surface.

    ends: world positions (2,) m of what may meet the medium, at the start; faults: gets those of media that lack a
    number, of layers, floors and containers where none are allowed, and of ends below the floor.
    """
    spec = scenario.bed or schema.Bed()
    if not scenario.media and scenario.surface_height_m is None and scenario.bed is None:
        return None
    faults += idle(scenario, {"depth_m": spec.depth_m, "container_x_m": spec.container_x_m})
    layers = tuple(layers_of(scenario, faults))
    if scenario.load.form == "resultant":
        faults += _resultant(scenario, layers)
    profile, slope = _profile(scenario, spec, ends), math.tan(math.radians(spec.slope_deg))
    placed = Bed(profile, slope, layers, container=spec.container_x_m)
    if spec.depth_m is None:
        return placed
    contact = spec.floor
    given = () if contact is None else (contact.stiffness_N_m2, contact.damping_s_m)
    floor = Floor(float(placed.height(np.zeros(1))[0]) - spec.depth_m, *given)
    if spec.profile_m is not None and profile[:, 1].min() <= floor.height:
        x, y = profile[np.argmin(profile[:, 1])]
        why = f"got {spec.depth_m:g} m, so the floor is at {floor.height:.6g} m, but the profile has the corner "
        faults.append(scene_fault("bed.depth_m", f"{why}[{x:g}, {y:g}]: allowed is a floor below all of it"))
    lowest = min((float(end[1]) for end in ends), default=math.inf)
    if lowest < floor.height - ROUND_OFF:
        faults.append(
            scene_fault(
                "bed.depth_m",
                f"got {spec.depth_m:g} m, so the floor is at {floor.height:.6g} m, but at the start the lowest end is "
                f"at {lowest:.6g} m: allowed is a floor below it",
            )
        )
    return replace(placed, floor=floor)


def walls_of(names: tuple[str, str], axis: int, places: tuple[float, float]) -> list[tuple[str, int, float, float]]:
    """Two walls across an axis at these places (m), see `Bed.walls`."""
    return [(name, axis, place, sign) for name, place, sign in zip(names, places, (-1.0, 1.0), strict=True)]


def idle(scenario: schema.Scenario, given: dict[str, Any]) -> Iterator[Fault]:
    """Floors and containers (by their keys) without a medium: only the load of a medium checks them."""
    if places(scenario):
        return
    bare = "{from: rft_generic, zeta: 1e-9}, or of spheres {law: bingham, yield_force_N: 0, viscosity_N_s_m: 0}"
    for key, value in given.items():
        if value is not None:
            what = "a floor" if key == "depth_m" else "a container"
            why = f"got {what}, but no medium, and a bed needs one; for one with almost no resistance take {bare}"
            yield scene_fault(f"bed.{key}", why)


def _resultant(scenario: schema.Scenario, layers: tuple[Layer, ...]) -> Iterator[Fault]:
    """Faults of what has no resultant at the middle of the immersed part."""
    if not all(layer.whole for layer in layers):
        yield scene_fault("load.form", "got resultant, but the bed has layers: allowed is distributed")
    scattering = next((key for one, key, *_ in places(scenario) if one.scatter is not None), None)
    if scattering is not None:
        yield scene_fault(
            f"{scattering}.scatter", "stands beside load.form: resultant, one force in all; allowed is null"
        )
    others = dict.fromkeys(one.law for one, *_ in places(scenario) if not one.resultant)
    if others:
        have = ", ".join(tag for tag, law in LAWS.items() if law.resultant)
        why = f"got resultant, but {', '.join(others)} has none; laws with one are {have}, else distributed is allowed"
        yield scene_fault("load.form", why)


def places(scenario: schema.Scenario) -> list[tuple[Law, str, float, float]]:
    """The media of a scenario with their keys, and the depths (m) that they lie between."""
    layers = () if scenario.bed is None else scenario.bed.layers
    bottoms = [*(layer.top_m for layer in layers), math.inf]
    several = isinstance(scenario.medium, tuple)
    return [
        *((one, f"medium.{i}" if several else "medium", 0.0, bottoms[0]) for i, one in enumerate(scenario.media)),
        *((one.medium, f"bed.layers.{i}.medium", one.top_m, bottoms[i + 1]) for i, one in enumerate(layers)),
    ]


def layers_of(scenario: schema.Scenario, faults: list[Fault], in_space: bool = False) -> Iterator[Layer]:
    """Layers of a scenario; faults gets media that lack a number; in_space: or one that is needed there."""
    for one, key, top, bottom in places(scenario):
        lacking = [
            scene_fault(
                f"{key}.{name}",
                f"got null: the source of {one.name} does not state it; give the number of your case, as "
                f"{{from: {one.name}, {name}: ...}}",
            )
            for name in one.lacking
        ]
        if in_space:
            lacking += [
                scene_fault(f"{key}.{name}", f"got null, but in space {one.name} needs a number there")
                for name in one.lacking_in_space
            ]
        faults += lacking
        if not lacking:
            yield Layer(one, top, bottom)


def _profile(scenario: schema.Scenario, spec: schema.Bed, ends: Sequence[Vector]) -> Vector:
    """Corners of the surface as given, or where it is at x = 0; without a height, as high as touches the lowest end."""
    if spec.profile_m is not None:
        return np.array(spec.profile_m)
    slope = math.tan(math.radians(spec.slope_deg))
    height = scenario.surface_height
    if height is None:
        height = min((float(y - slope * x) for x, y in ends), default=0.0)
    return np.array([[0.0, height]])
