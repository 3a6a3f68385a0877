"""The comparison of models: a verdict in line with its numbers, and refusals."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from support_refusals import faults_of
from support_runs import ROOT

from granular_contact.cli import main
from granular_contact.errors import ConfigError, SceneError
from granular_contact.report.figures.over_time import draw_runs
from granular_contact.results import Results
from granular_contact.studies.compare import Comparison, compare, write

CONFIG = ROOT / "configs" / "pendulum.yaml"
TO_STOP = ["solver.end_time_s=0.03", "solver.rest_time_s=null"]


@pytest.fixture(scope="module")
def comparison() -> Comparison:
    return compare(CONFIG, (0, 1), (2, 8), overrides=TO_STOP, repeats=1)


def test_one_mode_is_within_a_percent_of_the_beam_in_travel(comparison: Comparison) -> None:
    rigid, one_mode, coarse, finest = comparison.rows
    assert [row.name for row in comparison.rows] == ["rigid", "1 mode", "FE, 2 elements", "FE, 8 elements"]
    assert abs(one_mode.differences["travel_relative"]) < 0.01
    # The link bends by 0.19 mm of 264 mm, 0.04 deg of 4.25 deg travel: rigid is off by less than that, one mode by less
    # than half of what rigid is.
    assert 2 * abs(one_mode.differences["travel_relative"]) < abs(rigid.differences["travel_relative"]) < 0.01
    assert rigid.differences["deflection_relative"] is None
    # One clamped-free mode on a hinged root: its frequency is a tenth off, and so is the peak.
    assert 0.02 < abs(one_mode.differences["deflection_relative"]) < 0.3
    assert abs(coarse.differences["deflection_relative"]) < 0.01
    assert set(finest.differences.values()) == {0.0}


def test_relative_numbers_follow_from_the_summaries(comparison: Comparison) -> None:
    row, reference = comparison.rows[1], comparison.rows[-1].results.summary
    mine = row.results.summary
    assert row.differences["stopping_time_relative"] == pytest.approx(
        mine["stopping_time_s"] / reference["stopping_time_s"] - 1, rel=1e-12
    )
    travel = (mine["angle_at_stop_deg"] - 31.0) / (reference["angle_at_stop_deg"] - 31.0) - 1
    assert row.differences["travel_relative"] == pytest.approx(travel, rel=1e-9)


def test_verdict_names_the_cheapest_within_the_tolerance(comparison: Comparison) -> None:
    cheapest = min(comparison.rows[:-1], key=lambda row: row.seconds)
    assert cheapest.motion_error <= 0.01
    assert comparison.verdict.startswith(f"Cheapest within 1 % in stopping time and travel: {cheapest.name}, ")
    assert "for the peak deflection: FE, 2 elements." in comparison.verdict
    strict = Comparison(comparison.rows, 1e-9)
    assert strict.verdict.startswith("No model is within 1e-07 % of FE, 8 elements")


@pytest.mark.slow
def test_table_holds_the_rows(comparison: Comparison, tmp_path: Path) -> None:
    write(comparison, tmp_path / "out", figures=False)
    with (tmp_path / "out" / "compare.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["model"] for row in rows] == [row.name for row in comparison.rows]
    assert float(rows[1]["travel_relative"]) == comparison.rows[1].differences["travel_relative"]
    assert rows[0]["max_deflection_m"] == ""
    assert not (tmp_path / "out" / "figures").exists()


def test_figures_are_those_of_a_run_with_a_curve_for_each_model(
    comparison: Comparison, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: dict[str, dict[str, int]] = {}

    def noted(figure: Figure, file: Path) -> None:
        panels = {axes.get_ylabel().replace("\n", " "): axes.get_lines() for axes in figure.axes}
        drawn[file.stem.lstrip(".")] = {
            title: sum(len(line.get_ydata()) > 2 for line in lines) for title, lines in panels.items()
        }
        file.touch()

    monkeypatch.setattr("granular_contact.report.figures.over_time.save", noted)
    runs = [(row.name, row.results) for row in comparison.rows]
    draw_runs(runs, tmp_path, comparison.rows[-1].name)
    bending = len([results for _, results in runs if "deflection_m" in results.names])
    angles, deflections = drawn["joints"], drawn["deflection"]
    assert next(iter(angles.values())) == len(runs)
    assert next(iter(deflections.values())) == bending
    away = [count for title, count in (angles | deflections).items() if "less" in title]
    assert away[0] == len(runs) - 1
    assert away[-1] == bending - 1


@pytest.fixture(scope="module")
def in_space() -> Comparison:
    return compare(ROOT / "configs" / "whip.yaml", (0, 1), (4, 8), overrides=["solver.end_time_s=0.5"], repeats=1)


def test_models_in_space_are_compared_by_the_places_of_their_tips(in_space: Comparison) -> None:
    rigid, one_mode, coarse, finest = in_space.rows
    assert [row.name for row in in_space.rows] == ["rigid", "1 mode", "4 elements", "8 elements"]
    assert set(finest.differences.values()) == {0.0}
    assert max(one_mode.motion_error, coarse.motion_error) < 0.1 * rigid.motion_error
    assert rigid.differences["deflection_relative"] == pytest.approx(-1.0)
    # A cantilever of n elements bends by 1/4n^2 too little: one of 4 elements by 1.2 % less than one of 8.
    assert coarse.differences["deflection_relative"] == pytest.approx(-0.012, rel=0.5)
    assert in_space.verdict.startswith("No model is within 1 % of 8 elements in the motion; ") or (
        in_space.verdict.startswith("Cheapest within 1 % in the motion: ")
    )


def test_motion_error_in_space_is_distance_over_the_longest_path(in_space: Comparison) -> None:
    row, reference = in_space.rows[0], in_space.rows[-1].results

    def places(run: Results, point: str) -> np.ndarray:
        return np.array([np.interp(reference["time_s"], run["time_s"], run[f"{point}_{axis}_m"]) for axis in "xyz"])

    apart = np.linalg.norm(places(row.results, "tip") - places(reference, "tip"), axis=0).max()
    paths = [np.linalg.norm(np.diff(places(reference, name)), axis=0).sum() for name in ("arm", "whip", "tip")]
    assert row.differences["motion_m"] == pytest.approx(apart, rel=1e-3)
    assert row.differences["motion_relative"] == pytest.approx(apart / max(paths), rel=1e-2)


@pytest.mark.parametrize(
    ("modes", "elements", "message"),
    [
        ((21,), (4,), "--modes: got 21; allowed are whole numbers from 0 to 20"),
        ((-1,), (4,), "--modes: got -1; allowed are whole numbers from 0 to 20"),
        ((1,), (0,), "--elements: got 0; allowed are whole numbers from 1 to 1024"),
        ((1,), (), "--elements: got none; the reference needs at least one number"),
    ],
)
def test_counts_out_of_range_are_refused(modes, elements, message) -> None:
    assert [str(fault) for fault in faults_of(ConfigError, compare, CONFIG, modes, elements)] == [message]


def test_a_rigid_mechanism_has_nothing_to_compare() -> None:
    with pytest.raises(ConfigError, match="no link is flexible"):
        compare(ROOT / "configs" / "pendulum_rigid.yaml")


CHAIN = """
model:
  from: compound_pendulum
  bodies:
    second: {type: link, length_m: 0.1, diameter_m: 0.006, density_kg_m3: 7700}
  joints:
    knee: {type: hinge, parent: link, child: second, parent_point_m: [0.23876, 0]}
medium: play_sand
initial: {impact_angle_deg: 31, impact_speed_rad_s: 1}
"""


def test_a_chain_has_no_modal_reduction(tmp_path: Path, capsys) -> None:
    (tmp_path / "chain.yaml").write_text(CHAIN, encoding="utf-8")
    with pytest.raises(SceneError):
        compare(tmp_path / "chain.yaml")
    assert main(["compare", str(tmp_path / "chain.yaml"), "--out", str(tmp_path / "out")]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 1
    assert "method" in errors[0]
    assert not (tmp_path / "out").exists()


def test_elements_alone_are_compared_where_a_link_has_no_modes(tmp_path: Path, capsys) -> None:
    """A rod between two hinges, which the help names as a case for no modes."""
    rod = "length_m: 0.1, diameter_m: 0.006, density_kg_m3: 1400"
    text = f"""
model:
  in_space: true
  name: flail
  bodies:
    arm: {{type: link, {rod}, flexible: {{youngs_modulus_Pa: 2.0e9}}}}
    head: {{type: link, {rod}}}
  joints:
    hub: {{type: hinge, parent: ground, child: arm, axis: [0, 1, 0]}}
    knee: {{type: hinge, parent: arm, child: head, axis: [0, 1, 0], parent_point_m: [0.1, 0, 0]}}
medium: play_sand
bed: {{height_m: -0.5}}
solver: {{end_time_s: 0.02, accuracy: 1.0e-2}}
"""
    (tmp_path / "flail.yaml").write_text(text, encoding="utf-8")
    arguments = ["compare", str(tmp_path / "flail.yaml"), "--elements", "2,4", "--no-plots"]
    arguments += ["--out", str(tmp_path / "out")]
    assert main(arguments) == 2
    assert "arm carries head" in capsys.readouterr().err
    assert main([*arguments, "--modes", ""]) == 0
    shown = capsys.readouterr().out
    assert "2 elements" in shown
    assert "1 mode" not in shown
    with pytest.raises(SystemExit):
        main(["compare", "--help"])
    assert "'' for none" in " ".join(capsys.readouterr().out.split())
