"""One config with several models, rigid, modal and finite-element, compared with the finest beam.

A model is accepted for the motion when stopping time and travel (angle at stop minus impact angle) are both within the
tolerance, and for the deflection when the peak deflection is. The verdict is the cheapest accepted model.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import load, schema
from granular_contact.errors import ConfigError, Fault
from granular_contact.report import (
    COMPARISON,
    FIGURES,
    SCENARIO,
    SUMMARY,
    json_text,
    scenario_text,
    whole_folder,
    write_rows,
)
from granular_contact.report.overlay import write as write_overlay
from granular_contact.results import FINISHED, Compiling, Results
from granular_contact.results.frames import MOST
from granular_contact.results.interpolation import at_times, rates
from granular_contact.run import run, uninterrupted
from granular_contact.scene import build

Vector = NDArray[np.float64]

MODES, ELEMENTS = (0, 1, 2, 5), (4, 8, 16, 32)
MOST_MODES, MOST_ELEMENTS = 20, 1024
HISTORIES = "histories.png"
EVERY_STEP = "output.interval_s=null"  # differences are not to depend on how many rows are kept


@dataclass(frozen=True)
class Candidate:
    """A model that may compute the config: its name and the overrides that select it."""

    name: str
    overrides: tuple[str, ...]


@dataclass(frozen=True)
class Row:
    """A model's results, its median run time (s) and its differences from the reference.

    stopping_time, travel, deflection: relative; angle_rms (deg) and deflection_rms (m): root mean squares over the time
    that both have. None where either run has no such number.
    """

    model: Candidate
    results: Results
    seconds: float
    stopping_time: float | None
    travel: float | None
    deflection: float | None
    angle_rms: float | None
    deflection_rms: float | None

    def within(self, tolerance: float) -> bool:
        """Whether the run came to its end, with stopping time and travel both within a relative tolerance."""
        return self.results.status.code in FINISHED and all(
            x is not None and abs(x) <= tolerance for x in (self.stopping_time, self.travel)
        )


@dataclass(frozen=True)
class Comparison:
    """Rows in the order of the models; the last is the reference."""

    rows: tuple[Row, ...]
    tolerance: float

    @property
    def verdict(self) -> str:
        """One sentence for the motion, and one for the deflection."""
        last = self.rows[-1]
        if last.results.status.code not in FINISHED:
            why = last.results.status.message
            return f"{last.model.name} did not reach its end, so there is no reference: {why}"
        candidates = sorted(self.rows[:-1], key=lambda row: row.seconds)
        good = [row for row in candidates if row.within(self.tolerance)]
        limit, finest = f"{100 * self.tolerance:g} %", self.rows[-1].model.name
        if good:
            best = good[0]
            worst = max(abs(best.stopping_time or 0.0), abs(best.travel or 0.0))
            cost = f"{1e3 * best.seconds:.3g} ms ({finest}: {1e3 * self.rows[-1].seconds:.3g} ms)"
            motion = (
                f"Cheapest within {limit} in stopping time and travel: {best.model.name}, "
                f"error {100 * worst:.2g} % in {cost}"
            )
        else:
            motion = f"No model is within {limit} of {finest} in stopping time and travel"
        bends = [r for r in candidates if r.deflection is not None and abs(r.deflection) <= self.tolerance]
        deflection = f"for the peak deflection: {bends[0].model.name}" if bends else "for the peak deflection: none"
        return f"{motion}; {deflection}."


def models(
    path: str | PathLike[str], modes: Sequence[int], elements: Sequence[int], overrides: Sequence[str]
) -> list[Candidate]:
    """The models of a comparison, cheapest kind first, the finest beam last.

    Raises
    ------
    ConfigError
        The config is at fault, a count is out of range, or the mechanism has no flexible link to compare.
    """
    faults = [
        Fault("", None, f"--{name}", f"got {n}; allowed are whole numbers from {low} to {high}")
        for name, counts, low, high in (("modes", modes, 0, MOST_MODES), ("elements", elements, 1, MOST_ELEMENTS))
        for n in counts
        if not low <= n <= high
    ]
    faults += [] if elements else [Fault("", None, "--elements", "got none; at least one beam is the reference")]
    scenario = load(path, overrides).scenario
    flexible = [
        n for n, b in scenario.model.all_bodies.items() if isinstance(b, schema.Link) and b.flexible is not None
    ]
    links = [name for name in flexible if name in scenario.model.bodies]
    if not flexible:
        faults.append(Fault(str(path), None, "model.bodies", "no link is flexible, so there is nothing to compare"))
    if faults:
        raise ConfigError(faults)
    reduced = [
        Candidate(
            "rigid" if n == 0 else f"{n} mode{'s' if n > 1 else ''}",
            (f"method={{reduced: {{modes: {n}, static: elastoplastic}}}}",),
        )
        for n in sorted(set(modes))
    ]
    beams = [
        Candidate(
            f"FE, {n} element{'s' if n > 1 else ''}",
            ("method=engine", *(f"model.bodies.{link}.flexible.elements={n}" for link in links)),
        )
        for n in sorted(set(elements))
    ]
    return reduced + beams


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
    """Run a config with every model, `repeats` times after a warm-up, to measure the run time.

    progress: called with the name of what is run next; compiling: see `run`.

    Raises
    ------
    ConfigError, SceneError
        As `models`, or the mechanism has no modal reduction.
    """
    runs = []
    for model in models(path, modes, elements, overrides):
        if progress is not None:
            progress(model.name)
        scenario = load(path, [*overrides, *model.overrides, EVERY_STEP]).scenario
        scene = build(scenario)
        pictures = [0] * repeats + [MOST]
        tries = [uninterrupted(run(scene, scenario, most_frames=most, compiling=compiling)) for most in pictures]
        seconds = statistics.median(one.summary["cost"]["solve_s"] for one in tries[1:])
        runs.append((model, tries[-1], seconds))
    reference = runs[-1][1]
    start = float(reference[_angle_column(reference)][0])
    rows = tuple(_row(model, results, seconds, reference, start) for model, results, seconds in runs)
    return Comparison(rows, tolerance)


def _row(model: Candidate, results: Results, seconds: float, reference: Results, start: float) -> Row:
    def relative(key: str, origin: float = 0.0) -> float | None:
        mine, exact = results.summary[key], reference.summary[key]
        if mine is None or exact is None or exact == origin:
            return None
        return float((mine - exact) / (exact - origin))

    return Row(
        model=model,
        results=results,
        seconds=seconds,
        stopping_time=relative("stopping_time_s"),
        travel=relative("angle_at_stop_deg", start),
        deflection=relative("max_deflection_m"),
        angle_rms=_rms(results, reference, _angle_column(reference)),
        deflection_rms=_rms(results, reference, "deflection_m"),
    )


def _angle_column(results: Results) -> str:
    return next(column.name for column in results.columns if column.name.endswith("_angle_deg"))


def _rms(results: Results, reference: Results, column: str) -> float | None:
    """Root mean square difference of a column over the time that both runs have; None where one has no such column."""
    if not all(any(c.name == column for c in one.columns) for one in (results, reference)):
        return None
    end = min(results["time_s"][-1], reference["time_s"][-1])
    time = np.linspace(0.0, end, 2001)
    known = [(one["time_s"], one[column]) for one in (results, reference)]
    mine, exact = (at_times(*one, rates(*one), time) for one in known)
    return float(np.sqrt(np.mean((mine - exact) ** 2)))


def cells(row: Row) -> dict[str, str | float | None]:
    """A row of the table, by the names of its columns."""
    measured = ("stopping_time_s", "angle_at_stop_deg", "max_deflection_m")
    return {
        "model": row.model.name,
        **{key: row.results.summary[key] for key in measured},
        "angle_rms_deg": row.angle_rms,
        "deflection_rms_m": row.deflection_rms,
        "stopping_time_relative": row.stopping_time,
        "travel_relative": row.travel,
        "deflection_relative": row.deflection,
        "solve_s": row.seconds,
    }


def write(comparison: Comparison, directory: Path, figures: bool = True) -> None:
    """Write table, verdict, scenario, histories and motions of all, and a figure, completely or not at all."""
    with whole_folder(directory, "compare") as folder:
        write_rows(folder / COMPARISON, map(cells, comparison.rows))
        (folder / SUMMARY).write_text(json_text(_summary(comparison)), encoding="utf-8")
        (folder / SCENARIO).write_text(scenario_text(comparison.rows[-1].results), encoding="utf-8")
        runs = [(row.model.name, row.results) for row in comparison.rows]
        write_overlay(runs, folder)
        if figures:
            from granular_contact.report.figures.histories import draw_histories

            (folder / FIGURES).mkdir()
            draw_histories(runs, folder / FIGURES / HISTORIES)


def _summary(comparison: Comparison) -> dict[str, Any]:
    """What the table does not say: the verdict, how it was measured, and the warnings."""
    reference = comparison.rows[-1].results
    return {
        "name": reference.name,
        "verdict": comparison.verdict,
        "tolerance": comparison.tolerance,
        "reference": comparison.rows[-1].model.name,
        "imbalance_relative": {
            r.model.name: r.results.summary["energy"]["imbalance_relative"] for r in comparison.rows
        },
        "warnings": [f"{row.model.name}: {warning}" for row in comparison.rows for warning in row.results.warnings],
        "versions": reference.summary["versions"],
    }
