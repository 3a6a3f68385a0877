"""Whether a kernel is being compiled, told when it begins: with the first run of a law in an installation.

Numba tells of what it compiles as it begins (its events `numba:compile` of a function, `numba:run_pass` of each pass
over one, which alone tell of C functions), and says nothing when it finds the kernel in its cache on the disk; so
nothing needs to be guessed beforehand.

Meanwhile nobody looks for cycles of objects that are no longer used (Python's `gc`): numba makes a million objects that
mostly stay, and looking at all of them time and again takes a tenth of all compiling.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

_spent = 0.0  # by this process so far (s)
_tell: Callable[[], object] | None = None  # called once, when the first kernel is compiled


def seconds() -> float:
    """Wall time (s) that this process has compiled, so that it can be left out of a run's."""
    return _spent


@contextmanager
def announced(tell: Callable[[str], None] | None, what: str) -> Iterator[None]:
    """Call `tell` with a sentence once, when the first kernel is compiled inside; `what` is being compiled.

    Of a numba without such events nothing is told.
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
    """Have numba tell from now on; called where it is loaded, since it is not loaded for this."""
    try:
        from numba.core import event
    except ImportError:
        return

    class Listener(event.Listener):  # type: ignore[misc]  # numba has no types
        """Adds up the time from each start to its end, without `gc`; compilations may be nested."""

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
