"""The ground in space: slopes in any direction, maps of heights, and faults of maps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from support_models import one_body
from support_parts import called
from support_space import PAIRS, load_on

from granular_contact import Results, Rft3d, load, simulate
from granular_contact.errors import SceneError
from granular_contact.geometry import rotations
from granular_contact.laws.static_friction import Smooth
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.kernels.ground import tangent_plane
from granular_contact.sand.space.heights import Heights
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.shapes import Plate
from granular_contact.scene import build

RISE = (0.12, -0.07)


def run(bed: dict[str, Any]) -> dict[str, Any]:
    """A box thrown down onto a bed."""
    body = {"type": "rigid", "density_kg_m3": 2000, "shapes": [{"type": "box", "size_m": [0.06, 0.04, 0.03]}]}
    start = {"x_m": 0.02, "y_m": 0.01, "z_m": 0.05, "rpy_deg": [20, 35, 10], "vx_m_s": 0.5, "vz_m_s": -1}
    return {
        "model": one_body("box", body),
        "medium": "rft3d_sand",
        "bed": bed,
        "initial": {"joints": {"flight": start}},
        "solver": {"end_time_s": 0.06, "step_s": 5e-4, "rest_time_s": None},
    }


def written(folder: Path, values: np.ndarray, **keys: Any) -> dict[str, Any]:
    np.savetxt(folder / "ground.csv", values, delimiter=",")
    return {"height_m": 0.0, "height_map": {"file": str(folder / "ground.csv"), **keys}}


def path(results: Results) -> np.ndarray:
    return np.column_stack([results[f"box_{axis}_m"] for axis in "xyz"])


def test_a_map_of_a_slope_is_the_slope(tmp_path: Path) -> None:
    x, y = np.meshgrid(-0.3 + 0.05 * np.arange(13), -0.3 + 0.05 * np.arange(13))
    heights = 100.0 * (RISE[0] * x + RISE[1] * y)
    bed = written(tmp_path, heights, cell_m=0.05, corner_m=[-0.3, -0.3], scale=0.01)
    slope = {"height_m": 0.0, "slope_deg": float(np.degrees(np.arctan(np.hypot(*RISE))))}
    slope["slope_direction_deg"] = float(np.degrees(np.arctan2(RISE[1], RISE[0])))
    mapped, sloped = simulate(load(run(bed))), simulate(load(run(slope)))
    np.testing.assert_allclose(path(mapped), path(sloped), atol=1e-9)
    np.testing.assert_allclose(mapped["depth_m"], sloped["depth_m"], atol=1e-9)
    assert mapped["depth_m"].max() > 0.01
    assert abs(path(sloped)[-1, 1] - 0.01) > 1e-4  # it is led aside


@pytest.mark.parametrize("name", ["rft3d", "lee_marghitu", "ball"])
def test_forces_on_a_map_of_a_slope_are_those_of_the_slope(name: str) -> None:
    """Facets, strips of a bar and a ball: forces, their tangent, and what is seen at the end of a step."""
    x, y = np.meshgrid(-0.3 + 0.05 * np.arange(13), -0.3 + 0.05 * np.arange(13))
    heights = Heights(RISE[0] * x + RISE[1] * y, (-0.3, -0.3), 0.05)
    q, v = np.array([0.01, -0.02, -0.005, 1.0, 0.0, 0.0, 0.0]), np.array([0.3, 0.1, -0.5, 0.0, 0.4, -0.2, 0.3])
    wrenches = []
    for ground in ({"heights": heights}, {"slope": [*RISE, 0.0]}):
        load = load_on(*PAIRS[name], **ground)
        load.start(q)
        load.accept(0.0, q, v)
        load.accept(1e-3, q + 1e-3 * v, v)
        wrenches.append([load.force(q + 2e-3 * v, v, np.zeros(7)), load.tangent(q + 2e-3 * v, v, 1.0, 1.0).copy()])
        wrenches[-1] += [load.history.depth, load.history.work]
    assert np.abs(wrenches[1][0]).max() > 0.1
    for first, second in zip(*wrenches, strict=True):
        np.testing.assert_allclose(first, second, rtol=1e-6, atol=1e-6 * np.abs(second).max())


def test_kernels_and_scene_have_one_surface_whose_rise_is_its_derivative() -> None:
    random = np.random.default_rng(1)
    heights = Heights(random.normal(size=(5, 7)), (-0.2, 0.1), 0.1)
    ground = np.concatenate([[0.3, 0.2, -0.1, 1.0], heights.numbers])
    x, y = random.uniform(-0.3, 0.5, 40), random.uniform(0.0, 0.6, 40)
    level = heights.at(x, y) + 0.3 + 0.2 * x - 0.1 * y

    def height(x: float, y: float) -> tuple[float, np.ndarray]:
        plane = np.empty(4)
        called(tangent_plane)(ground, x, y, plane)
        return plane[0] + plane[1] * x + plane[2] * y, plane

    for i in range(40):
        height_here, plane = height(x[i], y[i])
        assert height_here == pytest.approx(level[i], abs=1e-12)
        heights_beside = [
            height(x[i] + dx, y[i] + dy)[0] for dx, dy in ((1e-6, 0.0), (-1e-6, 0.0), (0.0, 1e-6), (0.0, -1e-6))
        ]
        assert plane[1] == pytest.approx((heights_beside[0] - heights_beside[1]) / 2e-6, abs=1e-5)
        assert plane[2] == pytest.approx((heights_beside[2] - heights_beside[3]) / 2e-6, abs=1e-5)
        assert np.hypot(plane[1] - 0.2, plane[2] + 0.1) <= heights.steepest


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0,0,0\n0,,0\n0,0,0\n", "ground.csv:2: 1 of 3 columns hold no number, the first is 2"),
        ("0,0,0\n0,nan,0\n", "a map of heights has no holes"),
        ("0,0,0\n0,0\n", "ground.csv:2: got 2 columns, but the rows before have 3"),
        ("0,0,0\n", "got 1 rows; allowed are 2 or more"),
        ("0,0,0\n0,9,0\n", "allowed is less than 60: look at cell_m and scale"),
        (None, "can't be read: FileNotFoundError"),
    ],
)
def test_faults_of_a_map_name_file_and_line(tmp_path: Path, text: str | None, message: str) -> None:
    if text is not None:
        (tmp_path / "ground.csv").write_text(text)
    scenario = load(run({"height_map": {"file": str(tmp_path / "ground.csv"), "cell_m": 0.1}}))
    with pytest.raises(SceneError, match=r"bed\.height_map\.file") as caught:
        build(scenario)
    assert message in str(caught.value)


def test_maps_with_spaces_and_with_commas_are_the_same(tmp_path: Path) -> None:
    values = np.random.default_rng(3).uniform(0.0, 0.01, (4, 5))
    commas, spaces = tmp_path / "commas.csv", tmp_path / "spaces.txt"
    np.savetxt(commas, values, delimiter=",")
    np.savetxt(spaces, values)
    for file in (commas, spaces):
        placed = build(load(run({"height_m": 0.0, "height_map": {"file": str(file), "cell_m": 0.1}}))).bed
        np.testing.assert_array_equal(placed.heights.values, values)


def test_bodies_that_start_beyond_the_map_have_a_note(tmp_path: Path) -> None:
    """A map begins at the origin unless it has a corner: a robot there has two of its feet beside it."""
    ground = written(tmp_path, np.zeros((11, 21)), cell_m=0.1)
    (note,) = build(load(run(ground))).notes
    assert note.key == "bed.height_map"
    assert "from x = 0 to 2 m and from y = 0 to 1 m" in note.message
    assert note.message.endswith("beyond it at the start: box; corner_m moves the map")
    around = written(tmp_path, np.zeros((11, 21)), cell_m=0.1, corner_m=[-1, -0.5])
    assert build(load(run(around))).notes == ()


def test_slopes_of_a_map_are_those_of_its_heights() -> None:
    """Central differences of 1e-5 m over cells of 0.1 m are off by some 1e-8 of the curvature's size."""
    random = np.random.default_rng(5)
    heights = Heights(random.normal(size=(5, 7)), (-0.2, 0.1), 0.1)
    x, y = random.uniform(-0.4, 0.6, 400), random.uniform(-0.1, 0.7, 400)
    height, along, across = heights.tangent(x, y)
    np.testing.assert_allclose(height, heights.at(x, y), rtol=0, atol=1e-13)
    h = 1e-5
    np.testing.assert_allclose(along, (heights.at(x + h, y) - heights.at(x - h, y)) / (2 * h), rtol=0, atol=1e-4)
    np.testing.assert_allclose(across, (heights.at(x, y + h) - heights.at(x, y - h)) / (2 * h), rtol=0, atol=1e-4)
    assert not along[(x < -0.2) | (x > 0.4)].any()
    assert not across[(y < 0.1) | (y > 0.5)].any()


def test_bodies_leaving_the_map_in_a_run_are_reported(tmp_path: Path) -> None:
    ball = {"type": "rigid", "density_kg_m3": 800, "shapes": [{"type": "sphere", "diameter_m": 0.06}]}
    start = {"joints": {"flight": {"x_m": 0.05, "z_m": 0.035, "vx_m_s": 1.0}}}
    given = {"model": one_body("ball", ball), "medium": "rft3d_sand", "initial": start, "solver": {"end_time_s": 0.3}}
    leaving = {}
    for columns in (6, 30):  # to x = 0.15 m, or 1.35 m
        ground = written(tmp_path, np.zeros((5, columns)), cell_m=0.05, corner_m=[-0.1, -0.1])
        results = simulate(load(given | {"bed": ground}))
        leaving[columns] = [warning for warning in results.warnings if "left the map of heights" in warning]
        touching = results["ball_x_m"][results["ball_granular_z_N"] != 0.0].max()
    assert not leaving[30]
    (warning,) = leaving[6]
    assert "the map is from x = -0.1 to 0.15 m and from y = -0.1 to 0.1 m" in warning
    assert float(warning.split(" by ")[1].split()[0]) == pytest.approx(touching - 0.15, rel=0.01)


def test_a_picture_is_a_map_of_its_grey_levels(tmp_path: Path) -> None:
    """Upper rows lie farther to the left; a picture of 16 bits is read to the last of them."""
    levels = np.random.default_rng(5).integers(0, 65536, (4, 6)).astype(np.uint16)
    Image.fromarray(levels[::-1].copy()).save(tmp_path / "ground.png")
    keys = {"cell_m": 0.1, "scale": 1e-7}
    table = written(tmp_path, levels, **keys)
    picture = {"height_m": 0.0, "height_map": {"file": str(tmp_path / "ground.png"), **keys}}
    of_picture, of_table = (build(load(run(bed))).bed.heights for bed in (picture, table))  # type: ignore[union-attr]
    np.testing.assert_array_equal(of_picture.values, of_table.values)
    Image.fromarray(np.zeros((4, 4, 3), np.uint8)).save(tmp_path / "ground.png")
    with pytest.raises(SceneError, match="the picture is of the kind RGB; allowed is one of grey levels alone"):
        build(load(run(picture)))


def mapped(share: float = 1.0, **ground: Any) -> SpatialLoad:
    """The load on a tilted plate, by default on a map of heights, with a share of the size of its facets."""
    random = np.random.default_rng(4)
    given = ground or {"heights": Heights(0.006 * random.normal(size=(9, 9)), (-0.2, -0.2), 0.05)}
    bed = SpatialLoad(Rft3d(1600.0, 0.5, 0.3), 0.0, static=Smooth(1e-9), **given)
    bed.add_shape(Body("body", range(7)), Plate((0.2, 0.15)), rotation=rotations.of_rpy([0.3, 0.5, 0.2]), share=share)
    bed.close()
    return bed


def test_forces_on_a_map_converge_with_the_square_of_facets() -> None:
    """Each facet sees the plane at its own middle. With one plane for 64 of them they fell with their size alone."""

    def force(share: float) -> np.ndarray:
        bed, start = mapped(share), np.array([0.01, -0.02, -0.01, 1.0, 0.0, 0.0, 0.0])
        bed.start(start)
        return np.asarray(bed.force(start, np.array([0.3, 0.1, -0.5, 0.0, 0.0, 0.0, 0.0]), np.zeros(7)))

    fine = force(0.1)
    errors = [float(np.linalg.norm(force(share) - fine)) for share in (2.0, 1.0, 0.5)]
    assert errors[0] < 0.02 * np.linalg.norm(fine)
    assert 1.7 < np.log2(errors[0] / errors[2]) / 2.0 < 2.4, errors


def test_facets_on_a_map_are_taken_together() -> None:
    """As on a plane in blocks: one at a time they took up to four times as long."""
    map_load, sloped_load = mapped(), mapped(slope=[0.0, 0.0, 0.0])
    assert (
        len(map_load.batches[0].clusters)
        == len(sloped_load.batches[0].clusters)
        < len(map_load.batches[0].elements) / 32
    )
