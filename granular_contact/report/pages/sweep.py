"""Content of the page of a sweep."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from granular_contact.report import BANDS, CASES, SENSITIVITY, SERIES, SWEEP, TABLE
from granular_contact.report.histories import SAME, Curve, Group, panel
from granular_contact.report.overlay import History, motion
from granular_contact.report.overlay import table as overlaid
from granular_contact.report.pages.chart import chart
from granular_contact.report.pages.folder import Folder, Rows, Table
from granular_contact.report.pages.live import live_curves, live_overlay, nothing_live
from granular_contact.report.units import Array, greatest, label, quantity
from granular_contact.results import FINISHED
from granular_contact.results.alike import Kinds

MOST_RUNS = 6  # greatest number of saved cases shown side by side
MOST_ROWS = 100  # greatest number of rows on the page; the file has all
IMBALANCE, SECONDS = "energy.imbalance_relative", "cost.solve_s"
_NOT_KEY = (
    "cost.",
    "versions.",
    "energy.",
    "drives.",
    "contacts.",
    "strips.",
    "facets.",
    "strides.count",
    "strides.period",
)
# Key numbers that are listed and drawn first, in this order.
_FIRST = (
    *("wheel.drawbar_pull_N", "wheel.sinkage_m", "forward_speed_second_half_m_s", "forward_speed_m_s"),
    *("cost_of_transport", "penetration_time_s", "stopping_time_s", "max_depth_m", "max_deflection_m"),
)
_NOT_DRAWN = ("hub_stopping_time_s",)
OVER_SLIP = ("wheel.drawbar_pull_N", "wheel.torque_Nm", "wheel.sinkage_m", "max_depth_m", "largest_torque_Nm")
_CAPTIONS = {
    "wheel_over_slip": "Drawbar pull, torque and sinkage of the wheel over slip, means of the last half of the path.",
    "bands": "The motion: the median of all runs, and bands that contain half and nine tenths of them.",
    "convergence_of_means": "Means of the first 2, 3, 4 ... runs, with their 95 % confidence intervals.",
}
MOST_WARNINGS = 10  # greatest number of kinds of warnings


class _Cases(NamedTuple):
    """Cases of a sweep.

    table: table.csv; ended: only the cases that ended regularly, because numbers of the others are not of a whole run.
    varied: keys that the sweep varies; key_numbers: names of the key numbers.
    """

    table: Table
    ended: Table
    varied: list[str]
    key_numbers: list[str]


def content(folder: Folder, place: Path) -> dict[str, Any]:
    """Values for the template; place: folder for pictures that are drawn for the page."""
    cases = _read(folder)
    table = cases.table
    counts = Counter(str(status) for status in table.column("status"))
    names = [table.head[0], *cases.varied, "status", *_drawn(cases)[:6]]
    pictures = folder.figures()
    shown = OVER_SLIP if any(path.stem == "wheel_over_slip" for path in pictures) else ()
    return {
        "title": folder.path.name,
        "version": next(iter(_distinct(table, "versions.granular-contact")), ""),
        "count": len(table.rows),
        "counts": counts.most_common(),
        "failed": sum(count for status, count in counts.items() if status not in FINISHED),
        "useless": _useless(cases.ended),
        "ensemble": folder.has(BANDS),
        "varied": cases.varied,
        "warnings": [*_warnings(table), *_vague(folder)],
        "statistics": list(_statistics(cases)),
        "constants": [f"{label(name)} {quantity(name, cases.ended.numbers(name)[0])}" for name in _constant(cases)],
        "pictures": [*((path, _caption(path.stem)) for path in pictures), *_overviews(cases, place, shown)],
        "sensitivity": folder.table(SENSITIVITY) if folder.has(SENSITIVITY) else None,
        "failures": _failures(table),
        "audit": _audit(cases.ended),
        "columns": names,
        "rows": table.of(names),
        "most": MOST_ROWS,
        "sweep": folder.text(SWEEP),
        "seconds": float(np.nansum(table.numbers(SECONDS))) if SECONDS in table.head else None,
        "versions": {n[9:]: ", ".join(map(str, _distinct(table, n))) for n in table.head if n[:9] == "versions."},
        **_live(folder),
        "cases": _chart(cases),
    }


def _chart(cases: _Cases) -> dict[str, Any]:
    """Data of the chart: numbers that differ between the cases that ended regularly; empty if there are none."""
    drawn, along, table = _drawn(cases), _differing(cases, cases.varied), cases.ended
    if not drawn or not along:
        return {}
    columns = {name: table.numbers(name).tolist() for name in (*cases.varied, *cases.key_numbers)}
    names = [str(name) for name in table.column(table.head[0])]
    return chart(names, columns, along[0], drawn[0], joined=_joined(along))


def _live(folder: Folder) -> dict[str, Any]:
    """Bands of histories of an ensemble, or histories of saved cases: the first, the last and some in between."""
    if folder.has(BANDS):
        columns = folder.numbers(BANDS)
        return live_curves(columns, _bands(columns), BANDS)
    places = sorted(case for case in (folder.path / CASES).glob("*") if (case / SERIES).is_file())
    chosen = [places[i] for i in np.unique(np.linspace(0, len(places) - 1, MOST_RUNS).astype(int))] if places else []
    kept = [Folder(case, "run") for case in chosen]
    runs = [History(case.path.name, case.numbers(SERIES), case.motion()) for case in kept]
    if len(runs) < 2:
        return nothing_live()
    moved, played = motion(runs), kept[0].played()
    bed = None if moved is None or played is None else (moved, played[1])
    return live_overlay([case.name for case in runs], overlaid(runs), bed)


def _bands(columns: dict[str, Array]) -> list[Group]:
    """A panel of quantiles for each column of the ensemble."""
    quantiles: dict[str, list[Curve]] = {}
    for name in columns:
        stem, _, level = name.rpartition("_q")
        if stem:
            text = "median" if level == "50" else f"{int(level)} %"
            quantiles.setdefault(stem, []).append(Curve(text, ((name, 1.0),)))
    panels = [panel(label(stem), stem, curves, columns.__getitem__) for stem, curves in quantiles.items()]
    return [Group("bands", "Bands", "Quantiles of all runs at each instant.", tuple(panels))] if panels else []


def _read(folder: Folder) -> _Cases:
    table = folder.table(TABLE)
    head = table.head
    begin = next((i for i, name in enumerate(head) if name in ("name", "status")), len(head))
    statuses = zip(table.rows, table.column("status"), strict=True)
    ended = Table(head, [row for row, status in statuses if status in FINISHED])
    key_numbers = [
        name
        for name in head[begin:]
        if not name.startswith(_NOT_KEY) and np.isfinite(ended.numbers(name)).any() and name != "touch_time_s"
    ]
    return _Cases(table, ended, head[1:begin], key_numbers)


def _useless(table: Table) -> int:
    """Number of results that are not usable."""
    return sum(str(cell).lower() == "false" for cell in table.column("usable")) if "usable" in table.head else 0


def _distinct(table: Table, name: str) -> list[Any]:
    """Distinct values of a column; empty if there is no such column."""
    return list(dict.fromkeys(v for v in table.column(name) if v is not None)) if name in table.head else []


def _warnings(table: Table) -> list[str]:
    """Warnings of the cases, grouped where they differ only in numbers; the most frequent first."""
    if "warnings" not in table.head:
        return []
    kinds = Kinds()
    for warning in filter(None, table.column("warnings")):
        kinds.add(str(warning))
    return kinds.lines(len(table.rows), "cases", MOST_WARNINGS, TABLE)


def _vague(folder: Folder) -> list[str]:
    """Warnings about sensitivity indices that are too imprecise."""
    if not folder.has(SENSITIVITY):
        return []
    table, names = folder.table(SENSITIVITY), ("output", "input", "note", "first_order")
    if not set(names) <= set(table.head):
        return []
    return [
        f"sensitivity of {label(str(output))} to {label(str(name))}: {note}"
        for output, name, note, first_order in table.of(names)
        if note and first_order is not None
    ]


def _statistics(cases: _Cases) -> Iterator[list[Any]]:
    constant = _constant(cases)
    for name in _ordered(name for name in cases.key_numbers if name not in constant):
        values = cases.ended.numbers(name)
        values = values[np.isfinite(values)]
        spread = (values.min(), np.median(values), values.max())
        yield [label(name), len(values), *(quantity(name, float(value)) for value in spread)]


def _constant(cases: _Cases) -> list[str]:
    """Key numbers that are equal in all cases, if there are several cases."""
    if len(cases.ended.rows) < 2:
        return []
    differing = _differing(cases, cases.key_numbers)
    every = [name for name in cases.key_numbers if np.isfinite(cases.ended.numbers(name)).all()]
    return _ordered(name for name in every if name not in differing)


def _overviews(cases: _Cases, place: Path, shown: Collection[str]) -> Iterator[tuple[Path, str]]:
    """Figures of key numbers against the varied quantities, with captions; shown: key numbers of other figures."""
    varied = _differing(cases, cases.varied)
    if not varied or not cases.key_numbers or all(map(_is_seed, varied)):
        return
    from granular_contact.report.figures.studies import MOST, draw

    for i, name in enumerate([name for name in _drawn(cases) if name not in shown][:MOST]):
        path = place / f"overview_{i}.png"
        along, key_number = {key: cases.ended.numbers(key) for key in varied}, (name, cases.ended.numbers(name))
        draw(along, key_number, path, joined=_joined(varied))
        if path.exists():
            yield path, f"{label(name).capitalize()} of every case that came to an end, against the varied quantities."


def _caption(stem: str) -> str:
    kind, _, output = stem.partition("_")
    if stem in _CAPTIONS:
        return _CAPTIONS[stem]
    return f"Sobol indices of {label(output)}." if kind == "sensitivity" else stem.replace("_", " ")


def _differing(cases: _Cases, names: Sequence[str]) -> list[str]:
    """Names of the numbers that differ between cases by more than round-off."""
    columns = ((name, cases.ended.numbers(name)) for name in names)
    known = [(name, values[np.isfinite(values)]) for name, values in columns]
    return [name for name, values in known if len(values) and np.ptp(values) > SAME * greatest(values)]


def _joined(varied: Sequence[str]) -> bool:
    """Return whether points are joined by a line: if a single quantity is varied that is not a seed."""
    return len(varied) == 1 and not _is_seed(varied[0])


def _is_seed(key: str) -> bool:
    return key.endswith("seed")


def _drawn(cases: _Cases) -> list[str]:
    """Key numbers that differ between cases, the most important first."""
    return _ordered(name for name in _differing(cases, cases.key_numbers) if name not in _NOT_DRAWN)


def _ordered(names: Iterable[str]) -> list[str]:
    """Sort key numbers, the most important first."""
    return sorted(names, key=lambda name: _FIRST.index(name) if name in _FIRST else len(_FIRST))


def _failures(table: Table) -> Rows:
    rows = table.of((table.head[0], "message", "status"))
    return [[case, message] for case, message, status in rows if status not in FINISHED]


def _audit(table: Table) -> dict[str, Any] | None:
    """Energy imbalance: the median, and the worst case."""
    values = table.numbers(IMBALANCE) if IMBALANCE in table.head else np.zeros(0)
    if not np.isfinite(values).any():
        return None
    worst = int(np.nanargmax(values))
    median, most = (quantity(IMBALANCE, float(value)) for value in (np.nanmedian(values), values[worst]))
    return {"median": median, "most": most, "case": table.rows[worst][0]}
