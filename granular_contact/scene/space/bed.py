"""Bed of a scene in space: a level or sloped surface or a map of heights, layers, floor and container.

A map of heights is read from a table or a picture.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from granular_contact.config.csv_table import number
from granular_contact.config.schema import space as schema
from granular_contact.config.schema.bed import STEEPEST
from granular_contact.errors import Fault, scene_fault
from granular_contact.laws.floor import Floor
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer
from granular_contact.sand.space.heights import Heights
from granular_contact.scene.bed import ROUND_OFF, faults_without_medium, layers_of, walls_of
from granular_contact.scene.space.types import Part, SpatialRigidBody

Vector = NDArray[np.float64]
STEEPEST_RISE = math.tan(math.radians(STEEPEST))
KEY = "bed.height_map.file"
PICTURES = (".png", ".tif", ".tiff", ".bmp", ".pgm", ".jpg", ".jpeg")
GREY = ("1", "L", "I", "F", "I;16", "I;16B", "I;16L")  # image modes of Pillow
MOST_REPORTED = 4  # reading of a table stops at the first fault after so many


def heights_of(spec: schema.HeightMap, faults: list[Fault]) -> Heights | None:
    """Map of heights from its file; None if it has faults, which are appended."""
    path, words = Path(spec.file), list[str]()
    try:
        values = _picture(path, words) if path.suffix.lower() in PICTURES else _table(path, words)
    except (OSError, UnicodeDecodeError) as error:
        words.append(f"got {path.name!r}, but {path} can't be read: {type(error).__name__}")
        values = np.zeros((0, 0))
    if not words and min(values.shape) < 2:
        words.append(f"{path}: got {len(values)} rows; allowed are 2 or more rows and columns")
    if words:
        faults += [scene_fault(KEY, sentence) for sentence in words]
        return None
    heights = Heights(spec.scale * values, spec.corner_m, spec.cell_m)
    if not heights.steepest < STEEPEST_RISE:
        steep = math.degrees(math.atan(heights.steepest))
        why = f"{path}: it rises by up to {steep:.3g} deg; allowed is less than {STEEPEST}: look at cell_m and scale"
        faults.append(scene_fault(KEY, why))
    return heights


def _picture(path: Path, faults: list[str]) -> Vector:
    """Grey levels (rows, columns) of a picture, bottom row first, as the upper edge has the greatest y."""
    from PIL import Image

    with Image.open(path) as image:
        if image.mode not in GREY:
            faults.append(f"{path}: the picture is of the kind {image.mode}; allowed is one of grey levels alone")
            return np.zeros((0, 0))
        if "transparency" in image.info:
            faults.append(f"{path}: the picture has places without a grey level; a map of heights has no holes")
        values = np.asarray(image, float)[::-1]
    if holes := int(np.sum(~np.isfinite(values))):
        faults.append(f"{path}: {holes} of {values.size} places hold no number; a map of heights has no holes")
    return np.ascontiguousarray(values)


def _table(path: Path, faults: list[str]) -> Vector:
    """Numbers (rows, columns) of a CSV file, separated by commas or semicolons, or by spaces as NumPy writes them."""
    rows: list[list[float]] = []
    for i, line in enumerate(path.read_text(encoding="utf-8-sig").splitlines(), 1):
        if not line.strip():
            continue
        line = line.replace(";", ",")
        cells = [number(cell.strip()) for cell in (line.split(",") if "," in line else line.split())]
        holes = [j for j, value in enumerate(cells, 1) if value is None]
        if holes:
            got = f"{path}:{i}: {len(holes)} of {len(cells)} columns hold no number, the first is {holes[0]}"
            faults.append(f"{got}; a map of heights has no holes: fill them")
        elif rows and len(cells) != len(rows[0]):
            faults.append(f"{path}:{i}: got {len(cells)} columns, but the rows before have {len(rows[0])}")
        else:
            rows.append([value for value in cells if value is not None])
        if len(faults) > MOST_REPORTED:
            break
    return np.array(rows) if rows else np.zeros((0, 0))


@dataclass(frozen=True)
class SpatialBed:
    """Bed of granular media in space.

    origin: height (m) of the surface at x = y = 0, or of the zero level of a map. rise: slopes along x and y.
    container: coordinates (m) of the two walls across x and of the two across y; None without these walls.
    """

    origin: float
    rise: tuple[float, float]
    layers: tuple[Layer, ...]
    heights: Heights | None = None
    floor: Floor | None = None
    container: tuple[tuple[float, float] | None, tuple[float, float] | None] = (None, None)

    @property
    def media(self) -> tuple[Law, ...]:
        """The media of all layers."""
        return tuple(layer.medium for layer in self.layers)

    @property
    def walls(self) -> list[tuple[str, int, float, float]]:
        """Walls of the container, as in `scene.bed.Bed`."""
        names = ("rear", "front"), ("right", "left")
        pairs = zip(names, (0, 1), self.container, strict=True)
        return [wall for both, axis, at in pairs if at is not None for wall in walls_of(both, axis, at)]

    @property
    def level(self) -> bool:
        """Whether the surface is level."""
        return self.rise == (0.0, 0.0) and self.heights is None

    def height(self, x: Vector, y: Vector) -> Vector:
        """Height of the surface (m) at x, y (m), arrays of any shape."""
        level: Vector = self.origin + self.rise[0] * np.asarray(x) + self.rise[1] * np.asarray(y)
        return level if self.heights is None else level + self.heights.at(x, y)

    def slope(self, x: Vector, y: Vector) -> tuple[Vector, Vector]:
        """Slope of the surface along x and along y, at x, y (m)."""
        return self.tangent(x, y)[1:]

    def tangent(self, x: Vector, y: Vector) -> tuple[Vector, Vector, Vector]:
        """Height of the surface (m), and its slope along x and along y, at x, y (m), arrays of any shape."""
        level: Vector = self.origin + self.rise[0] * np.asarray(x) + self.rise[1] * np.asarray(y)
        if self.heights is None:
            zeros = np.zeros_like(level)
            return level, zeros + self.rise[0], zeros + self.rise[1]
        height, along, across = self.heights.tangent(x, y)
        return level + height, along + self.rise[0], across + self.rise[1]

    def pieces(self) -> Iterator[tuple[float, float]]:
        """Slope (rise per length) and area (m2) of the cells of a map of heights."""
        yield from () if self.heights is None else self.heights.pieces()

    @property
    def corners(self) -> Vector:
        """Corners (k, 2) m, x and z, of the section of the surface at y = 0; its first and last pieces are endless."""
        x = np.array([0.0, 1.0])
        if self.heights is not None:
            x = self.heights.corner[0] + self.heights.cell * np.arange(-1, self.heights.values.shape[1] + 1)
        return np.column_stack([x, self.height(x, np.zeros_like(x))])


def bed_of(
    scenario: schema.SpatialScenario, rigid: tuple[SpatialRigidBody, ...], faults: list[Fault]
) -> SpatialBed | None:
    """Bed of a scenario; None without a medium and without a surface. Faults are appended."""
    spec = scenario.bed or schema.SpatialBed()
    if not scenario.media and scenario.surface_height_m is None and scenario.bed is None:
        return None
    walls = {"container_x_m": spec.container_x_m, "container_y_m": spec.container_y_m}
    faults += faults_without_medium(scenario, {"depth_m": spec.depth_m, **walls})
    slope, toward = math.tan(math.radians(spec.slope_deg)), math.radians(spec.slope_direction_deg)
    rise = (slope * math.cos(toward), slope * math.sin(toward)) if slope else (0.0, 0.0)
    heights = None if spec.height_map is None else heights_of(spec.height_map, faults)
    layers, container = tuple(layers_of(scenario, faults, in_space=True)), (spec.container_x_m, spec.container_y_m)
    bed = SpatialBed(0.0, rise, layers, heights, container=container)
    height = scenario.surface_height
    parts = [(body, part) for body in rigid for part in body.parts if part.in_sand]
    if height is None:
        height = min((_clearance(bed, body, part) for body, part in parts), default=0.0)
    bed = replace(bed, origin=height)
    if spec.depth_m is None:
        return bed
    contact = spec.floor
    contact_law = () if contact is None else (contact.stiffness_N_m3, contact.damping_s_m)
    floor = Floor(float(bed.height(np.zeros(1), np.zeros(1))[0]) - spec.depth_m, *contact_law)
    faults += _floor_faults(bed, floor, spec.depth_m, parts)
    return replace(bed, floor=floor)


def _floor_faults(
    bed: SpatialBed, floor: Floor, depth: float, parts: list[tuple[SpatialRigidBody, Part]]
) -> Iterator[Fault]:
    """Faults of a floor that is above the lowest height of a map, or above a part at the start."""
    why = f"got {depth:g} m, so the floor is at {floor.height:.6g} m, but "
    if bed.heights is not None and (low := bed.origin + float(bed.heights.values.min())) <= floor.height:
        words = f"{why}the map of heights goes down to {low:.6g} m: allowed is a floor below it"
        yield scene_fault("bed.depth_m", words)
    bottoms = (float((body.motion.world(part.points)[:, 2] - part.drop).min()) for body, part in parts)
    lowest = min(bottoms, default=math.inf)
    if lowest < floor.height - ROUND_OFF:
        words = f"{why}at the start the lowest point is at {lowest:.6g} m: allowed is a floor below it"
        yield scene_fault("bed.depth_m", words)


def _clearance(bed: SpatialBed, body: SpatialRigidBody, part: Part) -> float:
    """Least height (m) of a part above the surface, negative if it is below."""
    x, y, z = body.motion.world(part.points).T
    height, *slopes = bed.tangent(x, y)
    return float((z - part.reach(*slopes) - height).min())
