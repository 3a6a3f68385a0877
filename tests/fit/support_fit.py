"""Measurements made by runs of known coefficients, as the files that a user has."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from support_runs import CONFIGS, simulate

from granular_contact.studies.fit import Fit, fit, load_specification, prepare
from granular_contact.studies.fit.problem import Problem

Vector = NDArray[np.float64]

CONFIG = CONFIGS / "pendulum.yaml"
RIGID = "method={reduced: {modes: 0}}"
TIP = ("tip_x_m", "tip_y_m")
NOISE = 1e-4  # m: of the source's motion capture
FRAME = 2e-3  # s
Cases = Sequence[tuple[float, float]]
FOUR: Cases = ((22.0, 1.75), (22.0, 4.66), (61.5, 2.70), (61.5, 9.17))  # the source's slowest and fastest at two angles
TWO: Cases = (FOUR[0], FOUR[3])
TRUE = {"medium.eta_d": 6.5, "medium.eta_h": 8.0, "medium.plunging.eta_v": 22.0, "medium.plunging.lambda": 1.1}


@cache
def curve(columns: tuple[str, ...], *overrides: str) -> tuple[CubicSpline, float]:
    """Exact columns of a run, and its end (s)."""
    results = simulate("pendulum", *overrides)
    return CubicSpline(results["time_s"], np.column_stack([results[c] for c in columns])), results["time_s"][-1]


def start(case: tuple[float, float]) -> tuple[str, str]:
    """Overrides for an impact angle (deg) and speed (rad/s)."""
    return f"initial.impact_angle_deg={case[0]}", f"initial.impact_speed_rad_s={case[1]}"


def measure(
    file: Path,
    *overrides: str,
    columns: tuple[str, ...] = TIP,
    noise: float = NOISE,
    seed: int = 0,
    end: float = 0.1,
    offset: float = 0.0,
    factor: float = 1.0,
    head: str | None = None,
) -> Path:
    """Write the CSV file of a camera: a row every 2 ms, on a clock `offset` (s) ahead, values times `factor`."""
    exact, last = curve(columns, *(overrides or (RIGID,)))
    time = np.arange(0.0, end, FRAME)
    values = exact(np.minimum(time, last))
    values = (values + noise * np.random.default_rng(seed).standard_normal(values.shape)) * factor
    rows = np.column_stack([time + offset, values]).tolist()
    lines = [head or ",".join(("time_s", *columns)), *(",".join(map(repr, row)) for row in rows)]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def four(folder: Path, *overrides: str, seed: int = 0, noise: float = NOISE, cases: Cases = FOUR) -> str:
    """Files of four impacts with the overrides (the rigid model unless given), and the `runs` of a fit file of them.

    cases: these in their place.
    """
    lines = ["runs:"]
    for i, case in enumerate(cases):
        file = measure(folder / f"{i}.csv", *start(case), *(overrides or (RIGID,)), seed=10 * seed + i, noise=noise)
        angle, speed = case
        lines.append(f"  - {{config: {CONFIG}, data: {file.name}, set: {{initial.impact_angle_deg: {angle}, ")
        lines[-1] += f"initial.impact_speed_rad_s: {speed}}}}}"
    return "\n".join(lines)


def problem(folder: Path, text: str) -> Problem:
    """Problem of a fit file of this text; the rigid model from one start, unless it says otherwise."""
    if "set:" not in text.split("runs:")[0]:
        text = f"set: {{method.reduced.modes: 0}}\n{text}"
    if "starts:" not in text:
        text = f"starts: 1\n{text}"
    path = folder / "fit.yaml"
    path.write_text(text, encoding="utf-8")
    return prepare(load_specification(path))


def fitted(folder: Path, text: str) -> Fit:
    return fit(problem(folder, text))


def near(fit: Fit, labels: Sequence[str] = tuple(TRUE)) -> list[float]:
    """Distances of estimates from the true values, in their own standard errors."""
    by_label = {estimate.parameter.label: estimate for estimate in fit.uncertainty.estimates}
    return [abs(by_label[label].value - TRUE[label]) / by_label[label].error for label in labels]
