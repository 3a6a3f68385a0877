"""Read measured columns from the cells of a CSV file as numbers, with every fault at its line.

The name of a measured column is a quantity with its unit at the end. For a run it is a column of the time series, for a
force test a prescribed or measured quantity. Each step raises its own faults; `gathered` collects the faults of several
steps.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import partial

import numpy as np

from granular_contact.config.csv_table import Table, first_faults, form_faults, number
from granular_contact.config.messages import unknown
from granular_contact.config.tree import Position
from granular_contact.errors import ConfigError, Fault
from granular_contact.values.arrays import Vector


def refuse(faults: Iterable[Fault]) -> None:
    """Raise ConfigError with these faults, if there are any."""
    if listed := list(faults):
        raise ConfigError(listed)


@contextmanager
def gathered(faults: list[Fault]) -> Iterator[None]:
    """Catch a ConfigError of the block and add its faults to `faults`; the code after the block continues."""
    try:
        yield
    except ConfigError as error:
        faults += error.faults


TIME = "time_s"
# Unit of a column of the time series -> allowed units of a measured column, with the factor to the unit of the column.
UNITS = {
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "deg": {"deg": 1.0, "rad": math.degrees(1.0)},
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6},
    "m_s": {"m_s": 1.0, "cm_s": 1e-2, "mm_s": 1e-3},
    "rad_s": {"rad_s": 1.0, "deg_s": math.radians(1.0), "rpm": 2.0 * math.pi / 60.0},
    "N": {"N": 1.0, "kN": 1e3, "mN": 1e-3},
    "Nm": {"Nm": 1.0, "Nmm": 1e-3, "mNm": 1e-3, "kNm": 1e3},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6},
}
OBSERVED = ("deg", "m")
# Forces are compared only if the fit names the column, because every table written by a run contains forces.
BY_NAME = ("N", "Nm")
# Quantities of the other columns of a run, by the end of their names.
KINDS = {"_rad_s": "a rate", "_m_s": "a speed", "_Nm": "a moment", "_N": "a force", "_J": "an energy", "_W": "a power"}

# Columns of a force test.
PRESCRIBED = DEPTH, SPEED, RATE, PATH = "depth_m", "speed_m_s", "rate_rad_s", "path_length_m"
FORCE, VERTICAL, HORIZONTAL = "force_N", "vertical_force_N", "horizontal_force_N"
TORQUE, PRESSURE = "torque_Nm", "pressure_Pa"
SIGNS = {
    FORCE: "against the motion",
    VERTICAL: "upward, on the body",
    HORIZONTAL: "to the right, on the body",
    TORQUE: "against the turning, or clockwise on a body that does not turn",
    PRESSURE: "the force against the motion over area_m2",
}
FORCE_TEST_COLUMNS = (*PRESCRIBED, *SIGNS)

# A header with its unit in brackets, and replacements for characters of units that names of columns do not have.
_IN_BRACKETS = re.compile(r"\s*([^()\[\]]*[^()\[\]\s])\s*[(\[]\s*([^()\[\]]*[^()\[\]\s])\s*[)\]]\s*")
_MARKS = str.maketrans({"/": "_", " ": None, ".": None, "*": None, "\u00b7": None, "\u00b0": "deg", "\u00b5": "u"})


def plain(header: str) -> str:
    """Convert a header with a unit in brackets to a name: `Depth (mm)` to `depth_mm`, `Speed [m/s]` to `speed_m_s`."""
    parts = _IN_BRACKETS.fullmatch(header)
    if parts is None:
        return header
    return f"{'_'.join(parts[1].lower().split())}_{parts[2].translate(_MARKS)}"


def observables(columns: Iterable[str]) -> list[str]:
    """Columns of a run that can be measured: angles and lengths."""
    return [name for name in columns if name.rpartition("_")[2] in OBSERVED]


def forces(columns: Iterable[str]) -> list[str]:
    """Columns of a run that are forces or moments: of drives, and of the medium on bodies."""
    return [name for name in columns if name.rpartition("_")[2] in BY_NAME]


def kind(column: str) -> str:
    """Quantity of a column of a run that is neither an angle nor a length, as `a force`."""
    return next((quantity for end, quantity in KINDS.items() if column.endswith(end)), "neither an angle nor a length")


def _unit(column: str) -> str:
    """Unit at the end of the name of a column: m_s of speed_m_s."""
    return max((unit for unit in UNITS if column.endswith(f"_{unit}")), key=len)


def spellings(known: Iterable[str]) -> dict[str, tuple[str, float]]:
    """For every allowed name of a measured column: the known column that it means, and the factor to its unit."""
    return {
        f"{column.removesuffix(base)}{unit}": (column, factor)
        for column in known
        for base in [_unit(column)]
        for unit, factor in UNITS[base].items()
    }


def recognise(name: str, known: Iterable[str]) -> tuple[str, float] | None:
    """Find the known column that the measured name means, with the factor to its unit; None if there is none."""
    return spellings(known).get(plain(name))


def with_units(known: Iterable[str]) -> str:
    """List the known columns with the other allowed units, as `tip_x_m (cm, mm, um)`."""
    pairs = ((column, _unit(column)) for column in known)
    return ", ".join(
        f"{column} ({', '.join(other for other in UNITS[unit] if other != unit)})" for column, unit in pairs
    )


FEWEST_ROWS = 6
LARGEST_ANGLE = 400.0  # deg
OF_FLEXIBLE_LINKS = ("deflection_m",)  # columns of runs with flexible links alone


@dataclass(frozen=True)
class Measured:
    """Measured data of one run or force test.

    time: (n,) s, increasing, by the clock of the measurement; in a force test the number of the row. values:
    (n, columns), in the units of the names of the columns; lines: line of each row in the file; unused: other columns
    of the file. prescribed: prescribed quantities of a force test, (n,) by column. notes: sentences about rows that
    were left out.
    """

    file: str
    time: Vector
    columns: tuple[str, ...]
    values: Vector
    lines: tuple[int, ...] = ()
    unused: tuple[str, ...] = ()
    prescribed: Mapping[str, Vector] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def select(
    table: Table, known: Sequence[str], mapping: Mapping[str, tuple[str, Position]], others: Sequence[str] = ()
) -> Measured:
    """Select the columns that a fit uses, as numbers.

    known: columns of the run that can be fitted; others: columns that can't. mapping: measured name with unit -> header
    in the file and position of the request; empty if the headers are such names themselves.

    Raises
    ------
    ConfigError
        The table lacks a column, or a cell is not a number.
    """
    refuse(form_faults(table))
    if mapping:
        known, at = [*known, *forces(others)], next(iter(mapping.values()))[1]
        why_not = partial(_why_not, known=known, others=others)
        chosen = mapped_columns(table, mapping, [TIME, *known], why_not)
        refuse(_incomplete(at.file, at.line, chosen, known))
    else:
        chosen = _named(table, known)
        refuse(_incomplete(table.file, table.header_line, chosen, known))
    values = numbers_of(table, chosen, FEWEST_ROWS)
    headers = {column: header for header, (column, _) in chosen.items()}
    faults = first_faults(table.file, _clock(table, headers[TIME], values[TIME]))
    for column, angles in values.items():
        faults += _angles(table, headers[column], angles) if column.endswith("_deg") else []
    refuse(faults)
    names = tuple(column for column in values if column != TIME)
    matrix = np.column_stack([values[name] for name in names])
    unused = tuple(name for name in table.header if name not in chosen)
    return Measured(table.file, values[TIME], names, matrix, table.lines, unused)


Chosen = dict[str, tuple[str, float]]  # header -> column of the time series, factor to its unit


def _named(table: Table, known: Sequence[str]) -> Chosen:
    """Choose columns by their headers. Further columns of a table written by a run are skipped; others are faults."""
    chosen = {name: hit for name in table.header if (hit := recognise(name, [TIME, *known])) is not None}
    # A table written by a run has forces and energies too, and a deflection if the other model had a flexible link.
    skipped = [name for name in table.header if name.endswith(tuple(KINDS))]
    skipped += OF_FLEXIBLE_LINKS if skipped else ()
    hint = "(or choose columns, forces too: --columns time_s=NAME,..., columns: {time_s: NAME, ...} in a fit file)"
    if all(column != TIME for column, _ in chosen.values()):
        hint += "; a force test needs no times, but force_N, torque_Nm or pressure_Pa"
        if any("slip" in name.casefold() for name in table.header):
            hint += "; of a wheel, each slip is a run with a table of its own, over time"
    refuse(
        Fault(table.file, table.header_line, name, f"unknown column; {_nearest(name, (*known, TIME))} {hint}")
        for name in table.header
        if name not in chosen and name not in skipped
    )
    return chosen


def mapped_columns(
    table: Table,
    mapping: Mapping[str, tuple[str, Position]],
    known: Sequence[str],
    why_not: Callable[[str], str],
) -> Chosen:
    """Choose the columns that `columns` of a fit file names; raises ConfigError.

    known: columns that can be fitted; why_not: function from a name that means none of them to the message.
    """
    chosen: Chosen = {}
    faults = []
    for name, (header, at) in mapping.items():
        hit, fault = recognise(name, known), ""
        if hit is None:
            fault = why_not(name)
        elif header not in table.header:
            fault = f"got {header!r}, but {table.file} has no such column; {unknown(header, table.header)}"
        elif header in chosen:
            fault = f"got {header!r}, which is already used for {chosen[header][0]}; each name needs its own column"
        else:
            chosen[header] = hit
        if fault:
            faults.append(at.fault(("columns", name), fault))
    refuse(faults)
    return chosen


def _why_not(name: str, known: Sequence[str], others: Sequence[str]) -> str:
    """Reason why a column cannot be fitted: it does not exist, or is one of `others`, which are not compared."""
    near, nearest = get_close_matches(name, others, 1, cutoff=0.8), _nearest(name, (*known, TIME))
    if not near:
        return f"the run has no such column; {nearest}"
    reason = f"is {kind(near[0])}, and only angles, lengths, forces and moments can be fitted; {nearest}"
    return reason if near[0] == name else f"the run has no such column; the nearest, {near[0]}, {reason}"


def _nearest(name: str, known: Sequence[str]) -> str:
    names = list(spellings(known))
    folded = {spelling.casefold(): spelling for spelling in names}
    hint = unknown(folded.get(name.casefold(), name), names)
    return hint if hint.startswith("did") else f"allowed are {with_units(known)}"


def _incomplete(file: str, line: int | None, chosen: Chosen, known: Sequence[str]) -> Iterator[Fault]:
    """Faults of missing and duplicate columns."""
    columns = [column for column, _ in chosen.values()]
    if TIME not in columns:
        yield Fault(file, line, "", f"has no column of times; allowed is one of {', '.join(spellings([TIME]))}")
    if set(columns) <= {TIME}:
        fault = f"has no column to compare with the run; angles and lengths can be compared: {with_units(known)}"
        yield Fault(file, line, "", fault)
    yield from duplicates(columns, file, line)


def duplicates(columns: Sequence[str], file: str, line: int | None) -> Iterator[Fault]:
    """Faults of quantities that two columns measure."""
    for column in sorted({column for column in columns if columns.count(column) > 1}):
        yield Fault(file, line, column, "is measured by two columns; choose one of them by name")


def numbers_of(table: Table, chosen: Chosen, fewest: int) -> dict[str, Vector]:
    """Chosen columns (n,) by name, in the unit of the name.

    Raises ConfigError if a cell is not a number, or if there are too few rows.
    """
    faults, columns = [], {}
    for header, (column, factor) in chosen.items():
        cells = [row[table.header.index(header)] for row in table.rows]
        numbers = [number(cell) for cell in cells]
        triples = zip(table.lines, cells, numbers, strict=True)
        faults += first_faults(
            table.file, [Fault(table.file, line, header, _no_number(cell)) for line, cell, x in triples if x is None]
        )
        columns[column] = factor * np.array(numbers, float)
    if len(table.rows) < fewest:
        fault = f"got {len(table.rows)} rows; allowed are {fewest} or more"
        faults.append(Fault(table.file, table.header_line, "", fault))
    refuse(faults)
    return columns


def _no_number(cell: str) -> str:
    if not cell:
        return "is empty; fill the cell, or leave the row out"
    comma = "; write decimals with a point" if "," in cell else ""
    return f"got {cell[:40]!r}; allowed is a finite number{comma}"


def _clock(table: Table, header: str, time: Vector) -> list[Fault]:
    """Faults of times (n,) s that do not increase."""
    faults = []
    for i in np.flatnonzero(np.diff(time) <= 0.0) + 1:
        cell, last = (table.rows[k][table.header.index(header)] for k in (i, i - 1))
        line = table.lines[i - 1]
        problem = f"is also the time of line {line}" if time[i] == time[i - 1] else f"comes after {last}"
        faults.append(Fault(table.file, table.lines[i], header, f"got {cell}, which {problem}; times must increase"))
    return faults


def _angles(table: Table, header: str, angles: Vector) -> list[Fault]:
    """Fault of the first angle (n,) deg that is too large to be an angle."""
    too_large = np.flatnonzero(np.abs(angles) > LARGEST_ANGLE)
    if len(too_large) == 0:
        return []
    i = too_large[0]
    message = (
        f"got {table.rows[i][table.header.index(header)]}, which is {angles[i]:.4g} deg; at most {LARGEST_ANGLE:g} deg "
        "are allowed: is it in another unit than its name says?"
    )
    return [Fault(table.file, table.lines[i], header, message)]
