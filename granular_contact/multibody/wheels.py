"""What wheels have in their results: slip, sinkage, drawbar pull, load, torque and efficiency.

Slip and pull are along the surface below the axle, load and sinkage at right angles to it, as if the surface went on
straight from there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from granular_contact.multibody.kinematics import Kinematics
from granular_contact.multibody.mechanism import label
from granular_contact.results import series
from granular_contact.results.energy import accumulate
from granular_contact.scene.types import Vector, Wheel

STANDS = 1e-5  # m/s: below it, in rim and axle, there is no slip
STEADY = 0.5  # the last part of the path, over which means are taken


def _wheels(motion: Kinematics) -> Iterator[tuple[str, Wheel]]:
    """Bodies with a wheel, each with its first one."""
    for body in motion.scene.rigid:
        wheel = next((shape.wheel for shape in body.shapes if shape.wheel is not None), None)
        if wheel is not None:
            yield body.name, wheel


def wheel_histories(motion: Kinematics, forces: Mapping[str, Vector]) -> dict[str, dict[str, Vector]]:
    """Histories (n,) of each wheel that the medium acts on, by its label.

    forces: of the medium by body, (n, 3): x, y (N) and moment about the origin (N m, counter-clockwise). v: speed (m/s)
    of the axle along the surface, to the right; omega: rate (rad/s) of the wheel, as it rolls to the right.
    """
    found, bed = {}, motion.scene.bed
    for name, wheel in _wheels(motion):
        if name not in forces or bed is None:
            continue
        (p, v), spin = motion.position(name, wheel.axle), motion.angle(name, wheel.axle)[1]
        tangent = tangents(bed.slope_at(p[:, 0]))
        speed, rim = np.sum(v * tangent, axis=1), -wheel.radius * spin
        faster = np.maximum(np.abs(speed), np.abs(rim))
        moves = faster > STANDS
        slip = np.divide(rim - speed, faster, out=np.zeros_like(rim), where=moves)
        backward = moves & (np.where(np.abs(rim) > np.abs(speed), rim, speed) < 0.0)
        (ahead, upward), cosine = components(forces[name], tangent), tangent[:, 0]
        found[label(name)] = {
            "v": speed,
            "omega": -spin,
            "slip": np.where(backward, -slip, slip),
            "sinkage_m": wheel.rim - (p[:, 1] - bed.height(p[:, 0])) * cosine,
            "drawbar_pull_N": np.where(backward, -ahead, ahead),
            "load_N": upward,
            "torque_Nm": -series.clockwise_moment(forces[name], p),
        }
    return found


def tangents(slope: Vector) -> Vector:
    """Unit vectors (n, 2) along a surface with slopes (n,), to the right."""
    along = np.column_stack([np.ones_like(slope), slope])
    found: Vector = along / np.hypot(1.0, slope)[:, None]
    return found


def components(force: Vector, tangent: Vector) -> tuple[Vector, Vector]:
    """Parts (n,) of forces (n, 2 or more), x and y first, along unit tangents (n, 2) and along the normals upward."""
    (x, y), (tx, ty) = force[:, :2].T, tangent.T
    return x * tx + y * ty, y * tx - x * ty


def wheel_columns(histories: Mapping[str, Mapping[str, Vector]]) -> series.Series:
    """Columns of all wheels."""
    columns: series.Series = {}
    for name, one in histories.items():
        words = {
            "slip": f"slip of {name}: 1 - v / (r omega) where its rim is faster than its axle, else r omega / v - 1",
            "sinkage_m": f"depth of the rim of {name} below the surface, at right angles to it",
            "drawbar_pull_N": f"force of the medium on {name} along the surface, ahead in the direction of travel",
            "load_N": f"force of the medium on {name} at right angles to the surface, upward",
            "torque_Nm": f"torque about its axle that the medium takes from {name}, clockwise positive",
        }
        columns |= {f"{name}_{key}": (text, one[key]) for key, text in words.items()}
        pulled, driven = one["drawbar_pull_N"] * np.abs(one["v"]), one["torque_Nm"] * one["omega"]
        share = np.divide(pulled, driven, out=np.zeros_like(pulled), where=(driven > 0.0) & (pulled > 0.0))
        words_of_share = f"pull times speed over torque times rate of {name}; 0 where it is braked or does not pull"
        columns[f"{name}_efficiency"] = (words_of_share, share)
    return columns


def wheel_numbers(time: Vector, histories: Mapping[str, Mapping[str, Vector]]) -> dict[str, Any]:
    """Means over the last half of the path of each wheel: of the first under `wheel`, of others under their labels.

    efficiency: work of the pull over work of the torque there; None where the wheel is braked or does not pull.
    """
    numbers = {}
    for i, (name, one) in enumerate(histories.items()):
        path = accumulate(time, np.maximum(np.abs(one["v"]), np.abs(one["omega"])))
        start = float(np.interp((1.0 - STEADY) * path[-1], path, time)) if path[-1] > 0.0 else float(time[0])

        def mean(values: Vector, start: float = start) -> float:
            total = accumulate(time, values)
            lasted = float(time[-1]) - start
            return float((total[-1] - np.interp(start, time, total)) / lasted) if lasted > 0.0 else float(values[-1])

        keys = ("slip", "sinkage_m", "drawbar_pull_N", "load_N", "torque_Nm")
        found: dict[str, float | None] = {key: mean(one[key]) for key in keys}
        pulled, driven = mean(one["drawbar_pull_N"] * np.abs(one["v"])), mean(one["torque_Nm"] * one["omega"])
        found["efficiency"] = pulled / driven if pulled > 0.0 and driven > 0.0 else None
        numbers["wheel" if i == 0 else f"wheel_{name}"] = found
    return numbers
