"""Processes to work in, on this machine: warm, single-threaded, deaf to Ctrl-C, and gone when the sweep is."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import wait as await_any
from typing import Any

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
# What a worker needs anyway; where workers are forked from a server, it is imported once for all of them. Nothing of
# ours: the server looks into the working folder first, and a checkout there is not the package that was installed.
_PRELOADED = ["numpy", "exudyn", "numba", "pydantic", "yaml"]
# Far more than a pool takes to close its pipes; on Python 3.10 one that still has work to hand over never does.
_LEAVE_S = 10.0
_HEARS_S = 5.0  # a pool hears of a lost worker in milliseconds


def cores() -> int:
    """Cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)  # not everywhere
    return len(affinity(0)) if affinity else os.cpu_count() or 1


class _Processes(ProcessPoolExecutor):
    """A pool whose workers start with one thread and without Ctrl-C, which is for the process that has the rows."""

    _watched: threading.Thread | None = None
    _watcher: threading.Thread | None = None

    def submit(self, *arguments: Any, **keywords: Any) -> Future[Any]:
        # Workers start in here; they inherit the environment and the blocked signals.
        with _no_interrupt(), _one_thread():
            future = super().submit(*arguments, **keywords)
        # There is no public way to what follows.
        manager: Any = self._executor_manager_thread
        if manager is not self._watched:
            self._watched = manager
            inside = manager, self._processes, self._result_queue
            self._watcher = threading.Thread(target=_watch, args=inside, daemon=True)
            self._watcher.start()
        return future

    def __exit__(self, kind: Any, *rest: Any) -> bool | None:
        if kind is None:
            return super().__exit__(kind, *rest)
        self.shutdown(wait=False, cancel_futures=True)
        return None

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """As of any executor; `wait=False` with `cancel_futures` ends the work under way as well."""
        # There is no public way to do this before Python 3.14.
        processes = list((getattr(self, "_processes", None) or {}).values())
        manager = getattr(self, "_executor_manager_thread", None)
        super().shutdown(wait=wait, cancel_futures=cancel_futures)
        if cancel_futures and not wait:
            for process in processes:
                process.terminate()
            alive = {process.sentinel for process in processes}
            while alive:
                alive -= set(await_any(list(alive)))
            if manager is not None:
                # It closes the pipe that the interpreter writes to at its exit, and does not look whether it does.
                manager.join(_LEAVE_S)
            if self._watcher is not None:
                self._watcher.join(_LEAVE_S)


def _watch(manager: threading.Thread, processes: dict[int, Any], results: Any) -> None:
    """Let a pool hear of a lost worker that keeps it waiting.

    Who is killed while it writes a result leaves half of it in the pipe, and the pipe's lock taken; the thread that
    manages the pool then reads for ever. With nobody left who could write, it comes to the end of the pipe.
    """
    try:
        while manager.is_alive():
            if not await_any([process.sentinel for process in list(processes.values())], timeout=1.0):
                continue
            manager.join(_HEARS_S)
            if manager.is_alive():
                for process in list(processes.values()):
                    process.kill()
                    process.join()
                results._writer.close()
                return
    except (OSError, ValueError):  # it was dismissed meanwhile
        return


def local_processes(workers: int) -> Executor:
    """Pool of processes on this machine."""
    prepare()
    context: Any = multiprocessing.get_context("forkserver" if _has_server() else "spawn")
    return _Processes(workers, mp_context=context, initializer=_start)


def prepare() -> None:
    """Start the server that workers are forked from, without waiting: it imports meanwhile what they will need."""
    if _has_server():
        from multiprocessing import forkserver, resource_tracker

        forkserver.set_forkserver_preload(_PRELOADED)
        resource_tracker.ensure_running()  # by itself, since it lets Ctrl-C through again once it has started
        with _no_interrupt(), _one_thread():
            forkserver.ensure_running()


def _has_server() -> bool:
    return "forkserver" in multiprocessing.get_all_start_methods()


def _start() -> None:
    """First thing in a worker: be deaf, and die with the process that started it, even where that one is killed."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_follow, args=(parent.sentinel,), daemon=True).start()
    if hasattr(signal, "pthread_sigmask"):
        # Not only ignored: a solve would listen again.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    else:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _follow(sentinel: int) -> None:
    await_any([sentinel])
    os._exit(1)


@contextmanager
def _one_thread() -> Iterator[None]:
    """Let processes that start now use one thread each: there are as many of them as cores."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextmanager
def _no_interrupt() -> Iterator[None]:
    """Keep Ctrl-C, sent to all processes of a terminal, from those that start now; here it only comes later."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
