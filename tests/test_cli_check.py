"""The command line: what it prints, and its exit codes. What it must not import: test_imports.py."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from support_results import make
from support_runs import ROOT

from granular_contact.cli import main
from granular_contact.cli.common import output_folder, worst
from granular_contact.errors import SolveError
from granular_contact.results import Column, Results, Status

CONFIG = str(ROOT / "configs" / "pendulum.yaml")
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}


@pytest.fixture
def command(monkeypatch, capsys):
    """As a user calls it, in this process: it has no start of a second."""

    def run(*arguments: str, folder: Path = ROOT) -> SimpleNamespace:
        monkeypatch.chdir(folder)
        code = main(list(arguments))
        printed = capsys.readouterr()
        return SimpleNamespace(returncode=code, stdout=printed.out, stderr=printed.err)

    return run


def test_check_names_each_good_file(command):
    # One of each kind whose check needs no kernel; all of them: the tests of the gallery.
    kinds = ("pendulum", "walker_in_space", "paper_cases", "optimise_c_leg")
    names = [f"configs/{kind}.yaml" for kind in kinds]
    done = command("check", *names)
    assert (done.returncode, done.stdout.splitlines(), done.stderr) == (0, [f"{name}: ok" for name in names], "")


def test_check_reports_the_bad_and_the_good(command, tmp_path):
    (tmp_path / "bad.yaml").write_text("model: compound_pendulum\ninitial: {impact_angle_deg: 95}\ngravity: 1\n")
    (tmp_path / "good.yaml").write_text("model: compound_pendulum\ninitial: {impact_angle_deg: 9}\n")
    done = command("check", "bad.yaml", "good.yaml", "no.yaml", folder=tmp_path)
    assert done.returncode == 2
    assert done.stdout == "good.yaml: ok\n"
    assert done.stderr.splitlines() == [
        "bad.yaml:2: initial.impact_angle_deg: got the number 95; allowed is a finite number from -90 to 90, or null",
        "bad.yaml:3: gravity: unknown key; did you mean gravity_m_s2?",
        "no.yaml: no such file",
    ]


def test_a_model_is_no_config_and_says_so(command):
    """Of bodies, and from a robot file; its own keys are not told as unknown."""
    for name in ("walker", "hexapod"):
        done = command("check", f"models/{name}.yaml")
        message = f"models/{name}.yaml: is a model, and not the config of a run, which names it: `model: FILE`\n"
        assert (done.returncode, done.stderr) == (2, message)


def test_robot_files_are_distinguished_from_configs(command, tmp_path):
    done = command("run", "models/hexapod/hexapod.urdf")
    message = "is a robot file, and not the config of a run, which names it: `model: {urdf: FILE}`\n"
    assert (done.returncode, done.stderr) == (2, f"models/hexapod/hexapod.urdf: {message}")
    (tmp_path / "rover.yaml").write_text("model: compound_pendulum\n")
    done = command("run", "rover", folder=tmp_path)
    message = "rover: no such file, and no config of this name is shipped; did you mean rover.yaml?\n"
    assert (done.returncode, done.stderr) == (2, message)


def test_a_fault_of_the_geometry_gets_its_line(command, tmp_path):
    """A pendulum that is welded to the ground and yet turns passes the schema; only the scene sees it."""
    text = """\
model:
  from: compound_pendulum
  joints:
    pivot: {type: weld}
initial:
  impact_angle_deg: 31
  impact_speed_rad_s: 6
"""
    (tmp_path / "run.yaml").write_text(text)
    done = command("check", "run.yaml", folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("run.yaml:7: initial.impact_speed_rad_s: ")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["check", "/"], "is a folder"),
        (["check", os.devnull], "is empty"),
        (["run", "nowhere.yaml"], "nowhere.yaml: no such file"),
        (["run", CONFIG, "--set", "medium.eta_h=x"], "--set medium.eta_h=x: medium.eta_h: got the text 'x'"),
        (["run", CONFIG, "--out", "/dev/null/a/b"], "/dev/null"),
        (["run", CONFIG, "--out", "/dev/null"], "/dev/null"),
        (["run", CONFIG, "--out", "/proc/a/b"], "can't be written"),
        (["run", CONFIG, "--out", str(ROOT)], "which no run wrote"),
        (["run", CONFIG, "--out", "x" * 300], "can't be written"),
    ],
    ids=lambda value: " ".join(value)[-30:] if isinstance(value, list) else "",
)
def test_bad_input_ends_with_2_and_no_traceback(command, arguments, message, tmp_path):
    done = command(*arguments, folder=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_may_be_written_is_left_as_it_was(tmp_path):
    """Trying whether a folder can be written leaves no trace, in it or around it."""
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "summary.json").write_text("{}")
    for name in ("old", "new", "a/b/c"):
        assert output_folder(str(tmp_path / name), "unused") == tmp_path / name
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["old", "summary.json"]


def test_schema_is_json(command):
    done = command("schema")
    assert (done.returncode, done.stderr) == (0, "")
    assert "solver" in json.loads(done.stdout)["properties"]


@pytest.mark.slow
def test_a_reader_that_leaves_is_no_error():
    line = f"'{sys.executable}' -m granular_contact schema | true"
    done = subprocess.run(["bash", "-c", line], cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True, timeout=60)
    assert done.stderr == ""


def finished(code: str) -> Results:
    """What a run leaves behind that ended in status `code` and has nothing to show."""
    table = np.zeros((2, 1))
    columns = (Column("time_s", "since the start"),)
    summary = {"stopping_time_s": 0.0254, "stopping_time_measure": "mean rate", "energy": {"imbalance_relative": 1e-6}}
    status, warnings = Status(code, f"it was {code}"), ("too fast",)
    return Results("strike", status, columns, table, summary, {}, (), None, warnings)


@pytest.fixture
def fake_run(monkeypatch, tmp_path):
    """Replaces the engine by one that reports some progress, or raises, and ends as told."""
    monkeypatch.chdir(tmp_path)

    def set_up(outcome: str | BaseException) -> None:
        def run(scene, scenario, progress, **_):
            assert scene.name == scenario.name == "pendulum"
            if progress is not None:
                progress(0.1, 0.5)
            if isinstance(outcome, BaseException):
                raise outcome
            return finished(outcome)

        monkeypatch.setitem(sys.modules, "granular_contact.run", SimpleNamespace(run=run))

    return set_up


@pytest.mark.parametrize(("status", "code"), [("rest", 0), ("end_time", 0), ("failed", 3), ("interrupted", 130)])
def test_run_prints_its_end_and_saves(fake_run, capsys, status, code):
    fake_run(status)
    assert main(["run", CONFIG, "--no-plots"]) == code
    printed = capsys.readouterr().out.splitlines()
    assert printed[0] == f"strike: it was {status}"
    assert "  stopping time   25.40 ms, mean rate" in printed
    assert printed[-2:] == ["  saved in        results/pendulum", "warning: too fast"]
    assert Path("results/pendulum/summary.json").is_file()
    assert main(["run", CONFIG, "--no-plots", "--quiet"]) == code
    quiet = capsys.readouterr()
    assert quiet.out == ""
    assert quiet.err == (f"it was {status}; saved in results/pendulum\n" if code else "")


def test_progress_is_drawn_on_a_terminal_only(fake_run, capsys, monkeypatch):
    fake_run("rest")
    main(["run", CONFIG, "--no-plots"])
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    main(["run", CONFIG, "--no-plots"])
    assert "of 0.5 s simulated" in capsys.readouterr().err


@pytest.mark.parametrize(("error", "code"), [(KeyboardInterrupt(), 130), (SolveError("no engine"), 3)])
def test_a_run_that_breaks_off_saves_nothing(fake_run, capsys, error, code):
    fake_run(error)
    assert main(["run", CONFIG]) == code
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert list(Path.cwd().iterdir()) == []


def test_an_unexpected_error_is_not_hidden(fake_run):
    fake_run(ZeroDivisionError())
    with pytest.raises(ZeroDivisionError):
        main(["run", CONFIG])


def test_the_worst_of_several_runs_gives_the_exit_code() -> None:
    fine = make()
    useless = dataclasses.replace(fine, summary=fine.summary | {"usable": False})
    late, failed = (dataclasses.replace(useless, status=Status(code, "")) for code in ("time_limit", "failed"))
    several = ([], [fine], [fine, useless], [useless, late], [late, failed, useless])
    assert [worst(runs) for runs in several] == [0, 0, 5, 4, 3]
