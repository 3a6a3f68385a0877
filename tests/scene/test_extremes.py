"""The tip of a mechanism and the lowest point of round bodies are points of the geometry, for any number of strips."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from granular_contact import load
from granular_contact.scene import build

STRIPS = (1, 16, 48, 49, 64, 97)


def scene(shape: dict[str, Any], joint: dict[str, Any], strips: int, **more: Any) -> Any:
    body = {"type": "rigid", "density_kg_m3": 1000, "shapes": [shape]}
    joint = {"parent": "ground", "child": "part", **joint}
    model = {"name": "round", "bodies": {"part": body}, "joints": {"joint": joint}}
    return build(load({"model": model, "medium": "rft_generic", "load": {"strips_per_rigid_part": strips}, **more}))


R, CENTRE = 0.05, (0.12, 0.07)
DISC = {"type": "disc", "diameter_m": 2 * R, "thickness_m": 0.02, "center_m": list(CENTRE)}
ARC = {"type": "arc", "radius_m": R, "from_deg": -60, "to_deg": 120, "width_m": 0.02, "thickness_m": 0.002}


@pytest.mark.parametrize("strips", STRIPS)
@pytest.mark.parametrize("home", [0.0, 31.0])
def test_the_tip_of_a_disc_is_its_farthest_point_from_the_pivot(strips: int, home: float) -> None:
    made = scene(DISC, {"type": "hinge", "home_deg": home}, strips)
    centre = float(np.hypot(*CENTRE))
    assert np.linalg.norm(made.tip_position) == pytest.approx(centre + R, rel=1e-12)
    np.testing.assert_allclose(made.tip[1], R * np.array(CENTRE) / centre, atol=1e-12)  # from the centre of mass


def test_tip_of_an_arc_is_its_farthest_point_or_end() -> None:
    for strips in STRIPS:
        at = scene({**ARC, "center_m": [0.1, 0.0]}, {"type": "hinge"}, strips).tip_position
        np.testing.assert_allclose(at, [0.1 + R, 0.0], atol=1e-12)
        # Away from the pivot it is open: the farthest points are its ends, here the last.
        open_arc = {**ARC, "from_deg": 90, "to_deg": 200, "center_m": [0.1, 0.0]}
        at = scene(open_arc, {"type": "hinge"}, strips).tip_position
        np.testing.assert_allclose(np.linalg.norm(at), np.hypot(0.1, R), atol=1e-12)


def test_tip_of_a_disc_on_its_own_centre_is_its_first_point() -> None:
    tips = [scene({**DISC, "center_m": [0, 0]}, {"type": "hinge"}, strips).tip_position for strips in STRIPS]
    np.testing.assert_allclose(tips, np.tile([R, 0.0], (len(STRIPS), 1)), atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0])
@pytest.mark.parametrize("shape", [DISC, {**ARC, "from_deg": 0, "to_deg": 180}], ids=["disc", "arc"])
def test_tip_of_a_falling_body_is_its_lowest_point_above_the_surface(shape: dict[str, Any], angle: float) -> None:
    for strips in STRIPS:
        start = {"initial": {"joints": {"joint": {"angle_deg": angle}}}}
        made = scene({**shape, "center_m": [0.0, 0.0]}, {"type": "free"}, strips, **start)
        (body,) = made.rigid
        low = made.tip_position[1]
        assert low <= body.motion.world(body.shapes[0].points)[:, 1].min() + 1e-12
        if shape["type"] == "disc":
            assert body.motion.position[1] - low == pytest.approx(R, rel=1e-9)
        assert made.surface == pytest.approx(low, abs=1e-12)
