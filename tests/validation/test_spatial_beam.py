"""The study of beams in space: the engine's elements and Kirchhoff's rod agree, so that its reference is no mistake."""

from __future__ import annotations

import pytest

from validation import spatial_beam as study


@pytest.mark.parametrize("kind", [study.CABLE, study.BEAM, study.EXACT])
def test_elements_of_the_engine_come_to_the_same_strip(kind: str) -> None:
    errors = study.strip_errors(kind, [4, 8], 0.0)
    assert errors[1] < 0.3 * errors[0]  # of second order, or better
    assert errors[1] < 6e-3  # 4e-4 to 5e-3
