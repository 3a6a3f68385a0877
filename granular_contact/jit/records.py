"""Record types that kernels take."""

from __future__ import annotations


def fields(kind: str, *names: str) -> list[tuple[str, str]]:
    """Fields of a record type that are all of one kind, as `f8`."""
    return [(name, kind) for name in names]
