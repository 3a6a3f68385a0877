"""Shapes of links that are not in the sand need not be perfect: a run goes on without them, and says so."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_models import one_body
from support_refusals import CONFIG_OR_SCENE, faults_of
from support_robot import block, robot_in, stl

from granular_contact import config, scene
from granular_contact.cli import main
from granular_contact.errors import SceneError
from granular_contact.sand.space.mesh_shape import Mesh

CUBE = block((0.1, 0.1, 0.1))
MESH = '<mesh filename="meshes/foot.stl" scale="0.001 0.001 0.001"/>'


def with_foot(corners: np.ndarray) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        path = robot_in(folder, (' scale="0.001 0.001 0.001"', ""))
        stl(folder / "meshes" / "foot.stl", corners)
        return path

    return make


def with_text(new: str) -> Callable[[Path], Path]:
    return lambda folder: robot_in(folder, (MESH, new))


def with_bytes(name: str, raw: bytes) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        path = robot_in(folder, ("meshes/foot.stl", name))
        (folder / name).write_bytes(raw)
        return path

    return make


FAULTY = {
    "missing": (with_text('<mesh filename="lost.stl"/>'), "there is no file"),
    "of a lost package": (with_text('<mesh filename="package://lost/foot.stl"/>'), "neither a folder lost"),
    "fetched": (with_text('<mesh filename="http://x.org/foot.stl"/>'), "nothing is fetched"),
    "nameless": (with_text("<mesh/>"), "is missing"),
    "another format": (with_bytes("foot.step", b"ISO-10303-21;"), "got a .step file"),
    "damaged": (with_bytes("foot.obj", b"v 1 2\nf a b"), "can't be read"),
    "pointer of Git LFS": (with_bytes("foot.obj", b"version https://git-lfs.github.com/spec/v1"), "git lfs pull"),
    "millimetres": (with_foot(1000.0 * CUBE), "give the scale 0.001"),
    "without any area": (with_foot(CUBE[:, [0, 1, 1]]), "none of its 12 triangles has an area"),
    "scale of 0": (with_text('<mesh filename="meshes/foot.stl" scale="0 1 1"/>'), "got '0 1 1'"),
    "flat box": (with_text('<box size="0.1 0 0.1"/>'), "three numbers above 0"),
    "unknown shape": (with_text('<cone radius="0.1"/>'), "got <cone>"),
}


def run_of(path: Path, **model: Any) -> dict[str, Any]:
    return {"model": {"urdf": str(path), **model}, "medium": "rft3d_sand"}


def notices(loaded: config.Loaded, built: scene.Scene) -> list[str]:
    return [*loaded.sources.notices, *map(str, loaded.sources.place(built.notes))]


@pytest.mark.parametrize("name", FAULTY)
def test_a_faulty_shape_out_of_the_sand_is_left_out(tmp_path: Path, name: str) -> None:
    make, message = FAULTY[name]
    path = make(tmp_path)
    loaded = config.load(run_of(path, in_sand=["leg"]))
    built = scene.build(loaded)
    assert built.body("foot").parts == ()
    assert built.body("foot").mass == 0.1
    (line,) = notices(loaded, built)
    assert line.startswith(f"{path}:6: ")
    assert message in line
    assert line.endswith("not in the sand, it is not drawn")
    faults = faults_of(CONFIG_OR_SCENE, lambda: scene.build(config.load(run_of(path, in_sand=["leg", "foot"]))))
    assert all(message in fault.message and "drawn" not in fault.message for fault in faults)


def test_a_mesh_that_gives_mass_is_needed_out_of_the_sand_too(tmp_path: Path) -> None:
    shape = {"type": "mesh", "file": str(tmp_path / "lost.stl"), "in_sand": False}
    body = {"type": "rigid", "density_kg_m3": 1000, "shapes": [shape]}
    with pytest.raises(SceneError, match="there is no such file"):
        scene.build(config.load({"model": one_body("plate", body), "medium": "rft3d_sand"}))


# One triangle of two corners, and one of three on a line, which closes the cube between its own corners.
TWO_CORNERS = np.concatenate([CUBE, CUBE[:1, [0, 1, 1]]])
(a, b, c), MIDDLE = CUBE[0], 0.5 * (CUBE[0, 0] + CUBE[0, 1])
ON_A_LINE = np.concatenate([[[a, MIDDLE, c], [MIDDLE, b, c], [a, b, MIDDLE]], CUBE[1:]])


@pytest.mark.parametrize("corners", [TWO_CORNERS, ON_A_LINE])
def test_triangles_without_area_carry_no_force_and_are_counted(tmp_path: Path, corners: np.ndarray) -> None:
    flat = Mesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    assert len(flat.faces) == len(corners) - 1
    left = flat.vertices[flat.faces]
    normals = 0.5 * np.cross(left[:, 1] - left[:, 0], left[:, 2] - left[:, 0])
    # What is left encloses the cube: its area vectors add to none, and its divergence is that of the volume.
    np.testing.assert_allclose(normals.sum(axis=0), 0.0, atol=1e-17)
    assert np.linalg.norm(normals, axis=1).sum() == pytest.approx(6e-2, rel=1e-12)
    assert np.einsum("ij,ij->", left.mean(axis=1), normals) / 3.0 == pytest.approx(1e-3, rel=1e-12)
    for sand in ("foot", "leg"):
        loaded = config.load(run_of(with_foot(corners)(tmp_path), in_sand=[sand]))
        built = scene.build(loaded)
        assert len(built.body("foot").parts[0].triangles) == len(corners) - 1
        (line,) = notices(loaded, built)
        assert f"1 of its {len(corners)} triangles have no area and are left out" in line


def test_check_prints_doubts_as_notes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = with_foot(ON_A_LINE)(tmp_path)
    assert main(["check", str(path)]) == 0
    assert f"note: {path}:6: link.foot.collision.geometry.mesh: foot.stl: 1 of its 14" in capsys.readouterr().err
