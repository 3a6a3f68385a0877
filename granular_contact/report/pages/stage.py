"""Stage of the player in the plane: the mechanism, the sand and its surface as SVG, which scripts move.

Without scripts it shows one instant. Lengths are px of the stage before zooming, y upward, because browsers do not draw
lengths of micrometres given in metres.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.report.pages.folder import Bed
from granular_contact.report.units import Array, round_below, sized
from granular_contact.results.frames import surface_height, take_in
from granular_contact.results.motion import Motion, scaled

WIDTH, FLATTEST, TALLEST = 960.0, 0.42, 0.75  # px; height to width
MARGIN = 0.07  # of the width
BEYOND = 6.0  # widths of the stage that sand goes on to either side
USUAL_ARROW, LONGEST_ARROW = 0.2, 0.45  # of the height: of the force that a tenth exceeds, and of any


def stage(motion: Motion, bed: Bed, shown: int, path: Array) -> dict[str, Any]:
    """Values for the template and the scripts; shown: index of the picture that is visible without scripts.

    path: (rows, 2) m, of the tip or of a body. The entry `motion` is the motion in px.
    """
    drawn = [motion.points(i) for i in range(len(motion.parts))]
    reach = [0.5 * part.diameter for part in motion.parts]
    low = np.min([points.min(axis=(0, 1)) - r for points, r in zip(drawn, reach, strict=True)], axis=0)
    high = np.max([points.max(axis=(0, 1)) + r for points, r in zip(drawn, reach, strict=True)], axis=0)
    take_in(bed.surface, low, high, 0.15)
    wide, tall = np.maximum(high - low, 1e-12)
    across = WIDTH * (1 - 2 * MARGIN)
    height = float(np.clip(across * tall / wide + 2 * MARGIN * WIDTH, FLATTEST * WIDTH, TALLEST * WIDTH))
    scale = min(across / wide, (height - 2 * MARGIN * WIDTH) / tall)
    left, bottom = scale * (low + high) / 2 - (WIDTH / 2, height / 2)
    usual, length = _usual(motion), round_below(0.2 * WIDTH / scale)
    seen = scaled(motion, scale)
    return {
        "width": WIDTH,
        "height": height,
        "left": left,
        "top": bottom + height,
        "motion": seen,
        "parts": [_part(seen, i, scale * points[shown]) for i, points in enumerate(drawn)],
        "sand": _sand(bed.scaled(scale), left, bottom),
        "path": _line(_thinned(scale * path, 0.3)) if len(path) else "",
        "arrow": USUAL_ARROW * height / usual if usual > 0.0 else 0.0,
        "longest": LONGEST_ARROW * height,
        "force": _key(usual, USUAL_ARROW * height),
        "bar": {"px": length * scale, "words": sized(length, "m")},
    }


def _part(motion: Motion, index: int, now: Array) -> dict[str, Any]:
    """SVG data of a part: a disc, a bar or an area, in its own frame, or in the stage's frame if the part bends."""
    part, bends = motion.parts[index], index in motion.bent
    points = now if bends else part.points
    closed = len(points) > 3 and bool(np.allclose(points[0], points[-1], atol=1e-6))
    kind = "disc" if len(points) == 1 else "area" if closed else "bar"
    drawn = {"kind": kind, "size": part.diameter, "line": _line(points, closed)}
    return {"name": part.name, "bends": bends, "poses": motion.poses[:, index], **drawn}


def turned(pose: Array) -> str:
    """The SVG transform of a pose x, y (px), angle (rad)."""
    return f"translate({pose[0]:.7g} {pose[1]:.7g}) rotate({np.degrees(pose[2]):.6g})"


def _line(points: Array, closed: bool = False) -> str:
    """The SVG path along points (n, 2) px."""
    corners = "L".join(f"{x:.6g} {y:.6g}" for x, y in points.tolist())
    return f"M{corners}{'Z' if closed else ''}"


def _thinned(path: Array, least: float) -> Array:
    """Thin a path to points that are at least `least` px apart; the last point is kept."""
    steps = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    _, first = np.unique(np.floor(steps / least), return_index=True)
    return np.asarray(path[np.unique([*first, len(path) - 1])])


def _sand(bed: Bed, left: float, bottom: float) -> dict[str, str]:
    """Paths of the sand, its surface, layers and floor, far beyond the edges of the stage."""
    if bed.surface is None:
        return {}
    wide = BEYOND * WIDTH
    ends = np.array([left - wide, left + 2 * wide])
    x = ends
    if np.ndim(bed.surface):
        corners = np.asarray(bed.surface)[:, 0]
        x = np.unique([*ends, *corners[(corners > ends[0]) & (corners < ends[1])]])
    line = np.column_stack([x, surface_height(bed.surface, x)])
    deep = min(bottom, float(line[:, 1].min())) - 2 * wide
    under = np.vstack([[x[0], deep], line, [x[-1], deep]])
    layers = [_line(line - (0.0, depth)) for depth in bed.layers]
    floor = ""
    if bed.floor is not None:
        floor = _line(np.array([[x[0], deep], [x[0], bed.floor], [x[-1], bed.floor], [x[-1], deep]]), True)
    return {"under": _line(under, True), "surface": _line(line), "layers": "".join(layers), "floor": floor}


def _usual(motion: Motion) -> float:
    """Scale of force arrows: the 90 % quantile of all forces (N), so that a short shock does not hide the others."""
    sizes = [np.hypot(*force.T) for _, force in motion.forces.values()]
    forces = np.concatenate(sizes) if sizes else np.zeros(0)
    return float(np.quantile(forces[forces > 0.0], 0.9)) if np.any(forces > 0.0) else 0.0


def _key(usual: float, px: float) -> dict[str, Any]:
    """Key of the force arrows: a round force, with the length of its arrow (px) and a text."""
    if not usual > 0.0:
        return {}
    newton = round_below(usual)
    return {"px": px * newton / usual, "words": f"{sized(newton, 'N')} from the medium"}
