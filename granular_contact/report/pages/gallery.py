"""A page of several runs: a picture and the key numbers of each, and a table of all to sort."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from granular_contact.report import PAGE, SUMMARY, version
from granular_contact.report.pages.folder import Folder, FolderError, open_folder
from granular_contact.report.pages.rendering import rendered
from granular_contact.report.units import is_number, quantity

NUMBERS = (  # the most telling first
    *("forward_speed_m_s", "cost_of_transport", "penetration_time_s", "stopping_time_s", "max_depth_m"),
    *("max_deflection_m", "largest_drive_torque_Nm", "energy.imbalance_relative"),
)
MOST_NUMBERS = 4  # of a card
PICTURES = ("views", "mechanism", "travel", "motion")  # the first that there is


def html(directories: Sequence[Path], file: Path) -> str:
    """The page of several runs, which will stand in a file: links to the pages of runs start from its folder.

    Raises
    ------
    FolderError
        One of the folders holds no run, or a broken one.
    """
    cards, rows = [], []
    for directory in directories:
        folder = open_folder(directory)
        if folder.kind != "run":
            raise FolderError(f"{directory} holds a {folder.kind}; a gallery is of runs")
        card = _card(folder, file)
        cards.append(card)
        rows.append([card["title"], card["status"], *(card["numbers"].get(key) for key in NUMBERS)])
    content = {"title": "Gallery", "version": version(), "cards": cards, "keys": ["run", "status", *NUMBERS]}
    return rendered("gallery", content | {"rows": rows}, {"files": {}})


def _card(folder: Folder, file: Path) -> dict[str, Any]:
    """What is shown of a run."""
    summary = folder.read(SUMMARY)
    energy = {f"energy.{key}": value for key, value in (summary.get("energy") or {}).items()}
    known = {key: value for key in NUMBERS if is_number(value := (summary | energy).get(key))}
    figures = {path.stem: path for path in folder.figures()}
    page = folder.path / PAGE
    return {
        "title": folder.path.name,
        "status": str(summary.get("status", "unknown")),
        "words": str(summary.get("message") or ""),
        "numbers": known,
        "facts": {key: quantity(key, value) for key, value in list(known.items())[:MOST_NUMBERS]},
        "picture": next((figures[name] for name in PICTURES if name in figures), None),
        "link": Path(os.path.relpath(page, file.resolve().parent)).as_posix() if page.is_file() else "",
    }
