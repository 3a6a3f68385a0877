"""Cells of a CSV file as text, and faults of its form.

The first line that is not empty and does not begin with # or % is the header. Cells are separated by commas, semicolons
or tabs. Separators at the end of lines, as spreadsheets write them, do not count as cells.
"""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

from granular_contact.config.tree import Position
from granular_contact.errors import Fault

MOST_BYTES = 50_000_000
MOST_SHOWN = 10  # number of reported faults of one kind in one file


@dataclass(frozen=True)
class Table:
    """Cells of a CSV file as text. lines: line of each row in the file, from 1."""

    file: str
    header: tuple[str, ...]
    header_line: int
    rows: tuple[tuple[str, ...], ...]
    lines: tuple[int, ...]


def read_table(path: Path, faults: list[Fault]) -> Table | None:
    """The table in a CSV file; None, with faults, if the file can't be read or has no such form."""
    whole = Position(str(path), None)
    try:
        if path.is_dir():
            faults.append(whole.fault((), "is a folder; a CSV file is needed"))
            return None
        if path.stat().st_size > MOST_BYTES:
            faults.append(whole.fault((), f"is larger than {MOST_BYTES} bytes, the most that is read"))
            return None
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        faults.append(whole.fault((), "no such file"))
    except UnicodeDecodeError:
        faults.append(whole.fault((), "is not text in UTF-8; save it as UTF-8"))
    except OSError as error:
        faults.append(whole.fault((), f"can't be read: {error.strerror or error}"))
    else:
        return parse_table(text, str(path), faults)
    return None


def parse_table(text: str, file: str, faults: list[Fault]) -> Table | None:
    """The table in the text of a CSV file; None, with a fault, if it has no such form.

    The rows may have more or fewer cells than the header, see `ragged_rows`.
    """
    numbered = ((i, line) for i, line in enumerate(text.splitlines(), 1))
    lines = [(i, line) for i, line in numbered if line.strip() and not line.lstrip().startswith(("#", "%"))]
    if not lines:
        faults.append(Fault(file, 1, "", "is empty; a line with the names of the columns is needed"))
        return None
    separator = max(",;\t", key=lines[0][1].count)
    try:
        rows = list(csv.reader((line for _, line in lines), delimiter=separator))
    except csv.Error as error:
        faults.append(Fault(file, None, "", f"is not a CSV text: {error}"))
        return None
    cells = [tuple(cell.strip() for cell in row) for row in rows]
    if len(cells) != len(lines):
        faults.append(Fault(file, lines[0][0], "", "has a quoted text over several lines; numbers only are allowed"))
        return None
    header, *below = _without_empty_ends(cells)
    return Table(file, header, lines[0][0], tuple(below), tuple(line for line, _ in lines[1:]))


def form_faults(table: Table) -> list[Fault]:
    """Faults of the header and of the number of cells in each row."""
    file, header_line, header = table.file, table.header_line, table.header
    if all(number(cell) is not None for cell in header):
        message = "has numbers where the names of the columns should stand; put a line as time_s,tip_x_mm above them"
        return [Fault(file, header_line, "", message)]
    if len(header) == 1 and " " in header[0]:
        return [Fault(file, header_line, "", "has one column; a comma, a semicolon or a tab separates columns")]
    nameless = [i for i, name in enumerate(header, 1) if not name]
    duplicates = sorted({name for name in header if name and header.count(name) > 1})
    return [
        *(Fault(file, header_line, "", f"has no name for column {i}") for i in nameless),
        *(Fault(file, header_line, name, "is the name of two columns; each needs its own") for name in duplicates),
        *first_faults(file, ragged_rows(table)),
    ]


def ragged_rows(table: Table) -> list[Fault]:
    """A fault for each row that has more or fewer cells than the header."""
    width, reference = len(table.header), f"as in the header of line {table.header_line}"
    pairs = zip(table.lines, table.rows, strict=True)
    return [
        Fault(table.file, line, "", f"has {len(row)} cells; {width} are allowed, {reference}")
        for line, row in pairs
        if len(row) != width
    ]


def _without_empty_ends(cells: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """The rows without the columns at the end that are empty in all rows."""
    width = max((i for row in cells for i, cell in enumerate(row, 1) if cell), default=0)
    return [row[: max(width, 1)] for row in cells]


def number(cell: str) -> float | None:
    """The finite number in a cell; None for any other text."""
    try:
        value = float(cell) if "_" not in cell else math.nan
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def first_faults(file: str, faults: list[Fault]) -> list[Fault]:
    """The first MOST_SHOWN faults of one kind, and a last one that counts the others."""
    if len(faults) <= MOST_SHOWN:
        return faults
    more = f"has {len(faults) - MOST_SHOWN} more such lines from here on"
    return [*faults[:MOST_SHOWN], Fault(file, faults[MOST_SHOWN].line, "", more)]
