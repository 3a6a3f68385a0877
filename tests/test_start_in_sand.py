"""Bodies that start in the sand, as if laid there without moving a grain."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support_runs import CONFIGS, scenario_of, simulate

from granular_contact.cli.main import main
from granular_contact.scene import build

LAID = "as if it had been laid there without moving a grain"
RIGID = ("method={reduced: {modes: 0, static: true_sign, rtol: 1e-10}}", "output.interval_s=null")
U_Y = 1e-5  # m, the default


def test_a_run_taken_up_in_the_sand_ends_as_the_whole_one() -> None:
    """With the true sign the sand has no memory; so what came before the start does not matter."""
    surface = f"surface_height_m={-0.263525 * np.sin(np.radians(31)):.12g}"
    whole = simulate("pendulum_rigid", *RIGID, surface)
    middle = len(whole["time_s"]) // 3
    angle, rate = (float(whole[name][middle]) for name in ("pivot_angle_deg", "pivot_rate_rad_s"))
    assert float(whole["depth_m"][middle]) > 5e-3
    part = simulate(
        "pendulum_rigid", *RIGID, surface, f"initial.impact_angle_deg={angle!r}", f"initial.impact_speed_rad_s={rate!r}"
    )
    assert part.summary["angle_at_stop_deg"] == pytest.approx(whole.summary["angle_at_stop_deg"], abs=1e-6)
    left = whole.summary["stopping_time_s"] - float(whole["time_s"][middle])
    assert part.summary["stopping_time_s"] == pytest.approx(left, abs=1e-8)


def test_body_touching_at_the_start_feels_the_sand_at_once() -> None:
    """The force on an end face jumps at the touch; round-off decided whether it acts at the start, 2.6e-4 of the way"""
    bed = build(scenario_of("free_link")).bed
    assert bed is not None
    surface = float(bed.height(0.0))
    above, below = (
        simulate("free_link", "load.end_cap=true", f"bed.height_m={surface + off!r}", "solver.end_time_s=0.02")
        for off in (-1e-14, 1e-14)
    )
    way = float(np.abs(above["rod_y_m"] - above["rod_y_m"][0]).max())
    assert max(np.abs(above[f"rod_{axis}_m"] - below[f"rod_{axis}_m"]).max() for axis in "xy") < 1e-9 * way
    assert above["drag_force_y_N"][0] == pytest.approx(below["drag_force_y_N"][0], rel=1e-6)
    assert above["drag_force_y_N"][0] > 0.01
    assert not [warning for run in (above, below) for warning in run.warnings if LAID in warning]


@pytest.mark.parametrize("method", ["engine", "{minimal: {}}", "{reduced: {modes: 0}}"])
def test_sand_holds_what_is_laid_into_it(method: str) -> None:
    results = simulate(
        "pendulum_rigid",
        f"method={method}",
        "surface_height_m=-0.1",
        "initial.impact_speed_rad_s=0",
        "solver.end_time_s=0.1",
    )
    way = np.hypot(results["tip_x_m"] - results["tip_x_m"][0], results["tip_y_m"] - results["tip_y_m"][0])
    assert way.max() < U_Y
    assert [warning for warning in results.warnings if LAID in warning] == [
        f"the mechanism starts {results['depth_m'][0]:.4g} m below the surface, {LAID}"
    ]


def test_a_dragged_plate_meets_the_published_stress() -> None:
    """alpha_x of a vertical plate moved along its normal, by the coefficients: C01 - C11 - C-11, times the depth."""
    results = simulate("dragged_plate")
    middle = np.argmin(np.abs(results["time_s"] - 0.5))
    stress = 1e6 * (0.086 + 0.039 - 0.018)  # N/m3
    force = stress * 0.04 * (0.08**2 - 0.03**2) / 2
    assert results["plate_granular_x_N"][middle] == pytest.approx(-force, rel=1e-9)
    assert abs(results["plate_granular_x_N"][0]) < 1e-12
    assert results.summary["energy"]["imbalance_relative"] < 1e-3
    # Inertia is nothing at mid-ramp; the drive works against the sand alone.
    assert results["rail_force_N"][middle] == pytest.approx(force, rel=1e-6)


def test_touching_or_settled_starts_have_no_warning_of_a_start_in_sand() -> None:
    settled = simulate("pendulum_rigid", "initial={impact_angle_deg: 31, settle: true}", "solver.end_time_s=0.01")
    for results in (simulate("pendulum"), settled):
        assert not any(LAID in warning for warning in results.warnings)
    assert settled["depth_m"][0] > 0.0


PENDULUM = ("pendulum", "initial={settle: true, joints: {pivot: {angle_deg: 31}}}")
ONE_BODY = """
model:
  name: one
  bodies:
    body: {{type: rigid, density_kg_m3: {}, shapes: [{}]}}
  joints:
    fall: {{type: free, parent: ground, child: body}}
medium: {}
initial: {{settle: true}}
solver: {{end_time_s: 0.1}}
"""
SHEET = "{type: plate, start_m: [-0.03, 0], end_m: [0.03, 0], width_m: 0.05, thickness_m: 0.005}"
BALL = "{type: sphere, diameter_m: 0.0254}"


@pytest.mark.parametrize("case", [PENDULUM, (ONE_BODY.format(2700, SHEET, "poppy_seeds_loose"),)])
def test_bodies_at_rest_from_the_start_have_no_warning_or_stopping_time(case: tuple[str, ...]) -> None:
    """Ways and energies of some nanometres and nanojoules were off by 100 %."""
    results = simulate(*case)
    assert (results.warnings, results.summary["stopping_time_s"]) == ((), None)
    assert results.status.code == "rest"


def test_a_ball_settles_where_the_sand_carries_it() -> None:
    medium = "{from: glass_beads_katsuragi_durian, stiffness_N_m: 60}"
    results = simulate(ONE_BODY.format(7700, BALL, medium))
    weight = 7700 * np.pi / 6 * 0.0254**3 * 9.81
    # The bristle is let go at rest, and takes its place again.
    assert results["depth_m"][-1] == pytest.approx(weight / 60, abs=2 * U_Y)
    assert results["depth_m"][0] == pytest.approx(weight / 60, abs=2 * U_Y)


def test_settling_that_fails_says_why(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Out of time is exit code 4; what creeps under any load never rests."""
    config, settled = PENDULUM
    run = ["run", str(CONFIGS / f"{config}.yaml"), "--out", str(tmp_path / "out"), "--no-plots", "--set", settled]
    assert main([*run, "--set", "solver.max_wall_s=1e-3"]) == 4
    assert "initial.settle: solver.max_wall_s (0.001) was over" in capsys.readouterr().err
    assert main([*run, "--set", "load.friction={type: smooth, reference_speed_m_s: 0.1}"]) == 3
    assert "smooth friction creeps under any load: take load.friction: {type: elastoplastic}" in capsys.readouterr().err


def test_command_says_when_the_surface_follows_the_touching_body(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Whoever puts a body at a height expects the surface at 0, or says where it is."""
    for more, warned in ((), True), (("bed.height_m=0",), False):
        overrides = ["initial.joints.fall.y_m=-0.05", "solver.end_time_s=0.001", *more]
        sets = [word for override in overrides for word in ("--set", override)]
        assert main(["run", str(CONFIGS / "free_link.yaml"), "--no-plots", "--out", str(tmp_path / "out"), *sets]) == 0
        assert ("surface         where it touches" in capsys.readouterr().out) == warned
