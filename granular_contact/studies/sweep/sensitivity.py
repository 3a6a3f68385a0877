"""Sobol indices from the rows of a Saltelli design: the share of the variance of an output that each input explains.

The first-order index is the share of the input alone, the total index the share with all interactions.
scipy.stats.sobol_indices (Saltelli et al. 2010) computes them, for independent inputs that are uniform over their
ranges. Confidence intervals come from a bootstrap over the points of the design.
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
MOST_NAMED = 3  # greatest number of cases that a message names
WIDEST_INTERVAL = 0.5  # greatest width of the interval of a usable index
INDEX_TOLERANCE = 0.1  # by how much an index may be outside 0 to 1, or a first-order index above the total index
HEAD = ("output", "input", "first_order", "first_low", "first_high", "total", "total_low", "total_high", "note")

_none = partial(np.empty, 0)


@dataclass(frozen=True)
class Indices:
    """Sobol indices of one output, (inputs,) each, with the ends of their confidence intervals (2, inputs).

    refused: reason why there are no indices, in which case the arrays are empty.
    """

    output: str
    inputs: tuple[str, ...]
    first: Vector = field(default_factory=_none)
    total: Vector = field(default_factory=_none)
    first_interval: Vector = field(default_factory=_none)
    total_interval: Vector = field(default_factory=_none)
    refused: str = ""


def imprecision(sobol: Indices, i: int) -> str:
    """Reason why the indices of an input are too imprecise to be used; empty if they are precise enough."""
    if sobol.refused:
        return ""
    width = max(float(np.ptp(ends[:, i])) for ends in (sobol.first_interval, sobol.total_interval))
    first, total = float(sobol.first[i]), float(sobol.total[i])
    if not width <= WIDEST_INTERVAL:  # also if it is NaN
        sign = f"a confidence interval is {width:.2g} wide"
    elif max(-first, -total, first - 1.0, total - 1.0) > INDEX_TOLERANCE:
        sign = "an index is outside 0 to 1"
    elif first - total > INDEX_TOLERANCE:
        sign = "the first-order index is above the total index"
    else:
        return ""
    return f"too few points, {sign}: take a greater count"


def warnings(sobol: Indices) -> list[str]:
    """Return a sentence for each input whose indices are too imprecise."""
    reasons = ((name, imprecision(sobol, i)) for i, name in enumerate(sobol.inputs))
    return [f"Sobol indices of {sobol.output} with respect to {name}: {reason}" for name, reason in reasons if reason]


def of_sweep(sweep: Sweep, rows: Iterable[Row]) -> list[Indices]:
    """Indices of each output of a sweep with a Saltelli sample; empty for any other sweep.

    Indices are refused if a case failed or lacks the output, because the design needs all its cases: `count` points A
    (a power of two), as many points B, and for each input the points A with this input taken from B.
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
    return [_checked_indices(output, inputs, count, value, failed, names) for output, value in pairs]


def _checked_indices(
    output: str, inputs: tuple[str, ...], count: int, values: Vector, failed: NDArray[np.bool_], names: Sequence[str]
) -> Indices:
    """Indices of an output, or the reason why they are refused."""
    for missing, fault in ((failed, "failed"), (~np.isfinite(values), f"have no {output}")):
        if missing.any():
            cases = [name for name, lacks in zip(names, missing, strict=True) if lacks]
            listed = ", ".join(cases[:MOST_NAMED]) + (", ..." if len(cases) > MOST_NAMED else "")
            return Indices(output, inputs, refused=f"{len(cases)} of {len(values)} cases {fault} ({listed})")
    if np.ptp(values[: 2 * count]) == 0.0:
        return Indices(output, inputs, refused="it is the same in all cases")
    return indices(output, inputs, values.reshape(len(inputs) + 2, count))


def indices(output: str, inputs: tuple[str, ...], values: Vector, seed: int = 0) -> Indices:
    """Indices from values (inputs + 2, count) of the output: at A, at B, and at A with each input from B."""
    from scipy import stats

    count = values.shape[1]

    def estimate(points: NDArray[np.int64]) -> Vector:
        """First-order and total indices (2, inputs) from the given points of the design."""
        chosen = values[:, points]
        parts = {"f_A": chosen[:1], "f_B": chosen[1:2], "f_AB": chosen[2:, None, :]}
        sobol = stats.sobol_indices(func=parts, n=count)
        return np.stack([np.atleast_1d(sobol.first_order), np.atleast_1d(sobol.total_order)])

    first_and_total = estimate(np.arange(count))
    # The bootstrap of scipy's own result takes no seed, so that a repeated sweep would give another file.
    resampled = stats.bootstrap(
        [np.arange(count)],
        estimate,
        vectorized=False,
        method="percentile",
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        rng=np.random.default_rng(seed),
    )
    ends = np.array(resampled.confidence_interval)
    return Indices(output, inputs, first_and_total[0], first_and_total[1], ends[:, 0], ends[:, 1])


def write(outputs: Sequence[Indices], folder: Path, figures: bool = True) -> None:
    """Write sensitivity.csv, with a line for each output and input, and a figure of each output.

    Parameters
    ----------
    outputs : sequence of Indices
        Sobol indices of each output; those that were refused have no figure.
    folder : Path
        An existing folder.
    figures : bool, optional
        Whether figures are drawn.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    rows = (_cells(sobol, i) for sobol in outputs for i in range(len(sobol.inputs)))
    write_table(folder / SENSITIVITY, HEAD, rows)
    drawable = [sobol for sobol in outputs if figures and not sobol.refused]
    if drawable:
        from granular_contact.report.figures.studies import draw_sensitivity

        for sobol in drawable:
            first, total = (sobol.first, sobol.first_interval), (sobol.total, sobol.total_interval)
            file = folder / FIGURES / f"sensitivity_{sobol.output}.png"
            draw_sensitivity(sobol.output, sobol.inputs, first, total, file)


def _cells(sobol: Indices, i: int) -> list[str | float]:
    if sobol.refused:
        return [sobol.output, sobol.inputs[i], *[""] * 6, sobol.refused]
    first, total = sobol.first_interval[:, i], sobol.total_interval[:, i]
    numbers = sobol.first[i], first[0], first[1], sobol.total[i], total[0], total[1]
    return [sobol.output, sobol.inputs[i], *map(float, numbers), imprecision(sobol, i)]
