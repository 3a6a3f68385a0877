"""Record types: numpy's structured types, whose fields kernels read and write as attributes, `line.width`.

numba gives records their fields as attributes; numpy does so for classes of records of one's own. Where nothing is
compiled (`jit.compiled.COMPILES`), types have such a class.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from granular_contact.jit.compiled import COMPILES


def fields(kind: str, *names: str) -> list[tuple[str, str]]:
    """Fields of a record type that are all of one kind, as `f8`."""
    return [(name, kind) for name in names]


def record_dtype(fields: Iterable[tuple[Any, ...]]) -> np.dtype:
    """Type of records with these fields, as numpy writes them: every array of records that kernels take has one.

    A field may have the name of what numpy's records have of themselves, as `size`.
    """
    found = np.dtype(list(fields))
    return found if COMPILES else np.dtype((_Record, found))


class _Record(np.record):  # type: ignore[misc]  # final in the stubs of numpy alone
    """Record that has its fields as attributes, before what numpy's records have of themselves."""

    def __getattribute__(self, name: str) -> Any:
        own = np.void.__getattribute__
        return self[name] if name in own(self, "dtype").fields else own(self, name)

    def __setattr__(self, name: str, value: Any) -> None:
        self[name] = value
