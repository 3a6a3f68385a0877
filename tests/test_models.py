"""Mechanisms in models/: every one has a config, keeps its energy, and does what its config says it does.

The numbers of whole runs are those of the gallery (tests/validation/test_gallery.py); here runs are short.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import yaml
from support_runs import ROOT

from granular_contact.config import load_scenario
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import build

CONFIGS = ROOT / "configs"


def simulate(name: str, *sets: str) -> Results:
    scenario = load_scenario(CONFIGS / f"{name}.yaml", list(sets))
    results = run(build(scenario), scenario)
    assert results.status.code in ("rest", "end_time")
    assert results.warnings == ()
    assert results.summary["energy"]["imbalance_relative"] <= 1e-3
    return results


def test_every_model_has_a_config_and_a_comment() -> None:
    used = [yaml.safe_load(config.read_text(encoding="utf-8")).get("model") for config in CONFIGS.glob("*.yaml")]
    for path in (ROOT / "models").glob("*.yaml"):
        text = path.read_text(encoding="utf-8")
        assert yaml.safe_load(text)["name"] == path.stem
        assert text.startswith("# ")
        assert any(model == path.stem for model in used), path.stem


@pytest.mark.slow
@pytest.mark.parametrize("angle", [20, 60, 90])
@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_a_rod_dropped_at_any_angle_stops(angle: int, speed: float) -> None:
    start = (f"initial.joints.fall.angle_deg={angle}", f"initial.joints.fall.vy_m_s={-speed}")
    results = simulate("free_link", *start, "solver.end_time_s=0.2")
    rises = np.flatnonzero(np.diff(results["tip_y_m"]) >= 0.0)[0]
    # The lower end stops in the step before the one that it first rises in, or in that one.
    longest = np.diff(results["time_s"])[rises - 1 : rises + 1].max()
    assert results.summary["penetration_time_s"] == pytest.approx(results["time_s"][rises], abs=1.01 * longest)
    assert 0.0 < results.summary["max_depth_m"] < 0.15


def test_without_sand_the_rod_falls() -> None:
    results = simulate("free_link", "medium=null")
    t, y = results["time_s"], results["rod_y_m"]
    # Exact for the integrator, as the acceleration is constant: round-off of 500 steps.
    assert y - y[0] == pytest.approx(-2.0 * t - 0.5 * 9.81 * t**2, abs=1e-9)


@pytest.mark.parametrize(("name", "at_once"), [("chain", 5), ("chain_flexible", 3)])
def test_several_links_of_a_chain_are_in_the_sand_at_once(name: str, at_once: int) -> None:
    results = simulate(name, "solver.end_time_s=0.3")
    spans = [span for link in results.summary["contacts"].values() for span in link]
    assert max(sum(on <= t <= off for on, off in spans) for t, _ in spans) >= at_once


def test_the_double_pendulum_comes_to_rest_with_both_links_in_the_sand() -> None:
    results = simulate("double_pendulum")
    assert results.status.code == "rest"
    assert all(link for link in results.summary["contacts"].values())


def test_the_c_leg_lifts_its_hip_at_every_turn() -> None:
    results = simulate("c_leg")
    t, hip = results["time_s"], results["hip_y_m"]
    first, second = (hip[(t >= a) & (t < a + 1.0)] for a in (0.5, 1.0))
    # Between lying on the sand and mid-stance, a good part of the leg's 60 mm.
    assert np.ptp(first) > 0.02
    # The gait is periodic from the first time the hip lies down: 1 % of the leg.
    assert first.max() == pytest.approx(second.max(), abs=6e-4)
    assert "forward_speed_m_s" not in results.summary  # its rail is upright


@pytest.mark.slow
def test_the_runner_keeps_up_with_its_clock_and_less_so_uphill() -> None:
    sets = ("solver.end_time_s=1.5", "signals.stride.frequency_Hz=2")
    forward = simulate("runner", *sets).summary["forward_speed_second_half_m_s"]
    # A toe, 40 mm from the hip, sweeps a chord of 90 deg in each stance: two of them a stride, two strides a second.
    without_slip = 2 * 2 * 2 * 0.04 * math.sin(math.radians(45))
    assert 0.8 * without_slip < forward < 1.05 * without_slip
    # On a bank as steep as this one it gets less far.
    up = simulate("runner", *sets, "bed.slope_deg=15").summary["forward_speed_second_half_m_s"]
    assert 0.0 < up < 0.95 * forward


@pytest.mark.slow
def test_the_walker_goes_the_way_that_its_knees_say() -> None:
    forward = simulate("walker", "solver.end_time_s=1")
    assert forward.summary["forward_speed_m_s"] > 0.1
    # Feet sink in, the trunk at 120 mm does not come down by more than half of that.
    assert forward["trunk_y_m"].min() > 0.06
    # With knees that bend in the stance and stretch in the swing it walks backwards.
    assert simulate("walker", "solver.end_time_s=1", "signals.knee.phase_deg=90").summary["forward_speed_m_s"] < -0.05


def test_stepping_leg_pulls_its_carriage_within_its_torque_limit() -> None:
    results = simulate("stepping_leg", "solver.end_time_s=1")
    assert results.summary["forward_speed_m_s"] > 0.1
    assert np.abs(results["knee_torque_Nm"]).max() <= 2.0
    assert len(results.summary["contacts"]["shank"]) >= 1


@pytest.mark.slow
def test_the_soft_walker_bends_its_shanks_both_ways_and_falls_behind() -> None:
    soft, stiff = (simulate(name, "solver.end_time_s=1") for name in ("soft_walker", "walker_in_space"))
    assert 0.8 * stiff["trunk_x_m"][-1] < soft["trunk_x_m"][-1] < stiff["trunk_x_m"][-1]
    for side in ("left", "right"):
        for axis, least in (("y", 1e-3), ("z", 3e-3)):
            assert np.abs(soft[f"shank_front_{side}_deflection_{axis}_m"]).max() > least
    assert 0.3 < soft.summary["links"]["shank_front_left"]["stress_Pa"] / 5e7 < 1.0  # of the yield stress


@pytest.mark.slow
def test_a_tail_turns_its_body_the_farther_the_stiffer_it_is() -> None:
    """Nothing turns before the tail beats; it beats to the left, so the body turns to the right."""
    yaws = []
    for modulus in (2e8, 2e9):
        results = simulate("tail", f"model.bodies.tail.flexible.youngs_modulus_Pa={modulus}")
        before = results["time_s"] < 0.3
        assert np.abs(results["body_yaw_deg"][before]).max() < 1e-6
        yaws.append(results["body_yaw_deg"][-1])
    soft, stiff = yaws
    assert -35.0 < stiff < 1.15 * soft < -10.0  # -28.7 and -24.0


@pytest.mark.slow
def test_a_flexible_leg_of_rising_stiffness_becomes_the_rigid_one() -> None:
    short = "solver.end_time_s=0.6"
    rigid = simulate("flexible_leg_rigid", short)["carriage_x_m"][-1]
    soft = simulate("flexible_leg", short)
    stiff = simulate("flexible_leg", short, "model.bodies.leg.flexible.youngs_modulus_Pa=2.3e+11")
    assert soft.summary["max_deflection_m"] > 0.005
    # A hundred times as stiff it bends a hundredth, 0.1 mm of a leg of 70, and the way differs by less than that share.
    assert stiff.summary["max_deflection_m"] < 0.03 * soft.summary["max_deflection_m"]
    assert abs(stiff["carriage_x_m"][-1] - rigid) < 0.05 * abs(soft["carriage_x_m"][-1] - rigid)
