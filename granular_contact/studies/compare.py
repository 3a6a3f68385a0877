"""Compare rigid and modal models of one config, and models with several numbers of elements, with the finest of them.

A model is accepted for the motion if its errors are within the tolerance: in the plane those of stopping time and
travel (angle at stop minus impact angle) of a pendulum, in space the greatest distance of the tip from its place in the
reference, over the longest path of a body. It is accepted for the deflection if the peak deflection is within the
tolerance. The verdict is the cheapest accepted model.
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
from granular_contact.scene.types import Vector

MODES, ELEMENTS = (0, 1, 2, 5), (4, 8, 16, 32)
MOST_MODES, MOST_ELEMENTS = 20, 1024
EVERY_STEP = "output.interval_s=null"  # so that differences do not depend on the number of stored rows
OF_MOTION = ("stopping_time_relative", "travel_relative", "motion_relative")  # the errors of the motion that there are
INSTANTS = 2001  # at which histories are compared


@dataclass(frozen=True)
class Row:
    """One model: its name, results, median run time (s) and differences from the reference.

    differences: by column, relative differences and root mean square differences (deg, m) over the common time; see
    `_in_plane` and `_in_space`. None if either run lacks the number.
    """

    name: str
    results: Results
    seconds: float
    differences: dict[str, float | None]

    @property
    def motion_error(self) -> float:
        """Greatest relative error of the motion; infinite if one is unknown, or the run failed."""
        errors = [self.differences[key] for key in OF_MOTION if key in self.differences]
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
        measure = "the motion" if "motion_relative" in reference.differences else "stopping time and travel"
        motion = f"No model is within {limit} of {reference.name} in {measure}"
        if accepted := [row for row in candidates if row.motion_error <= self.tolerance]:
            best = accepted[0]
            cost = f"{1e3 * best.seconds:.3g} ms ({reference.name}: {1e3 * reference.seconds:.3g} ms)"
            motion = (
                f"Cheapest within {limit} in {measure}: {best.name}, error {100 * best.motion_error:.2g} % in {cost}"
            )
        peaks = [(row.name, row.differences["deflection_relative"]) for row in candidates]
        accurate = [name for name, error in peaks if error is not None and abs(error) <= self.tolerance]
        return f"{motion}; for the peak deflection: {accurate[0] if accurate else 'none'}."


def models(
    path: str | PathLike[str], modes: Sequence[int], elements: Sequence[int], overrides: Sequence[str]
) -> dict[str, list[str]]:
    """Overrides of each model of a comparison, by its name; cheapest kind first, the most elements last.

    In the plane the beams are finite elements of Exudyn; in space the modes are those of the config's own elements.

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
    model = load(path, overrides).scenario.model
    flexible = [name for name, body in model.all_bodies.items() if getattr(body, "flexible", None) is not None]
    links = [name for name in flexible if name in model.bodies]
    if not flexible:
        faults.append(Fault(str(path), None, "model.bodies", "no link is flexible, so there is nothing to compare"))
    if faults:
        raise ConfigError(faults)
    friction, method, kind = ("", "auto", "") if model.in_space else (", static: elastoplastic", "engine", "FE, ")
    reduced = {
        _counted("mode", n) if n else "rigid": [f"method={{reduced: {{modes: {n}{friction}}}}}"]
        for n in sorted(set(modes))
    }
    beams = {
        kind + _counted("element", n): [
            f"method={method}",
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
    of_motion = _in_space if "tip_z_m" in reference.names else _in_plane
    return {
        **of_motion(results, reference),
        "deflection_rms_m": _rms(results, reference, "deflection_m"),
        "deflection_relative": _relative(results, reference, "max_deflection_m"),
    }


def _in_plane(results: Results, reference: Results) -> dict[str, float | None]:
    """Differences of a pendulum: of its angle (root mean square), and relative ones of stopping time and travel."""
    angle = next(name for name in reference.names if name.endswith("_angle_deg"))
    return {
        "angle_rms_deg": _rms(results, reference, angle),
        "stopping_time_relative": _relative(results, reference, "stopping_time_s"),
        "travel_relative": _relative(results, reference, "angle_at_stop_deg", float(reference[angle][0])),
    }


def _in_space(results: Results, reference: Results) -> dict[str, float | None]:
    """Greatest distance of the tip from its place in the reference (m), and its ratio to the longest path of a body.

    Centres of bodies are not compared: that of a body with a welded link depends on the length of the link's elements.
    """
    time = _common_time(results, reference)
    apart = np.linalg.norm(_places(results, "tip", time) - _places(reference, "tip", time), axis=0).max()
    points = [name.removesuffix("_x_m") for name in reference.names if name.endswith("_x_m")]
    longest = max(np.linalg.norm(np.diff(_places(reference, point, time)), axis=0).sum() for point in points)
    return {"motion_m": float(apart), "motion_relative": float(apart / longest) if longest > 0.0 else None}


def _places(run: Results, point: str, time: Vector) -> Vector:
    """Places (3, n) m of a point at times (n,) s."""
    return np.array([_at(run, f"{point}_{axis}_m", time) for axis in "xyz"])


def _relative(results: Results, reference: Results, key: str, origin: float = 0.0) -> float | None:
    """Relative difference of a number of the summary, both less `origin`; None if either run lacks it."""
    value, exact = results.summary[key], reference.summary[key]
    if value is None or exact is None or exact == origin:
        return None
    return float((value - exact) / (exact - origin))


def _common_time(results: Results, reference: Results) -> Vector:
    """Instants (s) from the start to the end of the shorter of two runs."""
    return np.linspace(0.0, min(results["time_s"][-1], reference["time_s"][-1]), INSTANTS)


def _at(run: Results, column: str, time: Vector) -> Vector:
    """Values of a column at times (s), by cubics between the steps."""
    history = run["time_s"], run[column]
    return at_times(*history, rates(*history), time)


def _rms(results: Results, reference: Results, column: str) -> float | None:
    """Root mean square difference of a column over the common time of two runs; None if one lacks the column."""
    if not all(column in run.names for run in (results, reference)):
        return None
    time = _common_time(results, reference)
    return float(np.sqrt(np.mean((_at(results, column, time) - _at(reference, column, time)) ** 2)))


def cells(row: Row) -> dict[str, str | float | None]:
    """Cells of a row of the table, by column name."""
    of_motion = () if "motion_relative" in row.differences else ("stopping_time_s", "angle_at_stop_deg")
    numbers = {key: row.results.summary[key] for key in (*of_motion, "max_deflection_m")}
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
