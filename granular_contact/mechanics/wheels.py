"""Columns and numbers of wheels in results: slip, sinkage, drawbar pull, load, torque and efficiency.

Slip and pull are tangential to the surface below the axle, load and sinkage normal to it, as if the surface were the
tangent plane there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.mechanism import label
from granular_contact.results import series
from granular_contact.results.accuracy import AccuracyWarning, share
from granular_contact.results.energy import accumulate
from granular_contact.scene.types import Scene, Vector

STANDS = 1e-5  # m/s: slip is zero where rim and axle are both slower
STEADY = 0.5  # last share of the path, over which means are taken
MEANS = ("slip", "sinkage_m", "drawbar_pull_N", "load_N", "torque_Nm", "side_force_N", "slip_angle_deg")
# Slip angle (degrees) and slip beyond which measured wheels differ much from all laws: docs/howto/media.md.
STEERED, BRAKED = 5.0, -0.6
UNSTEADY = 5e-3  # change within that part from which a warning is given; a slower decay has at most 1 % to go


def wheel_histories(motion: Kinematics, forces: Mapping[str, Vector]) -> dict[str, dict[str, Vector]]:
    """Histories (n,) of each wheel that the medium acts on, by its label.

    forces: of the medium by body, (n, 3): x, y (N) and moment about the origin (N m, counter-clockwise). v: speed (m/s)
    of the axle along the surface, to the right; omega: rate (rad/s) of the wheel, positive where it rolls to the right.
    """
    histories, bed = {}, motion.scene.bed
    for body in motion.scene.rigid:
        name, wheel = body.name, body.wheel
        if wheel is None or name not in forces or bed is None:
            continue
        (p, v), spin = motion.position(name, wheel.axle), motion.angle(name, wheel.axle)[1]
        tangent = tangents(bed.slope_at(p[:, 0]))
        speed, rim = np.sum(v * tangent, axis=1), -wheel.radius * spin
        slip, backward = sense(speed, rim)
        (ahead, upward), cosine = components(forces[name], tangent), tangent[:, 0]
        histories[label(name)] = {
            "v": speed,
            "omega": -spin,
            "slip": slip,
            "sinkage_m": wheel.rim - (p[:, 1] - bed.height(p[:, 0])) * cosine,
            "drawbar_pull_N": np.where(backward, -ahead, ahead),
            "load_N": upward,
            "torque_Nm": -series.clockwise_moment(forces[name], p),
        }
    return histories


def sense(speed: Vector, rim: Vector) -> tuple[Vector, NDArray[np.bool_]]:
    """Slip (n,) from the speeds (n,) m/s of axle and rim, and whether the wheel travels backward (n,)."""
    faster = np.maximum(np.abs(speed), np.abs(rim))
    moves = faster > STANDS
    slip = np.divide(rim - speed, faster, out=np.zeros_like(rim), where=moves)
    backward = moves & (np.where(np.abs(rim) > np.abs(speed), rim, speed) < 0.0)
    return np.where(backward, -slip, slip), backward


def tangents(slope: Vector) -> Vector:
    """Unit vectors (n, 2) along a surface with slopes (n,), to the right."""
    along = np.column_stack([np.ones_like(slope), slope])
    units: Vector = along / np.hypot(1.0, slope)[:, None]
    return units


def components(force: Vector, tangent: Vector) -> tuple[Vector, Vector]:
    """Components (n,) of forces (n, 2 or more; x, y first) along unit tangents (n, 2) and along the upward normals."""
    (x, y), (tx, ty) = force[:, :2].T, tangent.T
    return x * tx + y * ty, y * tx - x * ty


def add_wheels(fields: dict[str, Any], histories: Mapping[str, Mapping[str, Vector]]) -> None:
    """Add columns, numbers and warnings of wheels to the fields of an observation; histories: by label."""
    pitches = {label(body.name): body.wheel.pitch for body in fields["scene"].rigid if body.wheel is not None}
    numbers = wheel_numbers(fields["time"], histories, pitches)
    fields["motion"] |= wheel_columns(histories)
    fields["more"] |= numbers
    fields["accuracy"] += wheel_warnings(fields["scene"], numbers)
    fields["notices"] += tuple(uncompared(numbers))


def wheel_columns(histories: Mapping[str, Mapping[str, Vector]]) -> series.Series:
    """Columns of all wheels."""
    columns: series.Series = {}
    for name, history in histories.items():
        texts = {
            "slip": f"slip of {name}: 1 - v / (r omega) where its rim is faster than its axle, else r omega / v - 1",
            "sinkage_m": f"depth of the rim of {name} below the surface, at right angles to it",
            "drawbar_pull_N": f"force of the medium on {name} along the surface, ahead in the direction of travel",
            "load_N": f"force of the medium on {name} at right angles to the surface, upward",
            "torque_Nm": f"torque about its axle that the medium takes from {name}, positive where it drives ahead",
            "side_force_N": f"force of the medium on {name} along the surface, to the left of where it rolls",
            "slip_angle_deg": f"angle from where {name} rolls to where its axle moves along the surface, to the left",
        }
        columns |= {f"{name}_{key}": (text, history[key]) for key, text in texts.items() if key in history}
        pulled, driven = history["drawbar_pull_N"] * np.abs(history["v"]), history["torque_Nm"] * history["omega"]
        share = np.divide(pulled, driven, out=np.zeros_like(pulled), where=(driven > 0.0) & (pulled > 0.0))
        text = f"pull times speed over torque times rate of {name}; 0 where it is braked or does not pull"
        columns[f"{name}_efficiency"] = (text, share)
    return columns


def wheel_numbers(
    time: Vector, histories: Mapping[str, Mapping[str, Vector]], pitches: Mapping[str, float]
) -> dict[str, Any]:
    """Means over the last half of the path of each wheel: the first one under `wheel`, others under their labels.

    pitches (rad, by label): angles between grousers, 0 for smooth wheels; means are over whole pitches. efficiency:
    work of the pull over work of the torque in that time; None where the wheel is braked or does not pull. Changes are
    from the mean of the first half of that time to the mean of the second half: of the sinkage relative to the sinkage,
    of the pull relative to the load.
    """
    numbers = {}
    for i, (name, history) in enumerate(histories.items()):
        start, middle, later = _window(time, history, pitches[name])
        mean = partial(_mean, time, start, float(time[-1]))
        means: dict[str, float | None] = {key: mean(history[key]) for key in MEANS if key in history}
        pulled = mean(history["drawbar_pull_N"] * np.abs(history["v"]))
        driven = mean(history["torque_Nm"] * history["omega"])
        means["efficiency"] = pulled / driven if pulled > 0.0 and driven > 0.0 else None
        scales = {"sinkage_m": "sinkage_change", "drawbar_pull_N": "pull_change_over_load"}
        for key, change in scales.items():
            scale = abs(mean(history["sinkage_m" if key == "sinkage_m" else "load_N"]))
            difference = _mean(time, later, float(time[-1]), history[key]) - _mean(time, start, middle, history[key])
            means[change] = difference / scale if scale > 0.0 else None
        numbers["wheel" if i == 0 else f"wheel_{name}"] = means
    return numbers


def _window(time: Vector, history: Mapping[str, Vector], pitch: float) -> tuple[float, float, float]:
    """Times (s) at which the last half of a path begins, its first part ends and its second begins.

    All three are whole pitches (rad) from the end, if there are any.
    """
    path = accumulate(time, np.maximum(np.abs(history["v"]), np.abs(history["omega"])))
    if not path[-1] > 0.0:
        return float(time[0]), float(time[0]), float(time[0])
    start, middle = (float(np.interp(share * path[-1], path, time)) for share in (1.0 - STEADY, 1.0 - 0.5 * STEADY))
    turned = accumulate(time, np.abs(history["omega"]))
    whole = math.floor((turned[-1] - np.interp(start, time, turned)) / pitch + 1e-9) if pitch > 0.0 else 0
    if whole < 1:
        return start, middle, middle
    half = pitch * max(1, whole // 2)
    ends = (turned[-1] - pitch * whole, turned[-1] - pitch * whole + half, turned[-1] - half)
    start, middle, later = (float(np.interp(angle, turned, time)) for angle in ends)
    return start, middle, later


def _mean(time: Vector, start: float, end: float, values: Vector) -> float:
    """Mean of values (n,) between two times (s)."""
    total = accumulate(time, values)
    whole = float(np.interp(end, time, total) - np.interp(start, time, total))
    return whole / (end - start) if end > start else float(np.interp(end, time, values))


def uncompared(numbers: Mapping[str, Any]) -> Iterator[str]:
    """Yield a sentence for each wheel beyond the range in which laws were compared with measurements."""
    text = "outside the range in which laws were compared with wheels: {} {}, {}; see docs/howto/media.md"
    for name, means in numbers.items():
        if name.partition("_")[0] != "wheel":
            continue
        if abs(turned := means.get("slip_angle_deg") or 0.0) > STEERED:
            off = "measured side forces differ by a fifth to a half or more"
            yield text.format(name, f"has a slip angle of {abs(turned):.0f} degrees", off)
        if means["slip"] < BRAKED:
            off = "measured force and sinkage of a locked one are up to twice as large"
            yield text.format(name, f"has a slip of {means['slip']:.2f}", off)


def wheel_warnings(scene: Scene, numbers: Mapping[str, Any]) -> Iterator[AccuracyWarning]:
    """Yield a sentence if the wheel of a wheel test is not steady; numbers: of `wheel_numbers`."""
    means, test = numbers.get("wheel"), scene.wheel_test
    if means is None or test is None or any(medium.scatters for medium in scene.media):
        return
    sinks, pulls = (abs(means[key] or 0.0) for key in ("sinkage_change", "pull_change_over_load"))
    if max(sinks, pulls) > UNSTEADY:
        text = "the wheel is not steady: within the last half of its path its sinkage changed by "
        text += f"{share(sinks)}, and its pull by {share(pulls)} of the load; take a longer solver.end_time_s "
        text += f"(now {scene.solver.end_time_s:g})"
        yield AccuracyWarning(text + ("" if test.rate is not None else ", if this torque has a steady motion at all"))
