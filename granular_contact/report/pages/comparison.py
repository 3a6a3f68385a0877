"""What the page of a comparison of models shows."""

from __future__ import annotations

from typing import Any

from granular_contact.report import COMPARISON, PROGRAM, SCENARIO, SUMMARY
from granular_contact.report.pages.folder import Folder
from granular_contact.report.units import quantity

_SHOWN = (
    "model",
    "stopping_time_s",
    "stopping_time_relative",
    "angle_at_stop_deg",
    "travel_relative",
    "max_deflection_m",
    "deflection_relative",
    "angle_rms_deg",
    "deflection_rms_m",
    "solve_s",
)


def content(folder: Folder) -> dict[str, Any]:
    """Content for its template."""
    head, rows = folder.table(COMPARISON)
    summary = folder.read(SUMMARY) if folder.has(SUMMARY) else {}
    columns = [name for name in _SHOWN if name in head]
    imbalance = summary.get("imbalance_relative") or {}
    return {
        "title": summary.get("name") or folder.path.name,
        "version": (summary.get("versions") or {}).get(PROGRAM, ""),
        "summary": summary,
        "columns": columns,
        "rows": [[row[head.index(name)] for name in columns] for row in rows],
        "pictures": folder.figures(),
        "audit": [[name, quantity("imbalance_relative", share)] for name, share in imbalance.items()],
        "scenario": folder.text(SCENARIO),
    }
