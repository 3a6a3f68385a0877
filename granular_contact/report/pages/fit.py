"""What the page of a fit shows."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from granular_contact.report import PROGRAM
from granular_contact.report.histories import Curve, Group, panel
from granular_contact.report.pages.chart import chart
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.live import live_curves, nothing_live
from granular_contact.report.pages.rendering import flat
from granular_contact.report.units import column, is_number, label, plain, split

RECORD, RESIDUALS = "fit.json", "residuals.csv"
# Told by a section of their own; what else a record holds is shown as it is.
_TOLD = ("name", "status", "converged", "warnings", "parameters", "correlation", "directions", "runs", "versions")
_RESIDUAL_COLUMNS = ("run", "column", "data", "model", "residual_over_noise")


def content(folder: Folder) -> dict[str, Any]:
    """Content for its template."""
    record = folder.read(RECORD)
    parameters: dict[str, dict[str, Any]] = record.get("parameters") or {}
    runs = record.get("runs") or []
    return {
        "title": record.get("name") or folder.path.name,
        "version": (record.get("versions") or {}).get(PROGRAM, ""),
        "record": record,
        "status": str(record.get("status", "unknown")),
        "parameters": parameters,
        "runs": runs,
        "instants": sum(run.get("rows", 0) for run in runs),
        "estimates": [_estimate(*one) for one in parameters.items()],
        "coefficients": list(_coefficients(parameters)),
        "pictures": folder.figures(),
        "correlation": _correlation(record.get("correlation") or {}),
        "directions": list(_directions(record.get("directions") or [])),
        "residuals": _residuals(folder),
        "others": {key: value for key, value in record.items() if key not in _TOLD},
        "media": {path.name: folder.text(path.name) for path in sorted(folder.path.glob("medium*.yaml"))},
    }


def data(folder: Folder) -> dict[str, Any]:
    """Data for the scripts: residuals in units of the noise, over time, or over what a force test prescribed."""
    head, rows = folder.table(RESIDUALS) if folder.has(RESIDUALS) else ([], [])
    if not {"run", "column", "residual_over_noise"} <= set(head):
        return {}
    columns = {name: [row[i] for row in rows] for i, name in enumerate(head) if name not in ("run", "column")}
    names = [f"{row[head.index('run')]}, {row[head.index('column')]}" for row in rows]
    along = ("time_s", *(name for name in columns if name not in _RESIDUAL_COLUMNS))
    drawn = (chart(names, columns, name, "residual_over_noise") for name in along if name in columns)
    return next((one for one in drawn if one), {})


def live(folder: Folder) -> dict[str, Any]:
    """Data and model over time, a panel for each measured column of each run."""
    head, rows = folder.table(RESIDUALS) if folder.has(RESIDUALS) else ([], [])
    if not {*_RESIDUAL_COLUMNS, "time_s"} <= set(head):
        return nothing_live()
    measured: dict[tuple[str, str], list[list[float]]] = {}
    for row in rows:
        run, name, time, data, model = (row[head.index(one)] for one in ("run", "column", "time_s", "data", "model"))
        if all(is_number(one) for one in (time, data, model)):
            measured.setdefault((str(run), str(name)), []).append([time, data, model])
    tables = {one: np.array(values).T for one, values in measured.items() if len(values) > 1}
    if not tables:
        return nothing_live()
    clock = np.unique(np.concatenate([table[0] for table in tables.values()]))
    columns, panels = {"time_s": clock}, []
    for i, ((run, name), (time, *both)) in enumerate(tables.items()):
        curves = []
        for words, values in zip(("data", "model"), both, strict=True):
            columns[f"{i}.{words}.{name}"] = np.interp(clock, time, values, left=np.nan, right=np.nan)
            curves.append(Curve(words, ((f"{i}.{words}.{name}", 1.0),)))
        panels.append(panel(f"{run}: {label(name)}", name, curves, columns.__getitem__))
    return live_curves(columns, [Group("data", "Data and model", "As measured, and as fitted.", tuple(panels))], "")


def _estimate(key: str, found: dict[str, Any]) -> str:
    value, error = found.get("value"), found.get("standard_error")
    spread = "(no error can be given)" if error is None else f"\N{PLUS-MINUS SIGN} {_rounded(error, 2)}"
    return f"{label(key)} {_rounded(value, 4)} {spread}"


def _rounded(value: Any, digits: int) -> str:
    return plain(float(f"{value:.{digits}g}")) if is_number(value) else "unknown"


def _coefficients(parameters: dict[str, dict[str, Any]]) -> Iterator[list[Any]]:
    for key, found in parameters.items():
        interval = found.get("interval_95") or (None, None)
        bounds = " to ".join(plain(one) for one in found.get("bounds") or [])
        named = (found.get(name) for name in ("value", "standard_error"))
        yield [key, *named, *interval, found.get("start"), bounds, found.get("at_bound")]


def _correlation(correlation: dict[str, Any]) -> tuple[list[str], list[list[Any]]]:
    """Head and rows of a matrix; no rows of a single coefficient."""
    labels, matrix = correlation.get("labels") or [], correlation.get("matrix") or []
    if len(labels) < 2:
        return [], []
    rounded = [[None if x is None else round(x, 3) for x in row] for row in matrix]
    return ["", *labels], [[name, *row] for name, row in zip(labels, rounded, strict=True)]


def _directions(directions: list[dict[str, Any]]) -> Iterator[list[Any]]:
    for one in directions:
        size = one.get("relative_error")
        moved = {key: round(share, 2) for key, share in (one.get("parts") or {}).items() if abs(share) >= 0.05}
        yield ["unknown" if size is None else f"{100 * size:.3g} %", flat(moved)]


def _residuals(folder: Folder) -> list[list[Any]]:
    """How large the residuals are, by run and column."""
    head, rows = folder.table(RESIDUALS) if folder.has(RESIDUALS) else ([], [])
    if not set(_RESIDUAL_COLUMNS) <= set(head):
        return []
    groups: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for row in rows:
        run, name, data, model, scaled = (row[head.index(one)] for one in _RESIDUAL_COLUMNS)
        if is_number(data) and is_number(model) and is_number(scaled):
            groups.setdefault((str(run), str(name)), []).append((data - model, scaled))
    return [_spread(run, name, np.array(values)) for (run, name), values in groups.items()]


def _spread(run: str, name: str, values: np.ndarray[Any, np.dtype[np.float64]]) -> list[Any]:
    rms, scaled = np.sqrt(np.mean(values**2, axis=0))
    heading, (one, largest) = column(name, [float(rms), float(np.abs(values[:, 0]).max())])
    unit = heading.rpartition("(")[2].rstrip(")") if split(name)[1] else ""
    return [run, name, len(values), f"{plain(one)} {unit}".strip(), f"{plain(largest)} {unit}".strip(), float(scaled)]
