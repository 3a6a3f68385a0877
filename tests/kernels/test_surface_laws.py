"""rft, drft and rft3d: published values, signs, symmetries, and the effect of regularisation."""

from __future__ import annotations

import numpy as np
import pytest
from support_laws import (
    CLOSE,
    GENERIC,
    LOOSE,
    ROUGH,
    SAND,
    SURFACE_LAWS,
    TRUE_SIGN,
    Array,
    G,
    Strip,
    dragged,
    element,
    label,
    published_rft,
    strip_force,
)

from granular_contact.laws import rft3d
from granular_contact.laws.drft import Drft
from granular_contact.laws.rft import Rft
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.laws.surface_pressure import SurfacePressure
from granular_contact.sand.kernels.plates import EDGE, PRESSED, leading

ANGLES = np.arange(-90.0, 91.0, 7.5)
SETS = pytest.mark.parametrize("coefficients", [GENERIC, LOOSE, CLOSE], ids=["generic", "loose", "close"])
EVERY = pytest.mark.parametrize("medium", SURFACE_LAWS, ids=label)


def response(medium: object, s: Strip) -> Array:
    """Force on a strip, all terms and both ends."""
    return strip_force(s, medium.record(TRUE_SIGN, G)).sum(axis=(0, 1))


@SETS
def test_rft_is_the_printed_series_at_every_angle(coefficients: object) -> None:
    for beta in ANGLES:
        for gamma in ANGLES:
            want_x, want_z = published_rft(coefficients, beta, gamma)
            # Square metre at 1 m: N is Pa/m. The fold-free form is an identity; round-off of a dozen operations.
            got = response(Rft(coefficients), element(beta, gamma)) / 1e6
            np.testing.assert_allclose(got, [-want_x, want_z], atol=1e-12)


@pytest.mark.parametrize(("coefficients", "want"), [(GENERIC, 1.000), (LOOSE, 0.254), (CLOSE, 0.464)])
def test_rft_of_a_level_plate_pushed_down(coefficients: object, want: float) -> None:
    # Sums of three-digit coefficients: exact but for round-off.
    np.testing.assert_allclose(response(Rft(coefficients), element(0, 90)), [0.0, 1e6 * want], rtol=1e-12, atol=1e-6)


@pytest.mark.parametrize(
    ("beta", "gamma", "r", "z"), [(0, 45, -0.199, 0.761), (45, 45, -0.342, 0.583), (90, 0, -0.192, 0.075)]
)
def test_rft3d_at_the_published_states(beta: float, gamma: float, r: float, z: float) -> None:
    b, g = np.radians([beta, gamma])
    got = rft3d.alpha((np.sin(b), 0.0, -np.cos(b)), (np.cos(g), 0.0, -np.sin(g)))
    np.testing.assert_allclose(got, [r, 0.0, z], atol=5e-4)  # as printed, three digits


def test_rft3d_is_scaled_by_density_and_friction() -> None:
    xi = 1617.0 * 9.81 * (894 * 1.07**3 - 386 * 1.07**2 + 89 * 1.07)
    # Away from the vertical and where nothing would drive, on a surface too rough to slide.
    got = response(ROUGH, element(45, 45))
    np.testing.assert_allclose(
        got, xi * np.array(rft3d.alpha((0.5**0.5, 0.0, -(0.5**0.5)), (0.5**0.5, 0.0, -(0.5**0.5))))[[0, 2]], rtol=1e-9
    )


def test_rft3d_limits_the_tangential_part() -> None:
    limited = 0
    for beta in ANGLES:
        for gamma in ANGLES:
            s = element(beta, gamma)
            t = (s.P[1] - s.P[0]) / np.linalg.norm(s.P[1] - s.P[0])
            n, u = np.array([t[1], -t[0]]), s.V[0]
            force, rough = response(SAND, s), response(ROUGH, s)
            along, normal = force @ t, force @ n
            if abs(u @ force) < 1e-3 * np.linalg.norm(force):
                continue  # a part that would drive was dropped, which turns the force
            # The limit is exact; round-off of 1e7 N.
            assert abs(along) <= SAND.mu_surf * abs(normal) + 1e-6
            limited += abs(rough @ t) > 1.01 * abs(along)
    assert limited > 100


@EVERY
def test_no_state_drives_the_element(medium: object) -> None:
    least = np.inf
    for beta in np.arange(-90.0, 91.0, 10.0):
        for gamma in np.arange(-180.0, 180.0, 10.0):
            s = element(beta, gamma)
            force = response(medium, s)
            power, scale = float(force @ s.V[0]), float(np.linalg.norm(force))
            # Zero where a driving part was dropped, with round-off of the force.
            assert power <= 1e-12 * scale
            least = min(least, -power / max(scale, 1e-300))
    assert least >= -1e-12


@EVERY
def test_plunging_is_resisted_more_than_withdrawing(medium: object) -> None:
    down, up = response(medium, element(0, 90)), response(medium, element(0, -90))
    assert down[1] > 0.0 >= up[1]
    assert (up[1] == 0.0) == isinstance(medium, SurfacePressure)  # which say nothing of what is lifted
    assert down[1] > 2.0 * abs(up[1])


def test_an_outline_is_loaded_where_it_leads() -> None:
    medium = Rft(GENERIC)
    plate, outside, inside = (response(medium, element(0, 90, side=side)) for side in (0, -1, 1))
    # The plate lies along +x and moves down: its right-hand side leads.
    np.testing.assert_array_equal(outside, plate)
    assert not inside.any()
    # Over the first EDGE of n . u the stress is faded in: at half of it, half.
    grazing = np.degrees(np.arcsin(0.5 * EDGE))
    half, whole = (response(medium, element(0, grazing, side=side)) for side in (-1, 0))
    np.testing.assert_allclose(half, 0.5 * whole, rtol=1e-9)


def test_resting_outline_is_loaded_by_the_normal_stretch_of_its_bristles() -> None:
    """Not by their angle, which a hundredth of a micrometre changes: the force would be that stiff a spring."""
    m = Rft(GENERIC).record(Elastoplastic(yield_displacement=1e-5), G).view(np.recarray)[0]
    for along in (0.0, 0.5e-5, 1e-5):
        got = [leading((1.0, 0.0), (along, -share * PRESSED * 1e-5), -1, m) for share in (-0.5, 0.0, 0.5, 1.0)]
        np.testing.assert_allclose(got, [0.0, 0.0, 0.5, 1.0], rtol=1e-12)


def test_inertia_of_drft() -> None:
    still, moving = Drft(LOOSE, 1500.0, 1.1), element(30, 70, speed=2.0)
    f = strip_force(moving, still.record(TRUE_SIGN, G))
    n = np.array([np.sin(np.radians(30)), -np.cos(np.radians(30))])
    v_n = moving.V[0] @ n
    # A square metre: -lam rho v_n^2 n; round-off.
    np.testing.assert_allclose(f[1].sum(axis=0), -1.1 * 1500.0 * v_n**2 * n, rtol=1e-9)
    np.testing.assert_allclose(f[0], strip_force(moving, Rft(LOOSE).record(TRUE_SIGN, G))[0], rtol=1e-12)


def test_inertia_of_a_turning_strip_is_integrated_exactly() -> None:
    medium = Drft(LOOSE, 1500.0, 1.1).record(TRUE_SIGN, G)
    P, V = np.array([[0.0, 0.03], [0.1, -0.05]]), np.array([[0.4, 4.0], [-0.3, -2.0]])
    for side in (-1, 0, 1):
        f = strip_force(Strip(P, V, 0.02, side), medium)[1]
        xi = (np.arange(200000) + 0.5) / 200000
        p, v = (np.outer(1 - xi, X[0]) + np.outer(xi, X[1]) for X in (P, V))
        c = P[1] - P[0]
        length = np.linalg.norm(c)
        n = np.array([-c[1], c[0]]) / length
        v_n = v @ n * (p[:, 1] < 0)
        v_n = v_n if side == 0 else side * np.maximum(0.0, side * v_n)
        density = -1.1 * 1500.0 * 0.02 * length * np.outer(v_n * np.abs(v_n), n) / len(xi)
        want = np.array([(1 - xi) @ density, xi @ density])
        # Midpoint rule, 200000 points, one jump where the surface is crossed: 5e-6 of the value.
        np.testing.assert_allclose(f, want, atol=1e-5 * np.abs(want).max())
        assert np.abs(want).max() > 0.05  # N


def test_lowered_surface_of_drft() -> None:
    lowered = Drft(LOOSE, 1500.0, 1.1, surface_drop=0.01).record(TRUE_SIGN, G)
    plain = Drft(LOOSE, 1500.0, 1.1).record(TRUE_SIGN, G)
    s = Strip(np.array([[0.0, 0.01], [0.1, -0.05]]), np.array([[0.4, -1.0]] * 2))
    deeper = Strip(s.P + np.array([0.0, 0.01]), s.V)
    # Round-off of the depths.
    np.testing.assert_allclose(strip_force(s, lowered), strip_force(deeper, plain), rtol=1e-12)


def test_pressure_is_integrated_exactly_from_the_surface() -> None:
    record = Rft(GENERIC).record(TRUE_SIGN, G)
    s = Strip(np.array([[0.0, 0.02], [0.06, -0.06]]), np.array([[0.5, -1.0]] * 2), 0.03)
    f = strip_force(s, record)[0]
    beta, gamma = np.degrees(np.arctan2(-0.08, 0.06)), np.degrees(np.arctan2(1.0, 0.5))
    stress_x, stress_z = published_rft(GENERIC, beta, gamma)
    immersed = 0.1 * 0.75
    want = 1e6 * np.array([-stress_x, stress_z]) * 0.03 * 0.5 * 0.06 * immersed
    np.testing.assert_allclose(f.sum(axis=0), want, rtol=1e-12)
    # Acts at two thirds of the immersed length: xi = 1/4 + 3/4 * 2/3.
    np.testing.assert_allclose(f[1], 0.75 * want, rtol=1e-12)


def test_stress_grows_with_gravity() -> None:
    for medium in (Rft(GENERIC), SAND):
        s = element(20, 50)
        moon = strip_force(s, medium.record(TRUE_SIGN, 1.62))
        np.testing.assert_allclose(moon, strip_force(s, medium.record(TRUE_SIGN, 9.81)) * 1.62 / 9.81, rtol=1e-12)


def test_anchor_follows_along_the_bristle() -> None:
    record = Rft(GENERIC).record(Elastoplastic(0.01, 1e-3), G)
    near, far = np.array([0.006, -0.007]), np.array([0.06, -0.08])
    np.testing.assert_array_equal(dragged(near, np.zeros(2), record), [0.0, 0.0])
    np.testing.assert_allclose(dragged(far, np.zeros(2), record), 0.9 * far, rtol=1e-12)
