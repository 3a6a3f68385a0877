"""Slip, sinkage and forces of wheels in space: along and across the surface below, whatever way the wheel heads."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from granular_contact import Results, load, simulate
from granular_contact.errors import ConfigError
from granular_contact.mechanics.wheels import uncompared
from granular_contact.scene import build

RADIUS, WIDTH, SPEED, RATE = 0.05, 0.03, 0.04, 1.0  # m, m, m/s, rad/s
STEER, SLOPE = 20.0, 12.0  # deg
OF_A_STEP = (RATE * 5e-3) ** 2 / 12  # of rates, which follow from Euler parameters at the ends of steps


def rig(wheel: dict[str, Any] | None = None, slope: float = 0.0, steer: float = 0.0, heading: float = 0.0) -> Any:
    """A wheel that is carried along the slope at a depth of 5 mm and turns; steered, and all of it turned about z."""
    a, h = math.radians(slope), math.radians(heading)
    up = np.array([-math.sin(a) * math.cos(h), -math.sin(a) * math.sin(h), math.cos(a)])
    start = (RADIUS - 0.005) * up  # the axle; the surface goes through the origin
    shape = {"type": "wheel", "radius_m": RADIUS, "width_m": WIDTH, "facet_size_m": 0.01} | (wheel or {})
    turned = {"rpy_deg": [0, -slope, heading]}
    even = {"type": "table", "time_s": [0, 0.1], "interpolation": "linear"}
    return {
        "model": {
            "in_space": True,
            "name": "rig",
            "bodies": {
                "sled": {"type": "rigid", "mass_kg": 1, "inertia_kg_m2": {"xx": 1e-3, "yy": 1e-3, "zz": 1e-3}},
                "rim": {"type": "rigid", "density_kg_m3": 1000, "shapes": [shape]},
            },
            "joints": {
                "rail": {"type": "slider", "parent": "ground", "child": "sled", "axis": [1, 0, 0]}
                | turned
                | {"parent_point_m": start.tolist()},
                "axle": {
                    "type": "hinge",
                    "parent": "sled",
                    "child": "rim",
                    "axis": [0, 1, 0],
                    "rpy_deg": [0, 0, steer],
                },
            },
        },
        "medium": "rft3d_sand",
        "bed": {"height_m": 0.0, "slope_deg": slope, "slope_direction_deg": heading},
        "drives": {
            "rail": {"type": "motion", "position_m": even | {"values": [0, 0.1 * SPEED]}},
            "axle": {"type": "motion", "angle_deg": even | {"values": [0, math.degrees(0.1 * RATE)]}},
        },
        "solver": {"end_time_s": 0.1, "step_s": 5e-3},
        "output": {"figures": False},
    }


def last(results: Results, *names: str) -> np.ndarray:
    return np.array([results[f"rim_{name}"][-1] for name in names])


@pytest.mark.parametrize(("slope", "heading"), [(0.0, 0.0), (SLOPE, 0.0), (SLOPE, 70.0)])
def test_slip_and_sinkage_are_those_of_the_rig(slope: float, heading: float) -> None:
    run = simulate(load(rig(slope=slope, heading=heading)))
    slip, sinkage, side = last(run, "slip", "sinkage_m", "side_force_N")
    assert slip == pytest.approx(1.0 - SPEED / (RATE * RADIUS), abs=OF_A_STEP)
    assert sinkage == pytest.approx(0.005, abs=1e-9)
    pull, support = last(run, "drawbar_pull_N", "load_N")
    assert support > 0.0
    assert abs(side) < 1e-6 * support  # the scene is its own mirror image, but for facets and round-off
    # The same force along the axes of the world.
    force = last(run, "granular_x_N", "granular_y_N", "granular_z_N")
    a, h = math.radians(slope), math.radians(heading)
    along = np.array([math.cos(a) * math.cos(h), math.cos(a) * math.sin(h), math.sin(a)])
    normal = np.array([-math.sin(a) * math.cos(h), -math.sin(a) * math.sin(h), math.cos(a)])
    assert (pull, support) == pytest.approx((force @ along, force @ normal), rel=1e-9)


def test_steered_wheel_has_slip_along_its_heading_and_a_side_force() -> None:
    run = simulate(load(rig(steer=STEER)))
    slip, angle, side = last(run, "slip", "slip_angle_deg", "side_force_N")
    assert slip == pytest.approx(1.0 - SPEED * math.cos(math.radians(STEER)) / (RATE * RADIUS), abs=OF_A_STEP)
    assert angle == pytest.approx(-STEER, abs=1e-9)  # it heads to the left, and drifts to its right
    assert side > 0.0
    numbers = run.summary["wheel"]
    assert numbers["slip"] == pytest.approx(slip, abs=OF_A_STEP)
    assert {"side_force_N", "slip_angle_deg", "sinkage_m", "drawbar_pull_N"} <= numbers.keys()
    (sentence,) = (warning for warning in run.warnings if "slip angle" in warning)
    assert f"wheel has a slip angle of {STEER:.0f} degrees" in sentence


def test_wheels_that_differ_much_from_measured_ones_are_reported() -> None:
    numbers = {"slip": 0.2, "slip_angle_deg": 4.0}
    summary = {"wheel": numbers, "wheel_left": numbers | {"slip": -1.0}, "facets": {}}
    (sentence,) = uncompared(summary)
    assert sentence.startswith("outside the range")
    assert "wheel_left has a slip of -1.00" in sentence


def test_a_smooth_wheel_is_a_cylinder_and_grousers_add_what_they_weigh() -> None:
    grousers = {"count": 8, "height_m": 0.006, "thickness_m": 0.003}
    smooth, toothed = (build(load(rig(wheel))).body("rim") for wheel in ({}, {"grousers": grousers}))
    solid = 1000 * math.pi * RADIUS**2 * WIDTH
    assert smooth.mass == pytest.approx(solid, rel=1e-12)
    np.testing.assert_allclose(np.diag(smooth.inertia)[1], 0.5 * solid * RADIUS**2, rtol=1e-9)
    # The rim between two grousers is of chords: 1 - sin(x)/x of their area is missing, x = 2 pi / CHORDS.
    teeth = 1000 * 8 * 0.006 * 0.003 * WIDTH
    assert toothed.mass == pytest.approx(solid + teeth, rel=2e-3)
    (part,) = toothed.parts
    assert part.wheel is not None
    assert part.wheel.radius == pytest.approx(RADIUS + 0.002)


@pytest.mark.parametrize(("count", "height"), [(12, 8e-3), (16, 8e-3), (5, 2e-3)])
def test_every_facet_of_a_wheel_with_grousers_has_an_area_and_a_normal(count: int, height: float) -> None:
    """Of twelve teeth corners are in a row but for round-off: triangles between them would have neither."""
    wheel = {"radius_m": 0.06, "width_m": 0.04, "grousers": {"count": count, "height_m": height, "thickness_m": 3e-3}}
    (part,) = build(load(rig(wheel))).body("rim").parts
    made = part.shape.facets(0.01)
    assert np.all(made.area > 0.0)
    assert np.linalg.norm(made.normal, axis=1) == pytest.approx(1.0, abs=1e-12)
    assert np.abs(made.area @ made.normal).max() < 1e-12  # m2: the surface is closed


def test_grousers_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ConfigError, match=r"grousers\.thickness_m: got 0\.05; allowed is at most 0\.0353"):
        load(rig({"grousers": {"count": 8, "height_m": 0.006, "thickness_m": 0.05}}))
