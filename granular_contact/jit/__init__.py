"""How functions are compiled, with numba: the only room that speaks to the compiler beyond `njit`.

compiled    `kernel` for functions that Python calls, `part` for those that kernels call
calls       a law called by its address, and why
chosen      functions chosen by the record type of an argument
memory      views and small arrays within a kernel
layout      arrays of Python at fixed addresses, which a kernel finds by their names
records     record types whose fields are read and written
compiling, loaded    telling that something is compiled; what was loaded

numba keeps what it compiled beside the sources and takes it again while the file of the called function is unchanged;
it does not see that a function of another file, inlined into it, has changed. So what is older than any kernel or law
is dropped.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

_PACKAGE = Path(__file__).parents[1]


def compiled_sources() -> list[Path]:
    """Files of all that is compiled: rooms named `kernels`, this one, and laws."""
    rooms = [*_PACKAGE.rglob("kernels"), _PACKAGE / "jit", _PACKAGE / "laws"]
    return sorted(file for room in rooms for file in room.glob("*.py"))


def _drop_stale_cache() -> None:
    sources = compiled_sources()
    newest = max(source.stat().st_mtime for source in sources)
    for folder in {source.parent for source in sources}:
        for cached in (folder / "__pycache__").glob("*.nb[ic]"):
            with suppress(OSError):  # another process was faster, or the folder is not ours to change
                if cached.stat().st_mtime < newest:
                    cached.unlink()


_drop_stale_cache()
