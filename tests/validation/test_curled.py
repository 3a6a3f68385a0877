"""The reported error of links in space with too few elements: where they curl, and as they vibrate."""

from __future__ import annotations

import numpy as np
import pytest

from granular_contact.mechanics.space.beams import drift
from validation import curled


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rope that falls", "soft rope that falls and curls"])
def test_strip_error_estimate_of_a_curling_rope_is_true(name: str) -> None:
    """From both sides: a link of 16 elements, 2 % off, was silent; estimates are 1 to 2 times the error here."""
    made = curled.CASES[name]
    fine = curled.found(made(64))
    for count in (8, 16, 32):
        outcome = curled.found(made(count))
        error = curled.error(outcome, fine)
        assert 0.6 * error < outcome.estimate < 3.0 * error, count
        assert outcome.told is (outcome.estimate > 0.01)


def test_strip_error_estimate_of_a_vibrating_rod_grows_with_its_phase() -> None:
    """From both sides: 4 elements are 2.9 % of the path off after two periods, which was silent; 8 are 0.7 % off."""
    made = curled.CASES["rod that vibrates twice"]
    fine = curled.found(made(16))
    for count, warned in ((4, True), (8, False)):
        outcome = curled.found(made(count))
        assert (
            0.5 < outcome.estimate / curled.error(outcome, fine) < 2.0
        )  # 1.05 and 1.3, as the fine one has 0.2 % itself
        assert outcome.told is warned


def test_a_wave_is_off_by_both_its_amplitudes_at_most() -> None:
    """A wave of number k and amplitude c of the curvature; its frequency is off by (k l)^2 / 12, of itself."""
    length, count, number, amplitude = 0.4, 8, 1.5 * np.pi / 0.4, 0.3
    along = np.cos(number * length * (np.arange(count) + 0.5) / count)
    for periods, times in ((2, 1.0), (40, 20.0)):
        t = np.linspace(0.0, 2.0 * np.pi * periods, 100 * periods + 1)
        curvatures = np.zeros((len(t), count, 2))
        curvatures[..., 1] = amplitude * np.cos(t)[:, None] * along
        behind = amplitude / number**2 * (number * length / count) ** 2 / 12.0 * 4.0 * np.pi
        expected = min(times * behind, 2.0 * amplitude / number**2)
        assert drift(curvatures, length, (False, True)) == pytest.approx(expected, rel=1e-2)
    assert expected < times * behind  # after 40 periods
