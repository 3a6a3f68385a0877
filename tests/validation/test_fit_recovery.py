"""The study of fits: its claims in the quick form, and that they can fail."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support_claims import held

from validation import fit_recovery as study
from validation.study import Outcome

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def outcome() -> Outcome:
    return study.study(True)


def made_up(count: int, stated: float = 1.0, shift: float = 0.0) -> list[study.Draw]:
    """Draws of normal noise about the true values plus `shift` deviations; errors are `stated` times the deviation."""
    random, true = np.random.default_rng(0), np.array(list(study.TRUE.values()))
    draws = []
    for _ in range(count):
        values = true * (1.0 + 0.01 * (random.standard_normal(4) + shift))
        errors = stated * 0.01 * true
        draws.append(study.Draw(values, errors, values - 1.96 * errors, values + 1.96 * errors, False))
    return draws


def test_claims_hold(outcome: Outcome) -> None:
    assert len(outcome.claims) == 7
    assert all(held(outcome.claims).values())


def test_claims_fall_where_errors_are_wrong() -> None:
    assert all(held(study.recovery_claims(made_up(100))).values())
    small = held(study.recovery_claims(made_up(100, stated=0.6)))
    assert not small["intervals contain the true value"]
    assert not small["stated errors agree with the scatter"]
    large = held(study.recovery_claims(made_up(100, stated=1.6)))
    assert not large["stated errors agree with the scatter"]
    assert not held(study.recovery_claims(made_up(100, shift=0.6)))["estimates are unbiased"]
    alarmed = [replace(trial, misfit=i < 10) for i, trial in enumerate(made_up(100))]
    assert not held(study.recovery_claims(alarmed))["the true model is not called a misfit"]


def test_linear_theory_gives_the_errors_of_the_fits(outcome: Outcome) -> None:
    # The mean stated errors of the draws (table 1) against those at the true values (first row of table 2): the noise
    # of a draw, of which they are made, is known to 1 / sqrt(2 x 408) = 3.5 %, of two to 2.5 %; soft_l1 adds 1 %.
    first, second = (part.splitlines()[2:] for part in outcome.text.split("\n\n") if part.startswith("|"))
    stated = [float(row.split("|")[5]) / true for row, true in zip(first, study.TRUE.values(), strict=True)]
    theory = [float(cell) / 100 for cell in second[0].split("|")[2:6]]
    assert stated == pytest.approx(theory, rel=0.06)
