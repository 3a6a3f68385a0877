"""The parts of a mechanism that can reach the sand, measured from its pivot wherever the pivot is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support_runs import L_RB, LENGTH, scenario_of, scene_of, simulate

from granular_contact.errors import SceneError
from granular_contact.geometry.surface import greatest_depth, height_at, surface
from granular_contact.scene import build
from granular_contact.scene.bed import Bed
from granular_contact.scene.workspace import MARGIN, can_be_immersed, can_get_below, immersible_elements

# A hub of radius 20 mm, 100 mm above the sand, of a kind that its medium (for bars) does not take, and a link on it.
HUB = """
model:
  name: hub
  bodies:
    hub: {type: rigid, density_kg_m3: 2700, shapes: [{type: disc, diameter_m: 0.04, thickness_m: 0.02, in_sand: true}]}
    arm: {type: link, length_m: 0.3, diameter_m: 0.006, density_kg_m3: 7700}
  joints:
    pin: {type: hinge, parent: ground, child: hub}
    elbow: {type: hinge, parent: hub, child: arm}
medium: play_sand
surface_height_m: -0.1
initial: {joints: {}}
"""
# A ball below an arm: its centre stays 10 mm above the sand, its lowest point gets 20 mm into it.
BALL = """
model:
  name: ball
  bodies:
    arm: {type: rigid, density_kg_m3: 7700, shapes: [{type: cylinder, diameter_m: 0.006, end_m: [0.09, 0], in_sand: false}]}
    ball: {type: rigid, density_kg_m3: 2000, shapes: [{type: sphere, diameter_m: 0.06}]}
  joints:
    pin: {type: hinge, parent: ground, child: arm}
    tip: {type: weld, parent: arm, child: ball, parent_point_m: [0.09, 0]}
medium: {from: glass_beads_katsuragi_durian, stiffness_N_m: 500}
surface_height_m: -0.1
initial: {joints: {}}
"""  # noqa: E501 # one body a line
SOFT = ("medium=rft_generic", "surface_height_m=0")  # takes all but balls
SCENES = (
    (HUB, ()),
    (HUB, ("surface_height_m=-0.015",)),  # the hub is refused
    (HUB, ("bed.slope_deg=20",)),
    (HUB, ("bed.slope_deg=-50", "surface_height_m=-0.03")),  # refused: the slope is nearer than the sand below it
    (HUB, ("bed.profile_m=[[-0.5, -0.3], [-0.2, -0.01], [0.2, -0.01], [0.5, -0.3]]", "surface_height_m=null")),
    (HUB, (*SOFT, "bed.layers=[{top_m: 0.01, medium: play_sand}]")),  # the hub gets into the layer, which is for bars
    (HUB, (*SOFT, "bed.layers=[{top_m: 0.03, medium: play_sand}]")),  # it does not get that deep
    (BALL, ()),
    (BALL, ("surface_height_m=-0.13",)),
)


def shifted(text: str, overrides: tuple[str, ...], by: tuple[float, float]) -> str | list[list[bool]]:
    """Keys of the faults of a scene that was shifted, or which shapes of its bodies the sand is laid over."""
    x, y = by
    scenario = scenario_of(text, *overrides).model_dump(by_alias=True)
    scenario["model"]["joints"]["pin"]["parent_point_m"] = (x, y)
    bed = scenario["bed"] or {}
    if bed.get("profile_m"):
        bed["profile_m"] = [(a + x, b + y) for a, b in bed["profile_m"]]
    else:
        scenario["surface_height_m"] += y - x * math.tan(math.radians(bed.get("slope_deg") or 0.0))
    try:
        scene = build(type(scenario_of(text)).model_validate(scenario))
    except SceneError as error:
        return " ".join(sorted(fault.key for fault in error.faults))
    assert scene.bed is not None
    return [[can_be_immersed(scene.bed, body, shape) for shape in body.shapes] for body in scene.rigid]


@pytest.mark.slow
@pytest.mark.parametrize(("text", "overrides"), SCENES)
@settings(deadline=None, max_examples=5)
@given(by=st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)))
def test_a_shift_changes_nothing_of_what_is_refused(
    text: str, overrides: tuple[str, ...], by: tuple[float, float]
) -> None:
    assert shifted(text, overrides, by) == shifted(text, overrides, (0.0, 0.0))


def test_scenes_at_the_origin_are_accepted_or_refused() -> None:
    shifted_scenes = [shifted(text, overrides, (0.0, 0.0)) for text, overrides in SCENES]
    free, refused, both = [[False], [True]], "model.bodies.hub", [[True], [True]]
    of_hubs = [free, refused, free, refused, refused, "bed.layers.0.medium", both]
    assert shifted_scenes == [*of_hubs, [[False, True]], [[False, False]]]


def test_a_hub_away_from_the_origin_stays_out_of_the_sand() -> None:
    """Today's smallest case: at x = 0 it was built, at x = 0.5 m refused."""
    assert scene_of(HUB, "model.joints.pin.parent_point_m=[0.5, 0]").rigid[0].name == "hub"


def test_a_ball_reaches_by_its_radius() -> None:
    """Its centre gets to 90 mm below the pin, its lowest point to 120 mm; a margin of 2 % is counted in."""
    for depth, touches in ((0.119, True), (0.1 * MARGIN, True), (0.121 * MARGIN, False)):
        scene = scene_of(BALL, f"surface_height_m={-depth}")
        (body,) = scene.rigid
        (ball,) = (shape for shape in body.shapes if shape.kind == "ball")
        assert scene.bed is not None
        assert can_be_immersed(scene.bed, body, ball) == touches


def test_layers_are_refused_to_a_ball_however_little_of_it_gets_in() -> None:
    layer = "{top_m: 0.01, medium: {from: glass_beads_katsuragi_durian, stiffness_N_m: 900}}"
    assert shifted(BALL, (f"bed.layers=[{layer}]",), (0.0, 0.0)) == "bed.layers"
    assert shifted(BALL, (f"bed.layers=[{layer}]", "surface_height_m=-0.13"), (0.0, 0.0)) != "bed.layers"


def test_a_beam_reaches_by_its_length_from_the_pivot() -> None:
    for share, touches in ((0.999, True), (1.001, False)):
        scene = scene_of("pendulum", f"surface_height_m={-share * MARGIN * (L_RB + LENGTH)}")
        (link,) = scene.links
        assert scene.bed is not None
        assert can_get_below(scene.bed, link, np.array([[0.0, 0.0], [link.length, 0.0]])) == touches


def test_immersible_elements_of_a_beam_are_counted_from_its_tip() -> None:
    """Of 16 elements those whose ends are farther from the pivot than the sand: of 2.5 elements from the tip three."""
    far = L_RB + LENGTH * (1.0 - 2.5 / 16)
    scene = scene_of("pendulum", "model.bodies.link.flexible.elements=16", f"surface_height_m={-MARGIN * far}")
    assert scene.bed is not None
    assert immersible_elements(scene.bed, scene.links[0]) == range(13, 16)


def test_reach_of_a_body_welded_at_an_angle_is_its_true_distance() -> None:
    """An arm of 0.09 m and, from its end, 0.09 m square to it: sqrt(2) times 0.09 m from the pin, not 0.18 m."""
    bent = BALL.replace("parent_point_m: [0.09, 0]", "parent_point_m: [0.09, 0], child_point_m: [0, -0.09]")
    (body,) = scene_of(bent).rigid
    assert body.workspace.radius(body.shapes[1].points[0]) == pytest.approx(math.hypot(0.09, 0.09), rel=1e-12)


@settings(deadline=None)
@given(
    corners=st.lists(st.tuples(st.floats(0.01, 1.0), st.floats(-1.0, 1.0)), min_size=1, max_size=5),
    slope=st.floats(-1.5, 1.5),
    radius=st.floats(0.0, 2.0),
    center=st.tuples(st.floats(-2.0, 4.0), st.floats(-2.0, 2.0)),
)
def test_the_greatest_depth_within_a_circle(
    corners: list[tuple[float, float]], slope: float, radius: float, center: tuple[float, float]
) -> None:
    """Against points all along the lower half of the circle, which are 1e-3 rad apart: off by their sagitta."""
    steps = np.array(corners)
    profile = surface(np.column_stack([np.cumsum(steps[:, 0]), steps[:, 1]]), slope)
    angle = np.linspace(-math.pi, 0.0, 3142)
    x, y = center[0] + radius * np.cos(angle), center[1] + radius * np.sin(angle)
    deepest = greatest_depth(profile, np.array(center), radius)
    sampled = float(np.max(height_at(profile, x) - y))
    steepest = 1.0 + np.abs(np.diff(profile[:, 1]) / np.diff(profile[:, 0])).max(initial=0.0)
    assert sampled - 1e-9 <= deepest <= sampled + 1e-3 * radius * steepest + 1e-9


FALLS = """
model:
  name: falls
  bodies: {rod: {type: link, length_m: 0.2, diameter_m: 0.01, density_kg_m3: 2700}}
  joints: {free: {type: free, parent: ground, child: rod}}
medium: play_sand
bed: {slope_deg: 15}
initial: {joints: {free: {angle_deg: 40, vy_m_s: -1}}}
solver: {end_time_s: 0.03, step_s: 1.0e-3}
output: {figures: false}
"""


def test_a_slope_has_no_end() -> None:
    """5 km up the slope the same happens; it went on level from 1 km on. Round-off of the places there is 1e-12 m."""
    at_origin, far_away = (simulate(FALLS, f"model.joints.free.parent_point_m=[{x}, 0]") for x in (0, 5000))
    assert far_away["depth_m"].max() > 0.01
    np.testing.assert_allclose(far_away["depth_m"], at_origin["depth_m"], rtol=0.0, atol=1e-8)
    bed = scene_of(FALLS, "bed.height_m=1").bed
    assert isinstance(bed, Bed)
    x = np.array([-1e6, 0.0, 1e6])
    np.testing.assert_allclose(bed.height(x), 1.0 + x * math.tan(math.radians(15.0)), rtol=1e-14)
