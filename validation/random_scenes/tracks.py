"""Differences between two runs of a scene: of the motion of all bodies, and of the numbers of the summaries."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry import rotations

Tree = dict[str, Any]
Vector = NDArray[np.float64]


MOST_TURN = 0.5  # rad within a step; a cubic through both ends is off by its fourth power over 384


@dataclass(frozen=True)
class Track:
    """Motion of all bodies since the start.

    time (n,) s; place (n, k) m: in the plane the displacements in x and y of every body and its rotation times its
    radius, in space the displacements of its centre, and of the ends of its axes relative to the centre, with axes as
    long as the radius; rate (n, k) m/s; signs (k,): factors of the mirror image; way: longest path length, m; turn:
    greatest rotation of a body in space within a step, rad.
    """

    time: Vector
    place: Vector
    rate: Vector
    signs: Vector
    way: float
    turn: float = 0.0


def track(results: Any, tree: Tree, least_path: float) -> Track:
    """Track of a run; least_path: lower limit of the path length, m."""
    if tree["model"].get("in_space"):
        return _in_space(results, tree, least_path)
    columns = [*_bodies(results, tree)] or [*_pivot(results, tree)]
    place, rate = (np.column_stack([column[i] for column in columns]) for i in (0, 1))
    place = place - place[0]
    lengths = [float(np.abs(np.diff(place[:, i])).sum()) for i in range(place.shape[1])]
    bodies = [math.hypot(*lengths[i : i + 2]) + sum(lengths[i + 2 : i + 3]) for i in range(0, len(lengths), 3)]
    return Track(results["time_s"], place, rate, np.array([column[2] for column in columns]), max(least_path, *bodies))


def _in_space(results: Any, tree: Tree, least_path: float) -> Track:
    """Track of a run in space, rotated back about the vertical by the angle that `images_in_space.turned` recorded."""
    back = rotations.of_rpy([0.0, 0.0, -math.radians(tree.get("aside", {}).get("turned_deg", 0.0))])
    points, rates, longest, turn = [], [], least_path, 0.0
    for name, body in sorted(tree["model"]["bodies"].items()):
        place, velocity, spin = (
            np.column_stack([results[f"{name}_{column}"] for column in columns]) @ back.T
            for columns in (
                ("x_m", "y_m", "z_m"),
                ("vx_m_s", "vy_m_s", "vz_m_s"),
                ("spin_x_rad_s", "spin_y_rad_s", "spin_z_rad_s"),
            )
        )
        rpy = np.radians(np.column_stack([results[f"{name}_{angle}_deg"] for angle in ("roll", "pitch", "yaw")]))
        axes = reach(body) * np.array([back @ rotations.of_rpy(angles) for angles in rpy])
        arms = [axes[:, :, i] for i in range(3)]
        ends = [place, *(place + arm for arm in arms)]
        longest = max(longest, *(float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) for path in ends))
        turn = max(turn, float((np.diff(results["time_s"]) * np.linalg.norm(spin, axis=1)[1:]).max(initial=0.0)))
        points += [place, *arms]
        rates += [velocity, *(np.cross(spin, arm) for arm in arms)]
    place = np.column_stack(points)
    signs = np.array([1.0, -1.0, 1.0])
    mirror = np.tile(np.concatenate([signs, signs, -signs, signs]), len(points) // 4)
    return Track(results["time_s"], place - place[0], np.column_stack(rates), mirror, longest, turn)


def _bodies(results: Any, tree: Tree) -> Iterator[tuple[Vector, Vector, float]]:
    names = {column.name for column in results.columns}
    for name, body in sorted(tree["model"]["bodies"].items()):
        turn = next((column for column in (f"{name}_orientation_deg", f"{name}_angle_deg") if column in names), None)
        if f"{name}_x_m" not in names or turn is None:
            continue
        lever = reach(body)
        yield results[f"{name}_x_m"], results[f"{name}_vx_m_s"], -1.0
        yield results[f"{name}_y_m"], results[f"{name}_vy_m_s"], 1.0
        yield lever * np.radians(results[turn]), lever * results[f"{name}_spin_rad_s"], -1.0


def _pivot(results: Any, tree: Tree) -> Iterator[tuple[Vector, Vector, float]]:
    lever = max(reach(body) for body in tree["model"]["bodies"].values())
    yield lever * np.radians(results["pivot_angle_deg"]), lever * results["pivot_rate_rad_s"], -1.0


def reach(body: Tree) -> float:
    """Estimate of the radius (m) of a body about its origin."""
    if body["type"] == "link":
        return float(body["length_m"])
    most = 0.01
    for shape in body.get("shapes", []):
        points = [shape[key] for key in ("start_m", "end_m", "center_m") if key in shape] + shape.get("points_m", [])
        size = shape.get("radius_m", 0.5 * max(shape.get("length_m", 0.0), shape.get("diameter_m", 0.0)))
        size = max(size, 0.5 * math.hypot(*shape.get("size_m", ())))
        most = max(most, size + max((math.hypot(*point) for point in points), default=0.0))
    return most


def apart(first: Track, other: Track, mirror: bool = False) -> float:
    """Greatest difference of two tracks at the instants of the first, over the path length of the second.

    NaN if the second has other instants and turns by more than MOST_TURN between them, which no cubic represents.
    """
    end = min(first.time[-1], other.time[-1])
    common = first.time <= end * (1.0 + 1e-12)
    if other.turn > MOST_TURN and not np.array_equal(first.time, other.time):
        return math.nan
    at = _between(other, first.time[common])
    place = first.place[common] * (first.signs if mirror else 1.0)
    return float(np.abs(place - at).max()) / other.way


def _between(track: Track, at: Vector) -> Vector:
    """Positions at other instants by cubic Hermite interpolation."""
    time = track.time
    if len(time) == len(at) and np.array_equal(time, at):
        return track.place
    k = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(time) - 2)
    h = (time[k + 1] - time[k])[:, None]
    s = np.clip((at - time[k])[:, None] / h, 0.0, 1.0)
    a, b, va, vb = track.place[k], track.place[k + 1], track.rate[k] * h, track.rate[k + 1] * h
    between: Vector = a + s * (va + s * (3.0 * (b - a) - 2.0 * va - vb + s * (2.0 * (a - b) + va + vb)))
    return between


STRAIN = 1e-3  # of links: differences of smaller strains count relative to it
LEFT_OUT = ("cost", "versions", "warnings", "name", "message", "status", "static_turns")


def numbers(summary: Tree, prefix: str = "") -> Iterator[tuple[str, float]]:
    """Generate the numbers of a summary with their dotted keys, without those about the run itself."""
    for key, value in summary.items():
        if key in LEFT_OUT or key.startswith("imbalance"):
            continue
        if isinstance(value, dict):
            yield from numbers(value, f"{prefix}{key}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield f"{prefix}{key}", float(value)


def summaries_apart(first: Any, other: Any, own: Track, size: float, weight: float) -> tuple[float, str]:
    """Greatest difference of two summaries, each number relative to its scale in the run; and the key of that number.

    own: track of the first run; size: length of the rotating parts, m; weight: N. The scale of energies is at least the
    work of the weight over the path length. The scale of a cost of transport follows from those of the work and the
    distance of which it is the ratio. Pull and slip of a wheel can be near zero: their scales are the weight, and 1.
    Instants are compared by the motion between them: the difference is at most the relative distance that a body moves
    from one instant to the other. Instants and places of maxima are skipped, as two peaks can be equally high; so are
    facets, which each run chooses by itself. The scale of strains is at least STRAIN, and that of stresses belongs to
    it: steps are chosen by the error of positions, and do not resolve the vibration of a link that hardly bends.
    """
    of_first, of_second = dict(numbers(first.summary)), dict(numbers(other.summary))
    end = max(float(first["time_s"][-1]), float(other["time_s"][-1]))
    energy = max([weight * own.way, *(abs(value) for key, value in of_first.items() if key.endswith("_J"))])
    distance = max(1e-9 * own.way, abs(of_first.get("forward_speed_m_s", 0.0)) * end)
    scales = {
        "cost_of_transport": energy / (weight * distance) * max(1.0, own.way / distance),
        "_J": energy,
        "_m_s": own.way / end,
        "_m": own.way,
        "_deg": math.degrees(own.way / size),
        "_rad_s": own.way / size / end,
        "_W": energy / end,
        "_s": end,
    }
    worst = 0.0, ""
    for key in of_first.keys() & of_second.keys():
        of_maximum = key.startswith(("max_", "links.")) and key.endswith(("time_s", "place_m"))
        if key.startswith("facets.") or of_maximum:
            continue
        scale = next((value for tail, value in scales.items() if key.endswith(tail)), 0.0)
        if key.endswith(("strain", "stress_Pa")):
            strain = of_second.get(key.replace("stress_Pa", "strain"), 0.0)
            scale = STRAIN * (of_second[key] / strain if strain else 1.0)
        # A peak of power can be many times the mean, which is energy over time.
        itself = not scale or key.startswith("links.") or "largest_" in key
        if key.startswith("wheel.") and not scale:  # scale of forces: the weight; of slip and ratios: 1
            scale = weight if key.endswith("_N") else 1.0
        scale = max(scale, abs(of_second[key]) if itself else 0.0, 1e-300)
        off = abs(of_first[key] - of_second[key]) / scale
        if key.endswith("time_s"):
            off = min(off, moved(own, of_first[key], of_second[key]))
        worst = max(worst, (off, key))
    return worst


def moved(track: Track, begin: float, end: float) -> float:
    """Greatest displacement of a body between two instants (s), over the path length."""
    instants = np.clip([begin, end], track.time[0], track.time[-1])
    first, last = _between(track, instants)
    return float(np.abs(last - first).max()) / track.way
