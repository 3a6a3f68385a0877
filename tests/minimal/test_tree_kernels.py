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
    """Bodies with random parents before them, and their angles and rates."""
    bodies = np.zeros(count, tree.BODY)
    for i, body in enumerate(bodies):
        body["parent"] = rng.integers(-1, i)
        body["on_parent"], body["hinge"] = rng.uniform(-0.1, 0.1, (2, 2))
    bodies["mass"], bodies["inertia"] = rng.uniform(0.01, 0.2, (2, count)) * [[1.0], [1e-3]]
    return bodies, rng.uniform(-3, 3, count), rng.uniform(-8, 8, count)


def centres(bodies: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Coordinates (3 n,) x, y and angle of the bodies, worked out one by one."""
    out = np.zeros((len(bodies), 3))
    for i, body in enumerate(bodies):
        at, parent = body["on_parent"], body["parent"]
        if parent >= 0:
            at = out[parent, :2] + turn(angles[parent]) @ at
        out[i, :2], out[i, 2] = at - turn(angles[i]) @ body["hinge"], angles[i]
    return out.ravel()


def turn(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def jacobian(bodies: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Of `centres`, by complex-free central differences of fourth order: (h^4 / 30 + 1e-16 / h) x 0.3 m = 1e-13."""
    h, columns = 1e-3, []
    for i in range(len(angles)):
        e = np.eye(len(angles))[i]
        f = {k: centres(bodies, angles + k * h * e) for k in (-2, -1, 1, 2)}
        columns.append((8.0 * (f[1] - f[-1]) - (f[2] - f[-2])) / (12.0 * h))
    return np.array(columns).T


@pytest.mark.parametrize("count", [1, 2, 7, 20])
def test_accelerations_solve_the_dense_equations(count: int) -> None:
    """J^T M J alpha = J^T (f - M J' omega), with J' along the motion."""
    rng = np.random.default_rng(count)
    for _ in range(5):
        bodies, angles, rates = random_tree(rng, count)
        room, alpha = tree.motion(count), np.zeros(count)
        tree.place(angles, rates, bodies, room)
        room.force[:] = rng.uniform(-2, 2, (count, 3)) * [1.0, 1.0, 0.1]
        J, h = jacobian(bodies, angles), 1e-4
        np.testing.assert_allclose(room.pose.ravel(), centres(bodies, angles), atol=1e-14)
        np.testing.assert_allclose(room.twist.ravel(), J @ rates, atol=1e-10)
        turned = (jacobian(bodies, angles + h * rates) - jacobian(bodies, angles - h * rates)) / (2 * h)
        M = np.diag(np.stack([bodies["mass"], bodies["mass"], bodies["inertia"]], axis=1).ravel())
        f = room.force.ravel().copy()
        tree.accelerate(rates, bodies, room, alpha)
        rest = J.T @ M @ J @ alpha - J.T @ (f - M @ turned @ rates)
        # Differences of J': (8 h)^2 / 6 = 1e-7 of a moment of m l^2 omega^2, about 1 N m.
        assert np.abs(rest).max() < 1e-6 * np.abs(J.T @ M @ turned @ rates).max() + 1e-8


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
            chebyshev.rates(y, w, slope)
            chebyshev.step(y, 0.1 / steps, stages, w, slope, *room)
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
    w, start = arrays_of(surface_height_m=-0.2, **{"initial.impact_angle_deg": 45, "initial.impact_speed_rad_s": 0})
    w.profile[:, 1] = -0.1
    tree_load.accept(start, w, np.zeros(FIRST), True)
    chebyshev.rates(start, w, slope := np.empty_like(start))
    found, _ = chebyshev.radius(start, slope, w, np.zeros_like(start), np.empty_like(start), np.empty_like(start))
    moved, response = start.copy(), np.empty_like(start)
    moved[1] += 1e-9
    chebyshev.rates(moved, w, response)
    damping = abs(response[1] - slope[1]) / 1e-9
    # tau = 1 ms: beside the fast root of the dashpot, d, is a slow one of 1/tau, which adds to it 1/(tau d) of itself;
    # the power method stops within 5 %, and 20 % are put on top.
    assert damping > 1e4
    assert 1.1 < found / damping < 1.4
