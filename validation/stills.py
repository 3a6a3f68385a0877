"""Instants of a run side by side in one small picture, for the gallery.

The mechanism as in an animation: in the plane by `report.figures.animation`, in space by `report.figures.rendering`,
which needs the extra `render`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from granular_contact.report.figures.animation import Film, Picture, time_words
from granular_contact.report.figures.film import palette
from granular_contact.report.figures.rendering import Stage
from granular_contact.report.figures.stage import bounds, stage_of
from granular_contact.report.figures.style import INK
from granular_contact.results import Results, Snapshot

GAP = 8  # px


def write_strip(results: Results, file: Path, count: int = 4, width: int = 1200) -> None:
    """Write some instants of `results`, which has frames, into one PNG of few colours.

    Raises
    ------
    OSError
        The disk refuses.
    """
    in_space = results.motion is not None and results.motion.in_space
    picture = (strip_in_space if in_space else strip)(results, count, width)
    shown = Image.fromarray(picture).quantize(palette=palette([picture]), dither=Image.Dither.NONE)
    shown.save(file, optimize=True)


def strip(results: Results, count: int, width: int) -> Picture:
    """Pictures of `count` (even) frames as one, about so many px wide; two in a row, or one where the stage is wide.

    From each to the next the mechanism moves equally far, which seldom takes equally long.
    """
    low, high = bounds(results.frames)
    ratio = float(np.divide(*np.maximum(high - low, 1e-9)))
    in_row = 2 if ratio < 9.0 else 1
    stage = stage_of(results, width // in_row, 0.6 if ratio < 2.0 else 0.2)
    shown = list(Film(results, stage, words=False).pictures(evenly_moved(results.frames, count)))
    rows = [_joined(shown[i : i + in_row], axis=1) for i in range(0, count, in_row)]
    return _joined(rows, axis=0)


def strip_in_space(results: Results, count: int, width: int) -> Picture:
    """Pictures of `count` (even) instants of a run in space, evenly spaced, two in a row."""
    assert results.motion is not None
    stage = Stage(results.motion, (width - GAP) // 2, round(0.28 * width))
    instants = np.linspace(0, len(results.motion.time) - 1, count).round().astype(int)
    lasts = float(results.motion.time[-1])
    shown = [_at(stage.picture(int(k)), time_words(float(results.motion.time[k]), lasts)) for k in instants]
    stage.close()
    return _joined([_joined(shown[i : i + 2], axis=1) for i in range(0, count, 2)], axis=0)


def _at(picture: Picture, clock: str) -> Picture:
    """A picture with its time, as those of the plane have it."""
    image = Image.fromarray(picture)
    font = ImageFont.truetype(Path(matplotlib.get_data_path()) / "fonts/ttf/DejaVuSans-Bold.ttf", 14)
    ImageDraw.Draw(image).text((picture.shape[1] / 2, 8), clock, INK, font, "ma")
    return np.asarray(image)


def _joined(shown: list[Picture], axis: int) -> Picture:
    """Pictures beside (1) or under each other (0), with gaps between them."""
    height, width, _ = shown[0].shape
    gap = np.full((height, GAP, 3) if axis else (GAP, width, 3), 255, np.uint8)
    return np.concatenate([part for one in shown for part in (gap, one)][1:], axis=axis)


def evenly_moved(frames: Sequence[Snapshot], count: int) -> list[Snapshot]:
    """Frames between which the mechanism moves about equally far, chosen near large forces."""
    points = np.array([np.concatenate([outline.points for outline in frame.outlines]) for frame in frames])
    steps = np.linalg.norm(np.diff(points, axis=0), axis=2).max(axis=1)
    path = np.concatenate([[0.0], np.cumsum(steps)])
    push = np.array([sum(float(np.linalg.norm(force.force)) for force in frame.forces) for frame in frames])
    share = path[-1] / (count - 1)
    picked = [0]
    for k in range(1, count - 1):
        near = np.flatnonzero(np.abs(path - k * share) <= share / 4)
        closest = int(np.argmin(np.abs(path - k * share)))
        picked.append(int(near[np.argmax(push[near])]) if push[near].any() else closest)
    return [frames[i] for i in (*picked, len(frames) - 1)]
