"""Whether a kernel is being compiled, told when it begins: with the first run of a law in an installation.

Numba tells of a compilation as it starts one, and says nothing when it finds the kernel in its cache on the disk; so
nothing needs to be guessed beforehand.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def announced(tell: Callable[[str], None] | None, what: str) -> Iterator[None]:
    """Call `tell` with a sentence once, when the first kernel is compiled inside; `what` is being compiled.

    Without numba loaded there is nothing to compile, and it is not loaded for this.
    """
    if tell is None or "numba" not in sys.modules:
        yield
        return
    from numba.core import event

    say = tell

    class Listener(event.Listener):  # type: ignore[misc]  # numba has no types
        """Tells of the first start."""

        told = False

        def on_start(self, event: Any) -> None:  # noqa: ARG002
            if not self.told:
                self.told = True
                say(f"compiling {what}; this takes up to half a minute, the first time in an installation")

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Listener()):
        yield
