"""The unit of the time axis."""

from __future__ import annotations

from granular_contact.results import Results
from granular_contact.results.units import Unit, minus, unit_for


def time_unit(results: Results) -> Unit:
    """Of the time axis; chosen by the last instant."""
    return unit_for(results["time_s"], "s") if len(results.table) else Unit(1.0, "s")


def instant(results: Results, seconds: float) -> str:
    """An instant or a duration in the unit of the time axis, such as `32.7 ms`."""
    unit = time_unit(results)
    return minus(f"{seconds * unit.factor:.4g} {unit.name}")
