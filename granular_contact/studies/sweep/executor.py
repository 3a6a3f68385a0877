"""The workers of a sweep: an executor that is made when it is needed, and made anew after a shutdown."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor

from granular_contact.errors import whole
from granular_contact.studies.processes import cores, local_processes

ExecutorFactory = Callable[[int], Executor]


class WorkerPool:
    """A number of workers of one kind; leaving the `with` block ends them and the tasks they are working on.

    Parameters
    ----------
    workers : int, optional
        How many; one per core unless given.
    factory : callable, optional
        Makes an executor of that many workers; processes of this machine unless given.
    local : bool, optional
        Whether workers write to the disk of this machine, and so can keep their rows themselves.
    """

    def __init__(
        self, workers: int | None = None, factory: ExecutorFactory = local_processes, *, local: bool = True
    ) -> None:
        whole("workers", workers, 1, none=True)
        self.count, self.local = workers or cores(), local
        self._factory = factory
        self._executor: Executor | None = None

    def executor(self) -> Executor:
        """The executor, ready for tasks."""
        if self._executor is None:
            self._executor = self._factory(self.count)
        return self._executor

    def shutdown(self) -> None:
        """End the executor at once; the next call of `executor` makes a new one."""
        executor, self._executor = self._executor, None
        if executor is not None:
            executor.shutdown(wait=False, cancel_futures=True)

    def __enter__(self) -> WorkerPool:
        return self

    def __exit__(self, *error: object) -> None:
        self.shutdown()
