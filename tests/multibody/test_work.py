"""Work in the energy balance: it closes over jumps of the force, or a warning says that it does not."""

from __future__ import annotations

import re

import numpy as np
import pytest
from support_runs import scene_of, simulate

from granular_contact.results import Results
from granular_contact.results.accuracy import IMBALANCE_LIMIT, AccuracyWarning, warning_sentences
from granular_contact.results.energy import accumulate, work

BOX = """
model:
  name: box
  bodies:
    box:
      type: rigid
      density_kg_m3: 2700
      shapes:
        - {type: polygon, points_m: [[-0.03, -0.01], [0.03, -0.01], [0.03, 0.01], [-0.03, 0.01]], width_m: 0.03}
  joints: {fall: {type: free, parent: ground, child: box}}
medium: rft3d_sand
initial: {joints: {fall: {angle_deg: 0, vy_m_s: -1.5, vx_m_s: 0.3}}}
solver: {end_time_s: 0.05, step_s: 2.0e-4}
output: {bodies: all}
"""
ROD = """
model:
  name: rod
  bodies:
    rod: {type: link, length_m: 0.2, diameter_m: 0.006, density_kg_m3: 2700, flexible: {youngs_modulus_Pa: 7e+10}}
  joints: {fall: {type: free, parent: ground, child: rod}}
medium: play_sand
bed: {slope_deg: 12}
initial: {joints: {fall: {angle_deg: 40, vy_m_s: -2}}}
solver: {end_time_s: 0.05, step_s: 2.0e-4}
output: {bodies: all}
"""


def by_mean_power(run: Results, body: str) -> float:
    """Relative imbalance with the work of the medium by the trapezoidal rule, from the columns."""
    power = run[f"{body}_granular_x_N"] * run[f"{body}_vx_m_s"] + run[f"{body}_granular_y_N"] * run[f"{body}_vy_m_s"]
    power = power - run[f"{body}_granular_moment_Nm"] * run[f"{body}_spin_rad_s"]
    lack = run["kinetic_J"] + run["gravity_J"] - accumulate(run["time_s"], power)
    return float(np.abs(lack - lack[0]).max() / run["kinetic_J"].max())


def imbalance(run: Results) -> float:
    return float(run.summary["energy"]["imbalance_relative"])


def test_work_over_a_jump_of_the_force_is_that_of_the_scheme() -> None:
    """A mass that a force of 2 N slows down from one instant on: the scheme gives the step of the jump half of it."""
    h, mass = 1e-2, 1.0
    force = np.array([0.0, 0.0, -2.0, -2.0])
    velocity = 1.0 + h * np.array([0.0, 0.0, -1.0, -3.0]) / mass
    time = h * np.arange(4)
    gained = 0.5 * mass * (velocity**2 - velocity[0] ** 2)
    np.testing.assert_allclose(work(time, force, velocity), gained, atol=1e-15)
    # The mean power is off by a quarter of h dF dv, in the step of the jump alone.
    off = accumulate(time, force * velocity) - gained
    np.testing.assert_allclose(off, [0.0, 0.0, 0.25 * h * 2.0 * h, 0.25 * h * 2.0 * h], atol=1e-15)
    # Of several forces their works add up.
    both = np.column_stack([force, force])
    np.testing.assert_allclose(work(time, both, np.column_stack([velocity, velocity])), 2.0 * gained, atol=1e-15)


def test_a_solid_that_falls_flat_balances() -> None:
    """All of the sand is met in one step; by the mean power 1.8e-3 of the energy was lost to the rule."""
    run = simulate(BOX)
    assert by_mean_power(run, "box") > IMBALANCE_LIMIT
    # What is left is the damping of the scheme, of second order.
    assert imbalance(run) < 0.05 * by_mean_power(run, "box")
    halved = simulate(BOX, "solver.step_s=1e-4")
    assert imbalance(halved) < 0.35 * imbalance(run)


def test_a_flexible_rod_on_a_slope_balances_or_says_so() -> None:
    run = simulate(ROD)
    assert imbalance(run) < 2e-5  # 1.4e-4 by the mean power
    # Nearly along the slope, where it bends within a few steps.
    flat = simulate(ROD, "initial.joints.fall.angle_deg=10")
    assert imbalance(flat) > IMBALANCE_LIMIT
    assert flat.warnings[0].startswith("the energy balance has an error of 0.")
    assert "solver.step_s (now 0.0002)" in flat.warnings[0]
    finer = simulate(ROD, "initial.joints.fall.angle_deg=10", "solver.step_s=1e-4")
    assert imbalance(finer) < 0.5 * imbalance(flat)


@pytest.mark.parametrize(
    ("off", "heard"),
    [
        (0.0, ["steps", "beam", "bristles"]),
        (IMBALANCE_LIMIT, ["steps", "beam", "bristles"]),
        (0.03, ["energy", "steps", "bristles"]),  # positions off by 1.5 %, so that 1 % is a softer word
        (0.33, ["energy"]),
        (np.inf, ["energy"]),
    ],
)
def test_the_energy_balance_replaces_milder_warnings(off: float, heard: list[str]) -> None:
    warnings = [
        AccuracyWarning("steps are too long: 2 %", 0.02),
        AccuracyWarning("beam: 1 %", 0.01),
        AccuracyWarning("bristles vibrate"),
    ]
    scene = scene_of("pendulum")
    sentences = warning_sentences(off, warnings, scene)
    assert [
        next(word for word in ("energy", "steps", "beam", "bristles") if word in sentence[:20])
        for sentence in sentences
    ] == heard
    assert ("not usable" in sentences[0]) is (off > 0.05)
    # What makes the result useless by itself drops the rest, too.
    fatal = AccuracyWarning("turns", np.inf)
    assert warning_sentences(min(off, 0.03), [*warnings, fatal], scene) == ["turns"]


def test_every_solver_names_what_to_change() -> None:
    for config, more, key in (
        ("pendulum", (), "solver.step_s (now 0.0002)"),
        ("pendulum", ("solver.accuracy=1e-2",), "solver.accuracy (now 0.01)"),
        ("pendulum", ("method={reduced: {modes: 1, rtol: 1e-3}}",), "method.reduced.rtol (now 0.001)"),
        ("double_pendulum", ("method=minimal", "solver.accuracy=1e-4"), "solver.accuracy (now 0.0001)"),
    ):
        (sentence,) = warning_sentences(0.002, [], scene_of(config, *more))
        assert "an error of 0.20%" in sentence
        assert key in sentence


SPINNING = """
model:
  name: rod
  bodies:
    rod:
      type: rigid
      density_kg_m3: 1200
      shapes: [{type: cylinder, start_m: [-0.1, 0], end_m: [0.1, 0], diameter_m: 0.008}]
  joints: {fall: {type: free, parent: ground, child: rod}}
medium: play_sand
initial: {joints: {fall: {vy_m_s: -0.5, rate_rad_s: 60}}}
solver: {end_time_s: 0.1, rest_time_s: null}
output: {bodies: all}
"""


def test_steps_too_long_for_a_spin_warn_by_the_energy_balance() -> None:
    """A rod that strikes the sand spinning is 21 degrees off its 63 at 1 ms, where each step turns it by 3.

    The work of the medium is then unknown to a third; whatever the jumps along the motion tell is softer.
    """
    coarse, fine = (simulate(SPINNING, f"solver.step_s={h}") for h in (1e-3, 5e-5))
    wanted = np.interp(coarse["time_s"], fine["time_s"], fine["rod_orientation_deg"])
    assert np.abs(coarse["rod_orientation_deg"] - wanted).max() > 10.0
    (sentence,) = (warning for warning in coarse.warnings if "outside" not in warning)
    assert "not usable" in sentence
    assert "solver.step_s (now 0.001)" in sentence
    assert not any("not usable" in warning for warning in fine.warnings)


def test_small_jumps_of_position_are_reported_in_metres() -> None:
    run = simulate(BOX)
    (sentence,) = (warning for warning in run.warnings if "too long" in warning)
    share, metres = (float(text) for text in re.findall(r"about ([\d.]+)% of its path, ([\d.e-]+) m", sentence)[0])
    way = np.sum(np.diff(run["time_s"]) * np.abs(np.array([run["box_vx_m_s"], run["box_vy_m_s"]])).max(axis=0)[1:])
    assert metres == pytest.approx(0.01 * share * way, rel=0.1)  # two digits of both, and the touch to begin with
