"""Compare rigid, modal and finite-element models of one config with the model of the most elements.

A model is accepted for the motion if stopping time and travel (angle at stop minus impact angle) are both within the
tolerance, and for the deflection if the peak deflection is. The verdict is the cheapest accepted model.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from granular_contact import report
from granular_contact.config import load
from granular_contact.errors import ConfigError, Fault
from granular_contact.report.drawn import saved_before
from granular_contact.report.overlay import write as write_overlay
from granular_contact.results import FINISHED, Compiling, Results
from granular_contact.results.frames import MOST
from granular_contact.results.interpolation import at_times, rates
from granular_contact.run import run, uninterrupted
from granular_contact.scene import build

MODES, ELEMENTS = (0, 1, 2, 5), (4, 8, 16, 32)
MOST_MODES, MOST_ELEMENTS = 20, 1024
EVERY_STEP = "output.interval_s=null"  # so that differences do not depend on the number of stored rows


@dataclass(frozen=True)
class Row:
    """One model: its name, results, median run time (s) and differences from the reference.

    differences: by column, relative differences of stopping time, travel and peak deflection, and root mean square
    differences (deg, m) over the common time. None if either run lacks the number.
    """

    name: str
    results: Results
    seconds: float
    differences: dict[str, float | None]

    @property
    def motion_error(self) -> float:
        """Larger of the two relative errors of the motion; infinite if one is unknown, or the run failed."""
        errors = [self.differences[key] for key in ("stopping_time_relative", "travel_relative")]
        if self.results.status.code not in FINISHED:
            return math.inf
        return max(math.inf if error is None else abs(error) for error in errors)


@dataclass(frozen=True)
class Comparison:
    """Rows in the order of the models; the last is the reference."""

    rows: tuple[Row, ...]
    tolerance: float

    @property
    def verdict(self) -> str:
        """Cheapest accepted model for the motion and for the deflection, as a sentence."""
        *models, reference = self.rows
        if reference.results.status.code not in FINISHED:
            message = reference.results.status.message
            return f"{reference.name} did not reach its end, so there is no reference: {message}"
        candidates = sorted(models, key=lambda row: row.seconds)
        limit = f"{100 * self.tolerance:g} %"
        motion = f"No model is within {limit} of {reference.name} in stopping time and travel"
        if accepted := [row for row in candidates if row.motion_error <= self.tolerance]:
            best = accepted[0]
            cost = f"{1e3 * best.seconds:.3g} ms ({reference.name}: {1e3 * reference.seconds:.3g} ms)"
            motion = (
                f"Cheapest within {limit} in stopping time and travel: {best.name}, "
                f"error {100 * best.motion_error:.2g} % in {cost}"
            )
        peaks = [(row.name, row.differences["deflection_relative"]) for row in candidates]
        accurate = [name for name, error in peaks if error is not None and abs(error) <= self.tolerance]
        return f"{motion}; for the peak deflection: {accurate[0] if accurate else 'none'}."


def models(
    path: str | PathLike[str], modes: Sequence[int], elements: Sequence[int], overrides: Sequence[str]
) -> dict[str, list[str]]:
    """Overrides of each model of a comparison, by its name; cheapest kind first, the most elements last.

    Raises
    ------
    ConfigError
        The config has a fault, a count is out of range, or the mechanism has no flexible link to compare.
    """
    faults = [
        Fault("", None, f"--{name}", f"got {n}; allowed are whole numbers from {low} to {high}")
        for name, counts, low, high in (("modes", modes, 0, MOST_MODES), ("elements", elements, 1, MOST_ELEMENTS))
        for n in counts
        if not low <= n <= high
    ]
    faults += [] if elements else [Fault("", None, "--elements", "got none; the reference needs at least one number")]
    scenario = load(path, overrides).scenario
    flexible = [name for name, body in scenario.model.all_bodies.items() if getattr(body, "flexible", None) is not None]
    links = [name for name in flexible if name in scenario.model.bodies]
    if not flexible:
        faults.append(Fault(str(path), None, "model.bodies", "no link is flexible, so there is nothing to compare"))
    elif scenario.model.in_space:
        message = "is in space, and compare is for a pendulum in the plane; here sweep method.reduced.modes"
        faults.append(Fault(str(path), None, "model", message))
    if faults:
        raise ConfigError(faults)
    reduced = {
        _counted("mode", n) if n else "rigid": [f"method={{reduced: {{modes: {n}, static: elastoplastic}}}}"]
        for n in sorted(set(modes))
    }
    beams = {
        f"FE, {_counted('element', n)}": [
            "method=engine",
            *(f"model.bodies.{link}.flexible.elements={n}" for link in links),
        ]
        for n in sorted(set(elements))
    }
    return reduced | beams


def _counted(noun: str, count: int) -> str:
    return f"{count} {noun}{'s' * (count > 1)}"


def compare(
    path: str | PathLike[str],
    modes: Sequence[int] = MODES,
    elements: Sequence[int] = ELEMENTS,
    *,
    tolerance: float = 0.01,
    overrides: Sequence[str] = (),
    repeats: int = 3,
    progress: Callable[[str], None] | None = None,
    compiling: Compiling | None = None,
) -> Comparison:
    """Run a config with every model, one warm-up and then `repeats` times to measure the run time.

    progress: called with the name of the next model; compiling: see `run`.

    Raises
    ------
    ConfigError, SceneError
        As `models`, or the mechanism has no modal reduction.
    """
    runs = []
    for name, changes in models(path, modes, elements, overrides).items():
        if progress is not None:
            progress(name)
        scenario = load(path, [*overrides, *changes, EVERY_STEP]).scenario
        scene = build(scenario)
        pictures = [0] * repeats + [MOST]
        repetitions = [uninterrupted(run(scene, scenario, most_frames=most, compiling=compiling)) for most in pictures]
        seconds = statistics.median(results.summary["cost"]["solve_s"] for results in repetitions[1:])
        runs.append((name, repetitions[-1], seconds))
    reference = runs[-1][1]
    rows = tuple(Row(name, results, seconds, _differences(results, reference)) for name, results, seconds in runs)
    return Comparison(rows, tolerance)


def _differences(results: Results, reference: Results) -> dict[str, float | None]:
    """Differences of a run from the reference, see `Row`."""

    def relative(key: str, origin: float = 0.0) -> float | None:
        value, exact = results.summary[key], reference.summary[key]
        if value is None or exact is None or exact == origin:
            return None
        return float((value - exact) / (exact - origin))

    angle = next(name for name in reference.names if name.endswith("_angle_deg"))
    return {
        "angle_rms_deg": _rms(results, reference, angle),
        "deflection_rms_m": _rms(results, reference, "deflection_m"),
        "stopping_time_relative": relative("stopping_time_s"),
        "travel_relative": relative("angle_at_stop_deg", float(reference[angle][0])),
        "deflection_relative": relative("max_deflection_m"),
    }


def _rms(results: Results, reference: Results, column: str) -> float | None:
    """Root mean square difference of a column over the common time of two runs; None if one lacks the column."""
    if not all(column in run.names for run in (results, reference)):
        return None
    end = min(results["time_s"][-1], reference["time_s"][-1])
    time = np.linspace(0.0, end, 2001)
    histories = [(run["time_s"], run[column]) for run in (results, reference)]
    values, exact = (at_times(*history, rates(*history), time) for history in histories)
    return float(np.sqrt(np.mean((values - exact) ** 2)))


def cells(row: Row) -> dict[str, str | float | None]:
    """Cells of a row of the table, by column name."""
    numbers = {key: row.results.summary[key] for key in ("stopping_time_s", "angle_at_stop_deg", "max_deflection_m")}
    return {"model": row.name, **numbers, **row.differences, "solve_s": row.seconds}


def write_runs(
    directory: Path,
    kind: str,
    rows: Iterable[Mapping[str, Any]],
    runs: Sequence[tuple[str, Results]],
    summary: dict[str, Any] | None = None,
    *,
    figures: bool,
) -> None:
    """Write the table, histories and motions of compared runs, completely or not at all; then figures.

    summary: None if no run is the reference, otherwise the last run is. The saved scenario is that of the reference, or
    of the first run.
    """
    reference, basis = ("", runs[0][1]) if summary is None else runs[-1]
    table = list(rows)
    with report.whole_folder(directory, kind) as folder:
        report.write_table(folder / f"{kind}.csv", list(table[0]), (list(row.values()) for row in table))
        (folder / report.SCENARIO).write_text(report.scenario_text(basis), encoding="utf-8")
        write_overlay(runs, folder)
        if summary is not None:
            (folder / report.SUMMARY).write_text(report.json_text(summary), encoding="utf-8")
    if figures:
        from granular_contact.report.figures.over_time import draw_runs

        with saved_before(directory):
            draw_runs(runs, directory / report.FIGURES, reference)


def write(comparison: Comparison, directory: Path, figures: bool = True) -> None:
    """Write table, verdict, scenario, histories and motions of all runs, completely or not at all; then figures.

    Parameters
    ----------
    comparison : Comparison
        The comparison.
    directory : Path
        The folder. Results of an earlier comparison in it are replaced.
    figures : bool, optional
        Whether figures are drawn.

    Raises
    ------
    OSError
        The folder cannot be written, or contains something else.
    """
    runs = [(row.name, row.results) for row in comparison.rows]
    write_runs(directory, "compare", map(cells, comparison.rows), runs, _summary(comparison), figures=figures)


def _summary(comparison: Comparison) -> dict[str, Any]:
    """Content of summary.json: verdict, tolerance, reference, energy balances, warnings and versions."""
    reference = comparison.rows[-1].results
    balances = {row.name: row.results.summary["energy"]["imbalance_relative"] for row in comparison.rows}
    return {
        "name": reference.name,
        "verdict": comparison.verdict,
        "tolerance": comparison.tolerance,
        "reference": comparison.rows[-1].name,
        "imbalance_relative": balances,
        "warnings": [f"{row.name}: {warning}" for row in comparison.rows for warning in row.results.warnings],
        "versions": reference.summary["versions"],
    }
