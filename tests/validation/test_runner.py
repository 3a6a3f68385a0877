"""The study of the runner: its claims, and that they can fail."""

from __future__ import annotations

from dataclasses import replace

import pytest

from validation import runner as study

SATURATES = "runner.speed saturates or falls by 8 Hz"


@pytest.fixture(scope="module")
def found() -> list[list[study.Gait]]:
    return [[study.gait(f, ground) for f in study.QUICK] for ground in study.GROUNDS.values()]


def held(found: list[list[study.Gait]]) -> dict[str, bool]:
    return {claim.name: claim.held for claim in study.claims(*found)}


def test_claims_hold_but_for_the_saturation_that_the_law_does_not_know(found: list[list[study.Gait]]) -> None:
    assert [name for name, holds in held(found).items() if not holds] == [SATURATES]


def test_a_runner_that_stands_still_or_sinks_is_told(found: list[list[study.Gait]]) -> None:
    slow = [[replace(gait, speed=0.1) for gait in gaits] for gaits in found]
    assert held(slow)[SATURATES]
    assert not held(slow)["runner.speed rises with limb frequency"]
    assert not held(slow)["runner.legs keep their footing on close-packed seeds"]
    sunk = [[replace(gait, depth=0.05, imbalance=0.01) for gait in gaits] for gaits in found]
    assert not held(sunk)["runner.bodies do not sink without bound"]
    assert not held(sunk)["runner.energy is balanced"]
    firm = [found[0], found[0]]
    assert not held(firm)["runner.legs lose footing on loose seeds with a short stance"]


def test_table_has_a_row_for_each_gait(found: list[list[study.Gait]]) -> None:
    assert [float(row[0]) for row in study.rows(found[0])] == list(study.QUICK)
