"""Numbers between the steps of a history: the same as of a fine sample of its cubics."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from granular_contact.results.interpolation import Track, above_zero, at_times, first_above_zero, greatest

FINE = 401  # samples a step, its ends among them


def history(seed: int) -> tuple[np.ndarray, list[Track]]:
    """Uneven steps, and quantities of several sizes that wave a few times in them and cross zero or not."""
    random = np.random.default_rng(seed)
    time = np.cumsum(random.uniform(0.01, 0.1, 40))
    tracks = []
    for offset in (-3.0, -0.5, 0.0, -1.05):
        phase, speed = random.uniform(0.0, 6.0), random.uniform(3.0, 30.0)  # up to half a wave in a step
        wave = np.sin(speed * time + phase)
        tracks.append(Track(wave + offset, speed * np.cos(speed * time + phase)))
    return time, tracks


def sampled(time: np.ndarray, tracks: list[Track]) -> tuple[np.ndarray, np.ndarray]:
    """Fine instants, and the greatest of all quantities at each."""
    fine = np.concatenate([np.linspace(a, b, FINE) for a, b in pairwise(time)])
    return fine, np.max([at_times(time, *track, fine) for track in tracks], axis=0)


@pytest.mark.parametrize("seed", range(12))
def test_extremes_between_steps_agree_with_fine_sampling(seed: int) -> None:
    time, tracks = history(seed)
    fine, most = sampled(time, tracks)
    best, when = greatest(time, tracks)
    # A sample misses an extreme by its spacing squared: (0.1 / 800)^2 times half a curvature of up to 30^2 of it.
    assert most.max() - 1e-12 <= best <= most.max() + 1e-5
    assert best == pytest.approx(max(float(at_times(time, *track, np.array([when]))[0]) for track in tracks), abs=1e-12)
    spans = above_zero(time, tracks)
    inside = np.any([(fine > a) & (fine < b) for a, b in spans], axis=0) if spans else np.zeros(len(fine), bool)
    clear = np.abs(most) > 1e-9
    assert np.array_equal(inside[clear][1:-1], (most > 0.0)[clear][1:-1])
    assert first_above_zero(time, tracks) == (spans[0][0] if spans else None)


def test_a_touch_within_a_single_step_is_detected() -> None:
    # The cubic 4 x (1 - x) h - d of a step is above zero in its middle alone.
    time = np.array([0.0, 1.0, 2.0])
    track = Track(np.full(3, -0.9), np.array([4.0, -4.0, 0.0]))
    (span,) = above_zero(time, [track])
    assert span == pytest.approx((0.5 - 0.5 * np.sqrt(0.1), 0.5 + 0.5 * np.sqrt(0.1)))
    assert first_above_zero(time, [track]) == span[0]
    assert greatest(time, [track]) == pytest.approx((0.1, 0.5))
    assert first_above_zero(time, [Track(track.values - 0.2, track.rates)]) is None


def test_a_quantity_growing_from_zero_is_above_zero_from_the_start() -> None:
    track = Track(np.array([0.0, 0.5, 0.8]), np.array([0.7, 0.4, 0.2]))
    time = np.array([0.0, 1.0, 2.0])
    assert above_zero(time, [track]) == [(0.0, 2.0)]
    assert first_above_zero(time, [track]) == 0.0
