"""Accelerations of trees against their equations in dense form, and the integrator against what it must do."""

from __future__ import annotations

import numpy as np
import pytest
from support_runs import order, scene_of

from granular_contact.kernels import chebyshev, tree, tree_load
from granular_contact.kernels.lines import FIRST
from granular_contact.kernels.tree_load import TreeArrays
from granular_contact.minimal.tree import tree as make_tree
from granular_contact.scene.types import Scene


def random_tree(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes on hinges and sliders with random parents before them, and their coordinates and rates."""
    nodes = np.zeros(count, tree.NODE)
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


@pytest.mark.parametrize("count", [1, 2, 7, 20])
def test_accelerations_solve_the_dense_equations(count: int) -> None:
    """J^T M J s'' = J^T (f - M J' s') + tau, with J' along the motion; whichever of s'' and tau is given."""
    rng = np.random.default_rng(count)
    for _ in range(5):
        nodes, s, rates = random_tree(rng, count)
        nodes["prescribed"] = rng.integers(2, size=count)
        room, s2, h = tree.motion(count), rng.uniform(-50, 50, count), 1e-4
        tree.place(s, rates, nodes, room)
        room.force[:] = rng.uniform(-2, 2, (count, 3)) * [1.0, 1.0, 0.1]
        room.effort[:] = rng.uniform(-0.1, 0.1, count)
        given = np.where(nodes["prescribed"], s2, room.effort)
        J = jacobian(nodes, s)
        np.testing.assert_allclose(room.pose.ravel(), centres(nodes, s), atol=1e-13)
        np.testing.assert_allclose(room.twist.ravel(), J @ rates, atol=1e-9)
        turned = (jacobian(nodes, s + h * rates) - jacobian(nodes, s - h * rates)) / (2 * h)
        M = np.diag(np.stack([nodes["mass"], nodes["mass"], nodes["inertia"]], axis=1).ravel())
        f = room.force.ravel().copy()
        tree.accelerate(nodes, room, s2)
        assert np.array_equal(np.where(nodes["prescribed"], s2, room.effort), given)
        rest = J.T @ M @ J @ s2 - J.T @ (f - M @ turned @ rates) - room.effort
        # Differences of J': (8 h)^2 / 6 = 1e-7 of a moment of m l^2 omega^2, about 1 N m.
        assert np.abs(rest).max() < 1e-6 * np.abs(J.T @ M @ turned @ rates).max() + 1e-8
        moved = J @ s2 + turned @ rates
        np.testing.assert_allclose(room.acceleration.ravel(), moved, atol=1e-6 * np.abs(moved).max())


def pendulum(**options: object) -> Scene:
    return scene_of("pendulum_rigid", "method=minimal", *(f"{k}={v}" for k, v in options.items()))


def arrays_of(**options: object) -> tuple[TreeArrays, np.ndarray]:
    made = make_tree(pendulum(**options))
    return made.arrays, made.start


@pytest.mark.parametrize("stages", [2, 5, 12])
def test_steps_are_of_order_two(stages: int) -> None:
    """A rigid pendulum in vacuum, to 0.1 s; however many stages."""
    w, start = arrays_of(medium="null")
    slope, room = np.empty_like(start), [np.empty_like(start) for _ in range(3)]

    def end(steps: int) -> np.ndarray:
        y = start.copy()
        for _ in range(steps):
            chebyshev.rates(0.0, y, w, slope)
            chebyshev.step(0.0, y, 0.1 / steps, stages, w, slope, *room)
            y[:] = room[2]
        return y[:2]

    counts = [20, 40, 80, 160]
    errors = [float(np.abs(end(n) - end(2560)).max()) for n in counts]
    assert order([1.0 / n for n in counts], errors) == pytest.approx(2.0, abs=0.1)


def test_stages_follow_from_stiffness() -> None:
    """s stages are stable to 0.65 s^2: what is asked for covers the spectral radius, with hardly one too many."""
    for load in (1.0, 10.0, 300.0, 1e4):
        s = chebyshev.stages_for(1.0, load)
        assert 2.0 / 3.0 * (s * s - 1.0) * (1.0 - 2.0 / 15.0 * 2.0 / 13.0) >= load
        assert s == 2 or 0.65 * (s - 2) ** 2 < 1.03 * load


def test_spectral_radius_of_a_stuck_pendulum() -> None:
    """Deep in the sand at rest: the dashpot of the bristles against the moment of inertia."""
    made = make_tree(
        pendulum(surface_height_m=-0.2, **{"initial.impact_angle_deg": 45, "initial.impact_speed_rad_s": 0})
    )
    w, start = made.arrays, made.start
    assert made.load is not None
    made.load.batches[0].profile[:, 1] = -0.1
    tree_load.accept(start, w, np.zeros(FIRST), True)
    chebyshev.rates(0.0, start, w, slope := np.empty_like(start))
    found, _ = chebyshev.radius(0.0, start, slope, w, np.zeros_like(start), np.empty_like(start), np.empty_like(start))
    moved, response = start.copy(), np.empty_like(start)
    moved[1] += 1e-9
    chebyshev.rates(0.0, moved, w, response)
    damping = abs(response[1] - slope[1]) / 1e-9
    # tau = 1 ms: beside the fast root of the dashpot, d, is a slow one of 1/tau, which adds to it 1/(tau d) of itself;
    # the power method stops within 5 %, and 20 % are put on top.
    assert damping > 1e4
    assert 1.1 < found / damping < 1.4
