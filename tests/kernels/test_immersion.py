"""Closed depth integrals against numerical quadrature, their gradients against differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from granular_contact.kernels.immersion import (
    LEVEL,
    depth_integral_gradients,
    depth_integrals,
    immersed_interval,
)

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
        # difference below LEVEL take the two-point rule, whose own error has a test below.
        if kind == "immersed" and abs(z0 - z1) <= LEVEL * (z0 + z1):
            continue
        np.testing.assert_allclose(depth_integrals(z0, z1, lam), by_quadrature(z0, z1, lam), rtol=5e-11)


@pytest.mark.parametrize("lam", EXPONENTS)
def test_strip_above_the_surface_has_none(lam: float) -> None:
    assert depth_integrals(-0.1, -0.2, lam) == (0.0, 0.0)
    assert depth_integrals(0.0, 0.0, lam) == (0.0, 0.0)
    assert depth_integral_gradients(-0.1, -0.2, lam) == (0.0, 0.0, 0.0, 0.0)


def around_the_switch(lam: float) -> tuple[np.ndarray, np.ndarray]:
    """Relative jumps of (J_0, J_1) and of J_0 + J_1 where the closed form takes over from the two-point rule."""
    z0, sides = 0.7, []
    for side in (1 - 1e-13, 1 + 1e-13):  # the integrals themselves change by 1e-15 between these two
        level = LEVEL * side
        sides.append(np.array(depth_integrals(z0, z0 * (1 + level) / (1 - level), lam)))
    low, high = sides
    return np.abs(high / low - 1.0), np.abs(high.sum() / low.sum() - 1.0)


@pytest.mark.parametrize("lam", EXPONENTS)
def test_ends_are_continuous_at_the_switch(lam: float) -> None:
    # Three Gauss points on z^lam N_e are off by less than (dz/z)^6 = 6e-11 at dz/z = 2 LEVEL, the closed form by
    # eps / (dz/z)^2 = 6e-13.
    assert around_the_switch(lam)[0].max() < 1e-10


@pytest.mark.parametrize("lam", EXPONENTS)
@pytest.mark.parametrize("kind", KINDS)
def test_gradients_match_differences(kind: str, lam: float) -> None:
    rng = np.random.default_rng(11)
    weights = np.array([-1, 9, -45, 45, -9, 1]) / 60.0  # sixth order
    for _ in range(20):
        z0, z1 = ends(kind, rng)
        if kind == "near level":  # the stencil must stay on one side of the switch
            z1 = z0 * (1 + 1e-5)
        h = 1e-3 * min(abs(z0), abs(z1), max(abs(z1 - z0), LEVEL * abs(z0)))
        got = np.reshape(depth_integral_gradients(z0, z1, lam), (2, 2))
        for column, (d0, d1) in enumerate(((h, 0.0), (0.0, h))):
            values = [depth_integrals(z0 + k * d0, z1 + k * d1, lam) for k in (-3, -2, -1, 1, 2, 3)]
            difference = weights @ np.array(values) / h
            # Stencil: truncation (1e-3)^6; round-off eps J / h, which is 2e-13 J / min(z, dz), and times (z/dz)^2 for
            # the cancellation inside the closed form: bounded by 1e-6 of the greatest gradient for dz > z / 100.
            scale = max(np.abs(got).max(), max(values[0]) / max(abs(z0), abs(z1)))
            np.testing.assert_allclose(got[:, column], difference, rtol=0.0, atol=1e-6 * scale)


def test_switching_the_ends_switches_the_results() -> None:
    assert depth_integrals(0.3, -0.2, 1.1) == depth_integrals(-0.2, 0.3, 1.1)[::-1]
    g00, g01, g10, g11 = depth_integral_gradients(0.3, -0.2, 1.1)
    assert (g11, g10, g01, g00) == depth_integral_gradients(-0.2, 0.3, 1.1)


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
    assert immersed_interval(z0, z1) == expected


depth = st.floats(-1.0, 1.0).filter(lambda z: abs(z) > 1e-3)


@settings(max_examples=200, deadline=None)
@given(depth, depth, st.floats(0.001, 0.999))
def test_interval_holds_what_is_immersed(z0: float, z1: float, xi: float) -> None:
    first, last = immersed_interval(z0, z1)
    z = (1 - xi) * z0 + xi * z1
    if abs(z) > 1e-9:  # on the surface itself either answer is right
        assert (first < xi < last) == (z > 0.0)
