"""What the page of a comparison shows: of models of one run, or of one run in several media."""

from __future__ import annotations

from typing import Any

from granular_contact.report import COMPARISON, OF_MEDIA, OVERLAY, PROGRAM, SCENARIO, SUMMARY, version
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.live import live_overlay, nothing_live
from granular_contact.report.units import quantity

_OF_MODELS = (
    *("model", "stopping_time_s", "stopping_time_relative", "angle_at_stop_deg", "travel_relative"),
    *("max_deflection_m", "deflection_relative", "angle_rms_deg", "deflection_rms_m", "solve_s"),
)
_NOT_SHOWN = ("warnings", "energy_imbalance_relative")  # of media: shown elsewhere on the page


def content(folder: Folder) -> dict[str, Any]:
    """Content for its template."""
    of_media = folder.kind == "compare-media"
    head, rows = folder.table(OF_MEDIA if of_media else COMPARISON)
    summary = folder.read(SUMMARY) if folder.has(SUMMARY) else {}
    columns = [name for name in head if name not in _NOT_SHOWN] if of_media else [n for n in _OF_MODELS if n in head]
    imbalance = summary.get("imbalance_relative") or {}
    if of_media and "energy_imbalance_relative" in head:
        imbalance = {str(row[0]): row[head.index("energy_imbalance_relative")] for row in rows}
    if of_media and "warnings" in head:
        found = [(row[0], row[head.index("warnings")]) for row in rows]
        summary = {"warnings": [f"{name}: {words}" for name, words in found if words]}
    return {
        "title": summary.get("name") or folder.path.name,
        "version": (summary.get("versions") or {}).get(PROGRAM) or version(),
        "summary": summary,
        "of_media": of_media,
        "columns": columns,
        "rows": [[row[head.index(name)] for name in columns] for row in rows],
        "pictures": folder.figures(),
        "audit": [[name, quantity("imbalance_relative", share)] for name, share in imbalance.items()],
        "scenario": folder.text(SCENARIO),
    }


def live(folder: Folder) -> dict[str, Any]:
    """What is drawn and played of it, as of `pages.live`; nothing of a folder of an earlier version."""
    if not folder.has(OVERLAY):
        return nothing_live()
    _, rows = folder.table(OF_MEDIA if folder.kind == "compare-media" else COMPARISON)
    names = [str(row[0]) for row in rows]
    head, table = folder.numbers(OVERLAY)
    reference = names[-1] if names and folder.kind == "compare" else ""
    return live_overlay(names, dict(zip(head, table.T, strict=True)), folder.played(), reference)
