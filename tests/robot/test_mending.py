"""Copies of robot files by `--mend`: the changes are minimal; volume, tensor and centre stay where possible."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support_robot import block, inertial_after_mending, robot_in, stl

from granular_contact.cli import main
from granular_contact.geometry import rotations
from granular_contact.geometry.mesh_quality import quality
from granular_contact.robot.inertia import impossibility, with_raised_moments
from granular_contact.robot.inspection import inspect
from granular_contact.robot.mending_mesh import mended_mesh

CUBE = block((0.1, 0.1, 0.1))


def bracket() -> np.ndarray:
    """Triangles (20, 3, 3) of an L of 144 cm3, whose convex hull has 272 cm3."""
    section = np.array([[0, 0], [0.1, 0], [0.1, 0.02], [0.02, 0.02], [0.02, 0.1], [0, 0.1]])
    low, high = (np.column_stack([section[:, 0], np.full(6, y), section[:, 1]]) for y in (-0.02, 0.02))
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    sides = [
        tri
        for i, j in ((i, (i + 1) % 6) for i in range(6))
        for tri in ((low[i], high[j], low[j]), (low[i], high[i], high[j]))
    ]
    ends = [[low[a], low[b], low[c]] for a, b, c in caps] + [[high[a], high[c], high[b]] for a, b, c in caps]
    return np.array([*sides, *ends])


def arrays(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)


def with_slivers(corners: np.ndarray, count: int, seed: int) -> np.ndarray:
    """The same surface with triangles of no area between it and halves of its triangles, some side by side."""
    draw, triangles = np.random.default_rng(seed), list(corners)
    for _ in range(count):
        i = int(draw.integers(len(triangles)))
        a, b, c = np.roll(triangles[i], -int(draw.integers(3)), axis=0)
        if np.linalg.norm(np.cross(b - a, c - a)) < 1e-9:
            continue
        middle = a + draw.uniform(0.2, 0.8) * (b - a)
        triangles[i : i + 1] = [np.array([a, middle, c]), np.array([middle, b, c]), np.array([a, b, middle])]
    return np.array(triangles)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_removing_empty_triangles_keeps_a_mesh_closed_and_its_volume(seed: int) -> None:
    whole = with_slivers(bracket(), 12, seed)
    assert len(whole) > 30
    (vertices, faces), repairs = mended_mesh(*arrays(whole))
    after = quality(vertices, faces)
    assert after.faults == after.notes == ()
    # Corners between are exact to round-off, 1e-16 of 0.1 m: 1e-14 of the volume.
    assert after.volume == pytest.approx(1.44e-4, rel=1e-12)
    assert after.area == pytest.approx(quality(*arrays(bracket())).area, rel=1e-12)
    assert repairs.endswith("without area (volume 144 to 144 cm3)")


def test_corners_a_little_apart_are_welded() -> None:
    rough = CUBE + 2e-7 * np.random.default_rng(1).uniform(-1, 1, CUBE.shape)
    assert not quality(*arrays(rough)).closed
    mended, repairs = mended_mesh(*arrays(rough))
    assert quality(*mended).faults == ()
    assert "mm apart welded (volume " in repairs
    assert quality(*mended).volume == pytest.approx(1e-3, rel=1e-4)


def test_a_hole_of_many_corners_is_filled() -> None:
    trimesh = pytest.importorskip("trimesh")
    tube = trimesh.creation.cylinder(radius=0.05, height=0.1, sections=24)
    side = tube.triangles[tube.triangles[:, :, 2].min(axis=1) < 0.0499]  # without the upper end
    assert quality(*arrays(side)).faults
    mended, repairs = mended_mesh(*arrays(side))
    assert quality(*mended).faults == ()
    assert "holes filled by 22 triangles" in repairs
    assert quality(*mended).volume == pytest.approx(tube.volume, rel=1e-9)


# Half of a cube and an edge: no cure of ours closes it.
RAGGED = np.concatenate([CUBE[[0, 3, 5, 8]], block((0.1, 0.1, 0.1), (0.2, 0, 0))[[1, 4, 6, 10]]])


def test_a_hull_is_taken_only_if_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = robot_in(tmp_path, (' scale="0.001 0.001 0.001"', ""))
    stl(tmp_path / "meshes" / "foot.stl", RAGGED)
    assert main(["check", str(path), "--mend", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr()
    assert "not mended: it is open" in printed.out
    assert "--hull takes its convex hull" in printed.out
    assert f"not mended: {tmp_path / 'out' / 'arm.urdf'}:" in printed.err
    main(["check", str(path), "--mend", str(tmp_path / "hull"), "--hull"])
    assert "replaced by its convex hull (volume " in capsys.readouterr().out
    assert inspect(tmp_path / "hull" / "arm.urdf").faults == ()
    assert main(["check", str(path), "--hull"]) == 2
    assert "--hull: allowed with --mend" in capsys.readouterr().err


def test_a_doubtful_mesh_is_never_replaced_by_its_hull() -> None:
    """A block that ends in a cube, so that much of its area lies inside: united, and no larger."""
    cross = np.concatenate([CUBE, block((0.1, 0.05, 0.05), (0.05, 0, 0))])
    before = quality(*arrays(cross))
    assert before.faults == ()
    assert before.inner > 0.05
    mended, repairs = mended_mesh(*arrays(cross), hull=True)
    assert "hull" not in repairs
    assert quality(*mended).volume == pytest.approx(1e-3 + 0.05**3, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("short", [0.01, 0.04, 0.3])
@pytest.mark.parametrize("rpy", [(0.0, 0.0, 0.0), (0.4, -0.3, 1.0)])
def test_small_moments_are_raised_and_all_else_stays(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], short: float, rpy: tuple[float, float, float]
) -> None:
    """Both by one factor; the largest moment, the axes, the centre and the mass are those of the file."""
    largest = 3e-3
    given = np.array([0.3, 0.7]) * (1.0 - short) * largest
    turn = rotations.of_rpy(np.array([0.2, 0.5, -0.4]))
    tensor = turn @ np.diag([*given, largest]) @ turn.T
    moments = " ".join(f'i{a}{b}="{tensor["xyz".index(a), "xyz".index(b)]:.12g}"' for a, b in
                       ("xx", "yy", "zz", "xy", "xz", "yz"))  # fmt: skip
    origin = f'<origin xyz="0 0.016 -0.02" rpy="{" ".join(map(str, rpy))}"/>'
    old = '<mass value="2"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="1e-5" ixz="0" iyz="0"/>'
    path = robot_in(tmp_path, (old, f'{origin}<mass value="2"/><inertia {moments}/>'))
    inertial = inertial_after_mending(path, tmp_path / "out", "trunk")
    assert "mended: link trunk: its smaller moments of inertia are raised from" in capsys.readouterr().out
    assert inertial.mass == 2.0
    np.testing.assert_allclose(inertial.center, [0, 0.016, -0.02], atol=1e-12)
    wanted = np.diag([*given / (1.0 - short), largest])
    whole = rotations.of_rpy(np.array(rpy)) @ turn
    np.testing.assert_allclose(inertial.tensor, whole @ wanted @ whole.T, atol=1e-9 * largest * 10)


@pytest.mark.parametrize("moments", [(-1e-4, 2e-3, 3e-3), (-1e-9, 3e-3, 3e-3), (0.0, 0.0, 3e-3), (-1.0, -1.0, 3e-3)])
def test_any_tensor_with_a_largest_moment_can_be_raised(moments: tuple[float, float, float]) -> None:
    turn = rotations.of_rpy(np.array([0.2, 0.5, -0.4]))
    tensor = turn @ np.diag(moments) @ turn.T
    assert impossibility(tensor) is not None
    raised = with_raised_moments(tensor)
    assert impossibility(raised) is None
    assert np.linalg.eigvalsh(raised)[2] == pytest.approx(3e-3, rel=1e-12)
