"""Means over strides and numbers of drives, of histories whose integrals are known."""

from __future__ import annotations

import numpy as np
import pytest

from granular_contact.results.energy import accumulate
from granular_contact.results.interpolation import squared
from granular_contact.results.summary import Driving, drive_numbers, stride_numbers
from granular_contact.scene.signal_tables import period
from granular_contact.scene.signals import Buehler, Constant, Sine


def test_strides_that_grow_have_their_mean_and_scatter() -> None:
    """Strides of 0.5 s, 10 cm more each; power 2 sin(2 pi t / T) W puts 2 T / pi J into each."""
    time = np.linspace(0.0, 2.2, 4401)
    ends = 2.2 - 0.5 * np.arange(5)[::-1]  # 0.2, 0.7, ...
    place = np.interp(time, ends, [0.0, 0.1, 0.3, 0.6, 1.0])
    power = 2.0 * np.sin(2.0 * np.pi * (time - 0.2) / 0.5)
    numbers = stride_numbers(time, place, [power], [0.5 * power], weight=5.0, period=0.5)
    assert numbers is not None
    assert numbers["count"] == 3  # the first, in which a gait sets in, is left out
    assert numbers["distance_m"]["mean"] == pytest.approx(0.3)
    assert numbers["speed_m_s"] == pytest.approx({"mean": 0.6, "standard_deviation": 0.2})
    # Trapezoids of 0.5 ms: the error of a sine is (2 pi h / T)^2 / 12 of it, 3e-6.
    assert numbers["drive_work_put_in_J"]["mean"] == pytest.approx(1.0 / np.pi, rel=1e-5)
    assert numbers["largest_drive_torque_Nm"]["mean"] == pytest.approx(1.0, rel=1e-4)
    costs = [1.0 / np.pi / (5.0 * way) for way in (0.2, 0.3, 0.4)]
    assert numbers["cost_of_transport"]["mean"] == pytest.approx(np.mean(costs), rel=1e-5)
    assert numbers["cost_of_transport"]["standard_deviation"] == pytest.approx(np.std(costs, ddof=1), rel=1e-4)
    assert stride_numbers(time[:1900], place[:1900], [power[:1900]], [], 5.0, 0.5) is None  # 0.95 s: one whole stride


def test_strides_that_just_fit_are_counted() -> None:
    for whole, count in ((2, 2), (3, 2), (4, 3)):  # of three and more the first is left out
        time = 0.7 + np.linspace(0.0, 0.5 * whole, 20 * whole + 1)
        numbers = stride_numbers(time, time, [], [], 5.0, 0.5)
        assert numbers is not None
        assert numbers["count"] == count
        assert numbers["distance_m"] == pytest.approx({"mean": 0.5, "standard_deviation": 0.0})


def test_cost_of_transport_needs_travel_and_weight() -> None:
    time = np.linspace(0.0, 2.0, 81)
    for place, weight, has in ((time, 5.0, True), (0.0 * time, 5.0, False), (time, 0.0, False)):
        numbers = stride_numbers(time, place, [np.ones_like(time)], [], weight, 0.5)
        assert numbers is not None
        assert ("cost_of_transport" in numbers) == has


def test_numbers_of_a_drive() -> None:
    time = np.linspace(0.0, 1.0, 2001)
    torque, rate = 3.0 * np.sin(2 * np.pi * time), 2.0 * np.sin(2 * np.pi * time)
    numbers = drive_numbers(time, Driving(torque, torque * rate, accumulate(time, torque * rate)), rate, rotary=True)
    assert numbers["largest_torque_Nm"] == pytest.approx(3.0, rel=1e-5)
    assert numbers["rms_torque_Nm"] == pytest.approx(3.0 / np.sqrt(2), rel=1e-6)
    assert numbers["work_J"] == pytest.approx(3.0, rel=1e-6)
    assert numbers["mean_power_W"] == numbers["work_J"] == pytest.approx(numbers["work_put_in_J"])
    jumps = np.array([[0.4001 - 1e-10, -7.0, 8.0], [0.4001 + 1e-10, 6.0, -9.0]])  # sampled by no step
    back = Driving(torque, -torque * rate, accumulate(time, -torque * rate), jumps)
    numbers = drive_numbers(time, back, -rate, rotary=False)
    assert (numbers["work_put_in_J"], numbers["largest_force_N"], numbers["largest_power_W"]) == (0.0, 7.0, 8.0)


def test_a_run_that_ended_as_it_began_has_no_means() -> None:
    numbers = drive_numbers(np.zeros(1), Driving(np.full(1, 3.0), np.zeros(1), np.zeros(1)), np.zeros(1), rotary=True)
    assert (numbers["largest_torque_Nm"], numbers["rms_torque_Nm"], numbers["mean_power_W"]) == (3.0, 0.0, 0.0)


def test_mean_square_of_few_steps_is_that_of_many_steps() -> None:
    """A controller's torque that fades from its start on by two thirds a step, and one that swings in 12 steps."""
    fading = np.exp(-np.linspace(0.0, 20.0, 20))
    assert squared(np.linspace(0.0, 20.0, 20), fading) == pytest.approx(0.5, rel=0.06)  # trapezoids: 34 % too much
    time = np.cumsum(np.r_[0.0, np.tile([0.04, 0.06, 0.05], 8)])
    swing = np.sin(2.0 * np.pi * time / 0.6)
    assert squared(time, swing) == pytest.approx(0.5 * time[-1], rel=5e-3)


def test_mean_square_does_not_overshoot_beside_a_short_step() -> None:
    time, values = np.array([0.0, 1.0, 1.001, 2.0, 3.0]), np.array([0.0, 0.0, 1.0, 1.0, 1.0])
    assert squared(time, values) == pytest.approx(2.0, rel=1e-3)


def test_a_jump_between_steps_is_no_slope_in_the_mean_square() -> None:
    """Of a torque that jumps in the middle of one of five steps, from 1 to 3 N m."""
    time, torque = np.arange(6.0), np.array([1.0, 1.0, 1.0, 3.0, 3.0, 3.0])
    jumps = np.array([[2.5 - 1e-10, 1.0, 0.0], [2.5 + 1e-10, 3.0, 0.0]])
    numbers = drive_numbers(time, Driving(torque, 0.0 * torque, 0.0 * torque, jumps), 0.0 * time, rotary=True)
    assert numbers["rms_torque_Nm"] == pytest.approx(np.sqrt((2.5 + 9 * 2.5) / 5.0))


def test_only_signals_that_repeat_have_a_period() -> None:
    assert period(Sine(amplitude=1.0, omega=-4.0 * np.pi, phase=0.0, offset=0.0)) == pytest.approx(0.5)
    assert period(Buehler(frequency=2.0, sweep=1.0, offset=0.0, duty=0.5, phase=0.0, blend=0.1)) == 0.5
    assert period(Constant(1.0)) is None
    assert period(Sine(amplitude=0.0, omega=4.0, phase=0.0, offset=1.0)) is None
