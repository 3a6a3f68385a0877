"""Whether a kernel is being compiled, told when it begins: with the first run of a law in an installation.

Numba tells of what it compiles as it begins (its events `numba:compile` of a function, `numba:run_pass` of each pass
over one, which alone tell of C functions), and says nothing when it finds the kernel in its cache on the disk; so
nothing needs to be guessed beforehand.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

_spent = 0.0  # in all blocks of `announced` so far (s)


def seconds() -> float:
    """Wall time (s) that this process has compiled in blocks of `announced`, so that it can be left out of a run's."""
    return _spent


@contextmanager
def announced(tell: Callable[[str], None] | None, what: str) -> Iterator[None]:
    """Call `tell` with a sentence once, when the first kernel is compiled inside; `what` is being compiled.

    Without numba loaded there is nothing to compile, and it is not loaded for this. Of a numba without such events
    nothing is told.
    """
    if tell is None or "numba" not in sys.modules:
        yield
        return
    try:
        from numba.core import event
    except ImportError:
        yield
        return

    say = tell

    class Listener(event.Listener):  # type: ignore[misc]  # numba has no types
        """Tells of the first start, and adds up the time from each start to its end; compilations may be nested."""

        has_said, depth, begin = False, 0, 0.0

        def on_start(self, event: Any) -> None:  # noqa: ARG002
            if not self.has_said:
                self.has_said = True
                say(f"compiling {what}, once in an installation: 2 to 20 s, or half a minute if it is the first")
            if self.depth == 0:
                self.begin = time.perf_counter()
            self.depth += 1

        def on_end(self, event: Any) -> None:  # noqa: ARG002
            global _spent
            self.depth -= 1
            if self.depth == 0:
                _spent += time.perf_counter() - self.begin

    listener = Listener()
    with event.install_listener("numba:compile", listener), event.install_listener("numba:run_pass", listener):
        yield
