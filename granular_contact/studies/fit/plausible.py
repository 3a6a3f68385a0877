"""Whether coefficients are of the size of those published, and forces of the size that a law gives.

A depth in cm under a header in mm, or a force in mN under one in N, can be fitted as well as any other: what tells it
is a coefficient that no sand has, or a force that the law does not reach.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config.load import load_medium
from granular_contact.config.references import medium_names
from granular_contact.studies.fit.columns import SIGNS
from granular_contact.studies.fit.media_of_runs import fitted
from granular_contact.studies.fit.problem import Problem
from granular_contact.studies.fit.responses import Key

Vector = NDArray[np.float64]

BEYOND = 2.0  # times the greatest of several published values, or below the least: more is unlikely for a sand
TABLES = ("alpha_N_cm3",)  # whose single numbers are not judged: small ones differ by more from sand to sand
UNLIKE = 2.0  # factor between measured forces and those of the fitted law: a fit of their size makes it 1
ASKED = "is a column of the data in another unit than its name says?"


def unit_warnings(problem: Problem, values: Vector, residuals: Sequence[Vector]) -> Iterator[str]:
    """Sentences on what looks like another unit.

    values: parameters (p,); residuals: data less model (n, columns) of each run.
    """
    for one in fitted(problem):
        value = float(values[problem.parameters.index(one)])
        if (words := _beyond(one.key, abs(value))) is not None:
            yield f"{one.label}, {value:.3g}, is {words}: {ASKED}"
    for run, left in zip(problem.runs, residuals, strict=True):
        held = run.measured
        for k, name in enumerate(held.columns):
            data, model = held.values[:, k], held.values[:, k] - left[:, k]
            size, share = float(model @ model), float(data @ model)
            if name in SIGNS and share > 0.0 and not 1.0 / UNLIKE < share / size < UNLIKE:
                yield f"{held.file}: {name} is {share / size:.3g} times what the fitted law gives: {ASKED}"


def _beyond(key: Key, value: float) -> str | None:
    """How far a coefficient is from those of the media that are shipped, in words; None where it is not.

    One published value is no range, and is not compared with.
    """
    known = published().get(_name(key), [])
    if len(set(known)) < 2 or value == 0.0 or key[-2] in TABLES:
        return None
    low, high = min(known), max(known)
    span = f"{low:g} to {high:g} in the media that are shipped"
    if value > BEYOND * high:
        return f"{value / high:.2g} times the greatest published value ({span})"
    if value < low / BEYOND:
        return f"1/{low / value:.2g} of the least published value ({span})"
    return None


@cache
def published() -> dict[str, list[float]]:
    """Values other than 0 of each coefficient, by its dotted key, in the media that are shipped."""
    found: dict[str, list[float]] = {}
    for name in medium_names():
        plain = load_medium(name).model_dump(by_alias=True, exclude_unset=True)
        for key, value in _numbers(plain, ()):
            found.setdefault(_name(("", *key)), []).append(value)
    return found


def _numbers(plain: Any, path: Key) -> Iterator[tuple[Key, float]]:
    for key, value in plain.items() if isinstance(plain, dict) else ():
        if isinstance(value, float) and value != 0.0:
            yield (*path, key), abs(value)
        yield from _numbers(value, (*path, key))


def _name(key: Key) -> str:
    """Key of a coefficient within its medium, of which there may be several."""
    return ".".join(part for part in key[1:] if not part.isdecimal())
