"""Trees of rigid bodies in space in minimal coordinates: independent solutions, conserved numbers, and the engine."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from support_models import one_body
from support_runs import ROOT, order, simulate

from granular_contact import Simulation, build, load
from granular_contact.engines.tree.solve import Solve
from granular_contact.engines.tree.space_tree import tree
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.results.interpolation import at_times
from granular_contact.run import begin
from granular_contact.scene.methods import reason
from validation.random_scenes.space_trees import random_tree
from validation.space_trees import apart
from validation.space_trees import solved as solved_tree

Array = np.ndarray
GRAVITY = 9.81


def solved(config: dict[str, Any], **solver: Any) -> SpatialKinematics:
    """Motion of a config in minimal coordinates."""
    scene: Any = build(load(config | {"method": "minimal", "solver": config["solver"] | solver}))
    made = tree(scene)
    solve = Solve(made)
    solve.advance()
    return SpatialKinematics(made.system, solve.trajectory())


# ---- independent solutions ----

ROD = {
    "type": "rigid",
    "density_kg_m3": 1000,
    "shapes": [{"type": "box", "size_m": [0.2, 0.03, 0.01], "center_m": [0.1, 0, 0]}],
}
TWO_RODS: dict[str, Any] = {
    "model": {
        "in_space": True,
        "name": "two rods",
        "bodies": {"one": ROD, "two": ROD},
        "joints": {
            "a": {"type": "ball", "parent": "ground", "child": "one"},
            "b": {"type": "ball", "parent": "one", "child": "two", "parent_point_m": [0.2, 0, 0]},
        },
    },
    "medium": None,
    "initial": {"joints": {"a": {"spin_rad_s": [6, 2, 4]}, "b": {"rpy_deg": [20, -30, 60], "spin_rad_s": [-8, 3, -5]}}},
    "solver": {"end_time_s": 0.25, "rest_time_s": None},
}
MASS = 1000 * 0.2 * 0.03 * 0.01
INERTIA = MASS / 12.0 * np.array([0.03**2 + 0.01**2, 0.2**2 + 0.01**2, 0.2**2 + 0.03**2])


def skew(a: Array) -> Array:
    """Matrix of a x."""
    return np.cross(np.eye(3), a)


def of_two_rods(_: float, y: Array) -> Array:
    """Newton and Euler of both rods with the forces in their joints, one linear system (18, 18).

    y: quaternions (scalar last) and angular velocities, world frame, of both.
    """
    e, w = y[:8].reshape(2, 4), y[8:].reshape(2, 3)
    turns = [Rotation.from_quat(quaternion) for quaternion in e]
    J = [R.as_matrix() @ np.diag(INERTIA) @ R.as_matrix().T for R in turns]
    near, far = [-0.1 * R.as_matrix()[:, 0] for R in turns], [0.1 * R.as_matrix()[:, 0] for R in turns]
    A, b = np.zeros((18, 18)), np.zeros(18)  # r_1'', w_1', r_2'', w_2', force of a on one, force of b on two
    for k in range(2):
        A[6 * k : 6 * k + 3, 6 * k : 6 * k + 3] = MASS * np.eye(3)
        A[6 * k + 3 : 6 * k + 6, 6 * k + 3 : 6 * k + 6] = J[k]
        b[6 * k + 2], b[6 * k + 3 : 6 * k + 6] = -GRAVITY * MASS, -np.cross(w[k], J[k] @ w[k])
        A[6 * k : 6 * k + 3, 12 + 3 * k : 15 + 3 * k] = -np.eye(3)
        A[6 * k + 3 : 6 * k + 6, 12 + 3 * k : 15 + 3 * k] = -skew(near[k])
        # The joint's point of this rod is accelerated as that of the one before.
        A[12 + 3 * k : 15 + 3 * k, 6 * k : 6 * k + 3] = np.eye(3)
        A[12 + 3 * k : 15 + 3 * k, 6 * k + 3 : 6 * k + 6] = -skew(near[k])
        b[12 + 3 * k : 15 + 3 * k] = -np.cross(w[k], np.cross(w[k], near[k]))
    A[0:3, 15:18], A[3:6, 15:18] = np.eye(3), skew(far[0])
    A[15:18, 0:3], A[15:18, 3:6] = -np.eye(3), skew(far[0])
    b[15:18] += np.cross(w[0], np.cross(w[0], far[0]))
    solution = np.linalg.solve(A, b)
    rates = [0.5 * np.concatenate([e[k, 3] * w[k] + np.cross(w[k], e[k, :3]), [-w[k] @ e[k, :3]]]) for k in range(2)]
    return np.concatenate([*rates, solution[3:6], solution[9:12]])


@pytest.mark.slow
def test_two_rods_on_ball_joints_move_as_newton_and_euler_say() -> None:
    """Joint forces as unknowns and Runge-Kutta steps of order 8 by scipy; ours are of order two."""
    coarse = solved(TWO_RODS, step_s=1e-3)
    names = list(coarse.system.rigid)
    begun = [np.roll(coarse.quaternion(name)[0], -1) for name in names] + [coarse.spin(name)[0] for name in names]
    way = solve_ivp(of_two_rods, (0.0, 0.25), np.concatenate(begun), method="DOP853", rtol=1e-11, atol=1e-12)
    ends = [Rotation.from_quat(way.y[4 * k : 4 * k + 4, -1]).as_matrix()[:, 0] for k in range(2)]
    tip = 0.2 * (ends[0] + ends[1])
    steps, errors = [2e-3, 1e-3, 5e-4], []
    for step in steps:
        motion = solved(TWO_RODS, step_s=step, tolerance=1e-10)
        errors.append(float(np.linalg.norm(motion.position("two", np.array([0.1, 0, 0]))[0][-1] - tip)))
    assert order(steps, errors) == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < 1e-4 * 0.75  # the tip goes 0.75 m


ARM_AXES = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.3, 1.0, 0.2], [1.0, 0.0, 0.4]])
ARM_RATES = np.array([3.0, -4.0, 6.0, -8.0])


def of_arm(_: float, y: Array) -> Array:
    """Kane's equations of four rods on hinges one after another, from the axes and points of the hinges in the world.

    y: angles and rates. Rates of partial velocities by differences along the motion.
    """
    s, rates = y[:4], y[4:]

    def partial(s: Array) -> tuple[Array, Array, list[Array]]:
        R, at, axes, points, centers, turns = np.eye(3), np.zeros(3), [], [], [], []
        for axis, angle in zip(ARM_AXES, s, strict=True):
            unit = axis / np.linalg.norm(axis)
            axes.append(R @ unit)
            points.append(at)
            R = R @ Rotation.from_rotvec(angle * unit).as_matrix()
            centers.append(at + R @ [0.1, 0.0, 0.0])
            at = at + R @ [0.2, 0.0, 0.0]
            turns.append(R)
        V, W = np.zeros((4, 3, 4)), np.zeros((4, 3, 4))  # of centres and of turning, of each rod by each rate
        for i in range(4):
            for j in range(i + 1):
                V[i, :, j], W[i, :, j] = np.cross(axes[j], centers[i] - points[j]), axes[j]
        return V, W, turns

    V, W, turns = partial(s)
    d = 1e-5
    (V1, W1, _), (V0, W0, _) = partial(s + d * rates), partial(s - d * rates)
    M, right = np.zeros((4, 4)), np.zeros(4)
    for i, R in enumerate(turns):
        J, w = R @ np.diag(INERTIA) @ R.T, W[i] @ rates
        M += MASS * V[i].T @ V[i] + W[i].T @ J @ W[i]
        drift, turning = (V1[i] - V0[i]) @ rates / (2 * d), (W1[i] - W0[i]) @ rates / (2 * d)
        right -= V[i].T @ (MASS * (drift + GRAVITY * np.eye(3)[2])) + W[i].T @ (J @ turning + np.cross(w, J @ w))
    return np.concatenate([rates, np.linalg.solve(M, right)])


@pytest.mark.slow
def test_an_arm_of_four_links_moves_as_kane_says() -> None:
    """Hinges along axes in all directions; Runge-Kutta steps of order 8 by scipy, ours are of order two."""
    names = "abcd"
    joints, starts = {}, {}
    for i, name in enumerate(names):
        on = {"parent": "ground"} if i == 0 else {"parent": names[i - 1], "parent_point_m": [0.2, 0, 0]}
        joints[f"j{name}"] = {"type": "hinge", "child": name, "axis": ARM_AXES[i].tolist(), **on}
        starts[f"j{name}"] = {"rate_rad_s": float(ARM_RATES[i])}
    config: dict[str, Any] = {
        "model": {"in_space": True, "name": "arm", "bodies": dict.fromkeys(names, ROD), "joints": joints},
        "medium": None,
        "initial": {"joints": starts},
        "solver": {"end_time_s": 0.2, "rest_time_s": None},
    }
    begun = np.concatenate([np.zeros(4), ARM_RATES])
    way = solve_ivp(of_arm, (0.0, 0.2), begun, method="DOP853", rtol=1e-10, atol=1e-11)
    steps, errors = [2e-3, 1e-3, 5e-4], []
    for step in steps:
        motion = solved(config, step_s=step, tolerance=1e-10)
        coordinates = [motion.coordinate(joint)[0][-1] for joint in motion.scene.joints]
        errors.append(float(np.abs(coordinates - way.y[:4, -1]).max()))
    assert order(steps, errors) == pytest.approx(2.0, abs=0.2)
    assert errors[-1] < 2e-3  # rad, of some radians


def test_a_heavy_top_precesses_steadily() -> None:
    """A disc on a massless axle: I_1 W^2 cos t - I_3 w_3 W + m g h = 0 of the precession W at the inclination t."""
    m, high, I_3, tilt, spin = 0.2, 0.05, 1e-4, np.radians(30.0), 150.0
    I_1 = 0.5 * I_3 + m * high**2  # about the point that it stands on
    c = I_1 * np.cos(tilt)
    precession = (I_3 * spin - np.sqrt((I_3 * spin) ** 2 - 4.0 * c * m * GRAVITY * high)) / (2.0 * c)
    axis, R = np.array([0.0, -np.sin(tilt), np.cos(tilt)]), Rotation.from_euler("x", tilt).as_matrix()
    # The part of the precession along the axis is in w_3.
    angular_velocity = precession * np.array([0.0, 0.0, 1.0]) + (spin - precession * np.cos(tilt)) * axis
    inertia = {"xx": 0.5 * I_3, "yy": 0.5 * I_3, "zz": I_3}
    top = {"type": "rigid", "mass_kg": m, "inertia_kg_m2": inertia, "center_of_mass_m": [0, 0, high]}
    config: dict[str, Any] = {
        "model": one_body("top", top, "tip", "ball"),
        "medium": None,
        "initial": {"joints": {"tip": {"rpy_deg": [30, 0, 0], "spin_rad_s": angular_velocity.tolist()}}},
        "solver": {"end_time_s": 1.0, "step_s": 1e-3, "rest_time_s": None},
    }
    steps, errors = [2e-3, 1e-3, 5e-4], []
    for step in steps:
        motion = solved(config, step_s=step, tolerance=1e-10)
        up = motion.rotation("top")[-1][:, 2]
        wanted = Rotation.from_rotvec([0, 0, precession * motion.engine.time[-1]]).as_matrix() @ R[:, 2]
        errors.append(float(np.linalg.norm(up - wanted)))
    assert order(steps, errors) == pytest.approx(2.0, abs=0.2)
    assert errors[-1] < 1e-2  # of 3.3 rad


# ---- conserved numbers ----


def momentum_and_energy(motion: SpatialKinematics) -> tuple[Array, Array]:
    """Angular momentum (n, 3) about the common centre of mass, and kinetic energy (n,)."""
    bodies = [handle.body for handle in motion.system.rigid.values()]
    whole = sum(body.mass for body in bodies)
    center, speed = (sum(body.mass * motion.center(body.name)[k] for body in bodies) / whole for k in (0, 1))
    L, E = np.zeros_like(center), np.zeros(len(center))
    for body in bodies:
        x, v = motion.center(body.name)
        w, R = motion.spin(body.name), motion.rotation(body.name)
        angular_momentum = np.einsum("nij,jk,nlk,nl->ni", R, body.inertia, R, w)
        L += body.mass * np.cross(x - center, v - speed) + angular_momentum
        E += 0.5 * body.mass * np.sum(v * v, axis=1) + 0.5 * np.sum(w * angular_momentum, axis=1)
    return L, E


def test_a_tumbling_tree_keeps_momentum_and_energy_to_order_two() -> None:
    """Four bodies on hinges, a ball joint and a slider, without weight, sand or springs."""
    box = {"type": "rigid", "density_kg_m3": 1000, "shapes": [{"type": "box", "size_m": [0.1, 0.05, 0.03]}]}
    at = {"parent_point_m": [0.06, 0.01, 0], "child_point_m": [-0.05, 0, 0.01]}
    joints = {
        "base": {"type": "free", "parent": "ground", "child": "a"},
        "ball": {"type": "ball", "parent": "a", "child": "b", **at},
        "hinge": {"type": "hinge", "parent": "b", "child": "c", "axis": [0.3, 1, 0.2], **at},
        "slider": {
            "type": "slider",
            "parent": "a",
            "child": "d",
            "axis": [0.2, 1, 0.4],
            "parent_point_m": [-0.06, 0, 0],
        },
    }
    starts = {
        "base": {"spin_rad_s": [5, 9, -4], "rpy_deg": [20, 40, 60]},
        "ball": {"spin_rad_s": [-6, 4, 7]},
        "hinge": {"rate_rad_s": 9},
        "slider": {"speed_m_s": -0.1},
    }
    config: dict[str, Any] = {
        "model": {"in_space": True, "name": "tumbling", "bodies": dict.fromkeys("abcd", box), "joints": joints},
        "medium": None,
        "gravity_m_s2": 0,
        "initial": {"joints": starts},
        "solver": {"end_time_s": 0.4, "rest_time_s": None},
    }
    steps, turned, lost = [4e-3, 2e-3, 1e-3], [], []
    for step in steps:
        L, E = momentum_and_energy(solved(config, step_s=step, tolerance=1e-10))
        turned.append(np.linalg.norm(L[-1] - L[0]) / np.linalg.norm(L[0]))
        lost.append(abs(E[-1] - E[0]) / E[0])
    assert order(steps, turned) == pytest.approx(2.0, abs=0.2)
    assert order(steps, lost) > 1.8  # what the scheme damps is of order three
    assert turned[-1] < 1e-3
    assert lost[-1] < 1e-3


@pytest.mark.slow
def test_a_body_rests_on_a_slope() -> None:
    """Laid on sand that rises by 10 degrees it comes to rest, and then creeps by less than 1 um/s over 20 s."""
    box = {"type": "rigid", "density_kg_m3": 1500, "shapes": [{"type": "box", "size_m": [0.08, 0.06, 0.03]}]}
    config: dict[str, Any] = {
        "model": one_body("box", box),
        "medium": "rft3d_sand",
        "bed": {"slope_deg": 10, "slope_direction_deg": 30},
        "initial": {"joints": {"flight": {"z_m": 0.02, "rpy_deg": [0, -8, 4]}}},
        "solver": {"end_time_s": 23.0, "accuracy": 1e-2, "rest_time_s": None},
    }
    motion = solved(config)
    x, _ = motion.center("box")
    late = x[motion.engine.time > 3.0]
    assert np.linalg.norm(late[-1] - late[0]) < 20.0 * 1e-6
    assert motion.depths()["box"][0].values[-1] > 5e-4


@pytest.mark.slow
def test_a_robot_stands_on_a_slope() -> None:
    """The hexapod with its hips held by motors, on a slope of 8 degrees, as above."""
    drive = {"type": "pd", "angle_deg": 0, "gain_Nm_per_rad": 10, "rate_gain_Nm_s_per_rad": 0.1}
    scenario = load("hexapod").scenario
    stands = scenario.replace(
        {
            "signals": {},
            "drives": dict.fromkeys(scenario.drives, drive),
            "bed": {"slope_deg": 8, "slope_direction_deg": 30},
            "initial.joints": {"trunk": {"z_m": 0.07}},
            "solver.end_time_s": 23.0,
        }
    )
    simulation = Simulation(stands)
    at = [simulation.step(None, time).poses[0, :3] for time in (3.0, 20.0)]
    assert simulation.ended is not None
    assert np.linalg.norm(at[1] - at[0]) < 20.0 * 1e-6
    assert simulation.observe().depths.max() > 1e-3


# ---- the engine ----


def off(config: Any) -> float:
    """How far centres of mass are apart in minimal coordinates and by the engine, over the longest way of one."""
    paths = []
    for method in ("minimal", "engine"):
        begun = begin(build(config.replace({"method": method})))
        begun.solving.advance()
        t, system = begun.solving.trajectory(), begun.system
        assert system is not None
        times = np.linspace(0.0, config.solver.end_time_s, 101)
        at = [system.coordinates.places(system.rigid[body.name].node)[:3] for body in system.scene.rigid]
        paths.append(np.array([at_times(t.time, t.q[:, places], t.v[:, places], times) for places in at]))
        begun.solving.close()
    way = np.linalg.norm(np.diff(paths[0], axis=1), axis=2).sum(axis=1).max()
    return float(np.linalg.norm(paths[0] - paths[1], axis=2).max() / max(way, 1e-3))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_random_trees_move_as_by_the_engine(seed: int) -> None:
    # An error of 1e-3 of the way is promised of either.
    assert off(load(random_tree(seed)).scenario) < 2e-3


@pytest.mark.slow
def test_a_body_on_one_joint_is_solved_with_any_accuracy() -> None:
    # The engine's accelerations went to and fro ever more as steps shrank, down to 20 ns, 200,000 steps in 6 ms.
    fine = {"solver.accuracy": 3e-5, "solver.end_time_s": 0.02, "solver.max_wall_s": 60.0}
    scenario = load(random_tree(27)).scenario.replace(fine)
    assert [joint.type for joint in scenario.model.joints.values()] == ["hinge"]
    assert off(scenario) < 1e-4


@pytest.mark.slow
def test_deviation_from_the_engine_falls_with_the_accuracy() -> None:
    scenario = load(random_tree(2)).scenario.replace({"solver.accuracy": 1e-4})
    assert off(scenario) < 2e-4


@pytest.mark.parametrize("seed", [6, 18])
def test_a_tree_that_topples_over_keeps_its_accuracy(seed: int) -> None:
    fine, asked = (solved_tree(seed, "minimal", accuracy).ways for accuracy in (1e-4, 1e-3))
    assert apart(fine, asked) < 1e-3


@pytest.mark.slow
def test_the_engine_solves_steps_that_were_halved_to_near_round_off() -> None:
    """It begins deep in sand, at 500 times its weight. Were what a step may leave the same, none could be solved."""
    ours, theirs = (solved_tree(101, method, 3e-5) for method in ("minimal", "engine"))
    assert theirs.status.code == "end_time"
    assert apart(theirs.ways, ours.ways) < 1e-4


def test_newton_residual_is_small_beside_a_fine_accuracy() -> None:
    """A residual that is left acts as a force: one of 1e-5 puts this tree off by 12 times what is asked."""
    asked, exact = (solved_tree(176, "minimal", 1e-5, tolerance).ways for tolerance in (None, 1e-9))
    assert apart(exact, asked) < 0.2 * 1e-5


SHIPPED = {  # s
    "hexapod": 0.2,
    "walker_in_space": 0.2,
    "snake": 0.03,
    "screw": 0.3,
    "steered_wheel": 0.3,
    "dropped": 0.08,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_runs_move_as_by_the_engine(name: str) -> None:
    scenario = load(name).scenario.replace({"solver.end_time_s": SHIPPED[name], "solver.accuracy": 1e-3})
    assert off(scenario) < 1e-3


@pytest.mark.slow
def test_results_are_those_of_the_engine() -> None:
    """Columns, torques and energies of what a motion is prescribed of, and of springs in ball joints."""
    # Facets so small that neither run is repeated with others: a repeat has as many as its own estimate asks for.
    robot = f"model={{urdf: {ROOT / 'models' / 'hexapod' / 'hexapod.urdf'}, name: hexapod, facet_size_m: 0.008}}"
    runs = {}
    for method in ("minimal", "engine"):
        given = robot, f"method={method}", "solver.end_time_s=0.12", "solver.accuracy=1e-3"
        runs[method] = simulate("hexapod", *given)
    assert len({str(run.summary["facets"]["bodies"]) for run in runs.values()}) == 1
    ours, theirs = runs["minimal"], runs["engine"]
    assert [column.name for column in ours.columns] == [column.name for column in theirs.columns]
    times = np.linspace(0.02, 0.12, 50)
    for name in ("hip_front_left_torque_Nm", "hip_middle_left_torque_Nm"):
        a, b = (np.interp(times, r["time_s"], r[name]) for r in (ours, theirs))
        assert np.sqrt(np.mean((a - b) ** 2)) < 0.02 * np.ptp(b)
    for name in ("drive_work_J", "granular_work_J", "kinetic_J"):
        a, b = (np.interp(times, r["time_s"], r[name]) for r in (ours, theirs))
        np.testing.assert_allclose(a, b, atol=5e-3 * np.ptp(theirs["granular_work_J"]), err_msg=name)
    assert ours.summary["energy"]["imbalance_relative"] < 2e-3


# ---- what is asked of it ----


def test_a_state_of_a_tree_in_space_goes_on_bit_for_bit() -> None:
    """With ball joints, whose charts begin anew at each step."""
    simulation = Simulation(load(random_tree(3)))
    assert reason(simulation.scene).startswith("in minimal coordinates")
    simulation.step(None, 0.1)
    kept = simulation.state()
    first = [np.array(list(simulation.step(None, 0.03).values())) for _ in range(3)]
    simulation.restore(kept)
    resumed = [np.array(list(simulation.step(None, 0.03).values())) for _ in range(3)]
    np.testing.assert_array_equal(first, resumed)


@pytest.mark.slow
def test_walls_are_watched_as_by_the_engine() -> None:
    """How far what is immersed reaches, over a floor that bears, in layers."""
    scenario, reached = load("thin_sand").scenario.replace({"solver.end_time_s": 0.06}), []
    for method in ("minimal", "engine"):
        begun = begin(build(scenario.replace({"method": method})))
        begun.solving.advance()
        reached.append(begun.solving.trajectory().load.reached[-1])
        begun.solving.close()
    assert np.isfinite(reached).all()
    np.testing.assert_allclose(reached[0], reached[1], atol=1e-3 * 0.12)  # what steps leave of a way of 0.12 m


@pytest.mark.slow
def test_links_that_bend_move_as_by_the_engine() -> None:
    """A hub with a rod that is thrown into sand: ball joints with springs of bending and torsion between its pieces."""
    hub = {"type": "rigid", "density_kg_m3": 2000, "shapes": [{"type": "box", "size_m": [0.06, 0.04, 0.03]}]}
    soft = {"youngs_modulus_Pa": 2e8, "poissons_ratio": 0.35, "elements": 4, "bending_damping_N_m2_s": 2e-5}
    rod = {"type": "link", "length_m": 0.15, "diameter_m": 0.008, "density_kg_m3": 1200, "flexible": soft}
    clamp = {"type": "weld", "parent": "hub", "child": "rod", "parent_point_m": [0.03, 0, 0], "rpy_deg": [0, 40, 20]}
    fly = {"z_m": 0.11, "vx_m_s": 0.5, "vz_m_s": -0.5, "spin_rad_s": [2, 3, -4]}
    config = {
        "model": {
            "in_space": True,
            "name": "bend",
            "bodies": {"hub": hub, "rod": rod},
            "joints": {"fly": {"type": "free", "parent": "ground", "child": "hub"}, "clamp": clamp},
        },
        "medium": "rft3d_sand",
        "initial": {"joints": {"fly": fly}},
        "solver": {"end_time_s": 0.05, "accuracy": 1e-3, "rest_time_s": None},
    }
    scenario = load(config).scenario
    assert reason(build(scenario)).startswith("in minimal coordinates")
    assert off(scenario) < 2e-3
