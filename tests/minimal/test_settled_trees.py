"""Trees that begin in static equilibrium: the engine finds it, and minimal coordinates begin from it."""

from __future__ import annotations

import numpy as np
import pytest
from support_runs import scene_of, simulate

from granular_contact.errors import SceneError
from granular_contact.run import begin
from granular_contact.scene.methods import reason

LINK = "diameter_m: 0.00635, density_kg_m3: 2700"
HOLD = "gain_Nm_per_rad: 5, rate_gain_Nm_s_per_rad: 0.05"
# A leg on a vertical rail, on a slope; the dry friction of its knee slides until it stands.
LEG = f"""
model:
  name: leg
  bodies:
    hip: {{type: link, length_m: 0.04, {LINK}}}
    thigh: {{type: link, length_m: 0.1, {LINK}}}
    shank: {{type: link, length_m: 0.1, {LINK}}}
  joints:
    rail: {{type: slider, parent: ground, child: hip, axis: [0, 1]}}
    swing: {{type: hinge, parent: hip, child: thigh, home_deg: 60}}
    knee:
      type: hinge
      parent: thigh
      child: shank
      parent_point_m: [0.1, 0]
      home_deg: 60
      friction: {{torque_Nm: 0.002, slip_deg: 0.01}}
medium: play_sand
bed: {{slope_deg: 4}}
load: {{strips_per_rigid_part: 32}}
initial: {{settle: true}}
signals:
  stride: {{type: sine, amplitude: 20, frequency_Hz: 1, offset: 60}}
drives:
  swing: {{type: pd, angle_deg: {{type: shared, name: stride}}, {HOLD}}}
  knee: {{type: pd, angle_deg: stride, {HOLD}}}
solver: {{end_time_s: 0.4, accuracy: null, step_s: 2.0e-4}}
"""
# A column on a vertical rail, soft along its axis, that stands on its lower end.
COLUMN = """
model:
  in_space: true
  name: column
  bodies:
    head: {type: rigid, density_kg_m3: 2000, shapes: [{type: box, size_m: [0.06, 0.06, 0.04], in_sand: false}]}
    column:
      type: link
      length_m: 0.2
      diameter_m: 0.00635
      density_kg_m3: 1200
      flexible: {youngs_modulus_Pa: 1.0e7, elements: 4, axial_stiffness_N: 200, axial_damping_N_s: 1}
  joints:
    rail: {type: slider, parent: ground, child: head, axis: [0, 0, 1]}
    clamp: {type: weld, parent: head, child: column, rpy_deg: [0, 90, 0]}
medium: play_sand
bed: {height_m: -0.19}
initial: {settle: true}
solver: {end_time_s: 0.1, accuracy: null, step_s: 2.0e-4}
"""
# An arm whose spring holds its tip in the sand; the engine has a spring of its own for it.
ARM = f"""
model:
  name: arm
  bodies:
    arm: {{type: link, length_m: 0.2, {LINK}}}
  joints:
    swing: {{type: hinge, parent: ground, child: arm, spring: {{stiffness_Nm_per_rad: 0.5, rest_deg: 20}}}}
medium: play_sand
bed: {{height_m: -0.04}}
initial: {{settle: true}}
solver: {{end_time_s: 0.1, accuracy: null, step_s: 2.0e-4}}
"""


WALKER = "initial.settle=true", "solver.accuracy=null", "solver.step_s=4e-4", "solver.end_time_s=0.05"


@pytest.mark.parametrize(
    ("config", "overrides", "columns"),
    [
        pytest.param(LEG, (), ("hip_y_m", "swing_angle_deg", "knee_angle_deg"), id="leg"),
        pytest.param("walker_in_space", WALKER, ("trunk_x_m", "trunk_z_m", "knee_rear_left_angle_deg"), id="walker"),
        pytest.param(COLUMN, (), ("head_z_m",), id="column"),
        pytest.param(ARM, (), ("swing_angle_deg",), id="sprung arm"),
    ],
)
def test_settled_trees_start_and_move_as_by_the_engine(
    config: str, overrides: tuple[str, ...], columns: tuple[str, ...]
) -> None:
    """With the same fixed steps: the start to round-off, the motion to what Newton's method leaves."""
    assert reason(scene_of(config, *overrides)).startswith("in minimal coordinates")
    ours, theirs = simulate(config, *overrides), simulate(config, "method=engine", *overrides)
    for column in columns:
        x = np.interp(ours["time_s"], theirs["time_s"], theirs[column])  # (the engine may halve a step)
        assert ours[column][0] == pytest.approx(x[0], abs=1e-9)
        assert np.abs(ours[column] - x).max() < 1e-4 * np.abs(np.diff(x)).sum() + 1e-9


@pytest.mark.parametrize(
    ("config", "overrides", "column"),
    [
        pytest.param(LEG, ("signals.stride.amplitude=0",), "hip_y_m", id="leg"),
        pytest.param(COLUMN, (), "head_z_m", id="column"),
        pytest.param(ARM, (), "tip_y_m", id="sprung arm"),
    ],
)
def test_settled_trees_stay_at_rest(config: str, overrides: tuple[str, ...], column: str) -> None:
    """Within 1 um/s; with new bristles in sand and knee it would sink by the way on which they yield, 10 um or more."""
    results = simulate(config, *overrides)
    assert results["depth_m"][0] > 1e-3
    assert np.abs(results[column] - results[column][0]).max() < 1e-6 * results["time_s"][-1]
    assert results.warnings == ()


def test_settling_links_in_modes_is_refused() -> None:
    with pytest.raises(SceneError, match=r"initial\.settle is true"):
        scene_of(COLUMN, "method={reduced: {modes: 1}}")


def test_dry_friction_of_joints_is_that_of_the_equilibrium() -> None:
    ours, theirs = (begin(scene_of(LEG, method)).system for method in ("method=minimal", "method=engine"))
    assert ours is not None
    assert theirs is not None
    anchor = theirs.loads["knee"].first_anchor
    assert anchor - np.radians(60.0) > 1e-4  # it slid
    assert ours.loads["knee"].first_anchor == ours.loads["knee"].anchor == pytest.approx(anchor, abs=1e-9)
