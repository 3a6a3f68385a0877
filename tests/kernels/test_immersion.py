"""Closed depth integrals against numerical quadrature."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from support_parts import called

from granular_contact.sand.kernels.immersion import LEVEL, immersed_interval, moments, part_integrals, sign_change

EXPONENTS = (0.0, 0.3, 1.0, 1.1, 1.7, 2.0, 3.0)
# Kinds of strip by the depths of its ends: wholly immersed, cut either way, level, nearly level.
KINDS = ("immersed", "rising", "sinking", "level", "near level")


def ends(kind: str, rng: np.random.Generator) -> tuple[float, float]:
    a, b = rng.uniform(0.01, 2.0, 2)
    return {
        "immersed": (a, b),
        "rising": (a, -b),
        "sinking": (-a, b),
        "level": (a, a),
        "near level": (a, a * (1 + rng.uniform(-1e-4, 1e-4))),
    }[kind]


def integrals(z0: float, z1: float, lam: float) -> tuple[float, float]:
    return called(part_integrals)(*called(immersed_interval)(z0, z1), z0, z1, lam)


def by_quadrature(z0: float, z1: float, lam: float) -> tuple[float, float]:
    crossing = z0 / (z0 - z1) if (z0 > 0) != (z1 > 0) else None
    first = 0.0 if z0 >= 0 else crossing
    last = 1.0 if z1 >= 0 else crossing

    def integrand(xi: float, end: int) -> float:
        return max(0.0, (1 - xi) * z0 + xi * z1) ** lam * (xi if end else 1 - xi)

    return tuple(quad(integrand, first, last, args=(end,), epsabs=0.0, epsrel=1e-12, limit=200)[0] for end in (0, 1))


@pytest.mark.parametrize("lam", EXPONENTS)
@pytest.mark.parametrize("kind", KINDS)
def test_integrals_match_quadrature(kind: str, lam: float) -> None:
    rng = np.random.default_rng(7)
    for _ in range(40):
        z0, z1 = ends(kind, rng)
        # quad is asked for 1e-12; the closed form cancels to eps (z/dz)^2 = 5e-13 at the switch; random pairs with a
        # difference below LEVEL take three Gauss points, whose own error has a test below.
        if kind == "immersed" and abs(z0 - z1) <= LEVEL * (z0 + z1):
            continue
        np.testing.assert_allclose(integrals(z0, z1, lam), by_quadrature(z0, z1, lam), rtol=5e-11)


@pytest.mark.parametrize("lam", EXPONENTS)
def test_strip_above_the_surface_has_zero_integrals(lam: float) -> None:
    assert integrals(-0.1, -0.2, lam) == (0.0, 0.0)
    assert integrals(0.0, 0.0, lam) == (0.0, 0.0)


def around_the_switch(lam: float) -> tuple[np.ndarray, np.ndarray]:
    """Relative jumps of (J_0, J_1) and of J_0 + J_1 where the closed form takes over from three Gauss points."""
    z0, sides = 0.7, []
    for side in (1 - 1e-13, 1 + 1e-13):  # the integrals themselves change by 1e-15 between these two
        level = LEVEL * side
        sides.append(np.array(integrals(z0, z0 * (1 + level) / (1 - level), lam)))
    low, high = sides
    return np.abs(high / low - 1.0), np.abs(high.sum() / low.sum() - 1.0)


@pytest.mark.parametrize("lam", EXPONENTS)
def test_ends_are_continuous_at_the_switch(lam: float) -> None:
    # Three Gauss points on z^lam N_e are off by less than (dz/z)^6 = 6e-11 at dz/z = 2 LEVEL, the closed form by
    # eps / (dz/z)^2 = 6e-13.
    assert around_the_switch(lam)[0].max() < 1e-10


@pytest.mark.parametrize("lam", EXPONENTS)
@pytest.mark.parametrize("kind", ["immersed", "level", "near level"])
def test_parts_match_quadrature(kind: str, lam: float) -> None:
    rng = np.random.default_rng(9)
    for _ in range(40):
        z0, z1 = ends(kind, rng)
        a, b = np.sort(rng.uniform(0.0, 1.0, 2))

        def density(xi: float, end: int, z0: float = z0, z1: float = z1) -> float:
            return ((1 - xi) * z0 + xi * z1) ** lam * (xi if end else 1 - xi)

        want = [quad(density, a, b, args=(end,), epsabs=0.0, epsrel=1e-12)[0] for end in (0, 1)]
        # quad is asked for 1e-12; three Gauss points on parts that are level within LEVEL: 6e-11; the closed form
        # cancels to eps (z/dz)^2 = 6e-13.
        np.testing.assert_allclose(called(part_integrals)(a, b, z0, z1, lam), want, rtol=1e-10)


@pytest.mark.parametrize("lam", EXPONENTS)
def test_parts_add_up_to_the_immersed_interval(lam: float) -> None:
    rng = np.random.default_rng(10)
    for _ in range(100):
        z0, z1 = rng.uniform(-1.0, 1.0, 2)
        cuts = [0.0, *np.sort(rng.uniform(0.0, 1.0, 3)), 1.0]
        immersed = called(immersed_interval)(z0, z1)
        inside = np.clip(cuts, *immersed)
        parts = np.sum([called(part_integrals)(a, b, z0, z1, lam) for a, b in pairwise(inside)], axis=0)
        # As above; the ends of the part lie on the surface only up to round-off.
        np.testing.assert_allclose(parts, integrals(z0, z1, lam), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("lam", EXPONENTS)
@pytest.mark.parametrize("kind", ["immersed", "level", "near level", "from the surface", "to the surface"])
def test_moments_match_quadrature(kind: str, lam: float) -> None:
    rng = np.random.default_rng(12)
    for _ in range(40):
        deep = rng.uniform(0.01, 2.0)
        special = {"from the surface": (0.0, deep), "to the surface": (deep, 0.0)}
        z0, z1 = special[kind] if kind in special else ends(kind, rng)
        want = quad(
            lambda xi, z0=z0, z1=z1: ((1 - xi) * z0 + xi * z1) ** lam * xi**2, 0.0, 1.0, epsabs=0.0, epsrel=1e-12
        )[0]
        *others, square = called(moments)(z0, z1, lam)
        # Differences of powers over dz^3: eps (z/dz)^3, which is 1e-16 x 50^3 = 3e-11 where three Gauss points take
        # over; those are off by (dz/z)^6 = 6e-11 there.
        np.testing.assert_allclose(square, want, rtol=2e-10)
        # Over dz^2.
        np.testing.assert_allclose(others, by_quadrature(z0, z1, lam), rtol=1e-10)


@pytest.mark.parametrize("lam", EXPONENTS)
def test_moments_are_continuous_at_the_switch(lam: float) -> None:
    for turn in (1, -1):
        sides = []
        for side in (1 - 1e-13, 1 + 1e-13):
            level = LEVEL * side
            sides.append(called(moments)(*(0.7, 0.7 * (1 + level) / (1 - level))[::turn], lam))
        # As above, both.
        np.testing.assert_allclose(*sides, rtol=2e-10)


def test_moments_of_hardly_any_depth() -> None:
    for z in (1e-310, 1e-120, 1e-60):
        # Exponent 0: one third, whatever the depth; three Gauss points on a cubic are exact.
        for ends in ((0.0, z), (z, 0.0)):
            assert called(moments)(*ends, 0.0) == pytest.approx((0.5, 0.5, 1.0 / 3.0), rel=1e-12)
        assert max(called(moments)(0.0, z, 1.1)) < 1e-60


def test_where_a_sign_changes() -> None:
    assert called(sign_change)(0.0, 1.0, -1.0, 3.0) == 0.25
    assert called(sign_change)(0.0, 1.0, 3.0, -1.0) == 0.75
    # Never outside the part that was asked for; at its end where there is no change, at rest included.
    assert called(sign_change)(0.3, 0.9, -1.0, 3.0) == 0.3
    assert called(sign_change)(0.3, 0.6, 3.0, -1.0) == 0.6
    for pair in ((1.0, 2.0), (-1.0, -2.0), (0.0, 0.0), (0.0, 1.0), (-1.0, 0.0)):
        assert called(sign_change)(0.3, 0.6, *pair) == 0.6


def test_switching_the_ends_switches_the_results() -> None:
    assert integrals(0.3, -0.2, 1.1) == pytest.approx(integrals(-0.2, 0.3, 1.1)[::-1], rel=1e-14)


@pytest.mark.parametrize(
    ("z0", "z1", "expected"),
    [
        (-1.0, -2.0, (0.0, 0.0)),
        (0.0, 0.0, (0.0, 0.0)),
        (1.0, 2.0, (0.0, 1.0)),
        (1.0, 1.0, (0.0, 1.0)),
        (0.0, 1.0, (0.0, 1.0)),
        (1.0, 0.0, (0.0, 1.0)),
        (-1.0, 3.0, (0.25, 1.0)),
        (3.0, -1.0, (0.0, 0.75)),
    ],
)
def test_interval(z0: float, z1: float, expected: tuple[float, float]) -> None:
    assert called(immersed_interval)(z0, z1) == expected


depth = st.floats(-1.0, 1.0).filter(lambda z: abs(z) > 1e-3)


@settings(max_examples=60, deadline=None)
@given(depth, depth, st.floats(0.001, 0.999))
def test_interval_holds_the_immersed_part(z0: float, z1: float, xi: float) -> None:
    first, last = called(immersed_interval)(z0, z1)
    z = (1 - xi) * z0 + xi * z1
    if abs(z) > 1e-9:  # on the surface itself either answer is right
        assert (first < xi < last) == (z > 0.0)
