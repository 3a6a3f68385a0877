"""Cells of a CSV file -> measured columns as numbers, or every fault of them at its line."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from granular_contact.config.csv_table import Table, few, form_faults, number
from granular_contact.config.messages import unknown
from granular_contact.config.tree import Position
from granular_contact.errors import Fault
from granular_contact.studies.fit.columns import KINDS, TIME, forces, in_words, kind, recognise, spellings

Vector = NDArray[np.float64]

FEWEST_ROWS = 6
LARGEST_ANGLE = 400.0  # deg
OF_FLEXIBLE_LINKS = ("deflection_m",)  # columns that a run has if its mechanism bends


@dataclass(frozen=True)
class Measured:
    """Rows of one run on the clock of the measurement.

    time: (n,) s, growing; values: (n, columns), each in the unit of the column of the time series that it is named
    after; lines: of the rows in the file; unused: what else the file has. Of a force test time is the number of the
    row, and given has what was prescribed in each, (n,) by column. notes: sentences on rows that were left out.
    """

    file: str
    time: Vector
    columns: tuple[str, ...]
    values: Vector
    lines: tuple[int, ...] = ()
    unused: tuple[str, ...] = ()
    given: Mapping[str, Vector] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def select(
    table: Table,
    known: Sequence[str],
    mapping: Mapping[str, tuple[str, Position]],
    faults: list[Fault],
    others: Sequence[str] = (),
) -> Measured | None:
    """The columns that a fit uses, as numbers; None, with faults, where that is not possible.

    known: columns of the run that can be fitted; others: those that can't. mapping: measured name with unit -> header
    in the file and where that was said; empty: the headers are such names themselves.
    """
    if odd := form_faults(table):
        faults += odd
        return None
    chosen = (
        _mapped(table, [*known, *forces(others)], mapping, faults, others) if mapping else _named(table, known, faults)
    )
    if chosen is None:
        return None
    before = len(faults)
    values = numbers_of(table, chosen, FEWEST_ROWS, faults)
    if values is None:
        return None
    time_header = next(header for header, (column, _) in chosen.items() if column == TIME)
    faults += few(table.file, _clock(table, time_header, values[TIME]))
    for header, (column, _) in chosen.items():
        if column.endswith("_deg"):
            faults += _angles(table, header, values[column])
    if len(faults) > before:
        return None
    names = tuple(column for column in values if column != TIME)
    matrix = np.column_stack([values[name] for name in names])
    unused = tuple(name for name in table.header if name not in chosen)
    return Measured(table.file, values[TIME], names, matrix, table.lines, unused)


Chosen = dict[str, tuple[str, float]]  # header -> column of the time series, factor to its unit


def _named(table: Table, known: Sequence[str], faults: list[Fault]) -> Chosen | None:
    """Columns by their own names. What a run of ours has besides is left out; any other name is a fault."""
    found = {name: hit for name in table.header if (hit := recognise(name, [TIME, *known])) is not None}
    ours = (*known, TIME)
    # A run of ours has forces and energies, and may have been more than this one, as a link that bends.
    own_table = any(_is_of_a_run(name) for name in table.header)
    strange = [
        n for n in table.header if n not in found and not _is_of_a_run(n) and not (own_table and n in OF_FLEXIBLE_LINKS)
    ]
    hint = "(or say which to take: --columns time_s=NAME,..., columns: {time_s: NAME, ...} in a fit file)"
    if strange and all(column != TIME for column, _ in found.values()):
        hint += "; a force test needs no times, but force_N, torque_Nm or pressure_Pa"
    faults += [
        Fault(table.file, table.header_line, name, f"unknown column; {_nearest(name, ours)} {hint}") for name in strange
    ]
    return None if strange else _complete(table.file, table.header_line, found, known, faults)


def _is_of_a_run(name: str) -> bool:
    """Whether a run's own table has such columns, which no camera sees."""
    return name.endswith(tuple(KINDS))


def _mapped(
    table: Table,
    known: Sequence[str],
    mapping: Mapping[str, tuple[str, Position]],
    faults: list[Fault],
    others: Sequence[str],
) -> Chosen | None:
    before = len(faults)
    found = mapped_columns(
        table,
        mapping,
        [TIME, *known],
        lambda name: f"{_why_not(name, others)}; {_nearest(name, (*known, TIME))}",
        faults,
    )
    at = next(iter(mapping.values()))[1]
    return _complete(at.file, at.line, found, known, faults) if len(faults) == before else None


def mapped_columns(
    table: Table,
    mapping: Mapping[str, tuple[str, Position]],
    known: Sequence[str],
    why_not: Callable[[str], str],
    faults: list[Fault],
) -> Chosen:
    """Columns of a table by their headers, as `columns` of a fit file names them.

    known: columns that can be fitted; why_not: the words for a name that means none of them.
    """
    found: Chosen = {}
    for name, (header, at) in mapping.items():
        hit = recognise(name, known)
        if hit is None:
            faults.append(at.fault(("columns", name), why_not(name)))
        elif header not in table.header:
            message = f"got {header!r}, but {table.file} has no such column; {unknown(header, table.header)}"
            faults.append(at.fault(("columns", name), message))
        elif header in found:
            message = f"got {header!r}, which is {found[header][0]} already; each needs a column of its own"
            faults.append(at.fault(("columns", name), message))
        else:
            found[header] = hit
    return found


def _why_not(name: str, others: Sequence[str]) -> str:
    """Why a column can't be fitted: the run has none of the name, or only `others`, which a fit does not compare."""
    near = get_close_matches(name, others, 1, cutoff=0.8)
    if not near:
        return "the run has no such column"
    what = f"is {kind(near[0])}, and only angles, lengths, forces and moments can be fitted"
    return what if near[0] == name else f"the run has no such column; the nearest, {near[0]}, {what}"


def _nearest(name: str, known: Sequence[str]) -> str:
    names = list(spellings(known))
    folded = {one.casefold(): one for one in names}
    hint = unknown(folded.get(name.casefold(), name), names)
    return hint if hint.startswith("did") else f"allowed are {in_words(known)}"


def _complete(file: str, line: int | None, found: Chosen, known: Sequence[str], faults: list[Fault]) -> Chosen | None:
    columns = [column for column, _ in found.values()]
    before = len(faults)
    if TIME not in columns:
        faults.append(
            Fault(file, line, "", f"has no column of times; allowed is one of {', '.join(spellings([TIME]))}")
        )
    if set(columns) <= {TIME}:
        faults.append(
            Fault(
                file,
                line,
                "",
                f"has nothing to compare a run with: only angles and lengths can be; allowed are {in_words(known)}",
            )
        )
    faults += twice(columns, file, line)
    return found if len(faults) == before else None


def twice(columns: Sequence[str], file: str, line: int | None) -> Iterator[Fault]:
    """Faults of what several columns measure."""
    for column in sorted({column for column in columns if columns.count(column) > 1}):
        yield Fault(file, line, column, "is measured by two columns; choose one of them by name")


def numbers_of(table: Table, chosen: Chosen, fewest: int, faults: list[Fault]) -> dict[str, Vector] | None:
    """Chosen columns (n,) by name, in its unit; None, with faults, of cells that are no numbers or of too few rows."""
    before = len(faults)
    numbers = {header: _column_numbers(table, header, faults) for header in chosen}
    if len(table.rows) < fewest:
        words = f"got {len(table.rows)} rows; allowed are {fewest} or more"
        faults.append(Fault(table.file, table.header_line, "", words))
    if len(faults) > before:
        return None
    return {column: numbers[header] * factor for header, (column, factor) in chosen.items()}


def _column_numbers(table: Table, header: str, faults: list[Fault]) -> Vector:
    """Numbers (n,) of a column; faults of the cells that are none."""
    index = table.header.index(header)
    cells = [row[index] for row in table.rows]
    numbers = [number(cell) for cell in cells]
    faulty = [
        Fault(table.file, line, header, "is empty; leave the row out, or fill it" if not cell else _odd(cell))
        for line, cell, value in zip(table.lines, cells, numbers, strict=True)
        if value is None
    ]
    faults += few(table.file, faulty)
    return np.array([0.0 if value is None else value for value in numbers])


def _odd(cell: str) -> str:
    comma = "; write decimals with a point" if "," in cell else ""
    return f"got {cell[:40]!r}; allowed is a finite number{comma}"


def _clock(table: Table, header: str, time: Vector) -> list[Fault]:
    """Faults of times (n,) s that do not grow."""
    faults = []
    for i in np.flatnonzero(np.diff(time) <= 0.0) + 1:
        cell, last = (table.rows[k][table.header.index(header)] for k in (i, i - 1))
        problem = f"is that of line {table.lines[i - 1]} again" if time[i] == time[i - 1] else f"comes after {last}"
        faults.append(Fault(table.file, table.lines[i], header, f"got {cell}, which {problem}; times must grow"))
    return faults


def _angles(table: Table, header: str, angles: Vector) -> list[Fault]:
    """A fault of the first angle (n,) deg that is too large to be one."""
    over = np.flatnonzero(np.abs(angles) > LARGEST_ANGLE)
    if len(over) == 0:
        return []
    i = over[0]
    message = (
        f"got {table.rows[i][table.header.index(header)]}, which is {angles[i]:.4g} deg; at most {LARGEST_ANGLE:g} deg "
        "are allowed: is it in another unit than its name says?"
    )
    return [Fault(table.file, table.lines[i], header, message)]
