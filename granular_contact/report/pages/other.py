"""The page of results that need no words of their own: their tables and figures."""

from __future__ import annotations

from granular_contact.report import version
from granular_contact.report.pages import parts
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.page import page as whole


def page(folder: Folder) -> str:
    """HTML of a page of tables and figures."""
    tables = {path.name: folder.table(path.name) for path in sorted(folder.path.glob("*.csv"))}
    pictures = [*folder.figures(), *sorted(folder.path.glob("*.png"))]
    sections = [
        parts.section("Tables", *(parts.keyed_table(f"{name}.", *table) for name, table in tables.items())),
        parts.section("Figures", parts.figures(pictures, {})),
    ]
    kind = folder.kind.replace("-", " ").capitalize()
    return whole(folder.path.name, kind, None, "Tables and figures of this folder.", sections, version())
