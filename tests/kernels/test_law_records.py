"""Every law has a record type of its own, or it is refused where it is joined to the kernels."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit
from support_laws import (
    ALL_LAWS,
    BAR_LAWS,
    SOFT,
    SURFACE_LAWS,
    G,
)

from granular_contact.kernels import law
from granular_contact.laws.albert import Albert


def test_no_record_begins_with_another() -> None:
    # Kernels find a law by its record type, and numba takes a record for any other whose fields it begins with.
    fields = {str(m.record(SOFT, G).dtype.descr)[1:-1] for m in ALL_LAWS}
    assert len(fields) == len({type(m) for m in SURFACE_LAWS + BAR_LAWS}) + 1
    assert not any(a != b and a.startswith(b) for a in fields for b in fields)


@njit
def return_nothing(px, py, ax, ay, m):  # noqa: ARG001
    return ax, ay


ALBERT = Albert.blank().dtype.descr


@pytest.mark.parametrize("fields", [[*ALBERT, ("more", "f8")], ALBERT[:-1], ALBERT[:1]])
def test_a_record_that_begins_like_another_is_refused(fields: list[tuple[str, str]]) -> None:
    before = dict(law._KNOWN)
    with pytest.raises(TypeError) as caught:
        law.provide(law.drag_anchor, "m", np.dtype(fields))(return_nothing)
    words = str(caught.value)
    assert "test_law_records.return_nothing" in words
    assert "granular_contact.laws.albert." in words or "granular_contact.kernels." in words
    assert "begin alike" in words
    assert before == law._KNOWN


def test_a_record_of_its_own_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(law, "_KNOWN", dict(law._KNOWN))
    own = np.dtype([("own_number", "f8"), *ALBERT])
    law.provide(law.drag_anchor, "m", own)(return_nothing)
    assert law._KNOWN[own].endswith("return_nothing")
