"""Rows of a sweep -> table.csv, and the sweep itself -> sweep.yaml, from which it can be run again."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from granular_contact.config import scenario_to_dict
from granular_contact.config.sweep import Sweep
from granular_contact.report import PROGRAM, SWEEP, TABLE, version, yaml_text
from granular_contact.sweep.worker import Row

CASE = "case"


def write(sweep: Sweep, rows: Iterable[Row], folder: Path) -> None:
    """Write both files; rows may come in any order, and stand in that of the sweep.

    Raises
    ------
    OSError
        The disk refuses.
    """
    rows = sorted(rows, key=lambda row: row.index)
    with (folder / TABLE).open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names := columns(sweep, rows))
        for row in rows:
            cells = {**row.summary, **row.values, CASE: row.name}
            writer.writerow([_cell(cells.get(name)) for name in names])
    with (folder / SWEEP).open("w", encoding="utf-8") as file:
        file.writelines(_sweep_lines(sweep))


def columns(sweep: Sweep, rows: Sequence[Row]) -> list[str]:
    """Names of the columns: the case, what varies, then all that any run tells; rows of crashes know less."""
    told = sorted(rows, key=lambda row: row.summary["status"] == "error")  # stable, so not by who was first
    return list(dict.fromkeys([CASE, *sweep.keys, *(name for row in told for name in row.summary)]))


def _cell(value: Any) -> str:
    """`repr` of a float is the shortest text that reads back as the same one; nothing for what is not known."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list) and not any(isinstance(entry, dict | list) for entry in value):
        return "; ".join(map(_cell, value))
    if isinstance(value, dict | list):
        return json.dumps(value, ensure_ascii=False)
    # numpy's floats are floats, but their repr tells so.
    return repr(float(value)) if isinstance(value, float) else str(value)


def _sweep_lines(sweep: Sweep) -> Iterator[str]:
    """A sweep file that needs no other: the config with every default, and one line for each case."""
    yield f"# Written by {PROGRAM} {version()}; to run it again: {PROGRAM} sweep {SWEEP}\n"
    yield yaml_text({"config": scenario_to_dict(sweep.base)})
    yield "cases:\n"
    for case in sweep.cases:  # JSON is YAML, and written a hundred times as fast
        yield f"  {case.name}: {json.dumps(sweep.changes(case), ensure_ascii=False)}\n"
