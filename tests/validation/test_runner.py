"""The study of the runner: its claims, and that they can fail."""

from __future__ import annotations

from dataclasses import replace

import pytest

from validation import runner as study

pytestmark = pytest.mark.slow

RISES = "runner.speed rises with limb frequency while legs carry the trunk"


@pytest.fixture(scope="module")
def designs() -> list[list[study.Gait]]:
    return list(study.gaits(quick=True).values())


def held(designs: list[list[study.Gait]]) -> dict[str, bool]:
    return {claim.name: claim.held for claim in study.claims(*designs)}


def test_all_claims_hold(designs: list[list[study.Gait]]) -> None:
    assert [name for name, holds in held(designs).items() if not holds] == []


def test_a_runner_that_stands_still_or_sinks_is_reported(designs: list[list[study.Gait]]) -> None:
    slow = [[replace(gait, speed=0.1) for gait in gaits] for gaits in designs]
    assert not held(slow)[RISES]
    assert not held(slow)["runner.a heavy trunk gets faster, then slower"]
    assert not held(slow)["runner.legs keep their footing on close-packed seeds"]
    sunk = [[replace(gait, depth=0.05, imbalance=0.01) for gait in gaits] for gaits in designs]
    assert not held(sunk)["runner.bodies do not sink without limit"]
    assert not held(sunk)["runner.energy is balanced"]
    firm = [designs[0], designs[0], designs[0]]
    assert not held(firm)["runner.legs lose footing on loose seeds with a short stance"]
    assert not held(firm)["runner.a heavy trunk gets faster, then slower"]
    stiff = [[replace(gait, rise=0.01) for gait in gaits] for gaits in designs]
    assert not held(stiff)["runner.the heavy trunk slows down where legs no longer lift it"]


def test_table_has_a_row_for_each_gait(designs: list[list[study.Gait]]) -> None:
    assert [[float(row[0]) for row in study.rows(gaits)] for gaits in designs] == [list(each) for each in study.QUICK]
