"""The page of a comparison of models."""

from __future__ import annotations

from granular_contact.report import COMPARISON, PROGRAM, SCENARIO, SUMMARY
from granular_contact.report.pages import parts
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.markup import Markup, tag
from granular_contact.report.pages.numbers import quantity
from granular_contact.report.pages.page import page as whole

FIGURES = {"histories": "Angle and deflection by every model over time, and how far they are from the reference."}
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


def page(folder: Folder) -> str:
    """HTML of a comparison's page."""
    head, rows = folder.table(COMPARISON)
    summary = folder.read(SUMMARY) if folder.has(SUMMARY) else {}
    columns = [name for name in _SHOWN if name in head]
    cells = [[row[head.index(name)] for name in columns] for row in rows]
    reference = str(rows[-1][0]) if rows else "none"
    caption = f"Every model against {reference}, the reference; differences are relative to it."
    imbalance = summary.get("imbalance_relative") or {}
    sections = [
        parts.warnings(summary.get("warnings") or []),
        parts.section("Models", parts.keyed_table(caption, columns, cells)),
        parts.section("Figures", parts.figures(folder.figures(), FIGURES)),
        parts.section("Energy audit", _audit(imbalance)),
        parts.section("Scenario", _scenario(folder)),
        parts.section("Computation", parts.listing("Versions that made it.", summary.get("versions") or {})),
    ]
    lead = str(summary.get("verdict") or f"{len(rows)} models of one run against each other.")
    name = str(summary.get("name") or folder.path.name)
    version = str((summary.get("versions") or {}).get(PROGRAM, ""))
    badge = tag("span", f"{len(rows)} models", class_="status")
    return whole(name, "Comparison", badge, lead, sections, version)


def _audit(imbalance: dict[str, float]) -> Markup | None:
    rows = [[name, quantity("imbalance_relative", share)] for name, share in imbalance.items()]
    return parts.table("Share of the energy unaccounted for.", ["model", "share"], rows) if rows else None


def _scenario(folder: Folder) -> str | None:
    if not folder.has(SCENARIO):
        return None
    return parts.source(folder.path / SCENARIO, "The run that all models computed, as the reference had it.")
