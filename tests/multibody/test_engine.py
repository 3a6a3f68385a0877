"""The engine without sand: pendulums and beams against their equations and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support_runs import DENSITY, LENGTH, LINE_MASS, STIFFNESS, order, scene_of, simulate

from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.solve import settings
from granular_contact.mechanics.mass_and_gravity import gravity_loads, mass_matrix

VACUUM = ("medium=null", "solver.rest_time_s=null", "solver.tolerance=1e-9")
ROOTS = np.array([1.87510406871, 4.69409113297])  # of cos a cosh a = -1
FREQUENCIES = ROOTS**2 * np.sqrt(STIFFNESS / (LINE_MASS * LENGTH**4)) / (2 * np.pi)
STATIC = LINE_MASS * 9.81 * LENGTH**4 / (8 * STIFFNESS)

DOUBLE = """
model:
  name: double
  bodies:
    upper: {type: link, length_m: 0.3, diameter_m: 0.01, density_kg_m3: 7700}
    lower: {type: link, length_m: 0.2, diameter_m: 0.01, density_kg_m3: 7700}
  joints:
    shoulder: {type: hinge, parent: ground, child: upper}
    elbow: {type: hinge, parent: upper, child: lower, parent_point_m: [0.3, 0]}
initial: {impact_angle_deg: -40, impact_speed_rad_s: 3}
"""

CANTILEVER = """
model:
  name: cantilever
  bodies:
    link:
      type: link
      length_m: 0.23876
      diameter_m: 0.00635
      density_kg_m3: 7700
      flexible: {bending_stiffness_N_m2: 15.1642, elements: 8}
  joints:
    clamp: {type: weld, parent: ground, child: link}
initial: {impact_angle_deg: 0}
solver: {end_time_s: 0.2, spectral_radius: 1}
"""


def test_rigid_pendulum_in_vacuum_matches_its_equation_with_order_two() -> None:
    steps, start, speed = [8e-3, 4e-3, 2e-3, 1e-3], np.radians(31.0), 6.24
    body = scene_of("pendulum_rigid").rigid[0]
    arm = np.hypot(*body.motion.position)
    inertia, moment = body.inertia + body.mass * arm**2, body.mass * 9.81 * arm
    times = np.linspace(0.0, 0.4, 51)
    exact = solve_ivp(
        lambda _, y: [y[1], moment * np.cos(y[0]) / inertia],
        (0, 0.4),
        [start, speed],
        "DOP853",
        times,
        rtol=1e-10,
        atol=1e-12,
    ).y
    errors = []
    for step in steps:
        run = simulate("pendulum_rigid", *VACUUM, "solver.end_time_s=0.4", f"solver.step_s={step}")
        angle = np.radians(np.interp(times, run["time_s"], run["pivot_angle_deg"]))
        rate = np.interp(times, run["time_s"], run["pivot_rate_rad_s"])
        # Both are the rate of one rigid body, but the joint holds its velocities only to the second order of the step:
        # (10 rad/s x h)^2 / 2 of 10 rad/s.
        np.testing.assert_allclose(run["mean_rate_rad_s"], run["pivot_rate_rad_s"], atol=500 * step**2)
        errors.append(max(np.abs(angle - exact[0]).max(), np.abs(rate - exact[1]).max() / 10))
    # Generalised alpha is of second order. Period about 0.8 s: (2 pi h / T)^2 / 12 = 5e-6 of 3 rad at 1e-3 s.
    assert order(steps, errors) == pytest.approx(2.0, abs=0.2)
    assert errors[-1] < 3e-5


def test_double_pendulum_keeps_its_energy() -> None:
    drift, moved = [], []
    steps = [2e-3, 1e-3, 5e-4]
    for step in steps:
        run = simulate(DOUBLE, *VACUUM, "solver.end_time_s=1", f"solver.step_s={step}", "solver.spectral_radius=1")
        drift.append(np.abs(run["energy_imbalance_J"]).max())
        moved.append(np.ptp(run["kinetic_J"]))
        assert np.ptp(run["elbow_angle_deg"]) > 60.0  # the elbow does bend
    # Of second order: rates of 16 rad/s give (16 x 5e-4)^2 = 6e-5 a swing, some five of them.
    assert drift[-1] < 3.2e-4 * moved[-1]
    assert order(steps, drift) == pytest.approx(2.0, abs=0.1)


def test_double_pendulum_pulls_no_hinge_apart() -> None:
    run = simulate(DOUBLE, *VACUUM, "solver.end_time_s=1", "solver.step_s=5e-4", "solver.spectral_radius=1")
    q1 = np.radians(run["shoulder_angle_deg"])
    q2 = q1 + np.radians(run["elbow_angle_deg"])
    # Constraints are met on the level of positions, to the tolerance of Newton's method.
    np.testing.assert_allclose(run["tip_x_m"], 0.3 * np.cos(q1) + 0.2 * np.cos(q2), atol=1e-8)
    np.testing.assert_allclose(run["tip_y_m"], -0.3 * np.sin(q1) - 0.2 * np.sin(q2), atol=1e-8)


def test_double_pendulum_matches_its_equations() -> None:
    run = simulate(DOUBLE, *VACUUM, "solver.end_time_s=1", "solver.step_s=5e-4", "solver.spectral_radius=1")
    mass = DENSITY * np.pi / 4 * 0.01**2 * np.array([0.3, 0.2])
    center = mass * (np.array([0.3, 0.2]) ** 2 / 12 + 0.01**2 / 16)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        """Angles a, b below the horizontal of both links: Lagrange's equations."""
        (a, b), w = y[:2], y[2:]
        m = mass[1] * 0.3 * 0.1 * np.cos(b - a)
        matrix = np.array([[center[0] + mass[0] * 0.15**2 + mass[1] * 0.3**2, m], [m, center[1] + mass[1] * 0.1**2]])
        s = mass[1] * 0.3 * 0.1 * np.sin(b - a)
        weight = 9.81 * np.array([(mass[0] * 0.15 + mass[1] * 0.3) * np.cos(a), mass[1] * 0.1 * np.cos(b)])
        return np.concatenate([w, np.linalg.solve(matrix, weight + s * np.array([w[1] ** 2, -(w[0] ** 2)]))])

    start = [np.radians(-40.0)] * 2 + [3.0] * 2
    exact = solve_ivp(rates, (0, 1), start, "DOP853", run["time_s"], rtol=1e-10, atol=1e-12).y
    # Second order, (16 x 5e-4)^2 = 6e-5 of several radians, times the divergence of neighbouring paths: some 10 in 1 s.
    np.testing.assert_allclose(np.radians(run["shoulder_angle_deg"]), exact[0], atol=2e-3)
    np.testing.assert_allclose(np.radians(run["elbow_angle_deg"]), exact[1] - exact[0], atol=2e-3)


def let_go() -> tuple[np.ndarray, np.ndarray]:
    """Time and tip deflection of the level link, clamped and let go: it swings about its static deflection."""
    run = simulate(CANTILEVER, *VACUUM, "solver.step_s=2e-5")
    return run["time_s"], run["deflection_m"]


@pytest.mark.slow
def test_first_frequency_of_the_clamped_link() -> None:
    time, deflection = let_go()
    swing = deflection - STATIC
    k = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
    zeros = time[k] - swing[k] * (time[k + 1] - time[k]) / (swing[k + 1] - swing[k])
    frequency = (len(zeros) - 1) / (zeros[-1] - zeros[0])
    assert FREQUENCIES[0] == pytest.approx(77.4, abs=0.05)  # 1.875104^2 sqrt(E I / m) / (2 pi L^2) by hand
    # The second mode, 1.4 % of the first here and six times as fast, shifts the first and last of 16 zeros by up to
    # 0.014 / (2 pi) of a period each: 3e-4; the step lengthens the period by (2 pi 77 x 2e-5)^2 / 12 = 8e-6.
    assert frequency == pytest.approx(FREQUENCIES[0], rel=3e-4)


@pytest.mark.slow
def test_second_frequency_of_the_clamped_link() -> None:
    time, deflection = let_go()
    points = 2**18
    spectrum = np.abs(np.fft.rfft((deflection - STATIC) * np.hanning(len(time)), points))
    lines = np.fft.rfftfreq(points, time[1] - time[0])
    band = (lines > 300.0) & (lines < 800.0)
    # Half a line of the padded spectrum is 0.1 Hz; the step costs (2 pi 485 x 2e-5)^2 / 12 = 3e-4 = 0.15 Hz.
    assert lines[band][np.argmax(spectrum[band])] == pytest.approx(FREQUENCIES[1], abs=0.5)


def test_static_deflection_of_the_clamped_link() -> None:
    run = simulate(
        CANTILEVER, *VACUUM, "model.bodies.link.flexible.bending_damping_N_m2_s=0.0624", "solver.step_s=1e-4"
    )
    # Critically damped: gone like exp(-2 pi 77 x 0.2) in 0.2 s. Geometry: (STATIC / LENGTH)^2 = 7e-8; axial: none.
    assert run["deflection_m"][-1] == pytest.approx(STATIC, rel=1e-6)


def test_free_vibration_keeps_its_energy() -> None:
    run = simulate(CANTILEVER, *VACUUM, "solver.step_s=2e-5")
    exchanged = np.abs(run["gravity_J"]).max()
    # The trapezoidal rule conserves the quadratic energy of a linear beam; this one is linear to (STATIC / LENGTH)^2 =
    # 7e-8.
    assert np.abs(run["energy_imbalance_J"]).max() < 1e-6 * exchanged
    # Potential of gravity given up at the turning point, w = 2 STATIC: 0.4 of the tip deflection is the mean.
    assert exchanged == pytest.approx(9.81 * LINE_MASS * LENGTH * 0.4 * 2 * STATIC, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["bending_damping_N_m2_s=0.002", "axial_damping_N_s=500"])
def test_internal_damping_closes_the_balance(kind: str) -> None:
    """Bending is struck by letting go a level link, stretching by letting go one that hangs down."""
    bending = kind.startswith("bending")
    steps, errors, done = [4e-5, 2e-5, 1e-5] if bending else [8e-6, 4e-6, 2e-6], [], []
    for step in steps:
        run = simulate(
            CANTILEVER,
            *VACUUM,
            f"model.bodies.link.flexible.{kind}",
            f"solver.step_s={step}",
            f"solver.end_time_s={0.03 if bending else 0.003}",
            f"initial.impact_angle_deg={0 if bending else 90}",
        )
        done.append(run.summary["energy"]["damping_work_J"])
        errors.append(np.abs(run["energy_imbalance_J"]).max())
    assert done[-1] < 0.0
    # The damping power is summed by trapezoids: second order. The axial one grows within one step of 2e-6 s after the
    # start, out of some ten that matter: (1 / 10)^2 / 12 of the work.
    assert errors[-1] < (1e-4 if bending else 2e-3) * abs(done[-1])
    assert order(steps, errors) == pytest.approx(2.0, abs=0.1)


# ---- mass and weight, which we lay over the engine's bodies ourselves ----


@pytest.mark.parametrize("elements", [3, 32])
def test_mass_and_weight_are_the_engine_s(elements: int) -> None:
    """The engine's own mass matrix and its own mass-proportional loads, of a rigid body and a link; full, sparse."""
    system = build(scene_of("pendulum", "medium=null", f"model.bodies.link.flexible.elements={elements}"))
    mbs, mass = system.mbs, mass_matrix(system)
    engine = mbs.ComputeLinearizedSystem(settings(system.scene))[0]
    # Polynomials of degree 6, which the engine's rule integrates exactly: round-off.
    whole = mass.toarray() if hasattr(mass, "toarray") else mass
    np.testing.assert_allclose(whole, engine, rtol=1e-12, atol=1e-13 * engine.max())
    up = np.zeros(len(engine))
    wanted = np.zeros(len(engine))
    for node, part in gravity_loads(system).items():
        wanted[mbs.systemData.GetNodeLTGODE2(node)] = part
    for node in (h.node for h in system.rigid.values()):
        up[mbs.systemData.GetNodeLTGODE2(node)[1]] = 1.0
    for node in (n for h in system.links.values() for n in h.nodes):
        up[mbs.systemData.GetNodeLTGODE2(node)[1]] = 1.0
    # A uniform field does the same on every piece of mass: M times the rates of rising as one.
    np.testing.assert_allclose(wanted, -9.81 * engine @ up, rtol=1e-12, atol=1e-12 * np.abs(wanted).max())


def test_a_coarse_tolerance_is_not_made_coarser() -> None:
    """A thousand times the default leaves an imbalance that is still below what is warned of."""
    default, coarse = simulate("pendulum"), simulate("pendulum", "solver.tolerance=1e-2")
    assert coarse.summary["energy"]["imbalance_relative"] < 1e-3
    assert coarse.summary["stopping_time_s"] == pytest.approx(default.summary["stopping_time_s"], rel=1e-4)
