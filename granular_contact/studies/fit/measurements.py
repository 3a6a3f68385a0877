"""Cells of a CSV file -> measured columns as numbers, or every fault of them at its line.

The name of a measured column is a quantity with its unit at the end. Of a run these are columns of its time series, of
a force test what was prescribed and what was measured. Each step refuses its own faults; `gathered` collects those of
all.
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
    if found := list(faults):
        raise ConfigError(found)


@contextmanager
def gathered(faults: list[Fault]) -> Iterator[None]:
    """Add to `faults` those with which the block is left; what follows the block goes on."""
    try:
        yield
    except ConfigError as error:
        faults += error.faults


TIME = "time_s"
# Unit of a column of ours -> units that a measured one may have, and how many of ours one of them is.
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
BY_NAME = ("N", "Nm")  # what is compared where the fit says which column it is: every run's own table has forces
# What the other columns of a run hold, by the end of their names.
KINDS = {"_rad_s": "a rate", "_m_s": "a speed", "_Nm": "a moment", "_N": "a force", "_J": "an energy", "_W": "a power"}

# Columns of a force test.
GIVEN = DEPTH, SPEED, RATE, PATH = "depth_m", "speed_m_s", "rate_rad_s", "path_length_m"
FORCE, VERTICAL, HORIZONTAL = "force_N", "vertical_force_N", "horizontal_force_N"
TORQUE, PRESSURE = "torque_Nm", "pressure_Pa"
SIGNS = {
    FORCE: "against the motion",
    VERTICAL: "upward, on the body",
    HORIZONTAL: "to the right, on the body",
    TORQUE: "against the turning, or clockwise on a body that does not turn",
    PRESSURE: "the force against the motion over area_m2",
}
OF_FORCE_TESTS = (*GIVEN, *SIGNS)

# A header as tables have them, with its unit in brackets; signs that units are written with and names here are not.
_IN_BRACKETS = re.compile(r"\s*([^()\[\]]*[^()\[\]\s])\s*[(\[]\s*([^()\[\]]*[^()\[\]\s])\s*[)\]]\s*")
_MARKS = str.maketrans({"/": "_", " ": None, ".": None, "*": None, "\u00b7": None, "\u00b0": "deg", "\u00b5": "u"})


def plain(header: str) -> str:
    """A header with its unit in brackets, as `Depth (mm)` or `Speed [m/s]`, as a name: `depth_mm`, `speed_m_s`."""
    parts = _IN_BRACKETS.fullmatch(header)
    if parts is None:
        return header
    return f"{'_'.join(parts[1].lower().split())}_{parts[2].translate(_MARKS)}"


def observables(columns: Iterable[str]) -> list[str]:
    """The columns of a run that can be measured: its angles and lengths."""
    return [name for name in columns if name.rpartition("_")[2] in OBSERVED]


def forces(columns: Iterable[str]) -> list[str]:
    """The columns of a run that are forces or moments, as of drives and bodies in the medium."""
    return [name for name in columns if name.rpartition("_")[2] in BY_NAME]


def kind(column: str) -> str:
    """What a column of a run holds that is neither an angle nor a length, as `a force`."""
    return next((words for end, words in KINDS.items() if column.endswith(end)), "neither an angle nor a length")


def _unit(column: str) -> str:
    """The unit at the end of a column of ours: m_s of speed_m_s."""
    return max((unit for unit in UNITS if column.endswith(f"_{unit}")), key=len)


def spellings(known: Iterable[str]) -> dict[str, tuple[str, float]]:
    """Every name by which the `known` columns may be measured: which of them it is, and the factor to its unit."""
    return {
        f"{column.removesuffix(base)}{unit}": (column, factor)
        for column in known
        for base in [_unit(column)]
        for unit, factor in UNITS[base].items()
    }


def recognise(name: str, known: Iterable[str]) -> tuple[str, float] | None:
    """Which of the `known` columns the measured `name` is, and the factor to its unit; None if it is none of them."""
    return spellings(known).get(plain(name))


def in_words(known: Iterable[str]) -> str:
    """The known columns with the units that each may have, as `tip_x_m (cm, mm, um)`."""
    units = ((column, _unit(column)) for column in known)
    return ", ".join(f"{column} ({', '.join(one for one in UNITS[own] if one != own)})" for column, own in units)


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
    table: Table, known: Sequence[str], mapping: Mapping[str, tuple[str, Position]], others: Sequence[str] = ()
) -> Measured:
    """The columns that a fit uses, as numbers.

    known: columns of the run that can be fitted; others: those that can't. mapping: measured name with unit -> header
    in the file and where that was said; empty: the headers are such names themselves.

    Raises
    ------
    ConfigError
        The table lacks what is needed, or a cell is no number.
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
    """Columns by their own names. What a run of ours has besides is left out; any other name is a fault."""
    found = {name: hit for name in table.header if (hit := recognise(name, [TIME, *known])) is not None}
    # A run of ours has forces and energies, which no camera sees, and may have been more than this one, as a link that
    # bends.
    own = [name for name in table.header if name.endswith(tuple(KINDS))]
    own += OF_FLEXIBLE_LINKS if own else ()
    hint = "(or say which to take, also forces: --columns time_s=NAME,..., columns: {time_s: NAME, ...} in a fit file)"
    if all(column != TIME for column, _ in found.values()):
        hint += "; a force test needs no times, but force_N, torque_Nm or pressure_Pa"
    refuse(
        Fault(table.file, table.header_line, name, f"unknown column; {_nearest(name, (*known, TIME))} {hint}")
        for name in table.header
        if name not in found and name not in own
    )
    return found


def mapped_columns(
    table: Table,
    mapping: Mapping[str, tuple[str, Position]],
    known: Sequence[str],
    why_not: Callable[[str], str],
) -> Chosen:
    """Columns of a table by their headers, as `columns` of a fit file names them; raises ConfigError.

    known: columns that can be fitted; why_not: the words for a name that means none of them.
    """
    found: Chosen = {}
    faults = []
    for name, (header, at) in mapping.items():
        hit, words = recognise(name, known), ""
        if hit is None:
            words = why_not(name)
        elif header not in table.header:
            words = f"got {header!r}, but {table.file} has no such column; {unknown(header, table.header)}"
        elif header in found:
            words = f"got {header!r}, which is {found[header][0]} already; each needs a column of its own"
        else:
            found[header] = hit
        if words:
            faults.append(at.fault(("columns", name), words))
    refuse(faults)
    return found


def _why_not(name: str, known: Sequence[str], others: Sequence[str]) -> str:
    """Why a column can't be fitted: the run has none of the name, or only `others`, which a fit does not compare."""
    near, nearest = get_close_matches(name, others, 1, cutoff=0.8), _nearest(name, (*known, TIME))
    if not near:
        return f"the run has no such column; {nearest}"
    what = f"is {kind(near[0])}, and only angles, lengths, forces and moments can be fitted; {nearest}"
    return what if near[0] == name else f"the run has no such column; the nearest, {near[0]}, {what}"


def _nearest(name: str, known: Sequence[str]) -> str:
    names = list(spellings(known))
    folded = {one.casefold(): one for one in names}
    hint = unknown(folded.get(name.casefold(), name), names)
    return hint if hint.startswith("did") else f"allowed are {in_words(known)}"


def _incomplete(file: str, line: int | None, chosen: Chosen, known: Sequence[str]) -> Iterator[Fault]:
    """Faults of what is missing among the columns, or there twice."""
    columns = [column for column, _ in chosen.values()]
    if TIME not in columns:
        yield Fault(file, line, "", f"has no column of times; allowed is one of {', '.join(spellings([TIME]))}")
    if set(columns) <= {TIME}:
        words = f"has nothing to compare a run with: only angles and lengths can be; allowed are {in_words(known)}"
        yield Fault(file, line, "", words)
    yield from twice(columns, file, line)


def twice(columns: Sequence[str], file: str, line: int | None) -> Iterator[Fault]:
    """Faults of what several columns measure."""
    for column in sorted({column for column in columns if columns.count(column) > 1}):
        yield Fault(file, line, column, "is measured by two columns; choose one of them by name")


def numbers_of(table: Table, chosen: Chosen, fewest: int) -> dict[str, Vector]:
    """Chosen columns (n,) by name, in its unit; raises ConfigError for cells that are no numbers, or too few rows."""
    faults, found = [], {}
    for header, (column, factor) in chosen.items():
        cells = [row[table.header.index(header)] for row in table.rows]
        numbers = [number(cell) for cell in cells]
        triples = zip(table.lines, cells, numbers, strict=True)
        odd = [Fault(table.file, i, header, _odd(cell)) for i, cell, x in triples if x is None]
        faults += first_faults(table.file, odd)
        found[column] = factor * np.array(numbers, float)
    if len(table.rows) < fewest:
        words = f"got {len(table.rows)} rows; allowed are {fewest} or more"
        faults.append(Fault(table.file, table.header_line, "", words))
    refuse(faults)
    return found


def _odd(cell: str) -> str:
    if not cell:
        return "is empty; leave the row out, or fill it"
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
