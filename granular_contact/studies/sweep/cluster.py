"""Workers on a Dask cluster (extra `[cluster]`): the scheduler and workers of the package distributed.

The user starts the workers, one process for each core, because a run holds the lock of the interpreter:

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

ANSWER_SECONDS = 8.0  # timeout of the scheduler
MISSING = "--scheduler needs distributed: pip install 'granular-contact[cluster]'"


def cluster_pool(address: str, folder: Path | None = None) -> WorkerPool:
    """Return a pool of the workers of a cluster; address: of its scheduler, as tcp://host:8786.

    folder: for the results of each case; all workers must see it.

    Raises
    ------
    WorkerPoolError
        The scheduler does not answer or has no workers, or a worker has several threads or other versions than this
        process.
    """
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError:
        raise WorkerPoolError(MISSING) from None
    _silence()
    begin = time.monotonic()
    try:
        # A client without a scheduler waits twice as long before it gives up, so a plain request comes first.
        asyncio.run(_identity(address))
        client = distributed.Client(address, timeout=ANSWER_SECONDS, set_as_default=False)
    except Exception as error:  # any server may listen at the address
        fault = " ".join(str(error).split()) if isinstance(error, ValueError) else "no Dask scheduler answers"
        raise WorkerPoolError(f"--scheduler {address}: {fault} ({time.monotonic() - begin:.0f} s waited)") from None
    try:
        workers = _checked_workers(client, address, folder)
    except BaseException:
        client.close()
        raise
    return _ClusterPool(client, address, workers)


def _silence() -> None:
    """Silence all loggers of distributed, because every problem also raises an exception.

    Child loggers are included, since some have their own level.
    """
    children = (name for name in logging.root.manager.loggerDict if name.startswith("distributed."))
    for name in ("distributed", *children):
        logging.getLogger(name).setLevel(logging.CRITICAL)


async def _identity(address: str) -> None:
    """Ask a scheduler for its identity; raises if there is no answer in time."""
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
    """Pool of the workers of one client, which is closed at the end."""

    def __init__(self, client: Any, address: str, workers: int) -> None:
        super().__init__(workers, lambda _: _ClusterExecutor(client, address), local=False)
        self._client = client

    def __exit__(self, *error: Any) -> None:
        super().__exit__(*error)
        self._client.close()


class _ClusterExecutor(Executor):
    """Executor that returns futures of `concurrent.futures` for tasks of distributed.

    With distributed's own executor a future never ends if its worker dies after the end of the task and before the
    result is fetched.
    """

    def __init__(self, client: Any, address: str) -> None:
        self._client, self._address = client, address
        self._pending: set[Any] = set()

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **keywords: Any) -> Future[Any]:
        """`Executor.submit`."""
        outcome: Future[Any] = Future()
        try:
            inner = self._client.submit(function, *arguments, pure=False, **keywords)
        except (RuntimeError, OSError) as error:
            raise self._lost() from error
        self._pending.add(inner)
        inner.add_done_callback(partial(self._settle, outcome))
        return outcome

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        """Cancel unfinished tasks; the workers keep running."""
        self._client.cancel(list(self._pending))

    def _settle(self, outcome: Future[Any], inner: Any) -> None:
        distributed: Any = importlib.import_module("distributed")
        try:
            outcome.set_result(inner.result())
        except distributed.KilledWorker as error:
            outcome.set_exception(BrokenExecutor(str(error)))
        except (CancelledError, distributed.comm.CommClosedError):  # the latter while a result is fetched
            outcome.set_exception(self._lost())
        except BaseException as error:
            outcome.set_exception(error)
        self._pending.discard(inner)

    def _lost(self) -> WorkerPoolError:
        return WorkerPoolError(f"--scheduler {self._address}: the connection is lost")


def _checked_workers(client: Any, address: str, folder: Path | None) -> int:
    """Check all workers and return their number.

    Each must have one thread, the versions of this process (so that it computes the same rows), and see the folder.
    """
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
    environments = client.get_versions()["workers"]
    for package, version in versions().items():
        if package == "python":
            installed = {worker: about["host"]["python"].split(".final")[0] for worker, about in environments.items()}
        elif package == "granular-contact":  # by functions of Python itself, which every worker has
            installed = client.run(eval, "__import__('granular_contact').__version__", on_error="return")
        else:
            installed = client.run(metadata.version, package, on_error="return")
        for worker, other in installed.items():
            if other != version:
                has = f"has {package} {other}" if isinstance(other, str) else f"has no {package}"
                message = f"the worker {worker} {has}, but this process has {version}"
                raise WorkerPoolError(f"--scheduler {address}: {message}")
    if folder is not None:
        visible = client.run(os.path.isdir, str(folder))
        blind = next((worker for worker, sees in visible.items() if not sees), None)
        if blind is not None:
            message = f"the worker {blind} does not see {folder}, the folder for the results of --plots"
            raise WorkerPoolError(f"--scheduler {address}: {message}")
    return len(client.nthreads())
