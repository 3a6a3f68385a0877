"""A floor in space: closed forms of pressed bodies, the floor in the plane, energy, tangent."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support_space import FLAT, PAIRS, PLAY, SAND, Array, Motion, both, driven, load_on, state

from granular_contact import Bar, Box, Floor, Plate, Poncelet, Rft, Sphere
from granular_contact.sand.contact_lines import polyline
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.load import GranularLoad

K, D = 2e6, 0.3  # N/m3, s/m
NOTHING = Rft(zeta=1e-12)


def pressed(shape: Any, depth: float, speed: float = 0.0, medium: Any = NOTHING, **options: Any) -> Array:
    """Force and moment (6,) of the floor at a height of -0.2 m alone, on what is so far (m) below it at the origin."""
    load = load_on(medium, shape, options.pop("size", None), floor=Floor(-0.2, K, D), **options)
    q, v = state(np.array([0.0, 0.0, -0.2 - depth]), Rotation.identity(), np.array([0.0, 0.0, speed]), np.zeros(3))
    load.start(q)
    load.accept(0.0, q, v)
    names = load.history.term_names
    wrench: Array = load.history.terms[0, names.index("floor")]
    return wrench


def test_a_floor_carries_bodies_as_a_field_of_parallel_springs() -> None:
    depth, speed = 1e-3, -0.05
    share = 1.0 - D * speed
    force = pressed(Plate((0.1, 0.06)), depth, speed)
    np.testing.assert_allclose(force[:3], [0.0, 0.0, K * 0.1 * 0.06 * depth * share], rtol=1e-12, atol=1e-12)
    bar = pressed(Bar([[-0.05, 0.0, 0.0], [0.05, 0.0, 0.0]], 0.008), depth, speed, PLAY)
    assert bar[2] == pytest.approx(K * 0.1 * 0.008 * depth * share, rel=1e-12)
    # A ball as a whole is what its surface is as facets: pi R k delta^2, until all of it is below.
    for below in (0.002, 0.05, 0.15):
        cap = min(below, 0.08)
        want = K * np.pi * (0.04 * cap**2 + 0.08**2 * (below - cap)) * share
        ball = pressed(Sphere(0.08, 2.0), below - 0.04, speed, Poncelet(1e-9, 1e-9))
        assert ball[2] == pytest.approx(want, rel=1e-12)
        assert pressed(Sphere(0.08), below - 0.04, speed, size=0.004)[2] == pytest.approx(want, rel=5e-3)
    # It pushes down on nothing, however fast a body leaves it.
    assert pressed(Plate((0.1, 0.06)), depth, 10.0)[2] == 0.0
    assert pressed(Plate((0.1, 0.06)), -1e-6)[2] == 0.0


def test_force_of_a_floor_in_space_is_that_in_the_plane() -> None:
    """Of the width of the plate times the stiffness; both are below the sand that the plate goes through."""
    width = 0.06
    flat = GranularLoad(SAND, 0.0, floor=Floor(-0.025, K * width, D))
    flat.add(polyline(FLAT, [[-0.05, 0.0], [0.05, 0.0]], width=width))
    planar, spatial = both(flat, load_on(SAND, Plate((0.1, width)), floor=Floor(-0.025, K, D)), spin=0.0)
    np.testing.assert_allclose(spatial, planar, rtol=1e-10, atol=1e-10)
    floors = flat.history.terms[:, list(flat.history.term_names).index("floor")]
    assert np.abs(floors).max() > 0.1 * np.abs(planar).max()
    flat, bar = GranularLoad(PLAY, 0.0, floor=Floor(-0.025, K * 0.008, D)), Bar([[-0.08, 0, 0], [0.08, 0, 0]], 0.008)
    flat.add(polyline(FLAT, [[-0.08, 0.0], [0.08, 0.0]], diameter=0.008))
    planar, spatial = both(flat, load_on(PLAY, bar, floor=Floor(-0.025, K, D)), spin=4.0)
    np.testing.assert_allclose(spatial, planar, rtol=1e-9, atol=1e-9 * np.abs(planar).max())


def test_up_is_any_direction_and_the_floor_is_level_there() -> None:
    turn = Rotation.from_rotvec([0.7, -1.9, 0.4])
    options = {"floor": Floor(-0.02, K, D)}
    plain = driven(load_on(SAND, Box((0.1, 0.07, 0.05)), 0.03, **options), Motion(3)).history
    up = turn.apply([0, 0, 1])
    turned = driven(load_on(SAND, Box((0.1, 0.07, 0.05)), 0.03, up=up, **options), Motion(3), around=turn).history
    expected = turn.apply(plain.bodies[:, 0, :3])
    np.testing.assert_allclose(turned.bodies[:, 0, :3], expected, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(turned.floor_work, plain.floor_work, atol=1e-9)
    assert np.abs(plain.floor_work).max() > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rft3d", "lee_marghitu", "ball"])
def test_tangent_includes_the_floor_whose_spring_keeps_its_energy(name: str) -> None:
    medium, shape = PAIRS[name]
    load = load_on(medium, shape, floor=Floor(-0.03, K, D))
    random = np.random.default_rng(2)
    q, v = state(
        np.array([0.0, 0.0, -0.03]), Rotation.from_rotvec([0.2, 0.1, 0.0]), 0.1 * random.normal(size=3), np.ones(3)
    )
    load.start(q)
    load.accept(0.0, q, v)
    tangent, expected, d, fq, fv = np.zeros((7, 7)), np.zeros((7, 7)), 1e-8, 0.7, 0.02
    for row, column, value in load.tangent(q, v, fq, fv):
        tangent[int(row), int(column)] += value
    for j in range(7):
        e = d * np.eye(7)[j]
        sides = [load.force(q + sign * fq * e, v + sign * fv * e, np.zeros(7)) for sign in (1.0, -1.0)]
        expected[:, j] = (sides[0] - sides[1]) / (2 * d)
    for slopes in (tangent, expected):  # what Euler parameters change along themselves is no motion
        slopes -= np.outer(slopes[:, 3:] @ q[3:], np.append(np.zeros(3), q[3:]))
    np.testing.assert_allclose(tangent, expected, atol=2e-3 * np.abs(expected).max())
    # Undamped, on a closed way, the spring gives back all that it took; the trapezoidal rule errs by 1e-4 of it.
    load = load_on(medium, shape, 0.03, floor=Floor(-0.06, K))
    works = driven(load, Motion(1, depth=0.06, closed=True), 640).history.floor_work
    assert abs(works[-1]) < 1e-3 * np.ptp(works)
    assert np.ptp(works) > 0.1


def test_a_floor_below_two_media_carries_a_sphere_once() -> None:
    shape = Sphere(0.08, 2.0)
    single = pressed(shape, -0.038)
    both = pressed(shape, -0.038, medium=(NOTHING, Poncelet(1e-12, 1e-12)))
    np.testing.assert_array_equal(both, single)


def test_the_history_keeps_the_floor_apart() -> None:
    floor = Floor(-0.05, K, D)
    loads = [load_on(SAND, Box((0.1, 0.07, 0.05)), 0.03, **given) for given in ({}, {"floor": floor})]
    bare, borne = (driven(load, Motion(3, depth=0.05)).history for load in loads)
    np.testing.assert_allclose(borne.work, bare.work, atol=1e-12)
    assert not bare.floor_work.any()
    assert np.abs(borne.floor_work).max() > 1e-3
    assert borne.term_names == (*bare.term_names, "floor")
    assert borne.terms.shape[1] == bare.terms.shape[1] + 1 <= TERMS + 1
