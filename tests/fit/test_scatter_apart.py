"""Repeated force tests in a scattering medium: scatter, sensor noise and coefficient are estimated separately."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from support_force import PLATE, estimates_of, fitted, problem, table

from granular_contact import cli
from granular_contact.errors import ConfigError
from granular_contact.laws.probe import STEADY
from granular_contact.laws.rft import GENERIC, Rft
from granular_contact.laws.scatter import Scatter
from granular_contact.sand.contact_lines import Body, polyline
from granular_contact.sand.load import GranularLoad
from granular_contact.studies.fit import fit
from granular_contact.studies.fit.scatter import correlation, standard_errors

ZETA, RELATIVE, LENGTH, NOISE = 0.9, 0.3, 0.003, 0.15  # -, -, m, N
SIDE, ROWS = 0.0532, 120
DEPTH = np.linspace(5e-4, 0.04, ROWS)


def pressed(seed: int) -> np.ndarray:
    """Force (N) on the plate of the config, pressed in step by step, in a medium that scatters with this seed."""
    load = GranularLoad(Rft(GENERIC, ZETA, scatter=Scatter(RELATIVE, LENGTH, seed)), 0.0, static=STEADY)
    half = 0.5 * SIDE
    load.add(polyline(Body("plate", [0, 1, 2]), [[-half, 0.0], [half, 0.0]], width=SIDE, strips=32))
    v, force = np.array([0.0, -0.01, 0.0]), []
    load.start(np.zeros(3))
    for i, depth in enumerate(DEPTH):
        q = np.array([0.0, -depth, 0.0])
        load.accept(float(i), q, v)
        force.append(load.force(q, v, np.zeros(3))[1])
    return np.array(force)


def text(folder: Path, count: int, first: int, scatter: bool) -> str:
    for i in range(count):
        table(folder / f"{i}.csv", "depth_m,force_N", DEPTH, pressed(first + i), noise=NOISE, seed=first + i)
    runs = ", ".join(f"{{config: {PLATE}, data: {i}.csv}}" for i in range(count))
    head = f"scatter: {str(scatter).lower()}\nloss: linear\nparameters: [medium.zeta]\n"
    return f"{head}set: {{medium: {{law: rft, zeta: 0.5}}}}\nruns: [{runs}]"


def test_the_correlation_is_that_of_the_form() -> None:
    assert correlation(np.array([0.0]))[0] == pytest.approx(1.0, abs=1e-12)
    assert correlation(np.array([2.0, 5.0])).tolist() == [0.0, 0.0]
    lags = np.linspace(0.0, 2.0, 41)
    assert np.all(np.diff(correlation(lags)) <= 1e-12)
    # Of 20 000 lattices, at random places on them.
    random = np.random.default_rng(0)
    signs, t = random.choice([-1.0, 1.0], (20_000, 4)), random.random(20_000)
    lag = 0.7
    values, values_after_lag = (_value(signs, t + x) for x in (0.0, lag))
    assert float(np.mean(values * values_after_lag)) == pytest.approx(
        correlation(np.array([lag]))[0], abs=4 / np.sqrt(20_000)
    )


def _value(signs: np.ndarray, t: np.ndarray) -> np.ndarray:
    cell, rows = np.floor(t).astype(int), np.arange(len(t))
    part = t - cell
    q = part * part * (3.0 - 2.0 * part)
    both = (1.0 - q) * signs[rows, cell] + q * signs[rows, cell + 1]
    return both / np.sqrt((1.0 - q) ** 2 + q**2)


def test_standard_error_of_the_noise_is_that_of_a_variance() -> None:
    """Without scatter ln sigma of n values has the standard error 1 / sqrt(2 n); differences add h^2 of it."""
    random, n, sigma = np.random.default_rng(3), 200, 0.1
    residual = random.standard_normal(n)
    residual *= sigma / np.sqrt(np.mean(residual**2))  # so that the likelihood is greatest at sigma
    test = np.linspace(0.0, 1.0, n), np.ones(n), residual
    logs = np.log([1e-9, 0.05, sigma])
    assert standard_errors([test], logs)[2] == pytest.approx(1.0 / np.sqrt(2.0 * n), rel=2e-3)


@pytest.mark.slow
def test_scatter_noise_and_coefficient_are_estimated_separately(tmp_path: Path) -> None:
    result = fitted(tmp_path, text(tmp_path, 4, 1, True))
    value, error = estimates_of(result)["medium.zeta"]
    assert abs(value - ZETA) < 4.0 * error
    assert result.goodness.status == "fits"
    scatter = result.scatter
    assert scatter is not None
    assert abs(scatter.length - LENGTH) < 4.0 * scatter.length_error < 0.5 * LENGTH
    assert abs(scatter.relative - RELATIVE) < 4.0 * scatter.relative_error < 0.6 * RELATIVE
    assert scatter.noise == pytest.approx(NOISE, rel=0.1)
    # What scatters is alike over grains, so that the rows are fewer than they seem, and the usual errors far too small.
    path = (tmp_path / "fit.yaml").read_text(encoding="utf-8").replace("scatter: true", "scatter: false")
    usual = fit(problem(tmp_path, path))
    assert usual.goodness.status == "misfit"
    assert estimates_of(usual)["medium.zeta"][1] < 0.7 * error


def test_a_fit_of_data_without_scatter_estimates_none(tmp_path: Path) -> None:
    force = 2550.0 * DEPTH
    table(tmp_path / "0.csv", "depth_m,force_N", DEPTH, force, noise=NOISE)
    head = "scatter: true\nparameters: [medium.zeta]\nset: {medium: {law: rft, zeta: 0.5}}\n"
    result = fitted(tmp_path, f"{head}runs: [{{config: {PLATE}, data: 0.csv}}]")
    assert result.scatter is not None
    assert result.scatter.force < 0.005
    assert result.scatter.noise == pytest.approx(NOISE, rel=0.2)


@pytest.mark.slow
def test_the_medium_that_is_written_scatters(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text(tmp_path, 2, 11, True)
    files = [str(tmp_path / f"{i}.csv") for i in range(2)]
    arguments = ["fit", str(PLATE), *files, "--parameters", "medium.zeta", "--set", "medium=rft_generic", "--scatter"]
    out = tmp_path / "out"
    assert cli.main([*arguments, "--starts", "1", "--workers", "1", "--no-plots", "--out", str(out)]) == 0
    assert "scatter of the force" in capsys.readouterr().out
    record = json.loads((out / "fit.json").read_text(encoding="utf-8"))["scatter"]
    medium = yaml.safe_load((out / "medium.yaml").read_text(encoding="utf-8"))
    assert medium["scatter"]["relative"] == pytest.approx(record["relative"], rel=0.01)
    assert medium["scatter"]["length_m"] == pytest.approx(record["length_m"], rel=0.01)


def test_scatter_fits_need_a_column_of_the_path(tmp_path: Path) -> None:
    table(tmp_path / "0.csv", "speed_m_s,force_N", np.linspace(0.1, 0.5, 9), np.full(9, 3.0), noise=0.1)
    head = "scatter: true\nparameters: [medium.zeta]\nforce_test: {direction: right, depth_m: 0.05}\n"
    with pytest.raises(ConfigError, match="does not determine the path of the body; allowed is a column path_length_m"):
        problem(tmp_path, f"{head}set: {{medium: rft_generic}}\nruns: [{{config: {PLATE}, data: 0.csv}}]")
