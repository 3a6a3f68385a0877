"""Columns of CSV files -> signals: where a scenario names a file, its numbers are inserted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from granular_contact.config.csv_table import Table, number, read_table
from granular_contact.config.messages import unknown
from granular_contact.config.references import shown
from granular_contact.config.tree import Broken, Items, Mapping, Node, Position, Scalar, child, dotted, rewritten
from granular_contact.config.tree import Path as TreePath
from granular_contact.errors import Fault

KEYS = ("drives", "signals")  # of a scenario, below which files may be named
MOST_ROWS = 100_000
_KEYS = {"type", "file", "column", "time_column", "interpolation"}


def with_columns(node: Node, key: str, folder: Path, faults: list[Fault]) -> Node:
    """The tree under a key of a scenario with every signal of the type csv replaced by a table.

    Paths start from `folder`; in what stands in no file, as in `--set`, from the working folder.
    """

    def change(node: Mapping, path: TreePath) -> Node | None:
        kind = child(node, "type")
        is_csv = isinstance(kind, Scalar) and kind.value == "csv"
        return _table(node, path, folder, faults) if is_csv else None

    return rewritten(node, change, (key,)) if key in KEYS else node


def _table(node: Mapping, path: TreePath, folder: Path, faults: list[Fault]) -> Node:
    """A csv signal as a table; unchanged if its keys are faulty, which the schema reports."""
    file, column = (_text(node, key) for key in ("file", "column"))
    time_column = "time_s" if "time_column" not in node.nodes else _text(node, "time_column")
    if file is None or column is None or time_column is None or not set(node.nodes) <= _KEYS:
        return node
    at = node.nodes["file"].position
    start = folder if at.line is not None else Path()
    table = _read(start / file, (time_column, column), at, (*path, "file"), faults)
    if table is None:
        return Broken(node.position)
    source = f"{file}, column {column}"
    nodes: dict[str, Node] = {
        "type": Scalar(at, "table", "table"),
        "time_s": numbers_of(at, table[0]),
        "values": numbers_of(at, table[1]),
        "source": Scalar(at, source, source),
    }
    if "interpolation" in node.nodes:
        nodes["interpolation"] = node.nodes["interpolation"]
    return Mapping(node.position, nodes, dict.fromkeys(nodes, at))


def _text(node: Mapping, key: str) -> str | None:
    held = node.nodes.get(key)
    return held.value if isinstance(held, Scalar) and isinstance(held.value, str) else None


def numbers_of(at: Position, values: list[float]) -> Items:
    """A list of numbers as a node."""
    return Items(at, tuple(Scalar(at, value, repr(value)) for value in values))


def _read(
    file: Path, names: tuple[str, str], at: Position, path: TreePath, faults: list[Fault]
) -> tuple[list[float], list[float]] | None:
    """Times and values of a column, or None with faults."""
    found_faults = list[Fault]()
    table = table_named(file, at, path, found_faults)
    if table is not None:
        words = "there is no column"
        lost = [f"{words} {name!r}; {unknown(name, table.header)}" for name in names if name not in table.header]
        found = _pairs(table, names) if not lost else [Fault(table.file, table.header_line, "", one) for one in lost]
        if isinstance(found, tuple):
            return found
        found_faults = found
    faults += [one if one.key else replace(one, key=dotted(path[:-1])) for one in found_faults]
    return None


def table_named(file: Path, at: Position, path: TreePath, faults: list[Fault]) -> Table | None:
    """Table of a file; where it can't be read, the line that names it is at fault."""
    found = list[Fault]()
    table = read_table(shown(file), found)
    words = f"got {file.name!r}, but {shown(file)} can't be read"
    faults += [at.fault(path, f"{words}: {one.message}") if one.line is None else one for one in found]
    return table


def _fault(table: Table, line: int | None, message: str) -> list[Fault]:
    return [Fault(table.file, line, "", message)]


def _pairs(table: Table, names: tuple[str, str]) -> tuple[list[float], list[float]] | list[Fault]:
    """Times and values of two columns, or the first fault of them."""
    times, values = list[float](), list[float]()
    where = [table.header.index(name) for name in names]
    for line, cells in zip(table.lines, table.rows, strict=True):
        if not any(cells):
            continue
        texts = [cells[i] if i < len(cells) else "" for i in where]
        time, value = map(number, texts)
        if time is None or value is None:
            i = 0 if time is None else 1
            got = f"got {texts[i][:40]!r}" if texts[i] else "got nothing"
            return _fault(table, line, f"{got} in the column {names[i]}; allowed is a finite number")
        if times and time <= times[-1]:
            return _fault(table, line, f"got the time {time:g} after {times[-1]:g}; allowed are times that grow")
        if len(times) == MOST_ROWS:
            return _fault(table, line, f"got more than {MOST_ROWS} rows; at most that many are allowed")
        times.append(time)
        values.append(value)
    if len(times) < 2:
        words = f"got {len(times)} row{'s' * (len(times) != 1)} of numbers; allowed are 2 or more"
        return _fault(table, None, words)
    return times, values
