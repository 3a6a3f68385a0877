"""Histories of several models of one run with their differences from the reference, or of one run in several media."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_contact.report.figures.panels import cleared, curve, finish, fitting_columns, save, saved_figure, stacked
from granular_contact.report.figures.style import DOUBLE, INK, LINES, PALETTE, style
from granular_contact.report.units import Array, greatest, unit_for
from granular_contact.results import Results
from granular_contact.results.interpolation import at_times, rates
from granular_contact.results.series import resultant

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


def draw_media(runs: Runs, file: Path) -> None:
    """Draw runs (medium and results) into a PNG: depth or distance, force of the medium, energy that it took."""
    with saved_figure(file, 150.0, DOUBLE) as figure:
        panels = figure.subplots(3, 1, sharex=True)
        time = unit_for(_end(runs), "s")
        paths = [_path(one) for _, one in runs]
        length = unit_for(np.concatenate(paths), "m")
        walks = bool(_body(runs[0][1]))
        drawn = {
            f"{'distance' if walks else 'depth'} ({length.name})": [path * length.factor for path in paths],
            "force of the medium (N)": [np.linalg.norm(resultant(one, one.terms), axis=0) for _, one in runs],
            "energy taken (J)": [-one["granular_work_J"] for _, one in runs],
        }
        for axes, (label, curves) in zip(panels, drawn.items(), strict=True):
            axes.set_ylabel(label)
            for i, ((name, one), values) in enumerate(zip(runs, curves, strict=True)):
                look = {"color": PALETTE[i % len(PALETTE)], "linestyle": LINES[i % len(LINES)], "label": name}
                axes.plot(one["time_s"] * time.factor, values, **look)
        if not walks:
            panels[0].invert_yaxis()
        panels[0].legend()
        panels[2].set_xlabel(f"time ({time.name})")
        panels[2].set_xlim(0.0, _end(runs) * time.factor)


def _body(one: Results) -> str:
    """What travels: the first body of a run whose summary has a distance; empty for what does not."""
    if one.summary.get("distance_m") is None:
        return ""
    return next((name.removesuffix("_vx_m_s") for name in one.names if name.endswith("_vx_m_s")), "")


def _path(one: Results) -> Array:
    """Distance of what travels, of all else its depth (rows,) m."""
    body = _body(one)
    return one[f"{body}_x_m"] - one[f"{body}_x_m"][0] if body else one["depth_m"]


def _end(runs: Runs) -> float:
    """Time (s) until which there is something to see."""
    ends = []
    for _, one in runs:
        touch, stopping = one.summary["touch_time_s"], one.summary["stopping_time_s"]
        ends.append(one["time_s"][-1] if touch is None or stopping is None else touch + 1.3 * stopping)
    return float(max(ends))
