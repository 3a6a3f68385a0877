"""Units of axes and numbers: the multiple of an SI unit that brings them to 1 to 1000."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_PREFIXES = {-18: "a", -15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


@dataclass(frozen=True)
class Unit:
    """A value in SI units times `factor` is a number of `name`s."""

    factor: float
    name: str


def unit_for(values: Array, base: str) -> Unit:
    """The multiple of SI unit `base` in which the largest magnitude of `values` (any shape, SI) lies in 1 to 1000."""
    largest = greatest(values)
    exponent = 3 * int(np.floor(np.log10(largest) / 3)) if largest > 0 else 0
    exponent = min(max(exponent, min(_PREFIXES)), max(_PREFIXES))
    return Unit(10.0**-exponent, _PREFIXES[exponent] + base)


def greatest(values: Array) -> float:
    """Largest finite magnitude, 0 if there is none."""
    return float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))


def minus(words: str) -> str:
    """Text with a typeset minus sign."""
    return words.replace("-", "\N{MINUS SIGN}")
