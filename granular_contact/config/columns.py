"""Columns of CSV files -> signals: where a scenario names a file, its numbers are put in."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol

from granular_contact.config.messages import unknown
from granular_contact.config.references import shown
from granular_contact.config.tree import Broken, Items, Mapping, Node, Position, Scalar, child, set_key
from granular_contact.errors import Fault

KEYS = ("drives", "signals")  # of a scenario, below which files may be named
MOST_ROWS = 100_000
_KEYS = {"type", "file", "column", "time_column", "interpolation"}


def with_columns(root: Node, folder: Path, faults: list[Fault]) -> Node:
    """The tree of a scenario with every signal of the type csv replaced by a table; paths are from `folder`."""
    if not isinstance(root, Mapping):
        return root
    for key in KEYS:
        held = root.nodes.get(key)
        if held is not None:
            root = set_key(root, key, _replaced(held, (key,), folder, faults), root.keys[key])
    return root


def _replaced(node: Node, path: tuple[str, ...], folder: Path, faults: list[Fault]) -> Node:
    if not isinstance(node, Mapping):
        return node
    kind = child(node, "type")
    if isinstance(kind, Scalar) and kind.value == "csv":
        return _table(node, path, folder, faults)
    for key, below in node.nodes.items():
        node = set_key(node, key, _replaced(below, (*path, key), folder, faults), node.keys[key])
    return node


def _table(node: Mapping, path: tuple[str, ...], folder: Path, faults: list[Fault]) -> Node:
    """A csv signal as a table; as it is if its keys are at fault, which the schema tells."""
    file, column = (_text(node, key) for key in ("file", "column"))
    time_column = "time_s" if "time_column" not in node.nodes else _text(node, "time_column")
    if file is None or column is None or time_column is None or not set(node.nodes) <= _KEYS:
        return node
    at = node.nodes["file"].position
    table = _read(folder / file, (time_column, column), at, (*path, "file"), faults)
    if table is None:
        return Broken(node.position)
    source = f"{file}, column {column}"
    nodes: dict[str, Node] = {
        "type": Scalar(at, "table", "table"),
        "time_s": _numbers(at, table[0]),
        "values": _numbers(at, table[1]),
        "source": Scalar(at, source, source),
    }
    if "interpolation" in node.nodes:
        nodes["interpolation"] = node.nodes["interpolation"]
    return Mapping(node.position, nodes, dict.fromkeys(nodes, at))


def _text(node: Mapping, key: str) -> str | None:
    held = node.nodes.get(key)
    return held.value if isinstance(held, Scalar) and isinstance(held.value, str) else None


def _numbers(at: Position, values: list[float]) -> Items:
    return Items(at, tuple(Scalar(at, value, repr(value)) for value in values))


def _read(
    file: Path, names: tuple[str, str], at: Position, path: tuple[str, ...], faults: list[Fault]
) -> tuple[list[float], list[float]] | None:
    """Times and values of a column, or None with a fault."""
    name = str(shown(file))

    def refuse(line: int | None, message: str) -> None:
        faults.append(Fault(name, line, ".".join(path[:-1]), message))

    try:
        with file.open(encoding="utf-8-sig", newline="") as lines:
            rows = csv.reader(lines)
            header = [cell.strip() for cell in next(rows, [])]
            missing = [column for column in names if column not in header]
            for column in missing:
                refuse(
                    1, f"there is no column {column!r}; {unknown(column, header) if header else 'the file is empty'}"
                )
            return None if missing else _rows(rows, header, names, refuse)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        words = getattr(error, "strerror", None) or "it is no CSV text"
        faults.append(at.fault(path, f"got {file.name!r}, but {name} can't be read: {words}"))
        return None


class _Rows(Protocol):
    """A csv.reader: cells of each line, and how many lines were read."""

    line_num: int

    def __iter__(self) -> Iterator[list[str]]: ...

    def __next__(self) -> list[str]: ...


def _rows(
    rows: _Rows, header: list[str], names: tuple[str, str], refuse: Callable[[int | None, str], None]
) -> tuple[list[float], list[float]] | None:
    where = [header.index(column) for column in names]
    times: list[float] = []
    values: list[float] = []
    for cells in rows:
        if not any(cell.strip() for cell in cells):
            continue
        numbers = []
        for column, i in zip(names, where, strict=True):
            cell = cells[i].strip() if i < len(cells) else ""
            number = _number(cell)
            if number is None:
                got = f"got {cell[:40]!r}" if cell else "got nothing"
                refuse(rows.line_num, f"{got} in the column {column}; allowed is a finite number")
                return None
            numbers.append(number)
        if times and numbers[0] <= times[-1]:
            refuse(rows.line_num, f"got the time {numbers[0]:g} after {times[-1]:g}; allowed are times that grow")
            return None
        if len(times) == MOST_ROWS:
            refuse(rows.line_num, f"got more than {MOST_ROWS} rows; allowed are at most so many")
            return None
        times.append(numbers[0])
        values.append(numbers[1])
    if len(times) < 2:
        refuse(None, f"got {len(times)} row{'s' * (len(times) != 1)} of numbers; allowed are 2 or more")
        return None
    return times, values


def _number(cell: str) -> float | None:
    try:
        number = float(cell)
    except ValueError:
        return None
    return number if math.isfinite(number) and "_" not in cell else None
