"""Equations of trees against their dense form, the matrix of Newton's method, and the order of the steps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import block_diag
from support_models import chain
from support_parts import of_tree
from support_runs import order, scene_of, simulate
from support_slopes import slopes_of_residuals, solved_densely

from granular_contact.engines.tree.kernels import tree, tree_load, tree_march
from granular_contact.engines.tree.kernels.tree_arrays import NODE, addresses, room
from granular_contact.engines.tree.march import March
from granular_contact.engines.tree.tree import tree as make_tree
from granular_contact.mechanics.kernels.step_choice import LONGER, SHORTER

CHAIN_IN_SAND = chain(
    3,
    0.09,
    "medium: play_sand",
    "initial: {impact_angle_deg: 31, impact_speed_rad_s: 6}",
    "method: minimal",
    "solver: {end_time_s: 0.1, accuracy: 1.0e-4, rest_time_s: null}",
    diameter=0.0064,
)


def random_tree(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes on hinges and sliders with random parents before them, and their coordinates and rates."""
    nodes = np.zeros(count, NODE)
    for i, node in enumerate(nodes):
        node["parent"], node["kind"] = rng.integers(-1, i), rng.integers(2)
        node["on_parent"], node["point"] = rng.uniform(-0.1, 0.1, (2, 2))
        node["turn"], direction = rng.uniform(-3, 3, 2)
        node["axis"] = np.cos(direction), np.sin(direction)
    nodes["mass"], nodes["inertia"] = rng.uniform(0.01, 0.2, (2, count)) * [[1.0], [1e-3]]
    reach = np.where(nodes["kind"] == tree.SLIDER, 0.1, 1.0)
    return nodes, reach * rng.uniform(-3, 3, count), reach * rng.uniform(-8, 8, count)


def centres(nodes: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Coordinates (3 n,) x, y and angle of the nodes, worked out one by one."""
    out = np.zeros((len(nodes), 3))
    for i, node in enumerate(nodes):
        x, y, angle = out[node["parent"]] if node["parent"] >= 0 else (0.0, 0.0, 0.0)
        slides = node["kind"] == tree.SLIDER
        at = np.array([x, y]) + turn(angle) @ (node["on_parent"] + (s[i] * node["axis"] if slides else 0.0))
        angle += node["turn"] - (0.0 if slides else s[i])
        out[i, :2], out[i, 2] = at - turn(angle) @ node["point"], angle
    return out.ravel()


def turn(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def jacobian(nodes: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Of `centres`, by complex-free central differences of fourth order: (h^4 / 30 + 1e-16 / h) x 0.3 m = 1e-13."""
    h, columns = 1e-3, []
    for e in np.eye(len(s)):
        f = {k: centres(nodes, s + k * h * e) for k in (-2, -1, 1, 2)}
        columns.append((8.0 * (f[1] - f[-1]) - (f[2] - f[-2])) / (12.0 * h))
    return np.array(columns).T


def dense_masses(nodes: np.ndarray) -> np.ndarray:
    return np.diag(np.stack([nodes["mass"], nodes["mass"], nodes["inertia"]], axis=1).ravel())


@pytest.mark.parametrize("count", [1, 2, 7, 20])
def test_joint_residuals_are_those_of_the_dense_equations(count: int) -> None:
    """R = J^T M (J s'' + J' s') - J^T f - tau, with J' along the motion."""
    rng = np.random.default_rng(count)
    for _ in range(5):
        nodes, s, rates = random_tree(rng, count)
        w, h = room(count) | {"nodes": nodes}, 1e-4
        w["s"][:], w["rates"][:], w["s2"][:] = s, rates, rng.uniform(-50, 50, count)
        w["force"][:] = rng.uniform(-2, 2, (count, 3)) * [1.0, 1.0, 0.1]
        w["effort"][:] = rng.uniform(-0.1, 0.1, count)
        for step in (tree.place, tree.node_accelerations, tree.residuals):
            of_tree(step)(addresses(w))
        J = jacobian(nodes, s)
        np.testing.assert_allclose(w["pose"].ravel(), centres(nodes, s), atol=1e-13)
        np.testing.assert_allclose(w["twist"].ravel(), J @ rates, atol=1e-9)
        turned = (jacobian(nodes, s + h * rates) - jacobian(nodes, s - h * rates)) / (2 * h)
        moved, M = J @ w["s2"] + turned @ rates, dense_masses(nodes)
        asked = J.T @ (M @ moved - w["force"].ravel())
        # Differences of J': (8 h)^2 / 6 = 1e-7 of a moment of m l^2 omega^2, about 1 N m.
        allowed = 1e-6 * np.abs(J.T @ M @ turned @ rates).max() + 1e-8
        np.testing.assert_allclose(w["residual"], asked - w["effort"], atol=allowed)
        np.testing.assert_allclose(w["acceleration"].ravel(), moved, atol=1e-6 * np.abs(moved).max())


@pytest.mark.parametrize("count", [1, 2, 7, 20])
def test_folded_matrix_is_the_dense_one(count: int) -> None:
    """(J^T B J + diag c) change = -R, for any B of the nodes, without symmetry; nothing of what is prescribed."""
    rng = np.random.default_rng(10 + count)
    for _ in range(5):
        nodes, s, rates = random_tree(rng, count)
        w = room(count) | {"nodes": nodes, "prescribed": rng.integers(2, size=count)}
        w["s"][:], w["rates"][:] = s, rates
        for step in (tree.place, tree.inertias):
            of_tree(step)(addresses(w))
        masses = w["body"].reshape(-1, 3, 3).copy()
        body = masses + rng.uniform(-0.2, 0.2, masses.shape) * np.sqrt(masses @ np.ones((3, 3)) @ masses)
        w["body"][:], w["stiffness"][:] = body.reshape(-1, 9), rng.uniform(0.0, 1e-3, count)
        w["residual"][:] = rng.uniform(-1, 1, count)
        for step in (tree.eliminate, tree.solve):
            of_tree(step)(addresses(w))
        J = jacobian(nodes, s)
        change, scale = solved_densely(J.T @ block_diag(*body) @ J + np.diag(w["stiffness"]), w)
        np.testing.assert_allclose(w["change"], change, atol=1e-11 * scale + 1e-15)
        np.testing.assert_allclose(w["node_change"].ravel(), J @ change, atol=1e-11 * scale + 1e-15)


def test_newton_matrix_is_the_derivative_of_joint_residuals() -> None:
    """Of three links that bristles hold: by differences of R, with s, s' and s'' moved as a step of 0.1 ms does it."""
    march = March(make_tree(scene_of(CHAIN_IN_SAND)))
    march.plan(0.1)
    while march.time < 0.1:
        march.proceed()
    w, h = march.arrays, 1e-4
    fq, fv = 0.25 * h * h, 0.5 * h
    of_tree(tree_load.forces_on_nodes)(march._addresses)
    of_tree(tree_load.tangent)(fq, fv, march._addresses)
    c, J = w["stiffness"].copy(), jacobian(w["nodes"], w["s"])
    B = block_diag(*w["body"].reshape(-1, 3, 3))
    by = 1e-3  # rad/s2: 5e-8 rad/s, so that points move by a tenth of what a bristle yields at, or less
    slopes = slopes_of_residuals(
        march, (tree_load.forces_on_nodes, tree.node_accelerations, tree.residuals), fq, fv, by
    )
    matrix, sand = J.T @ B @ J + np.diag(c), J.T @ (B - dense_masses(w["nodes"])) @ J
    assert np.abs(sand).max() > 0.1 * np.abs(matrix).max()  # the sand counts
    # What turns with the change is left out: next to nothing at rest. Slopes of the sand are chords, some of them
    # beyond where a bristle yields, so that they are less steep or more.
    np.testing.assert_allclose(slopes, matrix, atol=0.1 * np.abs(sand).max())


def test_newton_tolerance_follows_the_greatest_speed() -> None:
    """A share of the greatest speed so far, down to a thousandth of the 1 mm/s of rest, where steps are long."""
    march = March(make_tree(scene_of(CHAIN_IN_SAND)))
    clock, share = march.arrays["clock"], march.arrays["control"]["share"][0]
    for speed, least in ((3.0, 0.0), (1e-5, 0.0), (1e-8, 1e-6)):
        clock["greatest"] = speed
        assert of_tree(tree_march.newton_tolerance)(1e6, march._addresses) == pytest.approx(
            share * max(speed, least), rel=1e-12
        )


def test_iterations_are_led_by_those_before() -> None:
    """In long steps of a chain that bristles hold, which plain iterations can't solve with a matrix now and then."""
    cost = simulate(CHAIN_IN_SAND, "solver.accuracy=null", "solver.step_s=1e-3").summary["cost"]
    assert cost["steps"] <= cost["newton_iterations"] < 6.0 * cost["steps"]
    assert cost["jacobians"] < 0.2 * cost["steps"]
    assert cost["shortened_steps"] == 0


def test_newton_matrix_is_renewed_after_a_large_change_of_step() -> None:
    run = simulate(CHAIN_IN_SAND, "solver.accuracy=1e-3")
    steps = np.diff(run["time_s"])
    ratios = steps[1:] / steps[:-1]
    changed = np.count_nonzero((ratios < 0.99 * SHORTER) | (ratios > 1.01 * LONGER))
    assert run.summary["cost"]["jacobians"] >= changed > 10


@pytest.mark.parametrize("radius", [1.0, 0.9, 0.5, 0.0])
def test_steps_are_of_order_two(radius: float) -> None:
    """A rigid pendulum in vacuum, to 0.1 s; whatever the spectral radius."""
    overrides = "method=minimal", "medium=null", "solver.end_time_s=0.1", f"solver.spectral_radius={radius}"

    def end(step: float) -> float:
        more = f"solver.step_s={step}", "solver.accuracy=null", "solver.tolerance=1e-12"
        return float(simulate("pendulum_rigid", *overrides, *more)["pivot_angle_deg"][-1])

    steps = [1e-2, 5e-3, 2.5e-3, 1.25e-3]
    exact = end(1e-5)
    assert order(steps, [abs(end(step) - exact) for step in steps]) == pytest.approx(2.0, abs=0.1)
