"""Shapes and meshes: what they enclose, how finely they are cut, what is refused and with which sentence."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_space import BODY, PLAY, SAND, load_on, message

from granular_contact import Bar, Box, Capsule, Cone, Cylinder, Mesh, Plate, Poncelet, Rft, Sphere
from granular_contact.geometry.mesh import areas
from granular_contact.sand.space.facets import Size, facet_rows, rectangle_facets, triangle_facets
from granular_contact.sand.space.load import SpatialLoad

D, H = 0.1, 0.15
SOLIDS = {
    "box": (Box((0.1, 0.2, 0.05)), 0.1 * 0.2 * 0.05, 2 * (0.02 + 0.005 + 0.01)),
    "cylinder": (Cylinder(D, H), np.pi * D**2 / 4 * H, np.pi * D * (D / 2 + H)),
    "sphere": (Sphere(D), np.pi * D**3 / 6, np.pi * D**2),
    "capsule": (Capsule(D, H), np.pi * D**3 / 6 + np.pi * D**2 / 4 * H, np.pi * D**2 + np.pi * D * H),
    "cone": (Cone(D, H), np.pi * D**2 / 12 * H, np.pi * D / 2 * (D / 2 + np.hypot(D / 2, H))),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_are_closed_and_as_large_as_they_should_be(name: str) -> None:
    shape, volume, area = SOLIDS[name]
    for size, off in ((None, 0.03), (0.01, 0.005)):
        corners = shape.corners(size)
        cross = areas(corners)
        assert np.einsum("ij,ij->", corners[:, 0], cross) / 3 == pytest.approx(volume, rel=off)
        assert np.linalg.norm(cross, axis=1).sum() == pytest.approx(area, rel=off)
        assert np.abs(cross.sum(axis=0)).max() < 1e-12
    assert np.linalg.norm(np.roll(corners, 1, axis=1) - corners, axis=2).max() <= 0.01 * (1 + 1e-12)
    whole = shape.corners(10.0)
    Mesh(whole.reshape(-1, 3), np.arange(3 * len(whole)).reshape(-1, 3))  # is not refused: closed, outside out


@pytest.mark.parametrize("name", SOLIDS)
def test_facets_have_the_area_of_the_surface_and_enclose_its_volume(name: str) -> None:
    """Of round surfaces, too, whose patches have their own centroids and mean normals: to second order."""
    shape, volume, area = SOLIDS[name]
    off = []
    for size in (0.01, 0.005):
        made = shape.facets(size)
        assert made.area.sum() == pytest.approx(area, rel=1e-9)
        off.append(abs(float(made.area @ np.sum(made.place * made.normal, axis=1)) / 3.0 / volume - 1.0))
        assert np.abs(made.area @ made.normal).max() < 5e-3 * area
    assert off[1] < max(0.35 * off[0], 1e-12)
    assert off[0] < 2e-2


@pytest.mark.parametrize("size", [0.02, 0.005])
def test_patches_of_a_ball_do_not_know_its_spin(size: float) -> None:
    """Of a ball that spins n . v is 0: along an edge e it grows by e . (n x w) + k e . (w x r), with r = n / k."""
    made = Sphere(D).facets(size)
    # (Patches around the poles have their own centre, as all have.)
    np.testing.assert_allclose(made.curve * np.linalg.norm(made.place, axis=1)[:, None], 1.0, rtol=1e-9)


@pytest.mark.parametrize("name", SOLIDS)
def test_a_larger_solid_is_cut_alike(name: str) -> None:
    """Sixteen times as large: all that is computed of it differs in the exponent of two alone."""
    shape = SOLIDS[name][0]
    sizes = {
        key: tuple(16.0 * np.array(size)) if key == "size" else 16.0 * size for key, size in vars(shape).items() if size
    }
    larger = type(shape)(**sizes)
    for made, scaled in ((shape.corners(), larger.corners()), (shape.drawn(), larger.drawn())):
        np.testing.assert_allclose(scaled, 16.0 * made, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(larger.facets().place, 16.0 * shape.facets().place, rtol=1e-12, atol=1e-12)


def test_a_capsule_without_a_length_is_cut_as_a_sphere() -> None:
    for size in (None, 0.02):
        levels = [np.unique(np.round(shape.corners(size)[..., 2], 6)) for shape in (Sphere(D), Capsule(D, 1e-9))]
        np.testing.assert_allclose(*levels, atol=1e-6)


@pytest.mark.parametrize(("name", "sides"), [("cylinder", 48), ("cone", 48), ("sphere", 24), ("capsule", 24)])
def test_round_bodies_are_drawn_round(name: str, sides: int) -> None:
    """A regular polygon of n sides with the area of its circle is pi^2 / 3 n^2 of the radius away from it at most."""
    corners = SOLIDS[name][0].drawn()
    widest = corners[np.abs(np.hypot(corners[..., 0], corners[..., 1]) / (D / 2) - 1.0) < 0.02]
    angles = np.unique(np.round(np.arctan2(widest[:, 1], widest[:, 0]), 6) % np.round(2.0 * np.pi, 6))
    assert len(angles) >= sides
    if name in ("sphere", "capsule"):  # from pole to pole half as many
        assert len(np.unique(np.round(corners[..., 2], 6))) > sides // 2
    assert len(corners) < 1000  # which a player and a report hold


@pytest.mark.parametrize("name", SOLIDS)
def test_edges_of_facets_are_in_their_planes(name: str) -> None:
    """Counter-clockwise about the normal; of what is round the second one is level, along the parallel."""
    made = SOLIDS[name][0].facets(0.02)
    for edge in (made.a, made.b):
        assert np.abs(np.sum(edge * made.normal, axis=1)).max() < 1e-12
    assert (np.sum(np.cross(made.a, made.b) * made.normal, axis=1) > 0.1 * made.area / 4.0).all()
    if name != "box":
        off_axis = np.hypot(made.place[:, 0], made.place[:, 1]) > 1e-6
        assert np.abs(made.b[off_axis, 2]).max() < 1e-12
        assert np.abs(np.sum(made.b * made.place, axis=1)[off_axis]).max() < 1e-12


@pytest.mark.parametrize("name", SOLIDS)
def test_facets_are_alike_on_all_sides(name: str) -> None:
    """The mirror image of each facet in the planes of the axes is one of the others; a cone has no image in z."""
    made = SOLIDS[name][0].facets(0.02)
    for axis in range(2 if name == "cone" else 3):
        flip = np.ones(3)
        flip[axis] = -1.0
        images = np.column_stack([flip * made.place, flip * made.normal, made.area])
        facets = np.column_stack([made.place, made.normal, made.area])
        far = np.abs(images[:, None] - facets[None]).max(axis=2)
        assert far.min(axis=1).max() < 1e-12
        assert len(set(far.argmin(axis=1).tolist())) == len(facets)


def test_a_facet_reaches_as_far_as_its_farthest_corner() -> None:
    """A triangle, and a parallelogram with half edges a and b."""
    rng = np.random.default_rng(4)
    corner, a, b = rng.normal(size=(3, 3))
    triangle = np.array([corner, corner + a, corner + b])
    parallelogram = np.array([s * a + t * b for s in (-1, 1) for t in (-1, 1)])
    flat = triangle_facets(triangle[None]), rectangle_facets(corner, a, b, Size(np.inf))
    for facets, corners in zip(flat, (triangle - triangle.mean(axis=0), parallelogram), strict=True):
        (row,) = facet_rows(facets, np.zeros((0, 8)), thin=False)
        assert row[3] == pytest.approx(np.linalg.norm(corners, axis=1).max(), rel=1e-12)


def test_neighbours_stay_together() -> None:
    clusters = load_on(SAND, Sphere(D), 0.002).lines[0].clusters
    assert len(clusters) > 20
    assert np.median(clusters["radius"]) < 0.35 * D


def test_facets_without_a_size_follow_the_error_that_is_allowed() -> None:
    """Errors go with the square of the size, so there are as many more facets as the error is smaller."""
    for shape, *_ in SOLIDS.values():
        counts = [len(shape.facets(accuracy=error).area) for error in (8e-3, 2e-3, 5e-4)]
        for fewer, more in pairwise(counts):
            assert more / fewer == pytest.approx(4.0, rel=0.25)
        assert len(shape.facets().area) == len(shape.facets(accuracy=3e-3).area)


CUBE = Box((0.1, 0.1, 0.1)).corners(10.0)


def arrays(corners: Any) -> tuple[Any, Any]:
    flat = np.asarray(corners).reshape(-1, 3)
    return flat, np.arange(len(flat)).reshape(-1, 3)


def test_an_impossible_mesh_is_refused() -> None:
    points, faces = arrays(CUBE)
    assert "it is open: 4 edges belong to one triangle only" in message(Mesh, points, faces[:10])
    flipped = faces.copy()
    flipped[3] = flipped[3][::-1]
    assert "at 3 edges two triangles are turned opposite ways" in message(Mesh, points, flipped)
    assert "it is inside out" in message(Mesh, points, faces[:, ::-1])
    flat = np.vstack([faces, [[0, 0, 1]]])
    assert Mesh(points, flat).notes == ("1 of its 13 triangles have no area and are left out, the first is 13",)
    assert "none of its 2 triangles has an area" in message(Mesh, points, flat[[12, 12]])
    both = message(Mesh, 1000 * points, np.vstack([faces[1:], [[0, 0, 1]]]))
    assert "it is 100 x 100 x 100 m: if it is in millimetres, give the scale 0.001" in both
    assert "it is open: 3 edges" in both
    assert len(both.splitlines()) == 2
    np.testing.assert_allclose(Mesh(1000 * points, faces, scale=0.001).vertices, points)
    assert "faces: got numbers from 0 to 35, allowed are 0 to 9" in message(Mesh, points[:10], faces)
    assert "vertices: got an array of shape (36, 2)" in message(Mesh, points[:, :2], faces)
    Mesh(points, faces[:10], thin=True)


def test_meshes_are_read_from_files(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    points, faces = arrays(CUBE)
    for kind in ("stl", "obj", "ply"):
        path = tmp_path / f"cube.{kind}"
        trimesh.Trimesh(points, faces, process=False).export(path)
        corners = Mesh.read(path).corners(10.0)
        np.testing.assert_allclose(np.sort(corners.reshape(-1, 3), axis=0), np.sort(points, axis=0), atol=1e-7)
    assert "there is no such file" in message(Mesh.read, tmp_path / "none.stl")
    assert "got a .step file, allowed are stl, obj, ply" in message(Mesh.read, tmp_path / "cube.step")
    (tmp_path / "broken.stl").write_text("solid nothing", encoding="utf-8")
    assert "broken.stl" in message(Mesh.read, tmp_path / "broken.stl")


def test_shapes_that_no_law_takes_are_reported() -> None:
    line = Bar([[0, 0, 0], [0, 0, 0.1]], 0.01)
    assert "in space nothing acts on a Bar: rft takes surfaces" in message(load_on, Rft(), line)
    assert "nothing acts on a Box: lee_marghitu takes a Bar" in message(load_on, PLAY, Box((0.1, 0.1, 0.1)))
    assert "nothing acts on a Cone: poncelet takes a Sphere" in message(load_on, Poncelet(1.0, 1.0), Cone(0.1, 0.1))


def test_impossible_shapes_are_refused() -> None:
    assert "size: got (0.1, -1, 0.1), allowed are 3 numbers above 0" in message(Box, (0.1, -1, 0.1))
    assert "Box: size: got (0.1, 0.1), allowed are 3 numbers above 0" in message(Box, (0.1, 0.1))
    assert "Plate: size: got 0.1, allowed are 2 numbers above 0" in message(Plate, 0.1)
    assert "Sphere: diameter: got '40 mm', allowed is a number above 0" in message(Sphere, "40 mm")
    assert "diameter: got nan" in message(Sphere, float("nan"))
    assert "points: got an array of shape (2, 2), allowed are (k, 3)" in message(Bar, [[0, 0], [1, 1]], 0.01)
    assert "the same point twice" in message(Bar, [[0, 0, 0], [0, 0, 0]], 0.01)
    assert "up: got [0, 0, 0], allowed is a direction" in message(SpatialLoad, SAND, 0.0, up=[0, 0, 0])
    assert "surface: got [0.0, 1.0], allowed in space is a finite number" in message(SpatialLoad, SAND, [0.0, 1.0])
    assert "slope: got 0.3, allowed in space are three" in message(SpatialLoad, SAND, 0.0, slope=0.3)
    load = SpatialLoad(SAND, 0.0)
    assert "shape: got 'box', allowed is a shape, such as Box(" in message(load.add_shape, BODY, "box")
    assert "rotation: got" in message(load.add_shape, BODY, Plate((0.1, 0.1)), rotation=np.diag([1, 1, -1]))
    assert "position: got [0, 0]" in message(load.add_shape, BODY, Plate((0.1, 0.1)), [0, 0])
    assert "facet_size: got 0" in message(load.add_shape, BODY, Plate((0.1, 0.1)), facet_size=0)


@pytest.mark.parametrize("shape", [Cone(0.08, 0.06), Cylinder(0.08, 0.06)], ids=["cone", "cylinder"])
def test_patches_around_a_side_turn_no_farther_than_asked(shape: Cone | Cylinder) -> None:
    """Around the tip of a cone as well, where as many as their edges ask for would be four."""
    facets = shape.cut_facets(Size(edge=0.02, turn=0.12))
    facets = facets.subset(np.abs(facets.normal[:, 2]) < 0.99)
    side, heights = facets.normal, np.round(facets.place[:, 2], 9)
    for z in np.unique(heights):
        around = np.sort(np.arctan2(side[heights == z, 1], side[heights == z, 0]))
        assert np.diff(around).max() <= 0.12
