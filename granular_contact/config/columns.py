"""Insert the numbers of CSV files into a config: signals over time, and the stresses of the law `table`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

from granular_contact.config.csv_table import Table, first_faults, form_faults, number, read_table
from granular_contact.config.messages import unknown
from granular_contact.config.references import readable_path
from granular_contact.config.tree import Broken, Items, Mapping, Node, Position, Scalar, dotted, replace_mappings
from granular_contact.config.tree import Path as TreePath
from granular_contact.errors import Fault
from granular_contact.laws.table import MOST_DRIVING, axis_faults, driving_fault, driving_stress

KEYS = ("drives", "signals")  # keys of a config that may contain csv signals
MOST_ROWS = 100_000
_MEDIA = ("medium", "bed")  # keys of a config that contain media
_SIGNAL_KEYS = {"type", "file", "column", "time_column", "interpolation"}  # keys of a csv signal


def with_numbers(node: Node, key: str, folder: Path, faults: list[Fault]) -> Node:
    """The tree under a key of a config with the numbers of its CSV files.

    A table replaces each signal of the type csv. Each law `table` that names a file gets its stresses. Paths start from
    `folder`, those of an override from the working folder.
    """

    def change(node: Mapping, path: TreePath) -> Node | None:
        if key in KEYS:
            return _signal(node, path, folder, faults) if _text(node, "type") == "csv" else None
        return _stresses(node, path, folder, faults) if _text(node, "law") == "table" else None

    return replace_mappings(node, change, (key,)) if key in (*KEYS, *_MEDIA) else node


def _signal(node: Mapping, path: TreePath, folder: Path, faults: list[Fault]) -> Node:
    """The table for a csv signal. A signal with faulty keys, which the schema reports, is returned as it is."""
    file, column = (_text(node, key) for key in ("file", "column"))
    time_column = "time_s" if "time_column" not in node.nodes else _text(node, "time_column")
    if file is None or column is None or time_column is None or not set(node.nodes) <= _SIGNAL_KEYS:
        return node
    file_faults = list[Fault]()
    table = _table(node, path, folder, file_faults)
    times_and_values = None if table is None else _pairs(table, (time_column, column), file_faults)
    faults += [fault if fault.key else replace(fault, key=dotted(path)) for fault in file_faults]
    if times_and_values is None:
        return Broken(node.position)
    at, source = node.nodes["file"].position, f"{file}, column {column}"
    times, values = times_and_values
    nodes: dict[str, Node] = {
        "type": Scalar(at, "table", "table"),
        "time_s": _numbers(at, times),
        "values": _numbers(at, values),
        "source": Scalar(at, source, source),
    }
    if "interpolation" in node.nodes:
        nodes["interpolation"] = node.nodes["interpolation"]
    return Mapping(node.position, nodes, dict.fromkeys(nodes, at))


def _text(node: Mapping, key: str) -> str | None:
    """The text under a key; None if there is none."""
    below = node.nodes.get(key)
    return below.value if isinstance(below, Scalar) and isinstance(below.value, str) else None


def _numbers(at: Position, values: list[float]) -> Items:
    """The node of a list of numbers."""
    return Items(at, tuple(Scalar(at, value, repr(value)) for value in values))


def _table(node: Mapping, path: TreePath, folder: Path, faults: list[Fault]) -> Table | None:
    """The table in the file that a mapping names. A file that can't be read is a fault of the line that names it."""
    at, file_faults = node.nodes["file"].position, list[Fault]()
    file = (folder if at.line is not None else Path()) / str(_text(node, "file"))
    table = read_table(readable_path(file), file_faults)
    message = f"got {file.name!r}, but {readable_path(file)} can't be read"
    faults += [
        at.fault((*path, "file"), f"{message}: {fault.message}") if fault.line is None else fault
        for fault in file_faults
    ]
    return table


def _missing(table: Table, names: Sequence[str]) -> list[Fault]:
    """A fault for each column that the table lacks."""
    return [
        Fault(table.file, table.header_line, "", f"there is no column {name!r}; {unknown(name, table.header)}")
        for name in names
        if name not in table.header
    ]


def _pairs(table: Table, names: tuple[str, str], faults: list[Fault]) -> tuple[list[float], list[float]] | None:
    """Times and values from the columns `names`; None, with the first fault of them."""
    if missing := _missing(table, names):
        faults += missing
        return None
    times, values = list[float](), list[float]()
    indices = [table.header.index(name) for name in names]
    for line, cells in zip(table.lines, table.rows, strict=True):
        if not any(cells):
            continue
        texts = [cells[i] if i < len(cells) else "" for i in indices]
        time, value = map(number, texts)
        message = ""
        if time is None or value is None:
            i = 0 if time is None else 1
            got = f"got {texts[i][:40]!r}" if texts[i] else "got nothing"
            message = f"{got} in the column {names[i]}; allowed is a finite number"
        elif times and time <= times[-1]:
            message = f"got the time {time:g} after {times[-1]:g}; allowed are times that grow"
        elif len(times) == MOST_ROWS:
            message = f"got more than {MOST_ROWS} rows; at most that many are allowed"
        else:
            times.append(time)
            values.append(value)
        if message:
            faults.append(Fault(table.file, line, "", message))
            return None
    if len(times) < 2:
        message = f"got {len(times)} row{'s' * (len(times) != 1)} of numbers; allowed are 2 or more"
        faults.append(Fault(table.file, None, "", message))
        return None
    return times, values


COLUMNS = ("depth_m", "beta_deg", "gamma_deg", "stress_x_Pa", "stress_z_Pa")
Rows = dict[tuple[float, float, float], tuple[float, float]]  # (depth, beta, gamma) -> stresses (x, z)


def _stresses(node: Mapping, path: TreePath, folder: Path, faults: list[Fault]) -> Node | None:
    """A law `table` with the axes and stresses from its file; None for a law without a file."""
    if _text(node, "file") is None:
        return None
    file_faults = list[Fault]()
    table = _table(node, path, folder, file_faults)
    file_faults += [] if table is None else [*form_faults(table), *_missing(table, COLUMNS)]
    rows = {} if table is None or file_faults else _rows(table, file_faults)
    axes = [sorted({grid_point[i] for grid_point in rows}) for i in range(3)]
    if table is not None and not file_faults:
        file_faults += first_faults(table.file, [*_grid_faults(table, rows, axes)])
    faults += file_faults
    if file_faults:
        return Broken(node.position)
    at, stresses = node.nodes["file"].position, [rows[point] for point in product(*axes)]  # type: ignore[index]
    columns = (*axes, [x for x, _ in stresses], [z for _, z in stresses])
    nodes = {name: below for name, below in node.nodes.items() if name != "file"}
    nodes |= {name: _numbers(at, values) for name, values in zip(COLUMNS, columns, strict=True)}
    return Mapping(node.position, nodes, {name: node.keys.get(name, at) for name in nodes})


def _rows(table: Table, file_faults: list[Fault]) -> Rows:
    """Stresses by depth, beta and gamma.

    Faults are cells without a number, rows for the same depth and angles, stresses at the surface, and stresses that
    would drive a body.
    """
    indices = [table.header.index(name) for name in COLUMNS]
    rows: Rows = {}
    lines: dict[tuple[float, float, float], int] = {}
    faults: list[Fault] = []
    for line, cells in zip(table.lines, table.rows, strict=True):
        values = [number(cells[i]) for i in indices]
        missing = [name for name, value in zip(COLUMNS, values, strict=True) if value is None]
        faults += [
            Fault(table.file, line, name, "got no finite number; allowed is one in every cell") for name in missing
        ]
        if missing:
            continue
        z, b, g, x, up = (float(value) for value in values if value is not None)
        if (z, b, g) in lines:
            faults.append(Fault(table.file, line, "", f"has the depth and angles of line {lines[z, b, g]} once more"))
        if z == 0.0 and (x, up) != (0.0, 0.0):
            faults.append(Fault(table.file, line, "", "has a stress at the surface; allowed is 0 there"))
        rows[z, b, g], lines[z, b, g] = (x, up), line
    scale = max((max(abs(x), abs(up)) for x, up in rows.values()), default=0.0)
    for (z, b, g), (x, up) in rows.items():
        if driving_stress(g, x, up) > MOST_DRIVING * scale:
            faults.append(Fault(table.file, lines[z, b, g], "", driving_fault(z, b, g, driving_stress(g, x, up))))
    file_faults += first_faults(table.file, faults)
    return rows


def _grid_faults(table: Table, rows: Rows, axes: list[list[float]]) -> Iterator[Fault]:
    """Faults of the axes of the grid, and of grid points without a row."""
    if not rows:
        yield Fault(table.file, table.header_line, "", "has no rows; a table needs one for each depth, beta and gamma")
        return
    for path, message in axis_faults(*(tuple(axis) for axis in axes)):
        yield Fault(table.file, table.header_line, str(path[0]), message)
    for z, b, g in product(*axes):
        if (z, b, g) not in rows:
            message = f"has no row for depth {z:g} m, beta {b:g} deg, gamma {g:g} deg, though others have each of these"
            yield Fault(table.file, table.header_line, "", message)
