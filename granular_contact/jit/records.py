"""Record types: numpy's structured types, whose fields kernels read and write as attributes, `line.width`.

In compiled code numba makes the fields of records attributes. Where nothing is compiled (`jit.compiled.COMPILES`) the
types have a record class of this module, which does the same.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from granular_contact.jit.compiled import COMPILES


def fields(kind: str, *names: str) -> list[tuple[str, str]]:
    """Fields of a record type, all of one kind such as `f8`."""
    return [(name, kind) for name in names]


def record_dtype(fields: Iterable[tuple[Any, ...]]) -> np.dtype:
    """Record type with fields as in `numpy.dtype`, for every array of records that kernels take.

    A field may have the name of an attribute of numpy's records, such as `size`.
    """
    kind = np.dtype(list(fields))
    return kind if COMPILES else np.dtype((_Record, kind))


class _Record(np.record):  # type: ignore[misc]  # final in the stubs of numpy alone
    """Record whose fields are attributes and come before the attributes of numpy's records."""

    def __getattribute__(self, name: str) -> Any:
        own = np.void.__getattribute__
        return self[name] if name in own(self, "dtype").fields else own(self, name)

    def __setattr__(self, name: str, value: Any) -> None:
        self[name] = value
