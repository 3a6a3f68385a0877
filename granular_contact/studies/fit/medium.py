"""Fit -> the fitted medium, with the provenance of its numbers and the range of the data."""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.config import scenario_to_dict
from granular_contact.laws.scatter import MOST
from granular_contact.results import Results
from granular_contact.studies.fit.fitting import Fit
from granular_contact.studies.fit.law_alone import LawAlone
from granular_contact.studies.fit.media_of_runs import MEDIUM, carrier, fitted
from granular_contact.studies.fit.problem import MeasuredRun
from granular_contact.studies.fit.responses import Key

PROVENANCE = "fitted"


def media(fit: Fit, program: str) -> dict[str, dict[str, Any]]:
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
        return {f"{MEDIUM}.yaml": _described(fit, found, [key[1:] for key in shared], runs, program)}
    return {
        f"{MEDIUM}_{index}.yaml": _described(
            fit, found[int(index)], [k[2:] for k in shared if k[1] == index], runs, program
        )
        for index in sorted({key[1] for key in shared})
    }


def _described(
    fit: Fit, found: dict[str, Any], keys: list[Key], runs: list[MeasuredRun], program: str
) -> dict[str, Any]:
    """A medium with its new source and range in the place of the old ones."""
    names = ", ".join(map(".".join, keys))
    files = sorted({run.measured.file for run in runs})
    listed = ", ".join(files[:4]) + (f" and {len(files) - 4} more" if len(files) > 4 else "")
    what = "force test" if all(isinstance(run.simulator, LawAlone) for run in runs) else "run"
    source = f"{names} fitted by {program} to {len(runs)} {what}{'s' * (len(runs) > 1)} ({listed})"
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


def results_of(fit: Fit, run: MeasuredRun) -> Results:
    """The whole run with the best parameters."""
    return run.simulator.results(_values(fit, run))


def seen(fit: Fit, runs: list[MeasuredRun]) -> dict[str, list[float]]:
    """Speeds (m/s) and depths (m) of what met the medium, and its diameters or widths (m): least, greatest."""
    speeds, depths, sizes = list[float](), list[float](), list[float]()
    for run in runs:
        model, values = run.simulator, _values(fit, run)
        own = model.seen(values) if isinstance(model, LawAlone) else _seen_of_run(run, results_of(fit, run))
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
