"""Mobilised static force on a bar: closed integrals of s z^lam along a strip against quadrature."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from support_laws import LEE_MARGHITU, G
from support_parts import called
from support_slow import fitted_order

from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.kernels.bar_statics import linear_integrals, mobilised_integrals
from granular_contact.sand.kernels.friction import direction
from granular_contact.sand.kernels.immersion import part_integrals

EXPONENTS = (0.0, 0.3, 1.0, 1.1, 1.7, 2.0)
BRISTLE, SMOOTH = (LEE_MARGHITU.record(static, G)[0] for static in (Elastoplastic(), Smooth()))
# Three Gauss points on strips that are level within LEVEL: (dz/z)^6 = 6e-11; the closed forms beyond it: 3e-11.
CLOSED = 2e-10


def strip(rng: np.random.Generator) -> tuple[float, float, float, float]:
    """A part (a, b) of a strip and depths of the strip's ends, not negative in the part; some end at the surface."""
    a, b = np.sort(rng.uniform(0.0, 1.0, 2))
    za, zb = rng.uniform(0.01, 2.0, 2)
    za, zb = [(za, zb), (za, za), (0.0, zb), (za, 0.0)][rng.choice(4, p=[0.5, 0.2, 0.15, 0.15])]
    slope = (zb - za) / (b - a)
    return a, b, za - a * slope, zb + (1.0 - b) * slope


def by_quadrature(a: float, b: float, z: tuple[float, float], lam: float, s: tuple[float, float], m: np.void) -> list:
    """Integrals of sigma z^lam N_e, in pieces between the places where |s| is 1."""
    cuts = sorted(x for x in ((k - s[0]) / (s[1] - s[0]) for k in (-1.0, 0.0, 1.0)) if a < x < b)

    def density(xi: float, end: int) -> float:
        depth = max(0.0, (1 - xi) * z[0] + xi * z[1])
        return depth**lam * called(direction)((1 - xi) * s[0] + xi * s[1], m) * (xi if end else 1 - xi)

    places = np.array([a, *cuts, b])
    return [
        sum(quad(density, p, q, args=(end,), epsabs=1e-15, epsrel=1e-12)[0] for p, q in pairwise(places))
        for end in (0, 1)
    ]


def drives(rng: np.random.Generator, a: float, b: float, most: float) -> tuple[float, float]:
    """Drive at the ends of the strip that has one sign between a and b and is at most so much there."""
    sa, sb = rng.choice([-1.0, 1.0]) * rng.uniform(0.0, most, 2)
    slope = (sb - sa) / (b - a)
    return sa - a * slope, sb + (1.0 - b) * slope


@pytest.mark.parametrize("lam", EXPONENTS)
def test_a_bristle_below_yield_is_linear_along_the_strip(lam: float) -> None:
    rng = np.random.default_rng(1)
    for _ in range(100):
        a, b, z0, z1 = strip(rng)
        sa, sb = rng.uniform(-1.0, 1.0, 2)  # of either sign: no law but a linear one
        slope = (sb - sa) / (b - a)
        s = sa - a * slope, sb + (1.0 - b) * slope
        want = by_quadrature(a, b, (z0, z1), lam, s, BRISTLE)
        scale = (b - a) * max(z0 + a * (z1 - z0), z0 + b * (z1 - z0)) ** lam
        # The parts of s cancel where it changes its sign, so next to the greatest that the integral can be.
        np.testing.assert_allclose(
            called(linear_integrals)(a, b, z0, z1, lam, sa, sb), want, atol=CLOSED * scale + 1e-13
        )


@pytest.mark.parametrize("lam", EXPONENTS)
def test_mobilised_integrals_match_quadrature(lam: float) -> None:
    rng = np.random.default_rng(2)
    yields = np.zeros(3, dtype=int)
    for _ in range(200):
        a, b, z0, z1 = strip(rng)
        s0, s1 = drives(rng, a, b, 3.0)
        got = called(mobilised_integrals)(a, b, z0, z1, lam, s0, s1, BRISTLE)
        want = by_quadrature(a, b, (z0, z1), lam, (s0, s1), BRISTLE)
        scale = (b - a) * max(z0 + a * (z1 - z0), z0 + b * (z1 - z0)) ** lam
        np.testing.assert_allclose(got, want, atol=CLOSED * scale + 1e-13)
        yields[int(abs(s0 + a * (s1 - s0)) >= 1.0) + int(abs(s0 + b * (s1 - s0)) >= 1.0)] += 1
    assert (yields > 10).all()  # none, one and both ends of the part


@pytest.mark.parametrize("lam", EXPONENTS)
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_force_is_continuous_where_a_bristle_yields(lam: float, sign: float) -> None:
    near = 1e-9
    for other in (0.3, 1.0, 2.5):
        for order in (1, -1):
            pairs = [(sign * (1.0 + side * near), sign * other)[::order] for side in (-1.0, 1.0)]
            below, above = (called(mobilised_integrals)(0.1, 0.8, 0.4, 1.3, lam, *pair, BRISTLE) for pair in pairs)
            # sigma changes by 2e-9 at most between the two, times z^lam of up to 1.3^2; the rest as above.
            np.testing.assert_allclose(below, above, atol=4e-9 + CLOSED * 1.7)


def test_far_beyond_yield_is_the_bound() -> None:
    for sign in (-1.0, 1.0):
        got = called(mobilised_integrals)(0.1, 0.8, 0.4, 1.3, 1.1, sign * 1e9, sign * 3e12, BRISTLE)
        assert got == tuple(sign * j for j in called(part_integrals)(0.1, 0.8, 0.4, 1.3, 1.1))


def test_a_smooth_sign_is_integrated_by_three_gauss_points() -> None:
    """Away from its zero, where the caller cuts the strip."""
    sizes = 0.4 * 0.75 ** np.arange(6)
    errors = []
    for d in sizes:
        z, s = (0.7, 0.7 + 0.3 * d), (0.2, 0.2 + d)
        want = by_quadrature(0.0, 1.0, z, 1.1, s, SMOOTH)
        errors.append(np.subtract(called(mobilised_integrals)(0.0, 1.0, *z, 1.1, *s, SMOOTH), want))
    # The sixth derivative of sigma z^lam falls with d^6, that of its product with N_e, linear in xi, with d^5.
    assert fitted_order(sizes, np.abs(np.sum(errors, axis=1)), 1e-13) > 5.8
    assert fitted_order(sizes, np.abs(errors).max(axis=1), 1e-13) == pytest.approx(5.0, abs=0.3)
