"""Mass properties and outlines of shapes, against a brute count of small squares; which shapes may meet which sand."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pydantic
import pytest
from matplotlib.path import Path

from granular_contact.config import schema
from granular_contact.errors import SceneError
from granular_contact.scene.shapes import build_shape

STRIPS = 400  # chords of curves: their polygon is the curve to 1e-4


def shape(**keys: Any) -> Any:
    return schema.Rigid(type="rigid", density_kg_m3=1.0, shapes=[keys]).shapes[0]


def counted(inside: Callable[[np.ndarray], np.ndarray], reach: float) -> tuple[float, np.ndarray, float]:
    """Area, centre and polar second moment per area about the centre, from 800 x 800 squares."""
    axis = (np.arange(800) + 0.5) / 400 - 1.0
    points = reach * np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    held = points[inside(points)]
    center = held.mean(axis=0)
    return len(held) * (reach / 400) ** 2, center, float(np.sum((held - center) ** 2, axis=1).mean())


def near_line(line: np.ndarray, half: float) -> Callable[[np.ndarray], np.ndarray]:
    """Points beside the pieces of a polyline, at most `half` away, without round ends."""

    def inside(points: np.ndarray) -> np.ndarray:
        is_inside = np.zeros(len(points), bool)
        order = np.argsort(points[:, 0])
        x = points[order, 0]
        for a, b in pairwise(line):
            left, right = sorted((a[0], b[0]))
            near = order[np.searchsorted(x, left - half) : np.searchsorted(x, right + half, "right")]
            along = (points[near] - a) @ (b - a) / np.sum((b - a) ** 2)
            off = points[near] - a - along[:, None] * (b - a)
            is_inside[near] |= (along >= 0) & (along <= 1) & (np.linalg.norm(off, axis=1) <= half)
        return is_inside

    return inside


ARC = {"type": "arc", "radius_m": 0.05, "center_m": [0.01, -0.02], "from_deg": -40, "to_deg": -250}
SOLIDS: dict[str, dict[str, Any]] = {
    "disc": {"type": "disc", "diameter_m": 0.08, "thickness_m": 0.5, "center_m": [0.02, -0.01]},
    "polygon": {"type": "polygon", "width_m": 0.5, "points_m": [[0, 0], [0.08, 0.01], [0.03, 0.02], [0.05, 0.07]]},
    "clockwise": {"type": "polygon", "width_m": 0.5, "points_m": [[0.05, 0.07], [0.03, 0.02], [0.08, 0.01], [0, 0]]},
    "foot": {"type": "foot", "length_m": 0.1, "height_m": 0.03, "width_m": 0.5, "center_m": [0.01, 0], "tilt_deg": -20},
    "round foot": {"type": "foot", "length_m": 0.06, "height_m": 0.06, "width_m": 0.5},
}


@pytest.mark.slow
@pytest.mark.parametrize("keys", SOLIDS.values(), ids=list(SOLIDS))
def test_solids_have_the_mass_of_their_outline(keys: dict[str, Any]) -> None:
    solid, lump = build_shape("part", shape(**keys), STRIPS)
    assert solid.kind == "outline"
    np.testing.assert_array_equal(solid.points[0], solid.points[-1])
    area, center, gyration = counted(Path(solid.points).contains_points, 0.12)
    # Squares of 0.3 mm along an outline of 0.3 m, in and out at random: some 1.5e-3 of the area; a disc's 400 chords
    # and a foot's 24 at each end lose as much again.
    assert lump.mass / 0.5 == pytest.approx(area, rel=3e-3)
    np.testing.assert_allclose(lump.center, center, atol=1e-4)
    assert lump.inertia / lump.mass == pytest.approx(gyration, rel=5e-3)


BARS: dict[str, dict[str, Any]] = {
    "plate": {"type": "plate", "width_m": 0.5, "thickness_m": 0.01, "start_m": [-0.03, 0.02], "end_m": [0.05, 0.04]},
    "arc": {**ARC, "width_m": 0.5, "thickness_m": 0.004},
    "polyline": {
        "type": "polyline", "width_m": 0.5, "thickness_m": 0.002, "points_m": [[0, 0], [0.08, 0.0], [0.08, 0.05]],
    },
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("keys", BARS.values(), ids=list(BARS))
def test_flat_bars_have_the_mass_of_their_band(keys: dict[str, Any]) -> None:
    bar, lump = build_shape("part", shape(**keys), STRIPS)
    assert bar.kind == "flat"
    area, center, gyration = counted(near_line(bar.points, keys["thickness_m"] / 2), 0.1)
    # As above, with squares of 0.25 mm along bands of 2 to 10 mm, and half a square of thickness at the corners.
    assert lump.mass / 0.5 == pytest.approx(area, rel=2e-2)
    np.testing.assert_allclose(lump.center, center, atol=3e-4)
    assert lump.inertia / lump.mass == pytest.approx(gyration, rel=2e-2)


def test_round_bars_and_balls_by_hand() -> None:
    arc, lump = build_shape("part", shape(**{**ARC, "from_deg": 0, "to_deg": -180}, diameter_m=0.004), STRIPS)
    assert arc.kind == "round"
    # Half a ring of radius R: length pi R, centre 2 R / pi from that of the circle; round-off.
    assert lump.mass == pytest.approx(np.pi * 0.002**2 * np.pi * 0.05, rel=1e-13)
    np.testing.assert_allclose(lump.center, [0.01, -0.02 + 2 * 0.05 / np.pi], rtol=1e-13)
    assert lump.inertia / lump.mass == pytest.approx(0.05**2 - (2 * 0.05 / np.pi) ** 2 + 0.004**2 / 16, rel=1e-13)
    ball, lump = build_shape("part", shape(type="sphere", diameter_m=0.02, center_m=[0.1, 0.2]), STRIPS)
    assert (ball.kind, ball.drop) == ("ball", 0.01)
    assert lump.mass == pytest.approx(4 / 3 * np.pi * 0.01**3, rel=1e-14)
    assert lump.inertia / lump.mass == pytest.approx(0.4 * 0.01**2, rel=1e-14)


def test_a_given_mass_stands_for_the_shapes(scene_of: Callable[..., Any]) -> None:
    scene = scene_of(
        "{type: rigid, mass_kg: 2, inertia_kg_m2: 0.03, center_of_mass_m: [0.1, 0],"
        " shapes: [{type: cylinder, diameter_m: 0.01, end_m: [0.2, 0]}]}"
    )
    assert (scene.rigid[0].mass, scene.rigid[0].inertia) == (2.0, 0.03)
    np.testing.assert_allclose(scene.rigid[0].shapes[0].points, [[-0.1, 0], [0.1, 0]], atol=1e-15)


@pytest.mark.parametrize(
    "spec", [BARS["plate"], BARS["arc"], SOLIDS["disc"], SOLIDS["foot"], {"type": "sphere", "diameter_m": 0.05}]
)
def test_shapes_that_the_law_does_not_take_are_refused(scene_of: Callable[..., Any], spec: dict[str, Any]) -> None:
    body = "{{type: rigid, density_kg_m3: 1000, shapes: [{shape}]}}"
    text = ", ".join(f"{key}: {value}" for key, value in spec.items())
    with pytest.raises(SceneError, match=r"model\.bodies\.body: can get into the sand, but play_sand takes round bars"):
        scene_of(body.format(shape=f"{{{text}}}"))
    scene_of(body.format(shape=f"{{{text}, in_sand: false}}, {{type: cylinder, diameter_m: 0.01, end_m: [0.2, 0]}}"))


def test_a_polygon_that_crosses_itself_is_refused() -> None:
    """Its halves would count against each other: a bow tie of two triangles once had a negative inertia."""
    tie = [[0, 0], [0.1, 0], [0, 0.1], [0.08, 0.1]]
    with pytest.raises(pydantic.ValidationError, match="sides after corners 2 and 4 cross"):
        shape(type="polygon", width_m=0.5, points_m=tie)
    pinched = [[0, 0], [0.1, 0], [0.05, 0.05], [0.1, 0.1], [0, 0.1], [0.05, 0.05]]
    assert shape(type="polygon", width_m=0.5, points_m=pinched)


def test_every_solid_of_the_schema_has_an_outline_of_positive_area() -> None:
    """Slivers once passed the schema and stopped the run."""
    sliver = shape(type="polygon", width_m=0.5, points_m=[[0, 0], [1e5, 0], [1e5, 1e-6]])
    sole = shape(type="foot", width_m=0.5, length_m=1e3, height_m=1e-3)
    for spec in (sliver, sole):
        outline = build_shape("body", spec, 4)[0].points
        (x, y), (u, w) = outline.T, np.roll(outline, -1, axis=0).T
        assert abs(np.sum(x * w - u * y)) > 2e-13 * np.ptp(outline, axis=0).max() ** 2
    with pytest.raises(pydantic.ValidationError, match="allowed is at most 1e"):
        shape(type="foot", width_m=0.5, length_m=1e4, height_m=1e-3)


def test_a_polygon_encloses_an_area_wherever_it_stands() -> None:
    """Seen from afar it was lost in round-off, and what lies on a line was given one by it."""
    corners = np.add([[0.0, 0.0], [2e-3, 0.0], [0.0, 1e-3]], [1e4, -3e4])
    assert shape(type="polygon", width_m=0.5, points_m=corners.tolist())
    line = [[1899.26341105563, -540.2907930811655], [1899.3040574734407, -540.1400673924912]]
    line.append([1899.4512594588564, -539.5942106646154])
    with pytest.raises(pydantic.ValidationError, match="encloses no area"):
        shape(type="polygon", width_m=0.5, points_m=line)
