"""Results folder -> one HTML file that holds everything: text, numbers, figures, motion, scenario, warnings.

folder                                  what is on the disk
run, comparison, sweep, fit, optimise   what is shown of each kind of results; of several runs
chart, stage, live                      a chart of many rows; the player of the plane; what scripts get
templates, rendering                    the words and the look of pages; what templates ask for
scripts                                 what runs in the browser
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
MOST_BYTES = 5_000_000  # of a file that can be saved from a page

_ODD = (
    *(ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError),
    *(struct.error, TemplateError),
)


# What is shown of each kind of results; of the others their tables and figures.
_CONTENTS: dict[str, Callable[[Folder], dict[str, Any]]] = {
    **dict.fromkeys(("compare", "compare-media"), comparison.content),
    **{"run": run.content, "fit": fit.content, "optimise": optimise.content},
}


def html(directory: Path) -> str:
    """The page of a results folder.

    Raises
    ------
    FolderError
        The folder holds no results, or broken ones.
    """
    folder = open_folder(directory)
    try:
        with tempfile.TemporaryDirectory() as place:
            of_kind = _CONTENTS.get(folder.kind, _tables)
            content = sweep.content(folder, Path(place)) if folder.kind == "sweep" else of_kind(folder)
            data, cases = {"files": _files(folder)} | content.pop("data"), content.pop("cases", {})
            data |= {"cases": cases} if cases else {}
            return rendered(folder.kind, content, data, draws=bool(cases or content["groups"]))
    except _ODD as error:  # what is written here has other types somewhere
        held = [str(folder.path / name) for name in ENTRIES[folder.kind] if name.endswith((".json", ".csv"))]
        named = " or ".join(name for name in held if Path(name).is_file())
        raise FolderError(f"{named} holds what no {folder.kind} of this program writes ({error!r})") from error


def _files(folder: Folder) -> dict[str, str]:
    """Texts that can be saved from the page, by their names; none of a size that would make the page unwieldy.

    A run gives all but its table, which the page holds for its scripts.
    """
    if folder.kind == "run":
        return {name: str(folder.text(name)) for name in (SUMMARY, SCENARIO, MOTION) if folder.has(name)}
    given = (OVERLAY, MOTION)  # which the page holds for its scripts
    names = [one for one in ENTRIES[folder.kind] if one.endswith((".json", ".csv", ".yaml")) and one not in given]
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
    """Write the page of a results folder to a file, `report.html` in the folder unless given, whole or not at all.

    Of several folders of runs it is a gallery, `gallery.html` in the folder that holds the first unless given.

    Raises
    ------
    FolderError
        As `html`; or the file is there already and is no page of ours.
    OSError
        The disk refuses.
    """
    several = [] if isinstance(directory, Path) else list(directory)
    if file is None:
        file = directory / PAGE if isinstance(directory, Path) else several[0].resolve().parent / GALLERY
    if file.exists() and not _is_ours(file):
        raise FolderError(f"{file} is there already and is not a report of this program: give another name, or move it")
    text = html(directory) if isinstance(directory, Path) else comparison.html(several, file)
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
