"""Scalar laws: one force on a ball, against its motion, of its speed v and the depth z of its lowest point.

Compiled equations: `kernels.scalar`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.static_friction import Elastoplastic, Smooth


def scalar_record(static: Elastoplastic | Smooth, terms: tuple[str, ...], **values: Any) -> NDArray[np.void]:
    """Record (1,) of `kernels.scalar` with these values; the last of the terms takes what is quadratic in speed."""
    from granular_contact.kernels import scalar

    record = np.zeros(1, scalar.RECORD)
    record["p"], record["quadratic"] = 1.0, len(terms) - 1
    for name, value in values.items():
        record[name] = value
    static.fill(record)
    return record
