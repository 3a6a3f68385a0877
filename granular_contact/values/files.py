"""Files that are written such that a killed process or a full disk leaves the old file."""

from __future__ import annotations

import os
from pathlib import Path


def write_whole(path: Path, text: str) -> None:
    """Write a text file completely or not at all.

    Parameters
    ----------
    path : Path
        The file. It is replaced.
    text : str
        Its content.
    """
    new = path.with_suffix(".new")
    new.write_text(text, encoding="utf-8")
    sync(new)
    new.replace(path)


def sync(path: Path) -> None:
    """Wait until the content of a file is on the disk."""
    with path.open("rb") as file:
        os.fsync(file.fileno())
