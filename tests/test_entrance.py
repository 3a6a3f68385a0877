"""The first commands of a user: the bare command, its version, a new config, kernels compiled ahead."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest
import yaml
from support_runs import ROOT

from granular_contact import __version__, starter
from granular_contact.cli import main, schema
from granular_contact.cli.schema import SCHEMAS
from granular_contact.config import json_schema, load, medium_names
from granular_contact.results import Results


def test_the_bare_command_lists_the_commands(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    printed = capsys.readouterr().out
    assert all(f"\n    {name} " in printed for name in ("new", "run", "check", "schema", "warm"))


def test_unknown_options_are_refused_with_the_usage_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    commands = (("schema model", "--of {run,model"), ("check a.yaml --strict", "--mend OUT"), ("--nope", "COMMAND"))
    for given, usage in commands:
        with pytest.raises(SystemExit):
            main(given.split())
        errors = capsys.readouterr().err
        assert usage in errors
        assert f"unrecognized arguments: {given.split()[-1]}" in errors


def test_the_version_names_the_engine_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert re.match(rf"granular-contact {re.escape(__version__)}, exudyn \d+\.\d+", capsys.readouterr().out)


NAMES = starter.names()  # which reads all configs


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_new_writes_a_config_of_the_shipped_model(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It stands alone, and does not overwrite; it is the shipped config with its model."""
    monkeypatch.setattr(starter, "names", lambda: NAMES)
    path = tmp_path / "mine.yaml"
    assert main(["new", name, "--out", str(path)]) == 0
    made, shipped = load(path).scenario, load(NAMES[name]).scenario
    assert made.model == shipped.model
    assert made.model_copy(update={"name": None}) == shipped.model_copy(update={"name": None})
    before = path.read_text(encoding="utf-8")
    assert main(["new", name, "--out", str(path)]) == 2
    assert "is there already" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == before


def test_commands_for_a_file_name_with_a_blank_can_be_copied(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A shell leaves ~ as it is in --out=~/wheel.yaml: a folder of the name ~ was made in the working folder."""
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(starter, "names", lambda: NAMES)
    assert main(["new", "free_link", "--out=~/my rod.yaml"]) == 0
    path = tmp_path / "my rod.yaml"
    commands = [line for line in capsys.readouterr().out.splitlines() if line.startswith("  ")]
    assert [shlex.split(line)[2] for line in commands] == [str(path)] * 2
    named = [line[1:] for line in path.read_text(encoding="utf-8").splitlines() if line.startswith("#   ")]
    assert [shlex.split(line)[2] for line in named] == ["my rod.yaml"] * 2
    monkeypatch.chdir(tmp_path)
    assert main(["run", "my rod.yaml", "--out=~/of the rod", "--set", "solver.end_time_s=0.01", "--no-plots"]) == 0
    assert Results.open(tmp_path / "of the rod").save("~/again", figures=False) == tmp_path / "again"
    assert not (tmp_path / "~").exists()


def test_every_key_that_new_offers_can_be_used(tmp_path: Path) -> None:
    """Without their sign of a comment, the offered lines are keys of the run."""
    text = starter.text("free_link", "mine.yaml")
    for key, line, _ in starter.OTHER_KEYS:
        if re.search(rf"^{key}:", text, re.M) is None:
            assert f"# {line}  #" in text
            text = text.replace(f"# {line}  #", f"{line}  #")
    path = tmp_path / "mine.yaml"
    path.write_text(text, encoding="utf-8")
    assert load(path).scenario.gravity_m_s2 == 1.62
    assert {word for _, line, _ in starter.OTHER_KEYS for word in re.findall(r"medium: (\w+)", line)} <= set(
        medium_names()
    )


def test_an_unknown_model_is_refused_with_the_list_of_models(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "runer"]) == 2
    assert "did you mean runner?" in capsys.readouterr().err
    assert main(["new"]) == 0
    assert "stepping_leg " in capsys.readouterr().out


SHIPPED = sorted(
    path for folder in ("configs", "models", "granular_contact/laws/presets") for path in (ROOT / folder).glob("*.yaml")
)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_a_shipped_file_leads_editors_to_the_schema_of_its_kind(path: Path) -> None:
    first, _, text = path.read_text(encoding="utf-8").partition("\n")
    assert first.startswith("# yaml-language-server: $schema="), "the line for editors is missing"
    schema = (path.parent / first.partition("=")[2]).resolve()
    assert schema.parent == ROOT / "schemas"
    keys = set(yaml.safe_load(text))
    kinds = {"models": "model", "presets": "medium"}
    ways = (("fit", "runs"), ("optimise", "objective"), ("run", "model"), ("sweep", "config"))
    assert schema.stem == kinds.get(path.parent.name, next((kind for kind, key in ways if key in keys), None))


@pytest.mark.slow
def test_the_schemas_that_lines_for_editors_name_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By `schema --write`; by `examples` beside models and configs: there the line of each leads to a file."""
    monkeypatch.setattr(schema, "files", cache(schema.files))
    assert main(["schema", "--write", str(tmp_path / "schemas")]) == 0
    assert main(["examples", str(tmp_path / "out")]) == 0
    assert json.loads((tmp_path / "schemas" / "run.json").read_text(encoding="utf-8")) == json_schema("run")
    for kind in SCHEMAS:
        text = (tmp_path / "schemas" / f"{kind}.json").read_text(encoding="utf-8")
        assert (tmp_path / "out" / "schemas" / f"{kind}.json").read_text(encoding="utf-8") == text
    files = [path for folder in ("configs", "models") for path in (tmp_path / "out" / folder).glob("*.yaml")]
    assert len(files) > 40
    for path in files:
        with path.open(encoding="utf-8") as file:
            assert (path.parent / file.readline().strip().partition("$schema=")[2]).is_file(), path


def test_paths_of_set_start_at_the_working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those in a config start from its folder."""
    configs, working_folder = tmp_path / "configs", tmp_path / "here"
    for folder, density in ((configs, 1000), (working_folder, 2000)):
        folder.mkdir()
        medium = f"{{law: albert, density_kg_m3: {density}, eta_h: 8}}"
        (folder / "sand.yaml").write_text(medium, encoding="utf-8")
    (working_folder / "turn.csv").write_text("time_s,angle\n0,1\n1,2\n", encoding="utf-8")
    (configs / "run.yaml").write_text("model: compound_pendulum\nmedium: sand.yaml\n", encoding="utf-8")
    monkeypatch.chdir(working_folder)
    assert load("../configs/run.yaml").scenario.media[0].density_kg_m3 == 1000
    for changed in (
        load("../configs/run.yaml", ["medium=sand.yaml"]),
        load("../configs/run.yaml", medium="sand.yaml"),
        load("../configs/run.yaml", ["medium={from: sand.yaml}"]),
    ):
        assert changed.scenario.media[0].density_kg_m3 == 2000
    drive = "drives.pivot={type: motion, angle_deg: {type: csv, file: turn.csv, column: angle}}"
    assert load("../configs/run.yaml", [drive]).scenario.drives["pivot"].angle_deg.values == (1, 2)


def test_kernels_are_compiled_ahead(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["warm", "pendulum_rigid"]) == 0
    printed = capsys.readouterr()
    assert printed.out.startswith("1 kinds of runs are ready: ")
    assert "pendulum_rigid (the law lee_marghitu for round bars, minimal)" in printed.err


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no terminals of this kind here")
@pytest.mark.parametrize("columns", [44, 130])
def test_printed_lines_fit_the_terminal(columns: int) -> None:
    """On a real terminal: lines end between words, and a table that is too wide becomes a list."""
    code = """from granular_contact.cli.common import print_table, say
say("  stopping time   25.46 ms, from touch to the first zero of the mean rate, about the pivot of the link")
heads = ["impact_speed_rad_s", "stop ms", "angle deg", "imbalance"]
print_table("case", heads, [["case_1", "2", "39.28", "34.27", "4e-6"]])
"""
    ours, theirs = os.openpty()
    size = {"COLUMNS": str(columns), "LINES": "40", "TERM": "xterm"}
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, env=os.environ | size, stdout=theirs, check=False)
    os.close(theirs)
    lines = re.sub(r"\x1b\[[\d;]*m", "", os.read(ours, 10_000).decode()).split("\r\n")
    os.close(ours)
    assert done.returncode == 0
    assert max(len(line.rstrip()) for line in lines) <= columns
    text = " ".join(" ".join(lines).split())
    assert "25.46 ms, from touch to the first zero of the mean rate, about the pivot of the link" in text
    listed = "impact_speed_rad_s 2 stop ms 39.28 angle deg 34.27 imbalance 4e-6"
    assert (listed in text) == (columns == 44)
    assert ("case_1 2 39.28 34.27 4e-6" in text) == (columns == 130)


OF_WORKERS = """
import os
from granular_contact.studies.processes import local_processes
if __name__ == "__main__":
    with local_processes(1) as pool:
        told = pool.submit(os.getenv, "EXUDYN_NO_USER_SETTINGS").result()
    print(told, os.getenv("EXUDYN_NO_USER_SETTINGS"))
"""


@pytest.mark.slow
def test_engine_settings_in_the_home_folder_print_nothing(tmp_path: Path) -> None:
    """Not in what a command prints, nor by workers; a program of the user's that imports the engine keeps them."""
    (tmp_path / ".exudyn").mkdir()
    stored = {"version": 1, "config": {"printDelayMilliSeconds": 0}}
    (tmp_path / ".exudyn" / "config.json").write_text(json.dumps(stored), encoding="utf-8")
    given = {name: value for name, value in os.environ.items() if not name.startswith("EXUDYN_")}
    given |= {"HOME": str(tmp_path), "USERPROFILE": str(tmp_path), "PYTHONPATH": str(ROOT)}

    def printed(*words: str, **more: str) -> str:
        command, environment = [sys.executable, *words], given | more
        return subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout

    if ".exudyn" not in printed("-c", "import exudyn"):
        pytest.skip("this Exudyn reads no such file")
    assert ".exudyn" in printed("-c", "import granular_contact, exudyn")
    config = str(ROOT / "configs" / "pendulum_rigid.yaml")
    run = "-m", "granular_contact", "run", config, "--method", "engine", "--out", str(tmp_path / "out"), "--no-plots"
    assert ".exudyn" not in printed(*run)
    (tmp_path / "sweep.py").write_text(OF_WORKERS, encoding="utf-8")
    assert printed(str(tmp_path / "sweep.py")) == "1 None\n"
