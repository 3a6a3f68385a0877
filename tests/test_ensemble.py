"""Statistics of ensembles, and what they refuse. That they do not depend on workers: tests/test_sweep_cluster.py."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support_runs import scenario_of

from granular_contact import report
from granular_contact.cli import main
from granular_contact.errors import ConfigError
from granular_contact.run import run
from granular_contact.scene import build
from granular_contact.studies import ensemble
from granular_contact.studies.ensemble import statistics
from granular_contact.studies.ensemble.runs import INSTANTS
from granular_contact.studies.sweep.journal import Row

SCATTER = "medium.scatter={relative: 0.3, length_m: 0.003, seed: 5}"


def rows(values: np.ndarray) -> list[Row]:
    """Runs that end at 1 s or 2 s, in another order than that of their seeds."""
    made = []
    for i, x in enumerate(values):
        end = 1.0 + i % 2
        row = {"status": "rest", "message": "", "max_depth_m": float(x), "same": 3.0, "cost.solve_s": float(i)}
        row |= {"series.time_s": np.linspace(0, end, INSTANTS).tolist(), "series.depth_m": [float(x)] * INSTANTS}
        made.append(Row(i, str(i), {}, row))
    return [Row(len(values), "bad", {}, {"status": "error", "message": "no"}), *made[::-1]]


def test_numbers_of_an_ensemble() -> None:
    values = np.random.default_rng(3).normal(0.2, 0.03, 500)
    statistics = ensemble.of_rows(rows(values))
    assert (statistics.count, statistics.failed, list(statistics.numbers)) == (500, 1, ["max_depth_m"])
    depth = statistics.numbers["max_depth_m"]
    np.testing.assert_array_equal(depth.values, values)
    assert depth.mean == pytest.approx(values.mean())
    assert depth.error == pytest.approx(values.std(ddof=1) / np.sqrt(500))
    runs, mean, half = depth.settling()
    for n, quantile in ((2, 12.7062), (17, 2.1199), (500, 1.9647)):  # 97.5 %, from a table of Student's distribution
        at = int(np.flatnonzero(runs == n)[0])
        assert mean[at] == pytest.approx(values[:n].mean())
        assert half[at] == pytest.approx(quantile * values[:n].std(ddof=1) / np.sqrt(n), rel=5e-5)
    assert statistics.time[-1] == 2.0
    np.testing.assert_allclose(statistics.bands["depth_m"][2], np.median(values), rtol=1e-12)


def test_an_ensemble_can_be_run_again_in_its_folder(tmp_path: Path) -> None:
    statistics.write(ensemble.of_rows(rows(np.arange(4.0))), tmp_path, figures=False)
    assert {path.name for path in tmp_path.iterdir()} == {"statistics.csv", "convergence.csv", "bands.csv"}
    report.check_target(tmp_path, "sweep")


def test_members_differ_in_their_seed_alone() -> None:
    sweep = ensemble.cases(scenario_of("pendulum_rigid", SCATTER), 3)
    members = [sweep.scenario(case) for case in sweep.cases]
    assert [member.media[0].scatter.seed for member in members] == [5, 6, 7]
    assert {member.media[0].model_copy(update={"scatter": None}).model_dump_json() for member in members} == {
        scenario_of("pendulum_rigid").media[0].model_dump_json()
    }


def test_one_seed_has_one_motion_by_steps_of_any_accuracy() -> None:
    # Finer steps asked for shorter strips once, and with them another draw: 800 us. The steps alone may move the stop
    # by the accuracy, 1e-3 of the 26 ms.
    stops = []
    for accuracy in (1e-3, 3e-4):
        changes = {"medium.scatter": {"relative": 0.15, "length_m": 0.003}, "solver.accuracy": accuracy}
        stops.append(run(build(scenario_of("pendulum").replace(changes))).summary["stopping_time_s"])
    assert stops[0] == pytest.approx(stops[1], abs=2.6e-5)


def test_a_run_without_scatter_is_no_ensemble(capsys: pytest.CaptureFixture[str]) -> None:
    for override in ("medium.scatter=null", "medium.scatter={relative: 0, length_m: 0.003}"):
        with pytest.raises(ConfigError, match=r"medium.scatter: is missing, or its relative is 0"):
            ensemble.cases(scenario_of("pendulum_rigid", override), 3)
    with pytest.raises(ConfigError, match="got 1 runs from the seed 5 on; allowed are 2 runs or more"):
        ensemble.cases(scenario_of("pendulum_rigid", SCATTER), 1)
    assert main(["ensemble", "configs/pendulum.yaml"]) == 2
    assert "medium.scatter: is missing" in capsys.readouterr().err


def test_a_finished_ensemble_is_said_to_be_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["ensemble", "configs/pendulum_rigid.yaml", "--set", SCATTER, "--set", "output.figures=false"]
    command += ["--count", "2", "--workers", "1", "--out", str(tmp_path / "out")]
    assert main([*command, "--quiet"]) == 0
    assert main(command) == 0
    assert "holds all runs of this ensemble already; --restart" in capsys.readouterr().out


def test_scatter_is_refused_by_reduced_models_and_resultant_loads() -> None:
    from granular_contact.errors import SceneError
    from granular_contact.scene import build

    for override, message in (("method={reduced: {modes: 0}}", "scatters"), ("load.form=resultant", "load.form")):
        with pytest.raises(SceneError, match=message):
            build(scenario_of("pendulum_rigid", SCATTER, override))
