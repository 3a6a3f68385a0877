"""Runs of unusual scenes: off the origin, settled, without a pivot, interrupted."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support_runs import ROOT, scenario_of, scene_of, simulate

from granular_contact.cli import main
from granular_contact.engines.exudyn.recorder import Recorder
from granular_contact.engines.modal.marching import March
from granular_contact.errors import SceneError
from granular_contact.run import run as solve
from granular_contact.scene import build

SETTLED = """
model:
  name: sprung
  bodies:
    link:
      {type: link, length_m: 0.3, diameter_m: 0.008, density_kg_m3: 7700,
       flexible: {elements: 4, bending_stiffness_N_m2: 20}}
  joints:
    pivot: {type: hinge, parent: ground, child: link, spring: {stiffness_Nm_per_rad: 3, rest_deg: 0}}
medium: null
initial: {joints: {pivot: {angle_deg: -40}}, settle: true}
solver: {end_time_s: 0.01}
"""
BALL_ON_HINGE = """
model:
  name: knob
  bodies:
    knob: {type: rigid, density_kg_m3: 7700, shapes: [{type: sphere, diameter_m: 0.05}]}
  joints:
    pivot: {type: hinge, parent: ground, child: knob}
medium: null
initial: {impact_angle_deg: 0}
solver: {end_time_s: 0.1}
"""
CANTILEVER = """
model:
  name: cantilever
  bodies:
    link: {type: link, length_m: 0.2, diameter_m: 0.006, density_kg_m3: 7700,
           flexible: {elements: 4, bending_stiffness_N_m2: 20}}
  joints:
    root: {type: weld, parent: ground, child: link, parent_point_m: [1, 0]}
medium: play_sand
bed: {height_m: -1}
initial: {joints: {}}
solver: {end_time_s: 0.01}
"""


def moved(name: str, x: float, y: float) -> tuple[str, ...]:
    """Overrides that put a pendulum of configs/ with its surface elsewhere."""
    surface = scene_of(name).surface
    return f"model.joints.pivot.parent_point_m=[{x},{y}]", f"surface_height_m={surface + y!r}"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "method"),
    [
        ("pendulum", "method=engine"),
        ("pendulum_rigid", "method=engine"),
        ("pendulum_rigid", "method=minimal"),
        ("pendulum", "method.reduced.modes=1"),
    ],
)
@pytest.mark.parametrize(("x", "y"), [(1.0, 0.0), (-0.3, 2.0), (100.0, -50.0)])
def test_a_mechanism_elsewhere_moves_alike(name: str, method: str, x: float, y: float) -> None:
    at_origin, translated = simulate(name, method), simulate(name, method, *moved(name, x, y))
    scenes = scene_of(name), scene_of(name, *moved(name, x, y))
    for scale in ("length", "speed", "force_scale"):
        # Round-off of positions up to 110 m in lengths of 0.26 m.
        assert getattr(scenes[1], scale) == pytest.approx(getattr(scenes[0], scale), rel=1e-12)
    assert scenes[0].tip[0] == scenes[1].tip[0]
    # That round-off, 1e-14 m, in bristles of 1e-5 m, and tolerances of Newton's method that follow it.
    assert translated.summary["stopping_time_s"] == pytest.approx(at_origin.summary["stopping_time_s"], rel=1e-6)


def test_a_settled_link_shows_the_angle_it_settled_at() -> None:
    results = simulate(SETTLED)
    angle = results["pivot_angle_deg"]
    # Links pull down on a spring of 3 N m/rad with m g l / 2 = 0.116 * 9.81 * 0.15 = 0.17 N m: some 3 degrees.
    assert np.all(np.abs(angle - 3.2) < 0.3)
    assert results["spring_J"][0] == pytest.approx(0.5 * 3 * np.radians(angle[0]) ** 2, rel=1e-9)


def test_a_ball_on_its_hinge_runs_by_every_method() -> None:
    ends = [simulate(BALL_ON_HINGE, *more).summary["status"] for more in ((), ("method=minimal",))]
    assert ends == ["rest", "rest"]
    with pytest.raises(SceneError, match=r"impact_tip_speed_m_s: got 0\.5, but no shape reaches beyond the hinge"):
        scene_of(BALL_ON_HINGE, "initial.impact_tip_speed_m_s=0.5")


def test_a_spinning_ball_does_not_rest() -> None:
    """A ball of 25 mm radius at 0.1 rad/s has 2.5 mm/s at its rim, above the 1 mm/s of rest."""
    summary = simulate(BALL_ON_HINGE, "initial.impact_speed_rad_s=0.1").summary
    assert summary["status"] == "end_time"


def test_a_ball_that_spins_slowly_rests() -> None:
    """At 0.02 rad/s its rim has 0.5 mm/s: below the 1 mm/s of rest, of which no rate in rad/s tells."""
    for method in ("engine", "minimal"):
        results = simulate(BALL_ON_HINGE, "initial.impact_speed_rad_s=0.02", f"method={method}")
        assert results.summary["status"] == "rest"


def test_clamped_links_have_no_mean_rate_and_no_stopping_time() -> None:
    results = simulate(CANTILEVER)
    assert "mean_rate_rad_s" not in [column.name for column in results.columns]
    assert results.summary["stopping_time_measure"] is None
    missed = "the mechanism never touched the medium: its deepest point came within 1 m of the surface"
    assert missed in results.warnings


def test_rows_at_an_interval_stay_on_their_grid() -> None:
    """100 000 sums of a step are off by up to 1e-11 s; a row a whole step late would be off by 1e-4 s."""
    solver = "solver={end_time_s: 10, rest_time_s: null, step_s: 1e-4}"
    results = simulate("pendulum_rigid", "medium=null", solver, "output.interval_s=0.01")
    np.testing.assert_allclose(results["time_s"], 0.01 * np.arange(1001), rtol=0.0, atol=1e-9)


# ---- interrupted ----


def struck(monkeypatch: pytest.MonkeyPatch, kind: type, name: str) -> None:
    """Let a Ctrl-C come in the middle of a method of a class, once."""
    method: Callable[..., object] = getattr(kind, name)
    calls = []

    def interrupted(self: object, *arguments: object) -> object:
        calls.append(1)
        if len(calls) == 2:
            os.kill(os.getpid(), signal.SIGINT)
        return method(self, *arguments)

    monkeypatch.setattr(kind, name, interrupted)
    monkeypatch.setattr(signal, "default_int_handler", signal.default_int_handler)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # tests in the background ignore it


@pytest.mark.parametrize(
    "command", [["compare-media", "--media", "play_sand,rft_generic"], ["compare", "--modes", "0", "--elements", "2"]]
)
def test_ctrl_c_ends_a_comparison(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    struck(monkeypatch, Recorder, "_count_shortened")
    config, out = str(ROOT / "configs" / "pendulum.yaml"), tmp_path / "out"
    assert main([command[0], config, *command[1:], "--out", str(out), "--no-plots"]) == 130
    assert "interrupted; nothing was saved" in capsys.readouterr().err
    assert not out.exists()


def test_ctrl_c_ends_settling(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from granular_contact.engines.exudyn import settle

    struck(monkeypatch, settle._Descent, "_step")
    config = tmp_path / "settled.yaml"
    config.write_text(SETTLED, encoding="utf-8")
    assert main(["run", str(config), "--out", str(tmp_path / "out"), "--no-plots"]) == 130
    assert "interrupted; nothing was saved" in capsys.readouterr().err


def test_an_interrupted_run_whose_table_is_full_is_kept() -> None:
    from granular_contact.engines.modal.model import model

    scene = scene_of("pendulum", "method.reduced.modes=0")
    march = March(
        model(scene, scene.method),
    )
    march.state = march.state._replace(rows=march.state.rows[:, :60])
    march._march()  # stops as the table is full, and is not taken on
    assert march.full
    table = march.table()
    assert len(table) == march.counts["rows"] + 1 > 2
    assert table[-1, 0] == march.time > table[-2, 0]


def test_a_comparison_with_what_did_not_end_has_no_verdict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = str(ROOT / "configs" / "pendulum.yaml")
    more = ["--modes", "0", "--elements", "2", "--set", "solver.max_wall_s=1e-6", "--no-plots"]
    assert main(["compare", config, *more, "--out", str(tmp_path / "out")]) == 4
    assert "FE, 2 elements did not reach its end, so there is no reference" in capsys.readouterr().out


def test_a_motion_that_runs_away_ends_there_and_is_reported() -> None:
    run = simulate(BALL_ON_HINGE, "drives.pivot={type: torque, torque_Nm: 1e10}", "solver.step_s=1e-3")
    assert run.status.code == "failed"
    assert run.status.message.startswith("the motion diverged at 0 s; take a smaller solver.step_s")
    assert len(run["time_s"]) == 1  # the step that left is not kept


@pytest.mark.parametrize(("method", "torque", "unit"), [("engine", 1e7, 1.0), ("minimal", 3e8, 0.025)])
def test_a_motion_has_run_away_once_a_speed_is_above_1e8(method: str, torque: float, unit: float) -> None:
    """Even acceleration from rest: after one step below it, after two above. m/s at the rim; the engine, of rad/s."""
    more = "solver.step_s=1e-3", "solver.end_time_s=3e-3", f"method={method}"
    run = simulate(BALL_ON_HINGE, f"drives.pivot={{type: torque, torque_Nm: {torque}}}", *more)
    rate = torque * 1e-3 / (0.1 * 7700.0 * np.pi / 6.0 * 0.05**5)  # of a ball's inertia m d^2 / 10
    assert 0.5e8 < unit * rate < 1e8
    assert run["mean_rate_rad_s"].tolist() == pytest.approx([0.0, rate], rel=1e-9)
    assert run.status.message.startswith("the motion diverged at 0.001 s; take a smaller solver.step_s")


def test_a_speed_is_that_of_one_coordinate() -> None:
    """Two balls at 0.8e8 rad/s each: together they are above 1e8, and neither is."""
    ball = "model.bodies.other={type: rigid, density_kg_m3: 7700, shapes: [{type: sphere, diameter_m: 0.05}]}"
    hinge = "model.joints.spindle={type: hinge, parent: ground, child: other, parent_point_m: [1, 0]}"
    torque = "{type: torque, torque_Nm: 1e7}"
    more = f"drives={{pivot: {torque}, spindle: {torque}}}", "solver.step_s=1e-3", "method=engine"
    run = simulate(BALL_ON_HINGE, ball, hinge, *more)
    assert len(run["time_s"]) == 2


@pytest.mark.parametrize("method", ["engine", "minimal"])
def test_a_run_reports_its_progress(method: str) -> None:
    """5000 steps; each method tells every thousand or more often."""
    more = "initial.impact_speed_rad_s=1", "solver.step_s=2e-5", f"method={method}"
    scenario, progress = scenario_of(BALL_ON_HINGE, *more), list[tuple[float, float]]()
    solve(build(scenario), scenario, progress=lambda t, end: progress.append((t, end)))
    times = [t for t, _ in progress]
    assert {end for _, end in progress} == {0.1}
    assert times == sorted(times)
    assert np.diff(times, prepend=0.0, append=0.1).max() < 0.03
