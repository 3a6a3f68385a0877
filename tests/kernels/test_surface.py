"""The compiled height of the free surface against numpy's."""

from __future__ import annotations

import numpy as np
from support_parts import called

from granular_contact.geometry.surface import height_at, surface
from granular_contact.sand.kernels.surface import depth, height


def test_profile_is_level_beyond_its_corners_and_straight_between() -> None:
    random = np.random.default_rng(1)
    for _ in range(20):
        corners = np.column_stack([np.cumsum(random.uniform(0.01, 1.0, 4)), random.normal(size=4)])
        profile, x = surface(corners), random.uniform(-5.0, 10.0, 50)
        expected = np.interp(x, *corners.T)
        np.testing.assert_allclose([called(height)(profile, at)[0] for at in x], expected, atol=1e-14)
        np.testing.assert_allclose(height_at(profile, x), expected, atol=1e-14)
        assert called(height)(profile, -100.0) == (corners[0, 1], 0.0)
        assert called(height)(profile, 100.0) == (corners[-1, 1], 0.0)


def test_slope_goes_on_without_end() -> None:
    plane = surface(np.array([[0.0, -0.2]]), 0.3)
    for x in (-1e5, -1.0, 0.0, 2e3, 1e5):
        level, slope = called(height)(plane, x)
        np.testing.assert_allclose((level, slope), (-0.2 + 0.3 * x, 0.3), rtol=1e-14)
        assert called(depth)(plane, x, 1.0) == level - 1.0
    assert called(height)(surface(np.array([[0.0, -0.2]])), 7.0) == (-0.2, 0.0)
