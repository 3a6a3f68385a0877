"""The command `fit`: its output, its files and its exit codes."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from support_fit import CONFIG, RIGID, measure

from granular_contact import config
from granular_contact.cli import main
from granular_contact.cli.fit import digits
from granular_contact.scene import build

FAST = ("--set", "method.reduced.modes=0", "--starts", "2", "--workers", "1")
KEYS = ("--parameters", "medium.eta_d,medium.plunging.eta_v")


@pytest.fixture(scope="module")
def data(tmp_path_factory) -> Path:
    return measure(tmp_path_factory.mktemp("data") / "strike.csv", RIGID)


@pytest.fixture(scope="module")
def folder(data: Path, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("results") / "out"
    assert main(["fit", str(CONFIG), str(data), *KEYS, *FAST, "--quiet", "--out", str(out)]) == 0
    return out


@pytest.mark.slow
def test_a_fit_writes_its_files_and_figures(folder: Path) -> None:
    assert {path.name for path in folder.iterdir()} == {"fit.json", "medium.yaml", "residuals.csv", "figures"}
    figures = {path.name: path.stat().st_size for path in (folder / "figures").iterdir()}
    assert set(figures) == {"run_01.png", "residuals.png", "correlation.png"}
    assert min(figures.values()) > 10_000
    saved = json.loads((folder / "fit.json").read_text(encoding="utf-8"))
    assert saved["status"] == "fits"
    eta = saved["parameters"]["medium.eta_d"]
    assert eta["interval_95"][0] < 6.5 < eta["interval_95"][1]
    assert np.array(saved["correlation"]["matrix"]).shape == (2, 2)


def test_residuals_are_data_less_model(folder: Path, data: Path) -> None:
    rows = list(csv.DictReader((folder / "residuals.csv").open(encoding="utf-8")))
    assert len(rows) == 100
    noise = json.loads((folder / "fit.json").read_text())["goodness"]["columns"]["tip_x_m"]["noise"]
    first = rows[0]
    assert (first["run"], first["column"], float(first["time_s"])) == ("strike", "tip_x_m", 0.0)
    shown = (float(first["data"]) - float(first["model"])) / noise
    assert float(first["residual_over_noise"]) == pytest.approx(shown, abs=1e-4)
    assert float(first["data"]) == float(data.read_text().splitlines()[1].split(",")[1])


def test_the_medium_is_ready_to_use_and_says_where_it_is_from(folder: Path, tmp_path: Path) -> None:
    medium = yaml.safe_load((folder / "medium.yaml").read_text(encoding="utf-8"))
    assert medium["provenance"] == "fitted"
    assert "strike.csv" in medium["source"]
    # The tip starts at 6.24 rad/s and 0.2635 m from the pivot, and comes to rest; the only bar that dips is the link.
    assert medium["range"]["speed_m_s"] == pytest.approx([0.0, 6.24 * 0.263525], abs=5e-3)
    assert medium["range"]["size_m"] == [0.00635, 0.00635]
    assert medium["range"]["depth_m"][0] == 0.0
    assert medium["range"]["depth_m"][1] == pytest.approx(0.0163, rel=0.02)
    text = CONFIG.read_text(encoding="utf-8").replace("play_sand", str(folder / "medium.yaml"))
    (tmp_path / "run.yaml").write_text(text, encoding="utf-8")
    scenario = config.load(tmp_path / "run.yaml").scenario
    assert scenario.medium is not None
    estimate = json.loads((folder / "fit.json").read_text())["parameters"]["medium.eta_d"]["value"]
    assert scenario.medium.eta_d == estimate
    build(scenario)


@pytest.mark.parametrize("config", [str(CONFIG), "pendulum"], ids=["file", "name of a shipped config"])
def test_fit_prints_parameters_errors_and_verdict(data: Path, tmp_path: Path, capsys, config: str) -> None:
    arguments = ["fit", config, str(data), *KEYS, *FAST, "--no-plots", "--out", str(tmp_path / "out")]
    assert main([*arguments, "--bounds", "medium.eta_d=3:12", "--noise", "tip_x_mm=0.1"]) == 0
    shown = capsys.readouterr().out
    assert "medium.plunging.eta_v" in shown
    assert "standard error" in shown
    assert "(given, 50 values)" in shown
    assert "(estimated, 50 values)" in shown
    assert "fits: the residuals look like noise" in shown
    assert not (tmp_path / "out" / "figures").exists()


@pytest.mark.parametrize(("value", "error"), [(1999.85, 0.1378), (-2e-3, 3e-6), (5.00073, 0.01462), (7.0, 9.0)])
def test_the_ends_of_an_interval_are_distinguished(value: float, error: float) -> None:
    """Each is shown to a tenth of the standard error or better."""
    for end in (value - 2.0 * error, value + 2.0 * error):
        assert abs(float(f"{end:.{digits(end, error)}g}") - end) <= 0.1 * error
    assert digits(value, float("nan")) == digits(0.0, error) == 4


def test_a_misfit_is_printed_even_when_quiet(tmp_path: Path, capsys) -> None:
    file = measure(tmp_path / "other.csv", RIGID, "gravity_m_s2=40")
    out = str(tmp_path / "out")
    options = ("--parameters", "medium.eta_d", *FAST, "--quiet", "--no-plots")
    assert main(["fit", str(CONFIG), str(file), *options, "--out", out]) == 0
    assert "warning: misfit: residuals" in capsys.readouterr().err
    assert "# misfit" in (tmp_path / "out" / "medium.yaml").read_text(encoding="utf-8")
    assert "does not describe" in yaml.safe_load((tmp_path / "out" / "medium.yaml").read_text())["source"]


@pytest.mark.slow
def test_several_runs_and_named_columns_on_the_command_line(tmp_path: Path) -> None:
    for i in range(2):
        measure(tmp_path / f"{i}.csv", RIGID, seed=i, factor=1e3, offset=0.005, head="t,X,Y")
    arguments = ["fit", str(CONFIG), str(tmp_path / "0.csv"), str(tmp_path / "1.csv"), *KEYS, *FAST, "--no-plots"]
    arguments += ["--columns", "time_s=t,tip_x_mm=X,tip_y_mm=Y", "--time-offset", "0.005", "--loss", "linear"]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 0
    saved = json.loads((tmp_path / "out" / "fit.json").read_text(encoding="utf-8"))
    assert [run["name"] for run in saved["runs"]] == ["0", "1"]
    assert saved["solver"]["loss"] == "linear"
    assert saved["goodness"]["columns"]["tip_x_m"]["rows"] == 100


REFUSED = {
    "no parameters": ([str(CONFIG), "DATA"], "--parameters: is missing"),
    "data first": (["DATA", str(CONFIG), *KEYS], "stands before any config"),
    "no data": ([str(CONFIG), *KEYS], "has no CSV file behind it"),
    "bounds of nothing": ([str(CONFIG), "DATA", *KEYS, "--bounds", "medium.eta_h=1:2"], "is none of the --parameters"),
    "bounds without colon": ([str(CONFIG), "DATA", *KEYS, "--bounds", "medium.eta_d=1"], "allowed is LOW:HIGH"),
    "bounds upside down": ([str(CONFIG), "DATA", *KEYS, "--bounds", "medium.eta_d=9:2"], "bounds from 9 to 2"),
    "column": ([str(CONFIG), "DATA", *KEYS, "--columns", "time_s=t,tip_x_m=tip_x_m"], "got 't', but"),
    "pair": ([str(CONFIG), "DATA", *KEYS, "--columns", "time_s"], "--columns time_s: is not NAME=VALUE"),
    "starts": ([str(CONFIG), "DATA", *KEYS, "--starts", "many"], "--starts: starts: got the text 'many'"),
    "noise twice": ([str(CONFIG), "DATA", *KEYS, "--noise", "tip_x_mm=1", "--noise", "tip_x_mm=2"],
                    "--noise: tip_x_mm: is given twice"),
    "bounds twice": ([str(CONFIG), "DATA", *KEYS, "--bounds", "medium.eta_d=1:40", "--bounds", "medium.eta_d=6:7"],
                     "--bounds: medium.eta_d: is given twice"),
    "no such file": (["nowhere.yaml"], "nowhere.yaml: no such file"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refusals(data: Path, tmp_path: Path, capsys, name: str) -> None:
    arguments, message = REFUSED[name]
    out = tmp_path / "out"
    code = main(["fit", *(str(data) if a == "DATA" else a for a in arguments), "--out", str(out)])
    assert code == 2
    assert message in capsys.readouterr().err
    assert not out.exists()


def test_options_that_a_fit_file_says_itself_are_refused(tmp_path: Path, data: Path, capsys) -> None:
    (tmp_path / "fit.yaml").write_text(f"parameters: [medium.eta_d]\nruns: [{{config: {CONFIG}, data: {data}}}]\n")
    assert main(["fit", str(tmp_path / "fit.yaml"), *KEYS, "--starts", "3"]) == 2
    assert [line.split(":")[0] for line in capsys.readouterr().err.splitlines()] == ["--parameters", "--starts"]


def test_a_folder_of_something_else_is_left_alone(data: Path, tmp_path: Path, capsys) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["fit", str(CONFIG), str(data), *KEYS, *FAST, "--out", str(tmp_path)]) == 2
    assert "mine.txt" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_check_reads_fit_files_with_their_data(tmp_path: Path, data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good, bad = tmp_path / "good.yaml", tmp_path / "bad.yaml"
    run = f"runs: [{{config: {CONFIG}, data: {data}}}]\nset: {{method.reduced.modes: 0}}\n"
    good.write_text(run + "parameters: [medium.eta_d]\n")
    bad.write_text(run + "parameters: [medium.eta_q]\nloss: cubic\n")
    before = set(tmp_path.iterdir())
    assert main(["check", str(good), str(bad)]) == 2
    out, err = capsys.readouterr()
    assert out == f"{good}: ok\n"
    assert "loss" in err
    assert set(tmp_path.iterdir()) == before
