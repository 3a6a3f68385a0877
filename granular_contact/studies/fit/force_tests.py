"""Cells of a CSV file of forces against depth or speed -> Measured, or every fault of them at its line.

Checks of force tests by the law itself: units, signs, depths, forces that are no more than noise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from granular_contact.config.csv_table import Table, first_faults, form_faults, number
from granular_contact.config.messages import unknown
from granular_contact.config.schema.fit import DIRECTIONS, ForceTest
from granular_contact.config.tree import Position
from granular_contact.errors import Fault
from granular_contact.studies.fit import diagnostics, measurements
from granular_contact.studies.fit.measurements import (
    DEPTH,
    OF_FORCE_TESTS,
    PRESSURE,
    SIGNS,
    TIME,
    Chosen,
    Measured,
    in_words,
    mapped_columns,
    numbers_of,
    recognise,
    refuse,
    twice,
)
from granular_contact.values.arrays import Vector

FEWEST_ROWS = 4
SAME = 1e-9  # relative difference of numbers that choose rows
TURNING_BACK = 0.02  # share of the range of depths: less is noise of the depth


def angle_of(test: ForceTest) -> float:
    """Direction of the motion below the horizontal (deg)."""
    return DIRECTIONS[test.direction] if isinstance(test.direction, str) else test.direction


def meant(table: Table, mapping: Mapping[str, tuple[str, Position]]) -> bool:
    """Whether a table is one of a force test by its columns: it has forces, and no times."""
    hits = [recognise(name, [TIME, *SIGNS]) for name in mapping or table.header]
    means = {hit[0] for hit in hits if hit is not None}
    return bool(means) and TIME not in means


def rows_of(table: Table, rows: Mapping[str, tuple[float, Position]]) -> Table:
    """The rows that have these numbers in these columns; raises ConfigError where there are none."""
    kept = list(zip(table.rows, table.lines, strict=True))
    for header, (value, at) in rows.items():
        if header not in table.header:
            words = f"{table.file} has no such column; {unknown(header, table.header)}"
            refuse([at.fault(("rows", header), words)])
        i = table.header.index(header)
        cells = [(number(row[i]) if i < len(row) else None) for row, _ in kept]
        chosen = [k for k, held in enumerate(cells) if held is not None and abs(held - value) <= SAME * abs(value)]
        if not chosen:
            there = sorted({held for held in cells if held is not None})[:6]
            words = f"got {value:g}, but no row of {table.file} has it; there are {', '.join(f'{x:g}' for x in there)}"
            refuse([at.fault(("rows", header), words)])
        kept = [kept[k] for k in chosen]
    return replace(table, rows=tuple(row for row, _ in kept), lines=tuple(line for _, line in kept))


def select(table: Table, test: ForceTest, mapping: Mapping[str, tuple[str, Position]]) -> Measured:
    """What was prescribed and measured, as numbers; raises ConfigError where the table does not have it."""
    refuse(form_faults(table))
    if mapping:
        words = f"is no column of a force test; allowed are {in_words(OF_FORCE_TESTS)}"
        chosen = mapped_columns(table, mapping, OF_FORCE_TESTS, lambda _: words)
    else:
        chosen = _named(table)
    refuse(_incomplete(table, chosen, test))
    values = numbers_of(table, chosen, FEWEST_ROWS)
    if DEPTH in values:
        refuse(_upward(table, values[DEPTH], test))
    back = _unloading(values[DEPTH], test) if DEPTH in values else np.zeros(len(table.rows), bool)
    if test.unloading == "refuse" and np.any(back):
        refuse(first_faults(table.file, [_refused(table, values[DEPTH], span) for span in _spans(back)]))
    return _measured(table, test, values, ~back, [name for name in table.header if name not in chosen])


def _measured(
    table: Table, test: ForceTest, values: dict[str, Vector], kept: NDArray[np.bool_], unused: list[str]
) -> Measured:
    names = tuple(column for column in values if column in SIGNS)
    count = int(kept.sum())
    constants = {DEPTH: test.depth_m, measurements.SPEED: test.speed_m_s, measurements.RATE: test.rate_rad_s}
    given = {name: np.full(count, value) for name, value in constants.items() if value is not None}
    given |= {name: column[kept] for name, column in values.items() if name not in names}
    notes = [
        f"{table.file}: lines {table.lines[a]} to {table.lines[b]}, in which the body goes back, are left out"
        for a, b in _spans(~kept)
    ]
    return Measured(
        table.file,
        np.arange(count, dtype=float),
        names,
        np.column_stack([values[name][kept] for name in names]),
        tuple(np.array(table.lines)[kept].tolist()),
        tuple(unused),
        given,
        tuple(notes),
    )


# ---- columns ----


def _named(table: Table) -> Chosen:
    """Columns by their own names; others are left out, unless they look like a misspelt one."""
    found = {name: hit for name in table.header if (hit := recognise(name, OF_FORCE_TESTS)) is not None}
    known = list(measurements.spellings(OF_FORCE_TESTS))
    near = {name: get_close_matches(name, known, 1, cutoff=0.85) for name in table.header if name not in found}
    refuse(
        Fault(table.file, table.header_line, name, f"unknown column; did you mean {one[0]}?")
        for name, one in near.items()
        if one
    )
    return found


def _incomplete(table: Table, chosen: Chosen, test: ForceTest) -> Iterator[Fault]:
    """Faults of what is missing, or there twice."""
    names, line = [column for column, _ in chosen.values()], table.header_line
    if not SIGNS.keys() & set(names):
        words = f"has no force, torque or pressure; allowed are {in_words(SIGNS)}"
        yield Fault(table.file, line, "", words)
    if DEPTH not in names and test.depth_m is None:
        words = f"has no column of depths; allowed is {in_words([DEPTH])}, or force_test: {{depth_m: ...}}"
        yield Fault(table.file, line, "", words)
    if PRESSURE in names and test.area_m2 is None:
        words = "is a pressure, of an area that is not said: force_test: {area_m2: ...}"
        yield Fault(table.file, line, PRESSURE, words)
    yield from twice(names, table.file, line)


# ---- depths that are heights, rows in which the body goes back ----


def _upward(table: Table, depth: Vector, test: ForceTest) -> Iterator[Fault]:
    """A fault of depths (n,) m that are counted upward: farther above the surface than ever below it.

    Depths that change in the sense of the motion are those of a body that comes from above, or goes out.
    """
    zero = test.depth_offset_m if isinstance(test.depth_offset_m, float) else 0.0
    first, last = sorted((int(np.argmin(depth)), int(np.argmax(depth))))
    along = (depth[last] - depth[first]) * np.sin(np.radians(angle_of(test))) > 0.0
    if not along and np.max(zero - depth) > max(np.max(depth - zero), 0.0):
        i = int(np.argmin(depth))
        words = f"got {1e3 * depth[i]:.4g} mm; depths count downward from the surface: turn the sign of the column"
        yield Fault(table.file, table.lines[i], DEPTH, words)


def _unloading(depth: Vector, test: ForceTest) -> NDArray[np.bool_]:
    """Rows (n,) in which the body moves against its direction: between a greatest depth and the next least one.

    A step back in a single row is another trial that begins, and steps below TURNING_BACK of the range are noise.
    """
    downward = np.sin(np.radians(angle_of(test)))
    back = np.zeros(len(depth), bool)
    if abs(downward) < 0.5:
        return back
    travel = depth * np.sign(downward)
    least = TURNING_BACK * float(np.ptp(travel))
    for a, b in _falls(travel, least):
        last = b == len(travel) - 1 and b > a + 1  # else it goes in again from there
        back[a + 1 : b + last] = True
    return back


def _falls(travel: Vector, least: float) -> list[tuple[int, int]]:
    """From each greatest to the next least value (indices), where it falls by more than `least`."""
    found: list[tuple[int, int]] = []
    top = bottom = 0
    falling = False
    for i in range(1, len(travel)):
        if not falling:
            top = i if travel[i] >= travel[top] else top
            if travel[top] - travel[i] > least:
                falling, bottom = True, i
        elif travel[i] <= travel[bottom]:
            bottom = i
        elif travel[i] - travel[bottom] > least:
            found.append((top, bottom))
            falling, top = False, i
    return [*found, (top, bottom)] if falling else found


def _spans(marked: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last index of each run of marked rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], marked.astype(int), [0]])))
    return [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]


def _refused(table: Table, depth: Vector, span: tuple[int, int]) -> Fault:
    a, b = span
    words = (
        f"to line {table.lines[b]} the depth goes back from {1e3 * depth[max(a - 1, 0)]:.4g} to {1e3 * depth[b]:.4g} "
        "mm: on the way back the medium does not resist as on the way in; leave these rows out, or say "
        "force_test: {unloading: leave_out}"
    )
    return Fault(table.file, table.lines[a], DEPTH, words)


DEEPEST = 100.0  # sizes of the body: no depth of a test
LEAST_FORCE = 4.0  # times the standard error that noise gives to the size of the force: smaller ones say nothing
UNLIKE = 100.0  # factor between tests of one law by which their forces differ at most, in units of the model


def of_test(held: Measured, model: Vector, size: float, least: float) -> Iterator[Fault]:
    """Faults of one test.

    model: (n, columns) of the law at the start values; size (m) of the body; least (m): depth in the table where it
    touches the surface, or the least that this may be.
    """
    depth = held.given[measurements.DEPTH]
    yield from first_faults(held.file, list(_above(held, depth, least)))
    deepest = int(np.argmax(depth))
    if depth[deepest] > DEEPEST * size:
        words = (
            f"got {depth[deepest]:.4g} m, but the body is {size:.3g} m wide: is the depth in another unit than its "
            "name says?"
        )
        yield Fault(held.file, held.lines[deepest], measurements.DEPTH, words)
        return
    for k, name in enumerate(held.columns):
        yield from _of_column(held, name, held.values[:, k], model[:, k])


def _above(held: Measured, depth: Vector, least: float) -> Iterator[Fault]:
    for i in np.flatnonzero(depth < least):
        words = (
            f"got {1e3 * depth[i]:.4g} mm, which is above the surface; leave the row out, or say where the touch is: "
            "force_test: {depth_offset_m: fit}, or a number"
        )
        yield Fault(held.file, held.lines[int(i)], measurements.DEPTH, words)


def _of_column(held: Measured, name: str, data: Vector, model: Vector) -> Iterator[Fault]:
    scatter, size = diagnostics.roughness(data), float(np.linalg.norm(model))
    if size == 0.0:
        return
    share = float(data @ model) / size  # of the data along the law, in units of the data
    if not np.any(data) or (scatter is not None and abs(share) < LEAST_FORCE * scatter):
        words = f"is noise alone: it scatters by {scatter or 0.0:.3g} from row to row, and has no more of a force"
        yield Fault(held.file, held.lines[0], name, words)
    elif share < 0.0:
        odd = int(np.argmax(np.abs(data) * (data * model < 0.0)))
        words = (
            f"got {data[odd]:.4g}, but the law gives {model[odd]:+.3g}: {name} is positive "
            f"{measurements.SIGNS[name]}; turn its sign in the table, or check force_test: {{direction: ...}}"
        )
        yield Fault(held.file, held.lines[odd], name, words)


def between_tests(held: Sequence[Measured], models: Sequence[Vector]) -> Iterator[Fault]:
    """Faults of tests whose forces are, against the law, hundreds of times those of the others."""
    found: dict[str, list[tuple[float, Measured]]] = {}
    for one, model in zip(held, models, strict=True):
        for k, name in enumerate(one.columns):
            size = float(model[:, k] @ model[:, k])
            ratio = float(one.values[:, k] @ model[:, k]) / size if size > 0.0 else 0.0
            if ratio > 0.0:
                found.setdefault(name, []).append((ratio, one))
    for name, tests in found.items():
        middle = float(np.exp(np.median(np.log([ratio for ratio, _ in tests]))))
        (low, first), (high, last) = (choose(tests, key=lambda one: one[0]) for choose in (min, max))
        if high / low <= UNLIKE:
            continue
        far, other = (last, first) if high / middle >= middle / low else (first, last)
        words = (
            f"measured against the law its forces differ by a factor {high / low:.3g} from those of {other.file}: is "
            f"one of them in another unit than its name says?"
        )
        yield Fault(far.file, far.lines[0], name, words)
