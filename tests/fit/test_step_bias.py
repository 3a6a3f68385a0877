"""Bias of fitted coefficients by the steps of runs: reported where it exceeds the standard error, and true in size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support_fit import fitted
from support_runs import simulate

TRUE = 1.5
DISC = """
model:
  name: disc
  bodies:
    disc: {type: rigid, density_kg_m3: 7700, shapes: [{type: disc, diameter_m: 0.03, thickness_m: 0.02, in_sand: true}]}
  joints:
    flight: {type: free, parent: ground, child: disc}
medium: {law: rft, zeta: 1.5}
initial: {joints: {flight: {vy_m_s: -1.0}}}
solver: {step_s: STEP, end_time_s: 0.05}
"""


def found_with(folder: Path, step: float, noise: float):
    """Fit of zeta by runs with a step (s) to data of a run with steps of 20 us."""
    (folder / "disc.yaml").write_text(DISC.replace("STEP", f"{step:g}"), encoding="utf-8")
    results = simulate(DISC.replace("STEP", "2e-5"))
    time = np.linspace(0.0, 0.04, 81)
    depth = np.interp(time, results["time_s"], results["depth_m"])
    rows = np.column_stack([time, depth + noise * np.random.default_rng(0).standard_normal(81)]).tolist()
    lines = ["time_s,depth_m", *(",".join(map(repr, row)) for row in rows)]
    (folder / "disc.csv").write_text("\n".join(lines), encoding="utf-8")
    bounds = f"{{from: {0.5 * TRUE}, to: {2.0 * TRUE}, start: {1.2 * TRUE}}}"
    runs = "set: {method: minimal}\nruns: [{config: disc.yaml, data: disc.csv}]"
    return fitted(folder, f"parameters: {{medium.zeta: {bounds}}}\n{runs}")


def bias_warnings(result) -> list[str]:
    """Warnings about finer steps."""
    return [warning for warning in result.warnings if "with finer steps" in warning]


def test_the_bias_of_long_steps_is_reported_and_true(tmp_path: Path) -> None:
    result = found_with(tmp_path, 2e-3, 1e-6)
    missing = TRUE - result.values[0]
    assert abs(missing) > 2.0 * result.uncertainty.estimates[0].error  # or nothing were to be told
    # A tenth of the step leaves a tenth of an error of first order; the data have some of 1e-6 m in 1e-2 m.
    assert result.bias[0] == pytest.approx(missing, rel=0.2)
    assert len(bias_warnings(result)) == 1


def test_bias_below_the_noise_gives_no_warning(tmp_path: Path) -> None:
    result = found_with(tmp_path, 2e-4, 1e-4)
    assert abs(result.bias[0]) < result.uncertainty.estimates[0].error
    assert not bias_warnings(result)
