"""Times of stops and of rest between rows of uneven steps, against motions whose stop is known."""

from __future__ import annotations

import numpy as np
import pytest

from granular_contact.results.stopping import find_rest, find_stop, find_turn

TIME = np.array([0.0, 0.11, 0.13, 0.3, 0.34, 0.6, 0.95, 1.0, 1.4, 1.45])  # s


@pytest.mark.parametrize(
    ("first", "slope", "bend"),
    [
        (3.0, -5.0, 0.0),  # a constant torque
        (3.0, -5.0, 1.5),
        (-3.0, 5.0, -1.5),
        (0.2, 2.0, -4.0),  # goes faster first; its parabola has a zero just before the start, too
    ],
)
def test_stop_of_a_parabolic_rate_is_its_zero(first: float, slope: float, bend: float) -> None:
    rate, acceleration = first + slope * TIME + bend * TIME**2, slope + 2.0 * bend * TIME
    angle = first * TIME + slope * TIME**2 / 2.0 + bend * TIME**3 / 3.0
    stop = find_stop(TIME, rate, acceleration, angle, rate)
    assert stop is not None
    zeros = np.roots([bend, slope, first]) if bend else np.array([-first / slope])
    at = min(zeros[zeros > 0.0])
    assert stop.time == pytest.approx(at, rel=1e-12)
    assert stop.angle == pytest.approx(first * at + slope * at**2 / 2.0 + bend * at**3 / 3.0, rel=1e-12)
    assert stop.hub_time == pytest.approx(at, rel=1e-9)
    assert find_stop(TIME, rate, acceleration, angle, rate, hub=False) == type(stop)(stop.time, stop.angle, None)
    assert find_stop(TIME[:2], rate[:2], acceleration[:2], angle[:2], rate[:2]) is None  # not yet


def test_stop_within_the_first_step_assumes_even_deceleration() -> None:
    rate, slope = 2.0 - 3.0 * (early := np.array([0.0, 1.0])), np.full(2, -3.0)
    stop = find_stop(early, rate, slope, 0.0 * early, rate)
    assert stop is not None
    assert stop.time == pytest.approx(2.0 / 3.0, rel=1e-12)


def test_turn_under_even_deceleration_is_exact() -> None:
    speed = -1.0 + 1.25 * TIME
    assert find_turn(TIME, speed, 0.0 * TIME, speed) == pytest.approx(0.8, rel=1e-12)
    assert find_turn(TIME[:6], speed[:6], 0.0 * TIME[:6], speed[:6]) is None


def test_rest_begins_where_the_speed_got_below_the_bound() -> None:
    even = np.maximum(1.0 - TIME, 0.0)  # is 0.2 at 0.8 s, between two rows
    assert find_rest(TIME, even, 0, 0.2, 0.4) == pytest.approx(0.8, rel=1e-12)
    # What stops at once does so within the step: at its end at the latest.
    sudden = np.where(TIME < 0.5, 1.0 - TIME, 0.0)
    assert find_rest(TIME, sudden, 0, 0.2, 0.4) == pytest.approx(0.6, rel=1e-12)
    # One that speeds up before tells no time: the end of the step is taken.
    assert find_rest(TIME, np.where(TIME < 0.5, 1.0 + TIME, 0.0), 0, 0.2, 0.4) == pytest.approx(0.6, rel=1e-12)
    assert find_rest(TIME, even, 0, 0.2, 0.6) is None  # did not last
    assert find_rest(TIME, even, 8, 0.2, 0.4) is None  # touched after it
    assert find_rest(TIME, np.ones_like(TIME), 0, 0.2, 0.4) is None
