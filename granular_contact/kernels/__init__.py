"""Compiled code: arrays in, arrays out.

numba keeps what it compiled beside the sources and takes it again while the file of the called function is unchanged;
it does not see that a function of another file, inlined into it, has changed. So what is older than any kernel or law
is dropped.
"""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

_HERE = Path(__file__).parent


def _drop_stale_cache(*folders: Path) -> None:
    newest = max(source.stat().st_mtime for folder in folders for source in folder.glob("*.py"))
    for cached in (file for folder in folders for file in (folder / "__pycache__").glob("*.nb[ic]")):
        with suppress(OSError):  # another process was faster, or the folder is not ours to change
            if cached.stat().st_mtime < newest:
                cached.unlink()


_drop_stale_cache(_HERE, _HERE.parent / "laws")


def __getattr__(name: str) -> Any:
    """A module of kernels, loaded when first asked for: laws name them, and are read without the compiler."""
    if not (_HERE / f"{name}.py").exists():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"{__name__}.{name}")
