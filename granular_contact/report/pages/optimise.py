"""What the page of a search shows."""

from __future__ import annotations

from typing import Any

from granular_contact.report import BEST, BEST_CONFIG, FIGURES, HISTORY, OPTIMISE, OPTIMUM, PROGRAM, SERIES, SUMMARY
from granular_contact.report.pages.chart import chart
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.live import live as of_run
from granular_contact.report.pages.live import nothing_live
from granular_contact.report.units import label, plain, quantity

MOST_ROWS = 100  # shown; the rest is in the table
MOST_REASONS = 10
_WORDS = {
    "history": "The objective of each run, the best so far, and half of each generation.",
    "parameters": "What each run tried; the line is the best run.",
}


def content(folder: Folder) -> dict[str, Any]:
    """What its template asks for."""
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
        "start": _worth(outcome, "start"),
        "best": _worth(outcome, "best"),
        "parameters": [
            [label(name), *(quantity(name, one[key]) for key in ("from", "to")), one["scale"], *_numbers(name, one)]
            for name, one in parameters.items()
        ],
        "constraints": [
            [label(name), *(_number(name, one[key]) for key in ("at_least", "at_most", "start", "best"))]
            for name, one in outcome["constraints"].items()
        ],
        "reasons": [[words, count] for words, count in reasons[:MOST_REASONS]],
        "pictures": [(path, _WORDS.get(path.stem, path.stem)) for path in folder.figures()],
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
    """The best run, as on a page of its own."""
    best = Folder(folder.path / BEST, "run")
    if not best.has(SUMMARY):
        return nothing_live()
    shown = of_run(best, best.read(SUMMARY))
    return shown | {"data": shown["data"] | {"table_name": f"{BEST}_{SERIES}"}}


def _worth(outcome: dict[str, Any], key: str) -> str:
    value, words = outcome[key], outcome["objective"]
    if value is None:
        return "none"
    return plain(value) if " " in words else quantity(words, value)  # a sum has no unit


def _numbers(name: str, one: dict[str, Any]) -> list[str]:
    return [_number(name, one[key]) for key in ("start", "best")]


def _number(name: str, value: Any) -> str:
    return "" if value is None else quantity(name, value) or plain(value)
