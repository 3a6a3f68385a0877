"""The study of strips: one of its cases in whole, and how it judges."""

from __future__ import annotations

from validation import strips


def test_error_of_a_cut_solid_is_that_of_the_study() -> None:
    """A box that falls and tumbles: silent, exact by its strips, and within what was asked where both are chosen."""
    judged = strips.judge(strips.CASES["solid, poppy seeds"])
    assert not judged.told
    assert judged.errors[0] < 5e-4
    assert judged.errors[1] < 5e-4
    for (error, steps, _), accuracy in zip(judged.chosen, strips.ACCURACIES, strict=True):
        assert error < accuracy
        assert steps < 130  # of 12 500 fixed ones


def test_strips_that_are_too_long_are_reported_and_shortened() -> None:
    """A rod that strikes steeply and topples: 2 % off with 8 strips. A box on its corner, 0.3 % off, is not told of."""
    case = strips.CASES["rod, 3D-RFT, steep"]
    run = strips.simulate(case, 8, step_s=1e-4)
    assert any("strips on which the medium acts are too long" in sentence for sentence in run.warnings)
    chosen = strips.simulate(case, None, accuracy=1e-3)
    assert chosen.summary["strips"]["per_rigid_part"] > 16
    reference = strips.simulate(case, 128, step_s=5e-5)
    assert strips.error(chosen, reference) < 1e-3
    assert strips.error(run, reference) > 1e-2
    box = strips.simulate(strips.CASES["solid, 3D-RFT"], None, step_s=1e-4)
    assert not any("strips" in sentence for sentence in box.warnings)
