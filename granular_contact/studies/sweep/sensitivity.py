"""Rows of a Saltelli design -> Sobol indices: the share of the variance of an output that each input explains. First
order: alone. Total: with all interactions. By scipy.stats.sobol_indices (Saltelli et al. 2010), with the inputs
independent and even over their ranges; intervals by a bootstrap over the points of the design.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import Sweep
from granular_contact.report import FIGURES, SENSITIVITY, write_table
from granular_contact.report.units import is_number
from granular_contact.studies.sweep.journal import Row
from granular_contact.values.arrays import Vector

CONFIDENCE = 0.95
RESAMPLES = 999
MOST_NAMED = 3  # cases
WIDEST_INTERVAL = 0.5  # interval of an index that says something
INDEX_TOLERANCE = 0.1  # how far an index may lie where none can: outside 0 to 1, the first order above the total
HEAD = ("output", "input", "first_order", "first_low", "first_high", "total", "total_low", "total_high", "note")

_none = partial(np.empty, 0)


@dataclass(frozen=True)
class Indices:
    """Sobol indices of one output, (inputs,) each, with the ends of their confidence intervals (2, inputs).

    refused: why there are none, and then the arrays are empty.
    """

    output: str
    inputs: tuple[str, ...]
    first: Vector = field(default_factory=_none)
    total: Vector = field(default_factory=_none)
    first_interval: Vector = field(default_factory=_none)
    total_interval: Vector = field(default_factory=_none)
    refused: str = ""


def imprecision(one: Indices, i: int) -> str:
    """Why the indices of an input are too imprecise to be used; empty if they are not."""
    if one.refused:
        return ""
    width = max(float(np.ptp(ends[:, i])) for ends in (one.first_interval, one.total_interval))
    first, total = float(one.first[i]), float(one.total[i])
    if not width <= WIDEST_INTERVAL:  # or it is not a number at all
        why = f"an interval {width:.2g} wide"
    elif max(-first, -total, first - 1.0, total - 1.0) > INDEX_TOLERANCE:
        why = "an index outside 0 to 1"
    elif first - total > INDEX_TOLERANCE:
        why = "a first order above the total"
    else:
        return ""
    return f"too few points, {why}: take a greater count"


def warnings(one: Indices) -> list[str]:
    """A sentence for each input whose indices are too imprecise."""
    named = ((name, imprecision(one, i)) for i, name in enumerate(one.inputs))
    return [f"Sobol indices of {one.output} to {name}: {why}" for name, why in named if why]


def of_sweep(sweep: Sweep, rows: Iterable[Row]) -> list[Indices]:
    """Indices of each output that the sample of a sweep is made for; none for any other sweep.

    They are refused where a case failed or has no such number, as the design needs all cases: `count` of A, a power of
    two, as many of B, and those of A with each input from B in turn.
    """
    sample = sweep.sample
    if sample is None or not sample.outputs:
        return []
    outputs, inputs, count = sample.outputs, tuple(sample.ranges), sample.count
    size = (len(inputs) + 2) * count
    values = np.full((len(outputs), size), np.nan)
    names, failed = [""] * size, np.zeros(size, dtype=bool)
    for row in rows:
        names[row.index], failed[row.index] = row.name, row.failed
        for i, output in enumerate(outputs):
            if is_number(value := row.summary.get(output)):
                values[i, row.index] = value
    pairs = zip(outputs, values, strict=True)
    return [_of_output(output, inputs, count, value, failed, names) for output, value in pairs]


def _of_output(
    output: str, inputs: tuple[str, ...], count: int, values: Vector, failed: NDArray[np.bool_], names: Sequence[str]
) -> Indices:
    for missing, said in ((failed, "failed"), (~np.isfinite(values), f"have no {output}")):
        if missing.any():
            which = [name for name, lacks in zip(names, missing, strict=True) if lacks]
            listed = ", ".join(which[:MOST_NAMED]) + (", ..." if len(which) > MOST_NAMED else "")
            return Indices(output, inputs, refused=f"{len(which)} of {len(values)} cases {said} ({listed})")
    if np.ptp(values[: 2 * count]) == 0.0:
        return Indices(output, inputs, refused="it is the same in all cases")
    return indices(output, inputs, values.reshape(len(inputs) + 2, count))


def indices(output: str, inputs: tuple[str, ...], values: Vector, seed: int = 0) -> Indices:
    """Indices from values (inputs + 2, count) of the output: at A, at B, and at A with each input from B."""
    from scipy import stats

    count = values.shape[1]

    def of(points: NDArray[np.int64]) -> Vector:
        held = values[:, points]
        parts = {"f_A": held[:1], "f_B": held[1:2], "f_AB": held[2:, None, :]}
        found = stats.sobol_indices(func=parts, n=count)
        return np.stack([np.atleast_1d(found.first_order), np.atleast_1d(found.total_order)])

    found = of(np.arange(count))
    # The result's own bootstrap takes no seed, and two runs of one sweep are to give one file.
    drawn = stats.bootstrap(
        [np.arange(count)],
        of,
        vectorized=False,
        method="percentile",
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        rng=np.random.default_rng(seed),
    )
    ends = np.array(drawn.confidence_interval)
    return Indices(output, inputs, found[0], found[1], ends[:, 0], ends[:, 1])


def write(found: Sequence[Indices], folder: Path, figures: bool = True) -> None:
    """Write sensitivity.csv, a line for each output and input, and a figure of each output; raises OSError."""
    write_table(folder / SENSITIVITY, HEAD, (_cells(one, i) for one in found for i in range(len(one.inputs))))
    known = [one for one in found if figures and not one.refused]
    if known:
        from granular_contact.report.figures.studies import draw_sensitivity

        for one in known:
            first, total = (one.first, one.first_interval), (one.total, one.total_interval)
            file = folder / FIGURES / f"sensitivity_{one.output}.png"
            draw_sensitivity(one.output, one.inputs, first, total, file)


def _cells(one: Indices, i: int) -> list[str | float]:
    if one.refused:
        return [one.output, one.inputs[i], *[""] * 6, one.refused]
    first, total = one.first_interval[:, i], one.total_interval[:, i]
    numbers = one.first[i], first[0], first[1], one.total[i], total[0], total[1]
    return [one.output, one.inputs[i], *map(float, numbers), imprecision(one, i)]
