"""Random input ends in a fault in one sentence or in a valid run: the first cases of `validation/fuzz.py`."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from random import Random

import pytest
import yaml

from validation import fuzz
from validation.fuzzing import cases, judgement
from validation.fuzzing.judgement import judge
from validation.fuzzing.mutations import damaged
from validation.fuzzing.scenarios import scenario

pytestmark = pytest.mark.slow

COUNT = 50


def test_no_case_ends_in_a_fault() -> None:
    results = [(seed, outcome) for seed, outcome in fuzz.outcomes(range(COUNT), 1)]
    assert [(seed, outcome) for seed, outcome in results if outcome.is_fault] == []
    count = Counter(outcome.kind.split(":")[0].split(",")[0] for _, outcome in results)
    # A generator that is refused, or that never leaves the beaten track, tests nothing.
    assert count["engine"] > 0.1 * COUNT
    assert count["minimal"] > 0.1 * COUNT
    assert count["reduced"] > 0.01 * COUNT
    assert 0.2 * COUNT < count["refused"] < 0.7 * COUNT


def test_a_seed_is_a_case(tmp_path: Path) -> None:
    for seed in range(20):
        texts = set()
        for copy in "ab":
            folder = tmp_path / f"{seed}{copy}"
            folder.mkdir()
            texts.add(cases.write(seed, folder).read_text(encoding="utf-8"))
        assert len(texts) == 1


def test_damage_is_damage() -> None:
    text = yaml.safe_dump(scenario(Random(1)))
    assert sum(damaged(Random(seed), text) != text for seed in range(100)) > 95


@pytest.mark.parametrize(
    ("broken", "kind"),
    [
        (lambda *_: 1 / 0, "traceback"),
        (lambda *_: [].append, "traceback"),
        (lambda *_: (_ for _ in ()).throw(judgement.SolveError("two\nlines")), "bad sentence"),
    ],
)
def test_a_traceback_or_bad_sentence_is_judged_a_fault(
    monkeypatch: pytest.MonkeyPatch, broken: object, kind: str
) -> None:
    monkeypatch.setattr(judgement, "run", broken)
    assert judge(cases.ROOT / "configs" / "pendulum.yaml").kind == kind


def test_a_hang_is_judged_late(monkeypatch: pytest.MonkeyPatch) -> None:
    def hang(*_: object) -> None:
        while True:
            pass

    monkeypatch.setattr(judgement, "run", hang)
    monkeypatch.setattr(judgement, "LIMIT", 0.2)
    assert judge(cases.ROOT / "configs" / "pendulum.yaml").kind == "late"


def test_nan_in_results_is_judged_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = judgement.run

    def spoilt(*arguments: object) -> object:
        results = honest(*arguments)
        results.table[-1, 3] = float("nan")
        return results

    monkeypatch.setattr(judgement, "run", spoilt)
    assert judge(cases.ROOT / "configs" / "pendulum_rigid.yaml").kind == "not finite"
