"""The stage of an animation: a view to scale that fills a picture, with sand under its surface, in pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import to_rgb

from granular_contact.plots.outlines import edge
from granular_contact.plots.style import SAND, SAND_EDGE
from granular_contact.plots.units import Array
from granular_contact.results import Results, Snapshot

WIDTH, LEAST_HEIGHT, MOST_HEIGHT = 640, 340, 640  # px
HEADER, FOOTER, SIDE = 48, 42, 26  # px kept free of the mechanism
SKY, DEEP = "#F6F8FA", "#D8C091"
SPECKS = (("#CDB27B", 0.055), ("#FBF3E0", 0.04), ("#B4975B", 0.02))  # colours of single grains, and their share


@dataclass(frozen=True)
class Stage:
    """What a picture of `width` x `height` px shows: from left and bottom (m) on, at so many px per m."""

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


def stage_of(results: Results) -> Stage:
    """The stage that holds the mechanism in all frames, the surface and some sand."""
    low, high = _bounds(results.frames)
    if results.surface is not None:
        size = float(np.max(high - low))
        if results.surface > low[1] - 2 * size:
            low[1] = min(low[1], results.surface - 0.1 * size)
            high[1] = max(high[1], results.surface)
    wide, high_ = np.maximum(high - low, 1e-9)
    across = WIDTH - 2 * SIDE
    height = int(np.clip(across * high_ / wide + HEADER + FOOTER, LEAST_HEIGHT, MOST_HEIGHT)) // 2 * 2  # MP4 needs even
    scale = min(across / wide, (height - HEADER - FOOTER) / high_)
    middle = (low + high) / 2
    left = middle[0] - WIDTH / 2 / scale
    bottom = middle[1] - (height + FOOTER - HEADER) / 2 / scale
    return Stage(float(left), float(bottom), float(scale), WIDTH, height)


def _bounds(frames: Sequence[Snapshot]) -> tuple[Array, Array]:
    rings = [edge(outline) for frame in frames for outline in frame.outlines]
    low = np.min([ring.min(axis=0) for ring in rings], axis=0)
    high = np.max([ring.max(axis=0) for ring in rings], axis=0)
    return low, high


def backdrop(stage: Stage, surface: float | None) -> Array:
    """Sky, and under the surface sand that darkens downwards: (height, width, 3) from 0 to 1, the upper row first."""
    picture = np.full((stage.height, stage.width, 3), to_rgb(SKY))
    if surface is None:
        return picture
    y = stage.top - (np.arange(stage.height) + 0.5) / stage.scale
    depth = np.broadcast_to((surface - y)[:, None] * stage.scale, picture.shape[:2])  # px
    cover = np.clip(depth + 0.5, 0.0, 1.0)[:, :, None]
    edge_line = np.clip(1.6 - np.abs(depth - 0.8), 0.0, 1.0)[:, :, None]
    sand = _sand(depth, stage.height)
    sand = sand * (1 - edge_line) + np.array(to_rgb(SAND_EDGE)) * edge_line
    return np.asarray(picture * (1 - cover) + sand * cover)


def _sand(depth: Array, height: int) -> Array:
    """Colour of the sand at depths (rows, columns) px, with grains strewn in it."""
    share = np.clip(depth / (0.6 * height), 0.0, 1.0)[:, :, None]
    share = np.round(share * 10) / 10  # few colours, so that a GIF stays small
    picture = np.array(to_rgb(SAND)) * (1 - share) + np.array(to_rgb(DEEP)) * share
    dice = np.random.default_rng(7).random(depth.shape)
    begin = 0.0
    for colour, part in SPECKS:
        picture[(dice >= begin) & (dice < begin + part)] = to_rgb(colour)
        begin += part
    return np.asarray(picture)
