"""Schema of the bed in the plane: its free surface, its floor, its container, and its layers with their media."""

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
    likely_mistakes,
    refusal,
)

Medium = Annotated[Law, Tagged("law", LAWS)]
Media = Annotated[tuple[Medium, ...], OneOrMore()]


DEPTH_OF_A_FLOOR = "a floor has a depth below the surface, and no height: depth_m, beside floor"
STEEPEST = 60  # deg: depth is measured vertically; on steeper ground it differs much from the distance to the surface


def _rising(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    """Refuse a profile whose x does not increase, or that is too steep; return it unchanged otherwise."""
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
    """Contact with the level floor: a spring and a damper per unit of length, force k delta (1 - d v_y).

    delta is the depth below the floor and v_y the vertical velocity. The floor never pulls, and has no friction.
    """

    model_config = likely_mistakes(height_m=DEPTH_OF_A_FLOOR)

    stiffness_N_m2: Positive
    """Stiffness k per unit of length; for a ball per unit of its diameter."""
    damping_s_m: NotNegative = 0.0
    """Damping factor d of the velocity; 0: no damping."""


class BedLayer(Strict):
    """A layer: a medium from a depth down to the next layer, or without end."""

    model_config = likely_mistakes(**dict.fromkeys(("depth_m", "height_m"), "a layer has the depth of its top, top_m"))

    top_m: Positive
    """Depth of the top of the layer below the free surface."""
    medium: Medium
    """Medium of the layer: a name, a path, or a mapping."""


class Bed(Strict):
    """Position of the medium: free surface, layers, floor and container.

    The surface does not change during a run: no craters, no heaps.
    """

    height_m: float | None = None
    """Height of the surface at x = 0, above the origin of the world. null: the mechanism touches the surface at the
    start."""
    slope_deg: Annotated[float, Field(gt=-STEEPEST, lt=STEEPEST)] = 0.0
    """Slope of the surface; with a positive slope it rises to the right."""
    profile_m: Annotated[tuple[Point, ...], Listed, Field(min_length=2), AfterValidator(_rising)] | None = None
    """Corners x, y of the surface in the world, from left to right, in place of height_m and slope_deg. Less than 60
    degrees steep; the surface is level beyond the first and the last corner. null: a straight surface."""
    depth_m: Positive | None = None
    """Depth of the level floor below the surface at x = 0. null: no floor."""
    floor: FloorContact | None = None
    """Contact force of the floor, which needs depth_m. null: no force, but a warning when a body reaches the floor."""
    container_x_m: Point | None = None
    """x of the left and the right wall. The walls exert no force; a body beyond them gives a warning. null: none."""
    layers: Annotated[tuple[BedLayer, ...], Listed] = ()
    """Layers below the medium of the run, from the highest to the deepest. The medium of the run lies on top."""

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
    """Faults of layers that are not in order of depth, or that begin below the floor.

    floor: depth (m) of the floor below the surface; None if there is none, or if it is not parallel to the surface.
    """
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
