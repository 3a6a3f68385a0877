"""Bodies that turn while they slide: leading facets and sheared displacement, for any facets and steps."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support_parts import called
from support_space import SAND, Array, load_on, state

from granular_contact import Box, Mesh, Sphere
from granular_contact.laws.pressure_sinkage import PressureSinkage
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.sand.kernels.facets import is_pulled, spread_along
from granular_contact.sand.kernels.friction import ELASTOPLASTIC, SWITCH, sliding
from granular_contact.sand.kernels.space_friction import FAST, factors_of_facet
from granular_contact.sand.space.facets import Size, as_facets, facet_rows, rectangle_facets, triangle_facets

DIAMETER, DEPTH, SPIN = 0.04, 0.06, np.array([0.3, 0.4, 0.0])  # m, m, rad/s
SHEARED = PressureSinkage(4e5, 1.0, 30.0, shear_deformation_modulus=0.02, plate_width=0.05)


def spun(size: float, step: float, fast: float = 1.0) -> Array:
    """Force (3,) and moment (3,) on a ball below the surface, once it has turned by 2 rad about its middle.

    size: of its facets (m); step: s; fast: factor of its spin, and of its speed downward of 0.1 mm/s.
    """
    load, spin, sinks = load_on(SHEARED, Sphere(DIAMETER), size), fast * SPIN, fast * 1e-4
    for i in range(round(4.0 / fast / step) + 1):
        t = step * i
        q, v = state(np.array([0.0, 0.0, -DEPTH - sinks * t]), Rotation.from_rotvec(t * spin), [0, 0, -sinks], spin)
        if i == 0:
            load.start(q)
        load.accept(t, q, v)
    return load.history.bodies[-1, 0]


def test_ball_turning_nearly_in_place_is_loaded_on_its_leading_side() -> None:
    """Of a round body n . v does not know the spin, so that fine facets and coarse ones lead alike.

    Were bristles alike within a facet, coarse ones would lead on all sides, and lift a quarter less.
    """
    finest, *others = (spun(size, 0.01) for size in (1.5e-3, 3e-3, 6e-3))
    for coarser, error in zip(others, (0.02, 0.06), strict=True):  # with the square of the size
        assert abs(coarser[2] / finest[2] - 1.0) < error
        assert np.linalg.norm(coarser[3:] - finest[3:]) < error * np.linalg.norm(finest[3:])


def test_leading_part_of_a_triangle_is_independent_of_corner_order() -> None:
    """A wedge of large triangles that turn as fast as they slide, with each corner of its triangles as the first."""
    corners = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.06, 0.0], [0.02, 0.01, 0.05]]
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    loads = [load_on(SAND, Mesh(corners, np.roll(faces, k, axis=1)), size=1.0) for k in range(3)]
    rng = np.random.default_rng(3)
    for _ in range(20):
        turn = Rotation.from_quat(rng.normal(size=4))
        q, v = state(np.array([0.0, 0.0, -0.04]), turn, 0.1 * rng.normal(size=3), 3.0 * rng.normal(size=3))
        forces = []
        for load in loads:
            load.start(q)
            forces.append(load.force(q, v, np.zeros(7)))
        scale = np.abs(forces[0]).max()
        assert scale > 1.0
        # Round-off: centroids are means of the same corners in another order.
        np.testing.assert_allclose(forces[1:], [forces[0]] * 2, atol=1e-9 * scale)


@pytest.mark.parametrize("form", ["triangle", "rectangle"])
def test_spread_of_velocity_in_a_facet_matches_gauss_quadrature(form: str) -> None:
    """Spread s^2 = 3 mean((n . v - n . v_c)^2), by Gauss's rule of an exact order."""
    rng = np.random.default_rng(5)
    corner, a, b, q = rng.normal(size=(4, 3))
    if form == "triangle":
        flat = triangle_facets(np.array([[corner, corner + a, corner + b]]))
        near, far = 1.0 / 6.0, 2.0 / 3.0
        weights, places = np.full(3, 1.0 / 3.0), [(near, near), (far, near), (near, far)]
    else:
        b, g = np.cross(a, b), 1.0 / np.sqrt(3.0)
        flat = rectangle_facets(corner, a, b, Size(np.inf))
        weights, places = np.full(4, 0.25), [(g, g), (g, -g), (-g, g), (-g, -g)]
    (facet,) = as_facets(facet_rows(flat, np.zeros((0, 8)), thin=False))
    along = np.array([np.cross(q, corner + x * a + y * b - flat.place[0]) @ flat.normal[0] for x, y in places])
    s = np.linalg.norm(called(spread_along)(facet, q))
    assert s**2 == pytest.approx(3.0 * weights @ along**2, rel=1e-12)


def test_facets_whose_bristle_may_lead_are_evaluated() -> None:
    """With the stretch alike within it, or differing as v does: |n . e| below spread times e . v / v^2."""
    looked_at, spread_of = called(is_pulled), called(spread_along)
    rng, seen = np.random.default_rng(8), {False: 0, True: 0}
    for _ in range(60):
        corner, a, b, u, e = rng.normal(size=(5, 3))
        q = 4.0 * rng.normal(size=3)
        flat = triangle_facets(np.array([[corner, corner + a, corner + b]]))
        (facet,) = as_facets(facet_rows(flat, np.zeros((0, 8)), thin=False))
        along, spread = float(facet["normal"] @ e), np.linalg.norm(spread_of(facet, q))
        share = max(0.0, float(e @ u) / float(u @ u))
        expected = bool(along > 0.0 or share * spread > abs(along))
        seen[expected] += along <= 0.0
        assert looked_at(facet, u, e, q) == expected
    assert min(seen.values()) > 5


def test_bristle_dragged_far_leans_towards_the_motion() -> None:
    """Its stretch, q less what tau v adds, is along (1 - f) e / |e| + f v / |v| and at most u_y (`space_friction`)."""
    m, rng = SimpleNamespace(friction=ELASTOPLASTIC, u_y=1e-3, tau=2e-3), np.random.default_rng(2)
    for size in (3e-4, 2e-3, 0.03) * 10:
        e, v = size * rng.normal(size=3), 0.3 * rng.normal(size=3)
        h, speed = np.linalg.norm(e), np.linalg.norm(v)
        cosine = max(0.0, float(e @ v) / (h * speed))
        f = cosine * (1.0 - min(1.0, m.u_y / h)) * speed / (speed + FAST * m.u_y / SWITCH)
        leaning = (1.0 - f) * e / h + f * v / speed
        by_e, by_v, _ = factors_of_facet(tuple(e), tuple(v), m)
        tau = m.tau + cosine * (sliding(min(h, m.u_y), m) - m.tau)
        expected = min(h, m.u_y) * leaning / np.linalg.norm(leaning)
        np.testing.assert_allclose(by_e * e + (by_v - tau) * v, expected, atol=1e-12 * m.u_y)


def test_bristle_below_half_yield_loads_a_facet_independent_of_motion() -> None:
    """Without damping: no place of a facet has slid, so that all of it is stretched alike, however its body turns."""
    u_y = 1e-4  # m
    load = load_on(SAND, Box((0.1, 0.07, 0.05)), size=1.0, static=Elastoplastic(u_y, 0.0))
    rng = np.random.default_rng(11)
    for _ in range(20):
        turn, along = Rotation.from_quat(rng.normal(size=4)), rng.normal(size=3)
        start, rest = state(np.array([0.0, 0.0, -0.04]), turn, np.zeros(3), np.zeros(3))
        load.start(start)
        q = start + 0.49 * u_y * np.array([*(along / np.linalg.norm(along)), 0.0, 0.0, 0.0, 0.0])
        still = load.force(q, rest, np.zeros(7))
        _, v = state(q[:3], turn, 0.01 * rng.normal(size=3), 0.3 * rng.normal(size=3))
        np.testing.assert_allclose(load.force(q, v, np.zeros(7)), still, atol=1e-9 * np.abs(still).max())


def test_load_on_a_fast_spinning_ball_is_independent_of_the_step() -> None:
    """The path of a step points where a facet went half a step before: away from what it slides along."""
    long, short = (spun(3e-3, step, fast=2.0) for step in (0.05, 0.001))
    assert np.linalg.norm(long - short) < 0.02 * np.linalg.norm(short)


def dragged(steps: int) -> Array:
    """Force and moment (6,) on a plate that was dragged 20 mm ahead, then aside, and turned in so many steps."""
    load = load_on(SHEARED, Box((0.04, 0.04, 0.02)), 0.01, static=Elastoplastic(1e-5, 0.0))
    corner = 1e-3  # m, radius
    angles = np.linspace(0.0, 0.5 * np.pi, steps + 1)[1:]
    ways = [np.array([x, 0.0]) for x in np.linspace(0.0, 0.02, 21)]
    ways += [np.array([0.02 + corner * np.sin(a), corner * (1.0 - np.cos(a))]) for a in angles]
    ways += [ways[-1] + [0.0, y] for y in np.linspace(1e-4, 5e-3, 20)]
    for i, (x, y) in enumerate(ways):
        ahead = ways[i] - ways[max(0, i - 1)] if i else np.array([1.0, 0.0])
        u = 0.02 * ahead / np.linalg.norm(ahead)
        q, v = state(np.array([x, y, -0.03]), Rotation.identity(), [*u, -2e-3], np.zeros(3))
        if i == 0:
            load.start(q)
        load.accept(float(i), q, v)
    return load.history.bodies[-1, 0]


def test_shear_displacement_is_independent_of_the_steps_of_a_turn() -> None:
    """Counted by the path alone, 5 mm would be sheared after a sharp turn and 26 mm after a turn in many steps."""
    sharp, gradual = (dragged(steps) for steps in (2, 200))
    # What is counted is 1 mm of the corner and the 5 mm after it, along y alone.
    np.testing.assert_allclose(sharp, gradual, rtol=1e-3, atol=1e-3 * np.abs(gradual).max())
