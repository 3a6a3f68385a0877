"""Schema of the bed: its free surface, its floor, its container and its layers, each with a medium."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated

from pydantic import AfterValidator, Field

from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.law import Law
from granular_contact.values.strict import (
    Faults,
    Listed,
    LocalFault,
    NotNegative,
    OneOrMore,
    Point,
    Positive,
    Strict,
    Tagged,
    refusal,
)

Medium = Annotated[Law, Tagged("law", LAWS)]
Media = Annotated[tuple[Medium, ...], OneOrMore()]


STEEPEST = 60  # deg: depth is vertical, and says little of how far the surface is on steeper ground


def _rising(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    faults: list[LocalFault] = [
        ((i, 0), f"got x = {b[0]:g} after {a[0]:g}; x must rise from corner to corner")
        for i, (a, b) in enumerate(pairwise(points), 1)
        if not b[0] > a[0]
    ]
    slopes = [] if faults else [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(points)]
    faults += [
        (
            (i,),
            f"got {math.degrees(slope):.4g} deg up to this corner; allowed is less than {STEEPEST}, up or down",
        )
        for i, slope in enumerate(slopes, 1)
        if abs(slope) >= math.radians(STEEPEST)
    ]
    if faults:
        raise refusal(faults)
    return points


class FloorContact(Strict):
    """Spring and damper per unit of length against a level floor: k delta (1 - d v_y), never pulling."""

    stiffness_N_m2: Positive
    """k; on a ball it acts over the diameter."""
    damping_s_m: NotNegative = 0.0
    """d."""


class BedLayer(Strict):
    """A medium from a depth downward, to the next layer or to the ground."""

    top_m: Positive
    """Depth below the free surface."""
    medium: Medium


class Bed(Strict):
    """Where the medium lies. Its free surface does not change: no craters, no heaps."""

    height_m: float | None = None
    """Height of the surface above the ground joint at x = 0; null: so that the mechanism touches it at the start."""
    slope_deg: Annotated[float, Field(gt=-STEEPEST, lt=STEEPEST)] = 0.0
    """The surface rises to the right by this angle."""
    profile_m: Annotated[tuple[Point, ...], Listed, Field(min_length=2), AfterValidator(_rising)] | None = None
    """Corners x, y of the surface in place of height and slope, less than 60 degrees steep; level beyond them."""
    depth_m: Positive | None = None
    """Of the level floor below the surface at x = 0; null: none."""
    floor: FloorContact | None = None
    """null: a warning when the floor is reached, but no force."""
    container_x_m: Point | None = None
    """Left and right wall; a body beyond them gives a warning, but the walls exert no force."""
    layers: Annotated[tuple[BedLayer, ...], Listed] = ()
    """Below the medium of the scenario, which then lies on top, from the highest to the deepest."""

    def _faults(self) -> Faults:
        if self.profile_m is not None and (self.height_m is not None or self.slope_deg != 0.0):
            yield ("profile_m",), "got a profile and height_m or slope_deg; one of the two is allowed"
        if self.floor is not None and self.depth_m is None:
            yield ("floor",), "a stiff floor needs depth_m"
        if self.container_x_m is not None and not self.container_x_m[0] < self.container_x_m[1]:
            yield ("container_x_m",), f"got {list(self.container_x_m)}; the first must be left of the second"
        level = self.profile_m is None and self.slope_deg == 0.0
        yield from layer_faults(self.layers, self.depth_m if level else None)


def layer_faults(layers: tuple[BedLayer, ...], floor: float | None) -> list[LocalFault]:
    """Layers that do not follow one another downward, or lie below a floor at this depth (m)."""
    tops = [layer.top_m for layer in layers]
    faults: list[LocalFault] = [
        (("layers", i + 1, "top_m"), f"got {below:g}, which is not below the layer above it, {above:g}")
        for i, (above, below) in enumerate(pairwise(tops))
        if not below > above
    ]
    faults += [
        (("layers", i, "top_m"), f"got {top:g}, but the floor is at {floor:g}; allowed is above it")
        for i, top in enumerate(tops)
        if floor is not None and top >= floor
    ]
    return faults
