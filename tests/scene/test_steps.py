"""Which steps a run takes where its config names none."""

from __future__ import annotations

import pytest
from support_runs import CONFIGS

from granular_contact import load
from granular_contact.cli.main import main
from granular_contact.scene import build
from granular_contact.scene.steps import ACCURACY, STEP

NO_STEPS = {"step_s": None, "accuracy": None}


@pytest.mark.parametrize(
    ("config", "changes", "step", "accuracy", "why"),
    [
        ("pendulum", {}, STEP, None, "one body moves in the plane"),
        ("free_link", {}, STEP, ACCURACY, "one that flies free"),
        ("double_pendulum", {"solver": NO_STEPS}, STEP, ACCURACY, "several bodies move"),
        ("dragged_plate", {"solver": NO_STEPS}, STEP, ACCURACY, "drives move the mechanism"),
        ("wheel", {"solver": NO_STEPS}, STEP, ACCURACY, "drives move the mechanism"),
        ("dropped", {"solver": NO_STEPS}, STEP, ACCURACY, "or moves in space"),
        ("runner", {}, STEP, 1e-2, "solver.accuracy"),
        ("runner", {"solver": {"accuracy": None, "step_s": 1e-3}}, 1e-3, None, "solver.step_s"),
        ("flexible_leg", {}, 5e-4, None, "solver.step_s"),
        ("pendulum", {"solver": {"step_s": 1e-3, "accuracy": 1e-4}}, 1e-3, 1e-4, "solver.accuracy"),
        ("pendulum", {"method": {"reduced": {}}}, STEP, None, "rtol"),
        ("double_pendulum", {"method": "minimal"}, 1e-4, None, "solver.step_s"),
        ("pendulum", {"solver": {"end_time_s": 1e-4}}, 1e-4, None, "one body"),
    ],
)
def test_steps_follow_from_what_moves_where_the_config_names_none(
    config: str, changes: dict[str, object], step: float, accuracy: float | None, why: str
) -> None:
    solver = build(load(config, **changes)).solver  # type: ignore[arg-type]
    assert (solver.step_s, solver.accuracy) == (step, accuracy)
    assert why in solver.why


def test_explain_prints_the_steps_and_the_reason(tmp_path, capsys) -> None:  # type: ignore[no-untyped-def]
    run = ["run", str(CONFIGS / "dropped.yaml"), "--explain", "--no-plots", "--out", str(tmp_path)]
    assert main([*run, "--set", "solver={end_time_s: 0.001}"]) == 0
    printed = capsys.readouterr().out
    assert "steps chosen by their error, with an accuracy of 0.001: several bodies move, or one that flies" in printed
    assert "settling: not asked for" in printed
