"""What is marked in panels over time: the touch, the stop, and how a run without a stop ended."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes

from granular_contact.report.figures.style import FAINT
from granular_contact.report.units import instant, minus, time_unit
from granular_contact.results import REST_MEASURE, Results


def mark_events(results: Results, panels: list[Axes]) -> None:
    """A thin line at touch, unless the run starts with it, and at the stop, whose time and angle stand above it."""
    if len(results.table) < 2:
        _above(panels[0], 1.0, _ending(results))
        return
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


def _above(axes: Axes, share: float, words: str) -> None:
    """Words above the panel at this share of its width, leaning inwards near its ends."""
    side = "left" if share < 0.3 else "right" if share > 0.7 else "center"
    look: Any = {"xycoords": "axes fraction", "textcoords": "offset points", "ha": side, "fontsize": 7.5}
    axes.annotate(words, (min(share, 1.0), 1.0), (0, 2.5), **look)


def _ending(results: Results) -> str:
    """How a run without a stop ended, in two words."""
    words = {"failed": "run failed", "interrupted": "interrupted", "time_limit": "out of time"}
    if results.status.code in words:
        return f"{words[results.status.code]} at {instant(results, results['time_s'][-1])}"
    # What is driven has no stop to look for.
    measure = results.summary.get("stopping_time_measure", "")
    return "" if measure is None else "not at rest" if measure == REST_MEASURE else "no stop"
