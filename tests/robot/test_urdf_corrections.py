"""Keys beside `urdf` correct the robot file; without them it is refused as before."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_refusals import faults_of
from support_robot import robot_in

from granular_contact import config, scene
from granular_contact.errors import ConfigError, SceneError

HIP_LIMIT = '<limit lower="-1" upper="0.5" effort="2" velocity="5"/>'
SLIDE_LIMIT = '<limit lower="0" upper="0.05" effort="20" velocity="1"/>'
LEG_MASS, FOOT_MASS = '<mass value="0.5"/>', '<mass value="0.1"/>'
LEG_INERTIA = f'{LEG_MASS}<inertia ixx="1e-3"'
TRUNK_MASS = '<mass value="2"/>'
STOPS = {"lower_deg": -20, "upper_deg": 30}
MOMENTS = {"xx": 2e-3, "yy": 2e-3, "zz": 3e-3}
BALL = {"type": "sphere", "diameter_m": 0.1}
WHOLE = {"mass_kg": 0.4, "inertia_kg_m2": MOMENTS}
# What is changed in the file, and the keys that put it right.
RIGHTED: dict[str, tuple[list[tuple[str, str]], dict[str, Any]]] = {
    "no limit": ([(HIP_LIMIT, "")], {"joints": {"hip": {"stops": STOPS}}}),
    "limit without ends": ([(HIP_LIMIT, '<limit effort="2"/>')], {"joints": {"hip": {"stops": STOPS}}}),
    "limit of words": ([(HIP_LIMIT, '<limit lower="a" upper="b"/>')], {"joints": {"hip": {"stops": STOPS}}}),
    "limit the wrong way": ([(HIP_LIMIT, '<limit lower="1" upper="-1"/>')], {"joints": {"hip": {"stops": STOPS}}}),
    "no stops": ([(HIP_LIMIT, "")], {"joints": {"hip": {"stops": None}}}),
    "no limit of a slider": ([(SLIDE_LIMIT, "")], {"joints": {"slide": {"stops": {"lower_m": -0.1, "upper_m": 0.1}}}}),
    "axis": ([('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>')], {"joints": {"hip": {"axis": [0, 1, 0]}}}),
    "damping": ([('damping="0.01"', 'damping="-1"')], {"joints": {"hip": {"damping_Nm_s_per_rad": 0.1}}}),
    "no mass": ([(LEG_MASS, "")], {"bodies": {"leg": {"mass_kg": 0.4}}}),
    "negative mass": ([(LEG_MASS, '<mass value="-1"/>')], {"bodies": {"leg": {"mass_kg": 0.4}}}),
    "impossible inertia": (
        [(LEG_INERTIA, f'{LEG_MASS}<inertia ixx="9"')], {"bodies": {"leg": {"inertia_kg_m2": MOMENTS}}}
    ),
    "no inertial": ([(FOOT_MASS, '<mass value="0"/>')], {"bodies": {"foot": WHOLE}}),
    "shapes": ([("meshes/foot.stl", "lost.stl")], {"bodies": {"foot": {"shapes": [BALL]}}}),
}  # fmt: skip


def load(path: Path, **model: Any) -> Any:
    loaded = config.load({"model": {"urdf": str(path), **model}, "medium": "rft3d_sand"})
    return loaded.scenario.model, scene.build(loaded)


@pytest.mark.slow
@pytest.mark.parametrize("name", RIGHTED)
def test_keys_beside_a_robot_file_correct_it(tmp_path: Path, name: str) -> None:
    changes, keys = RIGHTED[name]
    path = robot_in(tmp_path, *changes)
    with pytest.raises((ConfigError, SceneError)):
        load(path)
    model, built = load(path, **keys)
    plain, _ = load(robot_in(tmp_path / "plain"))
    # All else is as in the faultless file.
    for kind in ("bodies", "joints"):
        assert [*getattr(model, kind)] == [*getattr(plain, kind)]
        changed = keys.get(kind, {})
        for part in getattr(model, kind):
            if part not in changed and not (name == "no inertial" and part == "foot"):
                assert getattr(model, kind)[part].type == getattr(plain, kind)[part].type
    if name.endswith("mass"):
        assert built.body("leg").mass == pytest.approx(0.4)
        assert model.bodies["leg"].inertia_kg_m2 == plain.bodies["leg"].inertia_kg_m2
    if name == "impossible inertia":
        np.testing.assert_allclose(np.linalg.eigvalsh(built.body("leg").inertia), [2e-3, 2e-3, 3e-3], rtol=1e-12)
        assert built.body("leg").mass == 0.5
    if name == "no inertial":
        assert built.body("foot").mass == 0.4


def test_the_stops_are_those_given_and_as_stiff_as_the_file_has_it(tmp_path: Path) -> None:
    path = robot_in(tmp_path, (HIP_LIMIT, '<limit effort="2"/>'))
    model, _ = load(path, joints={"hip": {"stops": STOPS}})
    stops = model.joints["hip"].stops
    assert (stops.lower_deg, stops.upper_deg) == (-20.0, 30.0)
    assert stops.stiffness_Nm_per_rad == pytest.approx(2.0 / np.radians(1.0))  # its effort limit at one degree
    model, _ = load(path, joints={"hip": {"stops": {**STOPS, "stiffness_Nm_per_rad": 7}}})
    assert model.joints["hip"].stops.stiffness_Nm_per_rad == 7.0


def test_only_given_corrections_are_made(tmp_path: Path) -> None:
    path = robot_in(tmp_path, (HIP_LIMIT, ""), (LEG_MASS, ""), ("meshes/foot.stl", "lost.stl"))
    for keys, lines in (
        ({}, {5, 10}),  # the mesh is looked for once the rest is right
        ({"joints": {"hip": {"stops": STOPS}}}, {5}),
        ({"joints": {"hip": {"damping_Nm_s_per_rad": 1}}}, {5, 10}),
        ({"joints": {"hip": {"stops": STOPS}}, "bodies": {"leg": {"mass_kg": 1}}}, {6}),
        ({"joints": {"hip": {"stops": STOPS}}, "bodies": {"foot": {"mass_kg": 1}}}, {5}),
    ):
        assert {fault.line for fault in faults_of(ConfigError, load, path, **keys)} == lines, keys
    with pytest.raises(ConfigError, match=r"bodies.leg.mass_kg: got the number -1"):
        load(robot_in(tmp_path, (LEG_MASS, "")), bodies={"leg": {"mass_kg": -1}})


def test_a_link_that_becomes_part_of_another_body_gives_its_mass(tmp_path: Path) -> None:
    """The trunk is fixed to a base without mass, and the body of both is called base."""
    path = robot_in(tmp_path, (TRUNK_MASS, ""))
    model, _ = load(path, bodies={"trunk": {"mass_kg": 3}})
    assert model.bodies["base"].mass_kg == 3.0
    assert "trunk" not in model.bodies
    with pytest.raises(ConfigError, match=r"bodies.trunk.shapes: the link trunk is part of another body here"):
        load(path, bodies={"trunk": {"mass_kg": 3, "shapes": []}})


def test_names_that_are_numbers_stay(tmp_path: Path) -> None:
    path = robot_in(tmp_path, ('name="hip"', 'name="1"'), ('name="axle"', 'name="2-left"'))
    model, built = load(path, joints={"1": {"damping_Nm_s_per_rad": 0.5}})
    assert [*model.joints] == ["base", "1", "slide", "2-left"]
    assert model.joints["1"].damping_Nm_s_per_rad == 0.5
    assert "1" in [joint.name for joint in built.joints]
    changed = config.load(
        {"model": {"urdf": str(path)}, "medium": None, "drives": {"1": {"type": "torque", "torque_Nm": 1}}},
        ["drives.1.torque_Nm=2", "model.joints.1.damping_Nm_s_per_rad=0.25"],
    ).scenario
    assert changed.drives["1"].torque_Nm.value == 2.0
    assert changed.model.joints["1"].damping_Nm_s_per_rad == 0.25


@pytest.mark.parametrize("short", [1e-4, 1e-3, 1.9e-3])
def test_rounding_of_a_robot_file_is_no_fault(tmp_path: Path, short: float) -> None:
    """A plate's moments, of which the largest is the sum of the two others but for three or four digits."""
    moments = 'ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="1e-5" ixz="0" iyz="0"'
    rounded = f'ixx="1e-3" iyy="2e-3" izz="{3e-3 / (1.0 - short)}" ixy="0" ixz="0" iyz="0"'
    _, built = load(robot_in(tmp_path, (f"{LEG_MASS}<inertia {moments}", f"{LEG_MASS}<inertia {rounded}")))  # fmt: skip
    np.testing.assert_allclose(np.linalg.eigvalsh(built.body("leg").inertia), [1e-3, 2e-3, 3e-3], rtol=3e-3)


@pytest.mark.parametrize("named", [False, True], ids=["in the config", "in a file of the model"])
def test_an_override_changes_how_the_robot_file_is_read(tmp_path: Path, named: bool) -> None:
    model: Any = {"urdf": str(robot_in(tmp_path))}
    if named:
        (tmp_path / "arm.yaml").write_text(f"urdf: {model['urdf']}\n")
        model = str(tmp_path / "arm.yaml")
    run = {"model": model, "medium": "rft3d_sand"}
    changed = config.load(run, ["model.fix=[hip]", "model.stops.stiffness_N_per_m=7"]).scenario.model
    assert changed.joints["hip"].type == "weld"
    assert changed.joints["slide"].stops.stiffness_N_per_m == 7
    (fault,) = faults_of(ConfigError, lambda: config.load(run, ["model.base=flying"]))
    assert (
        str(fault)
        == "--set model.base=flying: model.base: got the text 'flying'; allowed is one of free, fixed, or null"
    )
