"""Sweep -> rows: cases go to a pool of workers in chunks; a case that kills its worker costs only its own row."""

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

CHUNK_SECONDS = 0.5  # long against the 2 ms that it takes to hand over a chunk, short against a sweep
LARGEST_CHUNK = 256
MOST_CHECKED_HERE = 400  # cases that are checked sooner here than workers are started
MOST_IN_THREADS = 400  # the same of cases that are marched together, see `run.summaries_of`
MOST_STEPS = 1e5  # of such a case: a worker that runs out of memory may be lost, this process not
_DIED = "the process died; run this case alone to see why, it may need more memory than is available"

Work = Future[tuple[list[bytes], float]]


def faults(sweep: Sweep, cases: Sequence[Case], probe: Probe | None, pool: WorkerPool) -> list[Fault]:
    """Faults of cases as `case_faults` gives them, found by the workers where there are many."""
    if len(cases) <= MOST_CHECKED_HERE:
        return case_faults(sweep, cases, probe)
    job, size = Job(sweep, simulate).packed(), max(64, len(cases) // (8 * pool.count))
    found: list[Fault] = []
    shared: list[tuple[Future[list[Fault]], range]] = []
    for start in range(0, len(cases), size):
        chunk = cases[start : start + size]
        # What a case refers to is a file here, and may be none elsewhere.
        found += case_faults(sweep, [case for case in chunk if sweep.needs_files(case)], probe)
        others = [case for case in chunk if not sweep.needs_files(case)]
        shared.append((pool.executor().submit(check, job, others, probe), range(start, start + len(chunk))))
    for future, places in shared:
        lost = isinstance(future.exception(), BrokenExecutor)
        found += case_faults(sweep, [cases[i] for i in places], probe) if lost else future.result()
    return found


def run(
    sweep: Sweep,
    pool: WorkerPool,
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
    pool : WorkerPool
        The workers.
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
    WorkerPoolError
        The workers can't be reached any more.
    """
    with closing(CaseRunner(sweep, pool, journal=journal, cases_folder=cases_folder, function=function)) as cases:
        yield from cases.rows(_tasks(sweep, done), len(sweep.cases) - len(done))


class CaseRunner:
    """Runs cases of one config in a pool, handed over at once or in portions; to be closed."""

    def __init__(
        self,
        sweep: Sweep,
        pool: WorkerPool,
        *,
        journal: Journal | None = None,
        cases_folder: Path | None = None,
        function: Simulate = simulate,
    ) -> None:
        """As of `run`; the cases of the sweep itself do not matter here."""
        self._sweep, self._pool, self._journal = sweep, pool, journal
        self._local = journal is not None and pool.local  # then the workers write
        self._keep = None if journal is None else journal.writer()
        folder = journal.folder if journal is not None and self._local else None
        job = Job(sweep, function, cases_folder, folder)
        self._job, self._marches = job.packed(), job.marches and pool.local and _is_short(sweep)

    def rows(self, tasks: Iterator[Task], count: int) -> Iterator[Row]:
        """Rows of so many tasks as they are finished; errors as of `run`."""
        if self._marches and count <= MOST_IN_THREADS:
            with WorkerPool(self._pool.count, _Threads) as threads:
                yield from self._rows(tasks, count, threads)
        else:
            yield from self._rows(tasks, count, self._pool)

    def _rows(self, tasks: Iterator[Task], count: int, pool: WorkerPool) -> Iterator[Row]:
        scheduler, suspects = _Scheduler(tasks, count, pool.count), list[Task]()
        for line in _together(scheduler, pool, self._job, suspects):
            if self._keep is not None and not self._local:
                self._keep.append(line)
            yield Row.of(line)
        if suspects and self._journal is not None and self._local:
            suspects = yield from _without_finished(suspects, self._journal)
        for line, lost in _one_by_one(suspects, self._sweep, pool, self._job) if suspects else ():
            if self._keep is not None and (lost or not self._local):
                self._keep.append(line)
            yield Row.of(line)

    def close(self) -> None:
        """No more rows; the pool stays as it is."""
        if self._keep is not None:
            self._keep.close()


class _Threads(ThreadPoolExecutor):
    """Threads that finish what they do when they are asked to end, so that nothing is written later."""

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        super().shutdown(wait=True, cancel_futures=cancel_futures)


def _is_short(sweep: Sweep) -> bool:
    """Whether no case can have so many rows that they need much memory."""
    from granular_contact.scene.steps import steps

    solver, varies = steps(sweep.base), any(key.startswith("solver") for key in sweep.keys)
    return not varies and solver.end_time_s / solver.step_s <= MOST_STEPS


def _without_finished(tasks: Sequence[Task], journal: Journal) -> Generator[Row, None, list[Task]]:
    """Rows of tasks that finished before their worker died; returns the other tasks."""
    pending = {task.index for task in tasks}
    found = [row for row in journal if row.index in pending]
    yield from found
    pending -= {row.index for row in found}
    return [task for task in tasks if task.index in pending]


def _tasks(sweep: Sweep, done: Collection[int]) -> Iterator[Task]:
    for index, case in enumerate(sweep.cases):
        if index not in done:
            yield Task(index, case, sweep.scenario(case) if sweep.needs_files(case) else None)


class _Scheduler:
    """Divides the cases into chunks: large enough that sending them costs little, small towards the end."""

    def __init__(self, tasks: Iterator[Task], count: int, workers: int) -> None:
        self._tasks, self.left, self._workers = tasks, count, workers
        self._size = 1

    def take(self) -> list[Task]:
        """The next chunk of cases."""
        size = max(1, min(self._size, self.left // (2 * self._workers)))
        chunk = list(islice(self._tasks, size))
        self.left -= len(chunk)
        return chunk

    def note(self, cases: int, seconds: float) -> None:
        """Update the size of chunks by the time of the latest one, as a worker's first chunk is slower."""
        self._size = max(1, min(LARGEST_CHUNK, int(CHUNK_SECONDS * cases / max(seconds, 1e-6))))


def _together(scheduler: _Scheduler, pool: WorkerPool, job: bytes, suspects: list[Task]) -> Iterator[bytes]:
    """Lines of all cases but those of lost chunks, which go to `suspects`: one may have killed its worker."""
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
            scheduler.note(len(lines), seconds)
            yield from lines


def _one_by_one(suspects: Sequence[Task], sweep: Sweep, pool: WorkerPool, job: bytes) -> Iterator[tuple[bytes, bool]]:
    """Lines of cases that run alone, and whether the row was lost."""
    pool.shutdown()  # new workers, that no other case has harmed
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
