"""Fits of media to the motion of a ball and a disc: the coefficient, and the range of sizes written with the medium."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support_fit import fitted
from support_models import ball
from support_runs import simulate

from granular_contact.studies.fit.writing import media

BALL = ball(
    "medium: {law: poncelet, constant_force_N: 3.0, drag_kg_m: 1.0}",
    "initial: {joints: {flight: {vy_m_s: -1.0}}}",
    "solver: {step_s: 2e-4, end_time_s: 0.05}",
)
DISC = BALL.replace(
    "type: sphere, diameter_m: 0.0254", "type: disc, diameter_m: 0.03, thickness_m: 0.02, in_sand: true"
).replace("law: poncelet, constant_force_N: 3.0, drag_kg_m: 1.0", "law: rft, zeta: 1.5")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "key", "true", "size"),
    # of a disc the width of its rim
    [(BALL, "constant_force_N", 3.0, 0.0254), (DISC, "zeta", 1.5, 0.02)],
    ids=["ball", "disc"],
)
def test_medium_of_a_ball_or_round_bar_is_fitted(tmp_path: Path, text: str, key: str, true: float, size: float) -> None:
    (tmp_path / "round.yaml").write_text(text, encoding="utf-8")
    results = simulate(text)
    time = np.linspace(0.0, 0.04, 21)
    depth = np.interp(time, results["time_s"], results["depth_m"])
    rows = np.column_stack([time, depth + 1e-5 * np.random.default_rng(0).standard_normal(21)]).tolist()
    lines = ["time_s,depth_m", *(",".join(map(repr, row)) for row in rows)]
    (tmp_path / "round.csv").write_text("\n".join(lines), encoding="utf-8")
    bounds = f"{{from: {0.5 * true}, to: {2.0 * true}, start: {1.2 * true}}}"
    runs = "set: {method: engine}\nruns: [{config: round.yaml, data: round.csv}]"
    result = fitted(tmp_path, f"parameters: {{medium.{key}: {bounds}}}\n{runs}")
    # 1e-5 m of some 1e-2 m, of 21 rows: a few in a thousand.
    assert result.values[0] == pytest.approx(true, rel=0.02)
    (medium,) = media(result).values()
    assert medium[key] == result.values[0]
    assert medium["range"]["size_m"] == [size, size]
    assert medium["range"]["depth_m"][1] == pytest.approx(float(results["depth_m"].max()), rel=0.02)
