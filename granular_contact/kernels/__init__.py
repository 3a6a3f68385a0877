"""Compiled code: arrays in, arrays out.

numba keeps what it compiled beside the sources and takes it again while the file of the called function is unchanged;
it does not see that a function of another file, inlined into it, has changed. So what is older than any kernel is
dropped.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path


def _drop_stale_cache(folder: Path) -> None:
    newest = max(source.stat().st_mtime for source in folder.glob("*.py"))
    for cached in (folder / "__pycache__").glob("*.nb[ic]"):
        with suppress(OSError):  # another process was faster, or the folder is not ours to change
            if cached.stat().st_mtime < newest:
                cached.unlink()


_drop_stale_cache(Path(__file__).parent)
