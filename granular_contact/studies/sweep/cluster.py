"""Workers on a Dask cluster (extra `[cluster]`): distributed's own scheduler and workers.

Workers are started by the user, one process for each core, as runs hold the interpreter:

    dask scheduler
    dask worker tcp://HOST:8786 --nworkers auto --nthreads 1
"""

from __future__ import annotations

import asyncio
import importlib
import logging
import os
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

from granular_contact.errors import WorkerPoolError
from granular_contact.results.summary import versions
from granular_contact.studies.sweep.executor import WorkerPool

ANSWER_SECONDS = 8.0  # until a scheduler counts as silent
MISSING = "--scheduler needs distributed: pip install 'granular-contact[cluster]'"


def cluster_pool(address: str, folder: Path | None = None) -> WorkerPool:
    """The workers of the cluster whose scheduler is at `address`, as tcp://host:8786.

    folder: one that they must see, for the results of each case.

    Raises
    ------
    WorkerPoolError
        The scheduler does not answer, or has no workers, or such that would not compute what this process would.
    """
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError:
        raise WorkerPoolError(MISSING) from None
    _silence()
    begin = time.monotonic()
    try:
        # A client that finds nobody takes as long again to give up; so one plain question comes first.
        asyncio.run(_identity(address))
        client = distributed.Client(address, timeout=ANSWER_SECONDS, set_as_default=False)
    except Exception as error:  # what speaks there may be anything
        said = " ".join(str(error).split()) if isinstance(error, ValueError) else "no Dask scheduler answers"
        raise WorkerPoolError(f"--scheduler {address}: {said} ({time.monotonic() - begin:.0f} s waited)") from None
    try:
        workers = _fit(client, address, folder)
    except BaseException:
        client.close()
        raise
    return _ClusterPool(client, address, workers)


def _silence() -> None:
    """Silence distributed's loggers, as every problem comes as an exception. Some child loggers have a level of their
    own, which is set, too.
    """
    for name in ("distributed", *(n for n in logging.root.manager.loggerDict if n.startswith("distributed."))):
        logging.getLogger(name).setLevel(logging.CRITICAL)


async def _identity(address: str) -> None:
    """Ask a scheduler who it is; raises if there is no answer in time."""
    core: Any = importlib.import_module("distributed.core")

    async def ask() -> None:
        comm = await core.connect(address, timeout=ANSWER_SECONDS)
        try:
            await comm.write({"op": "identity", "reply": True})
            if (await comm.read()).get("type") != "Scheduler":
                raise OSError("no scheduler")
        finally:
            comm.abort()

    await asyncio.wait_for(ask(), ANSWER_SECONDS)


class _ClusterPool(WorkerPool):
    """Workers of one client, which is closed at the end."""

    def __init__(self, client: Any, address: str, workers: int) -> None:
        super().__init__(workers, lambda _: _ClusterExecutor(client, address), local=False)
        self._client = client

    def __exit__(self, *error: Any) -> None:
        super().__exit__(*error)
        self._client.close()


class _ClusterExecutor(Executor):
    """distributed's futures as those of an executor of this machine.

    Its own executor leaves a future without an answer for ever where a worker dies after a task has ended and before
    its result was fetched.
    """

    def __init__(self, client: Any, address: str) -> None:
        self._client, self._address = client, address
        self._pending: set[Any] = set()

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **keywords: Any) -> Future[Any]:
        """As of any executor."""
        outcome: Future[Any] = Future()
        try:
            inner = self._client.submit(function, *arguments, pure=False, **keywords)
        except (RuntimeError, OSError) as error:
            raise self._gone() from error
        self._pending.add(inner)
        inner.add_done_callback(partial(self._settle, outcome))
        return outcome

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        """Cancel what has not ended; the workers stay."""
        self._client.cancel(list(self._pending))

    def _settle(self, outcome: Future[Any], inner: Any) -> None:
        distributed: Any = importlib.import_module("distributed")
        try:
            outcome.set_result(inner.result())
        except distributed.KilledWorker as error:
            outcome.set_exception(BrokenExecutor(str(error)))
        except (CancelledError, distributed.comm.CommClosedError):  # the latter while a result is fetched
            outcome.set_exception(self._gone())
        except BaseException as error:
            outcome.set_exception(error)
        self._pending.discard(inner)

    def _gone(self) -> WorkerPoolError:
        return WorkerPoolError(f"--scheduler {self._address}: the connection is lost")


def _fit(client: Any, address: str, folder: Path | None) -> int:
    """Number of workers; each must have the versions of this process, so that it gives the same rows."""
    try:
        client.wait_for_workers(1, timeout=2.0)
    except TimeoutError:
        raise WorkerPoolError(
            f"--scheduler {address}: it has no workers; start some with dask worker {address}"
        ) from None
    for worker, threads in client.nthreads().items():
        if threads != 1:
            message = f"the worker {worker} has {threads} threads; start workers with --nthreads 1"
            raise WorkerPoolError(f"--scheduler {address}: {message}")
    pythons = client.get_versions()["workers"]
    here = versions()
    for package, version in here.items():
        if package == "python":
            found = {worker: about["host"]["python"] for worker, about in pythons.items()}
            found = {worker: there.split(".final")[0] for worker, there in found.items()}
        elif package == "granular-contact":  # functions of Python itself, which every worker has
            found = client.run(eval, "__import__('granular_contact').__version__", on_error="return")
        else:
            found = client.run(metadata.version, package, on_error="return")
        for worker, there in found.items():
            if there != version:
                has = f"has {package} {there}" if isinstance(there, str) else f"has no {package}"
                raise WorkerPoolError(f"--scheduler {address}: the worker {worker} {has}, and here is {version}")
    if folder is not None:
        seen = client.run(os.path.isdir, str(folder))
        blind = next((worker for worker, sees in seen.items() if not sees), None)
        if blind is not None:
            raise WorkerPoolError(f"--scheduler {address}: the worker {blind} does not see {folder}, where --plots go")
    return len(client.nthreads())
