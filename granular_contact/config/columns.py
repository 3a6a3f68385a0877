"""CSV files that a scenario names -> their numbers, inserted: signals over time, and the stresses of a law `table`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path

from granular_contact.config.csv_table import Table, few, form_faults, number, read_table
from granular_contact.config.messages import unknown
from granular_contact.config.references import shown
from granular_contact.config.tree import Broken, Items, Mapping, Node, Position, Scalar, child, dotted, rewritten
from granular_contact.config.tree import Path as TreePath
from granular_contact.errors import Fault
from granular_contact.laws.table import MOST_DRIVING, axis_faults, driving, power

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


COLUMNS = ("depth_m", "beta_deg", "gamma_deg", "stress_x_Pa", "stress_z_Pa")
Rows = dict[tuple[float, float, float], tuple[float, float]]


def with_tables(node: Node, key: str, folder: Path, faults: list[Fault]) -> Node:
    """The tree under a key of a scenario with every file of a law `table` replaced by its numbers; paths as of
    `with_columns`.
    """

    def change(node: Mapping, path: TreePath) -> Node | None:
        law, file = child(node, "law"), child(node, "file")
        named = isinstance(file, Scalar) and isinstance(file.value, str)
        if not (named and isinstance(law, Scalar) and law.value == "table"):
            return None
        assert isinstance(file, Scalar)
        found = _read_stresses(folder, faults, file, dotted((*path, "file")))
        if found is None:
            return Broken(node.position)
        nodes = {name: one for name, one in node.nodes.items() if name != "file"}
        nodes |= {name: numbers_of(file.position, values) for name, values in found.items()}
        return Mapping(node.position, nodes, {name: node.keys.get(name, file.position) for name in nodes})

    return rewritten(node, change, (key,)) if key in ("medium", "bed") else node


def _read_stresses(folder: Path, faults: list[Fault], named: Scalar, key: str) -> dict[str, list[float]] | None:
    """Axes and stresses of a file; None, with faults."""
    start = folder if named.position.line is not None else Path()
    table = table_named(start / str(named.value), named.position, (key,), faults)
    if table is None:
        return None
    own_faults = form_faults(table)
    lost = [name for name in COLUMNS if name not in table.header]
    own_faults += [
        Fault(table.file, table.header_line, "", f"there is no column {name!r}; {unknown(name, table.header)}")
        for name in lost
    ]
    rows = {} if own_faults else _rows(table, own_faults)
    axes = [sorted({place[i] for place in rows}) for i in range(3)]
    if not own_faults:
        own_faults += few(table.file, [*_holes(table, rows, axes)])
    if own_faults:
        faults += own_faults
        return None
    ordered = [rows[place] for place in product(*axes)]  # type: ignore[index]
    return dict(zip(COLUMNS, (*axes, [x for x, _ in ordered], [z for _, z in ordered]), strict=True))


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
        if power(g, x, up) > MOST_DRIVING * scale:
            wrong.append(Fault(table.file, lines[z, b, g], "", driving(z, b, g, power(g, x, up))))
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
