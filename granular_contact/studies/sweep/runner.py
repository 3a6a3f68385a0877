"""Distribute the cases of a sweep to workers in chunks; a case that kills its worker loses only its own row."""

from __future__ import annotations

from collections.abc import Collection, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, ThreadPoolExecutor, wait
from contextlib import closing
from itertools import islice
from pathlib import Path

from granular_contact.config import Case, Sweep
from granular_contact.config.sweep import Probe, case_faults
from granular_contact.errors import Fault, WorkerPoolError
from granular_contact.studies.sweep.executor import WorkerPool
from granular_contact.studies.sweep.journal import Journal, Row
from granular_contact.studies.sweep.worker import Job, Simulate, Task, check, error_row, simulate, work

CHUNK_SECONDS = 0.5  # long compared with the 2 ms to send a chunk, short compared with a sweep
LARGEST_CHUNK = 256
MOST_CHECKED_HERE = 400  # up to so many cases are checked faster in this process than by starting workers
# Up to so many cases that are integrated together (see `run.summaries_of`) run faster in threads of this process.
MOST_IN_THREADS = 400
# Greatest number of steps of such a case: it must not exhaust the memory, which would kill this process, not a worker.
MOST_STEPS = 1e5
_DIED = "the process died; run this case alone to see why, it may need more memory than is available"

Work = Future[tuple[list[bytes], float]]


def faults(sweep: Sweep, cases: Sequence[Case], probe: Probe | None, pool: WorkerPool) -> list[Fault]:
    """Faults of cases, as `case_faults` gives them; the workers check them if there are many cases."""
    if len(cases) <= MOST_CHECKED_HERE:
        return case_faults(sweep, cases, probe)
    job, size = Job(sweep, simulate).packed(), max(64, len(cases) // (8 * pool.count))
    collected: list[Fault] = []
    checks: list[tuple[Future[list[Fault]], range]] = []
    for start in range(0, len(cases), size):
        chunk = cases[start : start + size]
        # Cases that refer to files are checked in this process, because workers elsewhere may not have the files.
        collected += case_faults(sweep, [case for case in chunk if sweep.needs_files(case)], probe)
        others = [case for case in chunk if not sweep.needs_files(case)]
        checks.append((pool.executor().submit(check, job, others, probe), range(start, start + len(chunk))))
    for future, indices in checks:
        lost = isinstance(future.exception(), BrokenExecutor)
        collected += case_faults(sweep, [cases[i] for i in indices], probe) if lost else future.result()
    return collected


def run(
    sweep: Sweep,
    pool: WorkerPool,
    *,
    done: Collection[int] = (),
    journal: Journal | None = None,
    cases_folder: Path | None = None,
    function: Simulate = simulate,
) -> Generator[Row, None, None]:
    """Run the cases of a sweep; yields one row for each case, in the order in which they finish.

    Parameters
    ----------
    sweep : Sweep
        From `granular_contact.config.load_sweep`.
    pool : WorkerPool
        The workers.
    done : collection of int
        Indices of cases to skip.
    journal : Journal, optional
        Stores each row before it is yielded.
    cases_folder : Path, optional
        Folder in which each case gets a results folder of its name.
    function : callable, optional
        Function from a scenario to its summary or results, importable in the workers.

    Raises
    ------
    OSError
        A row or the results of a case cannot be saved; everything saved before is complete.
    WorkerPoolError
        The workers cannot be reached any more.
    """
    with closing(CaseRunner(sweep, pool, journal=journal, cases_folder=cases_folder, function=function)) as cases:
        yield from cases.rows(_tasks(sweep, done), len(sweep.cases) - len(done))


class CaseRunner:
    """Runs cases of one config in a pool, all at once or in portions; has to be closed at the end."""

    def __init__(
        self,
        sweep: Sweep,
        pool: WorkerPool,
        *,
        journal: Journal | None = None,
        cases_folder: Path | None = None,
        function: Simulate = simulate,
    ) -> None:
        """Arguments: see `run`; the cases of `sweep` itself are not used."""
        self._sweep, self._pool, self._journal = sweep, pool, journal
        self._workers_write = journal is not None and pool.local
        self._writer = None if journal is None else journal.writer()
        folder = journal.folder if journal is not None and self._workers_write else None
        job = Job(sweep, function, cases_folder, folder)
        self._job, self._marches = job.packed(), job.marches and pool.local and _is_short(sweep)

    def rows(self, tasks: Iterator[Task], count: int) -> Iterator[Row]:
        """Yield the rows of `count` tasks in the order in which they finish; raises the errors of `run`."""
        if self._marches and count <= MOST_IN_THREADS:
            with WorkerPool(self._pool.count, _Threads) as threads:
                yield from self._rows(tasks, count, threads)
        else:
            yield from self._rows(tasks, count, self._pool)

    def _rows(self, tasks: Iterator[Task], count: int, pool: WorkerPool) -> Iterator[Row]:
        scheduler, suspects = _Scheduler(tasks, count, pool.count), list[Task]()
        for line in _together(scheduler, pool, self._job, suspects):
            if self._writer is not None and not self._workers_write:
                self._writer.append(line)
            yield Row.of(line)
        if suspects and self._journal is not None and self._workers_write:
            suspects = yield from _without_finished(suspects, self._journal)
        for line, lost in _one_by_one(suspects, self._sweep, pool, self._job) if suspects else ():
            if self._writer is not None and (lost or not self._workers_write):
                self._writer.append(line)
            yield Row.of(line)

    def close(self) -> None:
        """Close the journal; the pool stays open."""
        if self._writer is not None:
            self._writer.close()


class _Threads(ThreadPoolExecutor):
    """Thread pool whose shutdown waits for running tasks, so that nothing is written afterwards."""

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        super().shutdown(wait=True, cancel_futures=cancel_futures)


def _is_short(sweep: Sweep) -> bool:
    """Return whether every case has few enough steps that its histories need little memory."""
    from granular_contact.scene.steps import steps

    solver, varies = steps(sweep.base), any(key.startswith("solver") for key in sweep.keys)
    return not varies and solver.end_time_s / solver.step_s <= MOST_STEPS


def _without_finished(tasks: Sequence[Task], journal: Journal) -> Generator[Row, None, list[Task]]:
    """Yield the rows of tasks that finished before their worker died; return the other tasks."""
    pending = {task.index for task in tasks}
    finished = [row for row in journal if row.index in pending]
    yield from finished
    pending -= {row.index for row in finished}
    return [task for task in tasks if task.index in pending]


def _tasks(sweep: Sweep, done: Collection[int]) -> Iterator[Task]:
    for index, case in enumerate(sweep.cases):
        if index not in done:
            yield Task(index, case, sweep.scenario(case) if sweep.needs_files(case) else None)


class _Scheduler:
    """Divides tasks into chunks: large enough to make sending cheap, smaller towards the end to balance the workers."""

    def __init__(self, tasks: Iterator[Task], count: int, workers: int) -> None:
        self._tasks, self.left, self._workers = tasks, count, workers
        self._size = 1

    def take(self) -> list[Task]:
        """Return the next chunk of tasks."""
        size = max(1, min(self._size, self.left // (2 * self._workers)))
        chunk = list(islice(self._tasks, size))
        self.left -= len(chunk)
        return chunk

    def adapt(self, cases: int, seconds: float) -> None:
        """Adapt the size of chunks to the time of the latest chunk alone, because the first of a worker is slower."""
        self._size = max(1, min(LARGEST_CHUNK, int(CHUNK_SECONDS * cases / max(seconds, 1e-6))))


def _together(scheduler: _Scheduler, pool: WorkerPool, job: bytes, suspects: list[Task]) -> Iterator[bytes]:
    """Yield the lines of all tasks, except for those of lost chunks.

    Tasks of a lost chunk are added to `suspects`, because any of them may have killed the worker.
    """
    pending: dict[Work, list[Task]] = {}
    while pending or scheduler.left:
        while scheduler.left and len(pending) < 2 * pool.count:
            chunk = scheduler.take()
            pending[pool.executor().submit(work, job, chunk)] = chunk
        for future in wait(pending, return_when=FIRST_COMPLETED).done:
            chunk = pending.pop(future)
            error = future.exception()
            if isinstance(error, OSError | WorkerPoolError):
                raise error
            if error is not None:
                suspects += chunk
                continue
            lines, seconds = future.result()
            scheduler.adapt(len(lines), seconds)
            yield from lines


def _one_by_one(suspects: Sequence[Task], sweep: Sweep, pool: WorkerPool, job: bytes) -> Iterator[tuple[bytes, bool]]:
    """Run each suspect alone; yield its line, and whether its worker failed, so that it stored no row."""
    pool.shutdown()  # so that new workers start, which no other case has damaged
    for task in suspects:
        future: Work = pool.executor().submit(work, job, [task])
        error = future.exception()
        if isinstance(error, OSError | WorkerPoolError):
            raise error
        if error is None:
            yield future.result()[0][0], False
        else:
            died = isinstance(error, BrokenExecutor)
            yield error_row(task, sweep, RuntimeError(_DIED) if died else error).line(), True
