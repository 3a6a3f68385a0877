"""Bodies that start in the sand: as if they had been laid there without moving a grain."""

from __future__ import annotations

import numpy as np
import pytest
from support_runs import simulate

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
        f"it starts {results['depth_m'][0]:.4g} m below the surface, {LAID}"
    ]


def test_a_dragged_plate_meets_the_published_stress() -> None:
    """alpha_x of a vertical plate moved along its normal, by the coefficients: C01 - C11 - C-11, times the depth."""
    results = simulate("dragged_plate")
    middle = np.argmin(np.abs(results["time_s"] - 0.5))
    stress = 1e6 * (0.086 + 0.039 - 0.018)  # N/m3
    force = stress * 0.04 * (0.08**2 - 0.03**2) / 2
    assert results["plate_granular_x_N"][middle] == pytest.approx(-force, rel=1e-9)
    assert results["plate_granular_x_N"][0] == 0.0
    assert results.summary["energy"]["imbalance_relative"] < 1e-3
    # Inertia is nothing at mid-ramp; the drive works against the sand alone.
    assert results["rail_force_N"][middle] == pytest.approx(force, rel=1e-6)


def test_what_touches_or_settles_is_not_told_so() -> None:
    settled = simulate("pendulum_rigid", "initial={impact_angle_deg: 31, settle: true}", "solver.end_time_s=0.01")
    for results in (simulate("pendulum"), settled):
        assert not any(LAID in warning for warning in results.warnings)
    assert settled["depth_m"][0] > 0.0
