"""Content of the page of a fit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from granular_contact.report import FIT, PROGRAM, RESIDUALS
from granular_contact.report.histories import Curve, Group, panel
from granular_contact.report.pages.chart import chart
from granular_contact.report.pages.folder import Folder, Table
from granular_contact.report.pages.live import live_curves, nothing_live
from granular_contact.report.pages.rendering import flat
from granular_contact.report.units import Array, column, is_number, label, plain, split

# Entries with a section of their own; all other entries of the record are shown as they are.
_OWN_SECTION = (
    "name",
    "status",
    "converged",
    "warnings",
    "parameters",
    "correlation",
    "directions",
    "runs",
    "versions",
)
_RESIDUAL_COLUMNS = ("run", "column", "data", "model", "residual_over_noise")


def content(folder: Folder) -> dict[str, Any]:
    """Values for the template."""
    record = folder.read(FIT)
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
        "estimates": [_estimate(*parameter) for parameter in parameters.items()],
        "coefficients": list(_coefficients(parameters)),
        "pictures": folder.figures(),
        "correlation": _correlation(record.get("correlation") or {}),
        "directions": list(_directions(record.get("directions") or [])),
        "residuals": list(_residuals(folder)),
        "others": {key: value for key, value in record.items() if key not in _OWN_SECTION},
        "media": {path.name: folder.text(path.name) for path in sorted(folder.path.glob("medium*.yaml"))},
        **_live(folder),
        "cases": _cases(folder),
    }


def _cases(folder: Folder) -> dict[str, Any]:
    """Data of the chart: residuals in units of the noise over time, or over a prescribed quantity of a force test."""
    if not folder.has(RESIDUALS):
        return {}
    table = folder.table(RESIDUALS)
    if not {"run", "column", "residual_over_noise"} <= set(table.head):
        return {}
    columns = {name: table.column(name) for name in table.head if name not in ("run", "column")}
    names = [f"{run}, {name}" for run, name in table.of(("run", "column"))]
    along = ("time_s", *(name for name in columns if name not in _RESIDUAL_COLUMNS))
    charts = (chart(names, columns, name, "residual_over_noise") for name in along if name in columns)
    return next((data for data in charts if data), {})


def _measured(folder: Folder, names: Sequence[str]) -> dict[tuple[str, str], Array]:
    """The given columns (columns, rows) of residuals.csv, by run and measured column; only rows with numbers in all."""
    table = folder.table(RESIDUALS) if folder.has(RESIDUALS) else Table([], [])
    rows: dict[tuple[str, str], list[list[float]]] = {}
    if {"run", "column", *names} <= set(table.head):
        for run, name, *values in table.of(("run", "column", *names)):
            if all(map(is_number, values)):
                rows.setdefault((str(run), str(name)), []).append(values)
    return {key: np.array(values, float).T for key, values in rows.items()}


def _live(folder: Folder) -> dict[str, Any]:
    """Panels of data and model over time, one for each measured column of each run."""
    measured = _measured(folder, ("time_s", "data", "model"))
    tables = {key: values for key, values in measured.items() if values.shape[1] > 1}
    if not tables:
        return nothing_live()
    clock = np.unique(np.concatenate([table[0] for table in tables.values()]))
    columns, panels = {"time_s": clock}, []
    for i, ((run, name), (time, *both)) in enumerate(tables.items()):
        curves = []
        for kind, values in zip(("data", "model"), both, strict=True):
            columns[f"{i}.{kind}.{name}"] = np.interp(clock, time, values, left=np.nan, right=np.nan)
            curves.append(Curve(kind, ((f"{i}.{kind}.{name}", 1.0),)))
        panels.append(panel(f"{run}: {label(name)}", name, curves, columns.__getitem__))
    group = Group("data", "Data and model", "Measured data, and the fitted model.", tuple(panels))
    return live_curves(columns, [group], "")


def _estimate(key: str, estimate: dict[str, Any]) -> str:
    value, error = estimate.get("value"), estimate.get("standard_error")
    spread = "(not determined)" if error is None else f"\N{PLUS-MINUS SIGN} {_rounded(error, 2)}"
    return f"{label(key)} {_rounded(value, 4)} {spread}"


def _rounded(value: Any, digits: int) -> str:
    return plain(float(f"{value:.{digits}g}")) if is_number(value) else "unknown"


def _coefficients(parameters: dict[str, dict[str, Any]]) -> Iterator[list[Any]]:
    for key, estimate in parameters.items():
        interval = estimate.get("interval_95") or (None, None)
        bounds = " to ".join(plain(bound) for bound in estimate.get("bounds") or [])
        value, error = (estimate.get(name) for name in ("value", "standard_error"))
        yield [key, value, error, *interval, estimate.get("start"), bounds, estimate.get("at_bound")]


def _correlation(correlation: dict[str, Any]) -> tuple[list[str], list[list[Any]]]:
    """Head and rows of the correlation matrix; empty for a single coefficient."""
    labels, matrix = correlation.get("labels") or [], correlation.get("matrix") or []
    if len(labels) < 2:
        return [], []
    rounded = [[None if x is None else round(x, 3) for x in row] for row in matrix]
    return ["", *labels], [[name, *row] for name, row in zip(labels, rounded, strict=True)]


def _directions(directions: list[dict[str, Any]]) -> Iterator[list[Any]]:
    for direction in directions:
        size, parts = direction.get("relative_error"), direction.get("parts") or {}
        shares = {key: round(share, 2) for key, share in parts.items() if abs(share) >= 0.05}
        yield ["unlimited" if size is None else f"{100 * size:.3g} %", flat(shares)]


def _residuals(folder: Folder) -> Iterator[list[Any]]:
    """Size of the residuals by run and column."""
    for (run, name), (data, model, scaled) in _measured(folder, _RESIDUAL_COLUMNS[2:]).items():
        rms, largest = np.sqrt(np.mean((data - model) ** 2)), np.abs(data - model).max()
        heading, sizes = column(name, [float(rms), float(largest)])
        unit = heading.rpartition("(")[2].rstrip(")") if split(name)[1] else ""
        texts = (f"{plain(size)} {unit}".strip() for size in sizes)
        yield [run, name, len(data), *texts, float(np.sqrt(np.mean(scaled**2)))]
