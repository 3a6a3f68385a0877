# ruff: noqa: E501  (a body or a joint a line)
"""A robot file as a model: the same mechanism as in YAML, poses as of another reader, faults at the lines of the file."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_refusals import CONFIG_OR_SCENE, faults_of
from support_robot import block, robot_in, stl

from granular_contact import config, scene
from granular_contact.errors import ConfigError

DEGREE = np.pi / 180.0


def inertia(moment: float) -> dict[str, float]:
    return {"xx": moment, "yy": moment, "zz": moment, "xy": 1e-5}


# The robot of support_robot.py; its massless base is where the trunk is fixed to it.
ARM: dict[str, Any] = {
    "in_space": True,
    "name": "arm",
    "bodies": {
        "base": {
            "type": "rigid",
            "mass_kg": 2,
            "center_of_mass_m": [0, 0, 0.1],
            "inertia_kg_m2": {"xx": 1e-3 - 1e-5 * np.sin(1), "yy": 1e-3 + 1e-5 * np.sin(1), "zz": 1e-3, "xy": 1e-5 * np.cos(1)},
            "shapes": [{"type": "box", "size_m": [0.2, 0.1, 0.05], "center_m": [0, 0, 0.1], "rpy_deg": [0, 0, 0.5 / DEGREE]}],
        },
        "leg": {
            "type": "rigid",
            "mass_kg": 0.5,
            "inertia_kg_m2": inertia(1e-3),
            "shapes": [{"type": "cylinder", "diameter_m": 0.04, "length_m": 0.2, "center_m": [0, 0, -0.1],
                        "rpy_deg": [0.1 / DEGREE, 0.2 / DEGREE, 0.3 / DEGREE]}],
        },
        "foot": {
            "type": "rigid",
            "mass_kg": 0.1,
            "inertia_kg_m2": inertia(5e-5),
            "shapes": [{"type": "mesh", "file": "meshes/foot.stl", "scale": 0.001}],
        },
        "wheel": {
            "type": "rigid",
            "mass_kg": 0.2,
            "inertia_kg_m2": inertia(2e-4),
            "shapes": [{"type": "sphere", "diameter_m": 0.1}],
        },
    },
    "joints": {
        "base": {"type": "free", "parent": "ground", "child": "base"},
        "hip": {
            "type": "hinge", "parent": "base", "child": "leg",
            "parent_point_m": [0.1 * np.cos(0.5) - 0.05 * np.sin(0.5), 0.1 * np.sin(0.5) + 0.05 * np.cos(0.5), 0.1],
            "rpy_deg": [0.3 / DEGREE, -0.2 / DEGREE, 0.6 / DEGREE], "axis": [0, 1, 0],
            "damping_Nm_s_per_rad": 0.01, "friction": {"torque_Nm": 0.02},
            "stops": {"lower_deg": -1 / DEGREE, "upper_deg": 0.5 / DEGREE, "stiffness_Nm_per_rad": 2 / DEGREE},
            "effort_limit_Nm": 2, "rate_limit_rad_s": 5,
        },
        "slide": {
            "type": "slider", "parent": "leg", "child": "foot", "parent_point_m": [0, 0, -0.2], "axis": [0, 0, -1],
            "stops": {"lower_m": 0, "upper_m": 0.05, "stiffness_N_per_m": 2e4},
            "effort_limit_N": 20, "speed_limit_m_s": 1,
        },
        "axle": {
            "type": "hinge", "parent": "base", "child": "wheel", "axis": [1, 0, 0],
            "parent_point_m": [-0.1 * np.cos(0.5), -0.1 * np.sin(0.5), 0.1], "rpy_deg": [90, 0, 0.5 / DEGREE],
        },
    },
}  # fmt: skip
RUN: dict[str, Any] = {
    "medium": "rft3d_sand",
    "initial": {
        "joints": {
            "base": {"x_m": 0.1, "z_m": 0.3, "rpy_deg": [10, 20, 30], "vx_m_s": 1},
            "hip": {"angle_deg": -20, "rate_rad_s": 2},
            "slide": {"position_m": 0.03},
            "axle": {"angle_deg": 50},
        }
    },
    "drives": {"axle": {"type": "torque", "torque_Nm": 0.1}},
}


def run_of(path: Path, **model: Any) -> dict[str, Any]:
    return {**copy.deepcopy(RUN), "model": {"urdf": str(path), **model}}


def numbers(value: Any, path: str = "") -> dict[str, Any]:
    """All leaves of a nested value, by their path."""
    if isinstance(value, dict):
        return {k: v for key, held in value.items() for k, v in numbers(held, f"{path}.{key}").items()}
    if isinstance(value, list | tuple):
        return {k: v for i, held in enumerate(value) for k, v in numbers(held, f"{path}.{i}").items()}
    return {path: value}


def same(first: Any, second: Any) -> None:
    """Both have the same leaves; zero turns may be left out."""
    given, wanted = (
        {path: held for path, held in numbers(each.model_dump()).items() if held not in (None, 0.0)}
        for each in (first, second)
    )
    assert given.keys() == wanted.keys()
    for path, held in given.items():
        assert held == (pytest.approx(wanted[path], rel=1e-12) if isinstance(held, float) else wanted[path]), path


def test_a_urdf_is_the_same_mechanism_as_in_yaml(tmp_path: Path) -> None:
    path = robot_in(tmp_path)
    model = copy.deepcopy(ARM)
    model["bodies"]["foot"]["shapes"][0]["file"] = str(tmp_path / "meshes" / "foot.stl")
    from_file, by_hand = config.load(run_of(path)), config.load({**copy.deepcopy(RUN), "model": model})
    same(from_file.scenario.model, by_hand.scenario.model)
    for first, second in zip(scene.build(from_file).rigid, scene.build(by_hand).rigid, strict=True):
        assert first.name == second.name
        np.testing.assert_allclose(first.inertia, second.inertia, rtol=1e-12, atol=1e-18)
        np.testing.assert_allclose(first.parts[0].triangles, second.parts[0].triangles, rtol=0, atol=1e-15)


@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (-0.7, 0.02, 1.3)])
def test_links_stand_where_another_reader_puts_them(tmp_path: Path, angles: tuple[float, float, float]) -> None:
    mujoco = pytest.importorskip("mujoco")
    path = robot_in(tmp_path)
    bodies_kept = '<mujoco><compiler fusestatic="false" strippath="false"/></mujoco></robot>'
    model = mujoco.MjModel.from_xml_path(str(robot_in(tmp_path / "other", ("</robot>", bodies_kept))))
    other = mujoco.MjData(model)
    for joint, value in zip(("hip", "slide", "axle"), angles, strict=True):
        other.joint(joint).qpos = value
    mujoco.mj_kinematics(model, other)
    states = {
        "base": {},
        "hip": {"angle_deg": angles[0] / DEGREE},
        "slide": {"position_m": angles[1]},
        "axle": {"angle_deg": angles[2] / DEGREE},
    }
    loaded = config.load({"model": {"urdf": str(path)}, "medium": None, "initial": {"joints": states}})
    built = scene.build(loaded)
    for body, name in zip(built.rigid, ("base", "leg", "foot", "wheel"), strict=True):
        turned, pose = other.body(name).xmat.reshape(3, 3), body.motion
        link = loaded.scenario.model.bodies[name]
        center = turned @ (link.center_of_mass_m or (0, 0, 0)) + other.body(name).xpos
        np.testing.assert_allclose(pose.position, center, atol=1e-12)
        np.testing.assert_allclose(pose.rotation, turned, atol=1e-12)


def faults(run: dict[str, Any]) -> list[str]:
    return [str(fault) for fault in faults_of(CONFIG_OR_SCENE, lambda: scene.build(config.load(run)))]


HIP_LIMIT = '<limit lower="-1" upper="0.5" effort="2" velocity="5"/>'
MIMIC = (HIP_LIMIT, f'{HIP_LIMIT}<mimic joint="axle"/>')
PLANAR = ('"axle" type="continuous"', '"axle" type="planar"')


def test_faults_stand_at_the_lines_of_the_robot_file(tmp_path: Path) -> None:
    path = robot_in(tmp_path, ("meshes/foot.stl", "x.stl"), MIMIC, PLANAR)
    lines = faults(run_of(path))
    assert [line.split(": ")[0].removeprefix(str(tmp_path)) for line in lines] == [
        f"/arm.urdf:{n}" for n in (6, 10, 12)
    ]
    assert "joint.axle.type: planar is not supported" in lines[2]
    robot_in(tmp_path)
    stl(tmp_path / "meshes" / "foot.stl", block((60, 40, 20))[2:])
    (line,) = faults(run_of(path))
    assert line.startswith(f"{path}:6: model.bodies.foot.shapes.0.file: it is open: 4 edges")
    assert len(scene.build(config.load(run_of(path, in_sand=["leg"]))).rigid) == 4  # the mesh is drawn, and no more
    robot_in(tmp_path)
    (line,) = faults({**run_of(path), "drives": {"knee": {"type": "torque", "torque_Nm": 1}}})
    assert "there is no joint 'knee'" in line
    (line,) = faults(run_of(tmp_path / "none.urdf"))
    assert line.endswith("none.urdf no such file")


ASKED = [
    ({"in_sand": ["foots"]}, "model.in_sand.0: there is no link 'foots'; did you mean foot?"),
    ({"in_sand": ["sens*"]}, "model.in_sand.0: sensor: no collision shape for the medium to act on"),
    ({"fix": ["knee"]}, "model.fix.0: there is no joint 'knee'"),
    ({"base": "loose"}, "model.base: got the text 'loose'; allowed is one of free, fixed"),
    ({"insand": ["foot"]}, "model.insand: unknown key; did you mean in_sand?"),
    (
        {"stops": {"stiffness_Nm_per_rad": -1}},
        "model.stops.stiffness_Nm_per_rad: got the number -1; allowed is a finite",
    ),
    ({"joints": {"hip": {"damping": 1}}}, "model.joints.hip.damping: unknown key"),
]


@pytest.mark.parametrize(("model", "message"), ASKED)
def test_requests_of_a_model_to_a_robot_file_are_checked(tmp_path: Path, model: dict[str, Any], message: str) -> None:
    (line,) = faults(run_of(robot_in(tmp_path), **model))
    assert message in line


def loaded(path: Path, **model: Any) -> Any:
    return config.load({"model": {"urdf": str(path), **model}, "medium": "rft3d_sand"}).scenario.model


def test_options_of_a_robot_file_reach_the_model(tmp_path: Path) -> None:
    path = robot_in(tmp_path)
    model = loaded(
        path,
        in_sand=["f*"],
        facet_size_m=0.01,
        fix=["hip"],
        stops={"stiffness_N_per_m": 500, "dissipation_s_per_m": 0.1},
        base="fixed",
        joints={"axle": {"damping_Nm_s_per_rad": 0.5}},
        name="other",
    )
    assert {name: body.shapes[0].in_sand for name, body in model.bodies.items()} == {
        "trunk": False, "leg": False, "foot": True, "wheel": False
    }  # fmt: skip
    assert model.bodies["foot"].shapes[0].facet_size_m == 0.01
    assert model.name == "other"
    assert {name: joint.type for name, joint in model.joints.items()} == {
        "bolt": "weld", "hip": "weld", "slide": "slider", "axle": "hinge"
    }  # fmt: skip
    assert model.joints["slide"].stops.stiffness_N_per_m == 500
    assert model.joints["axle"].damping_Nm_s_per_rad == 0.5
    assert loaded(robot_in(tmp_path, MIMIC), mimic="ignore").joints["hip"].type == "hinge"
    assert loaded(robot_in(tmp_path, PLANAR), fix=["axle"]).joints["axle"].type == "weld"
    mirrored = loaded(robot_in(tmp_path, ("0.001 0.001 0.001", "0.001 -0.001 0.001")))
    assert mirrored.bodies["foot"].shapes[0].scale == (0.001, -0.001, 0.001)
    (part,) = scene.build(config.load(run_of(path))).body("foot").parts
    assert np.einsum("ij,ij->", part.triangles[:, 0], np.cross(part.triangles[:, 1], part.triangles[:, 2])) > 0


def test_a_link_called_world_is_the_ground(tmp_path: Path) -> None:
    worlds = [('<link name="base"/>', '<link name="world"/>'), ('<parent link="base"/>', '<parent link="world"/>')]
    path = robot_in(tmp_path, *worlds)
    model = loaded(path)
    assert model.joints["bolt"].type == "weld"
    assert model.joints["bolt"].parent == "ground"
    assert [*model.bodies] == ["trunk", "leg", "foot", "wheel"]
    floating = loaded(robot_in(tmp_path, *worlds, ('"bolt" type="fixed"', '"bolt" type="floating"')))
    assert floating.joints["bolt"].type == "free"
    (line,) = faults(run_of(robot_in(tmp_path, *worlds), base="free"))
    assert "model.base: got free, but the root link world" in line


def test_names_that_no_mechanism_can_have_are_changed(tmp_path: Path) -> None:
    path = robot_in(
        tmp_path,
        ('<link name="foot">', '<link name="left foot.1">'),
        ('<child link="foot"/>', '<child link="left foot.1"/>'),
    )
    assert "left_foot_1" in loaded(path).bodies
    path = robot_in(tmp_path, ('name="slide"', 'name="hip."'), ('name="axle"', 'name="hip:"'))
    assert any("joints.hip:: is written as hip_ here, as is another name" in line for line in faults(run_of(path)))


def test_a_mass_in_a_point_is_part_of_the_body_that_it_is_fixed_to(tmp_path: Path) -> None:
    point = '<inertial><mass value="0.5"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial>'
    with_mass = ('<link name="sensor">', f'<link name="sensor">{point}')
    leg = config.load({"model": {"urdf": str(robot_in(tmp_path, with_mass))}}).scenario.model.bodies["leg"]
    assert leg.mass_kg == pytest.approx(1.0)
    # Half of the mass in the leg's origin, half 0.1 m below: Steiner adds 2 x 0.5 x 0.05^2 across.
    assert leg.center_of_mass_m == pytest.approx((0.0, 0.0, -0.05))
    assert leg.inertia_kg_m2.xx == pytest.approx(1e-3 + 2.5e-3)
    assert leg.inertia_kg_m2.zz == pytest.approx(1e-3)
    turning = ('"mount" type="fixed"', '"mount" type="continuous"')
    with pytest.raises(ConfigError, match=r"moves by the joint mount \(continuous\) and has no moment of inertia"):
        config.load({"model": {"urdf": str(robot_in(tmp_path, with_mass, turning))}})


def test_a_joint_without_limits_is_reported(tmp_path: Path) -> None:
    path = robot_in(tmp_path, ('lower="-1" upper="0.5" effort', "effort"))
    with pytest.raises(ConfigError, match=r"hip.limit.lower: is missing, and so is upper, so that by URDF both are 0"):
        config.load({"model": {"urdf": str(path)}})
