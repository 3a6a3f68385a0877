"""Iterations of a chain in sand: who asks for its forces, and when a step that takes long may end."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
from support_runs import scene_of

from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.overlay import Overlay
from granular_contact.engines.exudyn.settings import patience, settings
from granular_contact.engines.exudyn.solve import solve
from granular_contact.scene import Scene

CHAIN = """
model:
  name: chain
  chain: {count: 6, link: {length_m: 0.05, diameter_m: 0.006, density_kg_m3: 7700}}
medium: play_sand
initial: {impact_angle_deg: 40, impact_speed_rad_s: 5}
solver: {step_s: 2e-4, end_time_s: 0.04, rest_time_s: null}
"""


def chain(*changes: str) -> Scene:
    return scene_of(CHAIN, *changes)


def tolerances(scene: Scene) -> list[float]:
    """Of the residuals of a step, over what is asked for, in units of the force scale."""
    growing = patience(scene, settings(scene))
    assert growing is not None
    return [growing.after(n) / scene.force_scale for n in range(6)]


def test_forces_are_asked_for_once_a_residual_whoever_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    once = solve(build(chain()))
    # One residual at the start of each step and one after each iteration, and the accelerations at the start of all.
    assert once.cost.load_calls == once.cost.newton_iterations + once.cost.steps + 1
    monkeypatch.setattr(Overlay, "unasked", lambda _: nullcontext())
    twice = solve(build(chain()))
    assert twice.cost.load_calls == 2 * once.cost.load_calls - 1
    np.testing.assert_array_equal(twice.q, once.q)


def test_only_a_step_that_takes_long_ends_with_more() -> None:
    assert tolerances(chain()) == pytest.approx([1e-5] * 3 + [1e-3] * 3)


def test_who_asks_for_less_gets_no_more() -> None:
    assert tolerances(chain("solver.tolerance=1e-4")) == pytest.approx([1e-4] * 3 + [1e-3] * 3)
    assert tolerances(chain("solver.tolerance=1e-2")) == pytest.approx([1e-2] * 6)


@pytest.mark.parametrize("change", ["medium=null", "solver.accuracy=1e-3", "model.chain.count=1"])
def test_what_no_sand_stops_is_iterated_to_the_end(change: str) -> None:
    scene = chain(change)
    assert patience(scene, settings(scene)) is None


def test_what_long_steps_leave_is_far_below_the_error_of_steps() -> None:
    shipped, closer = solve(build(chain())), solve(build(chain("solver.tolerance=1e-8")))
    exact = solve(build(chain("solver.step_s=2.5e-5")))
    error = np.abs(shipped.q - exact.q[::8]).max()
    assert shipped.cost.newton_iterations < 0.8 * closer.cost.newton_iterations
    assert np.abs(shipped.q - closer.q).max() < 0.5 * error
