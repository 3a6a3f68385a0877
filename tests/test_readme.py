"""What README shows is what happens."""

from __future__ import annotations

import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.S)


def command(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "granular_contact", *arguments], cwd=cwd, capture_output=True, text=True, check=True
    )


def test_the_yaml_is_that_of_the_first_run() -> None:
    shown, *_ = blocks("yaml")
    assert yaml.safe_load(shown) == yaml.safe_load((ROOT / "configs" / "pendulum.yaml").read_text(encoding="utf-8"))


def test_the_sweep_tells_that_speed_counts_and_drag_does_not(tmp_path: Path) -> None:
    _, shown, _ = blocks("yaml")
    assert yaml.safe_load(shown) == yaml.safe_load((ROOT / "configs" / "sensitivity.yaml").read_text(encoding="utf-8"))
    (line,) = (line for line in README.splitlines() if "configs/sensitivity.yaml --out" in line)
    arguments = shlex.split(line)[1:]
    arguments[arguments.index("--out") + 1] = str(tmp_path / "out")
    assert "Sobol indices of stopping_time_s" in command(*arguments, cwd=ROOT).stdout
    with (tmp_path / "out" / "sensitivity.csv").open(encoding="utf-8") as file:
        total = {row["input"]: float(row["total"]) for row in csv.DictReader(file)}
    # validation/sensitivity.py: drag has less than a hundredth of the variance, speed and eta_v nearly all.
    assert total["medium.eta_d"] < 0.02
    assert total["initial.impact_speed_rad_s"] > 0.3
    assert total["medium.plunging.eta_v"] > 0.3


def test_a_controller_holds_its_angle(capsys, monkeypatch) -> None:
    script = next(block for block in blocks("python") if "control=pid" in block)
    monkeypatch.chdir(ROOT)
    names: dict[str, object] = {}
    exec(script, names)
    told = re.search(r"It ends at ([\d.]+) deg, held by ([\d.]+) N m", README)
    assert told is not None
    assert f"angle {told[1]} deg, held by {told[2]} N m" in capsys.readouterr().out
    assert abs(names["results"]["pivot_angle_deg"][-1] - 40.0) < 0.01  # type: ignore[index]
    written = script[script.index("total =") : script.index("print")]
    assert len([line for line in written.splitlines() if line]) <= 10


def test_a_simulation_is_stepped_brought_back_and_begun_anew(monkeypatch) -> None:
    script = next(block for block in blocks("python") if "Simulation(" in block)
    monkeypatch.chdir(ROOT)
    names: dict[str, object] = {}
    exec(script, names)  # asserts itself that both futures are the same
    assert names["results"]["time_s"][-1] == pytest.approx(0.15)  # type: ignore[index]
    simulation = names["simulation"]
    assert 0.4 < simulation.scenario.medium.zeta < 0.6  # type: ignore[attr-defined]
    assert simulation.time == 0.0  # type: ignore[attr-defined]


def test_the_runner_of_gymnasium_walks(capsys) -> None:
    pytest.importorskip("gymnasium")
    script = next(block for block in blocks("python") if "gymnasium.make" in block)
    exec(script, {})
    told = re.fullmatch(r"(\d+) mm, end time 0.5 s reached\n", capsys.readouterr().out)
    assert told is not None
    assert int(told[1]) > 20


def test_the_search_is_the_shipped_one_and_what_it_finds_runs(tmp_path: Path) -> None:
    pytest.importorskip("cma")
    *_, shown = blocks("yaml")
    held = yaml.safe_load(shown)
    assert held == yaml.safe_load((ROOT / "configs" / "optimise_speed_close.yaml").read_text(encoding="utf-8"))
    (found,) = (block for block in blocks("sh") if "optimise configs" in block)
    search, run = (shlex.split(line.split("#")[0])[1:] for line in found.splitlines())
    # One population of short runs, in place of minutes.
    held |= {"config": str(ROOT / "configs" / "runner.yaml"), "evaluations": 5, "population": 4}
    held["set"] = {"solver.accuracy": 0.01, "solver.end_time_s": 0.02, "output.figures": False}
    (tmp_path / "search.yaml").write_text(yaml.safe_dump(held), encoding="utf-8")
    search[1] = str(tmp_path / "search.yaml")
    assert "largest_drive_torque_Nm" in command(*search, cwd=tmp_path).stdout
    assert "forward speed" in command(*run[:2], cwd=tmp_path).stdout


def test_the_script_comes_to_rest_under_its_weight(capsys, tmp_path, monkeypatch) -> None:
    script = next(block for block in blocks("python") if "GranularBed" in block)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(script, names)
    # At rest the sand carries the weight, m g = 0.981 N; speeds are below 1e-9 m/s by then, so drag is nothing.
    bed = names["bed"]
    np.testing.assert_allclose(bed.force, [0.0, 0.981], atol=1e-6)  # type: ignore[attr-defined]
    depth = re.search(r"at rest, ([\d.]+) mm deep", README)
    assert depth is not None
    assert f"depth {depth[1]} mm" in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []
    assert len([line for line in script.splitlines() if line]) <= 20


def test_five_lines_of_python_print_what_they_say(capsys, tmp_path, monkeypatch) -> None:
    script = next(block for block in blocks("python") if "load(" in block)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(script, names)
    shown = re.search(r"# (.*)", script)
    assert shown is not None
    assert capsys.readouterr().out.strip() == shown[1]
    results = names["results"]
    assert type(results).open(results.save("run", figures=False)).summary["name"] == "runner"
    assert len(results.plot("tip_x_m", "tip_y_m").axes) == 1


def test_the_script_in_space_comes_to_rest_under_its_weight(capsys, tmp_path, monkeypatch) -> None:
    script = next(block for block in blocks("python") if "add_body" in block)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(script, names)
    bed = names["bed"]
    weight = 2700 * 0.1 * 0.08 * 0.06 * 9.81
    np.testing.assert_allclose(bed.force, [0.0, 0.0, weight], atol=1e-6)  # type: ignore[attr-defined]
    assert f"carried by {weight:.3f} N" in README
    depth = re.search(r"at rest, ([\d.]+) mm deep,\s+carried by 12", README)
    assert depth is not None
    assert f"depth {depth[1]} mm" in capsys.readouterr().out


def test_the_first_run_leaves_what_the_table_names(tmp_path: Path) -> None:
    line = next(line for line in blocks("sh")[0].splitlines() if "granular-contact run" in line)
    arguments = shlex.split(line.split("granular-contact", 1)[1])
    command(*arguments, "--out", str(tmp_path / "out"), cwd=ROOT)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "summary.json",
        "timeseries.csv",
        "scenario.yaml",
        "motion.json",
        "figures",
    }
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    # Converged value 25.449 ms (validation/convergence.py), error of the default step below 1 us.
    assert abs(summary["stopping_time_s"] - 25.449e-3) < 2e-6
    assert summary["energy"]["imbalance_relative"] < 1e-3


def test_the_film_the_report_and_the_examples_are_made(tmp_path: Path) -> None:
    run, report, examples = (shlex.split(line.split("#")[0])[1:] for line in blocks("sh")[2].splitlines())
    command(*examples, cwd=tmp_path)
    command(*run, cwd=tmp_path / examples[-1])
    command(*report, cwd=tmp_path / examples[-1])
    made = {path.name for path in (tmp_path / examples[-1] / report[-1]).iterdir()}
    assert {"animation.gif", "report.html"} <= made


def test_the_other_commands_run(tmp_path: Path) -> None:
    run, check, schema = (line.split("#")[0].strip() for line in blocks("sh")[1].splitlines())
    arguments = shlex.split(run)[1:]
    arguments[arguments.index("--out") + 1] = str(tmp_path / "fast")
    assert "stopping time" in command(*arguments, "--no-plots", cwd=ROOT).stdout
    # (tests/validation/test_gallery.py runs all of them.)
    configs = [str(ROOT / "configs" / f"{name}.yaml") for name in ("pendulum", "paper_cases")]
    assert shlex.split(check)[1] == "check"
    assert command("check", *configs, cwd=ROOT).stdout.count(": ok") == len(configs)
    assert "properties" in json.loads(command(shlex.split(schema)[1], cwd=ROOT).stdout)


@pytest.fixture(scope="module")
def walked(tmp_path_factory) -> Path:
    """A folder in which the walk to fitted sand was made, block by block; `fit.txt` holds what the fit printed."""
    folder = tmp_path_factory.mktemp("walk")
    for name in ("configs", "models"):
        shutil.copytree(ROOT / name, folder / name)
    shim = folder / "bin" / "granular-contact"
    shim.parent.mkdir()
    shim.write_text(
        f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m granular_contact "$@"\n', encoding="utf-8"
    )
    shim.chmod(0o755)
    path = {**os.environ, "PATH": f"{shim.parent}{os.pathsep}{os.environ['PATH']}"}
    section = README.split("## From install to fitted sand")[1].split("\n## ")[0]
    printed = ""
    for language, block in re.findall(r"```(sh|python)\n(.*?)```", section, flags=re.S):
        code = ["bash", "-e", "-c", block] if language == "sh" else [sys.executable, "-c", block]
        done = subprocess.run(code, cwd=folder, env=path, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        printed += done.stdout
    (folder / "fit.txt").write_text(printed, encoding="utf-8")
    return folder


def test_the_walk_finds_the_sand_that_made_the_data(walked: Path) -> None:
    found = json.loads((walked / "results" / "fit" / "fit.json").read_text(encoding="utf-8"))
    assert found["status"] == "fits"
    for key, true in (("medium.eta_d", 5.0), ("medium.plunging.eta_v", 30.0)):
        parameter = found["parameters"][key]
        # Four standard errors: once in 16 000 draws of the noise, and the draw is fixed.
        assert abs(parameter["value"] - true) < 4 * parameter["standard_error"] < 0.05 * true


def test_the_walk_prints_what_is_shown(walked: Path) -> None:
    shown = re.search(r"```\n(parameter  .*?)```", README, flags=re.S)
    assert shown is not None
    printed = (walked / "fit.txt").read_text(encoding="utf-8")
    rows = (line for line in printed.splitlines() if line.startswith("medium."))  # in the same order
    for line in shown[1].splitlines():
        if line.startswith("medium."):
            numbers = line.split()[1:]
            there = next(rows).split()[1:]
            # The last digit may hang on the machine's own rounding.
            np.testing.assert_allclose([float(x) for x in there], [float(x) for x in numbers], rtol=2e-3, atol=2e-3)


def test_the_run_in_the_fitted_sand_is_that_of_the_true_sand(walked: Path, tmp_path: Path) -> None:
    summary = json.loads((walked / "results" / "in_fitted_sand" / "summary.json").read_text(encoding="utf-8"))
    true = ["--set", "medium.eta_d=5", "--set", "medium.plunging.eta_v=30", "--no-plots"]
    command("run", str(ROOT / "configs" / "pendulum.yaml"), *true, "--out", str(tmp_path / "out"), cwd=ROOT)
    exact = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    # Coefficients right to 1 % give stopping times, which go as their inverse roots or slower, to 1 %.
    assert abs(summary["stopping_time_s"] / exact["stopping_time_s"] - 1.0) < 0.01
