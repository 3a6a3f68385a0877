"""The choice of steps from accelerations, against its equations by hand (`mechanics.stepping`)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from granular_contact.mechanics.kernels import step_choice
from granular_contact.mechanics.kernels.step_error import CHANGES, EACH, MEAN, NONE

STEP, ACCURACY, SPEED = 2e-3, 1e-2, 0.5  # s, -, m/s


def need(changes: list[float], groups: list[int], *, excess: float, both: float, expected: bool = True) -> float:
    """How many times too long a step was in which accelerations changed so (m/s2), as in the one before if expected."""
    change = np.array(changes)
    zeros, ones = np.zeros_like(change), np.ones_like(change)
    arrays = {"a": change, "v": SPEED * ones, "lever": ones, "start": zeros, "change": zeros.copy()}
    arrays |= {"slope": change / STEP if expected else zeros, "group": np.array(groups), "means": np.zeros(0, MEAN)}
    choice = np.zeros(1, step_choice.CHOICE)
    choice["accuracy"], choice["excess"], choice["both"] = ACCURACY, excess, both
    needed, _ = step_choice.judge(CHANGES.addresses(arrays), STEP, choice, SPEED, SPEED)
    return float(needed)


@pytest.mark.parametrize("excess", [0.0, 0.2])
def test_position_error_includes_velocity_errors_over_the_run(excess: float) -> None:
    """h (excess 7 + 3 / 12) / v: what counts not by itself, as links that bend, is in the first term alone."""
    drift = STEP * (excess * 7.0 + 3.0 / 12.0) / SPEED
    needed = need([3.0, 7.0], [EACH, NONE], excess=excess, both=0.0)
    assert needed == pytest.approx(math.sqrt(drift / ACCURACY), rel=1e-12)


def test_a_slow_motion_is_held_to_its_own_speed() -> None:
    needed = need([3.0], [EACH], excess=0.0, both=0.3)
    assert needed == pytest.approx(math.sqrt(STEP * 0.3 * 3.0 / SPEED / ACCURACY), rel=1e-12)


def test_a_jump_of_the_force_acts_for_half_of_the_step() -> None:
    needed = need([300.0], [EACH], excess=0.0, both=0.0, expected=False)
    assert needed == pytest.approx(0.5 * STEP * 300.0 / SPEED / ACCURACY, rel=1e-12)
