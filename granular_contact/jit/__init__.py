"""Compilation with numba: the only room that uses more of the compiler than `njit`.

compiled    `kernel` for functions that Python calls, `part` for functions that kernels call
calls       calls of functions by their addresses, and why
chosen      functions chosen by the record type of an argument
memory      views, small arrays and records within a kernel
layout      arrays of Python at fixed addresses, which a kernel finds by their names
records     record types whose fields are read and written as attributes
compiling   notice and time of a compilation
loaded      what numba loads with its first kernel, in advance for worker processes

numba caches compiled code beside the sources and reuses it while the file of the called function is unchanged. It does
not notice changes of inlined functions in other files. So cached code that is older than any kernel or law is deleted.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

_PACKAGE = Path(__file__).parents[1]


def compiled_sources() -> list[Path]:
    """Source files of compiled code: rooms named `kernels`, this room, and laws."""
    rooms = [*_PACKAGE.rglob("kernels"), _PACKAGE / "jit", _PACKAGE / "laws"]
    return sorted(file for room in rooms for file in room.glob("*.py"))


def _drop_stale_cache() -> None:
    sources = compiled_sources()
    newest = max(source.stat().st_mtime for source in sources)
    for folder in {source.parent for source in sources}:
        for cached in (folder / "__pycache__").glob("*.nb[ic]"):
            with suppress(OSError):  # another process was faster, or the folder is read-only
                if cached.stat().st_mtime < newest:
                    cached.unlink()


_drop_stale_cache()
