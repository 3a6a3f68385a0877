"""Whether the numbers of a medium made in Python can be; those of configs are checked where they are read."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

from granular_contact.laws.layer import Layer
from granular_contact.laws.rft import Coefficients
from granular_contact.laws.validity import Validity

ABOVE_ZERO = {"yield_displacement", "reference_speed", "exponent"}


def check(part: Any) -> None:
    """Look through a medium, a layer or a regularisation of the static law.

    Raises
    ------
    ValueError
        A number in it is not finite, negative, or zero where it divides: the sand would drive what moves in it.
    """
    wrong = list(_faults(part, type(part).__name__))
    if wrong:
        raise ValueError("; ".join(wrong))


def _faults(part: Any, path: str) -> Iterator[str]:
    if isinstance(part, Layer):
        if not 0.0 <= part.top < part.bottom:
            yield f"{path}: got top {part.top} and bottom {part.bottom}, allowed is 0 <= top < bottom (m)"
        yield from _faults(part.medium, type(part.medium).__name__)
        return
    for field in fields(part):
        value, name = getattr(part, field.name), f"{path}.{field.name}"
        if is_dataclass(value) and not isinstance(value, Validity):
            yield from _faults(value, name)
        elif isinstance(value, float | int):
            yield from _number_faults(part, field.name, float(value), name)


def _number_faults(part: Any, field: str, value: float, name: str) -> Iterator[str]:
    if isinstance(part, Coefficients):
        if not math.isfinite(value):
            yield f"{name}: got {value}, allowed is a finite number"
    elif field in ABOVE_ZERO:
        if not 0.0 < value < math.inf:
            yield f"{name}: got {value}, allowed is a number above 0"
    elif not 0.0 <= value < math.inf:
        yield f"{name}: got {value}, allowed is a number of at least 0"
