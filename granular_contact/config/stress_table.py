"""A CSV file of stresses -> the numbers of a law `table`: where a medium names a file, they are inserted."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path

from granular_contact.config.columns import numbers_of, table_named
from granular_contact.config.csv_table import Table, few, form_faults, number
from granular_contact.config.messages import unknown
from granular_contact.config.tree import Broken, Mapping, Node, Scalar, child, dotted, rewritten
from granular_contact.config.tree import Path as TreePath
from granular_contact.errors import Fault
from granular_contact.laws.table import MOST_DRIVING, axis_faults, driving, power

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
        found = _read(folder, faults, file, dotted((*path, "file")))
        if found is None:
            return Broken(node.position)
        nodes = {name: one for name, one in node.nodes.items() if name != "file"}
        nodes |= {name: numbers_of(file.position, values) for name, values in found.items()}
        return Mapping(node.position, nodes, {name: node.keys.get(name, file.position) for name in nodes})

    return rewritten(node, change, (key,)) if key in ("medium", "bed") else node


def _read(folder: Path, faults: list[Fault], named: Scalar, key: str) -> dict[str, list[float]] | None:
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
