"""Messages about files that are no configs: short, without quoting the file, with the right place of keys and paths."""

from __future__ import annotations

from pathlib import Path

import pytest
from support_refusals import faults_of
from support_runs import CONFIGS, scenario_of

from granular_contact import cli
from granular_contact.config import load, load_sweep
from granular_contact.errors import ConfigError
from granular_contact.scene import build

SECRETS = {
    "text": "root:x:0:0:hunter2",
    "lines": "hunter2\nhunter2\n",
    "list": "- hunter2\n- hunter2\n",
    "number": "123456789",
    "mapping": "user: hunter2\nhunter2: joe\n",
    "key": "-----BEGIN KEY-----\nhunter2\n-----END KEY-----\n",
}
SWEEP = f"config: {CONFIGS / 'pendulum_rigid.yaml'}\n"


@pytest.mark.parametrize("command", ["check", "run", "sweep", "fit"])
@pytest.mark.parametrize("kind", SECRETS)
def test_a_file_that_is_no_config_is_not_quoted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str, command: str
) -> None:
    path = tmp_path / "secret.yaml"
    path.write_text(SECRETS[kind])
    (tmp_path / "data.csv").write_text("time_s,tip_x_m\n" + "".join(f"{i},0\n" for i in range(9)))
    more = [str(tmp_path / "data.csv"), "--parameters", "medium.eta_d"] if command == "fit" else []
    assert cli.main([command, str(path), *more]) == 2
    errors = capsys.readouterr().err
    assert "secret.yaml" in errors
    assert "hunter2" not in errors
    assert "123456789" not in errors
    assert errors.count("\n") == 1


def faults(path: Path, text: str) -> list[str]:
    path.write_text(text)
    return [str(fault) for fault in faults_of(ConfigError, load_sweep, path)]


def test_a_grid_of_a_great_many_dimensions_is_reported_in_short(tmp_path: Path) -> None:
    values = "".join(f"  medium.eta_d.k{i}: [{', '.join(['1'] * 100)}]\n" for i in range(120))
    (line,) = faults(tmp_path / "grid.yaml", f"{SWEEP}vary:\n{values}")
    assert len(line) < 300
    assert "at most 100000 are allowed" in line
    assert "and 114 more" in line


def test_unequal_columns_of_a_zip_are_reported_in_short(tmp_path: Path) -> None:
    values = "".join(f"  medium.eta_d.k{i}: [{', '.join(['1'] * (i + 1))}]\n" for i in range(100))
    (line,) = faults(tmp_path / "zip.yaml", f"{SWEEP}combine: zip\nvary:\n{values}")
    assert "and 94 more" in line
    assert len(line) < 400


def test_a_misplaced_combine_is_reported_with_its_place(tmp_path: Path) -> None:
    (line,) = faults(tmp_path / "sweep.yaml", f"{SWEEP}vary:\n  medium.eta_d: [4, 5]\n  combine: zip\n")
    assert line.endswith(
        "sweep.yaml:4: vary.combine: stands in vary, whose keys are those of a config; it belongs beside vary, at the "
        "same indentation"
    )


def test_where_the_path_of_a_medium_starts_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    (fault,) = faults_of(ConfigError, load, CONFIGS / "pendulum.yaml", ["medium=sand/mine.yaml"])
    assert "no file sand/mine.yaml; paths start from the working folder" in fault.message
    with pytest.raises(SystemExit):
        cli.main(["run", "--help"])
    assert "start from the working folder" in " ".join(capsys.readouterr().out.split())


def test_help_of_fit_states_window_and_sign_of_the_clock(capsys: pytest.CaptureFixture[str]) -> None:
    from granular_contact.config.schema.fit import OFFSET_RANGE

    with pytest.raises(SystemExit):
        cli.main(["fit", "--help"])
    printed = " ".join(capsys.readouterr().out.split())
    assert "at which the runs start, by the clock of the data" in printed
    assert f"from {OFFSET_RANGE[0]:g} to {OFFSET_RANGE[1]:g} s" in printed


FREE = """
model:
  name: rod
  bodies: {rod: {type: link, length_m: 0.2, diameter_m: 0.01, density_kg_m3: 2700}}
  joints: {free: {type: free, parent: ground, child: rod}}
"""


def test_no_model_needs_a_start() -> None:
    assert scenario_of(FREE) == scenario_of(f"{FREE}initial: {{joints: {{}}}}").model_copy(
        update={"initial": scenario_of(FREE).initial}
    )
    hinged = FREE.replace("type: free", "type: hinge")
    assert build(scenario_of(hinged)).bodies  # it begins at home, at rest
    driven = f"{hinged}drives: {{free: {{type: motion, angle_deg: 20}}}}\n"
    assert scenario_of(driven).initial.impact_angle_deg is None


def test_a_start_that_is_too_fast_is_refused_with_what_is_allowed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["run", str(CONFIGS / "pendulum_rigid.yaml"), "--set", "initial.impact_speed_rad_s=1e9"]) == 2
    errors = capsys.readouterr().err
    assert "initial: RB1+RB2+link starts with 1e+09 rad/s: allowed is less than 1e+08" in errors
