"""What is done with a case, in whichever process: Scenario -> Results -> Row. Knows nothing of how it got there."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from granular_contact.config import Scenario
from granular_contact.results import Results

Simulate = Callable[[Scenario], Results]


@dataclass(frozen=True)
class Task:
    """A case to run: its place in the sweep (from 0) and name; folder for its results, None to keep no more than a row.

    values: what the case has under the keys of the sweep.
    """

    index: int
    name: str
    values: dict[str, Any]
    scenario: Scenario
    folder: Path | None = None


@dataclass(frozen=True)
class Row:
    """What came of a case. summary: flat, by dotted key; at least `status` and `message`."""

    index: int
    name: str
    values: dict[str, Any]
    summary: dict[str, Any]

    @property
    def failed(self) -> bool:
        """Whether the case gave no result to rely on."""
        return self.summary["status"] not in ("rest", "end_time")


def simulate(scenario: Scenario) -> Results:
    """One run, as the command line does it."""
    from granular_contact import scene
    from granular_contact.run import run

    return run(scene.build(scenario), scenario)


def work(tasks: Sequence[Task], function: Simulate) -> tuple[list[Row], float]:
    """Rows of the tasks, and the seconds that they took; whatever a case raises is a row."""
    begin = time.perf_counter()
    rows = [_row(task, function) for task in tasks]
    return rows, time.perf_counter() - begin


def _row(task: Task, function: Simulate) -> Row:
    try:
        results = function(task.scenario)
        if task.folder is not None:
            from granular_contact import report

            report.write(results, task.folder, figures=task.scenario.output.figures)
    except Exception as error:
        return error_row(task, error)
    return Row(task.index, task.name, task.values, dict(_flat(results.summary)))


def error_row(task: Task, error: BaseException) -> Row:
    """The row of a case that did not come to an end, with the exception in one line."""
    message = " ".join(traceback.format_exception_only(error)[-1].split())
    return Row(task.index, task.name, task.values, {"status": "error", "message": message})


def _flat(summary: dict[str, Any], above: str = "") -> list[tuple[str, Any]]:
    """Entries of nested mappings by dotted key."""
    flat: list[tuple[str, Any]] = []
    for key, value in summary.items():
        if isinstance(value, dict):
            flat += _flat(value, f"{above}{key}.")
        else:
            flat.append((f"{above}{key}", value))
    return flat
