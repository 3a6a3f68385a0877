"""Layers in space: parts of facets between two depths, layers of one medium as one bed, and those of the plane."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from support_parts import called
from support_space import FLAT, PAIRS, SAND, Motion, both, driven, load_on, message

from granular_contact import Bar, Layer, Plate, Rft
from granular_contact.sand.contact_lines import polyline
from granular_contact.sand.kernels.facet_parts import between
from granular_contact.sand.load import GranularLoad

BOUNDS = ((0.0, 0.013), (0.013, 0.04), (0.04, np.inf))


def test_the_part_of_a_facet_between_two_depths_has_its_area_and_moments() -> None:
    """Against sums over points of triangles and parallelograms that lie across both depths, one of them, or none."""
    random, n = np.random.default_rng(1), 300
    u, v = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n, indexing="ij")
    a, b = u, v
    inside = a + b < 1.0
    a, b, top, bottom = a[inside], b[inside], 0.2, 0.5
    for _ in range(12):
        first, second = random.normal(size=(2, 3))
        z, dz = random.uniform(-0.2, 0.9), random.normal(size=3) * 0.4
        d = a[:, None] * first + b[:, None] * second + (1.0 - a - b)[:, None] * (-first - second)
        e = (2.0 * u.ravel() - 1.0)[:, None] * first + (2.0 * v.ravel() - 1.0)[:, None] * second
        depth, wide = z + d @ dz, z + e @ dz
        for four, points, z_of in ((False, d, depth), (True, e, wide)):
            part = (z_of > top) & (z_of < bottom)
            computed = called(between)(four, z, dz @ first, dz @ second, tuple(first), tuple(second), top, bottom)
            moments = [part.mean(), np.mean(part * z_of), *np.mean(part[:, None] * points, axis=0)]
            moments += [*np.mean((part * z_of)[:, None] * points, axis=0)]
            np.testing.assert_allclose(computed, moments, atol=2e-2)
            np.testing.assert_allclose(computed[:2], moments[:2], atol=5e-3)


# Of bars closed forms with cancellation, see `tests/kernels/test_layers.py`.
@pytest.mark.parametrize(("name", "close"), [("rft3d", 1e-12), ("drft", 1e-12), ("lee_marghitu", 1e-9)])
def test_layers_of_one_medium_are_the_whole_bed(name: str, close: float) -> None:
    medium, shape = PAIRS[name]
    layers = [Layer(medium, *bounds) for bounds in BOUNDS]
    single, layered = (
        driven(load_on(media, shape, 0.03, slope=(0.2, -0.1, 0.0)), Motion(4)).history.bodies
        for media in (medium, layers)
    )
    assert np.abs(single).max() > 0.1
    np.testing.assert_allclose(layered, single, rtol=0.0, atol=close * np.abs(single).max())


@pytest.mark.parametrize("deep", [0.02, 0.5], ids=["within", "below"])
def test_a_plate_in_layers_is_that_of_the_plane(deep: float) -> None:
    layers = (Layer(SAND, 0.0, deep), Layer(Rft(zeta=2.0), deep))
    flat = GranularLoad(layers, 0.0)
    flat.add(polyline(FLAT, [[-0.05, 0.0], [0.05, 0.0]], width=0.06))
    planar, spatial = both(flat, load_on(layers, Plate((0.1, 0.06))), spin=0.0)
    assert np.abs(planar).max() > 0.5
    np.testing.assert_allclose(spatial, planar, rtol=1e-10, atol=1e-10)
    # The layer is felt: what is below it alone would give another force.
    alone = GranularLoad(SAND, 0.0)
    alone.add(polyline(FLAT, [[-0.05, 0.0], [0.05, 0.0]], width=0.06))
    whole = both(alone, load_on(SAND, Plate((0.1, 0.06))), spin=0.0)[0]
    assert (np.abs(whole - planar).max() > 0.1 * np.abs(planar).max()) == (deep < 0.1)


def test_a_bar_in_layers_is_that_of_the_plane() -> None:
    layers = (Layer(PAIRS["lee_marghitu"][0], 0.0, 0.02), Layer(PAIRS["hill"][0], 0.02))
    flat = GranularLoad(layers, 0.0, end_cap=True)
    flat.add(polyline(FLAT, [[-0.08, 0.0], [0.08, 0.0]], diameter=0.008))
    bar = Bar([[-0.08, 0.0, 0.0], [0.08, 0.0, 0.0]], 0.008)
    planar, spatial = both(flat, load_on(layers, bar, end_cap=True), spin=4.0)
    assert np.abs(planar).max() > 0.05
    np.testing.assert_allclose(spatial, planar, rtol=1e-9, atol=1e-9 * np.abs(planar).max())


def test_a_ball_in_layers_is_refused_in_a_line() -> None:
    ball: Any = PAIRS["ball"]
    refusal = message(load_on, Layer(ball[0], 0.0, 0.1), ball[1])
    assert refusal == "bed: a ball is met as a whole, but the bed has layers: allowed is one medium"
