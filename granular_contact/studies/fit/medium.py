"""Fit -> the fitted medium, with the provenance of its numbers and the range of the data."""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.results import Results
from granular_contact.studies.fit.fitting import Fit
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
    runs = [(fit.problem.runs[i], results_of(fit, fit.problem.runs[i])) for i in acting]
    found = runs[acting.index(held)][1].scenario[MEDIUM]
    if not isinstance(found, list):
        return {f"{MEDIUM}.yaml": _described(fit, found, [key[1:] for key in shared], runs, program)}
    return {
        f"{MEDIUM}_{index}.yaml": _described(
            fit, found[int(index)], [k[2:] for k in shared if k[1] == index], runs, program
        )
        for index in sorted({key[1] for key in shared})
    }


def _described(
    fit: Fit, found: dict[str, Any], keys: list[Key], runs: list[tuple[MeasuredRun, Results]], program: str
) -> dict[str, Any]:
    """A medium with its new source and range in the place of the old ones."""
    names = ", ".join(map(".".join, keys))
    files = sorted({run.measured.file for run, _ in runs})
    listed = ", ".join(files[:4]) + (f" and {len(files) - 4} more" if len(files) > 4 else "")
    source = f"{names} fitted by {program} to {len(runs)} run{'s' * (len(runs) > 1)} ({listed})"
    if fit.goodness.status == "misfit":
        source += "; misfit: this law does not describe these data"
    kept = {key: value for key, value in found.items() if key != "standing"}  # that of the numbers before
    new = {"name": f"{found.get('name') or MEDIUM}_fitted", "source": source}
    return kept | new | {"provenance": PROVENANCE, "range": seen(runs)}


def results_of(fit: Fit, run: MeasuredRun) -> Results:
    """The whole run with the best parameters."""
    return run.simulator.results(tuple(float(fit.values[i]) for i in run.acting))


def seen(runs: list[tuple[MeasuredRun, Results]]) -> dict[str, list[float]]:
    """Speeds of the tip in the medium (m/s), depths (m) and diameters or widths (m) that met it: least, greatest."""
    speeds, depths, sizes = list[float](), list[float](), list[float]()
    for run, results in runs:
        time = results["time_s"]
        wet = (results["depth_m"] >= 0.0) & (time <= run.measured.time[-1] - run.measured.time[0] + time[1])
        speed = np.hypot(np.gradient(results["tip_x_m"], time), np.gradient(results["tip_y_m"], time))
        speeds += [float(speed[wet].min()), float(speed[wet].max())]
        depths += [0.0, float(results["depth_m"][wet].max())]
        sizes += results.sizes
    return {
        "speed_m_s": _span(speeds),
        "depth_m": _span(depths),
        "size_m": _span(sizes),
    }


def _span(values: list[float]) -> list[float]:
    return [float(f"{min(values):.4g}"), float(f"{max(values):.4g}")]
