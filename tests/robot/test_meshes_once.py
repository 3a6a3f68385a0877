"""A mesh that a robot uses many times is looked through once, by `check` and by a run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support_robot import block, inertial, stl

from granular_contact import config, scene
from granular_contact.geometry import mesh
from granular_contact.robot import inspection
from granular_contact.scene.space import shapes

USES = 14
MESH = '<mesh filename="toe.stl"{}/>'


def robot_of_many(folder: Path, scales: tuple[str, ...] = ("",)) -> Path:
    stl(folder / "toe.stl", block((0.03, 0.02, 0.01)))
    text = f'<robot name="many"><link name="trunk">{inertial(2)}</link>'
    for i in range(USES):
        shape = MESH.format(scales[i % len(scales)])
        text += f'<link name="toe{i}">{inertial(0.1, "5e-5")}<collision><geometry>{shape}</geometry></collision></link>'
        text += f'<joint name="j{i}" type="continuous"><origin xyz="{0.1 * i} 0 0"/><parent link="trunk"/>'
        text += f'<child link="toe{i}"/></joint>'
    path = folder / "many.urdf"
    path.write_text(text + "</robot>", encoding="utf-8")
    return path


def counted(monkeypatch: pytest.MonkeyPatch, counts: Counter[str], module: Any, name: str) -> None:
    whole: Callable[..., Any] = getattr(module, name)

    def count(*arguments: Any, **named: Any) -> Any:
        counts[name] += 1
        return whole(*arguments, **named)

    monkeypatch.setattr(module, name, count)


@pytest.mark.parametrize(("scales", "times"), [(("",), 1), (("", ' scale="2 2 2"'), 2)])
def test_a_mesh_is_looked_through_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, scales: tuple[str, ...], times: int
) -> None:
    path = robot_of_many(tmp_path, scales)
    counts: Counter[str] = Counter()
    counted(monkeypatch, counts, inspection, "quality")
    inspected = inspection.inspect(path)
    assert len(inspected.shapes) == USES
    assert all(shape.quality is not None and shape.quality.closed for shape in inspected.shapes)
    assert counts == {"quality": times}
    counts.clear()
    for module, name in ((shapes, "quality_notes"), (mesh, "faults")):
        counted(monkeypatch, counts, module, name)
    loaded = config.load({"model": {"urdf": str(path)}, "medium": "rft3d_sand"})
    built = scene.build(loaded)
    assert sum(len(body.parts) for body in built.rigid) == USES
    assert counts == {"quality_notes": times, "faults": times}
    counts.clear()
    scene.build(loaded.replace(solver={"end_time_s": 0.2}))
    assert counts == {}


def test_a_mesh_that_changed_is_looked_through_anew(tmp_path: Path) -> None:
    path = robot_of_many(tmp_path)
    run = {"model": {"urdf": str(path)}, "medium": "rft3d_sand"}
    before = scene.build(config.load(run)).body("toe3").parts[0].triangles
    stl(tmp_path / "toe.stl", 2.0 * block((0.03, 0.02, 0.01)))
    after = scene.build(config.load(run)).body("toe3").parts[0].triangles
    assert abs(after).max() == pytest.approx(2.0 * abs(before).max())
