"""The study of the beam: its claims, and that the theory worked out in it is that of the books."""

from __future__ import annotations

import math

import numpy as np
import pytest

from validation import beam_against_theory as study


@pytest.mark.slow
def test_every_claim_holds() -> None:
    claims = study.study(True).claims
    assert len(claims) == 11
    assert [str(claim) for claim in claims if not claim.held] == []


@pytest.mark.parametrize(("load", "across", "along"), [(1.0, 0.302, 0.056), (5.0, 0.714, 0.388), (10.0, 0.811, 0.555)])
def test_elastica_is_that_of_bisshopp_and_drucker(load: float, across: float, along: float) -> None:
    # Their table has three decimals.
    x, y = study.elliptic_elastica(load) / study.L
    assert (-y, 1 - x) == pytest.approx((across, along), abs=6e-4)


def test_a_small_load_bends_the_elastica_as_linear_theory_says() -> None:
    # The square of the load, F L^2 / EI = 1e-3, is left out: a part of 1e-7.
    force = 1e-3 * study.EI / study.L**2
    assert -study.elastica(force=force)[1] == pytest.approx(force * study.L**3 / (3 * study.EI), rel=2e-7)
    assert -study.elastica(weight=force / study.L)[1] == pytest.approx(force * study.L**3 / (8 * study.EI), rel=2e-7)


def test_pivot_at_the_clamp_without_root_is_a_hinge(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "OFFSET", 0.0)
    monkeypatch.setattr(study, "ROOT_INERTIA", 0.0)
    # tan(b) = tanh(b)
    b = np.sqrt(study.hinged(3) * 2 * math.pi * study.L**2 / math.sqrt(study.EI / study.MU))
    assert b == pytest.approx([3.926602, 7.068583, 10.210176], abs=2e-6)


def test_root_of_great_inertia_is_a_clamp(monkeypatch: pytest.MonkeyPatch) -> None:
    clamped = study.clamped_free(3)
    monkeypatch.setattr(study, "ROOT_INERTIA", 1e9)
    assert study.hinged(3) == pytest.approx(clamped, rel=1e-6)


def test_order_is_the_slope_and_leaves_round_off_out() -> None:
    n = [1, 2, 4, 8]
    assert study.order(n, [x**-3.0 for x in n]) == pytest.approx(3.0)
    assert study.order(n, [1.0, 1 / 8, 1 / 64, 1e-16], 1e-12) == pytest.approx(3.0)
    assert math.isnan(study.order(n, [1e-16] * 4, 1e-12))


def test_period_of_the_small_swing() -> None:
    # sqrt(J / (m g l)) in physics: 1.4955e-3 kg m2 and 0.08593 N m.
    quarter = study.quarter_period(1e-3, study.ROOT_INERTIA + study.BEAM_INERTIA)
    assert 4 * quarter == pytest.approx(2 * math.pi * math.sqrt(1.4955e-3 / 0.08593), rel=2e-4)
