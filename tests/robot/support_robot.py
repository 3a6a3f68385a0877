# ruff: noqa: E501  (a line of XML each, so that a fault's line is counted easily)
"""A robot of our own with each type of joint, and meshes for it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from granular_contact.cli import main
from granular_contact.robot.inspection import inspect
from granular_contact.robot.types import Inertial


def inertial(mass: float, moment: str = "1e-3") -> str:
    return f'<inertial><mass value="{mass}"/><inertia ixx="{moment}" iyy="{moment}" izz="{moment}" ixy="1e-5" ixz="0" iyz="0"/></inertial>'


ROBOT = f"""<?xml version="1.0"?>
<robot name="arm">
<link name="base"/>
<link name="trunk">{inertial(2)}<collision><geometry><box size="0.2 0.1 0.05"/></geometry></collision></link>
<link name="leg">{inertial(0.5)}<collision><origin xyz="0 0 -0.1" rpy="0.1 0.2 0.3"/><geometry><cylinder radius="0.02" length="0.2"/></geometry></collision></link>
<link name="foot">{inertial(0.1, "5e-5")}<collision><geometry><mesh filename="meshes/foot.stl" scale="0.001 0.001 0.001"/></geometry></collision></link>
<link name="wheel">{inertial(0.2, "2e-4")}<collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="sensor"><visual><geometry><box size="0.01 0.01 0.01"/></geometry></visual></link>
<joint name="bolt" type="fixed"><parent link="base"/><child link="trunk"/><origin xyz="0 0 0.1" rpy="0 0 0.5"/></joint>
<joint name="hip" type="revolute"><parent link="trunk"/><child link="leg"/><origin xyz="0.1 0.05 0" rpy="0.3 -0.2 0.1"/><axis xyz="0 1 0"/><limit lower="-1" upper="0.5" effort="2" velocity="5"/><dynamics damping="0.01" friction="0.02"/></joint>
<joint name="slide" type="prismatic"><parent link="leg"/><child link="foot"/><origin xyz="0 0 -0.2"/><axis xyz="0 0 -2"/><limit lower="0" upper="0.05" effort="20" velocity="1"/></joint>
<joint name="axle" type="continuous"><parent link="trunk"/><child link="wheel"/><origin xyz="-0.1 0 0" rpy="1.5707963267948966 0 0"/></joint>
<joint name="mount" type="fixed"><parent link="leg"/><child link="sensor"/><origin xyz="0 0 -0.1"/></joint>
</robot>
"""


def stl(path: Path, corners: np.ndarray) -> Path:
    """A binary STL file of triangles (n, 3, 3)."""
    record = np.zeros(len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]))
    record["corners"] = corners
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"\0" * 80 + np.uint32(len(corners)).tobytes() + record.tobytes())
    return path


def block(size: tuple[float, float, float], at: tuple[float, float, float] = (0, 0, 0)) -> np.ndarray:
    """Triangles (12, 3, 3) of a box around a point."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([half for a, b, c, d in sides for half in ((a, b, c), (a, c, d))])
    return (0.5 * signs * size + at)[faces]


def robot_in(folder: Path, *changes: tuple[str, str]) -> Path:
    """The robot's file in a folder, with its mesh, and with texts replaced."""
    text = ROBOT
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    stl(folder / "meshes" / "foot.stl", block((60, 40, 20)))
    path = folder / "arm.urdf"
    path.write_text(text, encoding="utf-8")
    return path


def inertial_after_mending(path: Path, folder: Path, link: str) -> Inertial:
    """Inertia of a link in the copy that `check --mend` writes of a faulty robot file, which has no faults."""
    assert main(["check", str(path), "--mend", str(folder)]) == 2
    mended = inspect(folder / "arm.urdf")
    assert mended.faults == ()
    mended_inertial = mended.robot.links[link].inertial
    assert mended_inertial is not None
    return mended_inertial
