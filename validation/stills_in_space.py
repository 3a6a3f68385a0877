"""Instants of a run in space: the mechanism from the right and a little above, on the surface of the sand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from granular_contact.report.figures.style import DPI, GRID, INK, SAND, SAND_EDGE, SKY, VERMILION, style
from granular_contact.results import Results
from granular_contact.results.motion import Motion

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
AZIMUTH, ELEVATION = np.radians(25.0), np.radians(20.0)  # of the view
MARGIN = 0.12  # of the size of what is shown, around it
COVER = 0.8  # how much of what is in the sand it hides
ARROW = 0.3  # of the height of a picture: the largest force
SHADE = 0.55  # of the colour where a face looks away from the light
LIGHT = np.array([0.3, -0.5, 0.81])
EVEN = 1e-5  # of the size of the ground: what is less off a plane is drawn as one, which goes on beyond the picture


def view() -> Array:
    """Rotation (3, 3): its rows point to the right and upward on the picture, and into it."""
    c, s, ce, se = np.cos(AZIMUTH), np.sin(AZIMUTH), np.cos(ELEVATION), np.sin(ELEVATION)
    return np.array([[c, s, 0.0], [-s * se, c * se, ce], [-s * ce, c * ce, -se]])


def strip(results: Results, count: int, width: int) -> Picture:
    """Pictures (h, w, 3) of `count` (even) instants, evenly spaced, as one that is about so many px wide."""
    motion = results.motion
    assert motion is not None  # which is what makes it a run in space
    ground = ground_of(motion, results.surface)
    low, high = _window(motion, ground)
    wide, tall = high - low
    in_row = 2 if wide > tall else count
    rows = count // in_row
    size = width / DPI, width / in_row * tall / wide * rows / DPI
    with style():
        figure = Figure(figsize=size, dpi=DPI, facecolor="white")
        canvas: Any = FigureCanvasAgg(figure)  # whose methods have no types
        for i, k in enumerate(np.linspace(0, len(motion.time) - 1, count).round().astype(int)):
            place = (i % in_row / in_row, 1.0 - (i // in_row + 1) / rows, 1.0 / in_row, 1.0 / rows)
            axes = figure.add_axes(place, xlim=(low[0], high[0]), ylim=(low[1], high[1]))
            axes.set_axis_off()
            axes.set_aspect("equal")
            _draw(axes, motion, int(k), ground, low, high)
        canvas.draw()
        shown: Picture = np.asarray(canvas.buffer_rgba())[..., :3].copy()
    return shown


@dataclass(frozen=True)
class Plane:
    """A level or sloped surface, which goes on beyond the picture: height (m) at the origin, rise along x and y."""

    height: float
    rise: Array

    def at(self, places: Array) -> Array:
        """Heights (n,) m at places (n, 2) m."""
        return np.asarray(self.height + places @ self.rise)

    def draw(self, axes: Any, low: Array, high: Array) -> None:
        """As a grid of lines seen aslant."""
        size = float((high - low).max())
        step = 10.0 ** np.floor(np.log10(0.4 * size))
        aslant = view()[:2, :2] + np.outer(view()[:2, 2], self.rise)
        center = np.linalg.solve(aslant, 0.5 * (low + high) - view()[:2, 2] * self.height)
        reach = 4.0 * size
        axes.fill(
            *self._seen(center + reach * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])),
            color=SAND,
            alpha=COVER,
            linewidth=0,
            zorder=2,
        )
        for axis in (0, 1):
            first, last = np.ceil((center[axis] - reach) / step), np.floor((center[axis] + reach) / step)
            for at in step * np.arange(first, last + 1):
                ends = np.empty((2, 2))
                ends[:, axis], ends[:, 1 - axis] = at, center[1 - axis] + reach * np.array([-1, 1])
                axes.plot(*self._seen(ends), color=SAND_EDGE, linewidth=0.3, alpha=0.5, zorder=3)

    def _seen(self, places: Array) -> Array:
        """Places (n, 2) m of the surface on the plane of the picture, (2, n)."""
        return view()[:2] @ np.column_stack([places, self.at(places)]).T


@dataclass(frozen=True)
class Uneven:
    """A map of heights, as far as a motion has it: heights (m) at y (rows) and x (columns)."""

    x: Array
    y: Array
    z: Array

    def at(self, places: Array) -> Array:
        """Heights (n,) m at places (n, 2) m, level beyond the map."""
        i, u = _between(self.x, places[:, 0])
        j, v = _between(self.y, places[:, 1])
        low, high = ((1.0 - u) * self.z[k, i] + u * self.z[k, i + 1] for k in (j, j + 1))
        return np.asarray((1.0 - v) * low + v * high)

    def draw(self, axes: Any, low: Array, high: Array) -> None:  # noqa: ARG002
        """As cells, the farthest first, lighter where they look to the light."""
        corners = np.stack([*np.meshgrid(self.x, self.y), self.z], axis=-1)
        cells = np.stack([corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]], axis=2)
        cells = cells.reshape(-1, 4, 3)
        cells = cells[np.argsort(-(cells.mean(axis=1) @ view()[2]))]
        normal = np.cross(cells[:, 2] - cells[:, 0], cells[:, 3] - cells[:, 1])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        bright = np.clip(1.0 + 0.8 * ((normal - [0.0, 0.0, 1.0]) @ LIGHT), 0.6, 1.1)
        colours = np.clip(np.array(to_rgb(SAND)) * bright[:, None], 0.0, 1.0)
        flat = cells @ view()[:2].T
        axes.add_collection(
            PolyCollection(list(flat), facecolors=colours, linewidths=0, alpha=COVER, antialiaseds=False, zorder=2)
        )
        lines = [*corners[::4], *np.moveaxis(corners, 1, 0)[::4]]
        for line in lines:
            axes.plot(*(view()[:2] @ line.T), color=SAND_EDGE, linewidth=0.3, alpha=0.5, zorder=3)


def _between(at: Array, x: Array) -> tuple[NDArray[np.int64], Array]:
    """Which of rising points come before values (n,), and how far (0 to 1) on to the next they are."""
    i = np.clip(np.searchsorted(at, x) - 1, 0, len(at) - 2)
    return i, np.clip((x - at[i]) / (at[i + 1] - at[i]), 0.0, 1.0)


def ground_of(motion: Motion, surface: Any) -> Plane | Uneven | None:
    """The surface of the sand as it is drawn; None in vacuum. surface: of the results."""
    if motion.ground is None:
        return Plane(float(surface), np.zeros(2)) if isinstance(surface, int | float) else None
    x, y, z = motion.ground
    across, along = np.meshgrid(x, y)
    columns = np.column_stack([np.ones(z.size), across.ravel(), along.ravel()])
    found = np.linalg.lstsq(columns, z.ravel())[0]
    size = float(max(np.ptp(x), np.ptp(y)))
    if np.abs(columns @ found - z.ravel()).max() < EVEN * size:
        return Plane(float(found[0]), np.asarray(found[1:], float))
    return Uneven(x, y, z)


def _window(motion: Motion, ground: Plane | Uneven | None) -> tuple[Array, Array]:
    """Lower left and upper right corner (2,) m of all pictures, on the plane of the picture."""
    points = np.concatenate([motion.points(i).reshape(-1, 3) for i in range(len(motion.parts))])
    if ground is not None:
        points = np.vstack([points, np.column_stack([points[:, :2], ground.at(points[:, :2])])])
    shown = points @ view()[:2].T
    low, high = shown.min(axis=0), shown.max(axis=0)
    margin = MARGIN * float((high - low).max())
    return low - margin, high + margin


def _draw(axes: Any, motion: Motion, k: int, ground: Plane | Uneven | None, low: Array, high: Array) -> None:
    """One instant: what is in the sand, the sand over it, then what is above."""
    corners, names = _triangles(motion, k)
    if ground is not None:
        corners, names = parted(corners, names, ground)
    middle = corners.mean(axis=1)
    buried = np.zeros(len(corners), bool) if ground is None else middle[:, 2] < ground.at(middle[:, :2])
    order = np.argsort(-(middle @ view()[2]))
    colours = _colours(corners, names)
    for chosen, height in ((buried, 1), (~buried, 4)):
        kept = order[chosen[order]]
        flat = corners[kept] @ view()[:2].T
        axes.add_collection(
            PolyCollection(
                list(flat), facecolors=colours[kept], edgecolors=colours[kept], linewidths=0.2, zorder=height
            )
        )
    if ground is not None:
        ground.draw(axes, low, high)
    for point, force in _arrows(motion, k, float(high[1] - low[1])):
        head = dict(
            arrowstyle="-|>,head_width=0.15,head_length=0.3", color=VERMILION, linewidth=1.0, shrinkA=0, shrinkB=0
        )
        axes.annotate("", point + force, point, arrowprops=head, zorder=6)
    words = f"{motion.time[k]:.2f} s"
    axes.text(0.03, 0.95, words, transform=axes.transAxes, va="top", color=INK)


def parted(corners: Array, parts: list[int], ground: Plane | Uneven) -> tuple[Array, list[int]]:
    """Triangles (n, 3, 3) m cut where they go through the surface, and the part of each."""
    above = corners[:, :, 2] - ground.at(corners[:, :, :2].reshape(-1, 2)).reshape(-1, 3)
    through = (above.min(axis=1) < 0.0) & (above.max(axis=1) > 0.0)
    # First the corner that is alone on its side; the cut meets both sides that begin there.
    alone = np.where((above > 0.0).sum(axis=1) == 1, above.argmax(axis=1), above.argmin(axis=1))
    turned = (alone[:, None] + np.arange(3)) % 3
    (a, b, c), (za, zb, zc) = (
        np.moveaxis(np.take_along_axis(corners, turned[:, :, None], axis=1)[through], 1, 0),
        np.take_along_axis(above, turned, axis=1)[through].T,
    )
    ab, ac = a + (za / (za - zb))[:, None] * (b - a), a + (za / (za - zc))[:, None] * (c - a)
    pieces = [np.stack(piece, axis=1) for piece in ((a, ab, ac), (ab, b, c), (ab, c, ac))]
    own = np.asarray(parts, int)
    return np.concatenate([corners[~through], *pieces]), [*own[~through].tolist(), *np.tile(own[through], 3).tolist()]


def _triangles(motion: Motion, k: int) -> tuple[Array, list[int]]:
    """Triangles (n, 3, 3) m of all parts at an instant, and the part of each."""
    found, parts = [np.zeros((0, 3, 3))], list[int]()
    for i, part in enumerate(motion.parts):
        if part.faces is not None and len(part.faces):
            found.append(motion.points(i)[k][part.faces])
            parts += [i] * len(part.faces)
    return np.concatenate(found), parts


def _colours(corners: Array, parts: list[int]) -> Array:
    """Colours (n, 3): lighter where a face looks to the light; the first part is grey, the others blue."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    bright = SHADE + (1.0 - SHADE) * 0.5 * (1.0 + normal @ (LIGHT / np.linalg.norm(LIGHT)))
    own = np.array([to_rgb(GRID) if i == 0 else to_rgb(SKY) for i in parts]).reshape(-1, 3)
    return np.asarray(np.clip(own * bright[:, None], 0.0, 1.0))


def _arrows(motion: Motion, k: int, height: float) -> list[tuple[Array, Array]]:
    """Where forces of the medium act and how far their arrows reach, on the plane of the picture (2,) m."""
    largest = max(
        (float(np.linalg.norm(np.nan_to_num(f), axis=1).max()) for _, f in motion.forces.values()), default=0.0
    )
    found = []
    for at, force in motion.forces.values():
        if largest > 0.0 and np.linalg.norm(np.nan_to_num(force[k])) > 0.02 * largest:
            found.append((view()[:2] @ at[k], view()[:2] @ force[k] * ARROW * height / largest))
    return found
