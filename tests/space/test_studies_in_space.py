"""Many runs of scenes in space: settings and varied keys reach them as in the plane."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from granular_contact import load, simulate
from granular_contact.config import load_sweep
from granular_contact.scene.variants import Builder
from granular_contact.studies import sweep

BALL = """\
model:
  in_space: true
  name: ball
  bodies:
    ball: {type: rigid, density_kg_m3: 2000, shapes: [{type: sphere, diameter_m: 0.04, facet_size_m: 0.03}]}
  joints:
    flight: {type: free, parent: ground, child: ball}
medium: rft3d_sand
surface_height_m: 0
initial: {joints: {flight: {z_m: 0.025, vx_m_s: 0.5, vz_m_s: -1}}}
solver: {end_time_s: 0.03, step_s: 1.0e-3, rest_time_s: null}
output: {figures: false}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "ball.yaml").write_text(BALL)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("folder")
def test_builder_of_sweep_scenes_accepts_scenes_in_space() -> None:
    """Whose bodies have other shapes than those of the reduced model, from which other scenes are made."""
    scenario = load("ball.yaml").scenario
    for build in (Builder(), Builder(scenario)):
        for speed in (-1.0, -2.0):
            initial = {"joints": {"flight": {"z_m": 0.025, "vz_m_s": speed}}}
            assert build(scenario.replace(initial=initial)).in_space


def test_a_sweep_in_space_has_the_rows_of_single_runs(folder: Path) -> None:
    keys = "initial.joints.flight.vz_m_s: [-1, -2]\n  model.bodies.ball.density_kg_m3: [1000, 3000]"
    (folder / "many.yaml").write_text(f"config: ball.yaml\nset: {{medium.mu_int: 0.9}}\nvary:\n  {keys}\n")
    with sweep.WorkerPool(1, ThreadPoolExecutor) as pool:
        rows = sorted(sweep.run(load_sweep("many.yaml"), pool), key=lambda row: row.index)
    depths = [float(row.summary["max_depth_m"]) for row in rows]
    changes = ["initial.joints.flight.vz_m_s=-2", "model.bodies.ball.density_kg_m3=3000", "medium.mu_int=0.9"]
    assert depths[3] == pytest.approx(simulate(load("ball.yaml", changes)).summary["max_depth_m"], rel=1e-9)
    assert depths[0] < min(depths[1:3])  # slower and lighter
    assert max(depths[1:3]) < depths[3]
