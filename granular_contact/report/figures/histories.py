"""Histories of several models of one run in common panels, with their differences from the last, the reference."""

from __future__ import annotations

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_contact.report.figures.panels import cleared, curve, finish, fitting_columns, save, stacked
from granular_contact.report.figures.style import INK, LINES, PALETTE, style
from granular_contact.report.units import greatest, unit_for
from granular_contact.results import Results
from granular_contact.results.interpolation import at_times, rates

Runs = list[tuple[str, Results]]
Lines = dict[str, tuple[str, str]]  # colour and style of the line of each run


def draw_histories(runs: Runs, file: Path) -> None:
    """Draw runs (name and results), the last of them the reference, into a PNG."""
    with style():
        save(histories(runs), file)


def histories(runs: Runs) -> Figure:
    """Angle and deflection, each with its difference from the reference, over the time of the shortest run."""
    shortest = min((one for _, one in runs), key=lambda one: one["time_s"][-1])
    angle = next(column.name for column in runs[-1][1].columns if column.name.endswith("_angle_deg"))
    bending = [run for run in runs if any(column.name == "deflection_m" for column in run[1].columns)]
    unit = unit_for(bending[-1][1]["deflection_m"], "m")
    lines = {name: (PALETTE[i % len(PALETTE)], LINES[i % len(LINES)]) for i, (name, _) in enumerate(runs[:-1])}
    lines[runs[-1][0]] = (INK, "-")

    figure, panels, time = stacked(shortest, 170.0, (1.3, 1, 1, 1))
    scale = time[-1] / shortest["time_s"][-1]
    _overlay(panels[0], runs, angle, scale, 1.0, lines)
    finish(panels[0], "angle (deg)", columns=fitting_columns([name for name, _ in runs], most=4))
    _differences(panels[1], runs, angle, scale, 1e3, lines)
    finish(panels[1], "less reference (mdeg)")
    _overlay(panels[2], bending, "deflection_m", scale, unit.factor, lines)
    finish(panels[2], f"deflection ({unit.name})")
    _differences(panels[3], bending, "deflection_m", scale, unit.factor, lines)
    finish(panels[3], f"less reference ({unit.name})")
    return figure


def _overlay(axes: Axes, runs: Runs, column: str, scale: float, factor: float, lines: Lines) -> None:
    for name, one in runs:
        colour, line = lines[name]
        curve(axes, one["time_s"] * scale, one[column] * factor, colour, name, linestyle=line, linewidth=0.9)


def _differences(axes: Axes, runs: Runs, column: str, scale: float, factor: float, lines: Lines) -> None:
    reference = runs[-1][1]
    for name, one in runs[:-1]:
        colour, line = lines[name]
        both = one["time_s"] <= reference["time_s"][-1]
        time = one["time_s"][both]
        known = reference["time_s"], reference[column]
        difference = one[column][both] - at_times(*known, rates(*known), time)
        difference = cleared(difference, greatest(reference[column]))
        curve(axes, time * scale, difference * factor, colour, name, linestyle=line, linewidth=0.8)
