"""Robot files that are no proper XML but that other readers accept: read to the same robot, each with a notice."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_robot import robot_in

from granular_contact import config
from granular_contact.cli import main
from granular_contact.robot.types import Robot
from granular_contact.robot.urdf import read_all

START = '<?xml version="1.0"?>\n'
# What stands in place of the first line, and before the end; the encoding; line and words of the notice.
TOLERATED: dict[str, tuple[str, str, str, int, str]] = {
    "version 0": ('<?xml version="0.0"?>\n', "", "utf-8", 1, "has the version '0.0'; read as 1.0"),
    "version 2": ('<?xml version="2"?>\n', "", "utf-8", 1, "has the version '2'; read as 1.0"),
    "no version": ('<?xml encoding="utf-8"?>\n', "", "utf-8", 1, "has no version; read as 1.0"),
    "blank line": ("\n" + START, "", "utf-8", 2, "does not stand at the start of the file"),
    "comment first": ("<!-- made by hand -->\n" + START, "", "utf-8", 2, "does not stand at the start of the file"),
    "two declarations": (START + START, "", "utf-8", 2, "does not stand at the start of the file"),
    "prefix": (START, "<gazebo><plugin:x/></gazebo>", "utf-8", 14, "prefix 'plugin' is not declared"),
    "prefix of an attribute": (START, '<gazebo a:b="1"/>', "utf-8", 14, "prefix 'a' is not declared"),
    "claim of UTF-16": ('<?xml version="1.0" encoding="utf-16"?>\n', "", "utf-8", 1, "says the encoding 'utf-16'"),
    "claim of nothing": ('<?xml version="1.0" encoding="plain"?>\n', "", "utf-8", 1, "says the encoding 'plain'"),
    "not UTF-8": (START, "<!-- 90\xb0 -->", "latin-1", 14, "the byte 0xb0, which the encoding utf-8 does not have"),
    "not ASCII": ('<?xml version="1.0" encoding="ascii"?>\n', "<!-- \xb0 -->", "utf-8", 14, "ascii does not have"),
    "dashes in a comment": (START, "<!-- ---- end ---- -->", "utf-8", 14, "a comment holds --"),
    "ampersand": (START, '<gazebo text="sand & gravel"/>', "utf-8", 14, "has an & that begins no known entity"),
}  # fmt: skip
FINE: dict[str, tuple[str, str]] = {
    "plain": (START, "utf-8"),
    "no declaration": ("", "utf-8"),
    "Latin-1 that says so": ('<?xml version="1.0" encoding="iso-8859-1"?>\n', "latin-1"),
    "UTF-8 with a mark": (START, "utf-8-sig"),
    "UTF-16 that says so": ('<?xml version="1.0" encoding="utf-16"?>\n', "utf-16"),
}


def written(folder: Path, start: str, before_end: str = "", encoding: str = "utf-8") -> Path:
    """The robot with another first line, and more before its end."""
    path = robot_in(folder, (START, start), ("</robot>", f"{before_end}</robot>"))
    path.write_bytes(path.read_text(encoding="utf-8").encode(encoding))
    return path


def same(first: Robot, second: Robot) -> None:
    assert [*first.links] == [*second.links]
    assert [*first.joints] == [*second.joints]
    for name, joint in first.joints.items():
        np.testing.assert_array_equal(joint.origin.xyz, second.joints[name].origin.xyz)
    for name, link in first.links.items():
        assert [shape.geometry for shape in link.collision] == [
            shape.geometry for shape in second.links[name].collision
        ]


@pytest.mark.parametrize("name", TOLERATED)
def test_tolerated_xml_faults_are_read_with_a_notice(tmp_path: Path, name: str) -> None:
    start, before_end, encoding, line, message = TOLERATED[name]
    plain, _ = read_all(robot_in(tmp_path / "plain"))
    path = written(tmp_path, start, before_end, encoding)
    robot, reader = read_all(path)
    assert reader.faults == []
    same(robot, plain)
    (notice,) = reader.notices
    assert message in notice.message
    assert (notice.file, notice.line) == (str(path), line)
    # The lines of what follows are those of the file.
    assert robot.links["base"].line == plain.links["base"].line + start.count("\n") - 1


@pytest.mark.parametrize("name", FINE)
def test_proper_files_have_no_notice(tmp_path: Path, name: str) -> None:
    start, encoding = FINE[name]
    _, reader = read_all(written(tmp_path, start, "<!-- \xb0 --><gazebo/>", encoding))
    assert reader.notices == reader.faults == []


@pytest.mark.parametrize("name", sorted(TOLERATED.keys() - {"comment first"}))  # which MuJoCo refuses
def test_mujoco_takes_them_too(tmp_path: Path, name: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    start, before_end, encoding, _, _ = TOLERATED[name]
    path = written(tmp_path, start, before_end, encoding)
    text = path.read_bytes().replace(b"meshes/foot.stl", str(tmp_path / "meshes" / "foot.stl").encode())
    path.write_bytes(text.replace(b"</robot>", b'<mujoco><compiler strippath="false"/></mujoco></robot>'))
    assert mujoco.MjModel.from_xml_path(str(path)).njnt == 3  # hip, slide and axle


def test_check_and_runs_print_the_notice(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, '\n<?xml version="0.0" encoding="utf-16"?>\n', "<gazebo><plugin:x/></gazebo>")
    notices: list[Any] = []
    assert main(["check", str(path)]) == 0
    notices.append(capsys.readouterr().err)
    run = tmp_path / "run.yaml"
    run.write_text("model: {urdf: arm.urdf}\nmedium: rft3d_sand\nsolver: {end_time_s: 0.05}\n", encoding="utf-8")
    assert main(["check", str(run)]) == 0
    notices.append(capsys.readouterr().err)
    notices.append("\n".join(config.load(run, solver={"end_time_s": 0.1}).sources.notices))
    for text in notices:
        for line, message in (
            (2, "has the version '0.0'"),
            (2, "says the encoding 'utf-16'"),
            (2, "does not stand at the start of the file"),
            (15, "prefix 'plugin' is not declared"),
        ):
            assert (
                sum(f"{path}:{line}: " in text_line and message in text_line for text_line in text.splitlines()) == 1
            ), text
