"""Fit -> the medium found, with where its numbers come from and the range of the data."""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.fit.fitting import Fit
from granular_contact.fit.problem import Run
from granular_contact.results import Results

PROVENANCE = "fitted"


def medium(fit: Fit, program: str) -> dict[str, Any] | None:
    """The medium of the first run with the fitted values, as a config has it; None if nothing of it was fitted."""
    shared = [p for p in fit.problem.parameters if p.key[0] == "medium" and p.shared]
    if not shared:
        return None
    runs = [(run, results_of(fit, run)) for run in fit.problem.runs]
    found: dict[str, Any] = runs[0][1].scenario["medium"]
    names = ", ".join(".".join(p.key[1:]) for p in shared)
    files = sorted({run.measured.file for run in fit.problem.runs})
    listed = ", ".join(files[:4]) + (f" and {len(files) - 4} more" if len(files) > 4 else "")
    ends = [
        found.get("name") or "medium",
        f"{names} fitted by {program} to {len(runs)} run{'s' * (len(runs) > 1)} ({listed})",
    ]
    if fit.goodness.status == "misfit":
        ends.append("misfit: this law does not describe these data")
    return found | {
        "name": f"{ends[0]}_fitted",
        "source": "; ".join(ends[1:]),
        "provenance": PROVENANCE,
        "range": seen(runs),
    }


def results_of(fit: Fit, run: Run) -> Results:
    """The whole run with the best parameters."""
    return run.simulator.results(tuple(float(fit.values[i]) for i in run.acting))


def seen(runs: list[tuple[Run, Results]]) -> dict[str, list[float]]:
    """Speeds of the tip in the medium (m/s), depths (m) and diameters (m) that met it, least and greatest."""
    speeds, depths, diameters = list[float](), list[float](), list[float]()
    for run, results in runs:
        time = results["time_s"]
        wet = (results["depth_m"] >= 0.0) & (time <= run.measured.time[-1] - run.measured.time[0] + time[1])
        speed = np.hypot(np.gradient(results["tip_x_m"], time), np.gradient(results["tip_y_m"], time))
        speeds += [float(speed[wet].min()), float(speed[wet].max())]
        depths += [0.0, float(results["depth_m"][wet].max())]
        diameters += _diameters(results)
    return {
        "speed_m_s": _span(speeds),
        "depth_m": _span(depths),
        "diameter_m": _span(diameters),
    }


def _diameters(results: Results) -> list[float]:
    """Of the bars that reach below the surface."""
    surface = results.surface if results.surface is not None else np.inf
    deepest = next(shot for shot in results.snapshots if shot.label == "deepest")
    return [one.diameter for one in deepest.outlines if len(one.points) > 1 and one.points[:, 1].min() < surface]


def _span(values: list[float]) -> list[float]:
    return [float(f"{min(values):.4g}"), float(f"{max(values):.4g}")]
