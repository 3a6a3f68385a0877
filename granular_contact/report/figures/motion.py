"""Motion over time: angle and rate of every hinge; of a free body, the path of its tip."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure

from granular_contact.report.figures.outlines import Hinge, hinges_of
from granular_contact.report.figures.panels import cleared, curve, finish, fitting_columns, mark_events, stacked
from granular_contact.report.figures.style import BLUE, FAINT, INK, PALETTE, SKY, VERMILION
from granular_contact.report.units import Array, greatest, unit_for
from granular_contact.results import Results

MOST_NAMED = 6  # curves with a name and a colour of their own


def motion(results: Results) -> Figure:
    """Angle and angular rate of every hinge (of a free body: the path of its tip), over time."""
    figure, (upper, lower), time = stacked(results, 88.0, (1, 1))
    hinges = hinges_of(results)
    if hinges:
        colours = _colours(len(hinges))
        _angles(upper, results, time, hinges, colours)
        _rates(lower, results, time, hinges, colours)
    else:
        up = "z" if "tip_z_m" in results.names else "y"
        both = np.concatenate([results["tip_x_m"], results[f"tip_{up}_m"]])
        unit, scale = unit_for(both, "m"), greatest(both)
        for axes, letter in ((upper, "x"), (lower, up)):
            curve(axes, time, cleared(results[f"tip_{letter}_m"], scale) * unit.factor, BLUE)
            finish(axes, f"tip {letter} ({unit.name})")
    mark_events(results, [upper, lower])
    return figure


def _colours(count: int) -> list[str]:
    """A colour for each hinge: distinct ones for a few, from blue to vermilion for a chain."""
    if count <= MOST_NAMED:
        return list(PALETTE[:count])
    ends = np.array([to_rgb(BLUE), to_rgb(VERMILION)])
    return [to_hex(ends[0] * (1 - share) + ends[1] * share) for share in np.linspace(0.0, 1.0, count)]


def _named(labels: list[str]) -> list[str]:
    """Labels for a legend: of many curves, the first and the last."""
    many = len(labels) > MOST_NAMED
    return [label if not many or i in (0, len(labels) - 1) else "" for i, label in enumerate(labels)]


def _angles(axes: Axes, results: Results, time: Array, hinges: list[Hinge], colours: list[str]) -> None:
    """Angles of the hinges. Their reference is named once if it is the same for all, else for each."""
    references = {hinge.reference for hinge in hinges}
    if references == {None}:
        labels, words = [hinge.name for hinge in hinges], "angle below horizontal (deg)"
    elif len(hinges) == 1:
        labels, words = [hinges[0].name], f"angle relative to {hinges[0].reference} (deg)"
    else:
        labels = [hinge.label if hinge.reference else f"{hinge.name}, below horizontal" for hinge in hinges]
        words = "angle (deg)"
    labels = _named(labels)
    for hinge, colour, label in zip(hinges, colours, labels, strict=True):
        curve(axes, time, results[hinge.angle], colour, label)
    finish(axes, words, columns=fitting_columns([one for one in labels if one], most=3) if len(hinges) > 1 else 0)


def _rates(axes: Axes, results: Results, time: Array, hinges: list[Hinge], colours: list[str]) -> None:
    """Rates of the hinges and, over them, the mean rate about the pivot; one curve where the two are the same."""
    has_mean = any(column.name == "mean_rate_rad_s" for column in results.columns)
    mean = results["mean_rate_rad_s"] if has_mean else None
    axes.axhline(0, color=FAINT, linewidth=0.5)
    labels = _named([f"at {hinge.label}" for hinge in hinges])
    for hinge, colour, label in zip(hinges, colours, labels, strict=True):
        rate = results[hinge.rate]
        if mean is not None and hinge.reference is None and greatest(rate - mean) <= 2e-3 * greatest(rate):
            curve(axes, time, rate, colour, f"at {hinge.name}, equal to the mean")
            mean = None
        elif mean is not None and len(hinges) == 1:
            curve(axes, time, rate, SKY, label, linewidth=0.6)
        else:
            curve(axes, time, rate, colour, label)
    if mean is not None:
        curve(axes, time, mean, INK if len(hinges) > 1 else BLUE, "mean (angular momentum / inertia)")
    shown = [str(label) for label in axes.get_legend_handles_labels()[1]]
    finish(axes, "angular rate (rad/s)", columns=fitting_columns(shown, most=2))
