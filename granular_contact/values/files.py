"""Files written so that a killed process, or a full disk, leaves the old one."""

from __future__ import annotations

import os
from pathlib import Path


def write_whole(path: Path, text: str) -> None:
    """Write a file completely or not at all."""
    making = path.with_suffix(".new")
    making.write_text(text, encoding="utf-8")
    sync(making)
    making.replace(path)


def sync(path: Path) -> None:
    """Wait until what was written to a file is on the disk."""
    with path.open("rb") as file:
        os.fsync(file.fileno())
