"""Bed of a scene: free surface, layers, floor and container."""

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

ROUND_OFF = 1e-9  # m: depths below this are round-off


@dataclass(frozen=True)
class Bed:
    """Bed of granular media in the plane.

    profile: corners (k, 2) m of the free surface, level beyond them, or one corner with an endless slope (rise per
    length). layers: from the top, none in vacuum. container: x of both walls (m).
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
        """Corners (k, 2) m of the surface; the first and the last piece are endless."""
        return surface(self.profile, self.slope)

    @property
    def walls(self) -> list[tuple[str, int, float, float]]:
        """Walls of the container: name, axis, coordinate (m) along it, and sign of the outward direction."""
        return [] if self.container is None else walls_of(("left", "right"), 0, self.container)

    @property
    def level(self) -> bool:
        """Whether the surface is level."""
        return len(self.profile) == 1 and self.slope == 0.0

    @property
    def plain(self) -> bool:
        """Whether the bed is level, with at most one medium and without a floor that carries."""
        floor_carries = self.floor is not None and self.floor.stiffness is not None
        return self.level and len(self.layers) <= 1 and not floor_carries

    def height(self, x: Vector) -> Vector:
        """Height of the surface (m) at x (m), any shape."""
        return height_at(self.corners, x)

    def greatest_depth(self, center: Vector, radius: float) -> float:
        """Greatest depth (m, negative above the surface) of points within a radius (m) of a centre (2,) m."""
        return greatest_depth(self.corners, center, radius)

    def pieces(self) -> Iterator[tuple[float, float]]:
        """Slope (rise per length) and length (m) of the pieces between the corners of a profile."""
        yield from pieces(self.profile)

    def slope_at(self, x: Vector) -> Vector:
        """Slope of the surface at x (m), any shape."""
        return slope_at(self.corners, x)


def bed_of(scenario: schema.Scenario, ends: Sequence[Vector], faults: list[Fault]) -> Bed | None:
    """Bed of a scenario; None without a medium and without a surface.

    ends: initial world positions (2,) m of the lowest points of parts that the medium may act on. Faults are appended:
    of media that lack a number, of layers, floors and containers where they are not allowed, and of ends below the
    floor.
    """
    spec = scenario.bed or schema.Bed()
    if not scenario.media and scenario.surface_height_m is None and scenario.bed is None:
        return None
    faults += faults_without_medium(scenario, {"depth_m": spec.depth_m, "container_x_m": spec.container_x_m})
    layers = tuple(layers_of(scenario, faults))
    if scenario.load.form == "resultant":
        faults += _resultant_faults(scenario, layers)
    profile, slope = _profile(scenario, spec, ends), math.tan(math.radians(spec.slope_deg))
    bed = Bed(profile, slope, layers, container=spec.container_x_m)
    if spec.depth_m is None:
        return bed
    contact = spec.floor
    contact_law = () if contact is None else (contact.stiffness_N_m2, contact.damping_s_m)
    floor = Floor(float(bed.height(np.zeros(1))[0]) - spec.depth_m, *contact_law)
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
    return replace(bed, floor=floor)


def walls_of(
    names: tuple[str, str], axis: int, coordinates: tuple[float, float]
) -> list[tuple[str, int, float, float]]:
    """Two walls across an axis at these coordinates (m), see `Bed.walls`."""
    return [
        (name, axis, coordinate, sign) for name, coordinate, sign in zip(names, coordinates, (-1.0, 1.0), strict=True)
    ]


def faults_without_medium(scenario: schema.Scenario, given: dict[str, Any]) -> Iterator[Fault]:
    """Faults of a floor or container (given, by key) without a medium, as only the load of a medium uses them."""
    if media_layers(scenario):
        return
    bare = "{from: rft_generic, zeta: 1e-9}, or of spheres {law: bingham, yield_force_N: 0, viscosity_N_s_m: 0}"
    for key, value in given.items():
        if value is not None:
            got = "a floor" if key == "depth_m" else "a container"
            why = f"got {got}, but no medium, and a bed needs one; a medium with almost no resistance is {bare}"
            yield scene_fault(f"bed.{key}", why)


def _resultant_faults(scenario: schema.Scenario, layers: tuple[Layer, ...]) -> Iterator[Fault]:
    """Faults of layers, scatter and laws that do not go with `load.form: resultant`."""
    if not all(layer.whole for layer in layers):
        yield scene_fault("load.form", "got resultant, but the bed has layers: allowed is distributed")
    scattering = next((key for medium, key, *_ in media_layers(scenario) if medium.scatter is not None), None)
    if scattering is not None:
        yield scene_fault(
            f"{scattering}.scatter", "stands beside load.form: resultant, which is a single force; allowed is null"
        )
    without = dict.fromkeys(medium.law for medium, *_ in media_layers(scenario) if not medium.resultant)
    if without:
        laws = ", ".join(tag for tag, law in LAWS.items() if law.resultant)
        why = f"got resultant, but {', '.join(without)} has none; laws with one are {laws}, else distributed is allowed"
        yield scene_fault("load.form", why)


def media_layers(scenario: schema.Scenario) -> list[tuple[Law, str, float, float]]:
    """The media of a scenario, each with its key of the config and the depths (m) of its top and its bottom."""
    layers = () if scenario.bed is None else scenario.bed.layers
    bottoms = [*(layer.top_m for layer in layers), math.inf]
    several = isinstance(scenario.medium, tuple)
    return [
        *((medium, f"medium.{i}" if several else "medium", 0.0, bottoms[0]) for i, medium in enumerate(scenario.media)),
        *((layer.medium, f"bed.layers.{i}.medium", layer.top_m, bottoms[i + 1]) for i, layer in enumerate(layers)),
    ]


def layers_of(scenario: schema.Scenario, faults: list[Fault], in_space: bool = False) -> Iterator[Layer]:
    """Layers of a scenario, without media that lack a number; their faults are appended.

    in_space: check also the numbers that media need only in space.
    """
    for medium, key, top, bottom in media_layers(scenario):
        lacking = [
            scene_fault(
                f"{key}.{name}",
                f"got null: the source of {medium.name} does not state it; give the number of your case, as "
                f"{{from: {medium.name}, {name}: ...}}",
            )
            for name in medium.lacking
        ]
        if in_space:
            lacking += [
                scene_fault(f"{key}.{name}", f"got null, but in space {medium.name} needs a number there")
                for name in medium.lacking_in_space
            ]
        faults += lacking
        if not lacking:
            yield Layer(medium, top, bottom)


def _profile(scenario: schema.Scenario, spec: schema.Bed, ends: Sequence[Vector]) -> Vector:
    """Corners (k, 2) m of the surface: those of the config, or one at x = 0.

    Without a height in the config, the surface touches the lowest end.
    """
    if spec.profile_m is not None:
        return np.array(spec.profile_m)
    slope = math.tan(math.radians(spec.slope_deg))
    height = scenario.surface_height
    if height is None:
        height = min((float(y - slope * x) for x, y in ends), default=0.0)
    return np.array([[0.0, height]])
