"""Warnings of fits about patterns in the residuals, shared noise, outliers and rounded data."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support_fit import CONFIG, NOISE, measure, problem
from support_refusals import faults_of

from granular_contact.errors import ConfigError
from granular_contact.studies.fit import diagnostics
from granular_contact.studies.fit.diagnostics import data_warnings
from granular_contact.studies.fit.problem import Problem

COLUMNS = ("tip_x_m", "tip_y_m", "pivot_angle_deg")
SIGMA = np.array([NOISE, NOISE, 0.02])


def text(count: int) -> str:
    runs = "".join(f"  - {{config: {CONFIG}, data: {i}.csv}}\n" for i in range(count))
    return f"parameters: [medium.eta_d]\nruns:\n{runs}"


@pytest.fixture(scope="module")
def two(tmp_path_factory) -> Problem:
    """Two runs of 50 rows of three columns."""
    folder = tmp_path_factory.mktemp("two")
    for i in range(2):
        measure(folder / f"{i}.csv", columns=COLUMNS, seed=i)
    return problem(folder, text(2))


def residuals(seed: int) -> list[np.ndarray]:
    """Noise of either run, in its own units."""
    return list(np.random.default_rng(seed).standard_normal((2, 50, 3)))


def test_pure_noise_gives_no_warning(two: Problem) -> None:
    # 4 standard deviations and a correlation of 4 of its own: for 300 values and 9 pairs, 2 % and 0.06 % of the draws.
    assert [warning for seed in range(30) for warning in data_warnings(two, residuals(seed), SIGMA)] == []


def test_a_column_made_of_another_is_found_under_a_pattern(two: Problem) -> None:
    f = residuals(0)
    f[0][:, 2] = f[0][:, 1] + 0.3 * f[0][:, 2]
    smooth = np.sin(np.linspace(0.0, 3.0, 50))[:, None]
    (warning,) = data_warnings(two, [0.5 * noise + smooth for noise in f], SIGMA)
    assert warning.startswith("the noise of tip_y_m and pivot_angle_deg is mostly the same")


def test_columns_with_the_same_noise_are_named_once(two: Problem) -> None:
    f = [np.repeat(noise[:, :1], 3, axis=1) for noise in residuals(0)]
    (warning,) = data_warnings(two, f, SIGMA)
    assert warning.startswith("the noise of tip_x_m and tip_y_m and pivot_angle_deg is mostly the same")


def test_a_pattern_in_two_columns_is_no_common_noise(two: Problem) -> None:
    smooth = 2.0 * np.sin(np.linspace(0.0, 3.0, 50))[:, None]
    assert data_warnings(two, [0.5 * noise + smooth for noise in residuals(0)], SIGMA) == []


def test_runs_with_the_same_noise_are_detected(two: Problem) -> None:
    f = residuals(0)
    f[1][:, 0] = -f[0][:, 0]
    (warning,) = data_warnings(two, f, SIGMA)
    assert warning.startswith("the noise of tip_x_m in 0 and 1 is mostly the same")


def test_the_same_numbers_twice_are_refused(tmp_path: Path) -> None:
    for i in range(2):
        measure(tmp_path / f"{i}.csv")
    (fault,) = faults_of(ConfigError, problem, tmp_path, text(2))
    assert fault.line == 6
    assert fault.message.endswith("0.csv; a measurement may be used only once")


@pytest.mark.parametrize(("factor", "warned"), [(1.0, False), (1.5, False), (1e4, True)])
def test_a_noise_given_far_too_large(two: Problem, factor: float, warned: bool) -> None:
    given = replace(two, noise=dict.fromkeys(two.noise) | {"tip_x_m": factor * NOISE})
    f = [noise / [factor, 1.0, 1.0] for noise in residuals(0)]
    warnings = data_warnings(given, f, SIGMA * [factor, 1.0, 1.0])
    assert len(warnings) == warned
    if warned:
        assert "of the given noise, 1: is its unit right?" in warnings[0]


def test_outliers_are_named_by_file_and_line(two: Problem) -> None:
    f = residuals(0)
    f[1][10:12, 1] = 400.0
    (warning,) = data_warnings(two, f, SIGMA)
    # line 1 holds the names
    assert warning.startswith("2 values are outliers, farther than 4 times the noise from the model: ")
    assert warning.endswith("1.csv lines 12, 13")
    bare = [replace(run, measured=replace(run.measured, lines=())) for run in two.runs]
    assert data_warnings(replace(two, runs=tuple(bare)), f, SIGMA)[0].endswith("1.csv rows 11, 12")
    assert data_warnings(two, [100.0 * noise for noise in residuals(0)], SIGMA) == []  # all of them are no exceptions


def test_rounding_of_data_is_detected_and_reported(two: Problem) -> None:
    step = 2e-4
    runs = [
        replace(run, measured=replace(run.measured, values=np.round(run.measured.values / step) * step))
        for run in two.runs
    ]
    warnings = data_warnings(replace(two, runs=tuple(runs)), residuals(0), np.array([0.5 * step, 0.5 * step, 0.02]))
    assert [warning.partition(",")[0] for warning in warnings] == [
        "tip_x_m is rounded to 0.0002",
        "tip_y_m is rounded to 0.0002",
    ]
    values = runs[0].measured.values[:, 0]
    assert diagnostics.rounding(values) == pytest.approx(step, rel=1e-9)
    # Most third differences of a link at rest are 0; the noise of rounding is a step over sqrt(12).
    flat = np.repeat([0.0, step, 2.0 * step], 20)
    assert diagnostics.roughness(flat) == pytest.approx(step / np.sqrt(12.0))


def test_data_that_are_not_rounded_have_no_rounding() -> None:
    random = np.random.default_rng(0)
    assert max(diagnostics.rounding(random.standard_normal(10)) for _ in range(100)) == 0.0
