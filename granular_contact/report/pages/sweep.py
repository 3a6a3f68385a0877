"""What the page of a sweep shows."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.report import BANDS, CASES, SENSITIVITY, SERIES, SWEEP, TABLE
from granular_contact.report.histories import Curve, Group, panel
from granular_contact.report.overlay import History, motion
from granular_contact.report.overlay import table as overlaid
from granular_contact.report.pages.chart import chart
from granular_contact.report.pages.folder import Folder, Rows
from granular_contact.report.pages.live import live_curves, live_overlay, nothing_live
from granular_contact.report.units import column, is_number, label, quantity
from granular_contact.results import FINISHED

MOST_RUNS = 6  # of cases that were kept, side by side
MOST_ROWS = 100  # shown; the rest is in the table
IMBALANCE, SECONDS = "energy.imbalance_relative", "cost.solve_s"
_NOT_KEY = ("cost.", "versions.", "energy.", "drives.", "contacts.", "strips.", "strides.count", "strides.period")
# Shown and drawn before all others, in this order.
_FIRST = (
    *(
        "wheel.drawbar_pull_N",
        "wheel.sinkage_m",
        "forward_speed_second_half_m_s",
        "forward_speed_m_s",
        "cost_of_transport",
        "penetration_time_s",
    ),
    *("stopping_time_s", "max_depth_m", "max_deflection_m"),
)
_NOT_DRAWN = ("hub_stopping_time_s",)
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
        """Only the cases that ended regularly: numbers of the others are those of where they stopped."""
        rows = [row for row, status in zip(self.rows, self.column("status"), strict=True) if status in FINISHED]
        return replace(self, rows=rows)

    def column(self, name: str) -> list[Any]:
        """Values of a column, in the order of the cases."""
        i = self.head.index(name)
        return [row[i] for row in self.rows]

    def numbers(self, name: str) -> Values:
        """Values of a column, NaN where there is no number."""
        return np.array([value if is_number(value) else np.nan for value in self.column(name)], dtype=float)


def content(folder: Folder, place: Path) -> dict[str, Any]:
    """Content for its template; place: a folder for pictures that are drawn for the page."""
    table = _read(folder)
    counts = Counter(str(status) for status in table.column("status"))
    ended = table.finished
    names = [table.head[0], *table.varied, "status", *_ordered(table.found)[:6]]
    return {
        "title": folder.path.name,
        "version": next(iter(_distinct(table, "versions.granular-contact")), ""),
        "count": len(table.rows),
        "counts": counts.most_common(),
        "failed": sum(count for status, count in counts.items() if status not in FINISHED),
        "varied": table.varied,
        "warnings": [*_warnings(table), *_vague(folder)],
        "statistics": list(_statistics(ended)),
        "pictures": [*((path, _caption(path.stem)) for path in folder.figures()), *_overviews(ended, place)],
        "sensitivity": folder.table(SENSITIVITY) if folder.has(SENSITIVITY) else None,
        "failures": _failures(table),
        "audit": _audit(ended),
        "columns": names,
        "cases": list(zip(*(table.column(name) for name in names), strict=True)),
        "most": MOST_ROWS,
        "sweep": folder.text(SWEEP),
        "seconds": float(np.nansum(table.numbers(SECONDS))) if SECONDS in table.head else None,
        "versions": {n[9:]: ", ".join(map(str, _distinct(table, n))) for n in table.head if n[:9] == "versions."},
    }


def data(folder: Folder) -> dict[str, Any]:
    """Data for the scripts: numbers that differ between the cases that came to an end; nothing where there are none."""
    table = _read(folder).finished
    drawn = _drawn(table)
    along = [name for name in table.varied if len(set(table.numbers(name)[np.isfinite(table.numbers(name))])) > 1]
    if not drawn or not along:
        return {}
    columns = {name: table.numbers(name).tolist() for name in (*table.varied, *table.found)}
    return chart([str(name) for name in table.column(table.head[0])], columns, along[0], drawn[0])


def live(folder: Folder) -> dict[str, Any]:
    """Bands of histories of an ensemble; or the runs of some cases, where they were kept: the first, the last, and some
    between.
    """
    if folder.has(BANDS):
        head, table = folder.numbers(BANDS)
        columns = dict(zip(head, table.T, strict=True))
        return live_curves(columns, _bands(columns), BANDS)
    places = sorted(one for one in (folder.path / CASES).glob("*") if (one / SERIES).is_file())
    chosen = [places[i] for i in np.unique(np.linspace(0, len(places) - 1, MOST_RUNS).astype(int))] if places else []
    kept = [Folder(one, "run") for one in chosen]
    runs = []
    for one in kept:
        head, table = one.numbers(SERIES)
        runs.append(History(one.path.name, dict(zip(head, table.T, strict=True)), one.motion()))
    if len(runs) < 2:
        return nothing_live()
    moved, played = motion(runs), kept[0].played()
    bed = None if moved is None or played is None else (moved, played[1])
    return live_overlay([one.name for one in runs], overlaid(runs), bed)


def _bands(columns: dict[str, Values]) -> list[Group]:
    """A panel of quantiles for each column that has some."""
    found: dict[str, list[Curve]] = {}
    for name in columns:
        stem, _, level = name.rpartition("_q")
        if stem:
            words = "median" if level == "50" else f"{int(level)} %"
            found.setdefault(stem, []).append(Curve(words, ((name, 1.0),)))
    panels = [panel(label(stem), stem, curves, columns.__getitem__) for stem, curves in found.items()]
    return [Group("bands", "Bands", "So many of all runs lie below each curve.", tuple(panels))] if panels else []


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


def _distinct(table: _Table, name: str) -> list[Any]:
    """Distinct values of a column; none if there is no such column."""
    return list(dict.fromkeys(v for v in table.column(name) if v is not None)) if name in table.head else []


def _warnings(table: _Table) -> list[str]:
    """Warnings of the cases, those that differ only in numbers as one kind; the most frequent first."""
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


def _statistics(table: _Table) -> Iterator[list[Any]]:
    for name in _ordered(table.found):
        values = table.numbers(name)
        values = values[np.isfinite(values)]
        spread = (values.min(), np.median(values), values.max())
        yield [label(name), len(values), *(quantity(name, float(value)) for value in spread)]


def _overviews(table: _Table, place: Path) -> Iterator[tuple[Path, str]]:
    """Drawings of key numbers against the varied quantities, and their captions."""
    columns = [(name, table.numbers(name)) for name in table.varied]
    varied = [(name, values) for name, values in columns if len(set(values[np.isfinite(values)])) > 1]
    if not varied or not table.found:
        return
    from granular_contact.report.figures.overview import MOST, draw

    for i, name in enumerate(_drawn(table)[:MOST]):
        path = place / f"overview_{i}.png"
        draw(dict(_axis(*one) for one in varied), _axis(name, table.numbers(name)), path)
        yield path, f"{label(name).capitalize()} of every case that came to an end against what varies."


def _caption(stem: str) -> str:
    kind, _, output = stem.partition("_")
    if stem == "wheel_over_slip":
        return "Drawbar pull, torque and sinkage of the wheel over its slip, means of the last half of the path."
    return f"Sobol indices of {label(output)}." if kind == "sensitivity" else stem.replace("_", " ")


def _drawn(table: _Table) -> list[str]:
    """Numbers that differ between cases, the most important first."""
    differ = [name for name in table.found if np.nanmin(table.numbers(name)) < np.nanmax(table.numbers(name))]
    return _ordered(name for name in differ if name not in _NOT_DRAWN)


def _ordered(names: Iterable[str]) -> list[str]:
    """Names of numbers, the most telling first."""
    return sorted(names, key=lambda one: _FIRST.index(one) if one in _FIRST else len(_FIRST))


def _axis(key: str, values: Values) -> tuple[str, Values]:
    """Label of an axis with its unit, and the numbers in this unit."""
    words, numbers = column(key, values.tolist())
    return words, np.array(numbers)


def _failures(table: _Table) -> Rows:
    columns = (table.column(name) for name in (table.head[0], "message", "status"))
    return [[case, message] for case, message, status in zip(*columns, strict=True) if status not in FINISHED]


def _audit(table: _Table) -> dict[str, Any] | None:
    """Energy imbalance: in the median, and in the worst case."""
    values = table.numbers(IMBALANCE) if IMBALANCE in table.head else np.zeros(0)
    if not np.isfinite(values).any():
        return None
    worst = int(np.nanargmax(values))
    median, most = (quantity(IMBALANCE, float(value)) for value in (np.nanmedian(values), values[worst]))
    return {"median": median, "most": most, "case": table.rows[worst][0]}
