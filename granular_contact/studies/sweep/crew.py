"""Whoever works on a sweep: an executor that is made when it is needed, and made again when it is broken."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from types import TracebackType

from granular_contact.errors import GranularContactError
from granular_contact.studies.sweep.pool import cores, local_processes

ExecutorFactory = Callable[[int], Executor]


class CrewError(GranularContactError):
    """Those who should work can't be reached, or can't do this work; the message is one line."""


class Crew:
    """So many workers of one kind; leaving the block ends them and what they are at.

    here: whether they write to the disk of this machine, and so can keep their rows themselves.
    """

    def __init__(
        self, workers: int | None = None, executor: ExecutorFactory = local_processes, *, here: bool = True
    ) -> None:
        """Take `workers` (all cores unless given) of what `executor` gives for a number of workers."""
        self.count, self.executor, self.here = workers or cores(), executor, here
        self._pool: Executor | None = None

    def pool(self) -> Executor:
        """The executor, ready for work."""
        if self._pool is None:
            self._pool = self.executor(self.count)
        return self._pool

    def dismiss(self) -> None:
        """End the executor; the next call of `pool` makes a new one."""
        pool, self._pool = self._pool, None
        if pool is not None:
            pool.shutdown(wait=False, cancel_futures=True)

    def __enter__(self) -> Crew:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.dismiss()
