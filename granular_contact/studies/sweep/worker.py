"""Work on a case in any process: Case -> Scenario -> Results -> Row."""

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


# What a case goes through: to its summary, or to all its results.
Simulate = Callable[[Scenario], dict[str, Any] | Results]


@dataclass(frozen=True)
class Task:
    """A case to run: its place in the sweep (from 0); and its scenario, where that can't be made anywhere."""

    index: int
    case: Case
    scenario: Scenario | None = None


@dataclass(frozen=True)
class Job:
    """What the tasks of a sweep have in common; sent with each of them, and read once in each process.

    sweep: without its cases. folder: for the results of each case, None to keep no more than a row. journal: where the
    process writes its rows, None to leave that to whoever gets them. token: of this run, as a process may see several.
    """

    sweep: Sweep
    function: Simulate
    folder: Path | None = None
    journal: Path | None = None
    token: str = field(default_factory=lambda: secrets.token_hex(8))

    @property
    def marches(self) -> bool:
        """Whether several of its tasks are marched by one compiled call."""
        return self.sweep.base.is_modal and self.function is simulate and self.folder is None

    @cached_property
    def writer(self) -> Writer | None:
        """Where this process writes its rows."""
        return None if self.journal is None else Journal(self.journal).writer()

    @cached_property
    def builder(self) -> Builder:
        """What builds the scenes of tasks that march together."""
        from granular_contact.scene.variants import Builder

        return Builder(self.sweep.base)

    def packed(self) -> bytes:
        """As `work` and `check` take it."""
        return pickle.dumps(replace(self, sweep=self.sweep.without_cases()))


@lru_cache(maxsize=2)
def _unpacked(job: bytes) -> Job:
    held: Job = pickle.loads(job)
    return held


def simulate(scenario: Scenario) -> dict[str, Any]:
    """One run, as the command line does it, of a scenario that comes straight from a config."""
    from granular_contact.run import summary_of
    from granular_contact.scene.build import build_checked

    return summary_of(build_checked(scenario))  # which was checked as it was made of its case


def simulate_with_pictures(scenario: Scenario) -> Results:
    """The same with all that results hold, and what the player of its page needs."""
    from granular_contact import scene
    from granular_contact.results.frames import MOST
    from granular_contact.run import run

    return run(scene.build(scenario), scenario, most_frames=MOST)


def work(job: bytes, tasks: Sequence[Task]) -> tuple[list[bytes], float]:
    """Lines of the tasks' rows, and the seconds that they took; an exception of a case becomes its row.

    Raises
    ------
    OSError
        The results can't be saved.
    """
    held = _unpacked(job)
    writer, begin = held.writer, time.perf_counter()
    lines = []
    for line in _marched(tasks, held) if held.marches else (_line(task, held) for task in tasks):
        lines.append(line)
        if writer is not None:
            writer.append(line)
    return lines, time.perf_counter() - begin


def check(job: bytes, cases: Sequence[Case], probe: Probe | None) -> list[Fault]:
    """Faults of some cases."""
    return case_faults(_unpacked(job).sweep, cases, probe)


def _line(task: Task, job: Job) -> bytes:
    try:
        scenario = _scenario(task, job)
        kept = job.folder is not None and job.function is simulate
        found = (simulate_with_pictures if kept else job.function)(scenario)
        if job.folder is None or not isinstance(found, Results):
            return _row(task, job, scenario, found.summary if isinstance(found, Results) else found)
    except Exception as error:
        return error_row(task, job.sweep, error).line()
    try:
        missing = _saved(found, job.folder / task.case.name, scenario.output.figures)
    except OSError:  # no matter of the case
        raise
    except Exception as error:
        return error_row(task, job.sweep, error).line()
    return _row(task, job, scenario, {**found.summary, "warnings": [*found.summary["warnings"], *missing]})


def _saved(found: Results, folder: Path, figures: bool) -> list[str]:
    """Save the results of a case; a sentence for each figure that could not be drawn."""
    from granular_contact import report

    missing = list[str]()
    with missing_figures(missing.append):
        report.write(found, folder, figures=figures)
    return missing


def _row(task: Task, job: Job, scenario: Scenario, summary: dict[str, Any]) -> bytes:
    return Row(task.index, task.case.name, job.sweep.values(task.case, scenario), dict(_flat(summary))).line()


def _marched(tasks: Sequence[Task], job: Job) -> list[bytes]:
    """Lines of tasks that are solved together; up to round-off each is what it would be alone, but for its times."""
    from granular_contact.run import summaries_of, tried

    scenarios, scenes = [], []
    for task in tasks:
        made = tried(_scenario, task, job)
        scenarios.append(made)
        scenes.append(made if isinstance(made, Exception) else tried(job.builder, made))
    fine = [one for one in scenes if not isinstance(one, Exception)]
    summaries = iter(summaries_of(fine))
    lines = []
    for task, scenario, scene in zip(tasks, scenarios, scenes, strict=True):
        found = scene if isinstance(scene, Exception) else next(summaries)
        if isinstance(found, Exception):
            lines.append(error_row(task, job.sweep, found).line())
        elif not isinstance(scenario, Exception):  # or its scene would be one
            lines.append(_row(task, job, scenario, found))
    return lines


def _scenario(task: Task, job: Job) -> Scenario:
    return task.scenario or job.sweep.scenario(task.case)


def error_row(task: Task, sweep: Sweep, error: BaseException) -> Row:
    """The row of a case that did not come to an end, with the exception in one line."""
    try:
        values = sweep.values(task.case, task.scenario or sweep.scenario(task.case))
    except ConfigError:  # was not checked
        values = task.case.values
    message = " ".join(traceback.format_exception_only(error)[-1].split())
    return Row(task.index, task.case.name, values, {"status": "error", "message": message})


def _flat(summary: dict[str, Any], above: str = "") -> list[tuple[str, Any]]:
    """Entries of nested mappings by dotted key."""
    flat: list[tuple[str, Any]] = []
    for key, value in summary.items():
        if isinstance(value, dict):
            flat += _flat(value, f"{above}{key}.")
        else:
            flat.append((f"{above}{key}", value))
    return flat
