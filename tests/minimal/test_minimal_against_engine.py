"""The same scenes in minimal coordinates and by the engine: same limit, same columns, refusals with a reason."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from support_runs import CONFIGS, FOUR_BAR, order, scene_of, simulate, tip_error

from granular_contact import cli
from granular_contact.errors import ConfigError, SceneError
from granular_contact.results import Results

FORK = """
model:
  name: fork
  bodies:
    side: {type: link, length_m: 0.08, diameter_m: 0.006, density_kg_m3: 7700}
    lower: {type: link, length_m: 0.1, diameter_m: 0.006, density_kg_m3: 7700}
    upper: {type: link, length_m: 0.1, diameter_m: 0.008, density_kg_m3: 7700}
  joints:
    branch: {type: hinge, parent: upper, child: side, parent_point_m: [0.05, 0], child_point_m: [0.01, 0]}
    elbow: {type: hinge, parent: upper, child: lower, parent_point_m: [0.1, 0]}
    shoulder: {type: hinge, parent: ground, child: upper, parent_point_m: [0.02, 0.01]}
medium: play_sand
initial: {impact_angle_deg: 40, impact_speed_rad_s: 5}
load: {strips_per_rigid_part: 4}
solver: {end_time_s: 0.03, rest_time_s: null}
"""
TIMES = np.linspace(0.0, 0.03, 61)


def by_engine(step: float, *more: str) -> Results:
    return simulate(FORK, "method=engine", f"solver.step_s={step}", "solver.tolerance=1e-8", *more)


def minimal(accuracy: float, *more: str) -> Results:
    return simulate(FORK, "method=minimal", f"solver.accuracy={accuracy}", *more)


def fixed(step: float, *more: str) -> Results:
    return simulate(FORK, "method=minimal", f"solver.step_s={step}", "solver.tolerance=1e-8", *more)


@pytest.mark.slow
@pytest.mark.parametrize("by", [by_engine, fixed])
def test_both_methods_converge_to_the_same_motion(by: Callable[[float], Results]) -> None:
    """The same law and bristles: what is left of either falls with its step."""
    fine, steps = fixed(2e-6), [8e-5, 4e-5, 2e-5]
    errors = [tip_error(by(step), fine, TIMES) for step in steps]
    # Order two, less for touch and yield, as in the study of convergence; the tip goes 40 mm.
    assert order(steps, errors) > 1.6
    assert errors[-1] < 3e-8


@pytest.mark.slow
def test_error_follows_the_accuracy() -> None:
    # Strips, too, are chosen by the accuracy: here they are as short as they get, so that steps alone are compared.
    strips = "load.strips_per_rigid_part=128"
    fine, runs = fixed(2e-6, strips), [minimal(accuracy, strips) for accuracy in (1e-2, 1e-3, 1e-4, 1e-5)]
    errors = [tip_error(run, fine, run["time_s"]) for run in runs]
    assert all(error < accuracy * 0.04 for error, accuracy in zip(errors, (1e-2, 1e-3, 1e-4, 1e-5), strict=True))
    # A tenth of the accuracy at order two; touch and yield fall inside steps, whose length their errors follow.
    assert all(b < 0.5 * a for a, b in pairwise(errors))


def test_energy_is_accounted_for() -> None:
    results = minimal(1e-3)
    assert results.summary["energy"]["granular_work_J"] < -1e-3
    assert results.summary["energy"]["imbalance_relative"] < 1e-3


def test_energy_is_kept_in_vacuum() -> None:
    drifts = []
    for accuracy in (1e-3, 1e-5):
        results = minimal(accuracy, "medium=null", "solver.end_time_s=0.3")
        energy = results["kinetic_J"] + results["gravity_J"]
        drifts.append(np.abs(energy - energy[0]).max() / results["kinetic_J"].max())
    assert drifts[1] < 1e-4
    assert drifts[1] < 0.2 * drifts[0]


def test_columns_are_the_engine_s() -> None:
    ours, theirs = fixed(1e-4), by_engine(2e-5)
    assert [c.name for c in ours.columns] == [c.name for c in theirs.columns]
    for name in (
        "elbow_angle_deg",
        "branch_angle_deg",
        "shoulder_rate_rad_s",
        "mean_rate_rad_s",
        "depth_m",
        "gravity_J",
    ):
        a, b = (np.interp(TIMES, r["time_s"], r[name]) for r in (ours, theirs))
        # Both are read off chords of at most 0.1 ms, over which rates change by a hundredth of their range.
        np.testing.assert_allclose(a, b, atol=2e-3 * np.ptp(theirs[name]))
    work = ours["granular_work_J"][-1]
    assert work == pytest.approx(theirs["granular_work_J"][-1], rel=1e-3)


def test_rest_and_stop_are_detected() -> None:
    ours = simulate("pendulum_rigid", "method=minimal")
    theirs = simulate("pendulum_rigid", "method=engine")
    assert ours.status.code == theirs.status.code == "rest"
    # Defaults of both: 0.2 ms steps of order two over a stop of 25 ms.
    assert ours.summary["stopping_time_s"] == pytest.approx(theirs.summary["stopping_time_s"], rel=1e-3)
    assert ours.summary["angle_at_stop_deg"] == pytest.approx(theirs.summary["angle_at_stop_deg"], abs=0.005)


def test_long_runs_outgrow_the_first_table() -> None:
    results = fixed(1e-5, "solver.end_time_s=0.02")
    assert len(results.table) == 2001
    assert np.all(np.diff(results["time_s"]) > 0.0)
    assert results["time_s"][-1] == 0.02


def test_the_last_of_fixed_steps_ends_with_the_run_where_some_were_halved() -> None:
    long = "solver.accuracy=null", "solver.step_s=8e-3", "solver.end_time_s=0.2", "solver.rest_time_s=null"
    run = simulate("chain", "method=minimal", *long)
    assert run.summary["cost"]["shortened_steps"] > 0
    steps = np.diff(run["time_s"])
    assert run["time_s"][-1] == 0.2
    assert steps.max() == pytest.approx(8e-3, rel=1e-9)
    assert steps[-1] < 0.9 * steps.max()


def test_a_matrix_of_newton_serves_many_steps() -> None:
    """Of even steps, which bring hardly a change of the matrix until bristles yield."""
    cost = fixed(1e-4).summary["cost"]
    assert cost["jacobians"] < 0.1 * cost["steps"]


def test_slope_of_the_surface() -> None:
    bed = "bed={slope_deg: 8}"
    ours, theirs = fixed(4e-5, bed), by_engine(4e-5, bed)
    assert tip_error(ours, theirs, TIMES) < 1e-6
    assert tip_error(ours, fixed(4e-5), TIMES) > 1e-4


@pytest.mark.parametrize(
    ("overrides", "reason"),
    [
        (["model.bodies.lower.flexible={youngs_modulus_Pa: 1e9}"], "lower is flexible"),
        (["model.joints.elbow.type=weld", "model.bodies.lower.flexible={youngs_modulus_Pa: 1e9}"], "elbow is a weld"),
    ],
)
def test_scenes_beyond_minimal_coordinates_are_refused_with_a_reason(overrides: list[str], reason: str) -> None:
    try:
        scene_of(FORK, "method=minimal", *overrides)
    except SceneError as error:
        (fault,) = error.faults
        assert fault.key == "method"
        assert reason in fault.message
        assert "that hinges and sliders join" in fault.message
    else:
        raise AssertionError(f"{overrides} was taken")


def test_loops_are_not_for_minimal_coordinates() -> None:
    with pytest.raises(SceneError, match="c closes a loop: minimal coordinates are for trees"):
        scene_of(FOUR_BAR, "method=minimal")


@pytest.mark.parametrize(
    ("overrides", "by"),
    [
        ((), "minimal"),
        (("method=engine",), "engine"),
        (("model.bodies.lower.flexible={youngs_modulus_Pa: 1e9}",), "engine"),
        (("initial.settle=true", "initial.impact_speed_rad_s=0"), "minimal"),
    ],
)
def test_default_method_is_minimal_wherever_it_serves(overrides: tuple[str, ...], by: str) -> None:
    method = scene_of(FORK, *overrides).method
    assert ("engine" if method is None else "minimal") == by


def test_one_method_at_a_time() -> None:
    with pytest.raises(ConfigError, match="one of them is allowed"):
        scene_of(FORK, "method={minimal: {}, reduced: {}}")


def test_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = ["run", str(CONFIGS / "pendulum_rigid.yaml"), "--method", "minimal"]
    assert cli.main([*run, "--no-plots", "--out", str(tmp_path / "a")]) == 0
    assert "stopping time   25.4" in capsys.readouterr().out
    chosen = ["run", str(CONFIGS / "runner.yaml"), "--method", "minimal", "--set", "solver.end_time_s=0.02"]
    assert cli.main([*chosen, "--no-plots", "--out", str(tmp_path / "b")]) == 0
    assert cli.main([*run, "--modes", "1"]) == 2
    assert "rigid bodies have none" in capsys.readouterr().err
