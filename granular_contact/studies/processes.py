"""Pool of worker processes on this machine: modules imported in advance, one thread each, SIGINT blocked.

In this process each worker has its own thread and its own pipe. A worker that dies closes its pipe, even in the middle
of a result, so the lost task is known and the other workers continue. The pools of the standard library and of loky
share one pipe for all results, and wait forever for the rest of such a result. In addition, loky's processes outlive a
killed parent, and those of dask's local cluster take seconds to start and to end. A lost task raises `BrokenExecutor`,
as in all of these pools.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import pickle
import signal
import sys
import sysconfig
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as await_any
from pathlib import Path
from typing import Any

from granular_contact.errors import WorkerPoolError

# `import exudyn` prints a message if it finds settings in ~/.exudyn. Workers must not print, nor depend on settings.
_QUIET = {"EXUDYN_NO_USER_SETTINGS": "1"}
_UNGUARDED = (
    "every worker process imports the script that starts it: "
    'put the lines of the script below `if __name__ == "__main__":`'
)
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
# Modules that every worker needs. A fork server imports them once for all workers. numba and pydantic import most of
# their modules only at first use, so these are listed too.
_NUMBA = ["np.arraymath", "np.linalg", "np.polynomial", "np.random.generator_methods", "cpython.randomimpl"]
_NUMBA += ["cpython.heapq", "cpython.charseq", "typed.typeddict", "typed.setobject", "misc.cffiimpl", "core.ccallback"]
_PRELOADED = ["numpy", "exudyn", "numba", "pydantic.json_schema", "yaml", *(f"numba.{name}" for name in _NUMBA)]
_OURS = ["studies.sweep.worker", "scene", "engines.exudyn.build", "engines.exudyn.solve", "engines.tree.solve"]
_OURS += ["mechanics.observe", "sand.from_scene", "run", "jit.loaded"]
_PACKAGE, _FOLDER = __name__.partition(".")[0], str(Path(__file__).parents[2])
_HAS_SERVER = "forkserver" in multiprocessing.get_all_start_methods()
# Without PYTHONSAFEPATH the server imports from the working folder first, where a checkout may contain another version
# of this package.
_HAS_SAFE_PATH = hasattr(sys.flags, "safe_path") and not sys.flags.ignore_environment


def cores() -> int:
    """Return the number of cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)  # not on every platform
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def local_processes(workers: int) -> Executor:
    """Return a pool of worker processes on this machine.

    Parameters
    ----------
    workers : int
        Number of processes, 1 or more. Each starts at its first task and computes with one thread.

    Returns
    -------
    Executor
        Functions, arguments and results of its tasks are pickled. The future of a task raises BrokenExecutor if its
        process died during the task, and WorkerPoolError if the process could not start.

    Raises
    ------
    ValueError
        There are no workers.
    """
    prepare()
    return _Processes(workers)


def prepare() -> None:
    """Start the fork server without waiting for it; it imports the modules that workers need."""
    if _HAS_SERVER:
        from multiprocessing import forkserver, resource_tracker

        ours = [f"{_PACKAGE}.{name}" for name in _OURS] if _HAS_SAFE_PATH else []
        forkserver.set_forkserver_preload([*_PRELOADED, *ours])
        resource_tracker.ensure_running()  # outside `_as_workers`, because it unblocks Ctrl-C when it has started
        # A folder of installed packages is already on the path, behind the standard library.
        first = "" if sysconfig.get_path("purelib") == _FOLDER else _FOLDER
        path = os.pathsep.join(filter(None, [first, os.environ.get("PYTHONPATH")]))
        with _as_workers(PYTHONSAFEPATH="1", PYTHONPATH=path):
            forkserver.ensure_running()


class _Processes(Executor):
    """Executor of threads, each of which starts its own worker process at its first task."""

    def __init__(self, workers: int) -> None:
        self._threads, self._local = ThreadPoolExecutor(workers), threading.local()
        self._context: Any = multiprocessing.get_context("forkserver" if _HAS_SERVER else "spawn")
        self._lock, self._ended = threading.Lock(), False
        self._started: list[tuple[Any, Connection]] = []

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **keywords: Any) -> Future[Any]:
        """`Executor.submit`; the future raises BrokenExecutor if the process died during the task, WorkerPoolError if
        the process died before its first task.
        """
        return self._threads.submit(self._call, function, arguments, keywords)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """`Executor.shutdown`; `wait=False` with `cancel_futures=True` also terminates running tasks."""
        end_now = cancel_futures and not wait
        self._threads.shutdown(wait=not end_now, cancel_futures=cancel_futures)
        with self._lock:
            self._ended = True
        for process, pipe in self._started:
            if end_now:
                process.terminate()
            else:
                pipe.close()
            process.join()
        self._threads.shutdown()

    def __exit__(self, kind: Any, *_: Any) -> None:
        self.shutdown(wait=kind is None, cancel_futures=kind is not None)

    def _call(self, *call: Any) -> Any:
        """Compute the result of a function call in the worker process of this thread."""
        task = pickle.dumps(call)
        try:
            if not hasattr(self._local, "pipe"):
                self._local.pipe = self._start()
            self._local.pipe.send_bytes(task)
            answer = self._local.pipe.recv_bytes()
        except (EOFError, OSError):
            vars(self._local).pop("pipe", None)  # the next task gets another process
            raise BrokenExecutor("the process died during a task") from None
        succeeded, outcome = pickle.loads(answer)
        if succeeded:
            return outcome
        raise outcome

    def _start(self) -> Connection:
        """Start a new process, wait until it is ready, and return the pipe to it."""
        with self._lock, _as_workers():
            if self._ended:
                raise BrokenExecutor("the work was ended")
            parent_end, worker_end = self._context.Pipe()
            process = self._context.Process(target=_serve, args=(worker_end,), daemon=True)
            try:
                process.start()
            except RuntimeError as error:  # this process is itself a worker that imports the script
                raise WorkerPoolError(_UNGUARDED) from error
            worker_end.close()  # so that the pipe closes when the worker ends
            self._started.append((process, parent_end))
        try:
            parent_end.recv_bytes()
        except (EOFError, OSError):
            if self._ended:
                raise BrokenExecutor("the work was ended") from None
            raise WorkerPoolError(f"a worker process ended before its first task; {_UNGUARDED}") from None
        return parent_end  # type: ignore[no-any-return]


def _serve(pipe: Connection) -> None:
    """Main loop of a worker: run tasks from the pipe until it is closed; exit when the parent process dies."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_follow, args=(parent.sentinel,), daemon=True).start()
    if hasattr(signal, "pthread_sigmask"):
        # Blocked and not only ignored, because a solve installs its own handler.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    else:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.freeze()  # imported objects stay, so the garbage collector need not visit them
    pipe.send_bytes(b"")
    while True:
        try:
            task = pipe.recv_bytes()
        except (EOFError, OSError):
            return
        try:
            function, arguments, keywords = pickle.loads(task)
            answer = pickle.dumps((True, function(*arguments, **keywords)))
        except BaseException as error:
            answer = _pickled(error)
        pipe.send_bytes(answer)


def _pickled(error: BaseException) -> bytes:
    try:
        return pickle.dumps((False, error))
    except Exception:  # the exception contains objects that can't be pickled
        return pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}")))


def _follow(sentinel: int) -> None:
    await_any([sentinel])
    os._exit(1)


@contextmanager
def _as_workers(**more: str) -> Iterator[None]:
    """Give processes that start within the block one thread each and a blocked SIGINT; more: environment variables.

    A terminal sends SIGINT to all its processes, but only the parent handles it. In the parent it is delayed until the
    end of the block.
    """
    environment = dict.fromkeys(_THREADS, "1") | _QUIET | more
    before = {name: os.environ.get(name) for name in environment}
    os.environ.update(environment)
    block = getattr(signal, "pthread_sigmask", None)  # not on every platform
    mask = block(signal.SIG_BLOCK, {signal.SIGINT}) if block else None
    try:
        yield
    finally:
        if block:
            block(signal.SIG_SETMASK, mask)
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
