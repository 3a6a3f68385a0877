"""CSV files that a scenario names -> their numbers, inserted: signals over time, and the stresses of a law `table`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

from granular_contact.config.csv_table import Table, few, form_faults, number, read_table
from granular_contact.config.messages import unknown
from granular_contact.config.references import shown
from granular_contact.config.tree import Broken, Items, Mapping, Node, Position, Scalar, dotted, rewritten
from granular_contact.config.tree import Path as TreePath
from granular_contact.errors import Fault
from granular_contact.laws.table import MOST_DRIVING, axis_faults, driving_fault, driving_stress

KEYS = ("drives", "signals")  # of a scenario, below which files may be named
MOST_ROWS = 100_000
_MEDIA = ("medium", "bed")
_OF_CSV = {"type", "file", "column", "time_column", "interpolation"}


def with_numbers(node: Node, key: str, folder: Path, faults: list[Fault]) -> Node:
    """The tree under a key of a scenario with the numbers of CSV files in it: as a table in the place of every signal
    of the type csv, and in every law `table` that names a file.

    Paths start from `folder`; in what stands in no file, as in `--set`, from the working folder.
    """

    def change(node: Mapping, path: TreePath) -> Node | None:
        if key in KEYS:
            return _signal(node, path, folder, faults) if _text(node, "type") == "csv" else None
        return _stresses(node, path, folder, faults) if _text(node, "law") == "table" else None

    return rewritten(node, change, (key,)) if key in (*KEYS, *_MEDIA) else node


def _signal(node: Mapping, path: TreePath, folder: Path, faults: list[Fault]) -> Node:
    """A csv signal as a table; unchanged if its keys are faulty, which the schema reports."""
    file, column = (_text(node, key) for key in ("file", "column"))
    time_column = "time_s" if "time_column" not in node.nodes else _text(node, "time_column")
    if file is None or column is None or time_column is None or not set(node.nodes) <= _OF_CSV:
        return node
    own_faults = list[Fault]()
    table = _table(node, path, folder, own_faults)
    found = None if table is None else _pairs(table, (time_column, column), own_faults)
    faults += [one if one.key else replace(one, key=dotted(path)) for one in own_faults]
    if found is None:
        return Broken(node.position)
    at, source = node.nodes["file"].position, f"{file}, column {column}"
    nodes: dict[str, Node] = {
        "type": Scalar(at, "table", "table"),
        "time_s": _numbers(at, found[0]),
        "values": _numbers(at, found[1]),
        "source": Scalar(at, source, source),
    }
    if "interpolation" in node.nodes:
        nodes["interpolation"] = node.nodes["interpolation"]
    return Mapping(node.position, nodes, dict.fromkeys(nodes, at))


def _text(node: Mapping, key: str) -> str | None:
    held = node.nodes.get(key)
    return held.value if isinstance(held, Scalar) and isinstance(held.value, str) else None


def _numbers(at: Position, values: list[float]) -> Items:
    """A list of numbers as a node."""
    return Items(at, tuple(Scalar(at, value, repr(value)) for value in values))


def _table(node: Mapping, path: TreePath, folder: Path, faults: list[Fault]) -> Table | None:
    """Table of the file that a mapping names; where it can't be read, the line that names it is at fault."""
    at, found = node.nodes["file"].position, list[Fault]()
    file = (folder if at.line is not None else Path()) / str(_text(node, "file"))
    table = read_table(shown(file), found)
    words = f"got {file.name!r}, but {shown(file)} can't be read"
    faults += [at.fault((*path, "file"), f"{words}: {one.message}") if one.line is None else one for one in found]
    return table


def _lost(table: Table, names: Sequence[str]) -> list[Fault]:
    """Faults of columns that are not there."""
    return [
        Fault(table.file, table.header_line, "", f"there is no column {name!r}; {unknown(name, table.header)}")
        for name in names
        if name not in table.header
    ]


def _pairs(table: Table, names: tuple[str, str], faults: list[Fault]) -> tuple[list[float], list[float]] | None:
    """Times and values of two columns; None, with the first fault of them."""
    if lost := _lost(table, names):
        faults += lost
        return None
    times, values = list[float](), list[float]()
    where = [table.header.index(name) for name in names]
    for line, cells in zip(table.lines, table.rows, strict=True):
        if not any(cells):
            continue
        texts = [cells[i] if i < len(cells) else "" for i in where]
        time, value = map(number, texts)
        wrong = ""
        if time is None or value is None:
            i = 0 if time is None else 1
            got = f"got {texts[i][:40]!r}" if texts[i] else "got nothing"
            wrong = f"{got} in the column {names[i]}; allowed is a finite number"
        elif times and time <= times[-1]:
            wrong = f"got the time {time:g} after {times[-1]:g}; allowed are times that grow"
        elif len(times) == MOST_ROWS:
            wrong = f"got more than {MOST_ROWS} rows; at most that many are allowed"
        else:
            times.append(time)
            values.append(value)
        if wrong:
            faults.append(Fault(table.file, line, "", wrong))
            return None
    if len(times) < 2:
        words = f"got {len(times)} row{'s' * (len(times) != 1)} of numbers; allowed are 2 or more"
        faults.append(Fault(table.file, None, "", words))
        return None
    return times, values


COLUMNS = ("depth_m", "beta_deg", "gamma_deg", "stress_x_Pa", "stress_z_Pa")
Rows = dict[tuple[float, float, float], tuple[float, float]]


def _stresses(node: Mapping, path: TreePath, folder: Path, faults: list[Fault]) -> Node | None:
    """A law with the axes and stresses of its file; None of one that names none."""
    if _text(node, "file") is None:
        return None
    own_faults = list[Fault]()
    table = _table(node, path, folder, own_faults)
    own_faults += [] if table is None else [*form_faults(table), *_lost(table, COLUMNS)]
    rows = {} if table is None or own_faults else _rows(table, own_faults)
    axes = [sorted({place[i] for place in rows}) for i in range(3)]
    if table is not None and not own_faults:
        own_faults += few(table.file, [*_holes(table, rows, axes)])
    faults += own_faults
    if own_faults:
        return Broken(node.position)
    at, ordered = node.nodes["file"].position, [rows[place] for place in product(*axes)]  # type: ignore[index]
    columns = (*axes, [x for x, _ in ordered], [z for _, z in ordered])
    nodes = {name: one for name, one in node.nodes.items() if name != "file"}
    nodes |= {name: _numbers(at, values) for name, values in zip(COLUMNS, columns, strict=True)}
    return Mapping(node.position, nodes, {name: node.keys.get(name, at) for name in nodes})


def _rows(table: Table, own_faults: list[Fault]) -> Rows:
    """Stresses by depth, beta and gamma; faults of cells, of places that come twice, and of what would drive a body."""
    where = [table.header.index(name) for name in COLUMNS]
    found: Rows = {}
    lines: dict[tuple[float, float, float], int] = {}
    wrong: list[Fault] = []
    for line, cells in zip(table.lines, table.rows, strict=True):
        values = [number(cells[i]) for i in where]
        missing = [name for name, value in zip(COLUMNS, values, strict=True) if value is None]
        wrong += [
            Fault(table.file, line, name, "got no finite number; allowed is one in every cell") for name in missing
        ]
        if missing:
            continue
        z, b, g, x, up = (float(value) for value in values if value is not None)
        if (z, b, g) in lines:
            wrong.append(Fault(table.file, line, "", f"has the depth and angles of line {lines[z, b, g]} once more"))
        if z == 0.0 and (x, up) != (0.0, 0.0):
            wrong.append(Fault(table.file, line, "", "has a stress at the surface; allowed is 0 there"))
        found[z, b, g], lines[z, b, g] = (x, up), line
    scale = max((max(abs(x), abs(up)) for x, up in found.values()), default=0.0)
    for (z, b, g), (x, up) in found.items():
        if driving_stress(g, x, up) > MOST_DRIVING * scale:
            wrong.append(Fault(table.file, lines[z, b, g], "", driving_fault(z, b, g, driving_stress(g, x, up))))
    own_faults += few(table.file, wrong)
    return found


def _holes(table: Table, rows: Rows, axes: list[list[float]]) -> Iterator[Fault]:
    """Faults of axes, and of places without a row."""
    if not rows:
        yield Fault(table.file, table.header_line, "", "has no rows; a table needs one for each depth, beta and gamma")
        return
    for path, message in axis_faults(*(tuple(one) for one in axes)):
        yield Fault(table.file, table.header_line, str(path[0]), message)
    for z, b, g in product(*axes):
        if (z, b, g) not in rows:
            words = f"has no row for depth {z:g} m, beta {b:g} deg, gamma {g:g} deg, though others have each of these"
            yield Fault(table.file, table.header_line, "", words)
