"""Draw pictures after the data are saved; a picture that fails is a warning and does not affect anything else."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from granular_contact.errors import FigureWarning


@contextmanager
def drawn(file: Path) -> Iterator[Path]:
    """Provide a path to draw to, which is renamed to `file` when the block ends; a missing folder is created.

    An exception in the block becomes a `FigureWarning`, and leaves no file.
    """
    making = file.with_name(f".{file.name}")
    try:
        file.parent.mkdir(exist_ok=True)
        yield making
        os.replace(making, file)
    except Exception as error:  # any exception, because the saved numbers do not depend on pictures
        reason = " ".join(str(getattr(error, "strerror", None) or error).split())
        cause = f"{type(error).__name__}: {reason}" if reason else type(error).__name__
        warnings.warn(f"{file} is missing, as drawing it failed ({cause})", FigureWarning, stacklevel=3)
    finally:
        with suppress(OSError):
            making.unlink()


@contextmanager
def saved_before(directory: Path) -> Iterator[None]:
    """Add to a Ctrl-C within the block that the data are already saved in `directory`."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"the data is saved in {directory}, but not all of its pictures") from None
