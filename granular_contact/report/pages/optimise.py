"""Content of the page of a search."""

from __future__ import annotations

from typing import Any

from granular_contact.report import BEST, BEST_CONFIG, FIGURES, HISTORY, OPTIMISE, OPTIMUM, PROGRAM, SERIES, SUMMARY
from granular_contact.report.pages.chart import chart
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.live import live as of_run
from granular_contact.report.pages.live import nothing_live
from granular_contact.report.units import label, plain, quantity

MOST_ROWS = 100  # greatest number of rows on the page; the file has all
MOST_REASONS = 10
_CAPTIONS = {
    "history": "The objective of each run, the best so far, and the middle half of each generation.",
    "parameters": "Parameters of each run; the line marks the best run.",
}


def content(folder: Folder) -> dict[str, Any]:
    """Values for the template."""
    outcome = folder.read(OPTIMUM)
    table = folder.table(HISTORY)
    parameters = outcome["parameters"]
    shown = ["run", "generation", *parameters, "objective", "excess", "failure"]
    drawn = {name: table.column(name) for name in ("run", *parameters, "objective")}
    reasons = sorted(outcome["failures"].items(), key=lambda item: -item[1])
    return {
        "title": outcome["name"],
        "version": outcome["versions"].get(PROGRAM, ""),
        "outcome": outcome,
        "gain": None if outcome["gain_relative"] is None else f"{100 * outcome['gain_relative']:.3g} %",
        "start": _objective(outcome, "start"),
        "best": _objective(outcome, "best"),
        "parameters": [_parameter_row(name, parameter) for name, parameter in parameters.items()],
        "constraints": [
            [label(name), *(_number(name, limit[key]) for key in ("at_least", "at_most", "start", "best"))]
            for name, limit in outcome["constraints"].items()
        ],
        "reasons": [[reason, count] for reason, count in reasons[:MOST_REASONS]],
        "pictures": [(path, _CAPTIONS.get(path.stem, path.stem)) for path in folder.figures()],
        "mechanism": next(iter(sorted((folder.path / BEST / FIGURES).glob("mechanism.png"))), None),
        "config": folder.text(BEST_CONFIG),
        "search": folder.text(OPTIMISE),
        "columns": shown,
        "rows": table.of(shown),
        "most": MOST_ROWS,
        **_live(folder),
        "cases": chart([f"run {plain(run)}" for run in drawn["run"]], drawn, "run", "objective"),
    }


def _live(folder: Folder) -> dict[str, Any]:
    """Motion and histories of the best run, as on the page of a run."""
    best = Folder(folder.path / BEST, "run")
    if not best.has(SUMMARY):
        return nothing_live()
    shown = of_run(best, best.read(SUMMARY))
    return shown | {"data": shown["data"] | {"table_name": f"{BEST}_{SERIES}"}}


def _objective(outcome: dict[str, Any], key: str) -> str:
    value, formula = outcome[key], outcome["objective"]
    if value is None:
        return "none"
    return plain(value) if " " in formula else quantity(formula, value)  # a weighted sum has no unit


def _parameter_row(name: str, parameter: dict[str, Any]) -> list[str]:
    bounds = (quantity(name, parameter[key]) for key in ("from", "to"))
    values = (_number(name, parameter[key]) for key in ("start", "best"))
    return [label(name), *bounds, parameter["scale"], *values]


def _number(name: str, value: Any) -> str:
    return "" if value is None else quantity(name, value) or plain(value)
