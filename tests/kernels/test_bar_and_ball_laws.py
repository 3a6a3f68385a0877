"""albert and hill against their resultants, the scalar laws against their formulas."""

from __future__ import annotations

import numpy as np
import pytest
from support_laws import (
    ALBERT,
    BAR_LAWS,
    DIAMETER,
    HILL,
    HILL_SCALED,
    MASS,
    SCALAR_LAWS,
    SOFT,
    TRUE_SIGN,
    Array,
    G,
    Strip,
    ball_force,
    dragged,
    label,
    strip_force,
)

from granular_contact.laws.albert import Albert
from granular_contact.laws.hill import Hill
from granular_contact.laws.lee_marghitu import LeeMarghitu, VerticalResistance

PIERCING = np.array([[0.0, 0.03], [0.05, -0.12]])


def moving(v: tuple[float, float], P: Array = PIERCING) -> Strip:
    return Strip(P, np.array([v, v]))


def total(medium: object, s: Strip) -> Array:
    return strip_force(s, medium.record(TRUE_SIGN, G)).sum(axis=(0, 1))


def test_albert_gives_its_resultant_and_nothing_else() -> None:
    for vx in (-0.3, 0.3):
        want = -np.sign(vx) * 8.0 * G * 2500.0 * 0.12**2 * 0.01
        np.testing.assert_allclose(total(ALBERT, moving((vx, -0.2))), [want, 0.0], rtol=1e-12)
    assert not total(ALBERT, moving((0.0, -0.2))).any()


@pytest.mark.parametrize(("medium", "scale"), [(HILL, 0.01), (HILL_SCALED, 0.02)])
@pytest.mark.parametrize(("vy", "eta", "lam"), [(-0.2, 10.0, 1.4), (0.2, 0.5, 1.7)])
def test_hill_gives_its_resultant_and_nothing_else(
    medium: Hill, scale: float, vy: float, eta: float, lam: float
) -> None:
    immersed = np.linalg.norm(PIERCING[1] - PIERCING[0]) * 0.12 / 0.15
    volume = np.pi * 0.01**2 / 4 * immersed
    want = -np.sign(vy) * eta * (0.12 / scale) ** lam * G * 2500.0 * volume
    np.testing.assert_allclose(total(medium, moving((0.3, vy))), [0.0, want], rtol=1e-12)


def test_albert_and_hill_are_parts_of_lee_marghitu() -> None:
    plunging, withdrawing = VerticalResistance(22.0, 1.1), VerticalResistance(3.0, 1.7)
    parts = Albert(2500.0, 8.0), Hill(2500.0, plunging, withdrawing)
    whole = LeeMarghitu(2500.0, 0.0, 8.0, plunging, withdrawing)
    rng = np.random.default_rng(4)
    for _ in range(50):
        P, v = rng.uniform(-0.1, 0.05, (2, 2)), rng.uniform(-1, 1, 2)
        s = Strip(P, np.array([v, v]))
        got = sum(total(part, s) for part in parts)
        np.testing.assert_allclose(got, total(whole, s), rtol=1e-11, atol=1e-12)


V = np.array([1.2, -1.6])  # 2 m/s
DEEP = 0.05
WANT = {
    "bingham": 3.0 + 2.0 * 2.0,
    "poncelet": 3.0 + 0.7 * 4.0,
    "allen": 0.7 * 4.0 + 2.0 * 2.0 + 3.0,
    "linear_depth": 90.0 * DEEP,
    "tsimring_volfson": 0.7 * 4.0 + 400.0 * DEEP**1.6,
}


@pytest.mark.parametrize("medium", SCALAR_LAWS[:5], ids=label)
def test_scalar_laws_are_their_formulas(medium: object) -> None:
    f = ball_force(DEEP, V, np.zeros(2), medium.record(TRUE_SIGN, G))
    np.testing.assert_allclose(f.sum(axis=0), -WANT[medium.name] * V / 2.0, rtol=1e-12)
    assert not f[len(medium.terms) :].any()
    assert all(f[i].any() for i in range(len(medium.terms)))


@pytest.mark.parametrize(("medium", "d1"), [(SCALAR_LAWS[5], 3.4 * DIAMETER), (SCALAR_LAWS[6], 0.09)])
def test_katsuragi_durian_takes_the_mass_of_the_ball(medium: object, d1: float) -> None:
    f = ball_force(DEEP, V, np.zeros(2), medium.record(TRUE_SIGN, G))
    np.testing.assert_allclose(f[0], -90.0 * DEEP * V / 2.0, rtol=1e-12)
    np.testing.assert_allclose(f[1], -MASS / d1 * 2.0 * V, rtol=1e-12)


def test_anchor_of_a_ball_and_of_a_bar() -> None:
    p, u_y = np.array([0.03, -0.06]), SOFT.yield_displacement
    ball = dragged(p, np.zeros(2), SCALAR_LAWS[0].record(SOFT, G))
    np.testing.assert_allclose(p - ball, u_y * p / np.linalg.norm(p), rtol=1e-12)
    for medium in BAR_LAWS:
        np.testing.assert_allclose(p - dragged(p, np.zeros(2), medium.record(SOFT, G)), [u_y, -u_y], rtol=1e-12)
