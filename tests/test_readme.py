"""What README shows is what happens."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
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
    (shown,) = blocks("yaml")
    assert yaml.safe_load(shown) == yaml.safe_load((ROOT / "configs" / "pendulum.yaml").read_text(encoding="utf-8"))


def test_the_script_comes_to_rest_under_its_weight(capsys, tmp_path, monkeypatch) -> None:
    (script,) = blocks("python")
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


def test_the_first_run_leaves_what_the_table_names(tmp_path: Path) -> None:
    line = next(line for line in blocks("sh")[0].splitlines() if "granular-contact run" in line)
    arguments = shlex.split(line.split("granular-contact", 1)[1])
    command(*arguments, "--out", str(tmp_path / "out"), cwd=ROOT)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "summary.json",
        "timeseries.csv",
        "scenario.yaml",
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
    configs = sorted(str(path) for path in (ROOT / "configs").glob("*.yaml"))
    assert shlex.split(check)[1] == "check"
    assert command("check", *configs, cwd=ROOT).stdout.count(": ok") == len(configs)
    assert "properties" in json.loads(command(shlex.split(schema)[1], cwd=ROOT).stdout)
