"""Stage of a film in the plane: a view to scale that fills a picture, and the background of sky and sand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import to_rgb

from granular_contact.report.figures.outlines import edge
from granular_contact.report.figures.style import FLOOR, SAND, SAND_EDGE
from granular_contact.report.units import Array
from granular_contact.results import Results, Snapshot
from granular_contact.results.frames import surface_height, take_in

WIDTH, FLATTEST, TALLEST = 640, 0.53, 1.0  # px; height to width
HEADER, FOOTER, SIDE = 48, 42, 26  # margins without the mechanism (px)
LONGEST_ARROW = 0.25  # of the height
SKY, DEEP, LAYER = "#F6F8FA", "#D8C091", 0.9
SPECKS = (("#CDB27B", 0.03), ("#FBF3E0", 0.02), ("#B4975B", 0.012))  # colours of single grains, and their share


@dataclass(frozen=True)
class Stage:
    """View of a picture of `width` x `height` px: left and lower edge (m), and scale (px per m)."""

    left: float
    bottom: float
    scale: float
    width: int
    height: int

    @property
    def right(self) -> float:
        """Right edge (m)."""
        return self.left + self.width / self.scale

    @property
    def top(self) -> float:
        """Upper edge (m)."""
        return self.bottom + self.height / self.scale


def stage_of(results: Results, width: int = WIDTH, flattest: float = FLATTEST) -> Stage:
    """Stage that shows the mechanism and force arrows of all frames, the surface and some sand.

    width: px; flattest: least ratio of height to width.
    """
    low, high = bounds(results.frames)
    take_in(results.surface, low, high, 0.1)
    stage = _around(low, high, width, flattest)
    largest = strongest(results.frames)
    tips = [
        force.point + arrow_vector(force.force, largest, stage) for frame in results.frames for force in frame.forces
    ]
    if not tips:
        return stage
    return _around(np.min([low, *tips], axis=0), np.max([high, *tips], axis=0), width, flattest)


def bounds(frames: Sequence[Snapshot]) -> tuple[Array, Array]:
    """Lower left and upper right corner (2,) m of the outlines in all frames."""
    rings = [edge(outline) for frame in frames for outline in frame.outlines]
    low = np.min([ring.min(axis=0) for ring in rings], axis=0)
    high = np.max([ring.max(axis=0) for ring in rings], axis=0)
    return low, high


def _around(low: Array, high: Array, width: int, flattest: float) -> Stage:
    wide, tall = np.maximum(high - low, 1e-9)
    across = width - 2 * SIDE
    height = np.clip(across * tall / wide + HEADER + FOOTER, flattest * width, TALLEST * width)
    height = height // 2 * 2  # MP4 needs even numbers
    scale = min(across / wide, (height - HEADER - FOOTER) / tall)
    left = (low[0] + high[0]) / 2 - width / 2 / scale
    spare = height - HEADER - FOOTER - tall * scale  # px, a third of it for more sand
    bottom = low[1] - (FOOTER + spare / 3) / scale
    return Stage(float(left), float(bottom), float(scale), width, int(height))


def strongest(frames: Sequence[Snapshot]) -> float:
    """The largest force (N) in any frame."""
    return max((float(np.linalg.norm(force.force)) for frame in frames for force in frame.forces), default=0.0)


def arrow_vector(force: Array, largest: float, stage: Stage) -> Array:
    """Vector (2,) m of the arrow of a force (2,) N; largest: force (N) of the longest arrow."""
    return np.asarray(force * (LONGEST_ARROW * stage.height / stage.scale / largest))


def backdrop(stage: Stage, results: Results) -> Array:
    """Background (height, width, 3) from 0 to 1, upper row first: sky, sand and floor.

    The sand darkens downwards and with every layer.
    """
    picture = np.full((stage.height, stage.width, 3), to_rgb(SKY))
    if results.surface is None:
        return picture
    x = stage.left + (np.arange(stage.width) + 0.5) / stage.scale
    y = stage.top - (np.arange(stage.height) + 0.5) / stage.scale
    depth = (surface_height(results.surface, x)[None, :] - y[:, None]) * stage.scale  # px
    cover = np.clip(depth + 0.5, 0.0, 1.0)[:, :, None]
    edge_line = np.clip(1.6 - np.abs(depth - 0.8), 0.0, 1.0)[:, :, None]
    sand = _sand(depth, stage.height)
    sand = sand * (1 - edge_line) + np.array(to_rgb(SAND_EDGE)) * edge_line
    for top in results.layers:
        sand *= np.where(depth > top * stage.scale, LAYER, 1.0)[:, :, None]
    picture = picture * (1 - cover) + sand * cover
    if results.floor is not None:
        picture[(depth > 0.0) & (y < results.floor)[:, None]] = to_rgb(FLOOR)
    return picture


def _sand(depth: Array, height: int) -> Array:
    """Colour of the sand at depths (rows, columns) px, with randomly coloured grains."""
    share = np.clip(depth / (0.6 * height), 0.0, 1.0)[:, :, None]
    share = np.round(share * 10) / 10  # few colours, so that a GIF stays small
    picture = np.array(to_rgb(SAND)) * (1 - share) + np.array(to_rgb(DEEP)) * share
    dice = np.random.default_rng(7).random(depth.shape)
    begin = 0.0
    for colour, part in SPECKS:
        picture[(dice >= begin) & (dice < begin + part)] = to_rgb(colour)
        begin += part
    return np.asarray(picture)
