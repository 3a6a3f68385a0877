"""A map of heights from its file, a table or a picture."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from granular_contact.config.csv_table import number
from granular_contact.config.schema import space as schema
from granular_contact.config.schema.bed import STEEPEST
from granular_contact.errors import Fault, scene_fault
from granular_contact.sand.space.heights import Heights

Vector = NDArray[np.float64]
STEEPEST_RISE = math.tan(math.radians(STEEPEST))
KEY = "bed.height_map.file"
PICTURES = (".png", ".tif", ".tiff", ".bmp", ".pgm", ".jpg", ".jpeg")
GREY = ("1", "L", "I", "F", "I;16", "I;16B", "I;16L")  # modes of Pillow
MOST_REPORTED = 4  # lines of a table that are reported


def heights_of(spec: schema.HeightMap, faults: list[Fault]) -> Heights | None:
    """Heights of a file; None, with faults."""
    path, words = Path(spec.file), list[str]()
    try:
        values = _picture(path, words) if path.suffix.lower() in PICTURES else _table(path, words)
    except (OSError, UnicodeDecodeError) as error:
        words.append(f"got {path.name!r}, but {path} can't be read: {type(error).__name__}")
        values = np.zeros((0, 0))
    if not words and min(values.shape) < 2:
        words.append(f"{path}: got {len(values)} rows; allowed are 2 or more rows and columns")
    if words:
        faults += [scene_fault(KEY, one) for one in words]
        return None
    heights = Heights(spec.scale * values, spec.corner_m, spec.cell_m)
    if not heights.steepest < STEEPEST_RISE:
        steep = math.degrees(math.atan(heights.steepest))
        why = f"{path}: it rises by up to {steep:.3g} deg; allowed is less than {STEEPEST}: look at cell_m and scale"
        faults.append(scene_fault(KEY, why))
    return heights


def _picture(path: Path, faults: list[str]) -> Vector:
    """Grey levels (rows upward, columns) of a picture, whose upper edge is farthest to the left in the world."""
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
    """Numbers (rows, columns) of a CSV file."""
    rows: list[list[float]] = []
    for i, line in enumerate(path.read_text(encoding="utf-8-sig").splitlines(), 1):
        if not line.strip():
            continue
        cells = [number(cell.strip()) for cell in line.replace(";", ",").split(",")]
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
