"""Measured sand against the models: the recorded agreement, and detection of a wrong model."""

from __future__ import annotations

import numpy as np
import pytest
from support_claims import held

from validation import force_tests, measured
from validation.measurements import cmu, others


@pytest.mark.slow
def test_plates_and_the_wheel() -> None:
    claims = held([*measured.plates()[1], *measured.pressed()[1], *measured.wheel(True)[1]])
    assert [name for name, kept in claims.items() if kept] == [
        "3D-RFT, nothing fitted: plate of 60 mm within a third",
        "RFT, zeta of the 60 mm plate: plate of 80 mm within a third",
        "k z^n of the 60 mm plate: force on the pressed wheel is between those of its two stated sizes, from 10 mm on",
        "k z^n of the 60 mm plate: force on the pressed wheel within a third, from 10 mm on",
        "3D-RFT, nothing fitted: Fx rises with slip as measured",
        "RFT, zeta of the 60 mm plate: Fx rises with slip as measured",
    ]
    assert sum("locked wheel" in name for name in claims) == 2


def test_the_preset_is_what_the_shipped_fit_finds_on_one_plate() -> None:
    fitted, kept = cmu.fitted(), cmu.models()["k z^n of the 60 mm plate"]
    (k, k_error), (n, n_error) = (fitted[f"medium.{key}"] for key in ("k_phi_Pa", "exponent"))
    assert kept.k_phi == pytest.approx(k, abs=0.01 * k_error)
    assert kept.exponent == pytest.approx(n, abs=0.01 * n_error)


def test_a_wrong_density_fails_the_claims(monkeypatch: pytest.MonkeyPatch) -> None:
    light = {name: medium.model_copy(update={"density": 600.0}) for name, medium in cmu.models().items()}
    monkeypatch.setattr(cmu, "models", lambda: light)
    assert not held(measured.plates()[1])["3D-RFT, nothing fitted: plate of 60 mm within a third"]


@pytest.mark.slow
def test_the_ball_and_the_dragged_plate() -> None:
    claims = held([*measured.ball(True)[1], *measured.drag()[1]])
    assert [name for name, kept in claims.items() if not kept] == [
        "ball: stopping time is three times depth over speed"
    ]
    # A ball that is set down comes to rest after half a period, twice as deep as its weight would press it.
    time, depth = others.stop(1e-6, others.K_OVER_M, others.D1)
    assert time == pytest.approx(np.pi / np.sqrt(others.K_OVER_M), rel=0.02)
    assert 0.9 < depth / (2 * others.G / others.K_OVER_M) < 1.0


@pytest.mark.slow
def test_intervals_of_force_tests_hold_the_true_value(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(force_tests, "QUICK_DRAWS", 4)
    claims = [force_tests.coverage(name, 4)[1][0] for name in ("zeta", "k and n")]
    assert all(claim.held for claim in claims)
    # Noise that is the same in all tests is none: intervals are then far too short, and that is seen.
    monkeypatch.setattr(force_tests, "noisy", lambda exact, case, seed: shifted(exact, case.noise * (1 + seed)))
    assert not force_tests.coverage("zeta", 4)[1][0].held


def shifted(exact: force_tests.Problem, by: float) -> force_tests.Problem:
    """Forces that are all too large by so much, with next to no scatter."""
    quiet = force_tests.replace(exact)
    runs = []
    for run in quiet.runs:
        values = run.measured.values + by + 1e-3 * np.sin(np.arange(len(run.measured.values)) ** 2)[:, None]
        runs.append(force_tests.replace(run, measured=force_tests.replace(run.measured, values=values)))
    return force_tests.replace(exact, runs=tuple(runs))
