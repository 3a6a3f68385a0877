# ruff: noqa: E501  (a case a line)
"""Each kind of bad robot file: one fault at its line, under its key; no entity is expanded, and nothing is fetched."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support_robot import ROBOT, block, robot_in, stl

from granular_contact.errors import ConfigError
from granular_contact.robot.inspection import inspect
from granular_contact.robot.urdf import read

TRUNK = '<mass value="2"/>'
HIP_LIMIT = '<limit lower="-1" upper="0.5" effort="2" velocity="5"/>'
# old text, new text, line, key, words of the message
FAULTS = [
    (TRUNK, '<mass value="-2"/>', 4, "link.trunk.inertial.mass.value", "got '-2'; allowed is a finite number of at"),
    (TRUNK, '<mass value="heavy"/>', 4, "link.trunk.inertial.mass.value", "got 'heavy'"),
    (TRUNK, "<mass/>", 4, "link.trunk.inertial.mass.value", "is missing"),
    (TRUNK, "", 4, "link.trunk.inertial.mass", "is missing"),
    (f'{TRUNK}<inertia ixx="1e-3"', f'{TRUNK}<inertia ixx="9e-3"', 4, "link.trunk.inertial.inertia", "which no body has"),
    (f'{TRUNK}<inertia ixx="1e-3"', f'{TRUNK}<inertia ixx="-1e-3"', 4, "link.trunk.inertial.inertia", "above 0"),
    (f'{TRUNK}<inertia ixx="1e-3"', f"{TRUNK}<inertia", 4, "link.trunk.inertial.inertia.ixx", "is missing"),
    ('<box size="0.2 0.1 0.05"/>', '<box size="0.2 0.1"/>', 4, "link.trunk.collision.geometry.box.size", "three finite"),
    ('<box size="0.2 0.1 0.05"/>', '<box size="0.2 0 1"/>', 4, "link.trunk.collision.geometry.box.size", "above 0"),
    ('<box size="0.2 0.1 0.05"/>', '<cone radius="1"/>', 4, "link.trunk.collision.geometry", "got <cone>; allowed is one"),
    ('<box size="0.2 0.1 0.05"/>', "", 4, "link.trunk.collision.geometry", "got nothing"),
    ('<cylinder radius="0.02"', "<cylinder", 5, "link.leg.collision.geometry.cylinder.radius", "is missing"),
    ('xyz="0 0 -0.1" rpy', 'xyz="0 0 nan" rpy', 5, "link.leg.collision.origin.xyz", "got '0 0 nan'"),
    ("meshes/foot.stl", "meshes/toe.stl", 6, "link.foot.collision.geometry.mesh.filename", "there is no file /"),
    ("meshes/foot.stl", "package://toes/foot.stl", 6, "link.foot.collision.geometry.mesh.filename", "folders above it"),
    ("meshes/foot.stl", "http://x.org/foot.stl", 6, "link.foot.collision.geometry.mesh.filename", "nothing is fetched"),
    ("meshes/foot.stl", "meshes/foot.step", 6, "link.foot.collision.geometry.mesh.filename", "there is no file"),
    (' scale="0.001 0.001 0.001"', "", 6, "link.foot.collision.geometry.mesh", "it is 60 x 40 x 20 m large: if it is in mi"),
    ("0.001 0.001 0.001", "0.001 0 1", 6, "link.foot.collision.geometry.mesh.scale", "three numbers that are not 0"),
    ('<link name="sensor">', '<link name="leg">', 8, "link.leg", "is the name of a link already, in line 5"),
    ('<link name="sensor">', "<link>", 8, "link.name", "is missing"),
    ('name="hip" type="revolute"', 'name="hip" type="hinge"', 10, "joint.hip.type", "got 'hinge'; allowed are revolute"),
    ('name="hip" type="revolute"', 'name="hip" type="planar"', 10, "joint.hip.type", "planar is not supported"),
    ('name="hip" type="revolute"', 'name="hip" type="floating"', 10, "joint.hip.type", "floating is not supported"),
    ('"bolt" type="fixed"><parent link="base"/>', '"bolt" type="fixed"><parent link="bass"/>', 9, "joint.bolt.parent", "did you mean base?"),
    ('<child link="leg"/>', "", 10, "joint.hip.child", 'is missing; allowed is <child link="..."/>'),
    (HIP_LIMIT, "", 10, "joint.hip.limit", "is missing"),
    (HIP_LIMIT, '<limit lower="1" upper="0.5"/>', 10, "joint.hip.limit.lower", "got 1; allowed is below upper, 0.5"),
    (HIP_LIMIT, f'{HIP_LIMIT}<mimic joint="knee"/>', 10, "joint.hip.mimic", "no joint 'knee'"),
    ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>', 10, "joint.hip.axis.xyz", "got 0 0 0; allowed is a direction"),
    ('damping="0.01"', 'damping="-1"', 10, "joint.hip.dynamics.damping", "of at least 0"),
    ('<parent link="leg"/><child link="foot"/>', '<parent link="leg"/><child link="wheel"/>', 12, "joint.axle.child", "wheel is the child of slide already"),
    ('<child link="trunk"/>', '<child link="base"/>', 9, "joint.bolt.child", "joins base to itself"),
    ('<parent link="base"/>', '<parent link="foot"/>', 9, "joint.bolt.parent", "is a closed chain"),
    ('"mount" type="fixed"', '"mount" type="continuous"', 8, "link.sensor", "moves by the joint mount (continuous) and has no mass"),
    ("</robot>", "<joit/></robot>", 14, "joit", "did you mean <joint>?"),
    ("</robot>", "", None, "", "is not valid XML"),
    ("</robot>", "<link name='${name}'/></robot>", 14, "", "is written in xacro"),
    ('<robot name="arm">', '<sdf name="arm">', None, "", "is not valid XML"),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("old", "new", "line", "key", "message"), FAULTS)
def test_each_fault_has_its_line_and_key(tmp_path: Path, old: str, new: str, line: int, key: str, message: str) -> None:
    path = robot_in(tmp_path, (old, new))
    try:
        reported = inspect(path).faults
    except ConfigError as error:
        reported = tuple(error.faults)
    mine = [fault for fault in reported if message in fault.message]
    assert len(mine) == 1, [str(fault) for fault in reported]
    assert mine[0].file == str(path)
    assert mine[0].key == key
    assert mine[0].line == line or line is None
    assert "\n" not in str(mine[0])


def test_all_faults_are_reported_at_once_and_a_good_file_has_none(tmp_path: Path) -> None:
    good = inspect(robot_in(tmp_path))
    assert good.faults == ()
    assert good.which == "collision"
    bad = robot_in(tmp_path, (TRUNK, "<mass/>"), (HIP_LIMIT, ""), ("meshes/foot.stl", "x.stl"))
    assert [fault.line for fault in inspect(bad).faults] == [4, 6, 10]


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b"", "is empty"),
        (b"\x00\xff\x12 no robot", "is not valid XML"),
        (ROBOT.encode()[:700], "is not valid XML"),
        (b'<!DOCTYPE r [<!ENTITY a "aa"><!ENTITY b "&a;&a;">]><robot name="&b;"/>', "has a DOCTYPE"),
        (b'<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot/>', "has a DOCTYPE"),
        ('<?xml version="1.0" encoding="utf-16"?><!DOCTYPE r [<!ENTITY a "b">]><robot/>'.encode("utf-16"), "DOCTYPE"),
        (b"<robot>" + b"<link>" * 300 + b"</link>" * 300 + b"</robot>", "is not valid XML"),
        (b"<sdf version='1.6'/>", "is an SDF file"),
        (b"<html/>", "its root is <html>"),
        (b"<robot" + b" " * 20_000_001 + b"/>", "is larger than 20 MB"),
    ],
)  # fmt: skip
def test_files_that_are_no_robot_end_in_one_line(tmp_path: Path, raw: bytes, message: str) -> None:
    path = tmp_path / "robot.urdf"
    path.write_bytes(raw)
    with pytest.raises(ConfigError) as caught:
        read(path)
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_packages_are_looked_up_above_the_file(tmp_path: Path) -> None:
    stl(tmp_path / "ws" / "named" / "meshes" / "foot.stl", block((60, 40, 20)))
    (tmp_path / "ws" / "other").mkdir()
    (tmp_path / "ws" / "other" / "package.xml").write_text("<package><name> toes </name></package>", encoding="utf-8")
    stl(tmp_path / "ws" / "other" / "foot.stl", block((60, 40, 20)))
    folder = tmp_path / "ws" / "other" / "urdf"
    for name in ("package://named/meshes/foot.stl", "package://toes/foot.stl", "..\\foot.stl"):
        assert inspect(robot_in(folder, ("meshes/foot.stl", name))).faults == (), name
    far = robot_in(tmp_path / "far", ("meshes/foot.stl", "package://nowhere/foot.stl"))
    assert inspect(far, packages={"nowhere": tmp_path / "ws" / "other"}).faults == ()


CUBE = block((0.1, 0.1, 0.1))
NOTED = {
    "open": (CUBE[2:], "it is open: 4 edges"),
    "inside out": (CUBE[:, ::-1], "it is inside out"),
    "one turned": (np.concatenate([CUBE[:1, ::-1], CUBE[1:]]), "turned opposite ways"),
    "flat triangle": (np.concatenate([CUBE, CUBE[:1, [0, 1, 1]]]), "1 of its 13 triangles have no area"),
    "twice": (np.concatenate([CUBE, block((0.1, 0.1, 0.1))]), "12 triangles stand there twice"),
    "two parts": (np.concatenate([CUBE, block((0.1, 0.1, 0.1), (0.3, 0, 0))]), "2 loose parts"),
    "overlap": (np.concatenate([CUBE, block((0.1, 0.05, 0.05), (0.05, 0, 0))]), "of its area lies inside it"),
    "hollow": (np.concatenate([CUBE, block((0.08, 0.08, 0.08))[:, ::-1]]), "about 39 % of its area lies inside it"),
    "tiny": (1e-3 * CUBE, "mm small"),
}


@pytest.mark.parametrize("name", NOTED)
def test_meshes_are_inspected(tmp_path: Path, name: str) -> None:
    corners, message = NOTED[name]
    path = robot_in(tmp_path, (' scale="0.001 0.001 0.001"', ""))
    stl(tmp_path / "meshes" / "foot.stl", corners)
    inspection = inspect(path)
    assert [fault.line for fault in (*inspection.faults, *inspection.notes) if message in fault.message] == [6]


def test_doubtful_bodies_are_noted(tmp_path: Path) -> None:
    def notes(*changes: tuple[str, str]) -> list[str]:
        return [f"{note.line} {note.message}" for note in inspect(robot_in(tmp_path, *changes)).notes]

    assert notes() == []
    box = '<box size="0.2 0.1 0.05"/></geometry></collision>'
    assert any(
        "its inertia is larger than its shapes can have" in note for note in notes((TRUNK, '<mass value="0.02"/>'))
    )
    assert any("its inertia is very small" in note for note in notes((TRUNK, '<mass value="2000"/>')))
    second = f'{box}<collision><origin xyz="0.05 0.01 0.01"/><geometry>{box}'
    assert any(
        "4 two of its shapes overlap, where the medium acts on both: box and box, about" in note
        for note in notes((box, second))
    )
    follows = f'{HIP_LIMIT}<mimic joint="axle"/>'
    assert any("follows axle, which is not supported" in note for note in notes((HIP_LIMIT, follows)))
    bare = notes((f"<collision><geometry>{box}", ""))
    assert bare == ["4 has no collision shape, so no medium acts on it"]
