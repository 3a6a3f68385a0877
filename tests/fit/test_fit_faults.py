"""Faults of data, fit files and parameters: one line each with file and line, all reported at once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support_fit import CONFIG, RIGID, measure

from granular_contact.config.csv_table import read_table
from granular_contact.config.tree import Position
from granular_contact.errors import ConfigError, Fault
from granular_contact.studies.fit import load_specification, prepare
from granular_contact.studies.fit.measurements import gathered, select

FIT = f"""\
parameters: [medium.eta_d]
set: {{method.reduced.modes: 0}}
runs:
  - config: {CONFIG}
    data: data.csv
"""


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> list[str]:
    """Lines of a file of 50 rows, 2 ms apart."""
    return measure(tmp_path_factory.mktemp("good") / "data.csv", RIGID).read_text().splitlines()


@pytest.fixture
def faults(tmp_path: Path, good: list[str]) -> Callable[..., list[tuple[str, int | None, str, str]]]:
    """File, line, key and message of each fault of a fit file with the data of these lines."""

    def of(text: str = FIT, lines: list[str] | None = None) -> list[tuple[str, int | None, str, str]]:
        (tmp_path / "data.csv").write_text("\n".join(good if lines is None else lines) + "\n", encoding="utf-8")
        (tmp_path / "fit.yaml").write_text(text, encoding="utf-8")
        with pytest.raises(ConfigError) as caught:
            prepare(load_specification(tmp_path / "fit.yaml"))
        assert all(len(str(fault).splitlines()) == 1 for fault in caught.value.faults)
        return [(Path(f.file).name, f.line, f.key, f.message) for f in caught.value.faults]

    return of


# ---- data ----


def cell(lines: list[str], line: int, column: int, text: str) -> list[str]:
    """The lines with one cell of a line (from 1) replaced."""
    cells = lines[line - 1].split(",")
    cells[column] = text
    return [*lines[: line - 1], ",".join(cells), *lines[line:]]


DATA = {
    "no header": (lambda g: g[1:], 1, "", "has numbers where the names"),
    "empty": (lambda _: [], 1, "", "is empty"),
    "hole": (lambda g: cell(g, 7, 2, ""), 7, "tip_y_m", "is empty; fill the cell"),
    "text": (lambda g: cell(g, 7, 1, "lost"), 7, "tip_x_m", "got 'lost'; allowed is a finite number"),
    "nan": (lambda g: cell(g, 7, 1, "nan"), 7, "tip_x_m", "got 'nan'"),
    "underscore": (lambda g: cell(g, 7, 1, "1_000"), 7, "tip_x_m", "got '1_000'"),
    "short row": (lambda g: [*g[:8], "0.014,0.2", *g[9:]], 9, "", "has 2 cells; 3 are allowed"),
    "time again": (lambda g: cell(g, 9, 0, "0.012"), 9, "time_s", "got 0.012, which is also the time of line 8"),
    "time back": (lambda g: cell(g, 9, 0, "0.003"), 9, "time_s", "got 0.003, which comes after 0.012"),
    "too few": (lambda g: g[:5], 1, "", "got 4 rows; allowed are 6 or more"),
    "shorter than the impact": (lambda g: g[:8], 8, "", "shorter than the impact, which takes about 0.0255 s"),
    "longer than the run": (None, 51, "", "ends 0.098 s after the start, but the run ends at 0.03 s"),
    "wrong unit of lengths": (lambda g: ["time_s,tip_x_cm,tip_y_m", *cell(g, 2, 1, "2e4")[1:]],
                              2, "tip_x_m", "got 200 m, but the mechanism reaches 0.226 m"),
    "angle": (lambda _: ["time_s,pivot_angle_deg", *(f"{0.002 * i},{31 + 8 * i}" for i in range(60))],
              49, "pivot_angle_deg", "which is 407 deg; at most 400 deg"),
    "angle in rad": (lambda _: ["time_s,pivot_angle_rad", *(f"{0.002 * i},31" for i in range(60))],
                     2, "pivot_angle_rad", "got 31, which is 1776 deg"),
    "unknown column": (lambda g: ["time_s,tip_q_m,tip_y_m", *g[1:]], 1, "tip_q_m", "did you mean tip_"),
    "unlike any": (lambda g: ["time_s,frame,tip_y_m", *g[1:]], 1, "frame", "allowed are pivot_angle_deg (rad), tip"),
    "wheel by slip": (lambda g: ["slip,tip_x_m,tip_y_m", *g[1:]], 1, "slip", "each slip is a run with a table"),
    "no time": (lambda g: ["mean_rate_rad_s,tip_x_m,tip_y_m", *g[1:]], 1, "", "has no column of times"),
    "time alone": (lambda g: ["time_s,drag_force_x_N,kinetic_J", *g[1:]], 1, "", "no column to compare with the run"),
    "two of one": (lambda g: ["time_s,tip_x_m,tip_x_mm", *g[1:]], 1, "tip_x_m", "is measured by two columns"),
    "capitals": (lambda g: ["time_s,Tip_X_m,tip_y_m", *g[1:]], 1, "Tip_X_m", "did you mean tip_x_m?"),
    "columns by blanks": (lambda g: ["time_s   tip_x_m", *g[1:]], 1, "", "a comma, a semicolon or a tab separates"),
    "no name": (lambda g: ["time_s,,tip_y_m", *g[1:]], 1, "", "has no name for column 2"),
    "name twice": (lambda g: ["time_s,tip_x_m,tip_x_m", *g[1:]], 1, "tip_x_m", "is the name of two columns"),
}  # fmt: skip


@pytest.mark.parametrize("name", DATA)
def test_faulty_data(faults, good, name: str) -> None:
    change, line, key, message = DATA[name]
    text = FIT
    if change is None:
        text = FIT.replace("modes: 0}", "modes: 0, solver.end_time_s: 0.03}")
    reported = faults(text, change(good) if change else good)
    assert reported[0][:3] == ("data.csv", line, key)
    assert message in reported[0][3]
    assert len(reported) == 1


def test_all_faulty_rows_at_once_and_not_too_many(faults, good) -> None:
    spoilt = cell(cell(cell(good, 4, 1, ""), 9, 2, "x"), 12, 0, "?")
    assert [(line, key) for _, line, key, _ in faults(lines=spoilt)] == [(4, "tip_x_m"), (9, "tip_y_m"), (12, "time_s")]
    for line in range(2, 52):
        spoilt = cell(spoilt, line, 1, "")
    reported = faults(lines=spoilt)
    assert len(reported) == 10 + 1 + 1 + 1
    assert ("data.csv", 12, "", "has 40 more such lines from here on") in reported


def test_names_units_separators_and_comments(tmp_path: Path) -> None:
    file = tmp_path / "odd.csv"
    rows = [f"{i};{100 * i};{0.5 + 0.01 * i};{7}" for i in range(8)]
    file.write_text("\ufeff# by a camera\n\nt [ms];X;swing;frame\n" + "\n".join(rows), encoding="utf-8")
    table_faults: list[Fault] = []
    table = read_table(file, table_faults)
    assert table is not None
    at = Position("here", 1)
    mapping = {"time_ms": ("t [ms]", at), "tip_x_mm": ("X", at), "pivot_angle_rad": ("swing", at)}
    assert table_faults == []
    measured = select(table, ["pivot_angle_deg", "tip_x_m", "tip_y_m"], mapping)
    np.testing.assert_allclose(measured.time, 1e-3 * np.arange(8))
    assert measured.columns == ("tip_x_m", "pivot_angle_deg")
    np.testing.assert_allclose(measured.values[:, 0], 0.1 * np.arange(8))
    np.testing.assert_allclose(measured.values[:, 1], np.degrees(0.5 + 0.01 * np.arange(8)))
    assert measured.unused == ("frame",)
    assert measured.lines[0] == 4


@pytest.mark.parametrize("form", ["{0},\n", "  # by hand\n{0}\n", "% by a machine\n{0}\n"])
def test_ends_of_spreadsheets_and_comments_of_others(tmp_path: Path, good, form: str) -> None:
    file = tmp_path / "data.csv"
    body = "".join(f"{row},\n" if form.startswith("{0},") else f"{row}\n" for row in good[1:])
    reported: list[Fault] = []
    for head in (form, "{0}\n"):  # cells too many in all rows, or but in the header
        file.write_text(head.format(good[0]) + body, encoding="utf-8")
        table = read_table(file, reported)
        assert reported == []
        assert table is not None
        assert table.header == ("time_s", "tip_x_m", "tip_y_m")
        assert {len(row) for row in table.rows} == {3}


def test_tables_of_runs_of_a_bending_link_are_data_for_a_rigid_link(tmp_path: Path) -> None:
    for names, refused in (("time_s,tip_x_m,deflection_m,drag_force_x_N", 0), ("time_s,tip_x_m,deflection_m", 1)):
        reported: list[Fault] = []
        rows = [",".join([str(i)] * (names.count(",") + 1)) for i in range(9)]
        (tmp_path / "t.csv").write_text("\n".join([names, *rows]), encoding="utf-8")
        table = read_table(tmp_path / "t.csv", reported)
        assert table is not None
        with gathered(reported):
            select(table, ["tip_x_m"], {})
        assert len(reported) == refused


def test_a_runs_own_table_is_data(tmp_path: Path) -> None:
    # what a camera can't see is left out
    names = "time_s,pivot_angle_deg,mean_rate_rad_s,tip_x_m,drag_force_x_N,kinetic_J"
    (tmp_path / "t.csv").write_text("\n".join([names, *(f"{i},1,2,3,4,5" for i in range(9))]), encoding="utf-8")
    reported: list[Fault] = []
    table = read_table(tmp_path / "t.csv", reported)
    assert table is not None
    measured = select(table, ["pivot_angle_deg", "tip_x_m"], {})
    assert measured.columns == ("pivot_angle_deg", "tip_x_m")
    assert measured.unused == ("mean_rate_rad_s", "drag_force_x_N", "kinetic_J")


# ---- fit files ----

TEXTS = {
    "no such data": (("data.csv", "nowhere.csv"), "nowhere.csv", None, "", "no such file"),
    "no such config": ((str(CONFIG), "nowhere.yaml"), "fit.yaml", 4, "", "nowhere.yaml', but there is no such file"),
    "no runs": (("runs:", "rums:"), "fit.yaml", 3, "rums", "did you mean runs?"),
    "unknown key of a run": (("    data:", "    colour: red\n    data:"), "fit.yaml", 5, "runs.0.colour", "unknown"),
    "no data": (("    data: data.csv\n", ""), "fit.yaml", 4, "runs.0.data", "is missing"),
    "no parameters": (("[medium.eta_d]", "[]"), "fit.yaml", 1, "parameters", "a list of 0 items"),
    "parameter twice": (("[medium.eta_d]", "[medium.eta_d, medium.eta_d]"), "fit.yaml", 1, "parameters", "twice"),
    "bounds upside down": (("[medium.eta_d]", "{medium.eta_d: {from: 9, to: 2}}"), "fit.yaml", 1,
                           "parameters.medium.eta_d", "got bounds from 9 to 2"),
    "bound no number": (("[medium.eta_d]", "{medium.eta_d: {from: low, to: 2}}"), "fit.yaml", 1,
                        "parameters.medium.eta_d.from", "allowed is a finite number"),
    "bound the schema refuses": (("[medium.eta_d]", "{medium.eta_d: {from: -2, to: 20}}"), "fit.yaml", 1,
                                 "medium.eta_d", "from: got the number -2; allowed is a finite number of at least 0"),
    "start outside": (("[medium.eta_d]", "{medium.eta_d: {from: 2, to: 9, start: 10}}"), "fit.yaml", 1,
                      "parameters.medium.eta_d.start", "not within the bounds from 2 to 9"),
    "log of nothing": (("[medium.eta_d]", "{medium.eta_d: {from: 0, to: 9, scale: log}}"), "fit.yaml", 1,
                       "parameters.medium.eta_d.scale", "must be above 0"),
    "last part of a key": (("medium.eta_d]", "eta_d]"), "fit.yaml", 1, "eta_d", "did you mean medium.eta_d?"),
    "unknown coefficient": (("eta_d]", "eta_q]"), "fit.yaml", 1, "medium.eta_q", "did you mean medium.eta_"),
    "text": (("medium.eta_d]", "medium.law]"), "fit.yaml", 1, "medium.law", "is not a number but 'lee_marghitu'"),
    "whole number": (("medium.eta_d]", "load.strips_per_element]"), "fit.yaml", 1, "load.strips_per_element",
                     "is a whole number, 4"),
    "a setting of the solver": (("medium.eta_d]", "solver.step_s]"), "fit.yaml", 1, "solver.step_s",
                                "says how a run is computed"),
    "unused": (("[medium.eta_d]", "[load.friction.damping_time_s]"), "fit.yaml", 1, "load.friction.damping_time_s",
               "has no effect on any of tip_x_m, tip_y_m in any run"),
    "unknown column": (("    data:", "    columns: {time_s: time_s, tip_q_m: tip_x_m}\n    data:"), "fit.yaml", 5,
                       "columns.tip_q_m", "the run has no such column; did you mean tip_"),
    "column that can't be fitted": (("    data:", "    columns: {time_s: time_s, mean_rate_rad_s: F}\n    data:"),
                                    "fit.yaml", 5, "columns.mean_rate_rad_s",
                                    "is a rate, and only angles, lengths, forces and moments can be fitted; allowed"),
    "nearly a column that can't be": (("    data:", "    columns: {time_s: time_s, mean_rates_rad_s: F}\n    data:"),
                                      "fit.yaml", 5, "columns.mean_rates_rad_s",
                                      "no such column; the nearest, mean_rate_rad_s, is a rate, and only angles"),
    "column not in the file": (("    data:", "    columns: {time_s: t, tip_x_m: tip_x_m}\n    data:"), "fit.yaml", 5,
                               "columns.time_s", "got 't', but"),
    "scale of an offset": (
        ("    data:", "    time_offset_s: {from: -0.02, to: 0, scale: linear}\n    data:"),
        *("fit.yaml", 5, "runs.0.time_offset_s.scale", "unknown key"),
    ),
    "offset": (("    data:", "    time_offset_s: maybe\n    data:"), "fit.yaml", 5, "runs.0.time_offset_s",
               "allowed is fit, a number"),
    "noise": (("runs:", "noise: {tip_x_m: 0}\nruns:"), "fit.yaml", 3, "noise.tip_x_m", "number above 0"),
    "noise of nothing": (("runs:", "noise: {deflection_mm: 1}\nruns:"), "fit.yaml", 3, "noise.deflection_mm",
                         "no data have such a column"),
    "noise of one column twice": (("runs:", "noise: {tip_x_mm: 0.1, tip_x_m: 5}\nruns:"), "fit.yaml", 3,
                                  "noise.tip_x_m", "is the same column as tip_x_mm"),
    "loss": (("runs:", "loss: cauchy\nruns:"), "fit.yaml", 3, "loss", "one of soft_l1, linear"),
    "starts": (("runs:", "starts: 0\nruns:"), "fit.yaml", 3, "starts", "from 1 to 1024"),
    "faulty config": (("modes: 0", "modes: 99"), "fit.yaml", 2, "method.reduced.modes", "from 0 to 20"),
    "a scene that can't be": (("modes: 0", "modes: 1, model.bodies.link.flexible: null"), "fit.yaml", 2,
                              "method.reduced.modes", "the model has no flexible link"),
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
def test_faulty_fit_file(faults, name: str) -> None:
    (old, new), file, line, key, message = TEXTS[name]
    assert FIT.count(old) == 1
    text = FIT.replace(old, new)
    if name == "unused":  # the true sign has no bristles
        text = text.replace("modes: 0", "modes: 0, method.reduced.static: true_sign")
    reported = faults(text)
    if name == "no runs":  # that they are missing stands in line 1
        assert reported.pop(0)[1:3] == (1, "runs")
    assert reported[0][:3] == (file, line, key)
    assert message in reported[0][3]
    assert len(reported) == 1


def test_faults_of_all_files_come_together(faults, good, tmp_path: Path) -> None:
    (tmp_path / "other.csv").write_text("1,2,3\n", encoding="utf-8")
    text = FIT + f"  - {{config: {CONFIG}, data: other.csv}}\n  - {{config: {CONFIG}, data: gone.csv}}\n"
    reported = faults(text, cell(good, 5, 1, ""))
    assert [(file, line) for file, line, *_ in reported] == [("data.csv", 5), ("gone.csv", None), ("other.csv", 1)]


@pytest.mark.parametrize(
    "more", ["model.joints.pivot.damping_Nm_s_per_rad: 1e-3", "model.bodies.link.flexible.bending_damping_N_m2_s: 1e-3"]
)
def test_data_before_the_start_of_the_run_are_refused(faults, good, more: str) -> None:
    early = [good[0], f"-0.002,{good[1].partition(',')[2]}", *good[1:]]
    reported = faults(FIT.replace("method.reduced.modes: 0", f"method: engine, {more}"), early)
    assert reported[0][:3] == ("data.csv", 2, "")
    assert "begins 0.002 s before the start" in reported[0][3]
    assert reported[0][3].endswith("leave these rows out, or let the run start earlier")


def test_bounds_of_the_time_offset_after_the_start_are_suggested(faults, good) -> None:
    more = "method: engine, model.joints.pivot.damping_Nm_s_per_rad: 1e-3"
    text = FIT.replace("method.reduced.modes: 0", more) + "    time_offset_s: fit\n"
    ((*_, message),) = faults(text, good)
    assert message.endswith("narrower bounds in a fit file, as time_offset_s: {from: -0.02, to: 0}")


@pytest.mark.parametrize(("shift", "more"), [(0.05, "time_offset_s: fit"), (12.3, "time_offset_s: 0.1"), (12.3, "")])
def test_a_clock_outside_the_run(faults, good, shift: float, more: str) -> None:
    rows = [line.partition(",") for line in good[1:]]
    late = [good[0], *(f"{float(time) + shift!r},{rest}" for time, _, rest in rows)]
    ((file, line, key, message),) = faults(f"{FIT}    {more}\n", late)
    assert (file, line, key) == ("data.csv", 2, "")
    earliest = {0.05: 0.03, 12.3: 12.2 if more else 12.3}[shift]  # an offset that is fitted goes to 20 ms
    assert f"begins {earliest:.4g} s after the start of the run at the earliest" in message
    assert "is the clock shifted" in message


def test_default_bounds_go_as_far_as_the_schema(tmp_path: Path, good) -> None:
    (tmp_path / "data.csv").write_text("\n".join(good), encoding="utf-8")
    keys = "medium.eta_d, medium.plunging.lambda, initial.impact_angle_deg"
    (tmp_path / "fit.yaml").write_text(FIT.replace("medium.eta_d", keys), encoding="utf-8")
    parameters = prepare(load_specification(tmp_path / "fit.yaml")).parameters
    bounds = {p.label: (p.low, p.high, p.start, p.log) for p in parameters}
    assert bounds["medium.eta_d"] == pytest.approx((0.65, 65.0, 6.5, True))
    assert bounds["medium.plunging.lambda"] == pytest.approx((0.11, 3.3, 1.1, True))  # at most 5
    assert bounds["initial.impact_angle_deg"] == pytest.approx((3.1, 46.5, 31.0, True))  # at most 90, so not 93
