"""Schema of the bed in space: level, sloped in any direction, or a map of heights."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from granular_contact.config.schema.bed import STEEPEST
from granular_contact.values.strict import LocalFault, Point, Positive, Strict, Text, refusal


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


IN_THE_PLANE = ("layers", "depth_m", "floor", "container_x_m", "profile_m")


class SpatialBed(Strict):
    """Where the medium lies in space. Its free surface does not change: no craters, no heaps."""

    height_m: float | None = None
    """Height of the surface above the world's origin, or of the zero of a height map; null: so that the mechanism
    touches it at the start."""
    slope_deg: Annotated[float, Field(gt=-STEEPEST, lt=STEEPEST)] = 0.0
    slope_direction_deg: float = 0.0
    """Direction in which the surface rises: counter-clockwise from x, seen from above; 90 is to the left."""
    height_map: HeightMap | None = None

    @model_validator(mode="before")
    @classmethod
    def _fills_the_bed(cls, given: Any) -> Any:
        words = "is for the plane; in space a medium fills the whole bed below its surface, without floor or walls"
        if found := [key for key in IN_THE_PLANE if isinstance(given, dict) and given.get(key) is not None]:
            raise refusal([((key,), words) for key in found])
        return given

    @model_validator(mode="after")
    def _fits_together(self) -> SpatialBed:
        faults: list[LocalFault] = []
        if self.height_map is not None and self.slope_deg != 0.0:
            faults.append((("height_map",), "got a height map and slope_deg; one of the two is allowed"))
        if faults:
            raise refusal(faults)
        return self
