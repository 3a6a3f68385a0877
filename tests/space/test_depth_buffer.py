"""Views in space show what is nearest to the eye, everywhere; edges and distance tell bodies apart."""

from __future__ import annotations

import numpy as np
import pytest

from granular_contact.report.figures.depth_buffer import EDGE, seen
from granular_contact.report.figures.space_views import MOST, _most_of_each
from granular_contact.sand.space.shapes import Box

LOW, HIGH, PIXELS = np.array([-1.0, -1.0]), np.array([1.0, 1.0]), 100
BLUE = np.array([0.2, 0.4, 0.8])


def square(z: tuple[float, float]) -> np.ndarray:
    """Two triangles (2, 3, 3) over most of the picture, at these distances on its left and right."""
    a, b, c, d = ([x, y, z[x > 0]] for x, y in ((-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)))
    return np.array([[a, b, c], [a, c, d]])


def test_planes_that_cross_are_each_seen_where_they_are_in_front() -> None:
    """No order of drawing gives this."""
    first, second = square((-1.0, 1.0)), square((1.0, -1.0))
    both = np.concatenate([first, second])
    picture = seen(both, np.array([0, 0, 1, 1]), BLUE, LOW, HIGH, PIXELS)
    alone = [seen(each, np.zeros(2, int), BLUE, LOW, HIGH, PIXELS) for each in (second, first)]
    left, right = np.s_[20:80, 10:40], np.s_[20:80, 60:90]
    for place, expected in ((left, alone[0]), (right, alone[1])):
        shades = picture[place][..., :3].mean(axis=(0, 1)), expected[place][..., :3].mean(axis=(0, 1))
        np.testing.assert_allclose(*shades, atol=0.02)
    middle = picture[50, 40:60, :3].min(axis=0)
    assert (middle < 1.3 * EDGE * BLUE + 0.2).all()  # where they meet there is an edge
    assert picture[0, 0, 3] == 0.0


def test_distant_faces_are_paler() -> None:
    near, far = 0.4 * square((1.0, 1.0)) + [0.5, 0, 0], 0.4 * square((-1.0, -1.0)) - [0.5, 0, 0]
    picture = seen(np.concatenate([near, far]), np.array([0, 0, 1, 1]), BLUE, LOW, HIGH, PIXELS)
    assert picture[50, 25, :3].sum() > 1.2 * picture[50, 75, :3].sum()


@pytest.mark.parametrize("turn", np.linspace(0.1, 6.0, 5))
def test_a_closed_body_has_no_holes(turn: float) -> None:
    """A box is convex: what is covered of each row is an interval."""
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    triangles = Box((1.0, 0.6, 0.4)).corners() @ turned.T
    covered = seen(triangles, np.zeros(len(triangles), int), BLUE, LOW, HIGH, PIXELS)[..., 3] > 0
    assert covered.sum() > 500
    assert np.abs(np.diff(covered.astype(int), axis=1)).sum(axis=1).max() == 2


def test_large_parts_get_the_triangles_that_small_parts_leave() -> None:
    """A wheel with grousers beside many small parts keeps its teeth: an equal share for each took them away."""
    assert _most_of_each([12] * 40 + [2000]) >= 2000
    numbers = [12, 500, 4000, 6000]
    each = _most_of_each(numbers)
    assert 12 + 500 + 2 * each in (MOST - 1, MOST)
    assert _most_of_each([100] * 1000) == 60
    assert _most_of_each([0]) >= 1
