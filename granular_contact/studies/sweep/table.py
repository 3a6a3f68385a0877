"""Rows of a sweep -> table.csv, and the sweep itself -> sweep.yaml, from which it can be run again."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from granular_contact.config import Sweep, scenario_to_dict
from granular_contact.report import SWEEP, TABLE, origin, write_table, yaml_text
from granular_contact.studies.sweep.checkpoint import Contents
from granular_contact.studies.sweep.journal import Row

CASE = "case"


def write(sweep: Sweep, rows: Iterable[Row], folder: Path) -> None:
    """Write table.csv; rows are gone through twice, and come in the order of the sweep.

    Raises
    ------
    OSError
        The disk refuses.
    """
    found = ({**row.summary, **row.values, CASE: row.name} for row in rows)
    write_cells(folder / TABLE, columns(sweep, rows), found)


def write_cells(path: Path, names: list[str], rows: Iterable[Mapping[str, Any]]) -> None:
    """Write a table of rows by the names of its columns; what a row does not have stays empty. Raises OSError."""
    write_table(path, names, ([cell(row.get(name)) for name in names] for row in rows))


def columns(sweep: Sweep, rows: Iterable[Row]) -> list[str]:
    """Names of the columns: the case, what varies, then all that any run has; rows of crashes know less."""
    keys_by_success: tuple[dict[str, None], dict[str, None]] = {}, {}
    for row in rows:
        keys_by_success[row.summary["status"] == "error"].update(dict.fromkeys(row.summary))
    return list(dict.fromkeys([CASE, *sweep.keys, *keys_by_success[0], *keys_by_success[1]]))


def cell(value: Any) -> str:
    """A value as the text of a cell; nothing for what is not known."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list) and not any(isinstance(entry, dict | list) for entry in value):
        return "; ".join(map(cell, value))
    if isinstance(value, dict | list):
        return json.dumps(value, ensure_ascii=False)
    return str(value)


def work_of(sweep: Sweep, noun: str = "sweep", runs: str = "cases") -> Contents:
    """What its folder is of; noun, runs: what messages call it and its runs."""
    return Contents("sweep", SWEEP, sweep_text(sweep), TABLE, lambda index: sweep.cases[index].name, noun, runs)


def sweep_text(sweep: Sweep) -> str:
    """A self-contained sweep file: the config with every default, and how cases are drawn, or a line for each."""
    return "".join(_lines(sweep))


def _lines(sweep: Sweep) -> Iterator[str]:
    yield origin(f"sweep {SWEEP}")
    yield yaml_text({"config": scenario_to_dict(sweep.base)})
    if sweep.sample is not None:
        yield yaml_text({"sample": sweep.sample.plain()})
        changes = (json.dumps(sweep.changes(case)).encode() for case in sweep.cases)
        digest = hashlib.sha256(b"\n".join(changes)).hexdigest()[:16]
        yield f"# {len(sweep.cases)} cases, {digest}\n"  # another version of the sampler may draw others
        return
    yield "cases:\n"
    for case in sweep.cases:  # JSON is YAML, and written a hundred times as fast
        yield f"  {case.name}: {json.dumps(sweep.changes(case), ensure_ascii=False)}\n"
