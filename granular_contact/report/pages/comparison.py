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
    table = folder.table(OF_MEDIA if of_media else COMPARISON)
    head, names = table.head, [str(row[0]) for row in table.rows]
    summary = folder.read(SUMMARY) if folder.has(SUMMARY) else {}
    columns = [name for name in head if name not in _NOT_SHOWN] if of_media else [n for n in _OF_MODELS if n in head]
    imbalance = summary.get("imbalance_relative") or {}
    if of_media and "energy_imbalance_relative" in head:
        imbalance = dict(zip(names, table.column("energy_imbalance_relative"), strict=True))
    if of_media and "warnings" in head:
        found = zip(names, table.column("warnings"), strict=True)
        summary = {"warnings": [f"{name}: {words}" for name, words in found if words]}
    live = nothing_live()  # of a folder of an earlier version
    if folder.has(OVERLAY):
        reference = names[-1] if names and not of_media else ""
        live = live_overlay(names, folder.numbers(OVERLAY), folder.played(), reference)
    return {
        "title": summary.get("name") or folder.path.name,
        "version": (summary.get("versions") or {}).get(PROGRAM) or version(),
        "summary": summary,
        "of_media": of_media,
        "columns": columns,
        "rows": table.of(columns),
        "pictures": folder.figures(),
        "audit": [[name, quantity("imbalance_relative", share)] for name, share in imbalance.items()],
        "scenario": folder.text(SCENARIO),
        **live,
    }
