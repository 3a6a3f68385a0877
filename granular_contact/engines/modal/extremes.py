"""Rows of one or many runs -> extremes of their motion, and the times when they touch the medium."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.modal.kernels import modal_extremes as kernels
from granular_contact.engines.modal.kernels.modal_extremes import EXTREMES, LineExtremes
from granular_contact.engines.modal.model import Model
from granular_contact.results.limits import Reach
from granular_contact.results.observation import Known
from granular_contact.results.summary import Extremes
from granular_contact.scene.types import Vector


def known(models: Sequence[Model], first: NDArray[np.int64], table: Vector) -> list[Known]:
    """Extremes of the runs of models with equal array sizes, from their rows.

    first (runs + 1,): first row of each run; table (rows, from 1 + 2 m): time, coordinates and rates.
    """
    lines = _lines(models)
    count, most = len(lines.every), int(np.max(np.diff(lines.starts), initial=1))
    depths = np.full(len(table), -np.inf)
    extremes = np.full((len(models), count), np.array(LineExtremes(), EXTREMES))
    bends = np.zeros((len(models), 2, 2))
    kernels.find_extremes(first, table, models[0].size, lines, np.zeros((3, most, 2)), depths, extremes, bends)
    pieces = zip(first[:-1].tolist(), first[1:].tolist(), strict=True)
    several = zip(models, pieces, extremes.tolist(), bends.tolist(), strict=True)
    return [_known(model, depths[begin:end], *more) for model, (begin, end), *more in several]


def _lines(models: Sequence[Model]) -> kernels.Lines:
    """Bars, and other shapes in the sand, of runs whose lines have equal sizes."""
    like, count = models[0].lines, len(models)
    surface = np.array([np.nan if model.scene.surface is None else model.scene.surface for model in models])
    if all(model.lines is like for model in models):
        shared = like.points, like.beside, like.drop
        geometry, beside, drop = (np.repeat(array[None], count, axis=0) for array in shared)
    else:
        several = [model.lines for model in models]
        geometry = np.array([lines.points for lines in several])
        beside, drop = np.array([lines.beside for lines in several]), np.array([lines.drop for lines in several])
    return kernels.Lines(geometry, like.starts, like.every, surface, beside, drop)


def _known(model: Model, depth: Vector, extremes: list[tuple[float, ...]], bends: list[list[float]]) -> Known:
    (high, at), (low, then) = bends
    bend = ((high, at) if high >= low else (-low, then)) if model.bends else None
    lines = [LineExtremes(*numbers) for numbers in extremes]
    if not lines or model.scene.surface is None:
        return Known(None, Extremes(None, bend), None, None)
    deepest = max(lines, key=lambda line: line.greatest)
    touches = [line.touch for line in lines if not np.isnan(line.touch)]
    most = deepest.greatest, deepest.when
    touch = min(touches, default=None) if model.scene.media else None
    return Known(depth, Extremes(most, bend), touch, _reach(model, lines[: len(model.bars)]))


def _reach(model: Model, lines: list[LineExtremes]) -> Reach | None:
    """Extremes of the immersed parts; None if no part can meet the medium."""
    if not model.scene.media or not lines:
        return None
    pairs = zip(model.bars, lines, strict=True)
    return Reach(
        speed=max(line.speed for line in lines),
        depth=max(line.deepest for line in lines),
        lowest=min(line.lowest for line in lines),
        least=(min(line.left for line in lines),),
        greatest=(max(line.right for line in lines),),
        sizes=tuple(sorted({("round", bar.diameter) for bar, line in pairs if line.deepest > 0.0})),
    )
