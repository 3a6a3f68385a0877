"""The page of a sweep."""

from __future__ import annotations

import re
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.report import SWEEP, TABLE
from granular_contact.report.pages import parts
from granular_contact.report.pages.folder import Folder, Rows
from granular_contact.report.pages.markup import Markup, join, tag
from granular_contact.report.pages.numbers import column, is_number, label, quantity
from granular_contact.report.pages.page import page as whole
from granular_contact.results import FINISHED

MOST_ROWS = 100  # shown; the rest is in the table
IMBALANCE = "energy.imbalance_relative"
_NOT_KEY = ("cost.", "versions.", "energy.")
_FIRST = ("stopping_time_s", "forward_speed_m_s", "max_depth_m", "max_deflection_m")  # are drawn before all others
_NOT_DRAWN = ("hub_stopping_time_s",)
SENSITIVITY = "sensitivity.csv"
MOST_WARNINGS = 10  # kinds
_NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?", re.IGNORECASE)
Values = NDArray[np.float64]


@dataclass(frozen=True)
class _Table:
    """table.csv; varied: what the sweep varies; found: what came of it, key numbers only."""

    head: list[str]
    rows: Rows
    varied: list[str]
    found: list[str]

    @property
    def finished(self) -> _Table:
        """The cases alone that came to an end: numbers of any other are those of where it broke off."""
        rows = [row for row, status in zip(self.rows, self.column("status"), strict=True) if status in FINISHED]
        return replace(self, rows=rows)

    def column(self, name: str) -> list[Any]:
        """Values of a column, in the order of the cases."""
        i = self.head.index(name)
        return [row[i] for row in self.rows]

    def numbers(self, name: str) -> Values:
        """Values of a column, NaN where there is no number."""
        return np.array([value if is_number(value) else np.nan for value in self.column(name)], dtype=float)


def page(folder: Folder) -> str:
    """HTML of a sweep's page."""
    table = _read(folder)
    counts = Counter(str(status) for status in table.column("status"))
    bad = sum(count for status, count in counts.items() if status not in FINISHED)
    ended = table.finished
    sections = [
        parts.warnings([*_warnings(table), *_vague(folder)]),
        parts.section("Key numbers", _left_out(bad), _statistics(ended)),
        parts.section("Figures", _figures(folder, ended)),
        parts.section("Sensitivity", _sensitivity(folder)),
        parts.section("Cases that failed", _failed(table)),
        parts.section("Energy audit", _energy(ended)),
        parts.section("Cases", _cases(table)),
        parts.section("Scenario", _scenario(folder)),
        parts.section("Computation", *_computation(table)),
    ]
    words = f"{bad} failed" if bad else "all came to an end"
    badge = tag("span", words, class_="status bad" if bad else "status")
    version = next((str(v) for v in _told(table, "versions.granular-contact")), "")
    return whole(folder.path.name, "Sweep", badge, _lead(table, counts), sections, version)


def _read(folder: Folder) -> _Table:
    head, rows = folder.table(TABLE)
    begin = next((i for i, name in enumerate(head) if name in ("name", "status")), len(head))
    table = _Table(head, rows, head[1:begin], [])
    finished = table.finished
    found = [
        name
        for name in head[begin:]
        if not name.startswith(_NOT_KEY) and np.isfinite(finished.numbers(name)).any() and name != "touch_time_s"
    ]
    return _Table(head, rows, head[1:begin], found)


def _lead(table: _Table, counts: Counter[str]) -> str:
    ends = {
        "rest": "came to rest",
        "end_time": "ran to the end time",
        "time_limit": "ran out of time",
        "error": "crashed",
    }
    words = ", ".join(f"{count} {ends.get(status, status)}" for status, count in counts.most_common())
    varied = ", ".join(label(name) for name in table.varied) or "nothing"
    return f"{len(table.rows)} cases: {words}. They differ in {varied}."


def _told(table: _Table, name: str) -> list[Any]:
    """What a column says, each value once; nothing if there is no such column."""
    return list(dict.fromkeys(v for v in table.column(name) if v is not None)) if name in table.head else []


def _warnings(table: _Table) -> list[str]:
    """Warnings of the cases, those that differ in their numbers alone as one kind; the most frequent first."""
    if "warnings" not in table.head:
        return []
    kinds: dict[str, list[str]] = {}
    for warning in table.column("warnings"):
        if warning:
            kinds.setdefault(_NUMBER.sub("#", str(warning)), []).append(str(warning))
    ordered = sorted(kinds.values(), key=len, reverse=True)
    shown = [_counted(alike, len(table.rows)) for alike in ordered[:MOST_WARNINGS]]
    more = len(ordered) - MOST_WARNINGS
    return [*shown, f"... and {more} more kind{'s' * (more > 1)}, in {TABLE}"] if more > 0 else shown


def _counted(alike: list[str], count: int) -> str:
    """The first warning of a kind, and how many cases have one."""
    other = ", in other cases with other numbers" if len(set(alike)) > 1 else ""
    return f"{alike[0]} ({len(alike)} of {count} cases{other})"


def _vague(folder: Folder) -> list[str]:
    """Sensitivities that are not known well enough."""
    if not folder.has(SENSITIVITY):
        return []
    head, rows = folder.table(SENSITIVITY)
    if not {"output", "input", "note", "first_order"} <= set(head):
        return []
    cells = (dict(zip(head, row, strict=True)) for row in rows)
    return [
        f"sensitivity of {label(str(one['output']))} to {label(str(one['input']))}: {one['note']}"
        for one in cells
        if one["note"] and one["first_order"] is not None
    ]


def _left_out(bad: int) -> Markup | None:
    """What the numbers, figures and energies are not of."""
    if not bad:
        return None
    cases = "1 case that did not come to an end is" if bad == 1 else f"{bad} cases that did not come to an end are"
    return tag("p", f"Of the cases that came to an end; {cases} left out here, in the figures and in the energy audit.")


def _statistics(table: _Table) -> Markup | None:
    rows = []
    for name in table.found:
        values = table.numbers(name)
        values = values[np.isfinite(values)]
        spread = (values.min(), np.median(values), values.max())
        rows.append([label(name), len(values), *(quantity(name, float(value)) for value in spread)])
    names = ["number", "cases that have it", "least", "median", "greatest"]
    return parts.table("What the cases found.", names, rows) if rows else None


def _figures(folder: Folder, table: _Table) -> Markup | None:
    shown = [parts.figure(path, _caption(path.stem)) for path in folder.figures()]
    columns = [(name, table.numbers(name)) for name in table.varied]
    varied = [(name, values) for name, values in columns if len(set(values[np.isfinite(values)])) > 1]
    if varied and table.found:
        from granular_contact.report.figures.overview import MOST, draw

        with tempfile.TemporaryDirectory() as place:
            for name in _drawn(table)[:MOST]:
                across = dict(_axis(*one) for one in varied)
                draw(across, _axis(name, table.numbers(name)), Path(place, "overview.png"))
                words = f"{label(name).capitalize()} of every case that came to an end against what varies."
                shown.append(parts.figure(Path(place, "overview.png"), words))
    return tag("div", *shown, class_="figures") if shown else None


def _caption(stem: str) -> str:
    kind, _, output = stem.partition("_")
    return f"Sobol indices of {label(output)}." if kind == "sensitivity" else stem.replace("_", " ")


def _drawn(table: _Table) -> list[str]:
    """Numbers that differ between cases, the most telling first."""
    differ = [name for name in table.found if np.nanmin(table.numbers(name)) < np.nanmax(table.numbers(name))]
    return sorted((name for name in differ if name not in _NOT_DRAWN), key=lambda one: one not in _FIRST)


def _axis(key: str, values: Values) -> tuple[str, Values]:
    """What an axis is called, and its numbers in the unit named there."""
    words, numbers = column(key, values.tolist())
    return words, np.array(numbers)


def _sensitivity(folder: Folder) -> Markup | None:
    if not folder.has(SENSITIVITY):
        return None
    head, rows = folder.table(SENSITIVITY)
    caption = "Part of the variance of an output that an input explains: alone (first order), and with others (total)."
    return parts.keyed_table(caption, head, rows)


def _failed(table: _Table) -> Markup | None:
    rows = [
        [case, message]
        for case, status, message in zip(
            table.column(table.head[0]), table.column("status"), table.column("message"), strict=True
        )
        if status not in FINISHED
    ]
    return _at_most("Why they failed.", ["case", "message"], rows) if rows else None


def _at_most(caption: str, head: list[str], rows: Rows) -> Markup:
    shown = parts.keyed_table(caption, head, rows[:MOST_ROWS])
    more = len(rows) - MOST_ROWS
    return join(shown, tag("p", f"... and {more} more in {TABLE}.") if more > 0 else None)


def _energy(table: _Table) -> Markup | None:
    if IMBALANCE not in table.head:
        return None
    values = table.numbers(IMBALANCE)
    if not np.isfinite(values).any():
        return None
    worst = int(np.nanargmax(values))
    return tag(
        "p",
        f"Share of the energy unaccounted for: {quantity(IMBALANCE, float(np.nanmedian(values)))} in the median, "
        f"{quantity(IMBALANCE, float(values[worst]))} at most, in case {table.rows[worst][0]}.",
    )


def _cases(table: _Table) -> Markup:
    names = [table.head[0], *table.varied, "status", *table.found[:6]]
    places = [table.head.index(name) for name in names]
    rows = [[row[i] for i in places] for row in table.rows]
    return _at_most("Cases, what they vary, and what came of them.", names, rows)


def _scenario(folder: Folder) -> Markup | None:
    if not folder.has(SWEEP):
        return None
    words = f"The config with every default in place, and the cases; granular-contact sweep {SWEEP} runs them again."
    return parts.source(folder.path / SWEEP, words)


def _computation(table: _Table) -> Iterator[Markup | None]:
    if "cost.solve_s" in table.head:
        yield parts.facts({"time_of_all_solves_s": float(np.nansum(table.numbers("cost.solve_s")))})
    versions = {n.partition(".")[2]: ", ".join(map(str, _told(table, n))) for n in table.head if n[:9] == "versions."}
    yield parts.listing("Versions that made it.", versions)
