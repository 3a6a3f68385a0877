"""Results folder -> one HTML file that holds everything: words, numbers, figures, animation, scenario, warnings.

folder                          what is on the disk
markup, page, parts, numbers    escaping; the page and its style; tables and figures; numbers in words
run, comparison, sweep, fit     what is said of each kind of results; other: of those without words of their own
anything                        entries of which no more is known than their names
"""

from __future__ import annotations

import os
import secrets
import struct
from collections.abc import Callable
from pathlib import Path

from granular_contact.report import ENTRIES, PAGE
from granular_contact.report.pages import comparison, fit, other, run, sweep
from granular_contact.report.pages.folder import Folder, FolderError, open_folder
from granular_contact.report.pages.page import GENERATOR

__all__ = ["FolderError", "html", "write"]

_KINDS: dict[str, Callable[[Folder], str]] = {
    "run": run.page,
    "compare": comparison.page,
    "sweep": sweep.page,
    "fit": fit.page,
}
_ODD = (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError, struct.error)


def html(directory: Path) -> str:
    """The page of a results folder.

    Raises
    ------
    FolderError
        The folder holds no results, or broken ones.
    """
    folder = open_folder(directory)
    try:
        return _KINDS.get(folder.kind, other.page)(folder)
    except _ODD as error:  # what is written here has other types somewhere
        held = [str(folder.path / name) for name in ENTRIES[folder.kind] if name.endswith((".json", ".csv"))]
        files = " or ".join(name for name in held if Path(name).is_file())
        raise FolderError(f"{files} holds what no {folder.kind} of this program writes ({error!r})") from error


def write(directory: Path, file: Path | None = None) -> Path:
    """Write the page of a results folder to a file, `report.html` in the folder unless given, whole or not at all.

    Raises
    ------
    FolderError
        As `html`; or the file is there already and is no page of ours.
    OSError
        The disk refuses.
    """
    file = directory / PAGE if file is None else file
    if file.exists() and not _is_ours(file):
        raise FolderError(f"{file} is there already and is no report of this program: give another name, or move it")
    text = html(directory)
    making = file.with_name(f".{file.name}.{secrets.token_hex(4)}")
    try:
        making.write_text(text, encoding="utf-8")
        os.replace(making, file)
    finally:
        making.unlink(missing_ok=True)
    return file


def _is_ours(file: Path) -> bool:
    if not file.is_file():
        return False
    with file.open("rb") as opened:
        return f'name="generator" content="{GENERATOR}"'.encode() in opened.read(1000)
