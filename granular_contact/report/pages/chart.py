"""Data of the chart on a page with many rows: any column of numbers against any other, with a third as colour."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from granular_contact.report.units import column, is_number

MOST_POINTS = 20_000  # greatest number of points; of a longer table every second row is shown, or every third, ...


def chart(
    names: Sequence[str], columns: Mapping[str, Sequence[Any]], x: str, y: str, *, joined: bool = False
) -> dict[str, Any]:
    """Data for the script: names of the rows, and the columns whose numbers differ; empty if x or y is constant.

    Parameters
    ----------
    names
        Text that is shown for the row under the pointer.
    columns
        Cells of each column, by key; the unit is that of the key.
    x, y
        Keys of the columns that are shown first.
    joined
        Whether points are joined by a line along x, for rows in which only x was varied.
    """
    every = max(1, -(-len(names) // MOST_POINTS))
    differing = [key for key, cells in columns.items() if len({cell for cell in cells if _is_finite(cell)}) > 1]
    if x not in differing or y not in differing:
        return {}
    shown = [_column(key, columns[key][::every]) for key in differing]
    axes = {"x": differing.index(x), "y": differing.index(y)}
    return {"names": list(names[::every]), "columns": shown, **axes, "joined": joined}


def _column(key: str, cells: Sequence[Any]) -> dict[str, Any]:
    heading, numbers = column(key, [float(cell) if _is_finite(cell) else None for cell in cells])
    return {"label": heading, "values": [float(number) if is_number(number) else None for number in numbers]}


def _is_finite(value: Any) -> bool:
    return is_number(value) and math.isfinite(value)
