"""The study of the paper's impacts: its claims, and that they can fail."""

from __future__ import annotations

import copy

import pytest
from support_claims import held

from validation import paper_cases as study
from validation.study import Outcome

pytestmark = pytest.mark.slow

NOT_HELD = "paper_cases.deflection grows with angle"


@pytest.fixture(scope="module")
def runs() -> study.Runs:
    return study.impacts(study.QUICK_STEP)


@pytest.fixture(scope="module")
def outcome(runs: study.Runs) -> Outcome:
    return study.outcome(runs, study.QUICK_STEP, figures=False)


def spoilt(runs: study.Runs, model: str, case: tuple[float, float], key: str, value: float) -> study.Runs:
    """The same runs, one with another key number."""
    other = dict(runs)
    other[(model, *case)] = copy.copy(runs[(model, *case)])
    object.__setattr__(other[(model, *case)], "summary", runs[(model, *case)].summary | {key: value})
    return other


def test_claims_hold_but_for_the_deflection_that_falls_with_the_angle(outcome: Outcome) -> None:
    assert len(outcome.claims) == 10
    assert [claim.name for claim in outcome.claims if not claim.held] == [NOT_HELD]


def test_deflections_are_those_measured(runs: study.Runs) -> None:
    # 16 elements with the default step peak within 2 % of a step ten times smaller, which gives these.
    peaks = study.numbers(runs, study.FE, "max_deflection_m")[:, 2]
    assert peaks == pytest.approx([1.411e-4, 3.352e-4, 2.804e-4, 2.136e-4], rel=0.02)


def test_table_has_twelve_impacts(outcome: Outcome) -> None:
    rows = [line for line in outcome.text.split("\n\n")[1].splitlines() if line.startswith("| ")]
    assert len(rows) == 2 + 12
    assert "| 31 | 6.24 | 1.64 | 25.46 |" in outcome.text


@pytest.mark.parametrize(
    ("claims", "model", "key", "value", "statement"),
    [
        (study.motion_claims, study.FE, "stopping_time_s", 0.027, "stopping time falls with speed"),
        (study.motion_claims, study.RIGID, "stopping_time_s", 0.018, "fall of stopping time flattens"),
        (study.motion_claims, study.ONE, "angle_at_stop_deg", 35.0, "penetration grows with speed"),
        (study.model_claims, study.FE, "stopping_time_s", 0.0231, "rigid and flexible links hardly differ"),
        (study.model_claims, study.ONE, "stopping_time_s", 0.0230, "event-located and elastoplastic friction agree"),
        (
            study.check_claims,
            study.RIGID,
            "stopping_time_s",
            0.02290,
            "the rigid link agrees with the earlier computation",
        ),
        (
            study.check_claims,
            study.RIGID,
            "angle_at_stop_deg",
            35.54,
            "the rigid link agrees with the earlier computation",
        ),
    ],
)
def test_claims_fall_with_one_spoilt_run(runs, claims, model, key, value, statement) -> None:
    assert held(claims(runs))[statement]
    assert not held(claims(spoilt(runs, model, (31.0, 8.41), key, value)))[statement]


def test_deflection_claims_fall_with_one_spoilt_run(runs: study.Runs) -> None:
    peaks = study.numbers(runs, study.FE, "max_deflection_m")[:, 2]
    thick = spoilt(runs, study.FE, (31.0, 8.41), "max_deflection_m", 3e-3)
    thin = spoilt(runs, study.FE, (31.0, 8.41), "max_deflection_m", 1e-4)
    assert not held(study.deflection_claims(thick, peaks))["deflection is very small"]
    assert not held(study.deflection_claims(thin, peaks))["deflection grows with speed"]
