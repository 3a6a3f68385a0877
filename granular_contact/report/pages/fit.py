"""The page of a fit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from granular_contact.report import PROGRAM
from granular_contact.report.pages import parts
from granular_contact.report.pages.anything import flat, shown
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.markup import Markup, tag
from granular_contact.report.pages.numbers import column, is_number, label, plain, split
from granular_contact.report.pages.page import page as whole

RECORD, RESIDUALS = "fit.json", "residuals.csv"
FIGURES = {
    "residuals": "Residuals in units of the noise, over time and as a histogram.",
    "correlation": "Correlation of the errors of the coefficients.",
}
# Told by a section of their own; what else a record holds is shown as it is.
_TOLD = ("name", "status", "converged", "warnings", "parameters", "correlation", "directions", "runs", "versions")
_RESIDUAL_COLUMNS = ("run", "column", "data", "model", "residual_over_noise")


def page(folder: Folder) -> str:
    """HTML of a fit's page."""
    record = folder.read(RECORD)
    parameters: dict[str, dict[str, Any]] = record.get("parameters") or {}
    sections = [
        parts.warnings([str(one) for one in record.get("warnings") or []]),
        parts.section("Coefficients", _coefficients(parameters)),
        parts.section("Figures", parts.figures(folder.figures(), FIGURES)),
        parts.section("Correlation", _correlation(record.get("correlation") or {})),
        parts.section("What the data tell apart", _directions(record.get("directions") or [])),
        parts.section("Data", *shown("measured runs", record.get("runs") or [])),
        parts.section("Residuals", _residuals(folder)),
        *(parts.section(label(k).capitalize(), *shown(label(k), v)) for k, v in record.items() if k not in _TOLD),
        *(
            parts.section(path.stem.replace("_", " ").capitalize(), _medium(folder, path.name))
            for path in sorted(folder.path.glob("medium*.yaml"))
        ),
        parts.section("Computation", parts.listing("Versions that made it.", record.get("versions") or {})),
    ]
    status = str(record.get("status", "unknown"))
    badge = tag("span", status, class_="status" if status == "fits" else "status bad")
    version = str((record.get("versions") or {}).get(PROGRAM, ""))
    name = str(record.get("name") or folder.path.name)
    return whole(name, "Fit", badge, " ".join(_sentences(record, parameters)), sections, version)


def _sentences(record: dict[str, Any], parameters: dict[str, dict[str, Any]]) -> Iterator[str]:
    runs = record.get("runs") or []
    count, rows = len(parameters), sum(run.get("rows", 0) for run in runs)
    yield (
        f"{count} coefficient{'s' * (count != 1)} from {rows} instants of {len(runs)} measured "
        f"run{'s' * (len(runs) != 1)}: {', '.join(_estimate(*one) for one in parameters.items())}."
    )
    if record.get("converged") is False:
        yield "The search did not converge."
    status = record.get("status")
    if status == "fits":
        yield "The residuals look like noise."
    elif status == "misfit":
        yield "The residuals are no noise: the model misses something."


def _estimate(key: str, found: dict[str, Any]) -> str:
    value, error = found.get("value"), found.get("standard_error")
    spread = "(no error can be given)" if error is None else f"\N{PLUS-MINUS SIGN} {_rounded(error, 2)}"
    return f"{label(key)} {_rounded(value, 4)} {spread}"


def _rounded(value: Any, digits: int) -> str:
    return plain(float(f"{value:.{digits}g}")) if is_number(value) else "unknown"


def _coefficients(parameters: dict[str, dict[str, Any]]) -> Markup | None:
    rows = []
    for key, found in parameters.items():
        interval = found.get("interval_95") or (None, None)
        bounds = " to ".join(plain(one) for one in found.get("bounds") or [])
        named = (found.get(name) for name in ("value", "standard_error"))
        rows.append([key, *named, *interval, found.get("start"), bounds, found.get("at_bound")])
    head = ["coefficient", "value", "standard error", "95 % from", "to", "start", "bounds", "at a bound"]
    return parts.table("What was found; intervals hold with a probability of 95 %.", head, rows) if rows else None


def _correlation(correlation: dict[str, Any]) -> Markup | None:
    labels, matrix = correlation.get("labels") or [], correlation.get("matrix") or []
    if len(labels) < 2:
        return None
    rounded = [[None if x is None else round(x, 3) for x in row] for row in matrix]
    rows = [[name, *row] for name, row in zip(labels, rounded, strict=True)]
    caption = "Correlation of the errors; near 1 or -1 two coefficients can stand in for each other."
    return parts.table(caption, ["", *labels], rows)


def _directions(directions: list[dict[str, Any]]) -> Markup | None:
    rows = []
    for one in directions:
        size = one.get("relative_error")
        moved = {key: round(share, 2) for key, share in (one.get("parts") or {}).items() if abs(share) >= 0.05}
        rows.append(["unknown" if size is None else f"{100 * size:.3g} %", flat(moved)])
    caption = "Combinations of coefficients, as shares of their relative changes, and how well each is known."
    return parts.table(caption, ["known to", "combination"], rows) if rows else None


def _residuals(folder: Folder) -> Markup | None:
    """How large the residuals are, by run and column."""
    if not folder.has(RESIDUALS):
        return None
    head, rows = folder.table(RESIDUALS)
    if not set(_RESIDUAL_COLUMNS) <= set(head):
        return None
    groups: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for row in rows:
        run, name, data, model, scaled = (row[head.index(one)] for one in _RESIDUAL_COLUMNS)
        if is_number(data) and is_number(model) and is_number(scaled):
            groups.setdefault((str(run), str(name)), []).append((data - model, scaled))
    found = [_spread(run, name, np.array(values)) for (run, name), values in groups.items()]
    names = ["run", "column", "rows", "rms of residuals", "largest", "rms in units of the noise"]
    return parts.table(f"What the model leaves, from {RESIDUALS}.", names, found)


def _spread(run: str, name: str, values: np.ndarray[Any, np.dtype[np.float64]]) -> list[Any]:
    rms, scaled = np.sqrt(np.mean(values**2, axis=0))
    heading, (one, largest) = column(name, [float(rms), float(np.abs(values[:, 0]).max())])
    unit = heading.rpartition("(")[2].rstrip(")") if split(name)[1] else ""
    return [run, name, len(values), f"{plain(one)} {unit}".strip(), f"{plain(largest)} {unit}".strip(), float(scaled)]


def _medium(folder: Folder, name: str) -> Markup:
    return parts.source(folder.path / name, f"The medium as found, ready to use: medium: {name} in a config.")
