"""Views of the mechanism in space, from the side, the front and above, with the footprints of bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.robots import in_contact
from granular_contact.report.figures.style import DOUBLE, FLOOR, PALETTE, SAND, SAND_EDGE
from granular_contact.report.units import Array, Unit, instant, unit_for
from granular_contact.results import Results
from granular_contact.results.motion import Motion, Part, coarser

# Name, axes across and upward in the picture, axis towards the eye with its sign.
VIEWS = (("side", 0, 2, 1, -1.0), ("front", 1, 2, 0, 1.0), ("top", 0, 1, 2, 1.0))
LIGHT = np.array([-0.3, -0.5, 0.81])
POSES = (("start", "#BDBDBD", 0.55), ("deepest", "#F0A66B", 0.7), ("end", "#6FA8CC", 0.95))  # colour and opacity
MOST = 3000  # triangles drawn of a pose


def views(results: Results, motion: Motion) -> Figure:
    """Three views of the mechanism, to scale; in the one from above where bodies are in the medium."""
    parts = [coarser(part, max(60, MOST // len(motion.parts))) for part in motion.parts]
    poses = ((_when(results, motion, name), colour, alpha, name) for name, colour, alpha in POSES)
    shown = [(k, colour, alpha, name) for k, colour, alpha, name in poses if k is not None]
    drawn = [_triangles(motion, parts, k) for k, *_ in shown]
    low = np.min([one.min(axis=(0, 1)) for one in drawn], axis=0)
    high = np.max([one.max(axis=(0, 1)) for one in drawn], axis=0)
    margin = 0.08 * float(np.max(high - low))
    low, high = low - margin, high + margin
    unit = unit_for(high - low, "m")
    figure, panels = _panels(high - low)
    for axes, (name, across, up, eye, sign) in zip(panels, VIEWS, strict=True):
        if up == 2:
            _ground(axes, motion, across, low, high, unit)
        for triangles, (_, colour, alpha, _) in zip(drawn, shown, strict=True):
            _draw(axes, triangles * unit.factor, (across, up, eye, sign), colour, alpha)
        axes.set_xlim(low[across] * unit.factor, high[across] * unit.factor)
        axes.set_ylim(low[up] * unit.factor, high[up] * unit.factor)
        axes.set(aspect="equal", xlabel=f"{'xyz'[across]} ({unit.name})", ylabel=f"{'xyz'[up]} ({unit.name})")
        axes.set_title(name, loc="left")
        axes.locator_params(nbins=5)
    _footprints(panels[2], results, unit)
    handles: list[Any] = [
        Patch(color=colour, alpha=alpha, label=f"{name}: {instant(results, float(motion.time[k]))}")
        for k, colour, alpha, name in shown
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


def _when(results: Results, motion: Motion, name: str) -> int | None:
    """The picture of an instant by its name; None where it is that of another one or there is none."""
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
    """Corners (n, 3, 3) m of all triangles in a picture."""
    found = []
    for i, part in enumerate(parts):
        if part.faces is not None and len(part.faces):
            one = Motion(motion.time[k : k + 1], (part,), motion.poses[k : k + 1, i : i + 1])
            found.append(one.points(0)[0][part.faces])
    return np.concatenate(found) if found else np.zeros((1, 3, 3))


def _panels(size: Array) -> tuple[Figure, list[Axes]]:
    """Side and front view beside each other, the one from above below the first."""
    tall = [max(size[2], 0.15 * size[0]), max(size[1], 0.15 * size[0])]
    wide = [size[0], max(size[1], 0.25 * size[0])]
    height = float(np.clip((DOUBLE - 40.0) * sum(tall) / sum(wide) + 34.0, 70.0, 190.0))
    figure = blank(DOUBLE, height, layout="constrained")
    grid = figure.subplots(2, 2, width_ratios=wide, height_ratios=tall, squeeze=False)
    grid[1, 1].set_axis_off()
    return figure, [grid[0, 0], grid[0, 1], grid[1, 0]]


def _ground(axes: Axes, motion: Motion, across: int, low: Array, high: Array, unit: Unit) -> None:
    """The section through the surface in the middle of a view, with layers, floor and the walls that stand across."""
    if motion.ground is None:
        return
    x, y, z = motion.ground
    along, height = (x, z[len(y) // 2]) if across == 0 else (y, z[:, len(x) // 2])
    bottom = min(low[2], float(height.min())) - float(high[2] - low[2])
    along, bottom = along * unit.factor, bottom * unit.factor
    axes.fill_between(along, bottom, height * unit.factor, color=SAND, linewidth=0, zorder=0)
    axes.plot(along, height * unit.factor, color=SAND_EDGE, linewidth=0.8, zorder=1)
    of = motion.bedding
    for depth in of.layers:
        top = (height - depth) * unit.factor
        axes.plot(along, top, color=SAND_EDGE, linewidth=0.6, dashes=(5, 3), zorder=1)
    if of.floor is not None:
        axes.axhspan(bottom, of.floor * unit.factor, facecolor=FLOOR, linewidth=0, zorder=1)
    for axis, place in of.walls:
        if axis == across:
            axes.axvline(place * unit.factor, color=FLOOR, linewidth=1.6, zorder=1)


def _draw(axes: Axes, triangles: Array, view: tuple[int, int, int, float], colour: str, alpha: float) -> None:
    """Triangles (n, 3, 3), the farthest first, lit from above."""
    across, up, eye, sign = view
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    shade = 0.72 + 0.28 * np.abs(normal @ LIGHT)
    order = np.argsort(sign * triangles[:, :, eye].mean(axis=1))
    colours = np.clip(shade[order, None] * np.array(to_rgb(colour)), 0.0, 1.0)
    flat = triangles[order][:, :, [across, up]]
    axes.add_collection(PolyCollection(list(flat), facecolors=colours, edgecolors=colours, linewidths=0.2, alpha=alpha))


def _footprints(axes: Axes, results: Results, unit: Unit) -> None:
    """Where the centre of each body was, from above, while it was in the medium."""
    time = results["time_s"]
    for i, (body, spans) in enumerate(in_contact(results).items()):
        if f"{body}_x_m" not in results.names or len(in_contact(results)) < 2:
            continue
        for on, off in spans:
            inside = (time >= on) & (time <= off)
            x, y = (results[f"{body}_{axis}_m"][inside] * unit.factor for axis in "xy")
            axes.plot(x, y, color=PALETTE[i % len(PALETTE)], linewidth=2.0, solid_capstyle="round", zorder=5)
