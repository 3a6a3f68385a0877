"""Iterations of a chain in sand: evaluations of forces, remaining residuals, shortened steps."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
import support_models
from support_runs import scene_of

from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.overlay import Overlay
from granular_contact.engines.exudyn.settings import settings
from granular_contact.engines.exudyn.solve import solve
from granular_contact.mechanics.kernels.numerics import TOLERANCE
from granular_contact.scene import Scene

PD = "drives={hinge_1: {type: pd, angle_deg: 0, gain_Nm_per_rad: 1, rate_gain_Nm_s_per_rad: 0.01}}"
CHAIN = support_models.chain(
    6,
    0.05,
    "medium: play_sand",
    "initial: {impact_angle_deg: 40, impact_speed_rad_s: 5}",
    "solver: {step_s: 2e-4, end_time_s: 0.04, rest_time_s: null}",
)


def chain(*changes: str) -> Scene:
    return scene_of(CHAIN, *changes)


def test_forces_are_computed_once_per_residual(monkeypatch: pytest.MonkeyPatch) -> None:
    once = solve(build(chain()))
    # One residual at the start of each step and one after each iteration, and the accelerations at the start of all.
    assert once.cost.load_calls == once.cost.newton_iterations + once.cost.steps + 1
    monkeypatch.setattr(Overlay, "untriggered", lambda _: nullcontext())
    twice = solve(build(chain()))
    assert twice.cost.load_calls == 2 * once.cost.load_calls - 1
    np.testing.assert_array_equal(twice.q, once.q)


def test_newton_residual_is_far_below_the_error_of_steps() -> None:
    shipped, closer = solve(build(chain())), solve(build(chain("solver.tolerance=1e-8")))
    exact = solve(build(chain("solver.step_s=2.5e-5")))
    error = np.abs(shipped.q - exact.q[::8]).max()
    assert shipped.cost.newton_iterations < 0.8 * closer.cost.newton_iterations
    assert np.abs(shipped.q - closer.q).max() < 0.5 * error


@pytest.mark.parametrize("change", ["solver.step_s=2e-4", "solver.accuracy=1e-3", PD])
def test_the_tolerance_is_one_number_for_all_scenes_in_the_plane(change: str) -> None:
    scene = chain(change)
    allowed = settings(scene).timeIntegration.newton.absoluteTolerance
    assert allowed == pytest.approx(TOLERANCE * scene.force_scale)


@pytest.mark.parametrize(("step", "shortened"), [(2.3e-3, False), (2e-2, True)])
def test_steps_are_shortened_only_where_the_iteration_fails(step: float, shortened: bool) -> None:
    """To 0.04 s in 18 steps of 2.2 ms, or in 2 of 20 ms, of which the first can't be solved."""
    run = solve(build(chain(f"solver.step_s={step}")))
    asked = 0.04 / np.ceil(0.04 / step)
    assert run.cost.shortened_steps == np.sum(np.diff(run.time)[:-1] < 0.99 * asked)
    assert (run.cost.shortened_steps > 0) == shortened
