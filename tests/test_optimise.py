"""Searches find the best case for any number of workers and after kills, and report faults of their file."""

from __future__ import annotations

import csv
import dataclasses
import json
import math
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
import yaml
from support_figures import sketched
from support_refusals import faults_of
from support_results import make
from support_sweep import CONFIGS, ENVIRONMENT, arguments, until

import granular_contact
from granular_contact.cli import main
from granular_contact.cli import many as shared
from granular_contact.config import Scenario, Study, load, load_optimise, scenario_to_dict
from granular_contact.errors import ConfigError, MissingPackageError
from granular_contact.report import pages
from granular_contact.results import Results
from granular_contact.scene import build
from granular_contact.studies.optimise import search as searching
from granular_contact.studies.optimise.outcome import Outcome
from granular_contact.studies.optimise.search import search
from granular_contact.studies.sweep import FolderRefused, Journal, WorkerPool

HERE = {**ENVIRONMENT, "PYTHONPATH": os.pathsep.join([ENVIRONMENT["PYTHONPATH"], *filter(None, sys.path)])}
METHODS = ("cma", "differential_evolution")
SPEED, ANGLE = "initial.impact_speed_rad_s", "initial.impact_angle_deg"
BEST_SPEED, BEST_ANGLE = 4.0, 30.0
# A paraboloid in place of runs. Ranges are not centred on its top, and the config starts elsewhere.
PARAMETERS = f"""parameters:
  {SPEED}: {{from: 1, to: 9, scale: log}}
  {ANGLE}: [10, 80]
"""
FILE = f"config: {CONFIGS / 'pendulum_rigid.yaml'}\n{PARAMETERS}objective: {{maximise: height}}\nevaluations: 150\n"


@pytest.fixture(autouse=True)
def _cma_is_here():
    pytest.importorskip("cma", reason="the extra [optimise] is not installed")


class Threads(ThreadPoolExecutor):
    """In place of processes; ends when it is told to."""

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        super().shutdown(wait=True, cancel_futures=cancel_futures)


def hill(scenario: Scenario) -> Results:
    """Height 1 at the top; `steep` is the distance from it in speed alone."""
    speed, angle = scenario.initial.impact_speed_rad_s, scenario.initial.impact_angle_deg
    away = (math.log(speed / BEST_SPEED) ** 2, ((angle - BEST_ANGLE) / 70) ** 2)
    numbers = {"height": 1 - sum(away), "speed": speed, "stopping_time_s": None}
    return dataclasses.replace(make(), summary={"status": "rest", **numbers, "energy": {"initial_J": speed**2}})


def breaking(scenario: Scenario) -> Results:
    """No run beyond 50 degrees; none that is usable below 20."""
    results, angle = hill(scenario), scenario.initial.impact_angle_deg
    if angle > 50:
        raise ArithmeticError(f"too steep{' by far' * (angle > 70)}")
    if angle < 20:
        results.summary["energy"]["imbalance_relative"] = 0.5
        results.summary["usable"] = False
        results.summary["height"] = 100.0
    return results


def study(folder: Path, text: str = FILE, name: str = "search.yaml") -> Study:
    (folder / name).write_text(text, encoding="utf-8")
    return load_optimise(folder / name, probe=build)


def outcome_of(held: Study, workers: int = 1, function=hill, **more) -> Outcome:
    with WorkerPool(workers, Threads) as pool:
        return search(held, pool, function=function, **more)


# ---- what is found ----


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_the_top_is_found_and_workers_do_not_matter(tmp_path, method):
    held = study(tmp_path, f"{FILE}method: {method}\nseed: 3\n")
    outcome = outcome_of(held)
    best = outcome.numbers
    # The paraboloid falls by 1e-3 within 3 % of the range of the angle and of the logarithm of the speed.
    assert outcome.value > 1 - 1e-3
    assert best[SPEED] == pytest.approx(BEST_SPEED, rel=0.04)
    assert best[ANGLE] == pytest.approx(BEST_ANGLE, abs=2.5)
    assert outcome.start.numbers == {}
    assert outcome.start.value < 0.9
    assert outcome.gain == pytest.approx(outcome.value / outcome.start.value - 1)
    assert (len(outcome.runs), outcome.failed, outcome.ended) == (150, [], "")
    assert outcome_of(held, workers=3).rows == outcome.rows
    few = FILE.replace("evaluations: 150", "evaluations: 20")
    other = outcome_of(study(tmp_path, f"{few}method: {method}\nseed: 4\n", "other.yaml"))
    assert other.rows[2] != outcome.rows[2]


@pytest.mark.parametrize("method", METHODS)
def test_constraints_are_kept_though_better_lies_beyond(tmp_path, method):
    text = f"{FILE}method: {method}\nconstraints: {{speed: {{at_most: 3, at_least: 2}}}}\n"
    outcome = outcome_of(study(tmp_path, text))
    assert outcome.best.is_allowed
    assert 2.9 < outcome.best.row.summary["speed"] <= 3  # the top is at 4
    assert outcome.gain is None  # the config has a speed of 6, which is not allowed
    assert max(run.value for run in outcome.runs) > outcome.value


def test_unsatisfiable_constraints_are_violated_least(tmp_path):
    outcome = outcome_of(study(tmp_path, f"{FILE}constraints: {{speed: {{at_most: 0.5}}}}\n"))
    assert not outcome.best.is_allowed
    assert outcome.best.row.summary["speed"] == pytest.approx(1, rel=0.02)  # the lowest of the range


@pytest.mark.parametrize("method", METHODS)
def test_failed_runs_count_as_worst_and_are_reported(tmp_path, method):
    outcome = outcome_of(study(tmp_path, f"{FILE}method: {method}\n"), function=breaking)
    assert outcome.value > 1 - 1e-2
    assert 20 <= outcome.numbers[ANGLE] <= 50
    reasons = {run.failure for run in outcome.failed}
    assert "ArithmeticError: too steep" in reasons
    assert "the energy balance has an error of 50%: the result is not usable" in reasons
    assert all(run.cost > 1e35 for run in outcome.failed)


def test_weights_and_the_sense_of_the_objective(tmp_path):
    text = FILE.replace("{maximise: height}", "{minimise: {height: -2, speed: 0.0, energy.initial_J: 1.0e-9}}")
    outcome = outcome_of(study(tmp_path, text))
    assert outcome.value == pytest.approx(-2, abs=2e-3)
    assert outcome.study.file.objective.formula == "-2 height + 0 speed + 1e-09 energy.initial_J"


def test_a_parameter_sets_all_of_its_keys(tmp_path):
    text = FILE.replace(f"  {ANGLE}: [10, 80]", f"  both: {{keys: [gravity_m_s2, {ANGLE}], from: 10, to: 80}}")
    held = study(tmp_path, text)
    assert held.start == {SPEED: 6.24, "both": None}  # they differ in the config
    scenario = held.sweep.scenario(held.case(1, {"both": 12.5}))
    assert scenario.gravity_m_s2 == scenario.initial.impact_angle_deg == 12.5


# ---- killed and resumed ----


def test_cases_in_the_journal_are_not_run_again(tmp_path):
    held, ran = study(tmp_path), []
    whole = outcome_of(held)
    writer = Journal(tmp_path).writer()
    for run in whole.runs[:70:2]:
        writer.append(run.row.line())
    writer.close()
    resumed = outcome_of(held, journal=Journal(tmp_path), advance=lambda: ran.append(1))
    assert resumed.rows == whole.rows
    assert len(ran) == 150 - 35
    with pytest.raises(FolderRefused, match=r"run_001 in the journal has other numbers than this search asks for"):
        outcome_of(study(tmp_path, f"{FILE}seed: 5\n", "other.yaml"), journal=Journal(tmp_path))


REAL = f"""config: {CONFIGS / "pendulum_rigid.yaml"}
set: {{method: {{reduced: {{modes: 0}}}}, output.figures: false}}
{PARAMETERS}objective: {{minimise: stopping_time_s}}
constraints: {{max_depth_m: {{at_most: 0.02}}}}
evaluations: 30
seed: 1
"""


def history(folder: Path) -> list[dict[str, str]]:
    with (folder / "history.csv").open(encoding="utf-8", newline="") as file:
        return [{key: cell for key, cell in row.items() if key != "cost.solve_s"} for row in csv.DictReader(file)]


@pytest.mark.slow
def test_a_search_killed_goes_on_to_the_same_best(tmp_path, monkeypatch, capsys):
    (tmp_path / "search.yaml").write_text(REAL, encoding="utf-8")
    command = ["optimise", str(tmp_path / "search.yaml"), "--out", str(tmp_path / "out"), "--workers", "2"]

    def lines(out: Path) -> int:
        return sum(file.read_bytes().count(b"\n") for file in (out.with_suffix(".part") / "journal").glob("*.jsonl"))

    with subprocess.Popen(arguments(*command), env=HERE, stdout=subprocess.DEVNULL) as process:
        until(lambda: process.poll() is not None or lines(tmp_path / "out") >= 8, 100)
        process.send_signal(signal.SIGKILL)
    kept = lines(tmp_path / "out")
    assert 8 <= kept < 30
    assert not (tmp_path / "out").exists()
    monkeypatch.setattr(shared, "pool", lambda *_: WorkerPool(2, Threads))  # other workers go on
    assert main(command) == 0
    printed = capsys.readouterr().out
    assert f"going on in {tmp_path / 'out.part'}: " in printed
    assert "better by" in printed
    # Undisturbed, from Python, on one worker.
    settings = {"method": {"reduced": {"modes": 0}}, "output": {"figures": False}}
    whole = granular_contact.optimise(
        load(CONFIGS / "pendulum_rigid.yaml", settings),
        yaml.safe_load(PARAMETERS)["parameters"],
        minimise="stopping_time_s",
        constraints={"max_depth_m": {"at_most": 0.02}},
        evaluations=30,
        seed=1,
        workers=1,
    )
    rows = history(tmp_path / "out")
    assert [float(row["objective"]) for row in rows] == [entry.value for entry in whole.runs]
    printed = json.loads((tmp_path / "out" / "optimise.json").read_text(encoding="utf-8"))
    assert printed["best"] == whole.value
    assert {name: entry["best"] for name, entry in printed["parameters"].items()} == whole.numbers
    # What was found is a config that runs, and gives what was found.
    best = load(tmp_path / "out" / "best.yaml").scenario
    assert scenario_to_dict(best) == scenario_to_dict(whole.scenario)
    results = Results.open(tmp_path / "out" / "best")
    # A run of its own builds its scene anew, one of a search takes it over from the one before: round-off apart.
    assert results.summary["stopping_time_s"] == pytest.approx(whole.value, rel=1e-12)
    assert results.summary["max_depth_m"] <= 0.02
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        *("optimise.yaml", "history.csv", "optimise.json", "best.yaml", "best"),
    }
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "search.yaml"]


# ---- the command ----


@pytest.fixture
def runs_in_this_process(monkeypatch):
    """Let the command take its runs in threads of this process, and draw them soon."""
    monkeypatch.setattr(shared, "pool", lambda *_: WorkerPool(2, Threads))
    with sketched():
        yield


TINY = REAL.replace("evaluations: 30", "evaluations: 20").replace("false", "true")


@pytest.mark.slow
@pytest.mark.usefixtures("runs_in_this_process")
def test_the_command_its_folder_and_its_page(tmp_path, capsys):
    text = TINY.replace("constraints: {max_depth_m: {at_most: 0.02}}\n", "")
    text = text.replace("{minimise: stopping_time_s}", "{minimise: {stopping_time_s: 1, max_depth_m: 0.01}}")
    (tmp_path / "search.yaml").write_text(text, encoding="utf-8")
    command = ["optimise", str(tmp_path / "search.yaml"), "--out", str(tmp_path / "out")]
    assert main(command) == 0
    out = capsys.readouterr().out
    assert "minimise, and constraints" in out
    assert sorted(path.name for path in (tmp_path / "out" / "figures").iterdir()) == ["history.png", "parameters.png"]
    assert (tmp_path / "out" / "best" / "figures" / "mechanism.png").is_file()
    before = {path: path.read_bytes() for path in (tmp_path / "out").rglob("*") if path.is_file()}
    assert main(command) == 0
    assert "holds all runs of this search already" in capsys.readouterr().out
    page = pages.write(tmp_path / "out").read_text(encoding="utf-8")
    assert "to minimise stopping_time_s + 0.01 max_depth_m" in " ".join(page.split())
    assert 'id="cases-chart"' in page  # any number of the runs against any other
    assert "granular-contact run best.yaml" in page
    saved = (tmp_path / "out" / "optimise.yaml").read_text(encoding="utf-8")
    assert "figures: true" in saved
    (tmp_path / "again.yaml").write_text(saved.replace("figures: true", "figures: false"), encoding="utf-8")
    assert main(["optimise", str(tmp_path / "again.yaml"), "--out", str(tmp_path / "again")]) == 0
    assert history(tmp_path / "again") == history(tmp_path / "out")
    assert {path: path.read_bytes() for path in before} == before
    (tmp_path / "search.yaml").write_text(text.replace("seed: 1", "seed: 2"), encoding="utf-8")
    assert main(command) == 2
    assert "contains another search (seed is 1 there, but 2 is requested)" in capsys.readouterr().err
    assert main(["check", str(tmp_path / "search.yaml")]) == 0
    assert main(["schema", "--of", "optimise"]) == 0
    assert {"parameters", "objective"} <= json.loads(capsys.readouterr().out.partition("\n")[2])["properties"].keys()


@pytest.mark.usefixtures("runs_in_this_process")
def test_a_missing_search_package_is_reported_in_one_line(tmp_path, capsys, monkeypatch):
    def missing(name: str) -> str:
        raise searching.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(searching.metadata, "version", missing)
    (tmp_path / "search.yaml").write_text(TINY, encoding="utf-8")
    assert main(["optimise", str(tmp_path / "search.yaml"), "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"{tmp_path / 'search.yaml'}: method: cma needs the package cma: pip install ")
    with pytest.raises(MissingPackageError):
        searching.packages(study(tmp_path).file)


# ---- bad input ----

FAULTY = {
    "a key that is nowhere": ((ANGLE, "initial.impact_angel_deg"), 4, "unknown key; did you mean impact_angle_deg?"),
    "a part that is nowhere": ((ANGLE, "model.bodies.lnk.length_m"), 4, "no 'lnk' in model.bodies; did you mean link?"),
    "bounds that the schema refuses": (("[10, 80]", "[10, 800]"), 4, "got the number 800; allowed is"),
    "a log scale from 0": (("from: 1,", "from: 0,"), 3, "on a log scale both must be above 0"),
    "no goal": (("{maximise: height}", "{}"), 5, "got neither of maximise and minimise; exactly one is allowed"),
    "an odd goal": (("maximise: height", "maximize: height"), 5, "unknown key; did you mean maximise?"),
    "a limit of nothing": (
        ("evaluations: 150", "constraints: {speed: {}}"),
        6,
        "got neither at_least nor at_most; one of them is needed",
    ),
    "too few runs": (("150", "12"), 6, "got 12; the config as it is and one population need 13"),
    "too few to differ": (
        ("evaluations: 150", "method: differential_evolution\npopulation: 4"),
        7,
        "got 4; differential_evolution needs 5 or more",
    ),
    "a method that is none": (("evaluations: 150", "method: cmaes"), 6, "got the text 'cmaes'; allowed is one of cma"),
    "a key set twice": (
        (ANGLE, f"both: {{keys: [{SPEED}], from: 1, to: 2}}\n  {ANGLE}"),
        4,
        f"sets {SPEED}, which {SPEED} sets too",
    ),
    "no config": (("pendulum_rigid.yaml", "nowhere.yaml"), 1, "but there is no file"),
}


@pytest.mark.parametrize("case", FAULTY)
def test_faults_are_reported_at_their_lines(tmp_path, case):
    change, line, message = FAULTY[case]
    with pytest.raises(ConfigError) as caught:
        study(tmp_path, FILE.replace(*change))
    places = [(fault.file, fault.line) for fault in caught.value.faults]
    assert places[0] == (str(tmp_path / "search.yaml"), line)
    assert message in caught.value.faults[0].message


def test_faults_of_a_file_its_keys_and_its_ends_are_reported_together(tmp_path):
    parameters = f"parameters:\n  initial.impact_sped_rad_s: [9, 4]\n  {ANGLE}: [10, 800]\n  load.odd: [2, 2]\n"
    faults = faults_of(ConfigError, study, tmp_path, FILE.replace(PARAMETERS, parameters) + "method: cmaes\n")
    assert [fault.line for fault in faults] == [3, 4, 5, 8]


@pytest.mark.parametrize(
    ("change", "key", "message"),
    [
        (("maximise: height", "maximise: hight"), "objective.maximise", "no number of a summary; did you mean height?"),
        (("maximise: height", "maximise: status"), "objective.maximise", "got 'status', which is no number"),
        (("maximise: height", "minimise: stopping_time_s"), "objective.minimise", "of the first 13 runs has stopping"),
        (("evaluations", "constraints: {sped: {at_most: 1}}\nevaluations"), "constraints.sped", "did you mean speed?"),
    ],
)
def test_an_objective_that_no_run_has_ends_the_search(tmp_path, change, key, message):
    (fault,) = faults_of(ConfigError, outcome_of, study(tmp_path, FILE.replace(*change)))
    assert (fault.key, fault.line is not None) == (key, True)
    assert message in fault.message
