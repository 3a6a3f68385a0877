"""Checks of force tests by the law itself: units, signs, depths, forces that are no more than noise."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from granular_contact.config.csv_table import few
from granular_contact.errors import Fault
from granular_contact.studies.fit import columns, noise
from granular_contact.studies.fit.measurements import Measured

Vector = NDArray[np.float64]

DEEPEST = 100.0  # sizes of the body: no depth of a test
LEAST_FORCE = 4.0  # times the standard error that noise gives to the size of the force: smaller ones say nothing
UNLIKE = 100.0  # factor between tests of one law by which their forces differ at most, in units of the model


def of_test(held: Measured, model: Vector, size: float, least: float) -> Iterator[Fault]:
    """Faults of one test.

    model: (n, columns) of the law at the start values; size (m) of the body; least (m): depth in the table where it
    touches the surface, or the least that this may be.
    """
    depth = held.given[columns.DEPTH]
    yield from few(held.file, list(_above(held, depth, least)))
    deepest = int(np.argmax(depth))
    if depth[deepest] > DEEPEST * size:
        words = (
            f"got {depth[deepest]:.4g} m, but the body is {size:.3g} m wide: is the depth in another unit than its "
            "name says?"
        )
        yield Fault(held.file, held.lines[deepest], columns.DEPTH, words)
        return
    for k, name in enumerate(held.columns):
        yield from _of_column(held, name, held.values[:, k], model[:, k])


def _above(held: Measured, depth: Vector, least: float) -> Iterator[Fault]:
    for i in np.flatnonzero(depth < least):
        words = (
            f"got {1e3 * depth[i]:.4g} mm, which is above the surface; leave the row out, or say where the touch is: "
            "force_test: {depth_offset_m: fit}, or a number"
        )
        yield Fault(held.file, held.lines[int(i)], columns.DEPTH, words)


def _of_column(held: Measured, name: str, data: Vector, model: Vector) -> Iterator[Fault]:
    scatter, size = noise.roughness(data), float(np.linalg.norm(model))
    if size == 0.0:
        return
    share = float(data @ model) / size  # of the data along the law, in units of the data
    if not np.any(data) or (scatter is not None and abs(share) < LEAST_FORCE * scatter):
        words = f"is noise alone: it scatters by {scatter or 0.0:.3g} from row to row, and has no more of a force"
        yield Fault(held.file, held.lines[0], name, words)
    elif share < 0.0:
        odd = int(np.argmax(np.abs(data) * (data * model < 0.0)))
        words = (
            f"got {data[odd]:.4g}, but the law gives {model[odd]:+.3g}: {name} is positive "
            f"{columns.SIGNS[name]}; turn its sign in the table, or check force_test: {{direction: ...}}"
        )
        yield Fault(held.file, held.lines[odd], name, words)


def between_tests(held: Sequence[Measured], models: Sequence[Vector]) -> Iterator[Fault]:
    """Faults of tests whose forces are, against the law, hundreds of times those of the others."""
    found: dict[str, list[tuple[float, Measured]]] = {}
    for one, model in zip(held, models, strict=True):
        for k, name in enumerate(one.columns):
            size = float(model[:, k] @ model[:, k])
            ratio = float(one.values[:, k] @ model[:, k]) / size if size > 0.0 else 0.0
            if ratio > 0.0:
                found.setdefault(name, []).append((ratio, one))
    for name, tests in found.items():
        middle = float(np.exp(np.median(np.log([ratio for ratio, _ in tests]))))
        (low, first), (high, last) = (choose(tests, key=lambda one: one[0]) for choose in (min, max))
        if high / low <= UNLIKE:
            continue
        far, other = (last, first) if high / middle >= middle / low else (first, last)
        words = (
            f"measured against the law its forces differ by a factor {high / low:.3g} from those of {other.file}: is "
            f"one of them in another unit than its name says?"
        )
        yield Fault(far.file, far.lines[0], name, words)
