"""Sweep -> rows: cases dealt out to a crew in chunks; a case that takes its worker down costs its own row only."""

from __future__ import annotations

from collections.abc import Collection, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from contextlib import closing
from itertools import islice
from pathlib import Path

from granular_contact.config import Case, Sweep
from granular_contact.config.sweep import Probe, case_faults
from granular_contact.errors import Fault
from granular_contact.studies.sweep.crew import Crew, CrewError
from granular_contact.studies.sweep.journal import Journal, Row
from granular_contact.studies.sweep.worker import Job, Simulate, Task, check, error_row, simulate, work

CHUNK_SECONDS = 0.5  # long against the 2 ms that it takes to hand over a chunk, short against a sweep
LARGEST_CHUNK = 256
FEW = 400  # cases that are checked sooner here than workers are started
_DIED = "the process died; run this case alone to see why, it may need more memory than there is"

Work = Future[tuple[list[bytes], float]]


def faults(sweep: Sweep, cases: Sequence[Case], probe: Probe | None, crew: Crew) -> list[Fault]:
    """Faults of cases as `case_faults` gives them, found by the crew where there are many."""
    if len(cases) <= FEW:
        return case_faults(sweep, cases, probe)
    job, size = Job(sweep, simulate).packed(), max(64, len(cases) // (8 * crew.count))
    found: list[Fault] = []
    shared: list[tuple[Future[list[Fault]], range]] = []
    for start in range(0, len(cases), size):
        chunk = cases[start : start + size]
        # What a case refers to is a file here, and may be none elsewhere.
        found += case_faults(sweep, [case for case in chunk if sweep.needs_files(case)], probe)
        others = [case for case in chunk if not sweep.needs_files(case)]
        shared.append((crew.pool().submit(check, job, others, probe), range(start, start + len(chunk))))
    for future, places in shared:
        lost = isinstance(future.exception(), BrokenExecutor)
        found += case_faults(sweep, [cases[i] for i in places], probe) if lost else future.result()
    return found


def run(
    sweep: Sweep,
    crew: Crew,
    *,
    done: Collection[int] = (),
    journal: Journal | None = None,
    cases_folder: Path | None = None,
    function: Simulate = simulate,
) -> Generator[Row, None, None]:
    """Run the cases of a sweep; rows come as they are finished, one for each case.

    Parameters
    ----------
    sweep : Sweep
        Of `granular_contact.config.load_sweep`.
    crew : Crew
        Who works.
    done : collection of int
        Indices of cases that are left out.
    journal : Journal, optional
        Keeps each row, before it comes here.
    cases_folder : Path, optional
        Where each case gets a results folder of its name.
    function : callable, optional
        What a case goes through, importable in the workers.

    Raises
    ------
    OSError
        A row or the results of a case can't be saved; what was saved before is whole.
    CrewError
        The workers can't be reached any more.
    """
    with closing(Bench(sweep, crew, journal=journal, cases_folder=cases_folder, function=function)) as bench:
        yield from bench.rows(_tasks(sweep, done), len(sweep.cases) - len(done))


class Bench:
    """A crew at work on cases of one config, which are handed over in one portion or many; to be closed."""

    def __init__(
        self,
        sweep: Sweep,
        crew: Crew,
        *,
        journal: Journal | None = None,
        cases_folder: Path | None = None,
        function: Simulate = simulate,
    ) -> None:
        """As of `run`; the cases of the sweep itself do not matter here."""
        self._sweep, self._crew, self._journal = sweep, crew, journal
        self._local = journal is not None and crew.here  # then the workers write
        self._keep = None if journal is None else journal.writer()
        folder = journal.folder if journal is not None and self._local else None
        self._job = Job(sweep, function, cases_folder, folder).packed()

    def rows(self, tasks: Iterator[Task], count: int) -> Iterator[Row]:
        """Rows of so many tasks as they are finished; errors as of `run`."""
        deal, suspects = _Deal(tasks, count, self._crew.count), list[Task]()
        for line in _together(deal, self._crew, self._job, suspects):
            if self._keep is not None and not self._local:
                self._keep.append(line)
            yield Row.of(line)
        if suspects and self._journal is not None and self._local:
            suspects = yield from _without_finished(suspects, self._journal)
        for line, lost in _one_by_one(suspects, self._sweep, self._crew, self._job) if suspects else ():
            if self._keep is not None and (lost or not self._local):
                self._keep.append(line)
            yield Row.of(line)

    def close(self) -> None:
        """No more rows; the crew is left to its owner."""
        if self._keep is not None:
            self._keep.close()


def _without_finished(tasks: Sequence[Task], journal: Journal) -> Generator[Row, None, list[Task]]:
    """Rows of the tasks that were finished before their worker died; returns the others."""
    wanted = {task.index for task in tasks}
    found = [row for row in journal if row.index in wanted]
    yield from found
    wanted -= {row.index for row in found}
    return [task for task in tasks if task.index in wanted]


def _tasks(sweep: Sweep, done: Collection[int]) -> Iterator[Task]:
    for index, case in enumerate(sweep.cases):
        if index not in done:
            yield Task(index, case, sweep.scenario(case) if sweep.needs_files(case) else None)


class _Deal:
    """Gives away the cases in chunks: large enough that handing them over costs little, small towards the end."""

    def __init__(self, tasks: Iterator[Task], count: int, workers: int) -> None:
        self._tasks, self.left, self._workers = tasks, count, workers
        self._size = 1

    def take(self) -> list[Task]:
        """The next cases, fewer than there are workers to share the rest."""
        size = max(1, min(self._size, self.left // (2 * self._workers)))
        chunk = list(islice(self._tasks, size))
        self.left -= len(chunk)
        return chunk

    def note(self, cases: int, seconds: float) -> None:
        """Learn from a finished chunk; from the latest one, as a worker's first is slower than all others."""
        self._size = max(1, min(LARGEST_CHUNK, int(CHUNK_SECONDS * cases / max(seconds, 1e-6))))


def _together(deal: _Deal, crew: Crew, job: bytes, suspects: list[Task]) -> Iterator[bytes]:
    """Lines of all cases but those of lost chunks, one of which may be the reason: `suspects` gets them."""
    pending: dict[Work, list[Task]] = {}
    while pending or deal.left:
        while deal.left and len(pending) < 2 * crew.count:
            chunk = deal.take()
            pending[crew.pool().submit(work, job, chunk)] = chunk
        for future in wait(pending, return_when=FIRST_COMPLETED).done:
            chunk = pending.pop(future)
            error = future.exception()
            if isinstance(error, OSError | CrewError):
                raise error
            if error is not None:
                suspects += chunk
                continue
            lines, seconds = future.result()
            deal.note(len(lines), seconds)
            yield from lines


def _one_by_one(suspects: Sequence[Task], sweep: Sweep, crew: Crew, job: bytes) -> Iterator[tuple[bytes, bool]]:
    """Lines of cases that are tried alone, and whether the row was lost."""
    crew.dismiss()  # new workers, that no other case has harmed
    for task in suspects:
        future: Work = crew.pool().submit(work, job, [task])
        error = future.exception()
        if isinstance(error, OSError | CrewError):
            raise error
        if error is None:
            yield future.result()[0][0], False
        else:
            died = isinstance(error, BrokenExecutor)
            yield error_row(task, sweep, RuntimeError(_DIED) if died else error).line(), True
