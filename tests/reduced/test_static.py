"""Static resistance: true sign with stops and turns, against the table, the bristle and other integrators."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support_parts import called
from support_pendulum import reduce
from support_runs import scene_of

from granular_contact.engines.modal.kernels.modal_motion import decide, margins, rates
from granular_contact.engines.modal.kernels.slip import slip_bias, slip_rows, slip_velocity
from granular_contact.engines.modal.marching import March
from granular_contact.engines.modal.solve import Trajectory, solve

# Impact angle (deg) and speed (rad/s), stopping time (s) and angle at stop (deg): see the table in tests/test_run.py.
TABLE = [
    (22, 1.75, 0.0352, 24.668),
    (22, 3.38, 0.0275, 25.049),
    (22, 4.66, 0.0243, 25.301),
    (31, 3.31, 0.0325, 34.623),
    (31, 6.24, 0.0255, 35.235),
    (31, 8.41, 0.0228, 35.566),
    (45, 2.66, 0.0459, 49.479),
    (45, 6.47, 0.0327, 50.512),
    (45, 9.06, 0.0290, 50.989),
    (61.5, 2.70, 0.0703, 68.017),
    (61.5, 6.54, 0.0513, 69.492),
    (61.5, 9.17, 0.0459, 70.171),
]


def strike(
    angle: float, speed: float, modes: int, static: str = "true_sign", rtol: float = 1e-7, *more: str
) -> Trajectory:
    settings = (f"initial.impact_angle_deg={angle}", f"initial.impact_speed_rad_s={speed}")
    return solve(reduce(scene_of("pendulum", *settings, *more), modes, static, rtol))


@pytest.mark.parametrize(("angle", "speed", "time", "at_stop"), TABLE)
def test_rigid_pendulum_of_the_table(angle, speed, time, at_stop):
    run, fine = strike(angle, speed, 0), strike(angle, speed, 0, rtol=1e-11)
    # The table is rounded to 0.1 ms and 0.001 deg.
    assert run.stop[0] == pytest.approx(time, abs=0.5e-4 + 1e-3 * time)
    assert np.degrees(run.stop[1]) == pytest.approx(at_stop, abs=0.002)
    assert run.stop[0] == pytest.approx(fine.stop[0], rel=1e-5)
    assert run.status.code == "rest"
    assert run.turns == 1  # it stops once, and the bound holds the weight


@pytest.mark.slow
@pytest.mark.parametrize("modes", [0, 1])
@pytest.mark.parametrize(("angle", "speed"), [case[:2] for case in TABLE])
def test_true_sign_and_bristle_stop_alike(angle, speed, modes):
    true, bristle = (strike(angle, speed, modes, static) for static in ("true_sign", "elastoplastic"))
    assert true.stop[0] == pytest.approx(bristle.stop[0], rel=5e-3 if modes else 1e-4)
    assert np.degrees(true.stop[1]) == pytest.approx(np.degrees(bristle.stop[1]), abs=1e-4)


def test_a_rigid_pendulum_at_rest_stays():
    run = strike(31, 6.24, 0)
    after = run.time > run.stop[0]
    assert np.ptp(run.q[after, 0]) < 1e-14
    # The medium carries the weight: its moment about the pivot, counter-clockwise, against gravity's.
    weight = 0.08593 * np.cos(run.stop[1])
    assert run.terms[-1, :, 2].sum() == pytest.approx(weight, rel=2e-4)
    # And there is no drag: that of a speed of round-off, 1e-16 m/s at most, squared.
    assert np.abs(run.terms[-1, 0]).max() < 1e-28


def test_the_medium_takes_energy_all_the_way():
    for modes, static in ((0, "true_sign"), (1, "elastoplastic")):
        run = strike(31, 6.24, modes, static)
        stop = np.searchsorted(run.time, run.stop[0])
        assert np.all(np.diff(run.work[:stop]) < 0)
        assert run.work[-1] < -0.02


@pytest.mark.slow
@pytest.mark.parametrize("integrator", ["DOP853", "Radau"])
def test_scipy_integrates_the_same_motion_before_the_stop(integrator):
    end = 0.01  # s: no part of the link turns round before
    march = March(reduce(scene_of("pendulum", f"solver.end_time_s={end}"), 1, "true_sign", 1e-9))
    start, regime, slopes = march.y.copy(), march.regime.copy(), np.empty_like(march.y)

    def slope(_, y):
        called(rates)(np.ascontiguousarray(y), regime, march.arrays, np.zeros_like(regime), np.zeros((3, 3)), slopes)
        return slopes.copy()

    exact = solve_ivp(slope, (0.0, end), start, integrator, rtol=1e-10, atol=1e-13, max_step=1e-4).y[:, -1]
    while march.go_on() == 0:
        pass
    np.testing.assert_array_equal(march.regime, regime)
    assert abs(march.y[2] - start[2]) > 0.1  # rad/s: the sand brakes it
    # Reach 0.3 m and speed 2 m/s scale the tolerance; errors of 50 steps add up to 1e-7 at the most.
    np.testing.assert_allclose(march.y[:4], exact[:4], rtol=1e-7, atol=1e-8)


# ---- one decision at a time ----


def immersed(modes: int, *more: str) -> March:
    march = March(reduce(scene_of("pendulum", *more), modes))
    march.y[0] += np.radians(3)
    return march


def test_rows_and_bias_are_derivatives_of_the_slip_velocity():
    march = immersed(3)
    rng = np.random.default_rng(5)
    q, v, a = march.y[:4].copy(), rng.standard_normal(4), rng.standard_normal(4)
    q[1:] = 1e-3 * rng.standard_normal(3)
    rows, bias = np.zeros((2, 4)), np.zeros(2)
    called(slip_rows)(q, march.arrays, rows)
    called(slip_bias)(q, v, march.arrays, bias)
    speed = np.zeros(2)
    called(slip_velocity)(q, v, march.arrays, speed)
    np.testing.assert_allclose(rows @ v, speed, atol=1e-14)
    # d/dt along q + t v, v + t a; differences of 1e-5 s leave 1e-9.
    ends = np.zeros((2, 2))
    for end, t in zip(ends, (-1e-5, 1e-5), strict=True):
        called(slip_velocity)(q + t * v, v + t * a, march.arrays, end)
    np.testing.assert_allclose(rows @ a + bias, (ends[1] - ends[0]) / 2e-5, atol=1e-7)


@pytest.mark.parametrize("stuck", [[0], [1], [0, 1]])
def test_components_that_stick_have_no_acceleration(stuck):
    """In sand so stiff that its bound holds them: both as well, as a bent link moves its middle in two directions."""
    strong = "{eta_v: 1.0e5, lambda: 1.1}"
    march = immersed(2, "medium.eta_h=1e5", f"medium.plunging={strong}", f"medium.withdrawing={strong}")
    march.y[0] += np.radians(17)
    march.y[1:6] = 5e-3, -2.5e-3, 1.0, -0.05, 0.01
    s = np.full(2, -1e-5)
    s[stuck] = 0.0
    dy, sigma, totals = np.empty(8), np.zeros(2), np.zeros((3, 3))
    called(rates)(march.y, s, march.arrays, sigma, totals, dy)
    rows, bias = np.zeros((2, 3)), np.zeros(2)
    called(slip_rows)(march.y[:3], march.arrays, rows)
    called(slip_bias)(march.y[:3], march.y[3:6], march.arrays, bias)
    assert (np.abs(sigma) < 1.0).all()
    # Without friction the middle would accelerate by 4e3 m/s2; the bias is a difference over 1e-6 s, of 1e-10.
    assert np.abs((rows @ dy[3:6] + bias)[stuck]).max() < 1e-8


@pytest.mark.parametrize(("eta_v", "sticks"), [(22, True), (0.2, False)])
def test_a_stopped_pendulum_sticks_where_the_bound_holds_its_weight(eta_v, sticks):
    """Three degrees deep the plunging bound is far above, or with eta_v = 0.2 and eta_h = 0 far below, the weight."""
    march = immersed(0, f"medium.plunging.eta_v={eta_v}", *([] if sticks else ["medium.eta_h=0"]))
    march.y[1] = 0.0
    decide(march.y, march.regime, np.array([True]), march.arrays)
    assert march.regime[0] == (0 if sticks else 1)
    margin = np.empty(1)
    called(margins)(march.y, march.regime, march.arrays, margin)
    assert margin[0] > 0


def test_withdrawing_has_its_own_bound():
    """Gravity upside down pulls out: a strong withdrawing bound holds it, a weak one does not. Else it is not asked."""
    for gravity, eta, regime in ((-9.81, 50.0, 0.0), (-9.81, 0.01, -1.0), (9.81, 0.01, 0.0)):
        withdrawing = f"medium.withdrawing={{eta_v: {eta}, lambda: 1.1}}"
        march = immersed(0, f"gravity_m_s2={gravity}", "medium.eta_h=0", withdrawing)
        march.y[1] = 0.0
        decide(march.y, march.regime, np.array([True]), march.arrays)
        assert march.regime[0] == regime
        if regime == 0:
            # The multiplier belongs to the bound on its own side: nothing moves.
            dy, sigma = np.empty(4), np.zeros(1)
            called(rates)(march.y, march.regime, march.arrays, sigma, np.zeros((3, 3)), dy)
            assert 1e-3 < np.sign(gravity) * sigma[0] < 1
            assert abs(dy[1]) < 1e-10 * 57  # rad/s2, of what gravity alone would give
        else:
            # Were it held, its bound would be passed.
            margin = np.empty(1)
            called(margins)(march.y, np.zeros(1), march.arrays, margin)
            assert margin[0] < 0


def test_sticking_stations_lose_their_remaining_speed():
    march = immersed(2)
    march.y[3:6] = 0.3, -0.5, 0.2
    for _ in range(40):  # bring the middle near rest, with the link still vibrating
        speed, rows = np.zeros(2), np.zeros((2, 3))
        called(slip_velocity)(march.y[:3], march.y[3:6], march.arrays, speed)
        called(slip_rows)(march.y[:3], march.arrays, rows)
        march.y[3:6] -= np.linalg.pinv(rows) @ (speed - 1e-9)
    decide(march.y, march.regime, np.array([True, True]), march.arrays)
    stuck = march.regime == 0
    assert np.any(stuck)
    called(slip_velocity)(march.y[:3], march.y[3:6], march.arrays, speed)
    assert np.abs(speed[stuck]).max() < 1e-15


def test_a_bristle_holds_what_it_stopped():
    run = strike(31, 6.24, 0, "elastoplastic")
    after = run.time > run.stop[0]
    # It springs back by its yield displacement, 1e-5 m at 0.26 m: 2e-3 deg, and stands still then.
    assert np.degrees(np.ptp(run.q[after, 0])) < 4e-3
    assert run.terms[-1, :, 2].sum() == pytest.approx(0.08593 * np.cos(run.stop[1]), rel=1e-2)


def test_one_component_stops_and_the_other_goes_on():
    """With a mode the two components pass zero at different instants, and both are seen."""
    run = strike(45, 2.66, 1)
    assert run.turns >= 3
    held = run.time > run.stop[0] + 0.005
    # The middle of the immersed part is held; the vibration about it goes on, without loss.
    assert np.ptp(run.v[held, 1]) > 1e-3
    assert run.status.code == "rest"
    assert "vibrates" in run.status.message
