"""Functions that workers call: make the scenario of a case, run it, and return its row."""

from __future__ import annotations

import pickle
import secrets
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from granular_contact.config import Case, Scenario, Sweep
from granular_contact.config.sweep import Probe, case_faults
from granular_contact.errors import ConfigError, Fault, missing_figures
from granular_contact.results import Results
from granular_contact.studies.sweep.journal import Journal, Row, Writer

if TYPE_CHECKING:
    from granular_contact.scene.variants import Builder


# Function that runs the scenario of a case; it returns the summary or complete results.
Simulate = Callable[[Scenario], dict[str, Any] | Results]


@dataclass(frozen=True)
class Task:
    """A case to run.

    index: in the sweep, from 0; scenario: None unless the case refers to files, which a worker may not be able to read.
    """

    index: int
    case: Case
    scenario: Scenario | None = None


@dataclass(frozen=True)
class Job:
    """Data common to all tasks of a sweep; sent with every chunk of tasks, and unpickled once in each process.

    sweep: without its cases when packed. folder: for the results of each case, None to keep rows alone. journal: folder
    in which the worker stores its rows, None if the receiver stores them. token: identifies this run of the sweep,
    because a process may work for several.
    """

    sweep: Sweep
    function: Simulate
    folder: Path | None = None
    journal: Path | None = None
    token: str = field(default_factory=lambda: secrets.token_hex(8))

    @property
    def marches(self) -> bool:
        """Whether one compiled call integrates several tasks together."""
        return self.sweep.base.is_modal and self.function is simulate and self.folder is None

    @cached_property
    def writer(self) -> Writer | None:
        """Writer for the rows of this process; None if the receiver stores them."""
        return None if self.journal is None else Journal(self.journal).writer()

    @cached_property
    def builder(self) -> Builder:
        """Builder of the scenes of tasks that are integrated together."""
        from granular_contact.scene.variants import Builder

        return Builder(self.sweep.base)

    def packed(self) -> bytes:
        """Pickle the job for `work` and `check`, without the cases of the sweep."""
        return pickle.dumps(replace(self, sweep=self.sweep.without_cases()))


@lru_cache(maxsize=2)
def _unpacked(job: bytes) -> Job:
    unpacked: Job = pickle.loads(job)
    return unpacked


def simulate(scenario: Scenario) -> dict[str, Any]:
    """Run a scenario and return its summary."""
    from granular_contact.run import summary_of
    from granular_contact.scene.build import build_checked

    return summary_of(build_checked(scenario))  # without checks: they were made for every case of the sweep


def simulate_with_pictures(scenario: Scenario) -> Results:
    """Run a scenario and return complete results, with the pictures for the player of its page."""
    from granular_contact import scene
    from granular_contact.results.frames import MOST
    from granular_contact.run import run

    return run(scene.build(scenario), scenario, most_frames=MOST)


def work(job: bytes, tasks: Sequence[Task]) -> tuple[list[bytes], float]:
    """Run tasks; return the lines of their rows and the seconds taken. An exception of a case becomes its row.

    Raises
    ------
    OSError
        The results cannot be saved.
    """
    unpacked = _unpacked(job)
    writer, begin = unpacked.writer, time.perf_counter()
    lines = []
    for line in _marched(tasks, unpacked) if unpacked.marches else (_line(task, unpacked) for task in tasks):
        lines.append(line)
        if writer is not None:
            writer.append(line)
    return lines, time.perf_counter() - begin


def check(job: bytes, cases: Sequence[Case], probe: Probe | None) -> list[Fault]:
    """Return the faults of cases."""
    return case_faults(_unpacked(job).sweep, cases, probe)


def _line(task: Task, job: Job) -> bytes:
    try:
        scenario = _scenario(task, job)
        keeps_results = job.folder is not None and job.function is simulate
        results = (simulate_with_pictures if keeps_results else job.function)(scenario)
        if job.folder is None or not isinstance(results, Results):
            return _row(task, job, scenario, results.summary if isinstance(results, Results) else results)
    except Exception as error:
        return error_row(task, job.sweep, error).line()
    try:
        missing = _saved(results, job.folder / task.case.name, scenario.output.figures)
    except OSError:  # a fault of the disk, not of the case
        raise
    except Exception as error:
        return error_row(task, job.sweep, error).line()
    return _row(task, job, scenario, {**results.summary, "warnings": [*results.summary["warnings"], *missing]})


def _saved(results: Results, folder: Path, figures: bool) -> list[str]:
    """Save the results of a case; return a sentence for each figure that could not be drawn."""
    from granular_contact import report

    missing = list[str]()
    with missing_figures(missing.append):
        report.write(results, folder, figures=figures)
    return missing


def _row(task: Task, job: Job, scenario: Scenario, summary: dict[str, Any]) -> bytes:
    return Row(task.index, task.case.name, job.sweep.values(task.case, scenario), dict(_flat(summary))).line()


def _marched(tasks: Sequence[Task], job: Job) -> list[bytes]:
    """Lines of tasks that are integrated together.

    Except for its run time each row is the same, up to round-off, as if its task ran alone.
    """
    from granular_contact.run import summaries_of, tried

    scenarios, scenes = [], []
    for task in tasks:
        scenario = tried(_scenario, task, job)
        scenarios.append(scenario)
        scenes.append(scenario if isinstance(scenario, Exception) else tried(job.builder, scenario))
    valid = [scene for scene in scenes if not isinstance(scene, Exception)]
    summaries = iter(summaries_of(valid))
    lines = []
    for task, scenario, scene in zip(tasks, scenarios, scenes, strict=True):
        summary = scene if isinstance(scene, Exception) else next(summaries)
        if isinstance(summary, Exception):
            lines.append(error_row(task, job.sweep, summary).line())
        elif not isinstance(scenario, Exception):  # always, since the scene is none
            lines.append(_row(task, job, scenario, summary))
    return lines


def _scenario(task: Task, job: Job) -> Scenario:
    return task.scenario or job.sweep.scenario(task.case)


def error_row(task: Task, sweep: Sweep, error: BaseException) -> Row:
    """Row of a case that raised an exception, with the exception as a message of one line."""
    try:
        values = sweep.values(task.case, task.scenario or sweep.scenario(task.case))
    except ConfigError:  # the case was not checked
        values = task.case.values
    message = " ".join(traceback.format_exception_only(error)[-1].split())
    return Row(task.index, task.case.name, values, {"status": "error", "message": message})


def _flat(summary: dict[str, Any], above: str = "") -> list[tuple[str, Any]]:
    """Flatten nested mappings to entries with dotted keys."""
    flat: list[tuple[str, Any]] = []
    for key, value in summary.items():
        if isinstance(value, dict):
            flat += _flat(value, f"{above}{key}.")
        else:
            flat.append((f"{above}{key}", value))
    return flat
