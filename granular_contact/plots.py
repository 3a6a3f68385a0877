"""Results -> figures at the size journals print them: time series one column wide, the mechanism two columns wide.

Drawn on an Agg canvas directly, without the cost of importing pyplot. Colours are Okabe and Ito's, which colour-blind
readers tell apart; kinds of line differ as well, for print in grey. Legends stand in room made for them above the data.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon, Rectangle
from numpy.typing import NDArray

from granular_contact.results import Outline, Results, Snapshot

Array = NDArray[np.float64]

SINGLE, DOUBLE, DPI = 88.0, 180.0, 200  # column widths, mm, and dots per inch
INK, FAINT, GRID = "#262626", "#8C8C8C", "#E9E9E9"
BLUE, VERMILION, GREEN, ORANGE, SKY, PURPLE = "#0072B2", "#D55E00", "#009E73", "#E69F00", "#56B4E9", "#CC79A7"
PALETTE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
SAND, SAND_EDGE, GRAINS = "#F1E3C4", "#A98F57", ("#D9C394", "#C4AB76")

STYLE: Any = {  # rcParams
    "text.usetex": False,
    "font.family": "STIXGeneral",  # comes with matplotlib, so figures look alike everywhere
    "mathtext.fontset": "stix",
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7,
    "text.color": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.edgecolor": INK,
    "axes.linewidth": 0.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.formatter.useoffset": False,
    "axes.unicode_minus": True,
    "grid.color": GRID,
    "grid.linewidth": 0.4,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "lines.linewidth": 1.0,
    "lines.markersize": 3,
    "legend.edgecolor": "none",
    "legend.facecolor": "white",
    "legend.framealpha": 1.0,
    "legend.fancybox": False,
    "legend.handlelength": 1.6,
    "legend.handletextpad": 0.5,
    "legend.columnspacing": 1.0,
    "legend.labelspacing": 0.25,
    "legend.borderpad": 0.2,
    "legend.borderaxespad": 0.1,
    "figure.dpi": DPI,
    "figure.constrained_layout.h_pad": 0.03,
    "figure.constrained_layout.w_pad": 0.03,
    "figure.constrained_layout.hspace": 0.03,
}
LEGEND_ROW = 3.7  # mm of panel height that one row of a legend takes

TERMS = {  # of the granular force: words, colour, kind of line
    "drag": ("drag", BLUE, "-"),
    "horizontal_static": ("horizontal static", VERMILION, (0, (4, 1.2))),
    "vertical_static": ("vertical static", GREEN, (0, (4, 1.2, 1, 1.2))),
}
POSES: dict[str, dict[str, Any]] = {
    "touch": {"facecolor": "#D4D4D4", "edgecolor": "#7A7A7A", "zorder": 3},
    "end": {"facecolor": "#6FA8CC", "edgecolor": "#00486F", "zorder": 4},
    "deepest": {"facecolor": "none", "edgecolor": VERMILION, "zorder": 5},
}


# --- figures -------------------------------------------------------------------------------------------------------


def draw(results: Results, directory: Path) -> None:
    """Write every figure that `results` has the columns for to `directory` as NAME.png; OSError as the disk has it."""
    with style():
        for name, figure in figures(results).items():
            figure.savefig(directory / f"{name}.png", dpi=DPI, metadata={"Software": None})


def figures(results: Results) -> dict[str, Figure]:
    """The figures of `results` by name, on Agg canvases; to be made and drawn within `style()`."""
    has = {column.name for column in results.columns}
    made: dict[str, Callable[[Results], Figure]] = {}
    if len(results.table):
        made["motion"] = motion
        if "deflection_m" in has:
            made["deflection"] = deflection
        if "drag_force_x_N" in has:
            made["forces"] = forces
        if "kinetic_J" in has:
            made["energy"] = energy
    if results.snapshots:
        made["mechanism"] = mechanism
    return {name: make(results) for name, make in made.items()}


@contextmanager
def style() -> Iterator[None]:
    """Matplotlib with this module's settings; the caller's are back afterwards."""
    with matplotlib.rc_context(STYLE):
        yield


def motion(results: Results) -> Figure:
    """Angle below the horizontal and angular rate of every hinge (of a free body: the way of its tip), over time."""
    figure, (upper, lower), time = _panels(results, 88.0, (1, 1))
    hinges = _hinges(results)
    colours = [PALETTE[i % len(PALETTE)] for i in range(len(hinges))]
    for name, colour in zip(hinges, colours, strict=True):
        _curve(upper, time, results[f"{name}_angle_deg"], colour, name)
    if hinges:
        _rates(lower, results, time, dict(zip(hinges, colours, strict=True)))
        _finish(upper, "angle below horizontal (deg)", columns=min(len(hinges), 3) if len(hinges) > 1 else 0)
        _finish(lower, "angular rate (rad/s)", columns=2)
    else:
        unit = unit_for(np.concatenate([results["tip_x_m"], results["tip_y_m"]]), "m")
        for axes, letter in ((upper, "x"), (lower, "y")):
            _curve(axes, time, results[f"tip_{letter}_m"] * unit.factor, BLUE)
            _finish(axes, f"tip {letter} ({unit.name})")
    _mark_events(results, [upper, lower])
    return figure


def deflection(results: Results) -> Figure:
    """Deflection of the flexible link's tip over time, its greatest value marked."""
    figure, (axes,), time = _panels(results, 55.0, (1,))
    values = results["deflection_m"]
    unit = unit_for(values, "m")
    axes.axhline(0, color=FAINT, linewidth=0.5)
    _curve(axes, time, values * unit.factor, BLUE)
    if np.isfinite(values).any():
        peak = int(np.nanargmax(np.abs(values)))
        words = f"largest: {values[peak] * unit.factor:.3g} {unit.name} at {_instant(results, results['time_s'][peak])}"
        axes.plot(time[peak], values[peak] * unit.factor, "o", color=VERMILION, label=_minus(words), linestyle="none")
    _finish(axes, f"tip deflection ({unit.name})", columns=1)
    _mark_events(results, [axes])
    return figure


def forces(results: Results) -> Figure:
    """The terms of the granular force and their sum over time: horizontal, vertical, moment about the pivot."""
    figure, panels, time = _panels(results, 118.0, (1, 1, 1))
    both = [results[f"{term}_force_{axis}_N"] for term in TERMS for axis in "xy"]
    newton = unit_for(np.concatenate(both), "N")
    moment = unit_for(np.concatenate([results[f"{term}_moment_Nm"] for term in TERMS]), "N·m")
    rows = (
        ("force_x_N", newton, "horizontal force"),
        ("force_y_N", newton, "vertical force"),
        ("moment_Nm", moment, "moment about pivot"),
    )
    for axes, (column, unit, words) in zip(panels, rows, strict=True):
        axes.axhline(0, color=FAINT, linewidth=0.5)
        parts = [results[f"{term}_{column}"] * unit.factor for term in TERMS]
        _curve(axes, time, np.sum(parts, axis=0), INK, "sum", linewidth=0.7)
        for part, (label, colour, kind) in zip(parts, TERMS.values(), strict=True):
            _curve(axes, time, part, colour, label, linestyle=kind)
        _finish(axes, f"{words} ({unit.name})", columns=4 if axes is panels[0] else 0)
    _mark_events(results, panels)
    return figure


def energy(results: Results) -> Figure:
    """Where the energy is and went over time, the total that should be constant, and by how much it is not."""
    figure, (upper, lower), time = _panels(results, 98.0, (3, 1))
    columns = {column.name for column in results.columns}
    parts = [  # gravity counted from the start, work turned into what is dissipated
        ("kinetic", "kinetic_J", 1.0, BLUE, "-"),
        ("gravity, from start", "gravity_J", 1.0, GREEN, (0, (4, 1.2))),
        ("elastic", "elastic_J", 1.0, PURPLE, (0, (1, 1))),
        ("dissipated in medium", "granular_work_J", -1.0, VERMILION, (0, (4, 1.2, 1, 1.2))),
        ("dissipated by damping", "damping_work_J", -1.0, ORANGE, (0, (2, 1))),
    ]
    curves = []
    for label, name, sign, colour, kind in parts:
        if name in columns:
            values = sign * results[name]
            curves.append((label, values - values[0] if name == "gravity_J" else values, colour, kind))
    total = np.sum([values for _, values, _, _ in curves], axis=0)
    unit = unit_for(np.concatenate([total, *(values for _, values, _, _ in curves)]), "J")
    _curve(upper, time, total * unit.factor, INK, "total", linewidth=0.8)
    for label, values, colour, kind in curves:
        _curve(upper, time, values * unit.factor, colour, label, linestyle=kind)
    _finish(upper, f"energy ({unit.name})", columns=2)
    _imbalance(lower, results, time)
    _mark_events(results, [upper, lower])
    return figure


def mechanism(results: Results) -> Figure:
    """The mechanism at touch, at its deepest and at the end, one over the other; beside it the immersed part enlarged.

    Overlaid and not side by side, as a link turns by a few degrees only: three pictures would look the same.
    """
    whole = _whole_view(results)
    tip = _tip_view(results)
    figure, panels = _views(
        [whole] if tip is None else [whole, tip], legend_rows=1 if tip else len(results.snapshots) + 1
    )
    if tip is not None:
        tip = panels[1].view
        panels[0] = panels[0].showing(tip)
    unit = unit_for(np.array([whole.width, whole.height]), "m")
    for panel in panels:
        _scene(panel.axes, results, unit, panel.view)
    pivots = _pivots(results)
    for x, y in pivots:
        panels[0].axes.plot(x * unit.factor, y * unit.factor, zorder=6, **PIVOT)
    if tip is not None:
        _outline_view(panels[0].axes, tip, unit)
        _dimension_depth(panels[1].axes, results, unit)
    handles: list[Artist] = [Patch(**_pose(shot), label=_caption(results, shot)) for shot in results.snapshots]
    if len(pivots):
        handles.append(Line2D([], [], label="pivot", **PIVOT))
    figure.legend(handles=handles, loc="lower center", ncols=4 if tip is not None else 1, borderaxespad=0.4)
    return figure


# --- units ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Unit:
    """A value in SI units times `factor` is a number of `name`s."""

    factor: float
    name: str


PREFIXES = {-18: "a", -15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


def unit_for(values: Array, base: str) -> Unit:
    """The multiple of SI unit `base` in which the largest magnitude of `values` (any shape, SI) lies in 1 to 1000."""
    largest = _largest(values)
    exponent = 3 * int(np.floor(np.log10(largest) / 3)) if largest > 0 else 0
    exponent = min(max(exponent, min(PREFIXES)), max(PREFIXES))
    return Unit(10.0**-exponent, PREFIXES[exponent] + base)


def _largest(values: Array) -> float:
    """Largest finite magnitude, 0 if there is none."""
    return float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))


def _time_unit(results: Results) -> Unit:
    """Of the time axis; chosen by the last instant."""
    return unit_for(results["time_s"], "s") if len(results.table) else Unit(1.0, "s")


def _instant(results: Results, seconds: float) -> str:
    """An instant or a duration in the unit of the time axis, such as `32.7 ms`."""
    unit = _time_unit(results)
    return _minus(f"{seconds * unit.factor:.4g} {unit.name}")


def _minus(words: str) -> str:
    """Text with a typeset minus sign."""
    return words.replace("-", "\N{MINUS SIGN}")


# --- panels over time ----------------------------------------------------------------------------------------------


def thin(time: Array, values: Array, bins: int = 700) -> NDArray[np.intp]:
    """Rows that draw the same curve: first, last, least and greatest of each of `bins` equal spans of `time` (n,)."""
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


def _figure(width: float, height: float, **options: Any) -> Figure:
    """An empty figure (mm) with an Agg canvas."""
    figure = Figure(figsize=(width / 25.4, height / 25.4), **options)
    FigureCanvasAgg(figure)
    return figure


def _panels(results: Results, height: float, ratios: tuple[float, ...]) -> tuple[Figure, list[Axes], Array]:
    """A column of panels of these relative heights that share the time axis, and the times (rows,) in its unit."""
    figure = _figure(SINGLE, height, layout="constrained")
    grid = figure.subplots(len(ratios), sharex=True, squeeze=False, height_ratios=ratios)
    panels: list[Axes] = list(grid[:, 0])
    figure.align_ylabels(panels)
    unit = _time_unit(results)
    time = results["time_s"] * unit.factor
    panels[0].set_xlim(*((time[0], time[-1]) if time[-1] > time[0] else (time[0] - 1, time[0] + 1)))
    panels[-1].set_xlabel(f"time ({unit.name})")
    return figure, panels, time


def _curve(axes: Axes, time: Array, values: Array, colour: str, label: str = "", **line: Any) -> None:
    """One curve; so few rows that there is no line to see are drawn as dots."""
    rows = thin(time, values)
    marker = "o" if len(rows) < 5 else ""
    axes.plot(time[rows], values[rows], color=colour, label=label, marker=marker, clip_on=not marker, **line)


def _finish(axes: Axes, words: str, columns: int = 0) -> None:
    """Label the panel, fit its scale to the curves and, if `columns`, set a legend in room made above them."""
    axes.set_ylabel(words)
    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.lines])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)
    least = 1e-4 * max(abs(low), abs(high)) or 1.0  # a constant is drawn as one, its round-off is not enlarged
    if high - low < least:
        low, high = (low + high - least) / 2, (low + high + least) / 2
    handles, _ = axes.get_legend_handles_labels()
    rows = -(-len(handles) // columns) if columns else 0
    height = axes.bbox.height / DPI * 25.4
    room = (high - low) / (0.9 - LEGEND_ROW * rows / height)
    axes.set_ylim(low - 0.05 * room, low + 0.95 * room)
    if rows:
        axes.legend(loc="upper left", ncols=columns).set_in_layout(False)


def _mark_events(results: Results, panels: list[Axes]) -> None:
    """A thin line at touch, unless the run starts with it, and at the stop, whose time and angle stand above it."""
    if len(results.table) < 2:
        _above(panels[0], 1.0, _ending(results))
        return
    first, last = results["time_s"][[0, -1]]
    factor, touch, stopping = _time_unit(results).factor, _touch(results), results.summary.get("stopping_time_s")
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
        at = "" if angle is None else f" at {_minus(f'{angle:.2f}')}°"
        _above(panels[0], end, f"stops after {_instant(results, stopping)}{at}")


def _vertical(panels: list[Axes], time: float, kind: Any) -> None:
    """A thin line across all panels, behind the curves."""
    for axes in panels:
        axes.axvline(time, color=FAINT, linewidth=0.6, linestyle=kind, zorder=1.5)


def _above(axes: Axes, share: float, words: str) -> None:
    """Words above the panel at this share of its width, leaning inwards near its ends."""
    side = "left" if share < 0.3 else "right" if share > 0.7 else "center"
    axes.annotate(
        words,
        (min(share, 1.0), 1.0),
        (0, 2.5),
        xycoords="axes fraction",
        textcoords="offset points",
        ha=side,
        fontsize=7.5,
    )


def _ending(results: Results) -> str:
    """How a run without a stop ended, in two words."""
    last = _instant(results, results["time_s"][-1])
    words = {"failed": f"run failed at {last}", "interrupted": f"interrupted at {last}"}
    return words.get(results.status.code, "no stop")


def _touch(results: Results) -> float:
    """Instant (s) of the snapshot at touch, else of the first row."""
    for shot in results.snapshots:
        if shot.label == "touch":
            return shot.time
    return float(results["time_s"][0])


def _hinges(results: Results) -> list[str]:
    """Names of the hinges, in the order of the columns."""
    names = {column.name for column in results.columns}
    angles = [column.name for column in results.columns if column.name.endswith("_angle_deg")]
    return [name.removesuffix("_angle_deg") for name in angles if name.replace("_angle_deg", "_rate_rad_s") in names]


def _rates(axes: Axes, results: Results, time: Array, hinges: dict[str, str]) -> None:
    """Rates of the hinges (name -> colour) and, over them, the mean rate; one curve where the two are the same."""
    has_mean = any(column.name == "mean_rate_rad_s" for column in results.columns)
    mean = results["mean_rate_rad_s"] if has_mean else None
    axes.axhline(0, color=FAINT, linewidth=0.5)
    for name, colour in hinges.items():
        rate = results[f"{name}_rate_rad_s"]
        if mean is not None and _largest(rate - mean) <= 2e-3 * _largest(rate):
            _curve(axes, time, rate, colour, f"at {name}, equal to the mean")
            mean = None
        elif mean is not None and len(hinges) == 1:
            _curve(axes, time, rate, SKY, f"at {name}", linewidth=0.6)
        else:
            _curve(axes, time, rate, colour, f"at {name}")
    if mean is not None:
        _curve(axes, time, mean, INK if len(hinges) > 1 else BLUE, "mean (angular momentum / inertia)")


def _imbalance(axes: Axes, results: Results, time: Array) -> None:
    """What the total changes by, on its own scale."""
    values = results["energy_imbalance_J"]
    unit = unit_for(values, "J")
    axes.axhline(0, color=FAINT, linewidth=0.5)
    _curve(axes, time, values * unit.factor, INK, linewidth=0.8)
    _finish(axes, f"imbalance ({unit.name})")


# --- the mechanism -------------------------------------------------------------------------------------------------

PIVOT: dict[str, Any] = {
    "marker": "o",
    "markersize": 4.5,
    "markerfacecolor": "white",
    "markeredgecolor": INK,
    "markeredgewidth": 0.9,
    "linestyle": "none",
}


@dataclass(frozen=True)
class View:
    """A window on the plane: lower left corner, width and height (m, world frame)."""

    title: str
    left: float
    bottom: float
    width: float
    height: float

    def grown(self, share: float) -> View:
        """The view with a margin all around, a share of its larger side."""
        margin = share * max(self.width, self.height)
        wide, high = self.width + 2 * margin, self.height + 2 * margin
        return replace(self, left=self.left - margin, bottom=self.bottom - margin, width=wide, height=high)

    def filling(self, aspect: float) -> View:
        """The smallest view around this one whose width is `aspect` times its height."""
        width, height = max(self.width, self.height * aspect), max(self.height, self.width / aspect)
        left, bottom = self.left - (width - self.width) / 2, self.bottom - (height - self.height) / 2
        return replace(self, left=left, bottom=bottom, width=width, height=height)


@dataclass(frozen=True)
class Panel:
    """Axes and the view that fills them."""

    axes: Axes
    view: View

    def showing(self, other: View) -> Panel:
        """The same axes with a view that takes in the other view too."""
        view = self.view
        left, bottom = min(view.left, other.left), min(view.bottom, other.bottom)
        right = max(view.left + view.width, other.left + other.width)
        top = max(view.bottom + view.height, other.bottom + other.height)
        both = replace(view, left=left, bottom=bottom, width=right - left, height=top - bottom)
        return Panel(self.axes, view if both == view else both.grown(0.03).filling(view.width / view.height))


def edge(outline: Outline) -> Array:
    """Closed edge (m, 2) m of a bar: its centre line moved to either side by half the diameter; a disc's is a ring."""
    points, radius = outline.points, outline.diameter / 2
    if len(points) == 1:
        turn = np.linspace(0, 2 * np.pi, 65)[:-1]
        return np.asarray(points + radius * np.column_stack([np.cos(turn), np.sin(turn)]))
    tangent = np.gradient(points, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-300)
    normal = radius * np.column_stack([-tangent[:, 1], tangent[:, 0]])
    return np.concatenate([points + normal, (points - normal)[::-1]])


def _whole_view(results: Results) -> View:
    """Everything drawn, and a strip of sand under it."""
    points = np.concatenate([edge(outline) for shot in results.snapshots for outline in shot.outlines])
    low, high = points.min(axis=0), points.max(axis=0)
    size = max(float(np.max(high - low)), 1e-9)
    if results.surface is not None and results.surface > low[1] - 2 * size:
        low[1] = min(low[1], results.surface - 0.05 * size)
        high[1] = max(high[1], results.surface)
    return View("mechanism", low[0], low[1], high[0] - low[0], high[1] - low[1]).grown(0.06)


def _tip_view(results: Results) -> View | None:
    """What is under the surface in any snapshot, with room for the dimension; None if nothing is."""
    deepest = _deepest(results)
    if results.surface is None or deepest is None:
        return None
    under = np.concatenate([_under(shot, results.surface) for shot in results.snapshots])
    if not len(under):
        return None
    low, high = under.min(axis=0), np.array([under[:, 0].max(), results.surface])
    size = float(np.max(high - low))
    left, right = low[0] - 0.15 * size, high[0] + 0.15 * size
    beside = deepest.clear + 0.7 * deepest.side * size
    left, right = min(left, beside), max(right, beside)
    return View("immersed part", left, low[1] - 0.2 * size, right - left, high[1] - low[1] + 0.55 * size)


def _dense(ring: Array) -> Array:
    """Points along a closed edge, fifty to a side."""
    share = np.linspace(0, 1, 50)[None, :, None]
    return np.asarray((ring[:, None] * (1 - share) + np.roll(ring, -1, axis=0)[:, None] * share).reshape(-1, 2))


def _views(views: list[View], legend_rows: int) -> tuple[Figure, list[Panel]]:
    """A figure with one panel a view, side by side, to the same height and as wide as the page; views fill panels."""
    left, right, top, below, gap = 12.5, 2.5, 6.0, 12.0 + LEGEND_ROW * legend_rows, 15.0  # mm
    page = DOUBLE if len(views) > 1 else SINGLE
    aspects = np.array([np.clip(view.width / view.height, 0.75, 2.2) for view in views])
    free = page - left - right - gap * (len(views) - 1)
    height = float(np.clip(free / aspects.sum(), 45, 82))
    widths = free * aspects / aspects.sum()
    figure = _figure(page, top + height + below)
    panels, at = [], left
    for i, (view, width) in enumerate(zip(views, widths, strict=True)):
        box = (at / page, below / (top + height + below), width / page, height / (top + height + below))
        axes = figure.add_axes(box)
        axes.set_title(f"({'ab'[i]}) {view.title}" if len(views) > 1 else "", loc="left", pad=3)
        panels.append(Panel(axes, view.filling(width / height)))
        at += width + gap
    return figure, panels


def _scene(axes: Axes, results: Results, unit: Unit, view: View) -> None:
    """Sand and all snapshots within `view`, to scale."""
    axes.set(xlabel=f"x ({unit.name})", ylabel=f"y ({unit.name})")
    axes.grid(False)
    axes.locator_params(nbins=6)
    for side in axes.spines.values():
        side.set_visible(True)
    if results.surface is not None and results.surface > view.bottom:
        _sand(axes, results.surface * unit.factor, view, unit)
    for shot in results.snapshots:
        for outline in shot.outlines:
            look = {**_pose(shot), "linewidth": 0.7}
            if len(outline.points) == 1:
                axes.add_patch(
                    Circle(tuple(outline.points[0] * unit.factor), outline.diameter / 2 * unit.factor, **look)
                )
            else:
                axes.add_patch(Polygon(edge(outline) * unit.factor, **look))
    axes.set_xlim(view.left * unit.factor, (view.left + view.width) * unit.factor)
    axes.set_ylim(view.bottom * unit.factor, (view.bottom + view.height) * unit.factor)
    axes.set_aspect("equal")


def _sand(axes: Axes, surface: float, view: View, unit: Unit) -> None:
    """The medium below the surface line (drawing units), strewn with grains that only look like sand."""
    left, bottom = view.left * unit.factor, view.bottom * unit.factor
    width, depth = view.width * unit.factor, surface - bottom
    axes.add_patch(Rectangle((left, bottom), width, depth, facecolor=SAND, edgecolor="none", zorder=0))
    place = np.random.default_rng(7)
    count = int(2500 * min(depth / (view.height * unit.factor), 1.0))
    for colour in GRAINS:
        x, y = left + width * place.random(count // 2), bottom + depth * place.random(count // 2)
        axes.scatter(x, y, s=place.uniform(0.05, 0.9, count // 2), color=colour, linewidths=0, zorder=1)
    axes.axhline(surface, color=SAND_EDGE, linewidth=0.9, zorder=2)


def _pose(shot: Snapshot) -> dict[str, Any]:
    """How the mechanism looks in this snapshot."""
    return POSES.get(shot.label, POSES["touch"])


def _caption(results: Results, shot: Snapshot) -> str:
    """Which snapshot, when, and the angle of the first hinge then."""
    words = f"{shot.label}: {_instant(results, shot.time)}"
    hinges = _hinges(results)
    if not hinges or not len(results.table):
        return words
    angle = np.interp(shot.time, results["time_s"], results[f"{hinges[0]}_angle_deg"])
    return f"{words}, {_minus(f'{angle:.2f}')}°"


def _pivots(results: Results) -> Array:
    """Points (k, 2) m that no snapshot moves: ground hinges; with nothing moved, the first point of a hinged model."""
    shots = [np.concatenate([outline.points for outline in shot.outlines]) for shot in results.snapshots]
    first = shots[0]
    moved = np.max([np.linalg.norm(shot - first, axis=1) for shot in shots], axis=0)
    if not moved.max() > 0:
        return first[:1] if _hinges(results) else first[:0]
    still = first[moved < 0.01 * moved.max()]
    size = float(np.max(np.ptp(first, axis=0)))
    kept: list[Array] = []
    for point in still:
        if all(np.linalg.norm(point - other) > 0.02 * size for other in kept):
            kept.append(point)
    return np.array(kept).reshape(-1, 2)


def _outline_view(axes: Axes, view: View, unit: Unit) -> None:
    """A thin frame where the enlarged view lies."""
    corner, size = np.array([view.left, view.bottom]), np.array([view.width, view.height])
    corner, size = corner * unit.factor, size * unit.factor
    axes.add_patch(Rectangle(tuple(corner), *size, fill=False, edgecolor=INK, linewidth=0.5, zorder=7))


@dataclass(frozen=True)
class Deepest:
    """The deepest point: x (m), depth (m), the side (+1 or -1 along x) with room, and where the body ends there (m)."""

    x: float
    depth: float
    side: float
    clear: float


def _deepest(results: Results) -> Deepest | None:
    """Of all snapshots, the point at the largest depth on record (on a bar's centre line or a disc's rim)."""
    depth, surface = results.summary.get("max_depth_m"), results.surface
    if surface is None or depth is None or not depth > 0 or not results.snapshots:
        return None
    found = []
    for shot in results.snapshots:
        low = [o.points if len(o.points) > 1 else o.points - (0, o.diameter / 2) for o in shot.outlines]
        points = np.concatenate(low)
        miss = np.abs(points[:, 1] - (surface - depth))
        found.append((float(miss.min()), float(points[miss.argmin(), 0]), shot))
    _, x, shot = min(found, key=lambda entry: entry[0])
    side = 1.0 if x >= np.median(np.concatenate([o.points for o in shot.outlines])[:, 0]) else -1.0
    under = _under(shot, surface)
    clear = side * float(np.max(side * under[:, 0], initial=side * x))
    return Deepest(x, float(depth), side, clear)


def _under(shot: Snapshot, surface: float) -> Array:
    """Points (k, 2) m of the edges that lie below the surface."""
    points = np.concatenate([_dense(edge(outline)) for outline in shot.outlines])
    return np.asarray(points[points[:, 1] < surface])


def _dimension_depth(axes: Axes, results: Results, unit: Unit) -> None:
    """The largest depth as a drawing dimensions it: extension line, double arrow and number beside the body."""
    deepest, surface = _deepest(results), results.surface
    if deepest is None or surface is None:
        return
    own = unit_for(np.array([deepest.depth]), "m")
    side, margin = deepest.side, 0.06 * float(np.ptp(axes.get_xlim()))
    x, at = deepest.x * unit.factor, deepest.clear * unit.factor + side * margin
    top, low = surface * unit.factor, (surface - deepest.depth) * unit.factor
    axes.plot([x, at + 0.3 * side * margin], [low, low], color=INK, linewidth=0.5, zorder=8)
    head = {"arrowstyle": "<|-|>,head_width=0.12,head_length=0.3", "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (at, top), (at, low), arrowprops={**head, "linewidth": 0.6, "color": INK}, zorder=8)
    words = f"depth\n{deepest.depth * own.factor:.2f} {own.name}"
    align: dict[str, Any] = {"ha": "left" if side > 0 else "right", "va": "center"}
    middle = (at, (top + low) / 2)
    axes.annotate(words, middle, (4 * side, 0), textcoords="offset points", zorder=9, **align)
