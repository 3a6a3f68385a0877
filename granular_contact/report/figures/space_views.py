"""Figure of the mechanism in space from the side, the front and above, with the footprints of bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from granular_contact.report.figures.contacts import in_contact
from granular_contact.report.figures.depth_buffer import seen
from granular_contact.report.figures.outlines import draw_bed
from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.style import DOUBLE, FLOOR, PALETTE
from granular_contact.report.units import Array, Unit, instant, unit_for
from granular_contact.results import Results
from granular_contact.results.motion import Motion, Part, coarser

# Name, axes across and upward in the picture, axis towards the eye with its sign.
VIEWS = (("side", 0, 2, 1, -1.0), ("front", 1, 2, 0, 1.0), ("top", 0, 1, 2, 1.0))
MOST_NAMED = 6  # bodies whose way in the medium has a name
POSES = (("start", "#BDBDBD", 0.6), ("deepest", "#F0A66B", 1.0), ("end", "#6FA8CC", 1.0))  # colour and opacity
APART = 0.25  # of the extent of the mechanism: poses that are nearer hide each other, and the middle one is left out
MOST = 4000  # triangles drawn of a pose
PIXELS = 5.0  # of a picture, for each mm of its panel's width


def views(results: Results, motion: Motion) -> Figure:
    """Figure of three views of the mechanism, to scale; the view from above has the footprints of bodies."""
    each = _most_of_each([0 if part.faces is None else len(part.faces) for part in motion.parts])
    parts = [coarser(part, each) for part in motion.parts]
    named = [(name, colour, alpha, _when(results, motion, name)) for name, colour, alpha in POSES]
    shown = [(name, colour, alpha, k) for name, colour, alpha, k in named if k is not None]
    drawn = [_triangles(motion, parts, k) for *_, k in shown]
    if len(shown) == len(POSES) and _hidden(drawn):
        del shown[1], drawn[1]
    low = np.min([triangles.min(axis=(0, 1)) for triangles in drawn], axis=0)
    high = np.max([triangles.max(axis=(0, 1)) for triangles in drawn], axis=0)
    margin = 0.08 * float(np.max(high - low))
    low, high = low - margin, high + margin
    unit = unit_for(high - low, "m")
    figure, panels, legend_axes = _panels(high - low)
    numbers = np.repeat(np.arange(len(parts)), [0 if part.faces is None else len(part.faces) for part in parts])
    for axes, view in zip(panels, VIEWS, strict=True):
        name, across, up, eye, sign = view
        if up == 2:
            _ground(axes, motion, across, low, high, unit)
        order = [across, up, eye]
        corners = low[order[:2]], high[order[:2]]
        left, right, bottom, top = (unit.factor * np.column_stack(corners)).ravel().tolist()
        pixels = round(PIXELS * DOUBLE * (corners[1] - corners[0])[0] / (high[0] - low[0] + high[1] - low[1]))
        for triangles, (_, colour, alpha, _) in zip(drawn, shown, strict=True):
            turned = triangles[:, :, order] * (1.0, 1.0, sign)
            picture = seen(turned, numbers, np.array(to_rgb(colour)), *corners, max(pixels, 60))
            axes.imshow(
                picture * (1.0, 1.0, 1.0, alpha),
                extent=(left, right, bottom, top),
                zorder=2,
                interpolation="antialiased",
            )
        axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
        axes.set(xlabel=f"{'xyz'[across]} ({unit.name})", ylabel=f"{'xyz'[up]} ({unit.name})")
        axes.set_title(name, loc="left")
        axes.locator_params(nbins=5)
    handles: list[Any] = [
        Patch(color=colour, alpha=alpha, label=f"{name}: {instant(results, float(motion.time[k]))}")
        for name, colour, alpha, k in shown
    ]
    legend_axes.legend(handles=handles + _footprints(panels[2], results, unit), loc="upper left", borderaxespad=0.0)
    return figure


def _most_of_each(numbers: list[int]) -> int:
    """Greatest number of triangles of a part (at least 60), so that parts with these numbers have MOST in total."""
    left, last = MOST, len(numbers)
    for k, number in enumerate(sorted(numbers)):
        if number * (last - k) > left:
            return max(60, left // (last - k))
        left -= number
    return MOST


def _hidden(drawn: list[Array]) -> bool:
    """Return whether the middle pose is too near to the first or the last one to be distinguished."""
    centres = [triangles.mean(axis=(0, 1)) for triangles in drawn]
    size = APART * float(np.max(np.ptp(drawn[0], axis=(0, 1))))
    return bool(min(np.linalg.norm(centres[1] - centres[i]) for i in (0, 2)) < size)


def _when(results: Results, motion: Motion, name: str) -> int | None:
    """Index of the picture of a named instant; None if it coincides with another one or does not exist."""
    if name == "start":
        return 0
    last = len(motion.time) - 1
    if name == "end":
        return last if last else None
    if "depth_m" not in results.names:
        return None
    k = int(np.argmin(np.abs(motion.time - results["time_s"][int(np.argmax(results["depth_m"]))])))
    return k if 0 < k < last else None


def _triangles(motion: Motion, parts: list[Part], k: int) -> Array:
    """Corners (n, 3, 3) m of all triangles at the instant with index k."""
    triangles = []
    for i, part in enumerate(parts):
        if part.faces is not None and len(part.faces):
            pose = Motion(motion.time[k : k + 1], (part,), motion.poses[k : k + 1, i : i + 1])
            triangles.append(pose.points(0)[0][part.faces])
    return np.concatenate(triangles) if triangles else np.zeros((1, 3, 3))


def _panels(size: Array) -> tuple[Figure, list[Axes], Axes]:
    """Figure with panels: side and front view, the view from above below the first, and axes for the legend."""
    tall = [max(size[2], 0.15 * size[0]), max(size[1], 0.15 * size[0])]
    wide = [size[0], max(size[1], 0.25 * size[0])]
    height = float(np.clip((DOUBLE - 40.0) * sum(tall) / sum(wide) + 34.0, 70.0, 190.0))
    figure = blank(DOUBLE, height, layout="constrained")
    grid = figure.subplots(2, 2, width_ratios=wide, height_ratios=tall, squeeze=False)
    grid[1, 1].set_axis_off()
    return figure, [grid[0, 0], grid[0, 1], grid[1, 0]], grid[1, 1]


def _ground(axes: Axes, motion: Motion, across: int, low: Array, high: Array, unit: Unit) -> None:
    """Draw the section of the surface in the middle of a view, with layers, floor and the walls normal to it."""
    if motion.ground is None:
        return
    x, y, z = motion.ground
    along, height = (x, z[len(y) // 2]) if across == 0 else (y, z[:, len(x) // 2])
    bottom = min(low[2], float(height.min())) - float(high[2] - low[2])
    draw_bed(axes, along, height, bottom, motion.bedding.layers, motion.bedding.floor, unit.factor)
    for axis, place in motion.bedding.walls:
        if axis == across:
            axes.axvline(place * unit.factor, color=FLOOR, linewidth=1.6, zorder=1)


def _footprints(axes: Axes, results: Results, unit: Unit) -> list[Any]:
    """Draw the path of the centre of each body during its contacts, from above; return lines for a legend."""
    time, handles = results["time_s"], []
    spans_of = in_contact(results)
    for i, (body, spans) in enumerate(spans_of.items()):
        if f"{body}_x_m" not in results.names or len(spans_of) < 2:
            continue
        colour = PALETTE[i % len(PALETTE)]
        for on, off in spans:
            inside = (time >= on) & (time <= off)
            x, y = (results[f"{body}_{axis}_m"][inside] * unit.factor for axis in "xy")
            axes.plot(x, y, color=colour, linewidth=2.0, solid_capstyle="round", zorder=5)
        if spans and i < MOST_NAMED:
            handles.append(Line2D([], [], color=colour, linewidth=2.0, label=f"{body} in the medium".replace("_", " ")))
    return handles
