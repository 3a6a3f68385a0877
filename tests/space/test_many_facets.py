"""Facets cost memory and time: more than a million are refused before they are made, with the size that is allowed."""

from __future__ import annotations

import re
import time
from typing import Any

import numpy as np
import pytest
from support_models import one_body
from support_refusals import faults_of

from granular_contact import Box, Capsule, Cone, Cylinder, Mesh, Plate, Sphere, load, preset, simulate
from granular_contact.errors import SceneError
from granular_contact.run import begin
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.space import elements, triangles
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.triangles import MOST_FACETS
from granular_contact.scene import build

SQUARE = Mesh([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]], [[0, 1, 2], [0, 2, 3]], thin=True)
SHAPES = [
    *(Box((0.2, 0.1, 0.04)), Cylinder(0.2, 0.1), Sphere(0.1), Capsule(0.1, 0.2), Cone(0.1, 0.2), Plate((0.2, 0.1))),
    SQUARE,
]


def refused(shape: Any, size: float) -> str:
    began = time.perf_counter()
    (fault,) = faults_of(SceneError, shape.facets, size)
    assert time.perf_counter() - began < 20.0  # a second here; without the bound it takes all memory
    assert fault.key == "facet_size"
    return fault.message


@pytest.mark.parametrize("shape", SHAPES, ids=lambda solid: type(solid).__name__.lower())
def test_any_shape_in_facets_too_small_is_refused_with_the_size_allowed(shape: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr(triangles, "MOST_FACETS", 20_000)
    for size in (1e-300, 1e-9, 1e-5):
        message = refused(shape, size)
    sizes = re.search(r"got (\S+) m, of which \S+ m2 takes more than 20,000 facets, .*; (\S+) m will do", message)
    assert sizes
    assert float(sizes[1]) == 1e-5
    assert 1_000 < len(shape.facets(float(sizes[2])).area) <= 20_000


def test_a_mesh_of_too_many_triangles_is_reported(monkeypatch: Any) -> None:
    monkeypatch.setattr(triangles, "MOST_FACETS", 1)
    assert "this surface of 2 triangles takes more than 1 facets" in refused(SQUARE, 1.0)
    assert len(SQUARE.corners(np.inf)) == 2  # to be drawn


def foot(**shape: Any) -> dict[str, Any]:
    """A foot on sand in space."""
    inertia = {"xx": 0.01, "yy": 0.02, "zz": 0.02}
    body = {"type": "rigid", "mass_kg": 5, "inertia_kg_m2": inertia, "shapes": [shape]}
    return {"model": one_body("foot", body), "medium": "rft3d_sand"}


@pytest.mark.parametrize(
    "shape",
    [
        {"type": "box", "size_m": [0.2, 0.1, 0.04]},
        {"type": "box", "size_m": [9e5, 0.1, 0.04]},
        {"type": "cylinder", "diameter_m": 0.2, "length_m": 0.1},
        {"type": "sphere", "diameter_m": 0.2},
    ],
)
def test_check_reports_too_many_facets_with_the_key(shape: dict[str, Any]) -> None:
    (fault,) = faults_of(SceneError, build, load(foot(**shape, facet_size_m=1e-5)))
    assert fault.key == "model.bodies.foot.shapes.0.facet_size_m"
    assert f"{MOST_FACETS:,} facets, 0.7 GB of memory" in fault.message


def test_tiny_facets_out_of_the_sand_are_allowed() -> None:
    build(load({**foot(type="sphere", diameter_m=0.2, facet_size_m=1e-5, in_sand=False), "medium": None}))


def test_the_limit_of_facets_counts_all_shapes_of_a_bed(monkeypatch: Any) -> None:
    monkeypatch.setattr("granular_contact.sand.space.load.MOST_FACETS", 5000)
    bed = SpatialLoad(preset("rft3d_sand"), 0.0)
    box, body = Box((0.2, 0.1, 0.04)), Body("foot", range(7))
    each = len(box.facets().area)
    for _ in range(5000 // each):
        bed.add_shape(body, box)
    with pytest.raises(
        SceneError, match=r"got [\d,]+ facets in all; allowed are 5,000, .*: a larger accuracy, larger facets"
    ):
        bed.add_shape(body, box)


def test_making_them_counts_as_wall_time(monkeypatch: Any) -> None:
    made = elements.cut_surface

    def slow(*given: Any) -> Any:
        time.sleep(0.5)
        return made(*given)

    monkeypatch.setattr(elements, "cut_surface", slow)
    results = simulate({**foot(type="sphere", diameter_m=0.1), "solver": {"end_time_s": 10, "max_wall_s": 0.5}})
    assert results.status.code == "time_limit"
    assert results["time_s"][-1] < 1.0


@pytest.mark.parametrize("config", ["hexapod", "snake", "walker_in_space"])
def test_a_shape_that_bodies_share_is_cut_once(config: str, monkeypatch: Any) -> None:
    scene: Any = build(load(config))
    cut, made = [], elements.cut_surface
    monkeypatch.setattr(elements, "cut_surface", lambda shape, *sizes: cut.append(shape) or made(shape, *sizes))
    begin(scene)
    parts = [part for body in scene.rigid for part in body.parts if part.in_sand]
    assert len(cut) == len({id(part.shape) for part in parts}) <= 0.5 * len(parts)


# ---- sizes of bodies ----

FAR = {
    "a length": {"type": "link", "length_m": 9e18, "diameter_m": 0.01, "density_kg_m3": 1000},
    "a disc": {
        **{"type": "rigid", "mass_kg": 5, "inertia_kg_m2": 0.02},
        "shapes": [{"type": "disc", "diameter_m": 2e7, "thickness_m": 0.1}],
    },
}


@pytest.mark.parametrize("name", FAR)
def test_a_body_larger_than_any_is_refused(name: str) -> None:
    hinge = {"type": "hinge", "parent": "ground", "child": "part"}
    model = {"name": "large", "bodies": {"part": FAR[name]}, "joints": {"pivot": hinge}}
    with pytest.raises(SceneError, match=r"model.bodies.part: reaches .* m; allowed is less than 1e\+06 m"):
        build(load({"model": model, "medium": "rft_generic"}))
    with pytest.raises(SceneError, match=r"model.bodies.foot: reaches .* is it in another unit than m\?"):
        build(load(foot(type="sphere", diameter_m=9e18)))


def test_a_body_that_starts_farther_away_than_any_is_refused() -> None:
    far = foot(type="sphere", diameter_m=0.1)
    far["model"]["joints"]["flight"]["parent_point_m"] = [2e6, 0.0, 0.0]
    with pytest.raises(SceneError, match=r"foot: starts at a distance of 2e\+06 m; allowed is less than 1e\+06 m"):
        build(load(far))
