"""Panels stacked on one time axis, with curves thinned to visible points, and legends that hide no data.

Touch and stop, or the end of a run without a stop, are marked. Figures use an Agg canvas directly, without the slow
import of pyplot.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from granular_contact.report.drawn import drawn
from granular_contact.report.figures.style import DPI, FAINT, LEGEND_ROW, SINGLE, style
from granular_contact.report.units import Array, instant, minus, time_unit, unit_for
from granular_contact.results import REST_MEASURE, Results

_PANEL, _HANDLE, _LETTER = 72.0, 7.7, 1.1  # widths (mm) of a panel, of a handle in a legend, of a letter


class _Shown(Figure):
    """A figure that a notebook shows without pyplot."""

    def _repr_png_(self) -> bytes:
        picture = BytesIO()
        self.savefig(picture, dpi=DPI, format="png")
        return picture.getvalue()


def blank(width: float, height: float, **options: Any) -> Figure:
    """An empty figure (mm) with an Agg canvas."""
    figure = _Shown(figsize=(width / 25.4, height / 25.4), **options)
    FigureCanvasAgg(figure)
    return figure


@contextmanager
def saved_figure(file: Path, height: float, width: float = SINGLE) -> Iterator[Figure]:
    """Provide an empty figure (mm) in the common style, which is saved as a PNG when the block ends; see `drawn`."""
    with style(), drawn(file) as making:
        figure = blank(width, height, layout="constrained")
        yield figure
        save(figure, making)


def save(figure: Figure, file: Path) -> None:
    """Write a PNG, without the version of matplotlib in its metadata."""
    figure.savefig(file, dpi=DPI, metadata={"Software": None})


def column_of(figure: Figure, count: int, **options: Any) -> list[Axes]:
    """Panels below each other that share their horizontal axis."""
    panels: list[Axes] = list(figure.subplots(count, sharex=True, squeeze=False, **options)[:, 0])
    figure.align_ylabels(panels)
    return panels


def stacked(seconds: Array, height: float, count: int) -> tuple[Figure, list[Axes], Array]:
    """Figure with a column of panels that share the time axis, and the times (rows,) in the unit of the axis."""
    figure = blank(SINGLE, height, layout="constrained")
    panels = column_of(figure, count)
    unit = unit_for(seconds, "s")
    time = seconds * unit.factor
    panels[0].set_xlim(*((time[0], time[-1]) if time[-1] > time[0] else (time[0] - 1, time[0] + 1)))
    panels[-1].set_xlabel(f"time ({unit.name})")
    return figure, panels, time


def curve(axes: Axes, time: Array, values: Array, colour: str, label: str = "", **line: Any) -> None:
    """Draw one curve; fewer than five rows are drawn as dots."""
    rows = thin(time, values)
    marker = "o" if len(rows) < 5 else ""
    axes.plot(time[rows], values[rows], color=colour, label=label, marker=marker, clip_on=not marker, **line)


def thin(time: Array, values: Array, bins: int = 700) -> NDArray[np.intp]:
    """Rows that draw the same curve: first, last, least and greatest in each of `bins` equal spans of `time` (n,)."""
    if len(time) <= 4 * bins:
        return np.arange(len(time))
    starts = np.unique(np.searchsorted(time, np.linspace(time[0], time[-1], bins + 1)[:-1]))
    ends = np.append(starts[1:], len(time))
    picks = [starts, ends - 1]
    for extreme in (np.fmin, np.fmax):
        hits = np.flatnonzero(values == np.repeat(extreme.reduceat(values, starts), ends - starts))
        spans = np.searchsorted(starts, hits, side="right")
        picks.append(hits[np.append(True, spans[1:] != spans[:-1])[: len(hits)]])
    return np.unique(np.concatenate(picks))


def finish(axes: Axes, axis_label: str, columns: int = 0) -> None:
    """Label the panel, fit its scale to the curves and, unless `columns` is 0, add a legend in space above them."""
    axes.set_ylabel(axis_label)
    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.lines])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)
    least = 1e-4 * max(abs(low), abs(high)) or 1.0  # a constant is drawn as one, its round-off is not enlarged
    if high - low < least:
        low, high = (low + high - least) / 2, (low + high + least) / 2
    handles, _ = axes.get_legend_handles_labels()
    rows = -(-len(handles) // columns) if columns else 0
    height = axes.bbox.height / DPI * 25.4
    room = (high - low) / (0.9 - min(LEGEND_ROW * rows / height, 0.6))  # the curves keep a third at the least
    axes.set_ylim(low - 0.05 * room, low + 0.95 * room)
    if rows:
        axes.legend(loc="upper left", ncols=columns).set_in_layout(False)


def fitting_columns(labels: list[str], most: int) -> int:
    """Greatest number of columns, up to `most`, of a legend with these labels within the width of a panel."""
    lengths = [len(label) for label in labels]
    for columns in range(min(most, len(labels)), 1, -1):
        longest = [max(column) for column in np.array_split(lengths, columns)]  # as matplotlib deals them out
        if sum(_HANDLE + _LETTER * length for length in longest) <= _PANEL:
            return columns
    return 1


def mark_events(results: Results, panels: list[Axes]) -> None:
    """Mark touch (unless the run starts with it) and stop by thin lines, with time and angle of the stop above."""
    first, last = results["time_s"][[0, -1]]
    factor, stopping = time_unit(results).factor, results.summary.get("stopping_time_s")
    touch = float(first) if results.summary.get("touch_time_s") is None else results.summary["touch_time_s"]
    begin = (touch - first) / (last - first)
    end = 1.0 if stopping is None else (touch + stopping - first) / (last - first)
    if 0.01 < begin < 1:
        _vertical(panels, touch * factor, (0, (1, 1.5)))
        if end - begin > 0.55:  # as far as the words at the stop may reach
            _above(panels[0], begin, "touch")
    if stopping is None:
        _above(panels[0], 1.0, _ending(results))
    else:
        _vertical(panels, (touch + stopping) * factor, (0, (5, 2)))
        angle = results.summary.get("angle_at_stop_deg")
        at = "" if angle is None else f" at {minus(f'{angle:.2f}')}°"
        does = "at rest" if results.summary.get("stopping_time_measure") == REST_MEASURE else "stops"
        _above(panels[0], end, f"{does} after {instant(results, stopping)}{at}")


def _vertical(panels: list[Axes], time: float, kind: Any) -> None:
    """A thin line across all panels, behind the curves."""
    for axes in panels:
        axes.axvline(time, color=FAINT, linewidth=0.6, linestyle=kind, zorder=1.5)


def _above(axes: Axes, share: float, text: str) -> None:
    """Write text above the panel at this share of its width, aligned inwards near the ends."""
    side = "left" if share < 0.3 else "right" if share > 0.7 else "center"
    look: Any = {"xycoords": "axes fraction", "textcoords": "offset points", "ha": side, "fontsize": 7.5}
    axes.annotate(text, (min(share, 1.0), 1.0), (0, 2.5), **look)


def _ending(results: Results) -> str:
    """Short text on the end of a run without a stop."""
    endings = {"failed": "run failed", "interrupted": "interrupted", "time_limit": "out of time"}
    if results.status.code in endings:
        return f"{endings[results.status.code]} at {instant(results, results['time_s'][-1])}"
    # What is driven has no stop to look for.
    measure = results.summary.get("stopping_time_measure", "")
    return "" if measure is None else "not at rest" if measure == REST_MEASURE else "no stop"
