"""Write the rows of a sweep to table.csv, and the sweep itself to sweep.yaml, from which it can be run again."""

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
    """Write table.csv of a sweep.

    Parameters
    ----------
    sweep : Sweep
        The sweep.
    rows : iterable of Row
        Results of the cases in the order of the sweep; iterated over twice.
    folder : Path
        An existing folder.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    entries = ({**row.summary, **row.values, CASE: row.name} for row in rows)
    write_cells(folder / TABLE, columns(sweep, rows), entries)


def write_cells(path: Path, names: list[str], rows: Iterable[Mapping[str, Any]]) -> None:
    """Write a table of rows by the names of its columns; missing entries stay empty. Raises OSError."""
    write_table(path, names, ([cell(row.get(name)) for name in names] for row in rows))


def columns(sweep: Sweep, rows: Iterable[Row]) -> list[str]:
    """Names of the columns: the case, the varied keys, then the key numbers of all rows.

    Rows of errors have few key numbers, so theirs come last.
    """
    keys_by_error: tuple[dict[str, None], dict[str, None]] = {}, {}
    for row in rows:
        keys_by_error[row.summary["status"] == "error"].update(dict.fromkeys(row.summary))
    return list(dict.fromkeys([CASE, *sweep.keys, *keys_by_error[0], *keys_by_error[1]]))


def cell(value: Any) -> str:
    """Format a value as the text of a cell; empty for None, NaN and infinity."""
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
    """Contents of the results folder of a sweep; noun, runs: names of the sweep and of its runs in messages."""
    return Contents("sweep", SWEEP, sweep_text(sweep), TABLE, lambda index: sweep.cases[index].name, noun, runs)


def sweep_text(sweep: Sweep) -> str:
    """Self-contained sweep file: the config with every default, and the sample or a line for each case."""
    return "".join(_lines(sweep))


def _lines(sweep: Sweep) -> Iterator[str]:
    yield origin(f"sweep {SWEEP}")
    yield yaml_text({"config": scenario_to_dict(sweep.base)})
    if sweep.sample is not None:
        yield yaml_text({"sample": sweep.sample.plain()})
        changes = (json.dumps(sweep.changes(case)).encode() for case in sweep.cases)
        digest = hashlib.sha256(b"\n".join(changes)).hexdigest()[:16]
        # The digest tells whether another version of the sampler draws other cases.
        yield f"# {len(sweep.cases)} cases, {digest}\n"
        return
    yield "cases:\n"
    for case in sweep.cases:  # JSON is valid YAML, and is written a hundred times as fast
        yield f"  {case.name}: {json.dumps(sweep.changes(case), ensure_ascii=False)}\n"
