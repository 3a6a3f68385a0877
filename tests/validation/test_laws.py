"""The study of the laws: all its claims but one hold, and that one is a weakness that it names."""

from __future__ import annotations

import pytest

from validation import laws as study
from validation.study import Outcome

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def outcome() -> Outcome:
    return study.study(True)


def test_claims(outcome: Outcome) -> None:
    assert len(outcome.claims) == 30
    assert [claim.name for claim in outcome.claims if not claim.held] == [
        "laws.no closed path inside the yield surface returns energy"
    ]


def test_a_wrong_value_of_a_law_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = study.rft3d_law.alpha
    monkeypatch.setattr(study.rft3d_law, "alpha", lambda *state: [1.01 * part for part in honest(*state)])
    _, (claim,) = study.printed_values()
    assert not claim.held
