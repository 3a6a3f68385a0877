"""Pool of the workers of a sweep: an executor that is created when needed, and again after a shutdown."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor

from granular_contact.errors import whole
from granular_contact.studies.processes import cores, local_processes

ExecutorFactory = Callable[[int], Executor]


class WorkerPool:
    """A number of workers of one kind; leaving the `with` block ends them, with the tasks that they work on.

    Parameters
    ----------
    workers : int, optional
        Number of workers, by default one per core.
    factory : callable, optional
        Function from the number of workers to an executor, by default of processes on this machine.
    local : bool, optional
        Whether workers write to the disk of this machine, so that they can store their rows themselves.
    """

    def __init__(
        self, workers: int | None = None, factory: ExecutorFactory = local_processes, *, local: bool = True
    ) -> None:
        whole("workers", workers, 1, none=True)
        self.count, self.local = workers or cores(), local
        self._factory = factory
        self._executor: Executor | None = None

    def executor(self) -> Executor:
        """Return the executor, ready for tasks."""
        if self._executor is None:
            self._executor = self._factory(self.count)
        return self._executor

    def shutdown(self) -> None:
        """End the executor at once; the next call of `executor` creates a new one."""
        executor, self._executor = self._executor, None
        if executor is not None:
            executor.shutdown(wait=False, cancel_futures=True)

    def __enter__(self) -> WorkerPool:
        return self

    def __exit__(self, *error: object) -> None:
        self.shutdown()
