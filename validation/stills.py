"""Pictures of several instants of a run side by side, for the gallery.

The mechanism is drawn as in an animation: in the plane by `report.figures.animation`, in space by
`report.figures.rendering`, which needs the extra `render`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from granular_contact.report.figures.animation import Film, Picture, time_text
from granular_contact.report.figures.film import palette
from granular_contact.report.figures.rendering import Stage
from granular_contact.report.figures.stage import bounds, stage_of
from granular_contact.report.figures.style import INK
from granular_contact.results import Results, Snapshot

GAP = 8  # px


def write_strip(results: Results, file: Path, count: int = 4, width: int = 1200) -> None:
    """Write pictures of `count` instants of `results`, which must have frames, into one PNG of few colours.

    Raises
    ------
    OSError
        The file can't be written.
    """
    in_space = results.motion is not None and results.motion.in_space
    picture = (strip_in_space if in_space else strip)(results, count, width)
    image = Image.fromarray(picture).quantize(palette=palette([picture]), dither=Image.Dither.NONE)
    image.save(file, optimize=True)


def strip(results: Results, count: int, width: int) -> Picture:
    """Picture of `count` (even) frames, about `width` px wide, with two frames in a row, or one if the stage is wide.

    The mechanism moves equally far between the frames; so the times between them differ in general.
    """
    low, high = bounds(results.frames)
    ratio = float(np.divide(*np.maximum(high - low, 1e-9)))
    in_row = 2 if ratio < 9.0 else 1
    stage = stage_of(results, width // in_row, 0.6 if ratio < 2.0 else 0.2)
    pictures = list(Film(results, stage, texts=False).pictures(evenly_moved(results.frames, count)))
    rows = [_joined(pictures[i : i + in_row], axis=1) for i in range(0, count, in_row)]
    return _joined(rows, axis=0)


def strip_in_space(results: Results, count: int, width: int) -> Picture:
    """Picture of `count` (even) instants of a run in space, evenly spaced in time, two in a row."""
    assert results.motion is not None
    stage = Stage(results.motion, (width - GAP) // 2, round(0.28 * width))
    instants = np.linspace(0, len(results.motion.time) - 1, count).round().astype(int)
    lasts = float(results.motion.time[-1])
    pictures = [_at(stage.picture(int(k)), time_text(float(results.motion.time[k]), lasts)) for k in instants]
    stage.close()
    return _joined([_joined(pictures[i : i + 2], axis=1) for i in range(0, count, 2)], axis=0)


def _at(picture: Picture, clock: str) -> Picture:
    """Picture with its time, as in the plane."""
    image = Image.fromarray(picture)
    font = ImageFont.truetype(Path(matplotlib.get_data_path()) / "fonts/ttf/DejaVuSans-Bold.ttf", 14)
    ImageDraw.Draw(image).text((picture.shape[1] / 2, 8), clock, INK, font, "ma")
    return np.asarray(image)


def _joined(pictures: list[Picture], axis: int) -> Picture:
    """Join pictures beside each other (axis 1) or under each other (axis 0), with gaps between them."""
    height, width, _ = pictures[0].shape
    gap = np.full((height, GAP, 3) if axis else (GAP, width, 3), 255, np.uint8)
    return np.concatenate([part for picture in pictures for part in (gap, picture)][1:], axis=axis)


def evenly_moved(frames: Sequence[Snapshot], count: int) -> list[Snapshot]:
    """Select `count` frames between which the mechanism moves about equally far, near large forces."""
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
