"""The chart of a page of many rows: any column of numbers against any other, with a third as colour."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from granular_contact.report.units import column, is_number

MOST_POINTS = 20_000  # of a longer table every second row, or third, and so on


def chart(
    names: Sequence[str], columns: Mapping[str, Sequence[Any]], x: str, y: str, *, joined: bool = False
) -> dict[str, Any]:
    """Data for the script: what each row is called, and the columns of which numbers differ; empty without x or y.

    Parameters
    ----------
    names
        What is reported of the row that is pointed at.
    columns
        Cells of each column, by its key; its unit is that of the key.
    x, y
        Keys of the columns that are shown at first.
    joined
        Whether points are joined along x, where that is shown: of rows in which nothing else was varied.
    """
    every = max(1, -(-len(names) // MOST_POINTS))
    differ = [key for key, cells in columns.items() if len({one for one in cells if _is_finite(one)}) > 1]
    if x not in differ or y not in differ:
        return {}
    shown = [_column(key, columns[key][::every]) for key in differ]
    places = {"x": differ.index(x), "y": differ.index(y)}
    return {"names": list(names[::every]), "columns": shown, **places, "joined": joined}


def _column(key: str, cells: Sequence[Any]) -> dict[str, Any]:
    words, numbers = column(key, [float(one) if _is_finite(one) else None for one in cells])
    return {"label": words, "values": [float(one) if is_number(one) else None for one in numbers]}


def _is_finite(value: Any) -> bool:
    return is_number(value) and math.isfinite(value)
