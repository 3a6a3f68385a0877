"""Notice that a kernel is being compiled, when the compilation begins: at the first run of a law in an installation.

Numba announces each compilation as it begins, by its events `numba:compile` of a function and `numba:run_pass` of each
compiler pass, which alone announce C functions. It announces nothing when it finds the kernel in its cache on disk, so
no guess beforehand is needed.

During compilation Python's cyclic garbage collector (`gc`) is off: numba makes a million objects that mostly stay, and
scanning them repeatedly takes a tenth of all compilation.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

_spent = 0.0  # compilation time of this process so far (s)
_tell: Callable[[], object] | None = None  # called once, when the first kernel compiles


def seconds() -> float:
    """Wall time (s) of compilation in this process, so that the time of a run can exclude it."""
    return _spent


@contextmanager
def announced(tell: Callable[[str], None] | None, what: str) -> Iterator[None]:
    """Call `tell` once with a sentence that names `what`, when the first kernel within the block compiles.

    A version of numba without these events tells nothing.
    """
    global _tell
    outer, _tell = _tell, None
    if tell is not None:
        _tell = partial(tell, f"compiling {what}, once in an installation: 2 to 40 s")
    try:
        yield
    finally:
        _tell = outer


def listen() -> None:
    """Listen to numba's events; called where numba is loaded, as it is not loaded for this alone."""
    try:
        from numba.core import event
    except ImportError:
        return

    class Listener(event.Listener):  # type: ignore[misc]  # numba has no types
        """Adds up the time from start to end of compilations, with `gc` off; compilations may be nested."""

        depth, begin, collects = 0, 0.0, False

        def on_start(self, event: Any) -> None:  # noqa: ARG002
            global _tell
            if _tell is not None:
                tell, _tell = _tell, None
                tell()
            if self.depth == 0:
                self.begin, self.collects = time.perf_counter(), gc.isenabled()
                gc.disable()
            self.depth += 1

        def on_end(self, event: Any) -> None:  # noqa: ARG002
            global _spent
            self.depth -= 1
            if self.depth == 0:
                _spent += time.perf_counter() - self.begin
                if self.collects:
                    gc.enable()

    listener = Listener()
    event.register("numba:compile", listener)
    event.register("numba:run_pass", listener)
