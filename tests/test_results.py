"""Results as users handle them: by name, as a frame, plotted, saved and opened; and `load` from Python."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from support_refusals import faults_of, message_of
from support_runs import CONFIGS, ROOT

import granular_contact
from granular_contact import Simulation, load, simulate
from granular_contact.cli import main
from granular_contact.config import scenario_to_dict
from granular_contact.config.schema.scenario import Load, Output, Scenario, Solver
from granular_contact.errors import ConfigError, MissingPackageError, ResultsError, SceneError
from granular_contact.results import Results


@cache
def swung() -> Results:
    return simulate(load("pendulum", method={"reduced": {"modes": 1}}, solver={"end_time_s": 0.02}))


@cache
def saved() -> dict[str, bytes]:
    import tempfile

    with tempfile.TemporaryDirectory() as place:
        folder = swung().save(Path(place) / "run", figures=False)
        return {path.name: path.read_bytes() for path in folder.iterdir()}


def folder_of(place: Path, **other: bytes | None) -> Path:
    place.mkdir()
    for name, content in saved().items():
        content = other.get(name.partition(".")[0], content)
        if content is not None:
            (place / name).write_bytes(content)
    return place


# ---- results ----


def test_the_motion_is_a_film_that_a_notebook_shows(tmp_path: Path) -> None:
    film = replace(swung(), frames=swung().frames[:3]).animation(tmp_path / "swing.gif")
    assert Path(film).read_bytes().startswith(b"GIF89a")
    assert film._repr_html_().startswith('<img alt="swing.gif" src="data:image/gif;base64,R0lGODlh')
    with pytest.raises(ResultsError, match=r"got the ending '\.png'; allowed are \.gif and \.mp4"):
        swung().animation(tmp_path / "swing.png")
    blind = simulate(load("pendulum", solver={"end_time_s": 1e-3}), most_frames=0)
    with pytest.raises(ResultsError, match="made with most_frames=0"):
        blind.animation(tmp_path / "none.gif")


def test_saved_results_are_opened_again(tmp_path: Path) -> None:
    results = swung()
    reopened = Results.open(results.save(tmp_path / "run", figures=False))
    np.testing.assert_array_equal(reopened.table, results.table)
    assert (reopened.columns, reopened.warnings, reopened.status) == (results.columns, results.warnings, results.status)
    assert reopened.summary == json.loads(json.dumps(results.summary))
    assert reopened.scenario == results.scenario
    assert (reopened.surface, reopened.layers, reopened.floor) == (results.surface, results.layers, results.floor)
    assert reopened.terms == results.terms != ()
    for read, saved in zip(reopened.frames, results.frames, strict=True):  # to 7 digits of the largest
        for a, b in zip(read.outlines, saved.outlines, strict=True):
            np.testing.assert_allclose(a.points, b.points, atol=1e-7)
        force_read, force_saved = (sum((force.force for force in shot.forces), np.zeros(2)) for shot in (read, saved))
        np.testing.assert_allclose(force_read, force_saved, rtol=1e-6, atol=1e-5)
    assert len(reopened.frames) > 20
    reopened.save(tmp_path / "again", figures=False)
    for name in ("summary.json", "timeseries.csv", "scenario.yaml"):
        assert (tmp_path / "again" / name).read_bytes() == (tmp_path / "run" / name).read_bytes()


def test_the_command_line_writes_what_save_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    options = ["--set", "method={reduced: {modes: 1}}", "--set", "solver.end_time_s=0.02", "--no-plots", "--quiet"]
    monkeypatch.chdir(tmp_path)  # where there is no config of this name
    assert main(["run", "pendulum", *options, "--out", str(tmp_path / "run")]) == 0
    assert {path.name for path in (tmp_path / "run").iterdir()} == set(saved())
    np.testing.assert_array_equal(Results.open(tmp_path / "run").table, swung().table)


def damaged() -> dict[str, tuple[dict[str, bytes | None], str]]:
    summary, table = saved()["summary.json"], saved()["timeseries.csv"]
    odd = json.dumps({**json.loads(summary), "status": "fine"}).encode()
    return {
        "no table": ({"timeseries": None}, "has no timeseries.csv: it is not the complete folder of a run"),
        "a table cut short": ({"timeseries": table[:-40]}, "timeseries.csv: can't be read as a table: "),
        "a table of words": ({"timeseries": table + b"well, x\n"}, "timeseries.csv: can't be read as a table: "),
        "another table": ({"timeseries": b"time_s,x_m\n0,1\n"}, "has other columns than those listed in summary.json"),
        "no summary": ({"summary": None}, "has no summary.json: it is not the complete folder of a run"),
        "no JSON": ({"summary": summary[:100]}, "summary.json: is not JSON"),
        "no columns": ({"summary": b'{"status": "rest"}'}, "has no columns"),
        "no such status": ({"summary": odd}, "got the status 'fine'"),
        "no scenario": ({"scenario": None}, "has no scenario.yaml"),
        "a broken scenario": ({"scenario": b"model: pendulam\n"}, "scenario.yaml:1: model: got 'pendulam'"),
    }


def test_damaged_folders_are_reported_in_one_line(tmp_path: Path) -> None:
    for damage, (other, message) in damaged().items():
        with pytest.raises(ResultsError) as caught:
            Results.open(folder_of(tmp_path / damage, **other))
        assert message in str(caught.value), damage
        assert "\n" not in str(caught.value)


def test_folders_without_a_run_are_reported(tmp_path: Path) -> None:
    for place in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(ResultsError):
            Results.open(place)
    (tmp_path / "table.csv").write_text("case\n", encoding="utf-8")
    with pytest.raises(ResultsError, match="contains results of a sweep; the folder of a single run is needed"):
        Results.open(tmp_path)


def test_columns_by_name() -> None:
    results = swung()
    assert results["pivot_angle_deg"].shape == results["time_s"].shape
    assert "pivot_angle_deg" in results._ipython_key_completions_()
    with pytest.raises(KeyError, match="did you mean pivot_angle_"):
        results["pivot_angle"]
    with pytest.raises(KeyError, match="there are: time_s"):
        results["q"]


def test_a_column_of_a_welded_body_is_that_of_the_body_it_is_welded_to() -> None:
    """Through two welds, and none to the ground; a name that is wrong for another reason has no word of welds."""
    arm = {"type": "link", "length_m": 0.1, "diameter_m": 0.01, "density_kg_m3": 2700}
    joints = {"pivot": {"type": "hinge", "parent": "ground", "child": "arm"}}
    for parent, child in (("arm", "finger"), ("finger", "nail")):
        joints[f"at_{child}"] = {"type": "weld", "parent": parent, "child": child, "parent_point_m": [0.1, 0]}
    model = {"name": "hand", "bodies": dict.fromkeys(("arm", "finger", "nail"), arm), "joints": joints}
    results = simulate({"model": model, "medium": None, "solver": {"end_time_s": 0.002}, "output": {"bodies": "all"}})
    for body in ("finger", "nail"):
        with pytest.raises(KeyError, match=f"{body} is welded to arm: .* whose names begin with arm_"):
            results[f"{body}_x_m"]
    simulation = Simulation({"model": model, "medium": None})
    with pytest.raises(KeyError, match=r"no observation 'nail_x_m'; nail is welded to arm: .* names begin with arm_"):
        simulation.step(None, 1e-3)["nail_x_m"]
    with pytest.raises(KeyError) as caught:
        results["arm_q_m"]
    assert "welded" not in str(caught.value)


def test_plots_have_a_panel_for_each_unit_and_show_in_notebooks() -> None:
    results = swung()
    figure = results.plot("tip_x_m", "pivot_rate_rad_s", "tip_y_m")
    lengths, rate = figure.axes
    assert [line.get_label() for line in lengths.get_lines()[:2]] == ["tip_x", "tip_y"]
    # 0.2 m and less: the axis is in millimetres.
    drawn = lengths.get_lines()[1].get_ydata()
    assert lengths.get_ylabel() == "mm"
    assert np.max(np.abs(drawn)) == pytest.approx(1e3 * np.max(np.abs(results["tip_y_m"])), rel=1e-9)
    assert rate.get_ylabel() == "pivot rate (rad/s)"
    assert figure._repr_png_().startswith(b"\x89PNG")  # type: ignore[attr-defined]
    with pytest.raises(KeyError, match="tip_y_m"):
        results.plot("tip_y")
    with pytest.raises(ValueError, match="needs the name of a column"):
        results.plot()


def test_frames_need_pandas_and_nothing_else_loads_it(monkeypatch) -> None:
    assert "pandas" not in sys.modules
    monkeypatch.setitem(sys.modules, "pandas", None)
    assert message_of(MissingPackageError, swung().to_dataframe) == "to_dataframe() needs pandas: pip install pandas"
    made: dict[str, object] = {}

    def frame(table, columns) -> SimpleNamespace:
        made.update(table=table, columns=columns)
        return SimpleNamespace()

    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=frame))
    assert swung().to_dataframe().attrs["time_s"] == "time since the start"
    np.testing.assert_array_equal(made["table"], swung().table)
    assert made["columns"] == swung().names


def test_reprs_are_short_and_escaped() -> None:
    results, loaded = swung(), load("runner")
    for thing in (results, loaded, loaded.scenario, granular_contact.build(loaded)):
        assert len(repr(thing)) < 160, repr(thing)
    assert "pendulum" in repr(results)
    page = results._repr_html_()
    assert "pivot_angle_deg" in page
    assert "<b>pendulum</b>" in page
    assert "<script>" not in load("runner", name="<script>").scenario._repr_html_()


# ---- load ----


def test_files_names_and_mappings_are_the_same() -> None:
    known = load(CONFIGS / "pendulum.yaml").scenario
    assert load("pendulum").scenario == load("pendulum.yaml").scenario == known
    held = {"name": "pendulum", "model": "compound_pendulum", "medium": "play_sand"}
    held |= {"initial": {"impact_angle_deg": 31, "impact_speed_rad_s": np.float64(6.24)}}
    assert load(held).scenario == known


@pytest.mark.parametrize(
    "function",
    [
        granular_contact.build,
        granular_contact.simulate,
        Simulation,
        lambda given: granular_contact.sweep(given, {"medium.eta_d": [4.0]}),
        granular_contact.ensemble,
        lambda given: granular_contact.optimise(given, {"medium.eta_d": [4, 6]}, minimise="max_depth_m"),
    ],
)
def test_functions_that_run_a_config_refuse_as_load_does(function) -> None:
    """Each loads what it is given: a name that is none, and a mapping with a fault, are refused as `load` does."""
    for given in ("pendulun", {"model": "no_such"}):
        with pytest.raises(ConfigError, match=re.escape(message_of(ConfigError, load, given))):
            function(given)
    assert granular_contact.build("pendulum_rigid").name == "pendulum_rigid"


def test_changes_as_texts_mappings_and_keywords_are_the_same() -> None:
    by_text = load("runner", ["solver.accuracy=1e-3", "medium=poppy_seeds_loose", "medium.zeta=0.5"])
    dotted = {"solver.accuracy": 1e-3, "medium": "poppy_seeds_loose", "medium.zeta": 0.5}
    ways = [
        load("runner", dotted),
        load("runner", {"solver": {"accuracy": 1e-3}}, medium={"from": "poppy_seeds_loose", "zeta": 0.5}),
        load("runner").replace(dotted),
        load("runner").replace(solver={"accuracy": 1e-3}, medium="poppy_seeds_loose").replace(medium={"zeta": 0.5}),
    ]
    for way in ways:
        assert scenario_to_dict(way.scenario) == scenario_to_dict(by_text.scenario)
    assert by_text.scenario.solver.end_time_s == 1.25  # of a mapping only what it names is changed
    assert ways[2].sources.locate("model.bodies.trunk") == load("runner").sources.locate("model.bodies.trunk")


def test_an_override_with_a_type_replaces_another_type() -> None:
    changed = load("runner", drives={"hip_rear_a": {"type": "torque", "torque_Nm": 0.1}}, method="engine").scenario
    assert changed.drives["hip_rear_a"].type == "torque"
    assert changed.drives["hip_rear_b"].type == "motion"


@pytest.mark.parametrize(
    ("text", "changes"),
    [
        ("solver.acuracy=0.1", {"solver": {"acuracy": 0.1}}),
        ("medium.zeta=-1", {"medium": {"zeta": -1}}),
        ("drives.hip.type=motion", {"drives": {"hip": {"type": "motion"}}}),
    ],
)
def test_faults_are_reported_as_on_the_command_line(text: str, changes: dict[str, object]) -> None:
    refused = partial(faults_of, ConfigError, load, "runner")
    by_text, by_keywords = ([(f.key, f.message) for f in faults] for faults in (refused([text]), refused(**changes)))
    assert by_text == by_keywords != []


def test_missing_files_are_reported_with_similar_names() -> None:
    with pytest.raises(ConfigError, match=r"^runer: no such file, .*; did you mean runner\?$"):
        load("runer")
    with pytest.raises(ConfigError, match=r"^folder/runner.yaml: no such file$"):
        load("folder/runner.yaml")


def test_faults_of_the_geometry_have_their_lines() -> None:
    loaded = load(CONFIGS / "flexible_leg.yaml", method={"reduced": {"modes": 0}})
    files = {fault.file for fault in faults_of(SceneError, simulate, loaded)}
    assert files == {"load method={'reduced': {'modes': 0}}"}


def test_editors_know_every_key_of_a_config() -> None:
    source = (ROOT / "granular_contact" / "config" / "given.py").read_text(encoding="utf-8")
    hints = dict(re.findall(r"class (\w+)\(TypedDict, total=False\):\n.*?\n\n((?:        .+\n)+)", source))
    for name, model in (("Changes", Scenario), ("Solver", Solver), ("Output", Output), ("Load", Load)):
        text = hints[f"{name.removesuffix('Changes')}Changes"]
        assert set(re.findall(r"^ +(\w+):", text, flags=re.M)) == set(model.model_fields)
