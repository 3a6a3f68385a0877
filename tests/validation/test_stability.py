"""A few cells of the matrix of stability.py, and its judgement by hand."""

from __future__ import annotations

import pytest

from validation import stability as study
from validation.stability_cases import Case, cases, heat

CELLS = (
    ("EI and EA", "1e6"),
    ("EI and EA", "1e-6"),
    ("step", "0.01 s"),
    ("yield displacement", "1e-8 m"),
    ("impact angle", "90 deg"),
    ("impact speed", "100 rad/s"),
    ("gravity", "-9.81"),
    ("grazes and leaves at the lowest point", "1e-06 m"),
)


def test_the_stability_matrix_has_enough_cases() -> None:
    """As many as the matrix promises, each once."""
    every = [*cases(), *(place[3] for place in heat())]
    assert len(set(every)) == len(every) >= 300
    assert sum(case.quick for case in every) >= 60


@pytest.fixture(scope="module")
def outcomes() -> list[study.Found]:
    chosen = [case for case in cases() if (case.factor, case.value) in CELLS]
    assert len(chosen) == len(CELLS)
    # The limits of time of the full form: a busy machine must not end a run that says itself why it fails.
    return [study.look(case, False) for case in chosen]


@pytest.mark.slow
def test_cells_keep_the_claims(outcomes: list[study.Found]) -> None:
    names = ("no result is NaN", "no run hangs or fails without an explanation", "energy balance", "difference")
    held = {claim.name: claim.held for claim in study.claims(outcomes, 0.0, True)}
    for name in names:
        assert all(value for key, value in held.items() if key.startswith(f"stability.{name}"))
    assert {outcome.case.value for outcome in outcomes if outcome.warnings} >= {"1e-6", "0.01 s", "100 rad/s"}


def test_a_wrong_answer_without_a_word_is_seen() -> None:
    wrong = study.Found(Case("a", "b", ()), "end_time", "", imbalance=0.02, difference=0.1)
    held = {claim.name.split(".")[1]: claim.held for claim in study.claims([wrong], 0.0, True)}
    assert not held["energy balance of runs without a warning"]
    assert not held["difference of runs without a warning"]
    hung = study.Found(Case("a", "b", ()), "time_limit", "over")
    assert study.unexplained([wrong, hung]) == [hung]


@pytest.mark.slow
def test_ten_times_the_step_is_reported() -> None:
    outcomes = [study.ten_times(study.CONFIGS / f"{name}.yaml") for name in ("pendulum", "impact_61deg", "runner")]
    assert study.coarse_claim(outcomes).held
    assert [bool(outcome.warnings) for outcome in outcomes] == [True, True, False]
    assert study.coarse_table(outcomes).count("\n") == 4
    for difference, warnings, held in ((0.03, ("w",), True), (0.03, (), False), (0.06, ("w",), False)):
        outcome = study.Coarse("a", 1e-3, "rest", warnings, 0.0, difference)
        assert study.coarse_claim([*outcomes, outcome]).held is held
