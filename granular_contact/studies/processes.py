"""Worker processes on this machine: modules imported in advance, one thread each, SIGINT blocked, ended with the sweep.

Each has a thread and a pipe of its own here. A process that dies closes its pipe, even with half a result in it: its
task is known, and the others go on. The pools of the standard library and of loky share one pipe for all results, and
wait forever for the other half; loky's processes outlive a killed parent besides, and those of dask's local cluster
take seconds to start and to end. A lost task raises `BrokenExecutor` in all of them.
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

# Workers print nothing of their own, and `import exudyn` would where it finds settings in ~/.exudyn; nor do results
# depend on these.
_QUIET = {"EXUDYN_NO_USER_SETTINGS": "1"}
_UNGUARDED = 'a script that starts worker processes is read by each of them: put it below `if __name__ == "__main__":`'
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
# What a worker needs anyway; where workers are forked from a server, it is imported once for all of them. numba and
# pydantic import most of themselves only when they are first used.
_NUMBA = ["np.arraymath", "np.linalg", "np.polynomial", "np.random.generator_methods", "cpython.randomimpl"]
_NUMBA += ["cpython.heapq", "cpython.charseq", "typed.typeddict", "typed.setobject", "misc.cffiimpl", "core.ccallback"]
_PRELOADED = ["numpy", "exudyn", "numba", "pydantic.json_schema", "yaml", *(f"numba.{name}" for name in _NUMBA)]
_OURS = ["studies.sweep.worker", "scene", "engines.exudyn.build", "engines.exudyn.solve", "engines.tree.solve"]
_OURS += ["mechanics.observe", "sand.of_scene", "run", "jit.loaded"]
_PACKAGE, _FOLDER = __name__.partition(".")[0], str(Path(__file__).parents[2])
_HAS_SERVER = "forkserver" in multiprocessing.get_all_start_methods()
# The server imports from the working folder first, unless it is asked not to: a checkout there may be another package
# than the one at work here.
_CAN_TELL = hasattr(sys.flags, "safe_path") and not sys.flags.ignore_environment


def cores() -> int:
    """Cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)  # not everywhere
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def local_processes(workers: int) -> Executor:
    """Pool of processes on this machine."""
    prepare()
    return _Processes(workers)


def prepare() -> None:
    """Start the fork server without waiting: meanwhile it imports what the workers need."""
    if _HAS_SERVER:
        from multiprocessing import forkserver, resource_tracker

        ours = [f"{_PACKAGE}.{name}" for name in _OURS] if _CAN_TELL else []
        forkserver.set_forkserver_preload([*_PRELOADED, *ours])
        resource_tracker.ensure_running()  # by itself, since it lets Ctrl-C through again once it has started
        # A folder of installed packages is on the path anyway, behind the standard library.
        first = "" if sysconfig.get_path("purelib") == _FOLDER else _FOLDER
        path = os.pathsep.join(filter(None, [first, os.environ.get("PYTHONPATH")]))
        with _as_workers(PYTHONSAFEPATH="1", PYTHONPATH=path):
            forkserver.ensure_running()


class _Processes(Executor):
    """Threads with a worker process each, which starts with the first task."""

    def __init__(self, workers: int) -> None:
        self._threads, self._own = ThreadPoolExecutor(workers), threading.local()
        self._context: Any = multiprocessing.get_context("forkserver" if _HAS_SERVER else "spawn")
        self._lock, self._ended = threading.Lock(), False
        self._started: list[tuple[Any, Connection]] = []

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **keywords: Any) -> Future[Any]:
        """As of any executor; a task whose process died has the exception BrokenExecutor, WorkerPoolError if it did
        before it could begin.
        """
        return self._threads.submit(self._call, function, arguments, keywords)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """As of any executor; `wait=False` with `cancel_futures` also ends running tasks."""
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
        """In one of the threads: the result of a function with its arguments, computed in the worker process."""
        task = pickle.dumps(call)
        try:
            if not hasattr(self._own, "pipe"):
                self._own.pipe = self._start()
            self._own.pipe.send_bytes(task)
            answer = self._own.pipe.recv_bytes()
        except (EOFError, OSError):
            vars(self._own).pop("pipe", None)  # the next task gets another process
            raise BrokenExecutor("the process died during a task") from None
        fine, outcome = pickle.loads(answer)
        if fine:
            return outcome
        raise outcome

    def _start(self) -> Connection:
        """The pipe to a new process, which is ready."""
        with self._lock, _as_workers():
            if self._ended:
                raise BrokenExecutor("the work was ended")
            here, there = self._context.Pipe()
            process = self._context.Process(target=_serve, args=(there,), daemon=True)
            try:
                process.start()
            except RuntimeError as error:  # this is a worker that reads the script
                raise WorkerPoolError(_UNGUARDED) from error
            there.close()  # so that the process alone can write to it
            self._started.append((process, here))
        try:
            here.recv_bytes()
        except (EOFError, OSError):
            if self._ended:
                raise BrokenExecutor("the work was ended") from None
            raise WorkerPoolError(f"a worker process ended before its first task; {_UNGUARDED}") from None
        return here  # type: ignore[no-any-return]


def _serve(pipe: Connection) -> None:
    """Main loop of a worker: run tasks from the pipe until it is closed; exit when the parent process dies."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_follow, args=(parent.sentinel,), daemon=True).start()
    if hasattr(signal, "pthread_sigmask"):
        # Not only ignored: a solve would listen again.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    else:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.freeze()  # what is imported stays, and need not be looked through again and again
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
    except Exception:  # it holds what can't be sent
        return pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}")))


def _follow(sentinel: int) -> None:
    await_any([sentinel])
    os._exit(1)


@contextmanager
def _as_workers(**more: str) -> Iterator[None]:
    """Processes that start now use one thread each and have SIGINT blocked: a terminal sends it to all its processes,
    but only the parent handles it. Here it is delayed until the end. more: of their environment.
    """
    environment = dict.fromkeys(_THREADS, "1") | _QUIET | more
    before = {name: os.environ.get(name) for name in environment}
    os.environ.update(environment)
    block = getattr(signal, "pthread_sigmask", None)  # not everywhere
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
