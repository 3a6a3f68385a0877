"""Schema of the bed in space: its surface (level, sloped or a map of heights), its layers, floor and container."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from granular_contact.config.schema.bed import STEEPEST, BedLayer, layer_faults
from granular_contact.values.strict import Faults, Listed, NotNegative, Point, Positive, Strict, Text, refusal


class HeightMap(Strict):
    """Heights of the surface at the points of a square grid; smooth between them, level beyond them."""

    file: Text
    """CSV without a header: a row for each y, upward from the corner, a column for each x; or a picture of grey levels
    (PNG, TIFF, ...), whose lower left is the corner. A path from the folder of the file that names it."""
    cell_m: Positive
    """Distance of neighbours."""
    corner_m: Point = (0.0, 0.0)
    """x and y of the first column and row."""
    scale: float = 1.0
    """Height in m of one unit of the file, of a picture of one grey level (there are 256, or 65536 of 16 bits)."""


IN_THE_PLANE = {
    ("profile_m",): "is for the plane; in space a surface is level, has slope_deg, or a height_map",
    ("floor", "stiffness_N_m2"): "is per length, for the plane; in space it is stiffness_N_m3, per area",
}


class SpatialFloorContact(Strict):
    """Spring and damper per unit of area against a level floor: k delta (1 - d v_z), never pulling, no friction."""

    stiffness_N_m3: Positive
    """k, of every point of a surface; on a bar over its diameter, on a sphere over its surface."""
    damping_s_m: NotNegative = 0.0
    """d."""


class SpatialBed(Strict):
    """Where the medium lies in space. Its free surface does not change: no craters, no heaps."""

    height_m: float | None = None
    """Height of the surface above the world's origin, or of the zero of a height map; null: so that the mechanism
    touches it at the start."""
    slope_deg: Annotated[float, Field(gt=-STEEPEST, lt=STEEPEST)] = 0.0
    slope_direction_deg: float = 0.0
    """Direction in which the surface rises: counter-clockwise from x, seen from above; 90 is to the left."""
    height_map: HeightMap | None = None
    depth_m: Positive | None = None
    """Of the level floor below the surface at x = y = 0; null: none."""
    floor: SpatialFloorContact | None = None
    """null: a warning when the floor is reached, but no force."""
    container_x_m: Point | None = None
    """x of the walls behind and ahead; a body beyond them gives a warning, but the walls exert no force."""
    container_y_m: Point | None = None
    """y of the walls to the right and to the left, likewise."""
    layers: Annotated[tuple[BedLayer, ...], Listed] = ()
    """Below the medium of the scenario, which then lies on top, from the highest to the deepest; their tops are so deep
    below the surface at each place: they follow a slope and a map of heights."""

    @model_validator(mode="before")
    @classmethod
    def _is_in_space(cls, given: Any) -> Any:
        if found := [(path, words) for path, words in IN_THE_PLANE.items() if _stands(given, path)]:
            raise refusal(found)
        return given

    def _faults(self) -> Faults:
        if self.floor is not None and self.depth_m is None:
            yield ("floor",), "a stiff floor needs depth_m"
        for key, walls in (("container_x_m", self.container_x_m), ("container_y_m", self.container_y_m)):
            if walls is not None and not walls[0] < walls[1]:
                yield (key,), f"got {list(walls)}; the first must be less than the second"
        level = self.height_map is None and self.slope_deg == 0.0
        yield from layer_faults(self.layers, self.depth_m if level else None)
        if self.height_map is not None and self.slope_deg != 0.0:
            yield ("height_map",), "got a height map and slope_deg; one of the two is allowed"


def _stands(given: Any, path: tuple[str, ...]) -> bool:
    """Whether there is a value under nested keys."""
    for key in path:
        if not isinstance(given, dict) or given.get(key) is None:
            return False
        given = given[key]
    return True
