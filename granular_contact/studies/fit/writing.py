"""Write a fit to a folder, completely or not at all: fit.json, medium.yaml, residuals.csv and figures.

The fitted medium is written with the provenance of its numbers and the range of the data.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from granular_contact import __version__
from granular_contact.config import scenario_to_dict
from granular_contact.laws.scatter import MOST
from granular_contact.report import FIGURES, FIT, PROGRAM, RESIDUALS, json_text, whole_folder, write_table, yaml_text
from granular_contact.report.drawn import saved_before
from granular_contact.results import Results
from granular_contact.results.summary import versions
from granular_contact.studies.fit.fitting import MEDIUM, Fit, fitted, reference_run
from granular_contact.studies.fit.goodness import Goodness
from granular_contact.studies.fit.law_alone import LawAlone
from granular_contact.studies.fit.measurements import DEPTH, RATE, SPEED, Measured
from granular_contact.studies.fit.problem import MeasuredRun, Parameter, Problem
from granular_contact.studies.fit.responses import Key
from granular_contact.studies.fit.solve import jacobian
from granular_contact.studies.fit.uncertainty import Estimate, band
from granular_contact.values.arrays import Vector

BAND_POINTS = 241
HEAD = ("run", "column", "time_s", "data", "model", "residual_over_noise")


def write(fit: Fit, directory: Path, figures: bool = True) -> None:
    """Write a fit to a folder: fit.json, the fitted medium, residuals.csv and figures.

    Parameters
    ----------
    fit : Fit
        The fit.
    directory : Path
        The folder. Results of an earlier fit in it are replaced, by all new files at once.
    figures : bool, optional
        Whether figures are drawn, after the other files are saved.

    Raises
    ------
    OSError
        The folder cannot be written, or contains something else.
    """
    with whole_folder(directory, "fit") as folder:
        (folder / FIT).write_text(json_text(summary(fit)), encoding="utf-8")
        for name, medium in media(fit).items():
            (folder / name).write_text(_header(fit, name) + yaml_text(medium), encoding="utf-8")
        prescribed = list(dict.fromkeys(name for run in fit.problem.runs for name in run.measured.prescribed))
        write_table(folder / RESIDUALS, [*HEAD, *prescribed], _residual_rows(fit, prescribed))
    if figures:
        with saved_before(directory):
            _draw(fit, directory / FIGURES)


def _header(fit: Fit, name: str) -> str:
    lines = [f"Written by {PROGRAM} {__version__}; in a config: medium: path/to/{name}"]
    shared = [estimate for estimate in fit.uncertainty.estimates if estimate.parameter.shared]
    lines += [f"{estimate.parameter.label}: {estimate.value:.6g} +- {estimate.error:.2g}" for estimate in shared]
    lines += fit.warnings
    return "".join(f"# {line}\n" for line in lines)


def summary(fit: Fit) -> dict[str, Any]:
    """Content of fit.json: plain data, in SI units, and degrees where the name of a column says so."""
    problem, uncertainty = fit.problem, fit.uncertainty
    labels = [parameter.label for parameter in problem.parameters]
    return {
        "name": problem.name,
        "status": fit.goodness.status,
        "converged": fit.solution.converged,
        "warnings": list(fit.warnings),
        "parameters": {estimate.parameter.label: _estimate(estimate, problem) for estimate in uncertainty.estimates},
        "correlation": {"labels": labels, "matrix": uncertainty.correlation.tolist()},
        "directions": [{"relative_error": size, "parts": parts} for size, parts in uncertainty.directions],
        "goodness": _goodness(fit.goodness),
        **_scatter(fit),
        "runs": [
            {
                "name": run.name,
                "data": run.measured.file,
                "rows": len(run.measured.time),
                "columns": list(run.measured.columns),
                "unused_columns": list(run.measured.unused),
                **_force_test(run),
            }
            for run in problem.runs
        ],
        "solver": {
            "loss": problem.loss,
            "starts": len(fit.solution.starts),
            "starts_agreeing": fit.agreeing,
            "seed": problem.seed,
        },
        "versions": versions(),
    }


def _estimate(estimate: Estimate, problem: Problem) -> dict[str, Any]:
    """Value, standard error, search range and runs of a parameter."""
    parameter = estimate.parameter
    return {
        "value": estimate.value,
        "standard_error": estimate.error,
        "interval_95": [estimate.low, estimate.high],
        "bounds": [parameter.low, parameter.high],
        "start": parameter.start,
        "scale": "log" if parameter.log else "linear",
        "at_bound": bool(estimate.at_bound),
        "runs": [problem.runs[i].name for i in parameter.runs],
    }


def _goodness(goodness: Goodness) -> dict[str, Any]:
    """Goodness of fit of all data and of each column."""
    return {
        "degrees_of_freedom": goodness.degrees_of_freedom,
        "reduced_chi_square": goodness.reduced_chi_square,
        "ljung_box_probability": goodness.ljung_box,
        "outlier_share": goodness.outliers,
        "reduced_chi_square_without_outliers": goodness.without_outliers,
        "columns": {
            column.column: {key: value for key, value in vars(column).items() if key != "column"}
            for column in goodness.columns
        },
    }


def _scatter(fit: Fit) -> dict[str, Any]:
    """Scatter of the grains; empty if it was not separated from noise."""
    scatter = fit.scatter
    if scatter is None:
        return {}
    return {
        "scatter": {
            "of_the_force": scatter.force,
            "of_the_force_error": scatter.force_error,
            "relative": scatter.relative,
            "relative_error": scatter.relative_error,
            "length_m": scatter.length,
            "length_error_m": scatter.length_error,
            "noise": scatter.noise,
        }
    }


def _force_test(run: MeasuredRun) -> dict[str, Any]:
    """Options and prescribed ranges of a force test; empty for a run."""
    model = run.simulator
    if not isinstance(model, LawAlone):
        return {}
    spans = {name: [float(values.min()), float(values.max())] for name, values in run.measured.prescribed.items()}
    return {"force_test": model.test.model_dump(exclude_defaults=True) | {"prescribed": spans}}


def _residual_rows(fit: Fit, prescribed: list[str]) -> Iterator[list[Any]]:
    """Yield a row for each measured value: run, column, time, data, model, residual in units of the noise.

    Rows of force tests have no time; the prescribed quantities follow.
    """
    sigma = dict(zip(fit.problem.columns, fit.solution.sigma, strict=True))
    for run, residuals in zip(fit.problem.runs, fit.residuals, strict=True):
        measured, blank = run.measured, [""] * len(residuals)
        time = blank if measured.prescribed else measured.time.tolist()
        columns = measured.prescribed
        prescribed_cells = [columns[name].tolist() if name in columns else blank for name in prescribed]
        for k, column in enumerate(measured.columns):
            data, residual = measured.values[:, k], residuals[:, k]
            scaled = [f"{x:.4f}" for x in residual / sigma[column]]
            for cells in zip(time, data.tolist(), (data - residual).tolist(), scaled, *prescribed_cells, strict=True):
                yield [run.name, column, *cells]


def _draw(fit: Fit, folder: Path) -> None:
    from granular_contact.report.figures.fits import RunPicture, draw

    problem, scaled = fit.problem, fit.solution.scaled
    times = [np.linspace(time[0], time[-1], BAND_POINTS) for time in problem.times()]
    models = problem.split(problem.model(scaled, times), times)
    widths = problem.split(band(fit.uncertainty, jacobian(problem, scaled, times)), times)
    sigma, quantile = dict(zip(problem.columns, fit.solution.sigma, strict=True)), fit.uncertainty.quantile
    runs = []
    for run, residuals, model, width, time in zip(problem.runs, fit.residuals, models, widths, times, strict=True):
        measured = run.measured
        noise = np.array([sigma[column] for column in measured.columns])
        arrays = measured.values, residuals, model, width
        runs.append(RunPicture(run.name, measured.columns, noise, quantile, *arrays, *_axis(measured, time)))
    shared = [j for j, parameter in enumerate(problem.parameters) if parameter.shared]
    estimates = [fit.uncertainty.estimates[j] for j in shared]
    values = [(_short(estimate.parameter), estimate.value, estimate.error) for estimate in estimates]
    correlation = fit.uncertainty.correlation[np.ix_(shared, shared)]
    draw(runs, values, correlation, fit.goodness.status == "misfit", folder)


_AXES = ((DEPTH, "depth in the table", "m"), (SPEED, "speed", "m/s"), (RATE, "rate", "rad/s"))


def _axis(measured: Measured, time: Vector) -> tuple[Vector, Vector, str, str]:
    """Abscissa of the figure of a run, at its rows and at other times (s), with label and unit.

    It is time, or for a force test the first prescribed quantity of `_AXES` that varies.
    """
    for name, label, unit in _AXES if measured.prescribed else ():
        values = measured.prescribed.get(name)
        if values is not None and np.ptp(values) > 0.0:
            return values, np.interp(time, measured.time, values), label, unit
    return measured.time, time, *(("row", "") if measured.prescribed else ("time of the measurement", "s"))


def _short(parameter: Parameter) -> str:
    """Key of a parameter without the common prefixes of a medium."""
    return ".".join(parameter.key).removeprefix("medium.").removeprefix("plunging.")


PROVENANCE = "fitted"


def media(fit: Fit) -> dict[str, dict[str, Any]]:
    """Fitted media as plain YAML data, by file name: those of `reference_run`.

    Of several media that add up, only those with fitted coefficients are included.
    """
    reference = reference_run(fit.problem)
    shared = [parameter.key for parameter in fitted(fit.problem) if reference in parameter.runs]
    if not shared:
        return {}
    fitted_runs = sorted({i for parameter in fitted(fit.problem) for i in parameter.runs})
    runs = [fit.problem.runs[i] for i in fitted_runs]
    run = fit.problem.runs[reference]
    plain = scenario_to_dict(run.simulator.load(_values(fit, run)).scenario)[MEDIUM]
    if not isinstance(plain, list):
        return {f"{MEDIUM}.yaml": _described(fit, plain, [key[1:] for key in shared], runs)}
    return {
        f"{MEDIUM}_{index}.yaml": _described(
            fit, plain[int(index)], [key[2:] for key in shared if key[1] == index], runs
        )
        for index in sorted({key[1] for key in shared})
    }


def _described(fit: Fit, medium: dict[str, Any], keys: list[Key], runs: list[MeasuredRun]) -> dict[str, Any]:
    """A medium with its source and range replaced by those of the fit."""
    names = ", ".join(map(".".join, keys))
    files = sorted({run.measured.file for run in runs})
    listed = ", ".join(files[:4]) + (f" and {len(files) - 4} more" if len(files) > 4 else "")
    noun = "force test" if all(isinstance(run.simulator, LawAlone) for run in runs) else "run"
    source = f"{names} fitted by {PROGRAM} {__version__} to {len(runs)} {noun}{'s' * (len(runs) > 1)} ({listed})"
    if fit.goodness.status == "misfit":
        source += "; misfit: this law does not describe these data"
    kept = {
        key: value for key, value in medium.items() if key != "standing"
    }  # it belongs to the numbers before the fit
    new = {"name": f"{medium.get('name') or MEDIUM}_fitted", "source": source}
    described = kept | new | {"provenance": PROVENANCE, "range": measured_range(fit, runs)}
    scatter = fit.scatter
    if scatter is None:
        return described
    size, length = float(f"{scatter.relative:.3g}"), float(f"{scatter.length:.3g}")
    return described | {"scatter": {"relative": min(size, MOST), "length_m": length, "seed": 1}}


def _values(fit: Fit, run: MeasuredRun) -> tuple[float, ...]:
    """Best values of the parameters that act on a run."""
    return tuple(float(fit.values[i]) for i in run.acting)


def measured_range(fit: Fit, runs: list[MeasuredRun]) -> dict[str, list[float]]:
    """Range (least, greatest) of speeds (m/s), depths (m) and diameters or widths (m) in the medium."""
    speeds, depths, sizes = list[float](), list[float](), list[float]()
    for run in runs:
        model, values = run.simulator, _values(fit, run)
        if isinstance(model, LawAlone):
            run_speeds, run_depths, run_sizes = model.ranges(values)
        else:
            run_speeds, run_depths, run_sizes = _range_of_run(run, model.results(values))
        speeds += run_speeds
        depths += run_depths
        sizes += run_sizes
    spans = {"speed_m_s": speeds, "depth_m": depths, "size_m": sizes}
    return {key: _span(values) for key, values in spans.items() if values}


def _range_of_run(run: MeasuredRun, results: Results) -> tuple[list[float], list[float], list[float]]:
    """Speeds and depths of the tip in the medium during the time of the data, and sizes."""
    time = results["time_s"]
    immersed = (results["depth_m"] >= 0.0) & (time <= run.measured.time[-1] - run.measured.time[0] + time[1])
    speed = np.hypot(np.gradient(results["tip_x_m"], time), np.gradient(results["tip_y_m"], time))
    speeds = [float(speed[immersed].min()), float(speed[immersed].max())]
    return speeds, [0.0, float(results["depth_m"][immersed].max())], list(results.sizes)


def _span(values: list[float]) -> list[float]:
    return [float(f"{min(values):.4g}"), float(f"{max(values):.4g}")]
