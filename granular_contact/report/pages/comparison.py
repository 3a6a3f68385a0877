"""Pages of several runs: comparison of models or media, and a gallery of any runs with a table to sort."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from granular_contact import __version__
from granular_contact.report import COMPARISON, OF_MEDIA, OVERLAY, PAGE, PROGRAM, SCENARIO, SUMMARY
from granular_contact.report.pages.folder import Folder, FolderError, open_folder
from granular_contact.report.pages.live import live_overlay, nothing_live
from granular_contact.report.pages.rendering import rendered
from granular_contact.report.units import is_number, quantity

_OF_MODELS = (
    *("model", "stopping_time_s", "stopping_time_relative", "angle_at_stop_deg", "travel_relative"),
    *("motion_m", "motion_relative"),
    *("max_deflection_m", "deflection_relative", "angle_rms_deg", "deflection_rms_m", "solve_s"),
)
_NOT_SHOWN = ("warnings", "energy_imbalance_relative")  # columns of media that are shown elsewhere on the page


def content(folder: Folder) -> dict[str, Any]:
    """Values for the template."""
    of_media = folder.kind == "compare-media"
    table = folder.table(OF_MEDIA if of_media else COMPARISON)
    head, names = table.head, [str(row[0]) for row in table.rows]
    summary = folder.read(SUMMARY) if folder.has(SUMMARY) else {}
    columns = [name for name in head if name not in _NOT_SHOWN] if of_media else [n for n in _OF_MODELS if n in head]
    imbalance = summary.get("imbalance_relative") or {}
    if of_media and "energy_imbalance_relative" in head:
        imbalance = dict(zip(names, table.column("energy_imbalance_relative"), strict=True))
    if of_media and "warnings" in head:
        warnings = zip(names, table.column("warnings"), strict=True)
        summary = {"warnings": [f"{name}: {warning}" for name, warning in warnings if warning]}
    live = nothing_live()  # folders of earlier versions have no histories
    if folder.has(OVERLAY):
        reference = names[-1] if names and not of_media else ""
        live = live_overlay(names, folder.numbers(OVERLAY), folder.played(), reference)
    return {
        "title": summary.get("name") or folder.path.name,
        "version": (summary.get("versions") or {}).get(PROGRAM) or __version__,
        "summary": summary,
        "of_media": of_media,
        "columns": columns,
        "rows": table.of(columns),
        "pictures": folder.figures(),
        "audit": [[name, quantity("imbalance_relative", share)] for name, share in imbalance.items()],
        "scenario": folder.text(SCENARIO),
        **live,
    }


NUMBERS = (  # the most important first
    *("forward_speed_m_s", "cost_of_transport", "penetration_time_s", "stopping_time_s", "max_depth_m"),
    *("max_deflection_m", "largest_drive_torque_Nm", "energy.imbalance_relative"),
)
MOST_NUMBERS = 4  # greatest number of key numbers on a card
PICTURES = ("views", "mechanism", "travel", "joints")  # a card shows the first that exists


def html(directories: Sequence[Path], file: Path) -> str:
    """Make the gallery of several runs; file: of the gallery, for relative links to the pages of the runs.

    Raises
    ------
    FolderError
        One of the folders contains no run, or a damaged one.
    """
    cards, rows = [], []
    for directory in directories:
        folder = open_folder(directory)
        if folder.kind != "run":
            raise FolderError(f"{directory} contains a {folder.kind}; a gallery shows single runs")
        card = _card(folder, file)
        cards.append(card)
        rows.append([card["title"], card["status"], *(card["numbers"].get(key) for key in NUMBERS)])
    content = {"title": "Gallery", "version": __version__, "cards": cards, "keys": ["run", "status", *NUMBERS]}
    return rendered("gallery", content | {"rows": rows}, {"files": {}})


def _card(folder: Folder, file: Path) -> dict[str, Any]:
    """Content of the card of a run."""
    summary = folder.read(SUMMARY)
    energy = {f"energy.{key}": value for key, value in (summary.get("energy") or {}).items()}
    numbers = {key: value for key in NUMBERS if is_number(value := (summary | energy).get(key))}
    figures = {path.stem: path for path in folder.figures()}
    page = folder.path / PAGE
    return {
        "title": folder.path.name,
        "status": str(summary.get("status", "unknown")),
        "words": str(summary.get("message") or ""),
        "numbers": numbers,
        "facts": {key: quantity(key, value) for key, value in list(numbers.items())[:MOST_NUMBERS]},
        "picture": next((figures[name] for name in PICTURES if name in figures), None),
        "link": Path(os.path.relpath(page, file.resolve().parent)).as_posix() if page.is_file() else "",
    }
