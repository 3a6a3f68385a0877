"""The study of beams in space: its references are right, and errors are warned of."""

from __future__ import annotations

import numpy as np
import pytest

from validation import oblique_modes
from validation import spatial_beam as study

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("kind", [study.CABLE, study.BEAM, study.EXACT])
def test_elements_of_the_engine_come_to_the_same_strip(kind: str) -> None:
    errors = study.strip_errors(kind, [4, 8], 0.0)
    assert errors[1] < 0.3 * errors[0]  # of second order, or better
    assert errors[1] < 6e-3  # 4e-4 to 5e-3


def test_a_beam_that_is_spun_up_comes_back_with_order_two() -> None:
    """What is left is the square of the greatest slope, 0.09^2, by which the theory is off."""
    (_, most, coarse, _), (_, _, fine, _) = study.spin_up.rows([4, 8])
    assert coarse / fine > 3.0
    assert fine < 0.025
    assert 0.5 < most < 0.6  # m; in figures of Simo and Vu-Quoc (1986) somewhat less than 0.6


def test_links_from_soft_to_stiff_are_accurate_or_warned_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study.soft_and_stiff, "FINE", 32)  # twice as many as those that are right to some 0.1 %
    cases = study.soft_and_stiff.cases((1e-4, 1e6), 32)
    assert [case.told for case in cases] == [True, False, True, True, False]
    for case in cases:
        assert case.error < 0.01 or case.told
        assert case.error > 1e-3 or not case.told  # which is told of above 1 %, and at most ten times too much
        assert case.imbalance < 1e-3


def test_modes_are_distinguished() -> None:
    """A motion in the first mode of one plane and the second of the other, of half the amplitude.

    Its energies are as 1 to 1/4, since the squares of these curvatures are the same.
    """
    place = (np.arange(400) + 0.5) / 400
    first, second = (oblique_modes.curvature(root, place) for root in oblique_modes.ROOTS[:2])
    theta = np.sin(np.arange(20.0))[:, None, None] * np.stack([first, 0.5 * second], axis=1)
    energy, tip = oblique_modes.left(theta, 1)
    assert energy == pytest.approx(0.2, abs=1e-3)
    lever = [abs((mode * (1.0 - place)).sum()) for mode in (first, 0.5 * second)]
    assert tip == pytest.approx(lever[1] / np.hypot(*lever), rel=1e-3)
    assert oblique_modes.left(theta, 2) == pytest.approx((0.0, 0.0), abs=1e-6)
