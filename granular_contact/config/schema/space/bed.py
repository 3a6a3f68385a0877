"""Schema of the bed in space: its surface (level, sloped or a height map), its layers, floor and container."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_contact.config.schema.bed import DEPTH_OF_A_FLOOR, STEEPEST, BedLayer, layer_faults
from granular_contact.values.strict import Faults, Listed, NotNegative, Point, Positive, Strict, Text, likely_mistakes


class HeightMap(Strict):
    """Height map: heights of the surface at the points of a square grid, smooth between them, level beyond them."""

    file: Text
    """Path of the file with the heights, relative to the folder of the file with this key. A CSV file without a header
    has a row for each y, beginning at the corner, and a column for each x. A picture of grey levels (PNG, TIFF, ...)
    has the corner at its lower left."""
    cell_m: Positive
    """Distance between neighbouring points of the grid, along x and y."""
    corner_m: Point = (0.0, 0.0)
    """World x and y of the corner of the grid with the smallest x and y."""
    scale: float = 1.0
    """Height (m) of one unit of the file; in a picture of one grey level, of which there are 256, or 65536 with 16
    bits."""


class SpatialFloorContact(Strict):
    """Contact with the level floor: a spring and a damper per unit of area, force k delta (1 - d v_z).

    delta is the depth below the floor and v_z the vertical velocity. The floor never pulls, and has no friction.
    """

    model_config = likely_mistakes(
        stiffness_N_m2="is per length, for the plane; in space it is stiffness_N_m3, per area",
        height_m=DEPTH_OF_A_FLOOR,
    )

    stiffness_N_m3: Positive
    """Stiffness k per unit of area: of the surface of a body, of a bar over its diameter."""
    damping_s_m: NotNegative = 0.0
    """Damping factor d of the velocity; 0: no damping."""


class SpatialBed(Strict):
    """Position of the medium in space: free surface, layers, floor and container.

    The surface does not change during a run: no craters, no heaps.
    """

    model_config = likely_mistakes(
        profile_m="is for the plane; in space a surface is level, has slope_deg, or a height_map"
    )

    height_m: float | None = None
    """Height above the origin of the world of the surface at x = y = 0, or of the zero of the height map. null: the
    mechanism touches the surface at the start."""
    slope_deg: Annotated[float, Field(gt=-STEEPEST, lt=STEEPEST)] = 0.0
    """Slope of the surface."""
    slope_direction_deg: float = 0.0
    """Direction in which the surface rises, counter-clockwise from x seen from above: 0 is ahead, 90 is to the left."""
    height_map: HeightMap | None = None
    """Heights of the surface, in place of slope_deg. null: a level or sloped surface."""
    depth_m: Positive | None = None
    """Depth of the level floor below the surface at x = y = 0. null: no floor."""
    floor: SpatialFloorContact | None = None
    """Contact force of the floor, which needs depth_m. null: no force, but a warning when a body reaches the floor."""
    container_x_m: Point | None = None
    """x of the rear and the front wall. The walls exert no force; a body beyond them gives a warning. null: none."""
    container_y_m: Point | None = None
    """y of the right and the left wall. The walls exert no force; a body beyond them gives a warning. null: none."""
    layers: Annotated[tuple[BedLayer, ...], Listed] = ()
    """Layers below the medium of the run, from the highest to the deepest. The medium of the run lies on top. Depths
    are measured from the surface above each point, so the layers follow a slope and a height map."""

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
