"""Equations of motion against slow, direct ones; energy, order, frequencies."""

from __future__ import annotations

import numpy as np
import pytest
from support_parts import called
from support_pendulum import CROOKED, lagrange, mass_matrix, reduce
from support_runs import GRAVITY_MOMENT, INERTIA, L_RB, LENGTH, LINE_MASS, STIFFNESS, order, scenario_of, scene_of

from granular_contact.engines.modal.arrays import arrays_of
from granular_contact.engines.modal.kernels import pendulum
from granular_contact.engines.modal.kernels.modal import modal_scatter as scatter
from granular_contact.engines.modal.kernels.modal import modal_stations as stations
from granular_contact.engines.modal.kernels.modal_load import load
from granular_contact.engines.modal.kernels.runge_kutta import TSITOURAS
from granular_contact.engines.modal.marching import March
from granular_contact.run import run
from granular_contact.scene import build

RNG = np.random.default_rng(3)


def state(modes: int) -> tuple[np.ndarray, np.ndarray]:
    q, v = 0.02 * RNG.standard_normal(modes + 1), RNG.standard_normal(modes + 1)
    q[0] = 0.7
    v[0] = 5.0
    return q, v


@pytest.mark.parametrize(("text", "modes"), [(CROOKED, 0), (CROOKED, 1), (CROOKED, 4), ("pendulum", 3)])
def test_equations_of_motion_are_those_of_lagrange(text, modes):
    """A crooked root with the link off the pivot's axis brings in every term."""
    reduced = reduce(scene_of(text), modes)
    w = arrays_of(reduced)
    w.pendulum["d"] = 0.0
    q, v = state(modes)
    forces = np.empty(modes + 1)
    called(pendulum.own_forces)(q, v, w.pendulum[0], forces)
    slow = lagrange(reduced, q, v)
    matrix = mass_matrix(reduced, q)
    # Rigid links have the rotary inertia of their section besides, which points on the axis have not.
    section = reduced.link.mass * reduced.link.thickness**2 / 16 if modes == 0 else 0.0
    matrix[0, 0] += section
    # Central differences with a step of 1e-6: 1e-10 of the largest term, which is elastic.
    np.testing.assert_allclose(forces, slow, atol=1e-8 * max(1.0, np.abs(slow).max()))
    acceleration = forces.copy()
    called(pendulum.accelerate)(q, acceleration, w.pendulum[0])
    np.testing.assert_allclose(matrix @ acceleration, forces, atol=1e-12 * max(1.0, np.abs(forces).max()))


def test_inertia_and_gravity_of_the_papers_pendulum():
    record = arrays_of(reduce(scene_of("pendulum_rigid"), 0)).pendulum[0]
    assert record["J"] == pytest.approx(INERTIA, rel=5e-5)  # stated to four digits
    assert record["g"] * record["S_e"] == pytest.approx(GRAVITY_MOMENT, rel=1e-4)


def test_a_flexible_link_without_modes_is_the_rigid_link():
    bent, stiff = (arrays_of(reduce(scene_of(name), 0)).pendulum[0] for name in ("pendulum", "pendulum_rigid"))
    for key in ("J", "S_e", "S_n"):
        assert bent[key] == pytest.approx(stiff[key], rel=1e-12, abs=1e-15)


def test_forces_do_the_work_of_their_stations():
    """Positions, velocities and generalised forces belong together: J by differences of the positions."""
    reduced = reduce(scene_of(CROOKED), 4)
    geometry = arrays_of(reduced).geometry
    q, v = state(4)
    n = len(geometry)
    place, speed, none, forces = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2)), RNG.standard_normal((n, 2))
    called(stations)(q, v, geometry, place, speed)
    columns = []
    for step in 1e-6 * np.eye(5):
        ahead, behind = np.empty((n, 2)), np.empty((n, 2))
        called(stations)(q + step, v, geometry, ahead, none)
        called(stations)(q - step, v, geometry, behind, none)
        columns.append((ahead - behind) / 2e-6)
    jacobian = np.array(columns)
    np.testing.assert_allclose(speed, np.einsum("kpc,k->pc", jacobian, v), atol=1e-9)
    out = np.zeros(5)
    called(scatter)(np.cos(q[0]), np.sin(q[0]), q, geometry, place, forces, out)
    np.testing.assert_allclose(out, np.einsum("kpc,pc->k", jacobian, forces), atol=1e-8)


def test_resultant_moment_is_the_generalised_force_of_the_angle():
    """Q_1 is the moment about the pivot, clockwise; totals hold it counter-clockwise, term by term."""
    reduced = reduce(scene_of(CROOKED, "initial.impact_angle_deg=5"), 3, "elastoplastic")
    w = arrays_of(reduced)
    q, v = state(3)
    totals, out = np.zeros((3, 3)), np.zeros(4)
    called(load)(q, v, np.ones(2), w, totals, out)
    assert abs(out[0]) > 0.1
    assert out[0] == pytest.approx(-totals[:, 2].sum(), rel=1e-12)


def vacuum(modes: int, rtol: float, *overrides: str):
    settings = (f"method={{reduced: {{modes: {modes}, rtol: {rtol}}}}}", "medium=null", "solver.end_time_s=0.1")
    scenario = scenario_of("pendulum", *settings, "solver.rest_time_s=null", *overrides)
    return run(build(scenario), scenario)


def test_energy_in_vacuum_is_kept_to_the_tolerance():
    soft = "model.bodies.link.flexible.bending_stiffness_N_m2=0.5"
    tolerances = [1e-6, 1e-7, 1e-8, 1e-9, 1e-10]
    errors = [vacuum(2, tol, soft).summary["energy"]["imbalance_relative"] for tol in tolerances]
    assert errors[-1] < 1e-8
    # An error of a step proportional to rtol, with as many more steps as rtol^(-1/5): a slope of 0.8 to 1.
    assert order(tolerances, errors) == pytest.approx(0.9, abs=0.2)
    assert vacuum(0, 1e-9).summary["energy"]["imbalance_relative"] < 1e-8


def test_the_stepper_is_of_fifth_order():
    scene = scene_of("pendulum", "medium=null", "solver.end_time_s=0.02", "solver.rest_time_s=null")
    ends, steps = [], [4e-5, 3.2e-5, 2.5e-5, 2e-5, 2e-6]  # finer, round-off; coarser, errors of sixth order
    for step in steps:
        march = March(reduce(scene, 1))
        march.allowed[:] = np.inf
        march.clock["step"], march.control["longest"] = step, step
        while march.go_on() == 0:
            pass
        ends.append(march.y[:4].copy())
    errors = [float(np.abs(end - ends[-1]).max()) for end in ends[:-1]]
    assert order(steps[:-1], errors) == pytest.approx(5, abs=0.2)


def test_internal_damping_takes_what_it_says():
    damped = vacuum(3, 1e-9, "model.bodies.link.flexible.bending_damping_N_m2_s=0.01")
    assert np.all(np.diff(damped["damping_work_J"]) <= 0)
    assert damped["damping_work_J"][-1] < -1e-7
    assert np.abs(damped["energy_imbalance_J"]).max() < 1e-4 * -damped["damping_work_J"][-1]


def frequencies_by_elements(count: int) -> np.ndarray:
    """First free frequencies (Hz) of the pendulum: cubic beam elements on a rigid root that turns about the pivot."""
    h = LENGTH / count
    scale = np.diag([1, h, 1, h])
    k = STIFFNESS / h**3 * scale @ [[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]] @ scale
    m = [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]
    m = LINE_MASS * h / 420 * scale @ m @ scale
    stiffness, mass = np.zeros((2, 2 * count + 2, 2 * count + 2))
    for e in range(count):
        at = slice(2 * e, 2 * e + 4)
        stiffness[at, at] += k
        mass[at, at] += m
    # The first node follows the root's angle: deflection L_RB per rad.
    free = np.zeros((2 * count + 2, 2 * count + 1))
    free[0, 0], free[1, 0], free[2:, 1:] = L_RB, 1.0, np.eye(2 * count)
    stiffness, mass = free.T @ stiffness @ free, free.T @ mass @ free
    root = scene_of("pendulum").rigid[0]
    mass[0, 0] += root.inertia + root.mass * float(root.motion.position @ root.motion.position)
    return np.sort(np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(mass, stiffness)))))[1:] / (2 * np.pi)


def test_frequencies_on_the_hinged_root():
    """The clamped modes have the wrong curvature at a light root, so they converge slowly: checked, not hidden."""
    exact = frequencies_by_elements(40)[:3]
    frequencies = []
    for modes in (1, 2, 4, 8, 16):
        record = arrays_of(reduce(scene_of("pendulum"), modes)).pendulum[0]
        mass = np.diag([record["J"]] + [record["m"]] * modes)
        mass[0, 1:] = mass[1:, 0] = record["c"][:modes]
        stiffness = np.diag([0.0, *record["k"][:modes]])
        roots = np.sort(np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(mass, stiffness)))))[1:]
        frequencies.append(roots / (2 * np.pi))
    first = np.array([f[0] for f in frequencies]) / exact[0] - 1
    assert np.all(np.diff(first) < 0)  # from above, as Ritz says
    assert first[-1] > -1e-6
    assert abs(first[-1]) < 1e-3
    np.testing.assert_allclose(frequencies[-1][:3], exact, rtol=5e-3)


def test_period_of_the_rigid_pendulum():
    """Small swings about the vertical: 2 pi sqrt(J / (m g s)), with amplitude 0.01: 1 + 0.01^2 / 16."""
    settings = ("initial.impact_angle_deg=90", "initial.impact_speed_rad_s=0.1", "solver.end_time_s=3")
    results = vacuum(0, 1e-10, *settings)
    rate, time = results["pivot_rate_rad_s"], results["time_s"]
    k = np.flatnonzero(np.diff(np.sign(rate)) != 0)
    zeros = time[k] + rate[k] * np.diff(time)[k] / (rate[k] - rate[k + 1])
    moment = GRAVITY_MOMENT / INERTIA
    amplitude = 0.1 / np.sqrt(moment)
    assert 2 * np.diff(zeros)[0] == pytest.approx(2 * np.pi / np.sqrt(moment) * (1 + amplitude**2 / 16), rel=2e-4)


def test_runge_kutta_pair_and_interpolant_have_their_orders():
    """Conditions of quadrature, and those of two stages; weights are what the last stage takes of those before."""
    pair = TSITOURAS
    takes, error, dense = np.column_stack([pair.slopes, np.zeros(7)]), pair.error, pair.dense
    places, weights = takes.sum(axis=1), takes[-1]
    for k in range(5):
        assert weights @ places**k == pytest.approx(1.0 / (k + 1), abs=1e-13)
    for k in range(4):
        assert error @ places**k == pytest.approx(0.0, abs=1e-13)
        # A power k of time is integrated to theta^(k + 1) / (k + 1).
        wanted = np.eye(4)[k] / (k + 1)
        np.testing.assert_allclose(places**k @ dense, wanted, atol=1e-12)
    for k in range(1, 4):
        assert weights @ takes @ places**k == pytest.approx(1.0 / ((k + 1) * (k + 2)), abs=1e-13)
    assert abs(error @ places**4) > 1e-5
    np.testing.assert_allclose(dense.sum(axis=1), weights, atol=1e-13)
