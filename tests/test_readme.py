"""The commands in README do what it says; .ci/run takes its test line."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml
from support_runs import ROOT

from granular_contact.cli import main

README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.S)


def test_the_yaml_is_that_of_the_first_run() -> None:
    (shown,) = blocks("yaml")
    assert yaml.safe_load(shown) == yaml.safe_load((ROOT / "configs" / "pendulum.yaml").read_text(encoding="utf-8"))


def test_the_first_run_writes_the_files_listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    line, _ = blocks("sh")
    arguments = shlex.split(line.rpartition("granular-contact ")[2])
    monkeypatch.chdir(ROOT)
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 0
    made = {path.name for path in (tmp_path / "out").iterdir()}
    assert made == {"summary.json", "timeseries.csv", "scenario.yaml", "motion.json", "figures"}
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    # Converged value 25.449 ms (validation/convergence.py), error of the default step below 1 us.
    assert abs(summary["stopping_time_s"] - 25.449e-3) < 2e-6
    assert summary["energy"]["imbalance_relative"] < 1e-3


def test_the_test_line_is_the_one_that_ci_takes() -> None:
    taken = re.findall(r"^\s*line=\$\((grep .*)\)$", (ROOT / ".ci" / "run").read_text(encoding="utf-8"), flags=re.M)
    printed = subprocess.run(["bash", "-c", *taken], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    _, shown = blocks("sh")
    assert printed == shown
    assert shown.startswith("python3 -m venv .venv && .venv/bin/pip install -q -e '.[test]'")


def test_python_prints_what_it_says(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for script in blocks("python"):  # each goes on from the one before
        exec(compile(script, "README.md", "exec", dont_inherit=True), names)
        (shown,) = re.findall(r"# (.*)", script)
        assert capsys.readouterr().out.strip() == shown
    results = names["results"]
    assert type(results).open(results.save("run", figures=False)).summary["name"] == "runner"
    assert len(results.plot("tip_x_m", "tip_y_m").axes) == 1


def test_readme_stays_below_100_lines() -> None:
    assert len(README.splitlines()) < 100
