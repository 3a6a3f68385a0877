"""Fit -> a folder: fit.json, medium.yaml, residuals.csv and figures, there whole or not at all.

Fit -> the fitted medium, with the provenance of its numbers and the range of the data.
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
from granular_contact.studies.fit.fitting import MEDIUM, Fit, carrier, fitted
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
    """Write a fit to `directory`, in place of an earlier fit's results there.

    Raises
    ------
    OSError
        The disk refuses, or the folder holds something else.
    """
    with whole_folder(directory, "fit") as folder:
        (folder / FIT).write_text(json_text(summary(fit)), encoding="utf-8")
        for name, found in media(fit).items():
            (folder / name).write_text(_header(fit, name) + yaml_text(found), encoding="utf-8")
        prescribed = list(dict.fromkeys(name for run in fit.problem.runs for name in run.measured.given))
        write_table(folder / RESIDUALS, [*HEAD, *prescribed], _residual_rows(fit, prescribed))
    if figures:
        with saved_before(directory):
            _draw(fit, directory / FIGURES)


def _header(fit: Fit, name: str) -> str:
    lines = [f"Written by {PROGRAM} {__version__}; in a config: medium: path/to/{name}"]
    shared = [one for one in fit.uncertainty.estimates if one.parameter.shared]
    lines += [f"{one.parameter.label}: {one.value:.6g} +- {one.error:.2g}" for one in shared]
    lines += fit.warnings
    return "".join(f"# {line}\n" for line in lines)


def summary(fit: Fit) -> dict[str, Any]:
    """Content of fit.json: plain data, SI units and degrees as in the names of the columns."""
    problem, known, good = fit.problem, fit.uncertainty, fit.goodness
    labels = [p.label for p in problem.parameters]
    return {
        "name": problem.name,
        "status": good.status,
        "converged": fit.solution.converged,
        "warnings": list(fit.warnings),
        "parameters": {one.parameter.label: _estimate(one, problem) for one in known.estimates},
        "correlation": {"labels": labels, "matrix": known.correlation.tolist()},
        "directions": [{"relative_error": size, "parts": parts} for size, parts in known.directions],
        "goodness": _goodness(good),
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


def _estimate(one: Estimate, problem: Problem) -> dict[str, Any]:
    """A parameter: its value, how sure it is, and what it was looked for in."""
    return {
        "value": one.value,
        "standard_error": one.error,
        "interval_95": [one.low, one.high],
        "bounds": [one.parameter.low, one.parameter.high],
        "start": one.parameter.start,
        "scale": "log" if one.parameter.log else "linear",
        "at_bound": bool(one.at_bound),
        "runs": [problem.runs[i].name for i in one.parameter.runs],
    }


def _goodness(good: Goodness) -> dict[str, Any]:
    """How the residuals compare with noise, of all data and of each column."""
    return {
        "degrees_of_freedom": good.degrees_of_freedom,
        "reduced_chi_square": good.reduced_chi_square,
        "ljung_box_probability": good.ljung_box,
        "outlier_share": good.outliers,
        "reduced_chi_square_without_outliers": good.without_outliers,
        "columns": {
            one.column: {key: value for key, value in vars(one).items() if key != "column"} for one in good.columns
        },
    }


def _scatter(fit: Fit) -> dict[str, Any]:
    """Scatter of the grains, where it was separated from noise."""
    one = fit.scatter
    if one is None:
        return {}
    return {
        "scatter": {
            "of_the_force": one.force,
            "of_the_force_error": one.force_error,
            "relative": one.relative,
            "relative_error": one.relative_error,
            "length_m": one.length,
            "length_error_m": one.length_error,
            "noise": one.noise,
        }
    }


def _force_test(run: MeasuredRun) -> dict[str, Any]:
    """What is kept of a force test; nothing of a run."""
    model = run.simulator
    if not isinstance(model, LawAlone):
        return {}
    spans = {name: [float(one.min()), float(one.max())] for name, one in run.measured.given.items()}
    return {"force_test": model.test.model_dump(exclude_defaults=True) | {"prescribed": spans}}


def _residual_rows(fit: Fit, prescribed: list[str]) -> Iterator[list[Any]]:
    """One row for each measured value: run, column, time, data, model, residual in units of the noise.

    In force tests what was prescribed stands behind it, and there is no time.
    """
    sigma = dict(zip(fit.problem.columns, fit.solution.sigma, strict=True))
    for run, residuals in zip(fit.problem.runs, fit.residuals, strict=True):
        held, blank = run.measured, [""] * len(residuals)
        clock = blank if held.given else held.time.tolist()
        given = [held.given[one].tolist() if one in held.given else blank for one in prescribed]
        for k, column in enumerate(held.columns):
            data, rest = held.values[:, k], residuals[:, k]
            scaled = [f"{x:.4f}" for x in rest / sigma[column]]
            for cells in zip(clock, data.tolist(), (data - rest).tolist(), scaled, *given, strict=True):
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
        held = run.measured
        noise = np.array([sigma[column] for column in held.columns])
        arrays = held.values, residuals, model, width
        runs.append(RunPicture(run.name, held.columns, noise, quantile, *arrays, *_axis(held, time)))
    shared = [j for j, p in enumerate(problem.parameters) if p.shared]
    ones = [fit.uncertainty.estimates[j] for j in shared]
    estimates = [(_short(one.parameter), one.value, one.error) for one in ones]
    correlation = fit.uncertainty.correlation[np.ix_(shared, shared)]
    draw(runs, estimates, correlation, fit.goodness.status == "misfit", folder)


_AXES = ((DEPTH, "depth in the table", "m"), (SPEED, "speed", "m/s"), (RATE, "rate", "rad/s"))


def _axis(held: Measured, time: Vector) -> tuple[Vector, Vector, str, str]:
    """What a run is drawn over, at its rows and at other times (s), with label and unit.

    That is time, or of a force test what was varied most.
    """
    for name, label, unit in _AXES if held.given else ():
        given = held.given.get(name)
        if given is not None and np.ptp(given) > 0.0:
            return given, np.interp(time, held.time, given), label, unit
    return held.time, time, *(("row", "") if held.given else ("time of the measurement", "s"))


def _short(parameter: Parameter) -> str:
    """The key without the common prefix of the keys of a medium."""
    return ".".join(parameter.key).removeprefix("medium.").removeprefix("plunging.")


PROVENANCE = "fitted"


def media(fit: Fit) -> dict[str, dict[str, Any]]:
    """Media of the run that has all the fitted coefficients, as configs have them, by the names of their files.

    Of several media that add up, those of which something was fitted.
    """
    held = carrier(fit.problem)
    shared = [p.key for p in fitted(fit.problem) if held in p.runs]
    if not shared:
        return {}
    acting = sorted({i for p in fitted(fit.problem) for i in p.runs})
    runs = [fit.problem.runs[i] for i in acting]
    carrying = fit.problem.runs[held]
    found = scenario_to_dict(carrying.simulator.load(_values(fit, carrying)).scenario)[MEDIUM]
    if not isinstance(found, list):
        return {f"{MEDIUM}.yaml": _described(fit, found, [key[1:] for key in shared], runs)}
    return {
        f"{MEDIUM}_{index}.yaml": _described(fit, found[int(index)], [k[2:] for k in shared if k[1] == index], runs)
        for index in sorted({key[1] for key in shared})
    }


def _described(fit: Fit, found: dict[str, Any], keys: list[Key], runs: list[MeasuredRun]) -> dict[str, Any]:
    """A medium with its new source and range in the place of the old ones."""
    names = ", ".join(map(".".join, keys))
    files = sorted({run.measured.file for run in runs})
    listed = ", ".join(files[:4]) + (f" and {len(files) - 4} more" if len(files) > 4 else "")
    what = "force test" if all(isinstance(run.simulator, LawAlone) for run in runs) else "run"
    source = f"{names} fitted by {PROGRAM} {__version__} to {len(runs)} {what}{'s' * (len(runs) > 1)} ({listed})"
    if fit.goodness.status == "misfit":
        source += "; misfit: this law does not describe these data"
    kept = {key: value for key, value in found.items() if key != "standing"}  # that of the numbers before
    new = {"name": f"{found.get('name') or MEDIUM}_fitted", "source": source}
    found = kept | new | {"provenance": PROVENANCE, "range": seen(fit, runs)}
    grains = fit.scatter
    if grains is None:
        return found
    size, length = float(f"{grains.relative:.3g}"), float(f"{grains.length:.3g}")
    return found | {"scatter": {"relative": min(size, MOST), "length_m": length, "seed": 1}}


def _values(fit: Fit, run: MeasuredRun) -> tuple[float, ...]:
    """Best values of the parameters that act on a run."""
    return tuple(float(fit.values[i]) for i in run.acting)


def seen(fit: Fit, runs: list[MeasuredRun]) -> dict[str, list[float]]:
    """Speeds (m/s) and depths (m) of what met the medium, and its diameters or widths (m): least, greatest."""
    speeds, depths, sizes = list[float](), list[float](), list[float]()
    for run in runs:
        model, values = run.simulator, _values(fit, run)
        own = model.seen(values) if isinstance(model, LawAlone) else _seen_of_run(run, model.results(values))
        speeds += own[0]
        depths += own[1]
        sizes += own[2]
    spans = {"speed_m_s": speeds, "depth_m": depths, "size_m": sizes}
    return {key: _span(values) for key, values in spans.items() if values}


def _seen_of_run(run: MeasuredRun, results: Results) -> tuple[list[float], list[float], list[float]]:
    """Of the tip in the medium, over the time of the data."""
    time = results["time_s"]
    wet = (results["depth_m"] >= 0.0) & (time <= run.measured.time[-1] - run.measured.time[0] + time[1])
    speed = np.hypot(np.gradient(results["tip_x_m"], time), np.gradient(results["tip_y_m"], time))
    speeds = [float(speed[wet].min()), float(speed[wet].max())]
    return speeds, [0.0, float(results["depth_m"][wet].max())], list(results.sizes)


def _span(values: list[float]) -> list[float]:
    return [float(f"{min(values):.4g}"), float(f"{max(values):.4g}")]
