"""Beds in space from YAML: layers, floor and container, their effect in a run, and their faults."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from support_models import one_body
from support_refusals import CONFIG_OR_SCENE, message_of

from granular_contact import load, simulate
from granular_contact.errors import SceneError
from granular_contact.report.figures.space_views import _ground
from granular_contact.report.units import unit_for
from granular_contact.results.motion import Bedding, motion_of, of_plain, plain
from granular_contact.run import run as solved
from granular_contact.scene import build

BALL = {"type": "sphere", "diameter_m": 0.06}
START = {"x_m": 0.1, "y_m": -0.05, "z_m": 0.03, "vx_m_s": 0.4, "vy_m_s": -0.3, "vz_m_s": -1.5}
IDLE = {"law": "bingham", "yield_force_N": 0, "viscosity_N_s_m": 0.5}


def run(bed: dict[str, Any], shape: dict[str, Any] = BALL, **given: Any) -> dict[str, Any]:
    """A body of 0.5 kg that begins at the surface and moves ahead and to the right."""
    inertia = {"xx": 2e-4, "yy": 2e-4, "zz": 2e-4}
    body = {"type": "rigid", "mass_kg": 0.5, "inertia_kg_m2": inertia, "shapes": [shape]}
    return {
        "model": one_body("b", body),
        "medium": "rft3d_sand",
        "bed": {"height_m": 0.0, **bed},
        "initial": {"joints": {"flight": START}},
        "solver": {"end_time_s": 0.3, "accuracy": 1e-2, "rest_time_s": None},
    } | given


@pytest.mark.parametrize("medium", [IDLE, {"from": "rft3d_sand", "density_kg_m3": 1e-6}], ids=["whole", "facets"])
def test_a_ball_rests_on_a_floor_at_the_depth_of_its_springs(medium: Any) -> None:
    """pi R k delta^2 = m g; without friction it slides on, and the sand that hardly is there bears nothing."""
    stiffness, radius = 1e6, 0.03
    bed = {"depth_m": 0.02, "floor": {"stiffness_N_m3": stiffness, "damping_s_m": 10}}
    results = simulate(load(run(bed, {**BALL, "facet_size_m": 0.004}, medium=medium)))
    delta = np.sqrt(0.5 * 9.81 / (np.pi * radius * stiffness))
    assert radius - results["b_z_m"][-1] - 0.02 == pytest.approx(delta, rel=5e-3)
    assert results["floor_force_z_N"][-1] == pytest.approx(0.5 * 9.81, rel=5e-3)
    assert not results["floor_force_x_N"].any()
    assert results.summary["energy"]["imbalance_relative"] < 1e-3
    assert results["floor_work_J"][-1] < -0.05
    assert any("the floor was reached" in warning and "its contact carried" in warning for warning in results.warnings)


def test_walls_are_watched_and_a_floor_without_a_contact_is_reported() -> None:
    """How far the immersed part of a ball reached follows from where its middle was."""
    bed = {"depth_m": 0.01, "container_x_m": [0.0, 0.12], "container_y_m": [-0.06, 0.2]}
    results = simulate(load(run(bed, {**BALL, "facet_size_m": 0.004})))
    deep = results["depth_m"] > 0.0
    far = np.sqrt(0.03**2 - np.maximum(0.0, 0.03 - results["depth_m"][deep]) ** 2)
    x, y = (results["b_x_m"][deep] + far).max(), (results["b_y_m"][deep] - far).min()
    walls = [warning for warning in results.warnings if "wall of the container" in warning]
    for (name, beyond), wall in zip((("front", x - 0.12), ("right", -0.06 - y)), walls, strict=True):
        assert wall.startswith(f"the {name} wall of the container was passed by ")
        assert float(wall.split(" by ")[1].split()[0]) == pytest.approx(beyond, abs=1e-3)  # of facets of 4 mm
    assert any("the floor was reached" in warning and "exerts no force" in warning for warning in results.warnings)


def test_layers_floor_and_walls_are_drawn_and_saved() -> None:
    layers = [{"top_m": 0.004, "medium": {"from": "rft3d_sand", "density_kg_m3": 3000}}]
    bed = {"depth_m": 0.3, "layers": layers, "container_x_m": [-0.1, 0.12], "container_y_m": [-0.2, 0.2]}
    solver = {"end_time_s": 0.01, "step_s": 1e-3, "rest_time_s": None}
    scenario = load(run(bed, solver=solver)).scenario
    motion = motion_of(solved(build(scenario), scenario, most_frames=3))
    assert motion is not None
    assert motion.bedding == Bedding((0.004,), -0.3, ((0, -0.1), (0, 0.12), (1, -0.2), (1, 0.2)))
    assert of_plain(plain(motion)).bedding == motion.bedding
    low, high = np.array([-0.2, -0.3, -0.4]), np.array([0.2, 0.3, 0.1])
    for across, walls in ((0, [-100.0, 120.0]), (1, [-200.0, 200.0])):
        axes = Figure().add_subplot()
        _ground(axes, motion, across, low, high, unit_for(high - low, "m"))
        upright = [line.get_xdata()[0] for line in axes.lines if np.ptp(line.get_xdata()) == 0.0]
        np.testing.assert_allclose(upright, walls)
        dashed = [line for line in axes.lines if line.is_dashed()]
        np.testing.assert_allclose([line.get_ydata() for line in dashed], [[-4.0, -4.0]], atol=1e-6)
        (floor,) = axes.patches
        assert floor.get_y() + floor.get_height() == pytest.approx(-300.0)


def test_a_layer_follows_the_slope_and_the_height_map(tmp_path: Any) -> None:
    """A map of a slope and the slope give one motion; without the harder layer it is another."""
    x, _ = np.meshgrid(-0.5 + 0.1 * np.arange(11), np.arange(11))
    np.savetxt(tmp_path / "ground.csv", 0.1 * x, delimiter=",")
    layers = {"layers": [{"top_m": 0.002, "medium": {"from": "rft3d_sand", "density_kg_m3": 5000}}]}
    slope = {"slope_deg": float(np.degrees(np.arctan(0.1)))}
    grid = {"file": str(tmp_path / "ground.csv"), "cell_m": 0.1, "corner_m": [-0.5, -0.5]}
    solver = {"end_time_s": 0.03, "step_s": 1e-3, "rest_time_s": None}
    shape = {"type": "box", "size_m": [0.06, 0.05, 0.04], "facet_size_m": 0.02}
    turned = {"initial": {"joints": {"flight": START | {"z_m": 0.05, "rpy_deg": [20, 35, 10]}}}}
    paths = []
    for bed in (slope | layers, {"height_map": grid} | layers, slope):
        results = simulate(load(run(bed, shape, solver=solver, **turned)))
        paths.append(np.column_stack([results[f"b_{axis}_m"] for axis in "xyz"]))
    np.testing.assert_allclose(paths[1], paths[0], atol=1e-9)
    assert paths[2][-1, 2] < paths[0][-1, 2] - 1e-3


HARD = {"top_m": 0.05, "medium": "rft3d_sand"}
FAULTS: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "per length": ({"depth_m": 1, "floor": {"stiffness_N_m2": 1e6}}, {}, "bed.floor.stiffness_N_m2: is per length"),
    "height of a floor": (
        {"floor": {"stiffness_N_m3": 1e6, "height_m": -0.1}},
        {},
        "bed.floor.height_m: a floor has a depth below the surface",
    ),
    "profile": ({"profile_m": [[0, 0], [1, 0]]}, {}, "bed.profile_m: is for the plane; in space a surface is level"),
    "no depth": ({"floor": {"stiffness_N_m3": 1e6}}, {}, "bed.floor: a stiff floor needs depth_m"),
    "walls": ({"container_y_m": [1, -1]}, {}, "bed.container_y_m: got [1.0, -1.0]; the first must be less"),
    "order": ({"layers": [HARD, HARD]}, {}, "bed.layers.1.top_m: got 0.05, which is not below the layer above it"),
    "under the floor": ({"layers": [HARD], "depth_m": 0.04}, {}, "bed.layers.0.top_m: got 0.05, but the floor is at"),
    "floor above": ({"depth_m": 0.01}, {"initial": {}}, "bed.depth_m: got 0.01 m, so the floor is at -0.01 m, but at"),
    "no medium": ({"container_x_m": [-1, 1]}, {"medium": None}, "bed.container_x_m: got a container, but no medium"),
    "law of bars": (
        {"layers": [{"top_m": 0.1, "medium": "play_sand"}]},
        {},
        "layers.0.medium: the sphere of b may get",
    ),
    "ball": ({"layers": [{"top_m": 0.1, "medium": IDLE}]}, {"medium": IDLE}, "bed.layers: a sphere is met as a whole"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_name_their_key(name: str) -> None:
    bed, given, message = FAULTS[name]
    assert message in message_of(CONFIG_OR_SCENE, lambda: build(load(run(bed, **given))))


def test_a_map_below_the_floor_is_reported(tmp_path: Any) -> None:
    np.savetxt(tmp_path / "ground.csv", np.outer([0.0, -0.1, 0.0], np.ones(3)), delimiter=",")
    bed = {"depth_m": 0.05, "height_map": {"file": str(tmp_path / "ground.csv"), "cell_m": 1.0, "corner_m": [0, 1]}}
    with pytest.raises(SceneError, match=r"the map of heights goes down to -0\.1 m: allowed is a floor below it"):
        build(load(run(bed)))
