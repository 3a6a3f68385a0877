"""Write an outcome: history.csv, optimise.json, the best config and its run, and figures."""

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
    """Return the contents of the results folder of a search.

    Raises
    ------
    MissingPackageError
        The package of the method is not installed.
    """
    text, versions_of_method = study_text(study), packages(study.file)
    return Contents("optimise", OPTIMISE, text, HISTORY, study.case_name, "search", "runs", versions_of_method)


def study_text(study: Study) -> str:
    """Self-contained file of the search: the config with every default, parameters, objective and options."""
    return origin(f"optimise {OPTIMISE}") + yaml_text(
        {"config": scenario_to_dict(study.sweep.base)} | study.file.plain()
    )


def write_outcome(outcome: Outcome, folder: Path, *, figures: bool = True) -> None:
    """Write an outcome into a folder, with the results of the best run.

    Raises
    ------
    OSError
        A file cannot be written.
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
    """Write history.csv: a row for each run, in the order of the proposals."""
    rows = outcome.rows
    write_cells(folder / HISTORY, list(dict.fromkeys(key for row in rows for key in row)), rows)


def outcome_data(outcome: Outcome) -> dict[str, Any]:
    """Content of optimise.json."""
    file, best, start = outcome.study.file, outcome.best, outcome.start
    best_summary = {} if best is None else best.row.summary
    return {
        "name": outcome.study.name,
        "method": file.method,
        "seed": file.seed,
        "population": file.size,
        "runs": len(outcome.runs),
        "failed": len(outcome.failed),
        "outside_constraints": sum(run.excess > 0.0 for run in outcome.runs),
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
            name: limit.model_dump() | {"start": start.row.summary.get(name), "best": best_summary.get(name)}
            for name, limit in file.constraints.items()
        },
        "failures": dict(Counter(run.failure for run in outcome.failed).most_common()),  # most frequent first
        "versions": versions() | packages(file),
    }


def _parameters(outcome: Outcome) -> dict[str, dict[str, Any]]:
    """Range of each parameter, the keys that it sets, and its values at the start and at the best run."""
    file, start = outcome.study.file, outcome.study.start
    return {
        name: {
            "from": parameter.start,
            "to": parameter.stop,
            "scale": parameter.scale,
            "keys": list(file.keys(name)),
            "start": start[name],
            "best": outcome.numbers[name],
        }
        for name, parameter in file.parameters.items()
    }


def _draw(outcome: Outcome, folder: Path) -> None:
    from granular_contact.report.figures.studies import draw_history, draw_parameters

    values = [(run.generation, run.value if run.is_allowed else None) for run in outcome.runs]
    file = outcome.study.file
    draw_history(values, file.objective.formula, file.objective.sense == "maximise", folder / "history.png")
    numbers = {
        name: [run.numbers.get(name, outcome.study.start[name]) for run in outcome.runs] for name in file.parameters
    }
    scales = {name: (parameter.start, parameter.stop, parameter.scale) for name, parameter in file.parameters.items()}
    best = None if outcome.best is None else outcome.best.index
    draw_parameters(numbers, scales, [run.is_allowed for run in outcome.runs], best, folder / "parameters.png")
