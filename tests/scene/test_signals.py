"""Signals: derivatives by differences, and the promised properties of each kind."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from granular_contact.scene.signals import Buehler, Constant, Ramp, Signal, Sine, Smoothed, jumps, piecewise

TIMES, VALUES = np.array([0.0, 0.2, 0.5, 0.6, 1.0]), np.array([0.0, 1.0, 0.5, 0.6, 2.0])
LINEAR = piecewise(TIMES, VALUES, cubic=False)
SIGNALS = {
    "constant": Constant(3.0),
    "sine": Sine(0.3, 5.0, 1.0, 0.2),
    "ramp": Ramp(1.0, 3.0, 0.2, 0.5),
    "buehler": Buehler(1.3, 1.0, 1.5, 0.6, 0.2, 0.1),
    "buehler, all blend": Buehler(0.7, 2.0, 1.5, 0.5, 0.0, 0.5),
    "cubic": piecewise(TIMES, VALUES, cubic=True),
    "linear": piecewise(TIMES, VALUES, cubic=False),
    "smoothed": Smoothed(LINEAR, jumps(LINEAR), 0.05),
    "smoothed over neighbours": Smoothed(LINEAR, jumps(LINEAR), 0.3),
}


@pytest.mark.parametrize("name", SIGNALS)
def test_rate_and_acceleration_are_derivatives(name: str) -> None:
    signal: Signal = SIGNALS[name]
    step = 1e-5
    # Instants away from the corners of the tables, which have one-sided derivatives.
    for t in np.arange(0.0123, 1.5, 0.0317):
        slope = (signal.value(t + step) - signal.value(t - step)) / (2 * step)
        bend = (signal.rate(t + step) - signal.rate(t - step)) / (2 * step)
        # Central differences: step^2 / 6 times derivatives of up to 1e5, and round-off of 1e-16 / step.
        assert signal.rate(t) == pytest.approx(slope, abs=2e-6)
        assert signal.acceleration(t) == pytest.approx(bend, abs=2e-5)


def test_sine_by_hand() -> None:
    sine = Sine(0.3, 2.0, math.pi / 2, 0.1)
    assert sine.value(0.0) == pytest.approx(0.4, rel=1e-15)
    assert sine.value(math.pi / 2) == pytest.approx(-0.2, rel=1e-15)


def test_ramp_starts_and_ends_at_rest() -> None:
    ramp = Ramp(1.0, 3.0, 0.2, 0.5)
    assert [ramp.value(t) for t in (0.0, 0.2, 0.45, 0.7, 9.0)] == pytest.approx([1, 1, 2, 3, 3], rel=1e-15)
    assert [ramp.rate(t) for t in (0.1, 0.2, 0.7, 0.8)] == pytest.approx([0.0] * 4, abs=1e-15)


def test_buehler_clock_sweeps_its_stance_in_its_share_of_the_time() -> None:
    clock = Buehler(frequency=2.0, sweep=1.0, offset=1.5, duty=0.6, phase=0.0, blend=0.1)
    assert clock.value(0.0) == pytest.approx(1.5, rel=1e-15)
    # The blends lie on either side of the kink at 0.3 of a turn's time: outside of them the clock is the unblended one.
    for share in (0.1, 0.2, 0.25):
        assert clock.value(share / 2.0) == pytest.approx(1.5 + share / 0.6, rel=1e-14)
        assert clock.rate(share / 2.0) == pytest.approx(2.0 * 1.0 / 0.6, rel=1e-14)
    assert clock.value(0.5 / 2.0) == pytest.approx(1.5 + math.pi, rel=1e-14)
    assert clock.rate(0.5 / 2.0) == pytest.approx(2.0 * (2 * math.pi - 1.0) / 0.4, rel=1e-14)


def test_buehler_clock_never_turns_back_and_turns_once_a_period() -> None:
    clock = Buehler(1.3, 5.8, 1.5, 0.3, 0.37, 0.2)  # a stance that is faster than the swing
    angles = np.array([clock.value(t) for t in np.linspace(0.0, 5.0, 5001)])
    assert np.diff(angles).min() > 0.0
    for t in (0.0, 0.4, 0.7):
        assert clock.value(t + 1 / 1.3) - clock.value(t) == pytest.approx(2 * math.pi, rel=1e-12)


def test_phase_is_time_ahead() -> None:
    ahead, clock = Buehler(1.3, 1.0, 1.5, 0.6, 0.25, 0.1), Buehler(1.3, 1.0, 1.5, 0.6, 0.0, 0.1)
    for t in np.linspace(0.0, 2.0, 31):
        assert ahead.value(t) == pytest.approx(clock.value(t + 0.25 / 1.3), rel=1e-12)


def test_cubic_table_interpolates_monotonically_and_rests_at_its_ends() -> None:
    signal, peer = SIGNALS["cubic"], PchipInterpolator(TIMES, VALUES)
    # In the inner intervals the slopes are those of scipy; at the ends ours are zero, where the signal stays.
    for t in np.linspace(0.2, 0.6, 41):
        assert signal.value(t) == pytest.approx(float(peer(t)), rel=1e-12)
    assert signal.value(-1.0) == 0.0
    assert signal.value(2.0) == pytest.approx(2.0, rel=1e-15)
    assert signal.rate(0.0) == signal.rate(1.0) == 0.0


def test_linear_table_is_straight_between_its_values() -> None:
    signal = SIGNALS["linear"]
    for t in np.linspace(0.0, 1.0, 101):
        assert signal.value(t) == pytest.approx(np.interp(t, TIMES, VALUES), abs=1e-15)


def test_rates_jump_at_the_corners_of_a_linear_table_and_nowhere_else() -> None:
    computed = jumps(LINEAR)
    rates = [0.0, 5.0, -5.0 / 3.0, 1.0, 3.5, 0.0]
    assert [jump.time for jump in computed] == TIMES.tolist()
    np.testing.assert_allclose([(j.before, j.after) for j in computed], list(pairwise(rates)), rtol=1e-12)
    assert all(not jumps(signal) for name, signal in SIGNALS.items() if name != "linear")
    # Five digits of a straight line: its pieces differ by less than 1e-4.
    line = np.linspace(0.0, 1.0, 8)
    assert [jump.time for jump in jumps(piecewise(line, np.round(3.0 * line, 5), cubic=False))] == [0.0, 1.0]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["smoothed", "smoothed over neighbours"])
def test_a_smoothed_table_is_continuous_to_its_acceleration(name: str) -> None:
    signal: Signal = SIGNALS[name]
    t = np.linspace(-0.3, 1.5, 18001)  # every corner and every end of a blend is one of these
    for of, greatest in (
        (signal.value, 5.0),
        (signal.rate, 1.5 * 20.0 / 0.05),
        (signal.acceleration, 6.0 * 20.0 / 0.05**2),
    ):
        values = np.array([of(float(at)) for at in t])
        assert np.abs(np.diff(values)).max() < 1e-4 * greatest * 1.1


def test_a_smoothed_table_is_the_table_away_from_its_corners() -> None:
    for t in (0.03, 0.1, 0.17, 0.23, 0.4, 0.47, 0.53, 0.57, 0.63, 0.9, 1.03, 2.0):
        assert SIGNALS["smoothed"].value(t) == pytest.approx(LINEAR.value(t), abs=1e-15)
