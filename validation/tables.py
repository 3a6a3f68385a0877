"""Helpers of all studies: a table in Markdown, and one line on the machine and the versions of packages."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from importlib import metadata
from typing import Any


def markdown(head: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """Table in Markdown, one line per row; cells are written by `str`."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def machine(*packages: str) -> str:
    """One line on the machine, Python and the versions of the named packages."""
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in packages)
    system = f"{os.cpu_count()} cores, {platform.machine()} {platform.system()}"
    return f"{system}, Python {platform.python_version()}, {versions}"
