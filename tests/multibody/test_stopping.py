"""Stopping times: reported for mechanisms that stop and stay at rest, and not for those that still fall."""

from __future__ import annotations

import numpy as np
import pytest
from support_runs import scene_of, simulate

from granular_contact.results import REST_MEASURE, STOP_MEASURE

CHAIN = """
model:
  name: three
  chain: {{count: 3, link: {{length_m: 0.1, diameter_m: 0.008, density_kg_m3: 7850}}}}
medium: play_sand
surface_height_m: {surface}
initial: {{joints: {{hinge_1: {{angle_deg: 10, rate_rad_s: {rate}}}, hinge_2: {{angle_deg: {elbow}}}}}}}
solver: {{end_time_s: {end}}}
"""


def test_a_chain_whose_first_link_still_falls_has_no_stopping_time() -> None:
    """Its tip is in the sand while it swings up: the mean rate is zero there, and all falls on the sand after that."""
    run = simulate(CHAIN.format(surface=-0.14, rate=-2, elbow=30, end=0.15))
    assert (run.status.code, run.summary["touch_time_s"]) == ("end_time", pytest.approx(0.0, abs=1e-9))
    mean, first = run["mean_rate_rad_s"], run["hinge_1_rate_rad_s"]
    zero = int(np.flatnonzero(mean[1:] * mean[0] < 0.0)[0])
    assert first[run["time_s"] > run["time_s"][zero] + 0.04].max() > 0.3
    assert (run.summary["stopping_time_s"], run.summary["angle_at_stop_deg"]) == (None, None)
    assert run.summary["stopping_time_measure"] == REST_MEASURE


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [CHAIN.format(surface=-0.1, rate=0, elbow=-40, end=2.0), "double_pendulum", "free_link"]
)
def test_a_stopping_time_of_many_parts_is_that_of_rest(case: str) -> None:
    """After it no joint and no body moves: the rest speed is 1 mm/s, of points no nearer to a joint than 1 mm."""
    run = simulate(case, "solver.end_time_s=2", "solver.step_s=2e-4")
    assert run.status.code == "rest"
    assert (run.summary["angle_at_stop_deg"] is not None) == (case == "free_link")  # of many bodies there is none
    stops = run.summary["touch_time_s"] + run.summary["stopping_time_s"]
    assert run["time_s"][-1] - stops == pytest.approx(0.02, abs=4e-4)  # rest_time_s, and steps of 0.2 ms
    rates = [c.name for c in run.columns if c.name.endswith(("vx_m_s", "vy_m_s"))]
    fastest = np.max([np.abs(run[name]) for name in rates], axis=0)
    assert fastest[run["time_s"] > stops].max() <= 1e-3
    assert fastest[run["time_s"] < stops].max() > 1.0


@pytest.mark.slow
def test_a_run_that_is_cut_before_the_rest_has_lasted_has_no_stopping_time() -> None:
    whole = simulate("double_pendulum")
    rests = whole.summary["touch_time_s"] + whole.summary["stopping_time_s"]
    cut = simulate("double_pendulum", f"solver.end_time_s={rests + 0.01}")
    assert (cut.status.code, cut.summary["stopping_time_s"]) == ("end_time", None)
    still = simulate("double_pendulum", "solver.rest_time_s=null", f"solver.end_time_s={rests + 0.03}")
    assert still.summary["stopping_time_s"] == pytest.approx(whole.summary["stopping_time_s"], abs=1e-5)


@pytest.mark.parametrize(
    ("config", "measure"),
    [
        ("pendulum", STOP_MEASURE),
        ("pendulum_rigid", STOP_MEASURE),
        ("free_link", REST_MEASURE),
        ("chain", REST_MEASURE),
        ("c_leg", None),
    ],
)
def test_stopping_time_states_its_measure(config: str, measure: str | None) -> None:
    scene = scene_of(config)
    assert (scene.pendulum is not None) == (measure == STOP_MEASURE)
    run = simulate(config, "solver.end_time_s=0.01")
    assert run.summary["stopping_time_measure"] == measure
