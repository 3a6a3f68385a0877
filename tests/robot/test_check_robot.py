"""The command `check` on robot files, and the mended copies that it writes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support_robot import block, inertial_after_mending, robot_in, stl

from granular_contact.cli import main
from granular_contact.geometry import mesh
from granular_contact.geometry.mesh_quality import quality
from granular_contact.robot.inspection import inspect

CUBE = block((0.1, 0.1, 0.1))


def test_check_prints_a_table_and_a_line_a_fault(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = robot_in(tmp_path)
    assert main(["check", str(path)]) == 0
    printed = capsys.readouterr()
    row = next(line for line in printed.out.splitlines() if line.startswith("foot"))
    assert row.split() == ["foot", "foot.stl", "12", "60", "x", "40", "x", "20", "yes", "yes", "1", "0", "48"]
    assert printed.out.splitlines()[-1] == f"{path}: ok"
    assert printed.err == ""
    stl(tmp_path / "meshes" / "foot.stl", 1000 * block((0.06, 0.04, 0.02))[2:])
    assert main(["check", str(path)]) == 2
    printed = capsys.readouterr()
    assert printed.err.startswith(f"{path}:6: link.foot.collision.geometry.mesh: foot.stl: it is open: 4 edges")
    assert len(printed.err.splitlines()) == 1
    assert main(["check", str(path), "--shapes", "visual"]) == 0
    assert "notes" in capsys.readouterr().out


def test_options_of_robots_are_for_robots(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(robot_in(tmp_path))
    assert main(["check", "configs/pendulum.yaml", "--mend", str(tmp_path / "out")]) == 2
    assert "--mend" in capsys.readouterr().err
    assert main(["check", path, "--package", "toes"]) == 2
    assert "allowed is NAME=PATH" in capsys.readouterr().err
    assert main(["check", path, "--mend", str(tmp_path)]) == 2
    assert "allowed is a new or empty folder" in capsys.readouterr().err


MENDED = {
    "fine": (CUBE, 1e-3, "kept", 12),
    "open": (CUBE[2:], 1e-3, "holes filled by 2 triangles (volume ", 12),
    "turned": (np.concatenate([CUBE[:3, ::-1], CUBE[3:]]), 1e-3, "turned outward (volume 666.7 to 1000 cm3)", 12),
    "inside out": (CUBE[:, ::-1], 1e-3, "turned outward (volume -1000 to 1000 cm3)", 12),
    "twice": (np.concatenate([CUBE, CUBE[:3]]), 1e-3, "triangles dropped: 3 given twice (volume ", 12),
    "two": (
        np.concatenate([CUBE, block((0.1, 0.05, 0.05), (0.05, 0, 0))]),
        1.125e-3,
        "its 2 parts made one (volume 1250 to 1125 cm3)",
        None,
    ),
    "hollow": (
        np.concatenate([CUBE, block((0.08, 0.08, 0.08))[:, ::-1]]),
        1e-3,
        "its 2 parts made one (volume 488 to 1000 cm3)",
        12,
    ),
    "millimetres": (1000 * CUBE, 1e-3, "read as millimetres", 12),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", MENDED)
def test_a_mended_copy_has_no_faults(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    corners, volume, done, triangles = MENDED[name]
    path = robot_in(tmp_path, (' scale="0.001 0.001 0.001"', ""))
    stl(tmp_path / "meshes" / "foot.stl", corners)
    main(["check", str(path), "--mend", str(tmp_path / "new" / "out")])
    printed = capsys.readouterr().out
    assert "mended: foot.stl: " in printed
    assert done in printed
    after = inspect(tmp_path / "new" / "out" / "arm.urdf")
    assert after.faults == ()
    (foot,) = (shape for shape in after.shapes if shape.path is not None)
    assert foot.path == tmp_path / "new" / "out" / "meshes" / "foot.stl"
    assert foot.quality is not None
    assert foot.quality.volume == pytest.approx(volume, rel=1e-5)
    assert foot.quality.inner == 0.0
    assert triangles in (None, foot.quality.triangles)


def test_an_inertia_too_large_for_the_shapes_becomes_theirs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = robot_in(
        tmp_path, ('<mass value="2"/><inertia ixx="1e-3"', '<origin rpy="1 0 0"/><mass value="2"/><inertia ixx="9"')
    )
    inertial = inertial_after_mending(path, tmp_path / "out", "trunk")
    assert "mended: link trunk: its inertia is now that of the hull of its shapes" in capsys.readouterr().out
    box = 2.0 / 12.0 * np.diag([0.1**2 + 0.05**2, 0.2**2 + 0.05**2, 0.2**2 + 0.1**2])
    np.testing.assert_allclose(inertial.tensor, box, atol=1e-9)
    np.testing.assert_allclose(inertial.center, 0.0, atol=1e-9)


def test_mirrored_meshes_keep_their_outside(tmp_path: Path) -> None:
    path = robot_in(tmp_path, ("0.001 0.001 0.001", "0.001 -0.001 0.002"))
    (foot,) = (shape.quality for shape in inspect(path).shapes if shape.path is not None)
    assert foot is not None
    assert foot.volume == pytest.approx(2 * 0.06 * 0.04 * 0.02)


def test_units_of_collada_files_count(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box((10, 20, 30)).export(tmp_path / "box.dae")
    text = (tmp_path / "box.dae").read_text(encoding="utf-8")
    (tmp_path / "box.dae").write_text(
        text.replace("<up_axis>", '<unit name="centimeter" meter="0.01"/>\n<up_axis>'), encoding="utf-8"
    )
    vertices, faces = mesh.read(tmp_path / "box.dae")
    assert quality(vertices, faces).volume == pytest.approx(0.1 * 0.2 * 0.3)


def test_an_impossible_inertia_without_a_shape_becomes_the_nearest(tmp_path: Path) -> None:
    """Of one whose two moments are nothing, as public files have them, a thin plate's."""
    for given, mended in (((0.0, 0.0, 3e-3), (1.5e-3, 1.5e-3, 3e-3)), ((1e-3, 2e-3, 9e-3), (3e-3, 6e-3, 9e-3))):
        moments = " ".join(f'i{axis}{axis}="{moment}"' for axis, moment in zip("xyz", given, strict=True))
        inertial = f'<inertial><mass value="0.3"/><inertia {moments} ixy="0" ixz="0" iyz="0"/></inertial>'
        path = robot_in(tmp_path, ('<link name="sensor">', f'<link name="sensor">{inertial}'))
        nearest = inertial_after_mending(path, tmp_path / f"out{given[0]}", "sensor")
        np.testing.assert_allclose(np.linalg.eigvalsh(nearest.tensor), mended, rtol=1e-6)
