"""Mechanisms in space solved: as in the plane where they are extruded, alike whichever way they look, at rest where
they stand, with joints, loops and drives, and their energy accounted for.
"""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation
from support_models import one_body
from support_parts import called
from support_runs import ROOT

from granular_contact import Results, load, simulate
from granular_contact.engines.tree.kernels import space_ball_joints
from granular_contact.engines.tree.kernels.tree_arrays import SPACE_NODE
from granular_contact.geometry import rotations
from granular_contact.mechanics.joint_loads import fill
from granular_contact.mechanics.kernels import joint_loads
from granular_contact.mechanics.space.coordinates import SpatialCoordinate
from granular_contact.scene import build
from granular_contact.scene.joint_law import JointLaw

FREE = {"f": {"type": "free", "parent": "ground", "child": "b"}}
SOLVER = {"end_time_s": 0.12, "accuracy": 1e-3, "rest_time_s": None}
POLYGON = [[-0.03, -0.02], [0.03, -0.02], [0.04, 0.01], [0, 0.03], [-0.04, 0.01]]
FINE = {"facet_size_m": 0.003}
# Planar shape, the same extruded, medium.
EXTRUDED: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "plate": (
        {"type": "plate", "start_m": [-0.04, 0], "end_m": [0.04, 0], "width_m": 0.05, "thickness_m": 0.004},
        {"type": "plate", "size_m": [0.08, 0.05], "thickness_m": 0.004, **FINE},
        "rft_generic",
    ),
    "bar": (
        {"type": "cylinder", "start_m": [-0.05, 0], "end_m": [0.05, 0], "diameter_m": 0.006},
        {"type": "bar", "points_m": [[-0.05, 0, 0], [0.05, 0, 0]], "diameter_m": 0.006},
        "play_sand",
    ),
    "polygon": (
        {"type": "polygon", "points_m": POLYGON, "width_m": 0.05},
        {"type": "polygon", "points_m": POLYGON, "width_m": 0.05, **FINE},
        "rft_generic",
    ),
    "c_leg": (
        {"type": "arc", "radius_m": 0.04, "from_deg": 0, "to_deg": 150, "width_m": 0.05, "thickness_m": 0.004},
        {"type": "arc", "radius_m": 0.04, "from_deg": 0, "to_deg": 150, "width_m": 0.05, "thickness_m": 0.004, **FINE},
        "rft_generic",
    ),
    "disc": (
        {"type": "disc", "diameter_m": 0.08, "thickness_m": 0.05},
        {"type": "cylinder", "diameter_m": 0.08, "length_m": 0.05, "rpy_deg": [90, 0, 0], **FINE},
        "rft_generic",
    ),
}


# Beds of the plane and in space, under shapes of this width: the floor's stiffness is per length there, here per area.
LAYERS = {"plate": "poppy_seeds_close", "bar": {"from": "play_sand", "eta_h": 20}}


def bed_of(name: str, width: float, in_space: bool) -> dict[str, Any]:
    key, stiffness = ("stiffness_N_m3", 2e6) if in_space else ("stiffness_N_m2", 2e6 * width)
    floor = {key: stiffness, "damping_s_m": 0.5}
    return {"depth_m": 0.014, "floor": floor, "layers": [{"top_m": 0.006, "medium": LAYERS[name]}]}


def columns(results: Results, *names: str, at: Any) -> np.ndarray:
    return np.column_stack([np.interp(at, results["time_s"], results[name]) for name in names])


@pytest.mark.slow
@pytest.mark.parametrize(("name", "width"), [*((name, None) for name in EXTRUDED), ("plate", 0.05), ("bar", 0.006)])
def test_extruded_bodies_move_as_in_the_plane(name: str, width: float | None) -> None:
    """On a bed of one medium, and on one with a layer and a floor that bears."""
    plane, space, medium = EXTRUDED[name]
    beds = [{} if width is None else {"bed": bed_of(name, width, in_space)} for in_space in (False, True)]
    body: dict[str, Any] = {"type": "rigid", "mass_kg": 0.3}
    common = {"medium": medium, "surface_height_m": 0, "solver": SOLVER}
    flat = simulate(
        load(
            common
            | beds[0]
            | {
                "model": {
                    "name": "b",
                    "joints": FREE,
                    "bodies": {"b": body | {"inertia_kg_m2": 3e-4, "shapes": [plane]}},
                }
            }
            | {
                "initial": {
                    "joints": {"f": {"y_m": 0.055, "angle_deg": 30, "vx_m_s": 0.5, "vy_m_s": -1, "rate_rad_s": 2}}
                }
            }
        )
    )
    inertia = {"xx": 3e-4, "yy": 3e-4, "zz": 3e-4}
    start = {"z_m": 0.055, "rpy_deg": [0, 30, 0], "vx_m_s": 0.5, "vz_m_s": -1, "spin_rad_s": [0, 2, 0]}
    bodies = {"b": body | {"inertia_kg_m2": inertia, "shapes": [space]}}
    deep = simulate(
        load(
            common
            | beds[1]
            | {"model": {"in_space": True, "name": "b", "joints": FREE, "bodies": bodies}}
            | {"initial": {"joints": {"f": start}}}
        )
    )
    at = np.linspace(0.0, 0.12, 60)
    planar, spatial = columns(flat, "b_x_m", "b_y_m", at=at), columns(deep, "b_x_m", "b_z_m", at=at)
    way = np.linalg.norm(np.diff(planar, axis=0), axis=1).sum()
    # Facets of 3 mm in place of strips, 96 chords of a circle, steps at an accuracy of 1e-3 each.
    assert np.linalg.norm(planar - spatial, axis=1).max() < 1e-3 * way
    assert np.abs(columns(flat, "b_orientation_deg", at=at) - columns(deep, "b_pitch_deg", at=at)).max() < 0.1
    assert np.abs(deep["b_y_m"]).max() < 1e-4 * way  # the facets of both sides are not quite alike
    assert deep["depth_m"].max() > 0.005
    if width is not None:
        works = [results["floor_work_J"][-1] for results in (flat, deep)]
        assert works[1] == pytest.approx(works[0], rel=2e-2)
        assert works[1] < -1e-3 * flat.summary["energy"]["initial_J"]
    assert deep.summary["energy"]["imbalance_relative"] < 1e-4


def test_the_runner_extruded_runs_as_in_the_plane() -> None:
    """The landing and half a stride; after 0.7 s they are 7e-4 of the way apart, at an accuracy of 1e-3."""
    flat = yaml.safe_load((ROOT / "models" / "runner.yaml").read_text(encoding="utf-8"))
    run = yaml.safe_load((ROOT / "configs" / "runner.yaml").read_text(encoding="utf-8"))
    deep = copy.deepcopy(flat) | {"in_space": True}
    for shape in (shape for body in deep["bodies"].values() for shape in body["shapes"]):
        shape["facet_size_m"] = 0.01
        if "center_m" in shape:
            shape["center_m"] = [shape["center_m"][0], 0, shape["center_m"][-1]]  # legs share their shape
    for joint in deep["joints"].values():
        if joint["type"] == "hinge":
            joint["axis"] = [0, 1, 0]
            joint["parent_point_m"].insert(1, 0)
    run["solver"] = {"end_time_s": 0.25, "accuracy": 3e-3}
    planar = simulate(load(run | {"model": flat}))
    start = {"joints": {"trunk": {"x_m": 0, "z_m": 0.045}}}
    spatial = simulate(load(run | {"model": deep, "initial": start}))
    at = np.linspace(0.0, 0.25, 100)
    path, path_in_space = (
        columns(planar, "trunk_x_m", "trunk_y_m", at=at),
        columns(spatial, "trunk_x_m", "trunk_z_m", at=at),
    )
    way = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert np.linalg.norm(path - path_in_space, axis=1).max() < 1e-3 * way
    assert np.abs(spatial["trunk_y_m"]).max() < 1e-5 * way
    assert path[-1, 0] > 0.02


# ---- whichever way it looks ----


def tumbling(turn: np.ndarray, *, mirrored: bool = False) -> Results:
    """A body with a spike and a hinged rod thrown into the sand, all of it turned about the vertical, or mirrored."""
    flip = np.diag([1.0, -1.0 if mirrored else 1.0, 1.0])
    R = turn @ flip @ rotations.of_rpy(np.radians([20, 35, 10])) @ flip
    velocity, spin = turn @ flip @ [0.5, 0.1, -1.0], turn @ flip @ [3.0, -4.0, 5.0] * np.linalg.det(flip)
    place = turn @ flip @ [0.01, 0.02, 0.05]
    box = {"type": "box", "size_m": [0.06, 0.04, 0.03], "facet_size_m": 0.012}
    spike = {"type": "cone", "diameter_m": 0.03, "height_m": 0.03, "facet_size_m": 0.012}
    spike["center_m"] = (flip @ [0.01, 0.005, -0.04]).tolist()
    rod = {"type": "link", "length_m": 0.05, "diameter_m": 0.01, "density_kg_m3": 2000, "facet_size_m": 0.02}
    hinge = {"type": "hinge", "parent": "a", "child": "l", "parent_point_m": (flip @ [0.03, 0.01, 0]).tolist()}
    hinge["axis"] = (flip @ [0.2, 1, 0.3] * np.linalg.det(flip)).tolist()
    hinge |= {"spring": {"stiffness_Nm_per_rad": 0.1}, "friction": {"torque_Nm": 0.002}}
    start = dict(zip(("x_m", "y_m", "z_m"), place.tolist(), strict=True))
    start |= dict(zip(("vx_m_s", "vy_m_s", "vz_m_s"), velocity.tolist(), strict=True))
    start |= {"quaternion": rotations.quaternion_of(R).tolist(), "spin_rad_s": spin.tolist()}
    bodies = {"a": {"type": "rigid", "density_kg_m3": 2000, "shapes": [box, spike]}, "l": rod}
    joints = {"f": {"type": "free", "parent": "ground", "child": "a"}, "h": hinge}
    return simulate(
        load(
            {
                "model": {"in_space": True, "name": "tumbling", "bodies": bodies, "joints": joints},
                "medium": "rft3d_sand",
                "surface_height_m": 0,
                "initial": {"joints": {"f": start, "h": {"rate_rad_s": 5}}},
                "solver": {"end_time_s": 0.06, "step_s": 5e-4, "rest_time_s": None, "tolerance": 1e-10},
            }
        )
    )


def test_turning_and_mirroring_the_scene_turns_and_mirrors_the_result() -> None:
    turn = rotations.of_rpy([0.0, 0.0, 1.234])
    seen, turned, mirrored = tumbling(np.eye(3)), tumbling(turn), tumbling(np.eye(3), mirrored=True)
    where, path_turned, image = (
        columns(results, "l_x_m", "l_y_m", "l_z_m", at=seen["time_s"]) for results in (seen, turned, mirrored)
    )
    way = np.linalg.norm(np.diff(where, axis=0), axis=1).sum()
    # What Newton's method leaves of a step is another one in other axes: 1e-11 of the way by the tolerance above, 1e-7
    # by the usual one.
    assert np.abs(where @ turn.T - path_turned).max() < 1e-10 * way
    assert np.abs(seen["h_angle_deg"] - turned["h_angle_deg"]).max() < 1e-7
    # The mirror image of a face is not cut into the mirror images of its facets.
    assert np.abs(where * [1, -1, 1] - image).max() < 2e-3 * way
    assert seen["depth_m"].max() > 0.01
    assert np.ptp(seen["h_angle_deg"]) > 5.0
    assert seen.summary["energy"]["imbalance_relative"] < 1e-3


# ---- standing ----


def test_a_robot_stands_on_a_slope() -> None:
    """Settled on a slope of 10 degrees it carries its weight and stays, and Newton's method has little to do.

    20 s of it and other robots: validation/standing.py.
    """
    leg = {"type": "rigid", "density_kg_m3": 1200}
    leg["shapes"] = [{"type": "capsule", "diameter_m": 0.02, "start_m": [0, 0, 0], "end_m": [0, 0, -0.08]}]
    hips = {"fl": [0.08, 0.05, 0], "fr": [0.08, -0.05, 0], "rl": [-0.08, 0.05, 0], "rr": [-0.08, -0.05, 0]}
    bodies = {"seat": {"type": "rigid", "density_kg_m3": 800, "shapes": [{"type": "box", "size_m": [0.2, 0.12, 0.03]}]}}
    joints: dict[str, Any] = {"seat": {"type": "free", "parent": "ground", "child": "seat"}}
    for name, place in hips.items():
        bodies[name] = leg
        joints[name] = {"type": "hinge", "axis": [0, 1, 0], "parent": "seat", "child": name, "parent_point_m": place}
    hold = {"type": "pd", "angle_deg": 0, "gain_Nm_per_rad": 10, "rate_gain_Nm_s_per_rad": 0.05}
    run = {
        "model": {"in_space": True, "name": "stool", "bodies": bodies, "joints": joints},
        "medium": "rft3d_sand",
        "bed": {"slope_deg": 10, "slope_direction_deg": 30},
        "initial": {"settle": True},
        "drives": dict.fromkeys(hips, hold),
        "solver": {"end_time_s": 1, "accuracy": 1e-2},
    }
    results = simulate(load(run))
    path = np.column_stack([results[f"seat_{axis}_m"] for axis in "xyz"])
    assert np.linalg.norm(path[-1] - path[0]) < 1e-10  # 1 um/s is allowed
    # With bristles exactly at their yield it were 750 iterations and 280 Jacobians in this second, and ever more later.
    cost = results.summary["cost"]
    assert cost["newton_iterations"] <= 4 * cost["steps"]
    assert cost["jacobians"] < 60
    weight = build(load(run)).mass * 9.81
    force = [results[f"static_force_{axis}_N"][-1] for axis in "xyz"]
    np.testing.assert_allclose(force, [0.0, 0.0, weight], atol=1e-5 * weight)
    assert results["depth_m"][-1] > 1e-3


# ---- joints ----


ARM = {
    "name": "arm",
    "bodies": {
        "upper": {"type": "link", "length_m": 0.1, "diameter_m": 0.02, "density_kg_m3": 2000},
        "lower": {"type": "link", "length_m": 0.1, "diameter_m": 0.02, "density_kg_m3": 2000},
        "foot": {"type": "link", "length_m": 0.04, "diameter_m": 0.02, "density_kg_m3": 2000},
    },
    "joints": {
        "hip": {
            "type": "hinge",
            "parent": "ground",
            "child": "upper",
            "home_deg": 20,
            "spring": {"stiffness_Nm_per_rad": 0.3, "rest_deg": 30},
            "friction": {"torque_Nm": 0.01},
        },
        "knee": {
            "type": "hinge",
            "parent": "upper",
            "child": "lower",
            "stops": {"lower_deg": -10, "upper_deg": 20, "stiffness_Nm_per_rad": 30, "dissipation_s_per_rad": 0.1},
            "damping_Nm_s_per_rad": 1e-3,
        },
        "rail": {"type": "slider", "parent": "lower", "child": "foot", "axis": [1, 0], "damping_N_s_per_m": 0.2},
    },
}
DRIVES = {
    "hip": {"type": "pd", "angle_deg": 60, "gain_Nm_per_rad": 0.8, "rate_gain_Nm_s_per_rad": 0.01, "limit_Nm": 0.5},
    "rail": {"type": "motion", "position_m": {"type": "sine", "amplitude": 0.02, "frequency_Hz": 3, "offset": 0.1}},
}


def in_space(model: dict[str, Any]) -> dict[str, Any]:
    """The same model in the x-z plane of space: clockwise there is right-handed about y."""
    model = copy.deepcopy(model) | {"in_space": True}
    model["joints"]["knee"]["parent_point_m"] = [0.1, 0, 0]
    for joint in model["joints"].values():
        joint["axis"] = [0, 1, 0] if joint["type"] == "hinge" else [*joint["axis"], 0]
    return model


def test_joints_act_as_in_the_plane() -> None:
    """Spring, friction, stops, dampers, a control within its limit and a prescribed motion; in vacuum."""
    flat = copy.deepcopy(ARM)
    flat["joints"]["knee"]["parent_point_m"] = [0.1, 0]  # type: ignore[index]
    common = {"drives": DRIVES, "initial": {"joints": {"knee": {"rate_rad_s": 6}}}}
    solver = {"end_time_s": 0.4, "accuracy": 1e-3}
    planar, spatial = (simulate(load({"model": model, **common, "solver": solver})) for model in (flat, in_space(ARM)))
    at = np.linspace(0.0, 0.4, 80)
    for name in ("hip_angle_deg", "knee_angle_deg", "hip_torque_Nm", "rail_force_N", "spring_J", "friction_work_J"):
        values = columns(planar, name, at=at)
        # The reaction of a prescribed motion jumps where friction turns and stops are met, at other steps.
        close = (0.05 if name == "rail_force_N" else 0.01) * np.ptp(values)
        np.testing.assert_allclose(columns(spatial, name, at=at), values, atol=close, err_msg=name)
    assert np.ptp(planar["knee_angle_deg"]) > 20.0
    assert spatial.summary["energy"]["imbalance_relative"] < 1e-3
    assert np.abs(spatial["upper_y_m"]).max() < 1e-9


def test_a_loop_and_a_ball_joint_keep_their_energy() -> None:
    """A four-bar of hinges whose axes all lean, so that it moves in a plane of its own, with a pendulum on it."""
    bar = {"type": "link", "length_m": 0.1, "diameter_m": 0.01, "density_kg_m3": 1000}
    hinge = {"type": "hinge", "axis": [0, 1, 0], "parent_point_m": [0.1, 0, 0]}
    leaning = {"type": "hinge", "axis": [0, 1, 0], "parent": "ground", "rpy_deg": [20, 0, 0]}
    model = {
        "in_space": True,
        "name": "four_bar",
        "bodies": {"a": bar, "b": bar, "c": bar, "p": bar},
        "joints": {
            "one": leaning | {"child": "a", "home_deg": 90},
            "two": hinge | {"parent": "a", "child": "b", "home_deg": -90},
            "three": hinge | {"parent": "b", "child": "c", "home_deg": -90},
            "four": {"type": "ball", "parent": "b", "child": "p", "parent_point_m": [0.05, 0, 0]},
        },
        "closures": {"end": leaning | {"child": "c", "parent_point_m": [0.1, 0, 0], "child_point_m": [0.1, 0, 0]}},
    }
    start = {"one": {"angle_deg": 70, "rate_rad_s": 4}, "four": {"rpy_deg": [0, 60, 0], "spin_rad_s": [1, 0, 2]}}
    run = {"model": model, "initial": {"joints": start}, "solver": {"end_time_s": 0.3, "accuracy": 1e-3}}
    results = simulate(load(run))
    assert results.summary["energy"]["imbalance_relative"] < 1e-3
    np.testing.assert_allclose(results["one_angle_deg"] + results["two_angle_deg"], 0.0, atol=0.01)  # a parallelogram
    assert np.ptp(results["one_angle_deg"]) > 20.0


def jointed(joint: dict[str, Any], start: dict[str, Any], rpy: list[float], foot: list[float]) -> dict[str, Any]:
    """Two rods and a foot across the second one; the first swings on a hinge, the second on a joint. In vacuum."""
    bodies = copy.deepcopy(ARM["bodies"]) | {"foot": {"type": "link", "length_m": 0.04, "diameter_m": 0.02}}
    bodies["foot"]["density_kg_m3"] = 2000
    joints = {
        "hip": {"type": "hinge", "parent": "ground", "child": "upper", "axis": [0, 1, 0], "home_deg": 20},
        "knee": {"parent": "upper", "child": "lower", "parent_point_m": [0.1, 0, 0], "rpy_deg": rpy} | joint,
        "tail": {"type": "weld", "parent": "lower", "child": "foot", "parent_point_m": [0.1, 0, 0]} | {"rpy_deg": foot},
    }
    model = {"in_space": True, "name": "arm", "bodies": bodies, "joints": joints}
    solver = {"end_time_s": 0.4, "accuracy": 1e-3}
    return {"model": model, "initial": {"joints": {"knee": start}}, "solver": solver}


STIFF = {"spring": {"stiffness_Nm_per_rad": 0.3}, "damping_Nm_s_per_rad": 5e-4}
END = {"upper_deg": 15, "stiffness_Nm_per_rad": 20, "dissipation_s_per_rad": 0.1}
BALL = {"type": "ball", **STIFF, "stops": END}


def test_a_ball_joint_has_a_spring_a_damper_and_an_end_of_its_range() -> None:
    """About one axis it is a hinge with stops at both sides; about all of them its energy is accounted for."""
    hinge = {"type": "hinge", "axis": [0, 1, 0], **STIFF, "stops": END | {"lower_deg": -15}}
    hinged = simulate(load(jointed(hinge, {"rate_rad_s": 30}, [0, 0, 0], [0, 90, 0])))
    other = simulate(load(jointed(BALL, {"spin_rad_s": [0, 30, 0]}, [0, 0, 0], [0, 90, 0])))
    at = np.linspace(0.0, 0.4, 60)
    for name in ("hip_angle_deg", "spring_J", "joint_damping_work_J"):
        values = columns(hinged, name, at=at)
        np.testing.assert_allclose(columns(other, name, at=at), values, atol=0.01 * np.ptp(values), err_msg=name)
    np.testing.assert_allclose(
        columns(other, "knee_angle_deg", at=at), np.abs(columns(hinged, "knee_angle_deg", at=at)), atol=0.3
    )
    assert np.abs(hinged["knee_angle_deg"]).max() > 16.0
    spun = simulate(load(jointed(BALL, {"spin_rad_s": [30, 15, 20]}, [10, 40, -70], [0, 0, 90])))
    assert spun.summary["energy"]["imbalance_relative"] < 1e-3
    assert spun["knee_angle_deg"].max() > 16.0
    assert spun["joint_damping_work_J"][-1] < -1e-3


def test_forces_in_a_ball_joint_are_those_of_its_potential_and_its_damper() -> None:
    """In random states: -dV/dq of the angle's energy and no more at rest, and the power of the damper is -c w^2."""
    random, law = np.random.default_rng(8), JointLaw(stiffness=0.3, upper=0.4, stop_stiffness=2.0)
    run = jointed(BALL, {"spin_rad_s": [0, 0, 0]}, [10, 40, -70], [0, 0, 90])
    joint: Any = next(j for j in build(load(run)).joints if j.kind == "ball")
    for damping in (0.0, 0.02):
        s = SpatialCoordinate(joint, [0.0] * 14)
        fill(s.record, replace(law, damping=damping), None)
        places = np.repeat(np.arange(14)[:, None], 2, axis=1)[None]

        def energy(q: np.ndarray, s: SpatialCoordinate = s) -> float:
            angle = s.at(q.tolist(), [0.0] * 14)[0]
            return 0.5 * law.stiffness * angle**2 + 0.5 * law.stop_stiffness * max(0.0, angle - law.upper) ** 2

        for _ in range(4):
            e = [rotations.quaternion_of(rotations.of_quaternion(random.normal(size=4))) for _ in range(2)]
            spins = random.normal(size=(2, 3)) * (damping > 0.0)
            q = np.concatenate([random.normal(size=3), e[0], random.normal(size=3), e[1]])
            rates = [
                0.5 * np.array([-w @ p[1:], *(p[0] * w + np.cross(w, p[1:]))]) for w, p in zip(spins, e, strict=True)
            ]
            v, f = np.concatenate([np.zeros(3), rates[0], np.zeros(3), rates[1]]), np.zeros(14)
            joint_loads.force(s.record, np.zeros(1, joint_loads.STATE), places, q, v, f)
            moved = [q + 1e-6 * unit for unit in np.eye(14)], [q - 1e-6 * unit for unit in np.eye(14)]
            slope = np.array([energy(a) - energy(b) for a, b in zip(*moved, strict=True)]) / 2e-6
            for unit, at in zip(e, (slice(3, 7), slice(10, 14)), strict=True):
                slope[at] -= unit @ slope[at] * unit  # along it a quaternion is no rotation
            w = spins[1] - spins[0]
            assert (f + slope) @ v == pytest.approx(-damping * w @ w, abs=1e-6)
            if damping == 0.0:
                np.testing.assert_allclose(f, -slope, atol=1e-6)
                assert np.abs(f).max() > 0.1


def test_power_between_elements_is_that_of_energy_and_damping() -> None:
    """Of both engines, at any angle: their power is -d/dt (K t^2 + k s^2) / 2 - D t'^2 - d s'^2, t the rotation vector.

    s: how far the child's point is from the parent's, along x of the joint. Rates by differences of a rigid motion.
    """
    random = np.random.default_rng(2)
    soft = {"youngs_modulus_Pa": 1e6, "elements": 2, "axial_stiffness_N": 1.0}
    rod = ARM["bodies"]["upper"] | {"flexible": soft}
    made: Any = build(load({"model": one_body("rod", rod, "a", "weld")}))
    K, D, (k, d) = np.array([0.3, 0.5, 0.2]), np.array([0.02, 0.01, 0.03]), (4.0, 0.7)
    P, C = rotations.of_rpy([0.3, -0.5, 0.9]), rotations.of_rpy([-0.2, 0.4, 0.1])
    law = replace(made.joints[-1].elastic, stiffness=K, damping=D, axial=(k, d))
    joint = replace(made.joints[-1], elastic=law, parent="one", parent_turn=P, child_turn=C)
    places = np.repeat(np.arange(14)[:, None], 2, axis=1)[None]
    node = np.zeros(1, SPACE_NODE)[0]
    node["before"], node["bends"], node["damps"] = rotations.quaternion_of(P), K, D
    for angle in (0.005, 0.4, 2.5):
        t = random.normal(size=3)
        parent, points, speeds = rotations.of_quaternion(random.normal(size=4)), *random.normal(size=(2, 2, 3))
        child = parent @ P @ rotations.of_vector(t * angle / np.linalg.norm(t)) @ C.T
        spins = random.normal(size=(2, 3))

        def at(h: float) -> tuple[np.ndarray, np.ndarray, float]:
            """Coordinates, rotation vector and how far the points are apart after a motion for a short time."""
            turns = [rotations.of_vector(h * w) @ R for w, R in zip(spins, (parent, child), strict=True)]  # noqa: B023
            x = points + h * speeds  # noqa: B023
            q = np.concatenate([[*x[i], *rotations.quaternion_of(turns[i])] for i in (0, 1)])
            apart = x[1] + turns[1] @ joint.child_point - x[0] - turns[0] @ joint.parent_point
            vector = Rotation.from_matrix((turns[0] @ P).T @ turns[1] @ C).as_rotvec()
            return q, vector, float((turns[0] @ P)[:, 0] @ apart)

        (q, theta, s), after, before = at(0.0), at(1e-6), at(-1e-6)
        v, rate, speed = ((a - b) / 2e-6 for a, b in zip(after, before, strict=True))
        for kind, axial in (("elastic", 0.0), ("stretching", (k * s + d * speed) * speed)):
            f, element = np.zeros(14), SpatialCoordinate(replace(joint, kind=kind), [0.0] * 14)
            joint_loads.force(element.record, np.zeros(1, joint_loads.STATE), places, q, v, f)
            assert f @ v == pytest.approx(-(K * theta + D * rate) @ rate - axial, rel=1e-6)
        turn, w = P @ theta, parent.T @ (spins[1] - spins[0])
        moment = np.array(called(space_ball_joints.elastic)(tuple(turn), tuple(w), node))
        assert moment @ w == pytest.approx(-(K * theta + D * rate) @ rate, rel=1e-6)


@pytest.mark.parametrize("kind", ["hinge", "slider"])
def test_the_gradient_of_a_coordinate_is_its_derivative(kind: str) -> None:
    """In random states that the joint allows; the rate is the gradient times the rates."""
    random = np.random.default_rng(4)
    model = in_space(ARM)
    model["joints"]["knee"] |= {"type": kind, "axis": [1, 2, 3], "rpy_deg": [10, 20, 30]}
    for key in ("stops", "damping_Nm_s_per_rad"):
        model["joints"]["knee"].pop(key)
    joint: Any = build(load({"model": model})).joints[1]
    s = SpatialCoordinate(joint, [0.0] * 14)
    for _ in range(5):
        parent, child = rotations.of_quaternion(random.normal(size=4)), rotations.of_quaternion(random.normal(size=4))
        spins = list(random.normal(size=(2, 3)))
        if kind == "hinge":  # the axes of both stay together
            child = parent @ joint.parent_turn @ rotations.of_rpy([0, 0, 0.7]) @ joint.child_turn.T
            spins[1] = spins[0] + 2.3 * parent @ joint.parent_turn[:, 2]
        places, speeds = random.normal(size=(2, 3)), random.normal(size=(2, 3))

        def at(t: float) -> np.ndarray:
            """Coordinates after a motion of both bodies for a short time."""
            turns = [rotations.of_vector(t * w) @ R for w, R in zip(spins, (parent, child), strict=True)]  # noqa: B023
            return np.concatenate([[*places[i] + t * speeds[i], *rotations.quaternion_of(turns[i])] for i in (0, 1)])  # noqa: B023

        v = (at(1e-6) - at(-1e-6)) / 2e-6
        moved = [s.at(at(t).tolist(), v.tolist())[0] for t in (1e-6, -1e-6)]
        _, rate, slope = s.at(at(0.0).tolist(), v.tolist())
        assert rate == pytest.approx((moved[0] - moved[1]) / 2e-6, rel=1e-5)
        assert rate == pytest.approx(np.dot(slope, v), rel=1e-12)
        assert kind == "slider" or rate == pytest.approx(2.3, rel=1e-5)


def test_penetration_ends_where_the_lower_end_stops_falling() -> None:
    """Of a ball that is thrown askew and rolls as it sinks: within two steps of where its path is lowest."""
    sphere = {"type": "sphere", "diameter_m": 0.03, "facet_size_m": 0.004}
    model = one_body("ball", {"type": "rigid", "density_kg_m3": 2000, "shapes": [sphere]})
    start = {"joints": {"flight": {"z_m": 0.02, "vx_m_s": 0.5, "vy_m_s": 0.4, "vz_m_s": -1}}}
    run = {"model": model, "medium": "rft3d_sand", "surface_height_m": 0, "initial": start}
    results = simulate(load(run | {"solver": {"end_time_s": 0.02, "step_s": 1e-4}}))
    lowest = results["time_s"][np.flatnonzero(np.diff(results["tip_z_m"]) >= 0.0)[0]]
    end_time = results.summary["touch_time_s"] + results.summary["penetration_time_s"]
    assert end_time == pytest.approx(lowest, abs=2e-4)
    assert 0.005 < results.summary["penetration_time_s"] < 0.01
