"""The quick form of error_vs_run_time, and its Pareto front by hand."""

from __future__ import annotations

import numpy as np
import pytest

from validation import error_vs_run_time as study

pytestmark = pytest.mark.slow

NONE = dict.fromkeys(study.KEYS, 0.0)


def point(error: float, milliseconds: float, failure: str = "") -> study.Point:
    setting = study.Setting("a", f"{error}", ("method=engine",))
    return study.Point(setting, dict.fromkeys(study.KEYS, error), [1e-3 * milliseconds], failure)


def test_front_keeps_what_nothing_beats() -> None:
    fast, slow, beaten, broken = point(9.0, 1.0), point(1.0, 5.0), point(9.5, 2.0), point(0.0, 0.1, "failed: no")
    assert study.front([slow, beaten, broken, fast], "tip", NONE) == [fast, slow]
    factor, best = study.distance(beaten, [slow, beaten, broken, fast], "tip", NONE)
    assert best is fast
    assert factor == pytest.approx(2.0)


def test_errors_below_the_uncertainty_are_equal() -> None:
    """What the reference cannot tell apart is ranked by time alone."""
    fast, slow = point(0.2, 1.0), point(0.1, 2.0)
    assert study.front([fast, slow], "stop", dict.fromkeys(study.KEYS, 0.5)) == [fast]
    assert study.front([fast, slow], "stop", NONE) == [fast, slow]


def test_an_error_right_by_chance_is_ranked_by_finer_steps() -> None:
    coarse, lucky, fine = point(9.0, 1.0), point(0.1, 2.0), point(1.0, 5.0)
    study.rank([coarse, lucky, fine])
    assert [p.ranked["angle"] for p in (coarse, lucky, fine)] == [9.0, 1.0, 1.0]
    assert study.front([coarse, lucky, fine], "angle", NONE) == [coarse, lucky]


def test_errors_of_a_known_shift() -> None:
    time = np.linspace(0.0, 0.04, 5)
    truth = study.Path40(time, np.zeros((5, 2)), np.zeros(5), 0.025, 35.0, 1.0)
    shifted = study.Path40(time, np.tile([3e-6, 4e-6], (5, 1)), np.full(5, 2e-6), 0.024999, 35.002, 1.0)
    assert study.errors(shifted, truth) == pytest.approx({"tip": 5.0, "stop": 1.0, "angle": 2.0, "bend": 2.0})


@pytest.fixture(scope="module")
def outcome() -> study.Outcome:
    return study.study(quick=True)


def test_accuracy_claims_hold(outcome: study.Outcome) -> None:
    """Only claims that no other process on the machine can spoil; those about time are the study's own business."""
    held = {claim.name.removeprefix("error_vs_run_time."): claim.held for claim in outcome.claims}
    assert len(held) == len(outcome.claims)
    assert all(
        held[name]
        for name in ("reference_uncertainty", "fe_default_stopping_time", "fe_default_angle_at_stop", "nothing_failed")
    )


def test_every_default_is_measured_and_every_refusal_explained(outcome: study.Outcome) -> None:
    for name in (study.FE_DEFAULT, "rigid, defaults", "1 mode, defaults"):
        assert f"| **{name}** |" in outcome.text
    assert outcome.text.count("does not apply: explicit solvers of Exudyn refuse joints") == 10
    assert "it ran" not in outcome.text


def test_modes_converge_on_the_beam() -> None:
    """2 modes come ten times closer to the beam than a rigid link does (47 against 2.3 um when written)."""
    truth = study.simulate(study.beam(16, 5e-5))
    rigid, two = (study.errors(study.simulate(study.modal(n, "elastoplastic", 1e-6)), truth)["tip"] for n in (0, 2))
    assert 40.0 < rigid < 55.0
    assert two < 0.1 * rigid


def test_a_finer_step_costs_accuracy_nothing() -> None:
    truth = study.simulate(study.beam(4, 2e-5))
    coarse, fine = (study.errors(study.simulate(study.beam(4, h)), truth) for h in (1e-3, 1e-4))
    assert all(fine[key] < 0.2 * coarse[key] for key in study.KEYS)


def test_default_names_the_schema_default() -> None:
    """The bold row is what a user gets: the same numbers as the config without any override."""
    plain = study.simulate(study.Setting("plain", "plain", ("method=engine",)))
    named = study.simulate(study.beam(4, 2e-4))
    assert (plain.stop, plain.angle) == (named.stop, named.angle)
