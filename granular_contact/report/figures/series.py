"""Deflection, forces and energy over time."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_contact.report.figures.panels import (
    ROUND_OFF,
    cleared,
    curve,
    finish,
    fitting_columns,
    mark_events,
    size_of,
    stacked,
)
from granular_contact.report.figures.style import BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, SKY, VERMILION
from granular_contact.report.histories import energies
from granular_contact.report.units import Array, Unit, greatest, instant, minus, time_unit, unit_for
from granular_contact.results import CENTRAL_MOMENT, MOMENT, Results

_DASHED, _DOTTED, _SHORT, _MIXED = (0, (4, 1.2)), (0, (1, 1)), (0, (2, 1)), (0, (4, 1.2, 1, 1.2))  # kinds of lines
# Of the terms of the granular force, one after another.
_TERMS = ((BLUE, "-"), (VERMILION, _DASHED), (GREEN, _MIXED), (PURPLE, _DOTTED), (ORANGE, _SHORT))
_ENERGIES = {
    **{"kinetic_J": (BLUE, "-"), "gravity_J": (GREEN, _DASHED), "elastic_J": (PURPLE, _DOTTED)},
    **{"granular_work_J": (VERMILION, _MIXED), "damping_work_J": (ORANGE, _SHORT)},
    **{"spring_J": (SKY, _DOTTED), "joint_damping_work_J": (ORANGE, _DASHED), "friction_work_J": (PURPLE, _SHORT)},
    **{"floor_work_J": (FAINT, _DASHED), "drive_work_J": (SKY, _MIXED)},
}


def deflection(results: Results) -> Figure:
    """Deflection of the flexible link's tip over time, its greatest value marked; in space in both planes too."""
    figure, (axes,), time = stacked(results, 55.0, (1,))
    values = cleared(results["deflection_m"], 1e-2 * size_of(results))  # links bend by 1e-7 of their length and more
    unit = unit_for(values, "m")
    axes.axhline(0, color=FAINT, linewidth=0.5)
    end = "_deflection_y_m"
    links = [name.removesuffix(end) for name in results.names if name.endswith(end)]  # in space
    curve(axes, time, values * unit.factor, BLUE, "distance from the axis" if links else "")
    for axis, colour, line in (("y", GREEN, _DASHED), ("z", ORANGE, _DOTTED)) if links else ():
        bent = results[f"{links[-1]}_deflection_{axis}_m"]
        curve(axes, time, bent * unit.factor, colour, f"along {axis} of the root", linestyle=line)
    peak, at = results.summary.get("max_deflection_m"), results.summary.get("max_deflection_time_s")
    if peak is not None and at is not None and len(time) and np.isfinite(values).any():
        # Between the rows of the table, of which there may be few; on the side where they are.
        peak *= np.sign(values[np.nanargmax(np.abs(values))]) * unit.factor
        words = f"largest: {peak:.3g} {unit.name} at {instant(results, at)}"
        axes.plot(at * time_unit(results).factor, peak, "o", color=VERMILION, label=minus(words), linestyle="none")
    finish(axes, f"tip deflection ({unit.name})", columns=2 if links else 1)
    mark_events(results, [axes])
    return figure


def forces(results: Results) -> Figure:
    """The terms of the granular force and their sum over time: horizontal, vertical and their moment; in space the
    force along x, y and z.
    """
    axes_of = "xyz" if f"{results.terms[0]}_force_z_N" in results.names else "xy"
    force = greatest(np.concatenate([results[f"{term}_force_{axis}_N"] for term in results.terms for axis in axes_of]))
    newton = unit_for(force, "N")
    if axes_of == "xyz":  # the moments are columns of the table
        directions = zip(axes_of, ("ahead", "to the left", "upward"), strict=True)
        return _terms(results, [(f"force_{axis}_N", force, newton, f"force {side}") for axis, side in directions])
    lever = force * size_of(results)
    pivots = any(column.name == f"{results.terms[0]}_{MOMENT}" for column in results.columns)
    column, about = (MOMENT, "pivot") if pivots else (CENTRAL_MOMENT, "centre of mass")
    turning = greatest(np.concatenate([results[f"{term}_{column}"] for term in results.terms]))
    moment = unit_for(turning if turning > ROUND_OFF * lever else lever, "N·m")
    rows = [
        ("force_x_N", force, newton, "horizontal force"),
        ("force_y_N", force, newton, "vertical force"),
        (column, lever, moment, f"moment about\n{about}"),
    ]
    return _terms(results, rows)


def _terms(results: Results, rows: Sequence[tuple[str, float, Unit, str]]) -> Figure:
    """A panel for each column of the terms that is not zero: its end, its scale, its unit, and words for it."""
    sizes = [greatest(np.concatenate([results[f"{term}_{row[0]}"] for term in results.terms])) for row in rows]
    rows = [row for row, size in zip(rows, sizes, strict=True) if size > ROUND_OFF * row[1]] or rows[:1]
    figure, panels, time = stacked(results, 10.0 + 36.0 * len(rows), (1,) * len(rows))
    for axes, (column, scale, unit, words) in zip(panels, rows, strict=True):
        axes.axhline(0, color=FAINT, linewidth=0.5)
        parts = [cleared(results[f"{term}_{column}"], scale) * unit.factor for term in results.terms]
        if len(parts) > 1:
            curve(axes, time, np.sum(parts, axis=0), INK, "sum", linewidth=0.7)
        for part, term, (colour, kind) in zip(parts, results.terms, cycle(_TERMS), strict=False):
            curve(axes, time, part, colour, term.replace("_", " "), linestyle=kind)
        labels = ["sum", *(term.replace("_", " ") for term in results.terms)]
        has_legend = axes is panels[0] and len(parts) > 1
        finish(axes, f"{words} ({unit.name})", columns=fitting_columns(labels, 4) if has_legend else 0)
    mark_events(results, panels)
    return figure


def energy(results: Results) -> Figure:
    """Energies and dissipated work over time, their total, which should be constant, and the imbalance."""
    figure, (upper, lower), time = stacked(results, 98.0, (3, 1))
    parts = [(one, one.values(results.__getitem__)) for one in energies(results.names)]
    scale = max(greatest(values) for _, values in parts)
    unit = unit_for(scale, "J")
    total = np.sum([values for _, values in parts], axis=0)
    curve(upper, time, total * unit.factor, INK, "total", linewidth=0.8)
    for one, values in parts:
        if greatest(values) >= ROUND_OFF * scale:
            colour, kind = _ENERGIES[one.terms[0][0]]
            curve(upper, time, values * unit.factor, colour, one.label, linestyle=kind)
    finish(upper, f"energy ({unit.name})", columns=2)
    _imbalance(lower, results, time, scale)
    mark_events(results, [upper, lower])
    return figure


def _imbalance(axes: Axes, results: Results, time: Array, scale: float) -> None:
    """Change of the total, on its own scale; if it is round-off, on the scale of the energies (J)."""
    values = cleared(results["energy_imbalance_J"], 1e-3 * scale)
    unit = unit_for(values if values.any() else scale, "J")
    axes.axhline(0, color=FAINT, linewidth=0.5)
    curve(axes, time, values * unit.factor, INK, linewidth=0.8)
    finish(axes, f"imbalance ({unit.name})")
