"""An outcome -> history.csv, optimise.json, the best config and its run, and figures."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

from granular_contact.config import Study, scenario_to_dict
from granular_contact.report import (
    BEST,
    BEST_CONFIG,
    FIGURES,
    HISTORY,
    OPTIMISE,
    OPTIMUM,
    PROGRAM,
    json_text,
    origin,
    write,
    yaml_text,
)
from granular_contact.results.summary import versions
from granular_contact.studies.optimise.outcome import Outcome
from granular_contact.studies.optimise.search import packages
from granular_contact.studies.sweep.checkpoint import Contents
from granular_contact.studies.sweep.table import write_cells


def work_of(study: Study) -> Contents:
    """What its folder is of.

    Raises
    ------
    MissingPackageError
        The method's package is not installed.
    """
    text, needed = study_text(study), packages(study.file)
    return Contents("optimise", OPTIMISE, text, HISTORY, study.case_name, "search", "runs", needed)


def study_text(study: Study) -> str:
    """A file of the search that needs no other: the config with every default, and what is asked of it."""
    return origin(f"optimise {OPTIMISE}") + yaml_text(
        {"config": scenario_to_dict(study.sweep.base)} | study.file.plain()
    )


def write_outcome(outcome: Outcome, folder: Path, *, figures: bool = True) -> None:
    """Write what a search found into a folder, with the results of the best run.

    Raises
    ------
    OSError
        The disk refuses.
    """
    write_history(outcome, folder)
    (folder / OPTIMUM).write_text(json_text(outcome_data(outcome)), encoding="utf-8")
    if outcome.best is not None:
        _write_best(outcome, folder, figures)
    if figures:
        _draw(outcome, folder / FIGURES)


def _write_best(outcome: Outcome, folder: Path, figures: bool) -> None:
    """Write the config of the best run, and its results."""
    head = f"# The best of {len(outcome.runs)} runs of {outcome.study.name}; to run it: {PROGRAM} run {BEST_CONFIG}\n"
    (folder / BEST_CONFIG).write_text(head + yaml_text(scenario_to_dict(outcome.scenario)), encoding="utf-8")
    write(outcome.simulate(), folder / BEST, figures=figures and outcome.scenario.output.figures)


def write_history(outcome: Outcome, folder: Path) -> None:
    """history.csv: a row for each run, in the order in which they were asked for."""
    rows = outcome.rows
    write_cells(folder / HISTORY, list(dict.fromkeys(key for row in rows for key in row)), rows)


def outcome_data(outcome: Outcome) -> dict[str, Any]:
    """What optimise.json holds."""
    file, best, start = outcome.study.file, outcome.best, outcome.start
    found = {} if best is None else best.row.summary
    return {
        "name": outcome.study.name,
        "method": file.method,
        "seed": file.seed,
        "population": file.size,
        "runs": len(outcome.runs),
        "failed": len(outcome.failed),
        "outside_constraints": sum(one.excess > 0.0 for one in outcome.runs),
        "ended": outcome.ended or None,
        "objective": file.objective.formula,
        "sense": file.objective.sense,
        "start": start.value,
        "start_is_allowed": start.is_allowed,
        "best": None if best is None else best.value,
        "best_run": None if best is None else best.index,
        "best_is_allowed": best is not None and best.is_allowed,
        "gain_relative": outcome.gain,
        "parameters": _parameters(outcome),
        "constraints": {
            name: limit.model_dump() | {"start": start.row.summary.get(name), "best": found.get(name)}
            for name, limit in file.constraints.items()
        },
        # The most frequent first.
        "failures": dict(Counter(one.failure for one in outcome.failed).most_common()),
        "versions": versions() | packages(file),
    }


def _parameters(outcome: Outcome) -> dict[str, dict[str, Any]]:
    """Range of each parameter, the keys that it sets, and its values."""
    file, start = outcome.study.file, outcome.study.start
    return {
        name: {
            "from": one.start,
            "to": one.stop,
            "scale": one.scale,
            "keys": list(file.keys(name)),
            "start": start[name],
            "best": outcome.numbers[name],
        }
        for name, one in file.parameters.items()
    }


def _draw(outcome: Outcome, folder: Path) -> None:
    from granular_contact.report.figures.studies import draw_history, draw_parameters

    values = [(one.generation, one.value if one.is_allowed else None) for one in outcome.runs]
    file = outcome.study.file
    draw_history(values, file.objective.formula, file.objective.sense == "maximise", folder / "history.png")
    tried = {
        name: [one.numbers.get(name, outcome.study.start[name]) for one in outcome.runs] for name in file.parameters
    }
    scales = {name: (one.start, one.stop, one.scale) for name, one in file.parameters.items()}
    best = None if outcome.best is None else outcome.best.index
    draw_parameters(tried, scales, [one.is_allowed for one in outcome.runs], best, folder / "parameters.png")
