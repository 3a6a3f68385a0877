"""Read a table of forces against depth or speed as `Measured`, with every fault at its line.

The law itself checks force tests: units, signs, depths, forces that are no larger than noise.
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
    FORCE_TEST_COLUMNS,
    PRESSURE,
    SIGNS,
    TIME,
    Chosen,
    Measured,
    duplicates,
    mapped_columns,
    numbers_of,
    recognise,
    refuse,
    with_units,
)
from granular_contact.values.arrays import Vector

FEWEST_ROWS = 4
SAME = 1e-9  # relative tolerance of the numbers that select rows
TURNING_BACK = 0.02  # share of the range of depths; smaller steps back are noise of the depth


def direction_deg(test: ForceTest) -> float:
    """Direction of the motion below the horizontal (deg)."""
    return DIRECTIONS[test.direction] if isinstance(test.direction, str) else test.direction


def is_force_test(table: Table, mapping: Mapping[str, tuple[str, Position]]) -> bool:
    """Return whether a table is a force test by its columns: it has forces, and no times."""
    hits = [recognise(name, [TIME, *SIGNS]) for name in mapping or table.header]
    columns = {hit[0] for hit in hits if hit is not None}
    return bool(columns) and TIME not in columns


def select_rows(table: Table, rows: Mapping[str, tuple[float, Position]]) -> Table:
    """Select the rows with the given numbers in the given columns; raises ConfigError if there are none."""
    kept = list(zip(table.rows, table.lines, strict=True))
    for header, (value, at) in rows.items():
        if header not in table.header:
            fault = f"{table.file} has no such column; {unknown(header, table.header)}"
            refuse([at.fault(("rows", header), fault)])
        i = table.header.index(header)
        numbers = [(number(row[i]) if i < len(row) else None) for row, _ in kept]
        matching = [k for k, x in enumerate(numbers) if x is not None and abs(x - value) <= SAME * abs(value)]
        if not matching:
            present = ", ".join(f"{x:g}" for x in sorted({x for x in numbers if x is not None})[:6])
            fault = f"got {value:g}, but no row of {table.file} has this number; the column has {present}"
            refuse([at.fault(("rows", header), fault)])
        kept = [kept[k] for k in matching]
    return replace(table, rows=tuple(row for row, _ in kept), lines=tuple(line for _, line in kept))


def select(table: Table, test: ForceTest, mapping: Mapping[str, tuple[str, Position]]) -> Measured:
    """Select the prescribed and measured columns, as numbers; raises ConfigError if one is missing."""
    refuse(form_faults(table))
    if mapping:
        fault = f"is no column of a force test; allowed are {with_units(FORCE_TEST_COLUMNS)}"
        chosen = mapped_columns(table, mapping, FORCE_TEST_COLUMNS, lambda _: fault)
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
    prescribed = {name: np.full(count, value) for name, value in constants.items() if value is not None}
    prescribed |= {name: column[kept] for name, column in values.items() if name not in names}
    notes = [
        f"{table.file}: lines {table.lines[a]} to {table.lines[b]} are left out, because the body moves back in them"
        for a, b in _spans(~kept)
    ]
    return Measured(
        table.file,
        np.arange(count, dtype=float),
        names,
        np.column_stack([values[name][kept] for name in names]),
        tuple(np.array(table.lines)[kept].tolist()),
        tuple(unused),
        prescribed,
        tuple(notes),
    )


# ---- columns ----


def _named(table: Table) -> Chosen:
    """Choose columns by their headers; other columns are skipped, unless they look like misspelt names."""
    chosen = {name: hit for name in table.header if (hit := recognise(name, FORCE_TEST_COLUMNS)) is not None}
    known = list(measurements.spellings(FORCE_TEST_COLUMNS))
    near = {name: get_close_matches(name, known, 1, cutoff=0.85) for name in table.header if name not in chosen}
    refuse(
        Fault(table.file, table.header_line, name, f"unknown column; did you mean {matches[0]}?")
        for name, matches in near.items()
        if matches
    )
    return chosen


def _incomplete(table: Table, chosen: Chosen, test: ForceTest) -> Iterator[Fault]:
    """Faults of missing and duplicate columns."""
    names, line = [column for column, _ in chosen.values()], table.header_line
    if not SIGNS.keys() & set(names):
        fault = f"has no force, torque or pressure; allowed are {with_units(SIGNS)}"
        yield Fault(table.file, line, "", fault)
    if DEPTH not in names and test.depth_m is None:
        fault = f"has no column of depths; allowed is {with_units([DEPTH])}, or force_test: {{depth_m: ...}}"
        yield Fault(table.file, line, "", fault)
    if PRESSURE in names and test.area_m2 is None:
        fault = "is a pressure, which needs an area: force_test: {area_m2: ...}"
        yield Fault(table.file, line, PRESSURE, fault)
    yield from duplicates(names, table.file, line)


# ---- depths that are heights, rows of unloading ----


def _upward(table: Table, depth: Vector, test: ForceTest) -> Iterator[Fault]:
    """Fault of depths (n,) m that seem to be heights: they are farther above the surface than below it.

    Depths that change in the direction of the motion are accepted: the body then comes from above, or leaves the sand.
    """
    zero = test.depth_offset_m if isinstance(test.depth_offset_m, float) else 0.0
    first, last = sorted((int(np.argmin(depth)), int(np.argmax(depth))))
    along = (depth[last] - depth[first]) * np.sin(np.radians(direction_deg(test))) > 0.0
    if not along and np.max(zero - depth) > max(np.max(depth - zero), 0.0):
        i = int(np.argmin(depth))
        fault = f"got {1e3 * depth[i]:.4g} mm; depths are positive below the surface: change the sign of the column"
        yield Fault(table.file, table.lines[i], DEPTH, fault)


def _unloading(depth: Vector, test: ForceTest) -> NDArray[np.bool_]:
    """Mask (n,) of the rows of unloading, in which the body moves against its direction.

    They lie between a local maximum of the travel and the next minimum. A step back within a single row is the start of
    another trial; steps smaller than TURNING_BACK of the range are noise.
    """
    downward = np.sin(np.radians(direction_deg(test)))
    back = np.zeros(len(depth), bool)
    if abs(downward) < 0.5:
        return back
    travel = depth * np.sign(downward)
    least = TURNING_BACK * float(np.ptp(travel))
    for a, b in _falls(travel, least):
        is_last = b == len(travel) - 1 and b > a + 1  # else the row of the minimum is the first of the next loading
        back[a + 1 : b + is_last] = True
    return back


def _falls(travel: Vector, least: float) -> list[tuple[int, int]]:
    """Indices of each local maximum and the next minimum, between which the travel falls by more than `least`."""
    falls: list[tuple[int, int]] = []
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
            falls.append((top, bottom))
            falling, top = False, i
    return [*falls, (top, bottom)] if falling else falls


def _spans(marked: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last index of each sequence of marked rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], marked.astype(int), [0]])))
    return [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]


def _refused(table: Table, depth: Vector, span: tuple[int, int]) -> Fault:
    a, b = span
    fault = (
        f"from this line to line {table.lines[b]} the depth goes back from {1e3 * depth[max(a - 1, 0)]:.4g} to "
        f"{1e3 * depth[b]:.4g} mm, and on the way back the medium resists differently: leave these rows out, or set "
        "force_test: {unloading: leave_out}"
    )
    return Fault(table.file, table.lines[a], DEPTH, fault)


DEEPEST = 100.0  # greatest plausible depth of a test, in sizes of the body
LEAST_FORCE = 4.0  # least size of a force, in standard errors from the noise; a smaller force is only noise
UNLIKE = 100.0  # greatest plausible factor between the forces of tests, relative to the model


def faults_of_test(measured: Measured, model: Vector, size: float, least: float) -> Iterator[Fault]:
    """Faults of the data of one test, compared with the law.

    model: (n, columns) of the law at the start values; size: of the body (m); least: depth in the table at which the
    body touches the surface, or the lower bound of this depth if it is fitted (m).
    """
    depth = measured.prescribed[measurements.DEPTH]
    yield from first_faults(measured.file, list(_above(measured, depth, least)))
    deepest = int(np.argmax(depth))
    if depth[deepest] > DEEPEST * size:
        fault = (
            f"got {depth[deepest]:.4g} m, but the body is {size:.3g} m wide: is the depth in another unit than its "
            "name says?"
        )
        yield Fault(measured.file, measured.lines[deepest], measurements.DEPTH, fault)
        return
    for k, name in enumerate(measured.columns):
        yield from _faults_of_column(measured, name, measured.values[:, k], model[:, k])


def _above(measured: Measured, depth: Vector, least: float) -> Iterator[Fault]:
    for i in np.flatnonzero(depth < least):
        fault = (
            f"got {1e3 * depth[i]:.4g} mm, which is above the surface; leave the row out, or give the depth at which "
            "the body touches the surface: force_test: {depth_offset_m: fit}, or a number"
        )
        yield Fault(measured.file, measured.lines[int(i)], measurements.DEPTH, fault)


def _faults_of_column(measured: Measured, name: str, data: Vector, model: Vector) -> Iterator[Fault]:
    scatter, size = diagnostics.roughness(data), float(np.linalg.norm(model))
    if size == 0.0:
        return
    projection = float(data @ model) / size  # of the data onto the law, in units of the data
    if not np.any(data) or (scatter is not None and abs(projection) < LEAST_FORCE * scatter):
        fault = f"contains only noise: no force is larger than its scatter from row to row, {scatter or 0.0:.3g}"
        yield Fault(measured.file, measured.lines[0], name, fault)
    elif projection < 0.0:
        row = int(np.argmax(np.abs(data) * (data * model < 0.0)))
        fault = (
            f"got {data[row]:.4g}, but the law gives {model[row]:+.3g}: {name} is positive "
            f"{measurements.SIGNS[name]}; change its sign in the table, or check force_test: {{direction: ...}}"
        )
        yield Fault(measured.file, measured.lines[row], name, fault)


def faults_between_tests(tests: Sequence[Measured], models: Sequence[Vector]) -> Iterator[Fault]:
    """Faults of tests whose forces, relative to the law, are more than `UNLIKE` times those of other tests."""
    ratios: dict[str, list[tuple[float, Measured]]] = {}
    for test, model in zip(tests, models, strict=True):
        for k, name in enumerate(test.columns):
            size = float(model[:, k] @ model[:, k])
            ratio = float(test.values[:, k] @ model[:, k]) / size if size > 0.0 else 0.0
            if ratio > 0.0:
                ratios.setdefault(name, []).append((ratio, test))
    for name, pairs in ratios.items():
        middle = float(np.exp(np.median(np.log([ratio for ratio, _ in pairs]))))
        (low, lowest), (high, highest) = (choose(pairs, key=lambda pair: pair[0]) for choose in (min, max))
        if high / low <= UNLIKE:
            continue
        far, other = (highest, lowest) if high / middle >= middle / low else (lowest, highest)
        fault = (
            f"relative to the law its forces differ by a factor {high / low:.3g} from those of {other.file}: is one of "
            f"them in another unit than its name says?"
        )
        yield Fault(far.file, far.lines[0], name, fault)
