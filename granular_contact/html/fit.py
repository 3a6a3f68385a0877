"""The page of a fit: what fit.json says, entry by entry, with its figures, its medium and its residuals."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from granular_contact.html import parts
from granular_contact.html.folder import Folder
from granular_contact.html.markup import Markup, join, tag
from granular_contact.html.numbers import is_number, label
from granular_contact.html.page import page as whole
from granular_contact.report import PROGRAM

RECORD, MEDIUM, RESIDUALS = "fit.json", "medium.yaml", "residuals.csv"
_ELSEWHERE = ("name", "status", "message", "words", "warnings", "versions", "cost")


def page(folder: Folder) -> str:
    """HTML of a fit's page."""
    record = folder.read(RECORD)
    status = record.get("status")
    bad = str(status) in ("misfit", "failed", "interrupted")
    sections = [
        parts.warnings([str(one) for one in record.get("warnings") or []]),
        parts.section("Key numbers", parts.facts({k: v for k, v in record.items() if is_number(v)})),
        parts.section("Figures", parts.figures(folder.figures(), {})),
        *(_entry(key, value) for key, value in record.items() if key not in _ELSEWHERE and not is_number(value)),
        parts.section("Residuals", _residuals(folder)),
        parts.section("Medium", _medium(folder)),
        parts.section(
            "Computation", *(parts.listing(f"{label(k)}.", record.get(k) or {}) for k in ("cost", "versions"))
        ),
    ]
    badge = None if status is None else tag("span", str(status), class_="status bad" if bad else "status")
    lead = record.get("words") or record.get("message") or "Coefficients found from measurements."
    lead = " ".join(lead) if isinstance(lead, list) else str(lead)
    versions = record.get("versions") or {}
    version = str(versions.get(PROGRAM, "")) if isinstance(versions, dict) else ""
    return whole(str(record.get("name") or folder.path.name), "Fit", badge, lead, sections, version)


def _entry(key: str, value: Any) -> Markup | None:
    """An entry of the record as a section."""
    return parts.section(label(key).capitalize(), *_shown(label(key), value))


def _shown(name: str, value: Any) -> Iterator[Markup | None]:
    """Whatever JSON can hold: a text as a paragraph, records alike as a table, other mappings as lists."""
    if isinstance(value, str):
        yield tag("p", value)
    elif isinstance(value, dict):
        yield from _mapping(name, value)
    elif isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
        head = list(dict.fromkeys(key for one in value for key in one))
        yield parts.keyed_table(f"{name}.", head, [[_flat(one.get(key)) for key in head] for one in value])
    elif isinstance(value, list) and value and all(isinstance(one, list) for one in value):
        head = [str(i + 1) for i in range(max(map(len, value)) + 1)]
        yield parts.table(f"{name}.", ["", *head[:-1]], [[i, *map(_flat, row)] for i, row in enumerate(value, 1)])
    elif isinstance(value, list) and value:
        yield tag("ul", *(tag("li", str(_flat(one))) for one in value))
    elif value is not None and value != []:
        yield tag("p", str(_flat(value)))


def _mapping(name: str, value: dict[str, Any]) -> Iterator[Markup | None]:
    if value and all(isinstance(one, dict) for one in value.values()):
        head = list(dict.fromkeys(key for one in value.values() for key in one))
        rows = [[key, *(_flat(one.get(column)) for column in head)] for key, one in value.items()]
        yield parts.table(f"{name}.", [name, *head], rows)
        return
    flat = {k: v for k, v in value.items() if not isinstance(v, dict | list)}
    yield parts.listing(f"{name}.", flat)
    for key, deeper in value.items():
        if key not in flat:
            yield join(tag("h3", label(key)), *_shown(label(key), deeper))


def _flat(value: Any) -> Any:
    """A value that fits into a cell."""
    if isinstance(value, list):
        return ", ".join(str(_flat(one)) for one in value)
    if isinstance(value, dict):
        return ", ".join(f"{key}: {_flat(one)}" for key, one in value.items())
    return value


def _residuals(folder: Folder) -> Markup | None:
    """How large the residuals are, by column."""
    if not folder.has(RESIDUALS):
        return None
    head, rows = folder.table(RESIDUALS)
    found = []
    for i, name in enumerate(head):
        values = np.array([row[i] for row in rows if is_number(row[i])], dtype=float)
        if len(values):
            rms = float(np.sqrt(np.mean(values**2)))
            found.append([name, len(values), float(values.mean()), rms, float(np.abs(values).max())])
    names = ["column", "rows", "mean", "root mean square", "largest"]
    return parts.table(f"Numbers of {RESIDUALS}, in the units of each column.", names, found)


def _medium(folder: Folder) -> Markup | None:
    if not folder.has(MEDIUM):
        return None
    return parts.source(folder.path / MEDIUM, f"The medium as found, ready to use: medium: {MEDIUM} in a config.")
