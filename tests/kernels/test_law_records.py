"""Every law has a record type of its own."""

from __future__ import annotations

from support_laws import (
    ALL_LAWS,
    BAR_LAWS,
    SOFT,
    SURFACE_LAWS,
    G,
)


def test_no_record_begins_with_another() -> None:
    # Kernels find a law by its record type, and numba takes a record for any other whose fields it begins with.
    fields = {str(m.record(SOFT, G).dtype.descr)[1:-1] for m in ALL_LAWS}
    assert len(fields) == len({type(m) for m in SURFACE_LAWS + BAR_LAWS}) + 1
    assert not any(a != b and a.startswith(b) for a in fields for b in fields)
