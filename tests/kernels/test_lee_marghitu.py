"""The law on strips and runs: closed resultants, brute force, signs."""

from __future__ import annotations

import numpy as np
import pytest
from support_slow import (
    TRUE_SIGN,
    TWO_WAYS,
    G,
    Link,
    cross,
    density,
    fitted_order,
    kernel,
    medium,
    midpoint,
    quadrature,
    random_link,
    resultants,
    stations_of,
)

from granular_contact.laws.lee_marghitu import LeeMarghitu, VerticalResistance
from granular_contact.laws.static_friction import Elastoplastic

STATES = 100
SLOPES = (None, 0.0, np.pi, np.pi / 2, -np.pi / 2)
UPRIGHT = Link(np.array([[0.1, 0.05], [0.1, -0.2]]), np.array([[0.4, -0.3]] * 2), 0.01)
DRAG, HORIZONTAL, VERTICAL = 0, 1, 2


def random_law(rng: np.random.Generator) -> LeeMarghitu:
    plunging, withdrawing = (VerticalResistance(*rng.uniform([0.5, 0.0], [30.0, 2.5])) for _ in range(2))
    return LeeMarghitu(rng.uniform(1000, 3000), rng.uniform(1, 10), rng.uniform(1, 10), plunging, withdrawing)


def steep(link: Link) -> bool:
    """Whether the closed resultant of an immersed link does not cancel: level, or more than 6 degrees off it."""
    c = link.P[1] - link.P[0]
    return c[1] == 0.0 or abs(c[1]) > 0.1 * np.linalg.norm(c)


def turning(link: Link, center: tuple[float, float], rate: float) -> Link:
    arm = link.P - np.array(center)
    return Link(link.P, rate * np.column_stack([-arm[:, 1], arm[:, 0]]), link.diameter, link.surface)


# ---- exact special cases ----


def test_upright_link_by_hand() -> None:
    d, z, rho = 0.01, 0.2, 2500.0
    F, totals = kernel(*stations_of(UPRIGHT, 5), UPRIGHT)
    speed = np.hypot(0.4, 0.3)
    lateral = 0.4 / speed  # sine of the angle between the link and its velocity
    drag = -6.5 * rho * d * z * lateral * speed * np.array([0.4, -0.3])
    static_h = -8.0 * G * rho * z**2 * d
    static_v = 22.0 * (z / d) ** 1.1 * G * rho * np.pi * d**2 / 4 * z
    # Closed forms all the way: round-off of a dozen operations.
    np.testing.assert_allclose(totals[DRAG, :2], drag, rtol=1e-12)
    np.testing.assert_allclose(totals[HORIZONTAL, :2], [static_h, 0.0], rtol=1e-12)
    np.testing.assert_allclose(totals[VERTICAL, :2], [0.0, static_v], rtol=1e-12)
    np.testing.assert_allclose(F.sum(axis=0), totals[:, :2].sum(axis=0), rtol=1e-12)


def test_where_the_forces_of_an_upright_link_act() -> None:
    _, totals = kernel(*stations_of(UPRIGHT, 5), UPRIGHT)
    fx, fy, moment = totals.T
    depth = -(0.1 * fy[:2] - moment[:2]) / fx[:2]
    # Drag at half the depth, a pressure that grows with depth at two thirds of it; round-off of cancelling parts.
    np.testing.assert_allclose(depth, [-0.5 * -0.2, -2 / 3 * -0.2], rtol=1e-11)


def test_where_the_vertical_force_of_a_slanted_link_acts() -> None:
    link = Link(np.array([[0.0, 0.05], [0.3, -0.1]]), np.array([[0.4, -0.3]] * 2), 0.01)
    _, totals = kernel(*stations_of(link, 7), link)
    # Density z^1.1 has its centroid at 2.1 / 3.1 of the depth, measured from the crossing at x = 0.1 to the tip at 0.3.
    # Round-off of a dozen operations.
    np.testing.assert_allclose(totals[VERTICAL, 2] / totals[VERTICAL, 1], 0.1 + 0.2 * 2.1 / 3.1, rtol=1e-11)


def test_moving_along_itself_has_no_drag_but_static_resistance() -> None:
    link = Link(UPRIGHT.P, np.array([[0.0, -1.0]] * 2), 0.01)
    _, totals = kernel(*stations_of(link, 3), link)
    assert not totals[DRAG].any()
    assert not totals[HORIZONTAL].any()
    assert totals[VERTICAL, 1] > 1.0  # N


def test_level_link_has_no_horizontal_static_resistance() -> None:
    link = Link(np.array([[0.0, -0.05], [0.2, -0.05]]), np.array([[0.4, -0.3]] * 2), 0.01)
    _, totals = kernel(*stations_of(link, 3), link)
    assert not totals[HORIZONTAL].any()
    expected = 2.1 * 22.0 * (5.0) ** 1.1 * G * 2500.0 * np.pi * 0.01**2 / 4 * 0.2
    # Three Gauss points on equal depths are exact up to round-off.
    np.testing.assert_allclose(totals[VERTICAL, 1], expected, rtol=1e-12)


# ---- closed resultants ----


@pytest.mark.parametrize("strips_", [1, 7])
def test_straight_links_match_the_closed_resultants(strips_: int) -> None:
    rng = np.random.default_rng(1)
    compared = 0
    for i in range(STATES):
        law = random_law(rng)
        depths = [None, (0.16, 0.4), (-0.4, -0.16)][i % 3]
        link = random_link(rng, SLOPES[i % len(SLOPES)], depths)
        if not steep(link):
            continue
        compared += 1
        _, totals = kernel(*stations_of(link, strips_), link, medium(law))
        want = resultants(link, law)
        # Closed forms with cancellation eps (z/dz)^2 of up to 1e-12, and 6e-11 of three Gauss points in level strips.
        np.testing.assert_allclose(totals[:, :2], want, rtol=1e-10, atol=1e-10 * np.abs(want).max())
    assert compared > 0.9 * STATES


@pytest.mark.parametrize("strips_", [1, 7])
def test_both_load_forms_agree_under_uniform_velocity(strips_: int) -> None:
    rng = np.random.default_rng(2)
    for i in range(STATES):
        link = random_link(rng, SLOPES[i % len(SLOPES)], [None, (0.16, 0.4)][i % 2])
        record = medium(random_law(rng))
        P, V = stations_of(link, strips_)
        _, distributed = kernel(P, V, link, record)
        F, resultant = kernel(P, V, link, record, resultant=True)
        # As above.
        scale = np.abs(distributed[:, :2]).max()
        np.testing.assert_allclose(resultant[:, :2], distributed[:, :2], rtol=1e-10, atol=1e-10 * scale)
        np.testing.assert_allclose(F.sum(axis=0), resultant[:, :2].sum(axis=0), rtol=1e-10, atol=1e-10 * scale)


def test_resultant_acts_at_the_middle_of_the_immersed_part() -> None:
    rng = np.random.default_rng(3)
    for _ in range(100):
        link = random_link(rng, depths=(0.0, 0.05))
        depth = -link.P[:, 1]
        if min(depth) > 0 or max(depth) < 0:
            continue
        deep = int(np.argmax(depth))
        crossing = link.P[deep] + (link.P[1 - deep] - link.P[deep]) * depth[deep] / (depth[deep] - depth[1 - deep])
        _, totals = kernel(*stations_of(link, 6), link, resultant=True)
        middle = 0.5 * (crossing + link.P[deep])
        # Round-off of positions up to 0.5 m over forces; the middle and the tip differ by centimetres.
        scale = np.abs(totals[:, :2]).max()
        np.testing.assert_allclose(totals[:, 2], cross(middle, totals[:, :2]), atol=1e-12 * scale)


# ---- brute force ----


def test_turning_links_match_brute_force_of_second_order() -> None:
    rng = np.random.default_rng(4)
    sizes = 2 ** np.arange(3, 9)
    for _ in range(4):
        link = random_link(rng, slope=-rng.uniform(0.3, 1.3), depths=(-0.04, 0.04))
        # A centre to the upper left of the link: neither velocity component changes sign along it, and |t x v| has no
        # kink.
        link = turning(link, (link.P[0, 0] - 0.1, link.P[0, 1] + 0.1), rng.choice([-5.0, 5.0]))
        _, totals = kernel(*stations_of(link, 1), link)
        brute = [midpoint(link, TWO_WAYS, int(n)) for n in sizes]
        for term, part in ((DRAG, 0), (DRAG, 2), (HORIZONTAL, 2), (VERTICAL, 1), (VERTICAL, 2)):
            exact = totals[term, part]
            errors = np.abs(np.array([b[term, part] for b in brute]) / exact - 1.0)
            # A midpoint rule on integrands whose second derivative is integrable: order 2 (z^1.1 at its zero included).
            # A kernel that was off by a part in 1e5 would bend the curve away from it.
            assert fitted_order(sizes, errors, 1e-12) == pytest.approx(-2.0, abs=0.2)
            assert errors[-1] < 1e-4
            # What Richardson's extrapolation of order 2 leaves is of order 3.1 at worst (z^2.1 Gauss-like end): 1e-7.
            richardson = (4 * brute[-1][term, part] - brute[-2][term, part]) / 3
            assert richardson == pytest.approx(exact, rel=3e-6)


def links_that_turn(rng: np.random.Generator, count: int) -> list[Link]:
    """Links that turn about a point of their own, or near it: in most of them both components change their sign."""
    out = []
    for i in range(count):
        link = random_link(rng, SLOPES[i % len(SLOPES)], [(-0.02, 0.05), (0.16, 0.3)][i % 2])
        xi = rng.uniform(0.05, 0.95)
        link = turning(link, tuple((1 - xi) * link.P[0] + xi * link.P[1]), rng.choice([-7.0, 7.0]))
        wind = rng.uniform(-0.3, 0.3, 2)  # moves the zeros of v_x, v_y and t x v apart
        out.append(Link(link.P, link.V + wind * (0.1, 1.0, 2.0)[i % 3], link.diameter))
    return out


def test_force_on_a_strip_turning_about_an_immersed_point_is_exact() -> None:
    rng = np.random.default_rng(5)
    turns = np.zeros(2, dtype=int)
    for link in links_that_turn(rng, 30):
        law = random_law(rng)
        _, totals = kernel(*stations_of(link, 1), link, medium(law))
        # Closed forms on either side of each zero, next to what they would be without a change of sign: 1e-10 as for
        # straight links, and the quadrature's 1e-11. |v| < 1e-12 m/s, where the sign is not sharp, is 1e-11 of a link.
        scale = np.abs(density(link, law, (np.arange(200) + 0.5) / 200)).mean(axis=2)
        np.testing.assert_allclose(totals, quadrature(link, law), rtol=0.0, atol=2e-10 * scale.max(axis=1).max())
        turns += np.sign(link.V[0]) * np.sign(link.V[1]) < 0.0
    assert (turns > 10).all()


def test_a_plain_midpoint_rule_agrees() -> None:
    rng = np.random.default_rng(6)
    points = 40000
    for link in links_that_turn(rng, 12):
        _, totals = kernel(*stations_of(link, 1), link)
        most = np.abs(density(link, TWO_WAYS, (np.arange(1000) + 0.5) / 1000)).max(axis=2)
        # Where a static density jumps from one bound to the other, twice the greatest density at most, over half a
        # point; likewise at the surface, where it begins.
        assert np.all(np.abs(totals - midpoint(link, TWO_WAYS, points)) <= 2.0 * most / points)


# ---- signs ----


def random_runs(rng: np.random.Generator, count: int) -> list[tuple[Link, np.ndarray, np.ndarray, np.ndarray]]:
    """Bent runs of stations with random velocities and anchors."""
    out = []
    for _ in range(count):
        link = random_link(rng)
        P, V = stations_of(link, 6)
        P += rng.uniform(-0.01, 0.01, P.shape)
        V += rng.uniform(-0.5, 0.5, V.shape)
        out.append((link, P, V, P + rng.uniform(-0.05, 0.05, P.shape)))
    return out


HALF_YIELDING = medium(static=Elastoplastic(0.03, 0.01))


@pytest.mark.parametrize(("vy", "branch"), [(-0.2, TWO_WAYS.plunging), (0.2, TWO_WAYS.withdrawing)])
@pytest.mark.parametrize("static", [TRUE_SIGN, Elastoplastic(1e-5, 1e-3)])
def test_direction_of_motion_chooses_the_branch(vy: float, branch: VerticalResistance, static: object) -> None:
    link = Link(UPRIGHT.P, np.array([[0.0, vy]] * 2), 0.01)
    P, V = stations_of(link, 3)
    anchors = P - 0.1 * V  # it has been moving for a while
    _, totals = kernel(P, V, link, medium(static=static), anchors)
    z, d = 0.2, 0.01
    want = -np.sign(vy) * branch.eta_v * (z / d) ** branch.lam * G * 2500.0 * np.pi * d**2 / 4 * z
    # Closed form, round-off; the other branch differs by a factor of more than 1.2.
    np.testing.assert_allclose(totals[VERTICAL, 1], want, rtol=1e-11)


@pytest.mark.parametrize("resultant", [False, True])
def test_every_term_takes_energy(resultant: bool) -> None:
    rng = np.random.default_rng(10)
    taken = np.zeros(3)
    for _ in range(STATES):
        link = random_link(rng)
        P, V = stations_of(link, 6)
        P += rng.uniform(-0.01, 0.01, P.shape)
        V += rng.uniform(-3.0, 3.0, V.shape)  # strips turn about points within them
        for term, law in enumerate(single_terms()):
            F, _ = kernel(P, V, link, medium(law), resultant=resultant)
            if resultant:  # one force, where one velocity is
                i = np.flatnonzero(F.any(axis=1))
                power = float((F[i] * V[i]).sum()) if len(i) else 0.0
            else:
                power = float((F * V).sum())
            # Where a velocity has just changed its sign, the work of one end is all but that of the other: round-off.
            assert power <= 1e-13 * np.abs(F * V).sum()
            taken[term] += power
    assert np.all(taken < -1.0)  # W: all three did something


def test_drag_takes_energy_whatever_the_motion() -> None:
    rng = np.random.default_rng(11)
    for link, P, V, _ in random_runs(rng, STATES):
        wild = V + rng.uniform(-3.0, 3.0, V.shape)
        F, _ = kernel(P, wild, link, medium(single_terms()[DRAG]))
        # -eta rho d |t x v| v . v pointwise, and Gauss weights are positive: never above zero, not even by round-off.
        assert (F * wild).sum() <= 0.0


def single_terms() -> tuple[LeeMarghitu, LeeMarghitu, LeeMarghitu]:
    none = VerticalResistance(0.0, 1.0)
    return (
        LeeMarghitu(2500.0, 6.5, 0.0, none, none),
        LeeMarghitu(2500.0, 0.0, 8.0, none, none),
        LeeMarghitu(2500.0, 0.0, 0.0, TWO_WAYS.plunging, TWO_WAYS.withdrawing),
    )


@pytest.mark.parametrize("resultant", [False, True])
def test_terms_add_up(resultant: bool) -> None:
    for link, P, V, anchors in random_runs(np.random.default_rng(12), 20):
        parts = [
            kernel(P, V, link, medium(law, Elastoplastic(0.03, 0.01)), anchors, False, resultant)[1]
            for law in single_terms()
        ]
        _, whole = kernel(P, V, link, HALF_YIELDING, anchors, False, resultant)
        # The same operations.
        np.testing.assert_allclose(sum(parts), whole, rtol=1e-14)
        for term in range(3):
            assert not np.delete(parts[term], term, axis=0).any()


# ---- end cap ----


@pytest.mark.parametrize("resultant", [False, True])
def test_end_cap_is_the_drag_of_a_disc(resultant: bool) -> None:
    for strips_, link in ((4, UPRIGHT), (3, random_link(np.random.default_rng(3), slope=-0.7, depths=(0.16, 0.3)))):
        P, V = stations_of(link, strips_)
        _, without = kernel(P, V, link, resultant=resultant)
        _, with_cap = kernel(P, V, link, cap=True, resultant=resultant)
        v, t = link.V[0], link.P[1] - link.P[0]
        face = np.pi * link.diameter**2 / 4
        want = -6.5 * 2500.0 * face * abs(v @ t) / np.linalg.norm(t) * v
        # A difference of forces of some 10 N.
        np.testing.assert_allclose((with_cap - without)[DRAG, :2], want, rtol=1e-9)
        assert not (with_cap - without)[1:].any()


def test_end_cap_above_the_surface_does_nothing() -> None:
    upside_down = Link(UPRIGHT.P[::-1], UPRIGHT.V, 0.01)
    P, V = stations_of(upside_down, 4)
    np.testing.assert_array_equal(kernel(P, V, upside_down, cap=True)[1], kernel(P, V, upside_down)[1])
