"""Sweep -> rows: cases dealt out to workers in chunks; a case that takes its worker down costs its own row only."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from itertools import islice
from pathlib import Path

from granular_contact.config.sweep import Sweep
from granular_contact.sweep.pool import cores, local_processes
from granular_contact.sweep.worker import Row, Simulate, Task, error_row, simulate, work

CHUNK_SECONDS = 0.2  # long against the 1 ms that it takes to hand over a chunk, short against a sweep
LARGEST_CHUNK = 64
_DIED = "the process died; run this case alone to see why, it may need more memory than there is"

ExecutorFactory = Callable[[int], Executor]
Work = Future[tuple[list[Row], float]]


def run(
    sweep: Sweep,
    workers: int | None = None,
    cases_folder: Path | None = None,
    executor: ExecutorFactory = local_processes,
    function: Simulate = simulate,
) -> Generator[Row, None, None]:
    """Run all cases of a sweep; rows come as they are finished, one for each case.

    Parameters
    ----------
    sweep : Sweep
        Of `granular_contact.config.load_sweep`.
    workers : int, optional
        Processes; all cores unless given, and no more than there are cases.
    cases_folder : Path, optional
        Where each case gets a results folder of its name.
    executor : callable, optional
        Gives an executor of so many workers. Called again when one is broken, and for single workers.
    function : callable, optional
        What a case goes through, importable in the workers.
    """
    workers = min(workers or cores(), len(sweep.cases))
    deal = _Deal(_tasks(sweep, cases_folder), len(sweep.cases), workers)
    while deal.left:
        suspects = yield from _together(deal, workers, executor, function)
        yield from _one_by_one(suspects, executor, function)


def _tasks(sweep: Sweep, folder: Path | None) -> Iterator[Task]:
    for index, case in enumerate(sweep.cases):
        scenario = sweep.scenario(case)
        place = None if folder is None else folder / case.name
        yield Task(index, case.name, sweep.values(case, scenario), scenario, place)


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


def _together(
    deal: _Deal, workers: int, executor: ExecutorFactory, function: Simulate
) -> Generator[Row, None, list[Task]]:
    """Rows until all cases are given away or a chunk is lost; returns the cases that may have been the reason."""
    suspects: list[Task] = []
    pending: dict[Work, list[Task]] = {}
    with executor(workers) as pool:
        while pending or (deal.left and not suspects):
            while deal.left and not suspects and len(pending) < 2 * workers:
                chunk = deal.take()
                try:
                    pending[pool.submit(work, chunk, function)] = chunk
                except BrokenExecutor:
                    suspects += chunk
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                chunk = pending.pop(future)
                if future.exception() is not None:
                    suspects += chunk
                    continue
                rows, seconds = future.result()
                deal.note(len(rows), seconds)
                yield from rows
    return suspects


def _one_by_one(suspects: Sequence[Task], executor: ExecutorFactory, function: Simulate) -> Iterator[Row]:
    """Rows of cases that are tried alone, each in a worker that no other case has harmed."""
    tasks = deque(suspects)
    while tasks:
        with executor(1) as pool:
            broken = False
            while tasks and not broken:
                task = tasks.popleft()
                try:
                    future: Work = pool.submit(work, [task], function)
                except BrokenExecutor:  # since the last case, and so not by this one
                    tasks.appendleft(task)
                    break
                error = future.exception()
                broken = isinstance(error, BrokenExecutor)
                if error is None:
                    yield from future.result()[0]
                else:
                    yield error_row(task, RuntimeError(_DIED) if broken else error)
