"""Data first, then pictures: what only shows is drawn when the data is saved, and one that fails costs only itself."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from granular_contact.errors import FigureWarning


@contextmanager
def drawn(file: Path) -> Iterator[Path]:
    """Give a path to draw to, which gets the name `file` when the block ends; the folder is made if it is missing.

    An exception of the block leaves no file, and becomes a `FigureWarning`.
    """
    making = file.with_name(f".{file.name}")
    try:
        file.parent.mkdir(exist_ok=True)
        yield making
        os.replace(making, file)
    except Exception as error:  # whatever drawing may raise: the numbers do not depend on it
        reason = " ".join(str(getattr(error, "strerror", None) or error).split())
        words = f"{type(error).__name__}: {reason}" if reason else type(error).__name__
        warnings.warn(f"{file} is missing, as drawing it failed ({words})", FigureWarning, stacklevel=3)
    finally:
        with suppress(OSError):
            making.unlink()


@contextmanager
def saved_before(directory: Path) -> Iterator[None]:
    """Let a Ctrl-C among the pictures say that the data is in `directory`."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"the data is saved in {directory}, without all of its pictures") from None
