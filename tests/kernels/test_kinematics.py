"""Stations of rigid bodies and ANCF elements, and virtual work between them and the coordinates."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from support_laws import stations
from support_parts import called, rigid_stations
from support_slow import TRUE_SIGN, TWO_WAYS, Link, fitted_order, kernel, medium

from granular_contact.sand.kernels import kinematics, law, lines, spatial
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.kinematics import cable_stations, curved_stations, hermite

LENGTHS = np.array([0.1, 0.07, 0.12])


def place(geometry: np.ndarray, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    P, V = np.full((len(geometry), 2), np.nan), np.full((len(geometry), 2), np.nan)
    stations(q, v, geometry, P, V)
    return P, V


def cases() -> list[tuple[np.ndarray, int]]:
    bar = rigid_stations(np.array([[-0.1, 0.02], [0.2, -0.05]]), 6)
    return [(bar, 3), (kinematics.in_space(bar), 7), (cable_stations(LENGTHS, 4), 16)]


def test_hermite_meets_values_and_slopes_at_the_ends() -> None:
    np.testing.assert_array_equal(hermite(np.array([0.0, 1.0]), 0.3), [[1, 0, 0, 0], [0, 0, 1, 0]])
    h, xi = 1e-6, np.array([0.0, 1.0])
    slopes = (hermite(xi + h, 0.3) - hermite(xi - h, 0.3)) / (2 * h * 0.3)
    # Central difference of a cubic: h^2 = 1e-12 plus round-off 1e-10.
    np.testing.assert_allclose(slopes, [[0, 1, 0, 0], [0, 0, 0, 1]], atol=1e-9)


def test_hermite_reproduces_cubics() -> None:
    length, cubic = 0.3, np.polynomial.Polynomial([0.2, -1.0, 3.0, 5.0])
    nodal = [cubic(0.0), cubic.deriv()(0.0), cubic(length), cubic.deriv()(length)]
    xi = np.linspace(0, 1, 9)
    # Both sides are the same cubic: round-off.
    np.testing.assert_allclose(hermite(xi, length) @ nodal, cubic(xi * length), atol=1e-15)


def test_rigid_stations_turn_with_the_body() -> None:
    geometry = rigid_stations(np.array([[0.0, 0.0], [0.2, 0.0]]), 2)
    P, V = place(geometry, np.array([1.0, 2.0, np.pi / 2]), np.array([0.3, -0.4, 5.0]))
    # By hand; round-off of cos(pi / 2).
    np.testing.assert_allclose(P, [[1.0, 2.0], [1.0, 2.1], [1.0, 2.2]], atol=1e-15)
    np.testing.assert_allclose(V, [[0.3, -0.4], [-0.2, -0.4], [-0.7, -0.4]], atol=1e-15)


def test_strips_are_shared_out_by_length_and_every_piece_has_one() -> None:
    points = np.array([[0.0, 0.0], [0.3, 0.0], [0.3, 0.1], [0.3, 0.101]])
    shares = [31, 10, 1]  # 41 times 0.3, 0.1 and 0.001 of 0.401 m: 30.7, 10.2 and 0.1
    straight = rigid_stations(points, 41)
    corners = [int(np.argmin(np.hypot(straight["x"] - x, straight["y"] - y))) for x, y in points]
    assert np.diff(corners).tolist() == shares
    assert [len(part) - 1 for part, _ in curved_stations(points, np.array([0.0, 0.4, 0.0]), 41)] == shares
    ((whole, turn),) = curved_stations(points, np.zeros(3), 41)
    assert turn == 0.0
    np.testing.assert_array_equal(whole, straight)


def test_strips_joined_in_pairs_keep_the_corners_between_sides() -> None:
    """Sides of 31, 10 and 1 strips: 16, 5 and 1 are left."""
    points = np.array([[0.0, 0.0], [0.3, 0.0], [0.3, 0.1], [0.3, 0.101]])
    ((stations, _),) = curved_stations(points, np.zeros(3), 41)
    left = stations[stations["kept"]]
    corners = [int(np.flatnonzero((left["x"] == x) & (left["y"] == y))[0]) for x, y in points]
    assert np.diff(corners).tolist() == [16, 5, 1]


def test_stations_of_chords_lie_on_their_arcs() -> None:
    """Three chords of one circle and a straight side: stations on the circle, at equal angles; one run of each kind."""
    angles, radius = np.array([0.0, 0.5, 1.0, 1.5]), 0.2
    circle = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    points, turns = np.vstack([circle, [[0.0, 0.4]]]), np.array([0.5, 0.5, 0.5, 0.0])
    (arc, turn), (side, none) = curved_stations(points, turns, 50)
    assert none == 0.0
    assert turn == pytest.approx(1.5 / (len(arc) - 1), rel=1e-12)
    even = turn * np.arange(len(arc))
    np.testing.assert_allclose(arc["x"], radius * np.cos(even), atol=1e-15)
    np.testing.assert_allclose(arc["y"], radius * np.sin(even), atol=1e-15)
    np.testing.assert_allclose(np.diff(side["x"], 2), 0.0, atol=1e-15)
    assert (side["x"][0], side["y"][0]) == (arc["x"][-1], arc["y"][-1])
    assert (side["x"][-1], side["y"][-1]) == (0.0, 0.4)


def test_cable_stations_of_a_straight_beam_are_evenly_spread() -> None:
    ends = np.concatenate([[0.0], np.cumsum(LENGTHS)])
    axis = np.array([0.6, -0.8])
    q = np.hstack([ends[:, None] * axis, np.tile(axis, (4, 1))]).ravel()
    P, _ = place(cable_stations(LENGTHS, 4), q, np.zeros(16))
    want = np.concatenate([np.linspace(a, b, 4, endpoint=False) for a, b in pairwise(ends)] + [ends[-1:]])
    # Hermite polynomials of a straight line: round-off.
    np.testing.assert_allclose(P, want[:, None] * axis, atol=1e-15)


def test_euler_parameters_turn_as_an_angle_does() -> None:
    bar, angle, rate = rigid_stations(np.array([[-0.1, 0.02], [0.2, -0.05]]), 6), 0.7, 3.0
    half = angle / 2
    q, v = np.zeros(7), np.zeros(7)
    q[:2], q[3], q[6] = (0.3, -0.2), np.cos(half), np.sin(half)
    v[:2], v[3], v[6] = (1.0, 2.0), -np.sin(half) * rate / 2, np.cos(half) * rate / 2
    planar = place(bar, np.array([0.3, -0.2, angle]), np.array([1.0, 2.0, rate]))
    # The same positions and velocities: round-off.
    np.testing.assert_allclose(place(kinematics.in_space(bar), q, v), planar, rtol=0, atol=1e-15)


@pytest.mark.parametrize(("geometry", "size"), cases())
def test_velocities_are_rates_of_positions(geometry: np.ndarray, size: int) -> None:
    rng = np.random.default_rng(1)
    q, v, h = rng.uniform(-1, 1, size), rng.uniform(-1, 1, size), 1e-5
    ahead, behind = place(geometry, q + h * v, v)[0], place(geometry, q - h * v, v)[0]
    # Central difference: h^2 |v|^3 r / 6 = 1e-11, round-off 1e-16 / 1e-5.
    np.testing.assert_allclose(place(geometry, q, v)[1], (ahead - behind) / (2 * h), atol=1e-10)


@pytest.mark.parametrize(("geometry", "size"), cases())
def test_virtual_work(geometry: np.ndarray, size: int) -> None:
    """J^T F . v = F . J v: the forces on the coordinates do the work that the forces at the stations do."""
    rng = np.random.default_rng(2)
    for i in range(100):
        q, v = rng.uniform(-1, 1, size), rng.uniform(-1, 1, size)
        P, V = place(geometry, q, v)
        F, out = rng.uniform(-10, 10, P.shape), np.zeros(size)
        F[:, : i % 3] = 0.0  # both components, y alone, none
        if size == spatial.SIZE:
            called(spatial.spatial_scatter)(q, geometry, F, out)
        else:
            called(kinematics.scatter)(q, geometry, P, F, out)
        # The same products in another order: round-off of some 30 terms of 10 W.
        assert out @ v == pytest.approx((F * V).sum(), abs=1e-12)


@pytest.mark.parametrize(("geometry", "size"), cases())
def test_power_of_a_run_is_that_of_its_generalised_forces(geometry: np.ndarray, size: int) -> None:
    rng = np.random.default_rng(3)
    q = {3: np.array([0.0, 0.0, -0.8]), 7: np.array([0.0, 0.0, 0.0, np.cos(0.4), 0.0, 0.0, -np.sin(0.4)])}.get(size)
    q = bent_beam() if q is None else q
    v, n = rng.uniform(-1, 1, size), len(geometry)
    P, V = place(geometry, q, v)
    run, anchors = np.zeros(1, lines.LINE), P.copy()
    run["width"], surface = 0.01, float(P[:, 1].mean())
    F, totals = kernel(P, V, Link(P[:2], V[:2], 0.01, surface), medium(TWO_WAYS, TRUE_SIGN))
    out, row = np.zeros(size), np.zeros(lines.FIRST + 13)
    level, sand = np.array([[0.0, surface]]), medium_record(medium(TWO_WAYS, TRUE_SIGN))
    contact, totals_too = law.Contact(geometry, run, level, sand, anchors, *np.zeros((3, n, 2))), np.zeros((3, 3))
    called(lines.force)(q, v, contact, totals_too, out)
    columns = lines.FIRST + np.array([0, 1, 10])
    work = totals_too, np.zeros(size)
    depth, speed = called(lines.accept)(q, v, contact, *work, row, columns, False, False)
    # Sums of some 30 products, round-off.
    assert out @ v == pytest.approx((F * V).sum(), rel=1e-12)
    assert row[lines.FIRST] == pytest.approx(out @ v, rel=1e-12)
    np.testing.assert_allclose(row[lines.FIRST + 1 : -3].reshape(3, 3), totals, rtol=1e-12, atol=1e-12)
    assert depth == row[lines.DEPTH] == surface - P[:, 1].min()
    assert speed == np.abs(V[:, 1]).max()


def bent_beam() -> np.ndarray:
    """Coordinates of three elements on an arc that falls from 20 to 80 degrees below the horizontal."""
    ends = np.concatenate([[0.0], np.cumsum(LENGTHS)])
    start, curvature = -0.35, -1.05 / ends[-1]
    angle = start + curvature * ends
    radius = 1 / curvature
    places = radius * np.column_stack([np.sin(angle) - np.sin(start), -np.cos(angle) + np.cos(start)])
    return np.hstack([places, np.column_stack([np.cos(angle), np.sin(angle)])]).ravel()


def curved_beam(surface: float, strips: int) -> np.ndarray:
    """Totals (3, 3) of the bent beam, which turns about its root and sinks: velocities keep their signs."""
    q = bent_beam()
    state, v = q.reshape(4, 4), np.zeros((4, 4))
    v[:, 0], v[:, 1] = 4.0 * state[:, 1] - 0.2, -4.0 * state[:, 0] - 0.3
    v[:, 2], v[:, 3] = 4.0 * state[:, 3], -4.0 * state[:, 2]
    P, V = place(cable_stations(LENGTHS, strips), q, v.ravel())
    return kernel(P, V, Link(P[:2], V[:2], 0.008, surface))[1]


def curved_beam_errors(surface: float, sizes: np.ndarray) -> np.ndarray:
    """Errors (sizes, 3, 3) of the totals against a very fine division, relative to the greatest that they get."""
    finest, scale = curved_beam(surface, 1024), np.abs(curved_beam(0.01, 1024))
    return np.array([np.abs(curved_beam(surface, int(n)) - finest) for n in sizes]) / np.where(scale == 0.0, 1.0, scale)


# All immersed; or the surface across the second element, at 24 heights, because the error also depends on where in its
# strip the surface cuts.
@pytest.mark.parametrize("surfaces", [np.array([0.01]), np.linspace(-0.08, -0.12, 24)], ids=["immersed", "cut"])
def test_strips_of_a_curved_beam_converge_with_order_two(surfaces: np.ndarray) -> None:
    sizes = 2 ** np.arange(1, 6)
    errors = np.sqrt(np.mean([curved_beam_errors(s, sizes) ** 2 for s in surfaces], axis=0))
    # Integrals of z dy and z y dy do not depend on the path, so the horizontal static term has no error but round-off.
    assert errors[:, 1].max() < 1e-12
    for term, part in ((0, 0), (0, 1), (0, 2), (2, 1), (2, 2)):
        # Chords of a curve and linear velocities are of second order; the surface cuts a chord and not the curve, which
        # is of second order as well.
        assert fitted_order(sizes, errors[:, term, part], 1e-10) == pytest.approx(-2.0, abs=0.2)
        assert errors[0, term, part] < 0.02


def test_sliding_surface_meets_no_bad_place_in_a_straight_element() -> None:
    link = Link(np.array([[0.0, 0.05], [0.1, -0.08]]), np.array([[1.0, -0.4], [0.5, -1.2]]), 0.008)
    P, V = link.P, link.V
    fine = np.linspace(0.0, 1.0, 65)[:, None]
    many = (1 - fine) * P[0] + fine * P[1], (1 - fine) * V[0] + fine * V[1]
    for surface in np.linspace(-0.09, 0.06, 301):
        cut = Link(P, V, 0.008, surface)
        whole, parts = kernel(P, V, cut)[1], kernel(*many, cut)[1]
        # Every integral is exact, in one strip as in 64: round-off, and 4e-11 of the two-point rule for level strips.
        np.testing.assert_allclose(whole, parts, atol=1e-9 * max(1.0, np.abs(parts).max()))


def test_sliding_surface_meets_no_bad_place_in_a_bent_element() -> None:
    sizes = np.array([1, 4])
    cut = np.max([curved_beam_errors(s, sizes) for s in np.linspace(-0.2, -0.001, 80)], axis=0)
    immersed = curved_beam_errors(0.01, sizes)
    for term, part in ((0, 0), (0, 1), (2, 1)):
        # The entry is integrated as well as the rest: an error of at most 3 times that of the beam when it is all in,
        # and with four strips an element 0.3 % of the greatest force. A point rule would be off by its strip's share, 8
        # %.
        assert np.all(cut[:, term, part] < 3.0 * immersed[:, term, part])
        assert cut[1, term, part] < 3e-3
