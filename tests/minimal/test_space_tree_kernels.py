"""Equations of trees in space against their dense form, the matrix of Newton's method, charts of ball joints."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation
from support_parts import of_tree
from support_runs import scene_of
from support_slopes import slopes_of_residuals, solved_densely

from granular_contact.engines.tree.kernels import space_elimination, space_load, space_tree
from granular_contact.engines.tree.kernels.tree_arrays import SPACE_NODE as NODE
from granular_contact.engines.tree.kernels.tree_arrays import addresses, room
from granular_contact.engines.tree.march import March
from granular_contact.engines.tree.space_tree import tree as make_tree
from granular_contact.geometry import rotations
from granular_contact.mechanics.kernels import space_rotations

Array = np.ndarray
HINGE, SLIDER, BALL = space_tree.HINGE, space_tree.SLIDER, space_tree.BALL


def random_turn(rng: np.random.Generator) -> Array:
    return Rotation.random(random_state=rng).as_matrix()


def random_tree(rng: np.random.Generator, joints: int) -> dict[str, Array]:
    """Arrays of nodes on hinges, sliders and ball joints with random parents before them, moving."""
    rows: list[tuple] = []
    bodies = [-1]
    for _ in range(joints):
        parent, kind = bodies[rng.integers(len(bodies))], rng.integers(3)
        for which in range(3 if kind == BALL else 1):
            rows.append((parent, kind, which))
            parent = len(rows) - 1
        bodies.append(len(rows) - 1)
    w = room(len(rows), in_space=True) | {
        "nodes": np.zeros(len(rows), NODE),
        "prescribed": np.zeros(len(rows), np.int64),
    }
    for node, home, (parent, kind, which) in zip(w["nodes"], w["home"], rows, strict=True):
        node["parent"], node["kind"], node["which"] = parent, kind, which
        turn, end = random_turn(rng), random_turn(rng)
        node["axis"], node["before"] = turn[:, 2], rotations.quaternion_of(turn)
        node["after"], home[:] = rotations.quaternion_of(end), rotations.quaternion_of(end)
        if kind != BALL or which == 0:
            node["on_parent"] = rng.uniform(-0.1, 0.1, 3)
        if kind != BALL or which == space_tree.LAST:
            node["point"], node["mass"] = rng.uniform(-0.1, 0.1, 3), rng.uniform(0.01, 0.2)
            A = rng.uniform(-1, 1, (3, 3))
            node["inertia"] = (1e-3 * node["mass"] * (A @ A.T + np.eye(3))).ravel()
    reach = np.where(w["nodes"]["kind"] == SLIDER, 0.1, 1.0)
    w["s"][:], w["rates"][:] = reach * rng.uniform(-1, 1, len(rows)), reach * rng.uniform(-8, 8, len(rows))
    return w


def placed(w: dict[str, Array], s: Array) -> list[tuple[Array, Array]]:
    """Centre of mass and rotation of each node, by scipy's rotations, one by one."""
    out: list[tuple[Array, Array]] = []
    for i, node in enumerate(w["nodes"]):
        x, R = out[node["parent"]] if node["parent"] >= 0 else (np.zeros(3), np.eye(3))
        at, before, after = (
            x + R @ node["on_parent"],
            *(rotations.of_quaternion(node[k][None])[0] for k in ("before", "after")),
        )
        if node["kind"] == SLIDER:
            at, turn = at + s[i] * R @ node["axis"], before
        elif node["kind"] == HINGE:
            turn = before @ Rotation.from_rotvec([0, 0, s[i]]).as_matrix() @ after
        elif node["which"] == space_tree.LAST:
            turn = Rotation.from_rotvec(s[i - 2 : i + 1]).as_matrix() @ rotations.of_quaternion(w["home"][i][None])[0]
        else:
            turn = np.eye(3)
        out.append((at - R @ turn @ node["point"], R @ turn))
    return out


def jacobian(w: dict[str, Array], s: Array) -> Array:
    """(6 n, n): velocities and angular velocities by rates; central differences of fourth order, 1e-12 of a length."""
    h, placement, columns = 1e-3, placed(w, s), []
    for e in np.eye(len(s)):
        f = {k: placed(w, s + k * h * e) for k in (-2, -1, 1, 2)}
        column = []
        for i, (_, R) in enumerate(placement):
            x, turn = ({k: f[k][i][part] for k in f} for part in (0, 1))
            slope, change = ((8.0 * (d[1] - d[-1]) - (d[2] - d[-2])) / (12.0 * h) for d in (x, turn))
            spin = change @ R.T
            column.append([*slope, spin[2, 1], spin[0, 2], spin[1, 0]])
        columns.append(np.ravel(column))
    return np.array(columns).T


def dense_masses(w: dict[str, Array]) -> Array:
    """Masses and inertias about the axes of the world, (6 n, 6 n)."""
    blocks = []
    for node, (_, R) in zip(w["nodes"], placed(w, w["s"]), strict=True):
        blocks += [node["mass"] * np.eye(3), R @ node["inertia"].reshape(3, 3) @ R.T]
    return np.asarray(block_diag(*blocks))


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 6])
def test_joint_residuals_are_those_of_the_dense_equations(count: int) -> None:
    """R = J^T (M A + spin x I spin - f) - tau, with A = J s'' + J' s' and J' along the motion."""
    rng = np.random.default_rng(count)
    for _ in range(4):
        w, h = random_tree(rng, count), 1e-4
        n = len(w["s"])
        w["s2"][:], w["effort"][:] = rng.uniform(-50, 50, n), rng.uniform(-0.1, 0.1, n)
        w["force"][:] = rng.uniform(-2, 2, (n, 6)) * [1, 1, 1, 0.1, 0.1, 0.1] * (w["nodes"]["mass"] > 0.0)[:, None]
        for step in (space_tree.place, space_tree.node_accelerations, space_tree.residuals):
            of_tree(step)(addresses(w))
        J, masses = jacobian(w, w["s"]), dense_masses(w)
        last = (w["nodes"]["kind"] != BALL) | (w["nodes"]["which"] == space_tree.LAST)  # the others are no bodies
        rows = np.repeat(last, 6)
        at = np.array([[*x, *R.ravel()] for x, R in placed(w, w["s"])])
        np.testing.assert_allclose(w["pose"][last, :3], at[last, :3], atol=1e-13)
        np.testing.assert_allclose(w["turned"][last], at[last, 3:], atol=1e-13)
        np.testing.assert_allclose(w["twist"].ravel()[rows], (J @ w["rates"])[rows], atol=1e-9)
        turned = (jacobian(w, w["s"] + h * w["rates"]) - jacobian(w, w["s"] - h * w["rates"])) / (2 * h)
        moved, spins = J @ w["s2"] + turned @ w["rates"], w["twist"][:, 3:]
        # Differences of J': (8 h)^2 / 6 = 1e-7 of an acceleration of 64 / s^2.
        np.testing.assert_allclose(w["acceleration"].ravel()[rows], moved[rows], atol=1e-6 * np.abs(moved).max())
        gyroscopic = np.zeros((n, 6))
        for i, spin in enumerate(spins):
            gyroscopic[i, 3:] = np.cross(spin, masses[6 * i + 3 : 6 * i + 6, 6 * i + 3 : 6 * i + 6] @ spin)
        asked = J.T @ (masses @ moved + gyroscopic.ravel() - w["force"].ravel())
        np.testing.assert_allclose(w["residual"], asked - w["effort"], atol=2e-6 * np.abs(asked).max() + 1e-8)


@pytest.mark.parametrize("count", [1, 2, 6])
def test_folded_matrix_is_the_dense_one(count: int) -> None:
    """(J^T B J + c) change = -R, for any B of the bodies, without symmetry; nothing of what is prescribed."""
    rng = np.random.default_rng(10 + count)
    for _ in range(4):
        w = random_tree(rng, count)
        n, bodies = len(w["s"]), w["nodes"]["mass"] > 0.0
        w["prescribed"][:] = rng.integers(2, size=n) * (w["nodes"]["kind"] != BALL)
        of_tree(space_tree.place)(addresses(w))
        of_tree(space_elimination.inertias)(0.0, addresses(w))
        masses = w["body"].reshape(n, 6, 6).copy()
        dense = dense_masses(w).reshape(n, 6, n, 6)
        np.testing.assert_allclose(masses, dense[np.arange(n), :, np.arange(n)], atol=1e-15)
        body = masses + rng.uniform(-0.05, 0.05, masses.shape) * np.sqrt(np.abs(masses @ np.ones((6, 6)) @ masses))
        body[~bodies] = 0.0
        balls = w["nodes"]["kind"] == BALL
        w["body"][:], w["stiffness"][:] = body.reshape(n, -1), rng.uniform(0.0, 1e-3, n) * ~balls
        w["coupled"][balls] = rng.uniform(-1e-4, 1e-4, (balls.sum(), 3))
        c = np.diag(w["stiffness"])
        for first in np.flatnonzero(balls & (w["nodes"]["which"] == 0)):
            c[first : first + 3, first : first + 3] = w["coupled"][first : first + 3]
        w["residual"][:] = rng.uniform(-1, 1, n)
        for step in (space_elimination.eliminate, space_elimination.solve):
            of_tree(step)(addresses(w))
        J = jacobian(w, w["s"])
        change, scale = solved_densely(J.T @ block_diag(*body) @ J + c, w)
        np.testing.assert_allclose(w["change"], change, atol=1e-10 * scale + 1e-15)
        moved = (J @ change).reshape(n, 6)
        np.testing.assert_allclose(w["node_change"][bodies], moved[bodies], atol=1e-10 * scale + 1e-15)


@pytest.mark.parametrize("angle", [1e-6, 0.05, 0.31, 0.33, 1.5, 3.0])
def test_chart_of_rotation_vectors(angle: float) -> None:
    """J and J' of the chart: by differences of scipy's exponential, also where series end."""
    rng = np.random.default_rng(3)
    axis, rate, h = rng.normal(size=3), rng.normal(size=3), 1e-4
    u = angle * axis / np.linalg.norm(axis)

    def spin(v: Array) -> Array:
        """Angular velocity at v of a motion with `rate`, by the fourth-order difference."""
        turns = {k: Rotation.from_rotvec(v + k * h * rate).as_matrix() for k in (-2, -1, 1, 2)}
        change = (8.0 * (turns[1] - turns[-1]) - (turns[2] - turns[-2])) / (12.0 * h)
        S = change @ Rotation.from_rotvec(v).as_matrix().T
        return np.array([S[2, 1], S[0, 2], S[1, 0]])

    of = space_rotations.jacobian_coefficients(tuple(u))
    np.testing.assert_allclose(space_rotations.jacobian_times(tuple(u), tuple(rate), of), spin(u), atol=1e-10)
    drift = (spin(u + h * rate) - spin(u - h * rate)) / (2.0 * h)
    np.testing.assert_allclose(space_rotations.jacobian_rate_times(tuple(u), tuple(rate), of), drift, atol=1e-6)
    turned = rotations.of_quaternion(np.array([space_rotations.exponential(tuple(u))]))[0]
    np.testing.assert_allclose(turned, Rotation.from_rotvec(u).as_matrix(), atol=1e-14)


@pytest.mark.parametrize("square", [0.0, 0.05, 0.0999999, 0.1000001, 2.0])
def test_coefficients_of_the_chart_are_those_of_their_power_series(square: float) -> None:
    """a = sum (-x)^k / (2k + 2)!, b = sum (-x)^k / (2k + 3)! of x = u . u, and 2 da/dx, 2 db/dx, to 30 terms."""
    terms = range(30)
    a, b = ([(-1.0) ** k / math.factorial(2 * k + more) for k in terms] for more in (2, 3))
    values = [sum(c * square**k for k, c in enumerate(of)) for of in (a, b)]
    slopes = [sum(2.0 * k * c * square ** (k - 1) for k, c in enumerate(of) if k > 0) for of in (a, b)]
    # Closed forms lose what cancels in 1 - cos and the like: 1e-16 over x^2 or less.
    coefficients = space_rotations.jacobian_coefficients((np.sqrt(square), 0.0, 0.0))
    np.testing.assert_allclose(coefficients, values + slopes, rtol=0.0, atol=2e-15 if square < 0.1 else 1e-13)


def test_a_new_chart_leaves_the_motion_as_it_is() -> None:
    rng = np.random.default_rng(5)
    w = random_tree(rng, 6)
    w["s2"][:] = rng.uniform(-50, 50, len(w["s"]))
    seen = ("pose", "twist", "acceleration")
    for step in (space_tree.place, space_tree.node_accelerations):
        of_tree(step)(addresses(w))
    bodies = w["nodes"]["mass"] > 0.0
    before = {name: w[name][bodies].copy() for name in seen}
    for step in (space_tree.recentre, space_tree.place, space_tree.node_accelerations):
        of_tree(step)(addresses(w))
    assert not w["s"][w["nodes"]["kind"] == BALL].any()
    for name in seen:
        np.testing.assert_allclose(w[name][bodies], before[name], rtol=1e-12, atol=1e-11, err_msg=name)


def test_newton_matrix_is_the_derivative_of_joint_residuals() -> None:
    """Of the walker that stands in sand: by differences of R, with s, s' and s'' moved as a step of 1 ms does it."""
    march = March(make_tree(scene_of("walker_in_space", "solver.end_time_s=0.3")))
    march.plan(0.3)
    while march.time < 0.3:
        march.proceed()
    w, h = march.arrays, 1e-3
    fq, fv = 0.25 * h * h, 0.5 * h
    of_tree(space_load.forces_on_nodes)(march._addresses)
    of_tree(space_load.tangent)(fq, fv, march._addresses)
    c, J, B = w["stiffness"].copy(), jacobian(w, w["s"]), block_diag(*w["body"].reshape(-1, 6, 6))
    slopes = slopes_of_residuals(
        march, (space_load.forces_on_nodes, space_tree.node_accelerations, space_tree.residuals), fq, fv, 1e-3
    )
    matrix, sand = J.T @ B @ J + np.diag(c), J.T @ (B - dense_masses(w)) @ J
    assert np.abs(sand).max() > 0.02 * np.abs(matrix).max()  # the sand counts
    np.testing.assert_allclose(slopes, matrix, atol=0.1 * np.abs(sand).max())
