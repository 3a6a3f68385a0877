"""HTML page of a results folder, in one file: text, numbers, figures, motion, scenario, warnings.

folder                                  results folder on the disk
run, comparison, sweep, fit, optimise   content of the page of each kind of results; a gallery of several runs
chart, stage, live                      a chart of many rows; the player in the plane; data for scripts
templates, rendering                    texts and layout of pages; functions for templates
scripts                                 scripts that run in the browser
"""

from __future__ import annotations

import os
import secrets
import struct
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from jinja2 import TemplateError

from granular_contact import __version__
from granular_contact.report import ENTRIES, MOTION, OVERLAY, PAGE, SCENARIO, SUMMARY
from granular_contact.report.pages import comparison, fit, optimise, run, sweep
from granular_contact.report.pages.folder import Folder, FolderError, open_folder
from granular_contact.report.pages.live import nothing_live
from granular_contact.report.pages.rendering import GENERATOR, rendered

__all__ = ["FolderError", "html", "write"]

GALLERY = "gallery.html"
MOST_BYTES = 5_000_000  # greatest size of a file that can be saved from a page

# Exceptions of data of unexpected types in a results folder.
_MALFORMED = (
    *(ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError),
    *(struct.error, TemplateError),
)


# Function that makes the content of each kind of results; other kinds have a page of their tables and figures.
_CONTENTS: dict[str, Callable[[Folder], dict[str, Any]]] = {
    **dict.fromkeys(("compare", "compare-media"), comparison.content),
    **{"run": run.content, "fit": fit.content, "optimise": optimise.content},
}


def html(directory: Path) -> str:
    """Make the page of a results folder.

    Parameters
    ----------
    directory : Path
        The folder.

    Returns
    -------
    str
        The page, in one HTML file.

    Raises
    ------
    FolderError
        The folder contains no results, or damaged ones.
    """
    folder = open_folder(directory)
    try:
        with tempfile.TemporaryDirectory() as pictures:
            make = _CONTENTS.get(folder.kind, _tables)
            content = sweep.content(folder, Path(pictures)) if folder.kind == "sweep" else make(folder)
            data, cases = {"files": _files(folder)} | content.pop("data"), content.pop("cases", {})
            data |= {"cases": cases} if cases else {}
            return rendered(folder.kind, content, data, draws=bool(cases or content["groups"]))
    except _MALFORMED as error:
        files = [folder.path / name for name in ENTRIES[folder.kind] if name.endswith((".json", ".csv"))]
        named = " or ".join(str(file) for file in files if file.is_file())
        raise FolderError(
            f"{named} does not have the form that this program writes for a {folder.kind} ({error!r})"
        ) from error


def _files(folder: Folder) -> dict[str, str]:
    """Texts that can be saved from the page, by file name; large files are left out, to keep the page small.

    For a run the table is left out as well, because the page contains it for its scripts.
    """
    if folder.kind == "run":
        return {name: str(folder.text(name)) for name in (SUMMARY, SCENARIO, MOTION) if folder.has(name)}
    in_page = (OVERLAY, MOTION)  # the page contains them for its scripts
    names = [name for name in ENTRIES[folder.kind] if name.endswith((".json", ".csv", ".yaml")) and name not in in_page]
    small = [name for name in names if folder.has(name) and (folder.path / name).stat().st_size <= MOST_BYTES]
    return {name: text for name in small if (text := folder.text(name)) is not None}


def _tables(folder: Folder) -> dict[str, Any]:
    """Content of the page of results without a template of their own."""
    return {
        "title": folder.path.name,
        "version": __version__,
        "tables": {path.name: folder.table(path.name) for path in sorted(folder.path.glob("*.csv"))},
        "pictures": [*folder.figures(), *sorted(folder.path.glob("*.png"))],
        **nothing_live(),
    }


def write(directory: Path | Sequence[Path], file: Path | None = None) -> Path:
    """Write the page of a results folder to a file, completely or not at all.

    Parameters
    ----------
    directory : Path or sequence of Path
        A results folder, or several folders of runs, whose page is a gallery.
    file : Path, optional
        The file; by default `report.html` in the folder, or `gallery.html` beside the first of several folders.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FolderError
        As `html`; or the file exists and is not a page of this program.
    OSError
        The file cannot be written.
    """
    runs = [] if isinstance(directory, Path) else list(directory)
    if file is None:
        file = directory / PAGE if isinstance(directory, Path) else runs[0].resolve().parent / GALLERY
    if file.exists() and not _is_page(file):
        raise FolderError(f"{file} exists and is not a report of this program: give another name, or move the file")
    text = html(directory) if isinstance(directory, Path) else comparison.html(runs, file)
    making = file.with_name(f".{file.name}.{secrets.token_hex(4)}")
    try:
        making.write_text(text, encoding="utf-8")
        os.replace(making, file)
    finally:
        making.unlink(missing_ok=True)
    return file


def _is_page(file: Path) -> bool:
    """Return whether a file is a page of this program."""
    if not file.is_file():
        return False
    with file.open("rb") as opened:
        return f'name="generator" content="{GENERATOR}"'.encode() in opened.read(1000)
