"""Sobol indices: of functions whose indices are known, through the rows of a design; and of a sweep as users run it."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from support_sweep import SPEED, write

from granular_contact.cli import main, many
from granular_contact.config import Sweep, load_sweep
from granular_contact.studies.sweep import Row, WorkerPool, sensitivity

OUTPUT = "y"
# Three keys that any number may stand under, so that cases need not be checked.
KEYS = ("medium.eta_d", "medium.eta_h", "gravity_m_s2")


def design(folder: Path, count: int, ends: tuple[float, float], seed: int = 0) -> Sweep:
    ranges = "".join(f"    {key}: [{ends[0]!r}, {ends[1]!r}]\n" for key in KEYS)
    text = f"sample:\n  method: saltelli\n  count: {count}\n  seed: {seed}\n  outputs: [{OUTPUT}]\n  ranges:\n{ranges}"
    return load_sweep(write(folder, text))


def rows(sweep: Sweep, function: Callable[..., float | None]) -> list[Row]:
    """What a sweep would give if a run was this function of the three values."""
    ending = {"status": "rest", "message": ""}
    return [
        Row(i, case.name, case.values, {**ending, OUTPUT: function(*(case.values[key] for key in KEYS))})
        for i, case in enumerate(sweep.cases)
    ]


def within(intervals_of: np.ndarray, ends: np.ndarray, exact: list[float], share: float) -> None:
    """The exact values lie in the intervals, or as near as one in twenty may miss, and these are as narrow as said."""
    width = ends[1] - ends[0]
    assert np.all(width < share)
    assert np.all(np.abs(intervals_of - exact) <= np.maximum(width, 1e-3))


@pytest.mark.slow
def test_a_linear_function(tmp_path):
    """Of a1 x1 + a2 x2 + a3 x3, x even over one range: a_i^2 over their sum, alone and in total."""
    slopes = np.array([1.0, 2.0, 4.0])
    sweep = design(tmp_path, 256, (1.0, 2.0))
    [result] = sensitivity.of_sweep(sweep, rows(sweep, lambda *x: float(slopes @ x)))
    exact = list(slopes**2 / np.sum(slopes**2))
    assert (result.output, result.inputs, result.refused) == (OUTPUT, KEYS, "")
    within(result.first, result.first_interval, exact, 0.3)
    within(result.total, result.total_interval, exact, 0.3)


@pytest.mark.slow
def test_too_few_points_are_reported(tmp_path):
    slopes = np.array([1.0, 2.0, 4.0])
    for count, warned in ((2, True), (256, False)):
        sweep = design(tmp_path, count, (1.0, 2.0))
        results = sensitivity.of_sweep(sweep, rows(sweep, lambda *x: float(slopes @ x)))
        warnings = sensitivity.warnings(results[0])
        assert bool(warnings) == warned
        sensitivity.write(results, tmp_path, figures=False)
        with (tmp_path / "sensitivity.csv").open(encoding="utf-8") as file:
            notes = [row["note"] for row in csv.DictReader(file) if row["note"]]
        assert [warning.partition(": ")[2] for warning in warnings] == notes
        assert all(warning.endswith("take a greater count") for warning in warnings)


@pytest.mark.parametrize(
    ("first", "total", "width", "why"),
    [(0.3, 0.4, 0.2, ""), (-0.02, 0.01, 0.2, ""), (0.3, 0.4, 0.6, "wide"), (0.3, 0.4, math.nan, "wide"),
     (-0.15, 0.4, 0.2, "outside"), (0.3, 1.2, 0.2, "outside"), (0.55, 0.4, 0.2, "above the total")],
)  # fmt: skip
def test_imprecise_indices_are_reported_with_the_reason(first, total, width, why):
    ends = np.array([[0.0], [width]])
    indices = sensitivity.Indices(OUTPUT, KEYS[:1], np.array([first]), np.array([total]), ends, ends)
    imprecision = sensitivity.imprecision(indices, 0)
    assert why in imprecision
    assert bool(imprecision) == bool(why)


@pytest.mark.slow
def test_ishigami(tmp_path):
    """Its third input does nothing alone and a quarter together with the first (Ishigami and Homma 1990)."""
    a, b = 7.0, 0.1

    def ishigami(x: float, y: float, z: float) -> float:
        x, y, z = (value - 10.0 for value in (x, y, z))
        return math.sin(x) + a * math.sin(y) ** 2 + b * z**4 * math.sin(x)

    alone, second = 0.5 * (1 + b * math.pi**4 / 5) ** 2, a**2 / 8
    both = b**2 * math.pi**8 * (1 / 18 - 1 / 50)
    variance = alone + second + both
    first = [alone / variance, second / variance, 0.0]
    total = [(alone + both) / variance, second / variance, both / variance]
    assert first[0] == pytest.approx(0.3139, abs=1e-4)
    sweep = design(tmp_path, 512, (10.0 - math.pi, 10.0 + math.pi), seed=1)
    [result] = sensitivity.of_sweep(sweep, rows(sweep, ishigami))
    within(result.first, result.first_interval, first, 0.3)
    within(result.total, result.total_interval, total, 0.3)
    # What tells the two kinds apart is far wider than any interval.
    assert result.total[2] - result.first[2] > 0.2
    # The same rows, the same numbers, intervals too.
    [repeated] = sensitivity.of_sweep(sweep, rows(sweep, ishigami))
    assert np.array_equal(repeated.total_interval, result.total_interval)


@pytest.mark.slow
def test_intervals_hold_what_they_say(tmp_path):
    """95 % intervals over 8 designs of 64 points miss the exact value of a linear function in few."""
    slopes = np.array([1.0, 2.0, 4.0])
    exact = slopes**2 / np.sum(slopes**2)
    missed = 0
    for seed in range(8):
        sweep = design(tmp_path, 64, (1.0, 2.0), seed)
        values = np.array([row.summary[OUTPUT] for row in rows(sweep, lambda *x: float(slopes @ x))])
        result = sensitivity.indices(OUTPUT, KEYS, values.reshape(5, 64), seed)
        low, high = result.total_interval
        missed += int(np.sum((exact < low) | (exact > high)))
    # Sobol points are more even than the random ones that a bootstrap thinks of, so fewer than 5 % of 24 are missed.
    assert missed <= 2


@pytest.mark.parametrize(
    ("function", "status", "message"),
    [
        (lambda *x: None if x[0] > 1.98 else 1.0 * x[0], "end_time", "cases have no y (case_"),
        (lambda *x: math.nan if x[0] > 1.98 else x[0], "rest", "cases have no y (case_"),
        (lambda *_: 2.5, "rest", "it is the same in all cases"),
    ],
)
def test_indices_are_refused_rather_than_wrong(tmp_path, function, status, message):
    sweep = design(tmp_path, 64, (1.0, 2.0))
    given = [Row(r.index, r.name, r.values, {**r.summary, "status": status}) for r in rows(sweep, function)]
    [result] = sensitivity.of_sweep(sweep, given)
    assert message in result.refused
    assert len(result.first) == 0
    sensitivity.write([result], tmp_path)
    with (tmp_path / "sensitivity.csv").open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert [line["input"] for line in lines] == list(KEYS)
    assert {(line["first_order"], line["total"], line["note"]) for line in lines} == {("", "", result.refused)}
    assert not (tmp_path / "figures").exists()


def test_a_failed_case_refuses_them(tmp_path):
    sweep = design(tmp_path, 64, (1.0, 2.0))
    given = rows(sweep, lambda *x: x[0])
    given[7] = Row(7, given[7].name, given[7].values, {"status": "error", "message": "boom"})
    [result] = sensitivity.of_sweep(sweep, given)
    assert result.refused == "1 of 320 cases failed (case_008)"


RUN = f"""set: {{method: {{reduced: {{modes: 0}}}}}}
sample:
  method: saltelli
  count: 16
  outputs: [stopping_time_s, max_deflection_m]
  ranges:
    {SPEED}: [2, 9]
    medium.eta_d: {{from: 1, to: 10, scale: log}}
"""


@pytest.fixture
def cases_in_this_process(monkeypatch):
    """Let the command take its runs in a thread of this process."""
    monkeypatch.setattr(many, "pool", lambda *_: WorkerPool(1, ThreadPoolExecutor))


@pytest.mark.slow
@pytest.mark.usefixtures("cases_in_this_process")
def test_sweep_command_prints_indices_and_their_doubts(tmp_path, capsys):
    """A rigid link has no deflection, which refuses the indices of that; faster impacts stop sooner, whatever eta_d."""
    path = write(tmp_path, RUN)
    assert main(["sweep", str(path), "--out", str(tmp_path / "out")]) == 0
    out, err = capsys.readouterr()
    none = "64 of 64 cases have no max_deflection_m (case_01, case_02, case_03, ...)"
    # 16 points are too few for this, and it is said.
    vague, refused = (line for line in err.splitlines() if " of 64 cases, " not in line)
    assert vague.startswith(
        f"warning: Sobol indices of stopping_time_s with respect to {SPEED}: too few points, a confidence"
    )
    assert refused == f"no Sobol indices of max_deflection_m: {none}"
    assert "Sobol indices of stopping_time_s" in out
    names = sorted(str(p.relative_to(tmp_path / "out")) for p in (tmp_path / "out").rglob("*"))
    figure = "figures/sensitivity_stopping_time_s.png"
    assert names == ["figures", figure, "sensitivity.csv", "sweep.yaml", "table.csv"]
    with (tmp_path / "out" / "sensitivity.csv").open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert [(line["output"], line["input"]) for line in lines] == [
        (output, key) for output in ("stopping_time_s", "max_deflection_m") for key in (SPEED, "medium.eta_d")
    ]
    assert float(lines[0]["total"]) > 0.8 > 0.2 > float(lines[1]["total"])
    # The saved sweep is the same design.
    reloaded = load_sweep(tmp_path / "out" / "sweep.yaml")
    assert [case.values for case in reloaded.cases] == [case.values for case in load_sweep(path).cases]
    assert main(["sweep", str(tmp_path / "out" / "sweep.yaml"), "--out", str(tmp_path / "out")]) == 0
    assert "holds all cases of this sweep already" in capsys.readouterr().out


@pytest.mark.usefixtures("cases_in_this_process")
def test_an_output_that_no_run_has_ends_it_at_once(tmp_path, capsys):
    path = write(tmp_path, RUN.replace("max_deflection_m", "stoping_time_s"))
    assert main(["sweep", str(path), "--out", str(tmp_path / "out")]) == 2
    message = "sample.outputs: got 'stoping_time_s', which is not a number of a summary; did you mean stopping_time_s?"
    assert capsys.readouterr().err == f"{path}: {message}\n"
    assert list(tmp_path.iterdir()) == [path]
