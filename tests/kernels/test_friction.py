"""Both regularised signs, bristles and smooth: for a point moved on paths, and along a strip between two points."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from support_parts import called
from support_slow import Link, kernel, medium

from granular_contact.laws.lee_marghitu import LeeMarghitu, VerticalResistance
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.kernels import friction, lines, planar_friction, space_friction
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.friction import drag_component

U_Y = 1e-5
PLASTIC = medium(static=Elastoplastic(U_Y, 0.0))[0]
DAMPED = medium(static=Elastoplastic(U_Y, 1e-3))[0]
SMOOTH = medium(static=Smooth(1e-3))[0]
LINE, LEVEL = np.zeros(1, lines.LINE)[0], np.zeros((1, 2))


def direction(stretch: float, v: float, m: np.void) -> float:
    """Regularised sign at a point."""
    return called(friction.direction)(called(friction.drive)(stretch, v, m), m)


def cycle(path: np.ndarray, m: np.void) -> tuple[np.ndarray, np.ndarray]:
    """Direction and anchor after every accepted point of a slow path (m)."""
    sigma, anchors, anchor = np.zeros(len(path)), np.zeros(len(path)), path[0]
    for i, p in enumerate(path):
        sigma[i] = direction(p - anchor, 0.0, m)
        anchor = called(drag_component)(p, anchor, m)
        anchors[i] = anchor
    return sigma, anchors


def work(path: np.ndarray, sigma: np.ndarray) -> float:
    """Work of a unit bound on the body: force is -sigma; trapezoids are exact on piecewise linear sigma."""
    return float(-np.sum(0.5 * (sigma[1:] + sigma[:-1]) * np.diff(path)))


def zigzag(amplitude: float, cycles: int, points: int) -> np.ndarray:
    corners = np.array([0.0, *([amplitude, -amplitude] * cycles), amplitude, 0.0])
    return np.concatenate([np.linspace(a, b, points, endpoint=False) for a, b in pairwise(corners)] + [[0.0]])


def test_a_bristle_that_yields_is_led_by_the_velocity() -> None:
    """T in place of tau from the yield on, rising from half of it, where the bristle is stretched on; tau elsewhere."""
    for m, tau in ((PLASTIC, 0.0), (DAMPED, 1e-3)):
        for share, time in ((1.0, friction.SWITCH), (0.75, 0.5 * (tau + friction.SWITCH)), (0.5, tau), (0.1, tau)):
            e, v = share * U_Y, 2e-4
            assert called(friction.drive)(e, v, m) == pytest.approx((e + time * v) / U_Y, rel=1e-12)
            assert called(friction.drive)(e, -v, m) == pytest.approx((e - tau * v) / U_Y, rel=1e-12)
        assert called(friction.drive)(3.0 * U_Y, 0.0, m) == pytest.approx(1.0, rel=1e-15)
    slow = medium(static=Elastoplastic(U_Y, 0.05))[0]  # its own tau is more than T
    assert called(friction.drive)(U_Y, 1e-4, slow) == pytest.approx(1.0 + 0.05 * 1e-4 / U_Y, rel=1e-12)


def test_regularised_sign_saturates_at_one() -> None:
    for sign in (1.0, -1.0):
        assert direction(sign * 2 * U_Y, 0.0, PLASTIC) == sign
        assert direction(0.0, sign * 0.1, DAMPED) == sign
        assert direction(0.0, sign * 0.1, SMOOTH) == pytest.approx(sign, abs=1e-15)  # tanh(100)
    assert direction(0.25 * U_Y, 0.0, PLASTIC) == pytest.approx(0.25, rel=1e-15)
    # The damping adds tau v / u_y = 0.1; round-off.
    assert direction(0.25 * U_Y, 1e-3, DAMPED) == pytest.approx(0.35, rel=1e-14)
    assert direction(0.25 * U_Y, 1e-3, SMOOTH) == pytest.approx(math.tanh(1.0), rel=1e-15)


def test_direction_follows_the_velocity_at_the_end_of_a_step() -> None:
    """A body that went 1 mm ahead in a step, and at its end goes back or aside at 0.1 m/s, has turned its direction."""
    assert direction(1e-3, -0.1, DAMPED) == -1.0
    # The bristle still leans ahead by u_y, of tau v = 10 u_y.
    q = called(planar_friction.drive)((1e-3, 0.0), (0.0, 0.1), DAMPED)
    (ux, uy), share = called(planar_friction.mobilised)(q, DAMPED)
    assert (ux / uy, share) == pytest.approx((0.1, 1.0), rel=1e-12)


def test_bristle_of_a_facet_dragged_far_follows_the_velocity() -> None:
    """On a circle the path of a step points where the body went in its middle: late by half the angle of the turn."""
    for turn in (0.1, 0.02):  # rad in a step
        chord, v = (np.array([np.cos(angle), np.sin(angle), 0.0]) for angle in (0.0, 0.5 * turn))
        for far in (10.0, 100.0):
            e, rate = far * U_Y * chord, 0.1 * v
            by_e, by_v, _ = called(space_friction.factors_of_facet)(tuple(e), tuple(rate), PLASTIC)
            q = by_e * e + by_v * rate
            late = 0.5 * turn - math.atan2(q[1], q[0])
            # T |v| is 100 u_y, so that the bristle is 1 / 101 of q. Of it 1 / far is not led, and FAST u_y / (T |v|).
            assert late == pytest.approx(0.5 * turn / 101.0 * (1.0 / far + 0.05), rel=0.06)
            assert np.linalg.norm(q) == pytest.approx(101.0 * U_Y, rel=turn**2)


def test_planar_direction_is_that_of_a_component_along_an_axis() -> None:
    rng = np.random.default_rng(3)
    for stretch, v in rng.uniform(-2, 2, (100, 2)) * [U_Y, 5e-3]:
        for m in (PLASTIC, DAMPED, SMOOTH):
            q = called(planar_friction.drive)((0.0, stretch), (0.0, v), m)
            (ux, uy), share = called(planar_friction.mobilised)(q, m)
            assert ux == 0.0
            # The share is that of the magnitude: the same operations, but for a quotient and its inverse; round-off.
            assert share * uy == pytest.approx(direction(stretch, v, m), rel=1e-14)


def test_anchor_is_mapped_back_to_the_yield_displacement() -> None:
    assert called(drag_component)(0.3 * U_Y, 0.0, PLASTIC) == pytest.approx(0.0, abs=1e-20)
    # Round-off of 1e-5 m.
    assert called(drag_component)(3.0 * U_Y, 0.0, PLASTIC) == pytest.approx(2.0 * U_Y, rel=1e-14)
    assert called(drag_component)(-3.0 * U_Y, 0.0, PLASTIC) == pytest.approx(-2.0 * U_Y, rel=1e-14)


def test_return_mapping_of_one_large_step_equals_many_small_steps() -> None:
    """One large step lands where many small ones do, as long as it does not turn round: plasticity has no clock."""
    small = cycle(np.linspace(0.0, 7.3 * U_Y, 1000), PLASTIC)
    large = cycle(np.array([0.0, 7.3 * U_Y]), PLASTIC)
    assert large[0][-1] == small[0][-1] == 1.0
    # 1000 additions of round-off at 7e-5 m.
    assert large[1][-1] == pytest.approx(small[1][-1], abs=1e-13 * U_Y * 1000)


def test_no_creep_under_a_constant_load() -> None:
    p = anchor = 0.7 * U_Y
    p += 0.6 * U_Y  # a load of 0.6 of the bound is carried here
    for _ in range(10_000):
        anchor = called(drag_component)(p, anchor, DAMPED)
    # p - (p - anchor) may round once, in the last place of 1e-5 m; a millionth of u_y would be creep.
    assert anchor == pytest.approx(0.7 * U_Y, abs=1e-20)
    assert direction(p - anchor, 0.0, DAMPED) == pytest.approx(0.6, rel=1e-12)


def test_smooth_creeps_under_a_constant_load() -> None:
    # At rest it carries nothing, whatever the stretch; to carry 0.6 of the bound it has to move at v_eps artanh 0.6.
    assert direction(5 * U_Y, 0.0, SMOOTH) == 0.0
    assert direction(0.0, 1e-3 * math.atanh(0.6), SMOOTH) == pytest.approx(0.6, rel=1e-14)


@pytest.mark.parametrize("amplitude", [1.5, 3.0, 20.0])
def test_cycles_dissipate_the_area_of_the_loop(amplitude: float) -> None:
    a = amplitude * U_Y
    one_cycle, two_cycles = (zigzag(a, n, 2000) for n in (1, 2))
    more = work(two_cycles, cycle(two_cycles, PLASTIC)[0]) - work(one_cycle, cycle(one_cycle, PLASTIC)[0])
    # A perfect elastoplastic loop between -a and a has the area 4 (a - u_y) of the unit bound. Its corners fall between
    # points: at each of two a triangle of up to half a step (2a / 2000) times the change of sigma over it, 2a / 2000
    # u_y.
    step = 2 * a / 2000
    assert more == pytest.approx(-4 * (a - U_Y), abs=2 * step**2 / U_Y)


def test_small_cycles_are_elastic() -> None:
    path = zigzag(0.9 * U_Y, 3, 500)
    sigma, anchors = cycle(path, PLASTIC)
    # Sums of 3500 products of 1e-8 m: round-off 1e-16 of each.
    assert abs(work(path, sigma)) < 1e-12 * U_Y
    assert np.abs(anchors).max() < 1e-12 * U_Y


def test_random_closed_paths_never_give_energy() -> None:
    rng = np.random.default_rng(1)
    for _ in range(25):
        corners = np.concatenate([[0.0], rng.uniform(-4, 4, 8) * U_Y])
        loop = np.concatenate([corners, corners[1:], [corners[0]]])
        path = np.interp(np.linspace(0, len(loop) - 1, 4001), np.arange(len(loop)), loop)
        # Between points sigma is cut off at +-1 and the trapezoid rule sees a chord: off by a step squared over u_y at
        # each of some 18 corners, (16 u_y / 500)^2 / u_y / 8 at most.
        assert work(path, cycle(path, PLASTIC)[0]) < 18 * (8 * 17 / 4000) ** 2 / 8 * U_Y


def test_a_strip_driven_to_and_fro_takes_energy() -> None:
    """The same through the kernels: level strip, horizontally rigid grains, anchors moved by the end of each step."""
    law = LeeMarghitu(2500.0, 0.0, 8.0, VerticalResistance(0.0, 1.0), VerticalResistance(0.0, 1.0))
    record = medium(law, Elastoplastic(U_Y, 0.0))
    P0, V = np.array([[0.0, -0.02], [0.0, -0.05]]), np.zeros((2, 2))
    link = Link(P0, V, 0.01)
    anchors = P0.copy()
    bound = 8.0 * 9.81 * 2500.0 * (0.05**2 - 0.02**2) * 0.01
    path = zigzag(5 * U_Y, 1, 200)
    force = np.zeros(len(path))
    for i, x in enumerate(path):
        P = P0 + np.array([x, 0.0])
        force[i] = kernel(P, V, link, record, anchors)[0][:, 0].sum()
        called(lines.drag_anchors)(P, anchors, LINE, LEVEL, medium_record(record)[0])
    # Closed expression of the bound, round-off (stretches of 1e-5 m next to positions of 1e-2 m: 1e-13).
    assert np.abs(force).max() == pytest.approx(bound, rel=1e-11)
    done = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(path)))
    # Loop from 0 over 5, -5, 5 to 0 in units of u_y: 25 long less what is elastic, 0.5 to load and 2 x 2 to turn twice;
    # then the third turn unloads 5 -> 4 with +0.5 and yields the other way 4 -> 3 at the cost of 0.5, and slides 3 ->
    # 0.
    want = -(0.5 + 4.0) - 2 * (10.0 - 2.0) - 3.0
    # Corners between points: step^2 / u_y each, 5 of them, step 10 u_y / 200.
    assert done == pytest.approx(bound * want * U_Y, abs=bound * U_Y * 5 * 0.05**2)


def test_anchors_are_free_above_the_surface() -> None:
    P = np.array([[0.0, 0.2], [0.1, 0.1], [0.2, -0.1]])
    anchors = np.full((3, 2), 0.5)
    called(lines.drag_anchors)(P, anchors, LINE, LEVEL, medium_record(medium(static=Elastoplastic(U_Y, 0.0)))[0])
    # The first is where its station is: no strip beside it is in the sand. The upper end of the strip that pierces the
    # surface is dragged along as its lower end is; round-off of 0.1 m.
    np.testing.assert_allclose(anchors, [P[0], P[1] + U_Y, P[2] + U_Y], atol=1e-15)


def test_bristles_change_sign_near_the_zero_of_velocity() -> None:
    """Between two saturated bristles of opposite sign: off by no more of a strip than `friction` says."""
    rng = np.random.default_rng(5)
    for back, ahead in 10.0 ** rng.uniform(-4, 1, (100, 2)):
        s0, s1 = called(friction.drive)(-U_Y, -back, DAMPED), called(friction.drive)(U_Y, ahead, DAMPED)
        of_s, of_v = s0 / (s0 - s1), back / (back + ahead)
        w = back + ahead
        # The bound is reached where one of the ends stands still; round-off.
        assert abs(of_s - of_v) <= U_Y / (2 * U_Y + friction.SWITCH * w) * (1 + 1e-9)
