"""The parts of MuJoCo models that are in the sand, and faults of models in one line each."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_mujoco import BOX, SAND, model_of
from support_refusals import message_of
from support_runs import ROOT

from granular_contact import Poncelet, Rft
from granular_contact.errors import SceneError

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
from granular_contact.mujoco import MujocoBed  # noqa: E402

CUBE = "-1 -1 -1 1 -1 -1 1 1 -1 -1 1 -1 -1 -1 1 1 -1 1 1 1 1 -1 1 1"
SIDES = "0 2 1 0 3 2 4 5 6 4 6 7 0 1 5 0 5 4 2 3 7 2 7 6 0 4 7 0 7 3 1 2 6 1 6 5"


def area(bed: Any) -> float:
    return float(sum(line.rows[:, 7].sum() for line in bed.load.lines))


def test_geoms_are_taken_as_they_are() -> None:
    model = model_of(
        '<geom name="box" type="box" size="0.02 0.02 0.02" pos="0.1 0 0"/>'
        '<geom name="pin" type="cylinder" size="0.01 0.05" euler="90 0 0"/>'
        '<geom name="egg" type="ellipsoid" size="0.03 0.02 0.01" pos="-0.1 0 0"/>'
        '<geom name="ball" type="sphere" size="0.02" pos="0 0.2 0"/>'
        '<geom name="cube" type="mesh" mesh="cube" pos="0 -0.2 0"/>'
        '<geom name="picture" type="sphere" size="0.2" contype="0" conaffinity="0"/>',
        more=f'<asset><mesh name="cube" vertex="{CUBE}" face="{SIDES}" scale="0.02 0.02 0.02"/></asset>',
    )
    bed = MujocoBed(model, SAND)
    assert bed.add_geoms(".*", facet_size=0.004) == ["box", "pin", "egg", "ball", "cube"]
    p = 1.6075
    egg = 4 * np.pi * (((0.03 * 0.02) ** p + (0.03 * 0.01) ** p + (0.02 * 0.01) ** p) / 3) ** (1 / p)
    sides = 2 * 6 * 0.04**2 + 2 * np.pi * 0.01 * (0.1 + 0.01) + egg + 4 * np.pi * 0.02**2
    assert area(bed) == pytest.approx(sides, rel=0.02)


def test_overlapping_geoms_are_loaded_on_their_outer_faces() -> None:
    two = '<geom name="a" type="box" size="0.05 0.02 0.02"/>'
    two += '<geom name="b" type="box" size="0.05 0.02 0.02" pos="0.05 0 0"/>'
    bed = MujocoBed(model_of(two), SAND)
    bed.add_geoms("a|b", facet_size=0.005)
    # The sides of both that lie on each other count twice along 50 mm; the ends within the other do not.
    once = 2 * (0.15 * 0.04 + 0.15 * 0.04 + 0.04 * 0.04)
    assert area(bed) == pytest.approx(once + 4 * 0.05 * 0.04, rel=1e-6)


def refused(call: Any, *arguments: Any, **named: Any) -> str:
    message = message_of((SceneError, ValueError), call, *arguments, **named)
    assert "\n" not in message
    return message


def test_impossible_bodies_in_sand_are_refused_in_one_line() -> None:
    open_cube = SIDES.rsplit(" ", 3)[0]
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="open" vertex="{CUBE}" face="{open_cube}" scale="0.02 0.02 0.02"/></asset>'
        '<worldbody><geom name="floor" type="plane" size="1 1 1"/><geom name="wall" type="box" size="1 1 1"/>'
        '<body name="leg"><freejoint/><geom name="foot" type="sphere" size="0.02"/>'
        '<geom name="shell" type="mesh" mesh="open"/>'
        "</body></worldbody></mujoco>"
    )
    bed = MujocoBed(model, SAND)
    assert refused(bed.add_geoms, "toe") == "bed.add_geoms: no geom fits 'toe'; the model has floor, wall, foot, shell"
    assert "geom floor is a plane and has no volume" in refused(bed.add_geoms, "floor")
    assert "geom wall is fixed to the world: sand does not move it (a missing <freejoint/>?)" in refused(
        bed.add_geoms, "wall"
    )
    assert "geom shell: it is open" in refused(bed.add_geoms, "shell")
    assert bed.add_geoms("shell", hull=True) == ["shell"]
    bed.add_geoms("foot")
    assert "geom foot is in the sand already" in refused(bed.add_geoms, "foot")
    assert refused(bed.add_geoms, "(foot").startswith(
        "bed.add_geoms: got '(foot', allowed is a regular expression (missing )"
    )
    other = mujoco.MjData(mujoco.MjModel.from_xml_string("<mujoco/>"))
    assert refused(bed.apply, other).startswith(
        "bed: got data of another model, with 0 coordinates, 0 velocities and 1"
    )
    bed.apply(mujoco.MjData(model))
    assert "it is in use already" in refused(bed.add_geoms, "foot")
    assert "nothing was named" in refused(MujocoBed(model, SAND).apply, mujoco.MjData(model))
    assert "nothing acts on a Box: poncelet takes a Sphere" in refused(
        MujocoBed(model_of(), Poncelet(1, 1)).add_geoms, "box"
    )
    assert "form: got 'resultant', allowed in space" in refused(MujocoBed, model, SAND, form="resultant")
    along = refused(MujocoBed, model, SAND, plane=(0, 0, 2))
    assert along == "plane: got [0, 0, 2], which is along up; allowed is across it"
    model.opt.gravity[:] = 0.0
    assert "the model has no gravity" in refused(MujocoBed, model, SAND)


def warned(xml: str, **options: Any) -> list[str]:
    model = mujoco.MjModel.from_xml_string(xml)
    bed = MujocoBed(model, SAND, **options)
    bed.add_geoms("box")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        bed.apply(mujoco.MjData(model))
    assert not any("\n" in str(warning.message) for warning in caught)
    return [str(warning.message) for warning in caught]


def test_contacts_that_keep_the_sand_from_acting_give_a_warning() -> None:
    body = f'<body name="robot" pos="0 0 0.1"><freejoint/>{BOX}</body>'
    floor = '<geom name="floor" type="plane" size="1 1 0.1"{}/>'
    assert warned(f"<mujoco><worldbody>{body}</worldbody></mujoco>") == []
    (warning,) = warned(f"<mujoco><worldbody>{floor.format('')}{body}</worldbody></mujoco>")
    assert warning.startswith(
        "geom floor is rigid at the surface of the sand and carries robot instead of it: remove it"
    )
    off = ' contype="0" conaffinity="0"'
    assert warned(f"<mujoco><worldbody>{floor.format(off)}{body}</worldbody></mujoco>") == []
    assert (
        warned(f"<mujoco><worldbody>{floor.format('')}{body}</worldbody></mujoco>", surface=0.3) == []
    )  # a deep bottom
    pair = '<contact><pair geom1="floor" geom2="box"/></contact>'
    (warning,) = warned(f"<mujoco><worldbody>{floor.format(off)}{body}</worldbody>{pair}</mujoco>")
    assert re.search("contact pair 0 of geoms (floor and box|box and floor) is left on beside the sand", warning)
    leg = '<body name="trunk" pos="0 0 0.5"><geom size="0.1"/>'
    leg += f'<body name="leg" pos="0 0 -0.3"><joint/>{BOX}</body></body>'
    (warning,) = warned(f"<mujoco><worldbody>{leg}</worldbody></mujoco>")
    assert warning.startswith("body trunk is fixed to the world")
    assert warning.endswith("give it a <freejoint/>")


def robot(path: str) -> Any:
    spec = mujoco.MjSpec.from_file(path)
    if spec.strippath:  # as old versions of MuJoCo read a URDF: without the folders of its meshes
        spec.meshdir = "meshes"
    return spec


def test_robot_files_need_a_free_joint() -> None:
    path = str(ROOT / "models" / "hexapod" / "hexapod.urdf")
    spec = robot(path)
    bed = MujocoBed(model := spec.compile(), SAND)
    assert "is fixed to the world: sand does not move it (a missing <freejoint/>?)" in refused(bed.add_geoms, ".*")
    bed.add_geoms("leg_.*")
    with pytest.warns(UserWarning, match=r"leg_rear_right turn on hinges of the world: .* give that a <freejoint/>$"):
        bed.of(mujoco.MjData(model))
    spec = robot(path)
    spec.worldbody.first_body().add_freejoint()
    bed = MujocoBed(model := spec.compile(), SAND)
    assert len(bed.add_geoms("trunk|leg_.*")) == 7
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bed.of(mujoco.MjData(model))


def test_sections_of_geoms_in_a_plane() -> None:
    joints = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>'
    geoms = '<geom name="box" type="box" size="0.05 0.04 0.03"/>'
    geoms += '<geom name="disc" type="cylinder" size="0.02 0.01" pos="0.1 0 0" euler="90 0 0"/>'
    model = model_of(geoms, joint=joints)
    bed = MujocoBed(model, Rft(), plane=(1, 0, 0))
    bed.add_geoms("box|disc")
    widths = [float(line.record["width"][0]) for line in bed.load.lines]
    assert widths[0] == pytest.approx(0.08)
    assert widths[-1] == pytest.approx(0.02)
    points = np.concatenate([np.column_stack([line.stations["x"], line.stations["y"]]) for line in bed.load.lines])
    np.testing.assert_allclose([points[:, 0].max(), points[:, 0].min()], [0.12, -0.05], atol=1e-9)
    assert "got one without a section" in refused(
        MujocoBed(
            model_of('<geom name="c" type="capsule" size="0.01 0.02"/>', joint=joints), Rft(), plane=(1, 0, 0)
        ).add_geoms,
        "c",
    )


EXAMPLES = {
    "ball": r"at rest -?\d+\.\d mm deep, the sand took up -?\d\.\d{3} J",
    "hexapod": r"-?\d\.\d{3} m in 0\.1 s, the sand took up \d\.\d\d J",
    "wheel": r"slip 0\.3: drawbar pull -?\d+\.\d N, torque -?\d\.\d\d N m, sinkage -?\d+\.\d mm",
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_run(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With a film where MuJoCo can draw, and a line that says so where it can not."""
    film = tmp_path / "film.gif"
    monkeypatch.syspath_prepend(str(ROOT / "examples" / "mujoco"))
    monkeypatch.setattr(sys, "argv", [name, "--seconds", "0.1", "--video", str(film)])
    runpy.run_path(str(ROOT / "examples" / "mujoco" / f"{name}.py"), run_name="__main__")
    printed = capsys.readouterr().out
    assert re.search(EXAMPLES[name], printed), printed
    assert film.exists() != ("no film: " in printed)


def test_without_mujoco_one_line_says_how_to_get_it() -> None:
    code = "import sys; sys.modules['mujoco'] = None\nimport granular_contact.mujoco"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.stderr.strip().endswith("granular_contact.mujoco needs MuJoCo: pip install 'granular-contact[mujoco]'")
