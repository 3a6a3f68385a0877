"""The output folder: its exact files, written whole or not at all."""

from __future__ import annotations

import csv
import dataclasses
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import yaml
from matplotlib.figure import Figure
from support_results import make
from support_runs import ROOT

from granular_contact import report
from granular_contact.errors import FigureWarning
from granular_contact.report import figures, overlay
from granular_contact.results import Results
from granular_contact.results.motion import Motion, Part

NAMES = ["figures", "scenario.yaml", "summary.json", "timeseries.csv"]


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def content(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def awkward() -> Results:
    """Numbers that are hard to write down."""
    results = make(rows=40)
    table = results.table.copy()
    table[:8, 3] = [0.1, 1 / 3, -0.0, 5e-324, 1.7976931348623157e308, np.nan, np.inf, -np.inf]
    return dataclasses.replace(
        results, table=table, summary={**results.summary, "extra": (np.float64("inf"), np.int64(3))}
    )


@pytest.mark.slow
def test_folder_holds_the_files_and_figures(tmp_path: Path) -> None:
    report.write(make(), tmp_path / "deep" / "run")
    assert names(tmp_path / "deep") == ["run"]
    assert names(tmp_path / "deep" / "run") == NAMES
    assert names(tmp_path / "deep" / "run" / "figures") == ["energy.png", "forces.png", "joints.png", "mechanism.png"]


def test_without_figures(tmp_path: Path) -> None:
    report.write(make(), tmp_path / "run", figures=False)
    assert names(tmp_path / "run") == NAMES[1:]


def test_series_reads_back_to_the_last_bit(tmp_path: Path) -> None:
    results = awkward()
    report.write(results, tmp_path / "run", figures=False)
    with (tmp_path / "run" / "timeseries.csv").open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == [column.name for column in results.columns]
    table = np.array([[float(cell) for cell in row] for row in rows])
    assert np.array_equal(table.view(np.int64), results.table.view(np.int64))  # the sign of zero, and NaN, as well
    assert rows[0][3] == "0.1"


def test_summary_is_strict_json_in_its_order_with_columns_described(tmp_path: Path) -> None:
    results = awkward()
    report.write(results, tmp_path / "run", figures=False)
    text = (tmp_path / "run" / "summary.json").read_text(encoding="utf-8")

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is not JSON")

    read = json.loads(text, parse_constant=refuse)
    assert list(read) == [*results.summary, "columns"]
    assert read["energy"]["granular_work_J"] is None
    assert read["extra"] == [None, 3]
    assert read["columns"] == {column.name: column.description for column in results.columns}
    assert text.startswith('{\n  "status"')


def test_warnings_come_from_the_results_if_the_summary_has_none(tmp_path: Path) -> None:
    results = dataclasses.replace(make(), summary={"status": "rest"}, warnings=("odd",))
    report.write(results, tmp_path / "run", figures=False)
    assert json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))["warnings"] == ["odd"]


def test_scenario_reads_back_and_says_how_to_run_it_again(tmp_path: Path) -> None:
    shared = [1.0, 2.5e-07]
    results = make()
    results = dataclasses.replace(results, scenario={**results.scenario, "a": shared, "b": shared, "name": "µ = 1e3"})
    report.write(results, tmp_path / "run", figures=False)
    text = (tmp_path / "run" / "scenario.yaml").read_text(encoding="utf-8")
    assert text.splitlines()[0] == (
        "# Written by granular-contact 0.1.0; to run it again: granular-contact run scenario.yaml"
    )
    assert yaml.safe_load(text) == results.scenario
    assert list(yaml.safe_load(text)) == list(results.scenario)
    assert "gravity_m_s2: [0.0, -9.81]" in text
    assert "&" not in text


@pytest.mark.parametrize("exchange", [True, False], ids=["one-call", "two-renames"])
class TestWholeOrNotAtAll:
    @pytest.fixture(autouse=True)
    def _way(self, exchange: bool, monkeypatch: pytest.MonkeyPatch) -> None:
        for name in ("over_time.stack", "mechanism"):  # empty ones
            monkeypatch.setattr(f"granular_contact.report.figures.{name}", lambda *_: Figure((1.0, 1.0)))
        if not exchange:
            monkeypatch.setattr(report, "_exchange", lambda _one, _other: False)

    def test_an_earlier_run_is_replaced_as_a_whole(self, tmp_path: Path) -> None:
        report.write(make(flexible=True), tmp_path / "run")
        report.write(make(rows=7), tmp_path / "run", figures=False)
        assert names(tmp_path) == ["run"]
        assert names(tmp_path / "run") == NAMES[1:]
        assert len((tmp_path / "run" / "timeseries.csv").read_text().splitlines()) == 8

    def test_an_empty_folder_is_filled(self, tmp_path: Path) -> None:
        (tmp_path / "run").mkdir()
        report.write(make(), tmp_path / "run", figures=False)
        assert names(tmp_path) == ["run"]
        assert names(tmp_path / "run") == NAMES[1:]

    @pytest.mark.slow
    @pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
    @pytest.mark.parametrize("where", ["scenario_text", "write_table", "swap"])
    def test_a_failure_leaves_the_old_folder(
        self, where: str, error: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        report.write(make(), tmp_path / "run", figures=False)
        before = content(tmp_path)

        def fail(*_: object) -> None:
            raise error

        monkeypatch.setattr(report, where, fail)
        with pytest.raises(type(error)):
            report.write(make(flexible=True), tmp_path / "run", figures=False)
        assert content(tmp_path) == before
        assert names(tmp_path) == ["run"]

    @pytest.mark.slow
    @pytest.mark.parametrize("error", [ValueError("no rows"), MemoryError()])
    def test_a_failing_figure_is_reported_and_costs_only_itself(
        self, error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(_: Results) -> None:
            raise error

        monkeypatch.setattr(figures, "mechanism", fail)
        with pytest.warns(FigureWarning, match=r"figures/mechanism\.png is missing, as drawing it failed") as caught:
            report.write(make(), tmp_path / "run")
        assert len(caught) == 1
        assert names(tmp_path / "run") == NAMES
        assert names(tmp_path / "run" / "figures") == ["energy.png", "forces.png", "joints.png"]

    def test_ctrl_c_among_the_pictures_keeps_the_data(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        def stop(_: Results) -> None:
            raise KeyboardInterrupt

        monkeypatch.setattr(figures, "mechanism", stop)
        with pytest.raises(KeyboardInterrupt, match="the data is saved in"):
            report.write(make(), tmp_path / "run")
        assert names(tmp_path) == ["run"]
        assert set(NAMES[1:]) <= set(names(tmp_path / "run"))


def test_the_exchange_is_one_call_on_linux(tmp_path: Path) -> None:
    first, second = tmp_path / "one", tmp_path / "other"
    for folder in (first, second):
        folder.mkdir()
        (folder / folder.name).touch()
    if not report._exchange(first, second):
        pytest.skip("this system has no exchange of folders")
    assert names(first) == ["other"]
    assert names(second) == ["one"]


def test_the_old_folder_comes_back_when_the_second_rename_fails(tmp_path: Path) -> None:
    target = tmp_path / "run"
    report.write(make(), target, figures=False)
    before = content(tmp_path)
    with pytest.raises(FileNotFoundError):
        report._replace(tmp_path / ".run.absent", target)
    assert content(tmp_path) == before
    assert names(tmp_path) == ["run"]


def test_a_linked_folder_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    report.write(make(), tmp_path / "link", figures=False)
    assert (tmp_path / "link").is_symlink()
    assert names(tmp_path / "real") == NAMES[1:]


def test_files_that_no_run_wrote_are_not_replaced(tmp_path: Path) -> None:
    report.write(make(), tmp_path / "run", figures=False)
    (tmp_path / "run" / "notes.txt").write_text("mine")
    with pytest.raises(FileExistsError, match=r"notes\.txt"):
        report.write(make(), tmp_path / "run")
    (tmp_path / "file").touch()
    with pytest.raises(NotADirectoryError, match="is a file"):
        report.check_target(tmp_path / "file")
    assert names(tmp_path) == ["file", "run"]


@pytest.mark.slow
def test_matplotlib_is_imported_for_figures_only_and_pyplot_never(tmp_path: Path) -> None:
    code = "import sys; from pathlib import Path; from support_results import make; from granular_contact import report"
    for drawn, unwanted in (
        (False, ("matplotlib", "granular_contact.report.figures")),
        (True, ("matplotlib.pyplot",)),
    ):
        code += f"\nreport.write(make(rows=20), Path({str(tmp_path / 'run')!r}), figures={drawn})"
        code += f"\nassert not [name for name in {unwanted!r} if name in sys.modules]"
    tests = Path(__file__).parent
    paths = f"import sys; sys.path[:0] = [{str(tests)!r}, {str(tests.parent)!r}]\n"
    subprocess.run([sys.executable, "-c", paths + code], check=True)


def left_behind(folder: Path, name: str, age: float = 3600.0) -> Path:
    """What a run that was killed while it wrote leaves, so many seconds (s) ago."""
    made = folder / name
    (made / "figures").mkdir(parents=True)
    (made / "summary.json").write_text("{")
    os.utime(made, (time.time() - age, time.time() - age))
    return made


def test_folders_of_killed_runs_are_cleared_away(tmp_path: Path) -> None:
    old = [left_behind(tmp_path, name) for name in (".run.0123abcd", ".run.k2x_9ab1")]
    young = left_behind(tmp_path, ".run.00000000", age=1.0)
    others = [
        left_behind(tmp_path, name) for name in (".run2.0123abcd", ".run.notes", "run.0123abcd", ".run.0123abcd.old")
    ]
    foreign = left_behind(tmp_path, ".run.deadbeef")
    (foreign / "thesis.tex").write_text("mine")
    os.utime(foreign, (0, 0))
    report.write(make(), tmp_path / "run", figures=False)
    assert not any(path.exists() for path in old)
    assert all(path.exists() for path in (young, *others, foreign))


def test_the_folder_of_a_run_at_work_is_left_alone(tmp_path: Path) -> None:
    with report.whole_folder(tmp_path / "run") as making:
        os.utime(making, (0, 0))
        report.write(make(), tmp_path / "run", figures=False)
        assert making.exists()
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_a_killed_process_releases_its_lock(tmp_path: Path) -> None:
    """The smallest case: kill -9 while the folder is written, then another run of the same name."""
    code = f"""
import os, signal
from pathlib import Path
from granular_contact import report
with report.whole_folder(Path({str(tmp_path / "run")!r})) as making:
    (making / "summary.json").touch()
    os.utime(making, (0, 0))
    os.kill(os.getpid(), signal.SIGKILL)
"""
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False)
    (left,) = tmp_path.iterdir()
    assert left.name.startswith(".run.")
    report.write(make(), tmp_path / "run", figures=False)
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_runs_are_put_on_one_clock() -> None:
    """A run that ends early has no numbers after its end and stays where it was; keys of names are all different."""
    long = make()
    half = len(long.table) // 2
    short = dataclasses.replace(long, table=long.table[:half].copy(), frames=long.frames[: len(long.frames) // 2])
    assert overlay.keys(["a b", "a, b", "FE, 4 elements", "+"]) == ["a_b", "a_b_2", "FE_4_elements", "run"]
    runs = [overlay.history("whole", long), overlay.history("a, b", short)]
    table = overlay.table(runs)
    time = table["time_s"]
    assert np.isfinite(table["whole.tip_y_m"]).all()
    assert (np.isfinite(table["a_b.tip_y_m"]) == (time <= short["time_s"][-1])).all()
    np.testing.assert_allclose(table["whole.tip_y_m"], long["tip_y_m"], rtol=1e-12)
    panels = [p for group in overlay.panels(["whole", "a, b"], table, "whole") for p in group.panels]
    assert all([curve.label for curve in panel.curves] in (["whole", "a, b"], ["a, b"]) for panel in panels)
    titles = [panel.title for panel in panels]
    assert len(titles) == len(set(titles))
    assert overlay.motion(runs) is None  # these have no pictures
    at = np.linspace(0.0, 0.02, 11)
    poses = np.stack([np.stack([at, 0 * at, 50 * at], axis=1)], axis=1)
    bar = Motion(at, (Part("link", np.array([[0.0, 0.0], [0.1, 0.0]])),), poses)
    early = dataclasses.replace(bar, time=0.5 * at)
    both = [dataclasses.replace(run, motion=motion) for run, motion in zip(runs, (bar, early), strict=True)]
    moved = overlay.motion(both)
    assert moved is not None
    assert [part.name for part in moved.parts] == ["whole: link", "a, b: link"]
    np.testing.assert_allclose(moved.poses[:, 0], poses[:, 0], atol=1e-12)
    np.testing.assert_allclose(moved.poses[2, 1], poses[4, 0], atol=1e-12)  # twice as fast
    np.testing.assert_allclose(moved.poses[7:, 1], poses[[-1] * 4, 0], atol=1e-12)  # and then at rest
