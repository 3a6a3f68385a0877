"""The study of the sensitivity of the stopping time: its claims, and that they can fail."""

from __future__ import annotations

import copy
from concurrent.futures import ThreadPoolExecutor

import pytest
from support_claims import held

from granular_contact.studies.sweep import WorkerPool
from validation import sensitivity as study

pytestmark = pytest.mark.slow

SIX, ONE_IMPACT = (design.name for design in study.DESIGNS)


@pytest.fixture(scope="module")
def indices() -> dict[str, list[study.Indices]]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(study, "WorkerPool", lambda: WorkerPool(1, ThreadPoolExecutor))
        return {design.name: study.indices(design, study.QUICK_COUNT) for design in study.DESIGNS}


def test_claims_hold(indices):
    assert len(held(study.claims(indices))) == 4
    assert all(held(study.claims(indices)).values())


@pytest.mark.parametrize(
    ("design", "output", "array", "value", "statement"),
    [
        (SIX, 0, "first", 0.2, "speed and angle decide the stopping time more than the sand does"),
        (SIX, 0, "total", 0.2, "speed and angle decide the stopping time more than the sand does"),
        (SIX, 0, "total_interval", 0.06, "eta_d hardly changes the stopping time"),
        (ONE_IMPACT, 0, "total_interval", 0.06, "eta_d hardly changes the stopping time"),
        (ONE_IMPACT, 0, "first", 0.4, "eta_v is the coefficient that decides the stopping time of one impact"),
        (ONE_IMPACT, 1, "first", 0.4, "eta_d decides where one impact stops"),
    ],
)
def test_claims_fall_with_other_indices(indices, design, output, array, value, statement):
    other = copy.deepcopy(indices)
    getattr(other[design][output], array)[...] = value
    assert not held(study.claims(other))[statement]


def test_table_has_a_line_for_each_input(indices):
    lines = study.table(indices[SIX]).splitlines()
    assert [line.split("|")[1].strip() for line in lines[2:]] == [*study.SYMBOLS.values(), "sum"]
