"""What the page of a fit shows."""

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

# Told by a section of their own; what else a record holds is shown as it is.
_TOLD = ("name", "status", "converged", "warnings", "parameters", "correlation", "directions", "runs", "versions")
_RESIDUAL_COLUMNS = ("run", "column", "data", "model", "residual_over_noise")


def content(folder: Folder) -> dict[str, Any]:
    """Content for its template."""
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
        "estimates": [_estimate(*one) for one in parameters.items()],
        "coefficients": list(_coefficients(parameters)),
        "pictures": folder.figures(),
        "correlation": _correlation(record.get("correlation") or {}),
        "directions": list(_directions(record.get("directions") or [])),
        "residuals": list(_residuals(folder)),
        "others": {key: value for key, value in record.items() if key not in _TOLD},
        "media": {path.name: folder.text(path.name) for path in sorted(folder.path.glob("medium*.yaml"))},
        **_live(folder),
        "cases": _cases(folder),
    }


def _cases(folder: Folder) -> dict[str, Any]:
    """Data for the scripts: residuals in units of the noise, over time, or over what a force test prescribed."""
    if not folder.has(RESIDUALS):
        return {}
    table = folder.table(RESIDUALS)
    if not {"run", "column", "residual_over_noise"} <= set(table.head):
        return {}
    columns = {name: table.column(name) for name in table.head if name not in ("run", "column")}
    names = [f"{run}, {name}" for run, name in table.of(("run", "column"))]
    along = ("time_s", *(name for name in columns if name not in _RESIDUAL_COLUMNS))
    drawn = (chart(names, columns, name, "residual_over_noise") for name in along if name in columns)
    return next((one for one in drawn if one), {})


def _measured(folder: Folder, names: Sequence[str]) -> dict[tuple[str, str], Array]:
    """These columns of the residuals (columns, rows) by run and measured column, of rows that have numbers in all."""
    table = folder.table(RESIDUALS) if folder.has(RESIDUALS) else Table([], [])
    found: dict[tuple[str, str], list[list[float]]] = {}
    if {"run", "column", *names} <= set(table.head):
        for run, name, *values in table.of(("run", "column", *names)):
            if all(map(is_number, values)):
                found.setdefault((str(run), str(name)), []).append(values)
    return {key: np.array(values, float).T for key, values in found.items()}


def _live(folder: Folder) -> dict[str, Any]:
    """Data and model over time, a panel for each measured column of each run."""
    measured = _measured(folder, ("time_s", "data", "model"))
    tables = {key: values for key, values in measured.items() if values.shape[1] > 1}
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


def _residuals(folder: Folder) -> Iterator[list[Any]]:
    """How large the residuals are, by run and column."""
    for (run, name), (data, model, scaled) in _measured(folder, _RESIDUAL_COLUMNS[2:]).items():
        rms, largest = np.sqrt(np.mean((data - model) ** 2)), np.abs(data - model).max()
        heading, sizes = column(name, [float(rms), float(largest)])
        unit = heading.rpartition("(")[2].rstrip(")") if split(name)[1] else ""
        words = (f"{plain(one)} {unit}".strip() for one in sizes)
        yield [run, name, len(data), *words, float(np.sqrt(np.mean(scaled**2)))]
