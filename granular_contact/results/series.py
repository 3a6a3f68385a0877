"""Columns of the time series, the same for every method of solution: names, units, descriptions, signs.

All that turns is positive clockwise, angles, rates and moments alike, so that moment times rate is a power (see
models/README.md).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from granular_contact.results import CENTRAL_MOMENT, MOMENT, Column, Results
from granular_contact.values.arrays import Vector

Series = dict[str, tuple[str, Vector]]


def tabulate(series: Series) -> tuple[tuple[Column, ...], Vector]:
    """Columns, and the table (instants, columns)."""
    columns = tuple(Column(name, description) for name, (description, _) in series.items())
    return columns, np.column_stack([values for _, values in series.values()])


def joint(name: str, child: str, parent: str | None, angle: Vector, rate: Vector, *, in_space: bool = False) -> Series:
    """Angle (n,) rad and rate (n,) rad/s of a hinge, clockwise, in space right-handed; parent None is the ground."""
    what = "below the horizontal" if parent is None else f"relative to {parent}"
    angle_words = f"angle of {child} at {name}, {what}, clockwise positive"
    if in_space:
        angle_words = f"angle of {child} at {name} relative to {parent or 'the ground'}, right-handed about its axis"
    return _turn(name, angle_words, angle, rate)


def ball(name: str, child: str, parent: str | None, angle: Vector, rate: Vector) -> Series:
    """Angle (n,) rad of the rotation of a ball joint from home, and its rate (n,) rad/s."""
    what = f"angle of the rotation of {child} at {name} relative to {parent or 'the ground'}, from home"
    return _turn(name, what, angle, rate)


def _turn(name: str, what: str, angle: Vector, rate: Vector) -> Series:
    return {
        f"{name}_angle_deg": (what, np.degrees(angle)),
        f"{name}_rate_rad_s": (f"rate of {name}_angle", rate),
    }


def slider(name: str, child: str, parent: str | None, position: Vector, speed: Vector) -> Series:
    """Position (n,) m and speed (n,) m/s of a slider."""
    what = f"position of {child} along the axis of {name} in {parent or 'the ground'}"
    return {
        f"{name}_position_m": (what, position),
        f"{name}_speed_m_s": (f"rate of {name}_position", speed),
    }


def drive(joint: str, hinge: bool, force: Vector, power: Vector, *, in_space: bool = False) -> Series:
    """Torque (n,) N m or force (n,) N of a drive, and its power (n,) W."""
    column, what = ("torque_Nm", "torque, clockwise") if hinge else ("force_N", "force, along the axis")
    what = "torque, right-handed about the axis" if hinge and in_space else what
    return {
        f"{joint}_{column}": (f"{what}, of the drive of {joint} on the child", force),
        f"{joint}_power_W": (f"power of the drive of {joint}", power),
    }


def body(name: str, center: Vector, angle: Vector, velocity: Vector, spin: Vector) -> Series:
    """Motion of a body: centre of mass (n, 2) m, its velocity (n, 2) m/s, angle (n,) rad and rate, clockwise."""
    return {
        f"{name}_x_m": (f"horizontal position of the centre of mass of {name}", center[:, 0]),
        f"{name}_y_m": (f"height of the centre of mass of {name}", center[:, 1]),
        f"{name}_orientation_deg": (f"angle of {name} below the horizontal, clockwise positive", np.degrees(angle)),
        f"{name}_vx_m_s": (f"horizontal velocity of the centre of mass of {name}", velocity[:, 0]),
        f"{name}_vy_m_s": (f"upward velocity of the centre of mass of {name}", velocity[:, 1]),
        f"{name}_spin_rad_s": (f"rate of {name}_orientation", spin),
    }


def body_force(name: str, force: Vector, center: Vector) -> Series:
    """Force of the medium on a body, (n, 3) as of `clockwise_moment`; its centre of mass (n, 2) m."""
    fx, fy, _ = force.T
    return {
        f"{name}_granular_x_N": (f"force of the medium on {name}, horizontal", fx),
        f"{name}_granular_y_N": (f"force of the medium on {name}, upward", fy),
        f"{name}_granular_moment_Nm": (
            f"moment of that force about the centre of mass of {name}, clockwise positive",
            clockwise_moment(force, center),
        ),
    }


def body_depth(name: str, depth: Vector) -> Series:
    """Depth (n,) m of a body's deepest point, negative above the surface."""
    return {f"{name}_depth_m": (f"depth of the deepest point of {name} below the surface", depth)}


def tip(place: Vector, mean_rate: Vector | None) -> Series:
    """Place (n, 2) m of the tip; mean rate (n,) rad/s, None for a mechanism that has no pivot."""
    words = "angular momentum over moment of inertia about the pivot, clockwise positive"
    series: Series = {} if mean_rate is None else {"mean_rate_rad_s": (words, mean_rate)}
    series["tip_x_m"] = ("horizontal position of the tip", place[:, 0])
    series["tip_y_m"] = ("height of the tip", place[:, 1])
    return series


def clockwise_moment(wrench: Vector, about: Vector) -> Vector:
    """Moment (n,) N m about points (n, 2) m, or one (2,), clockwise as all of a table turns.

    wrench (n, 3): force x, y (N) and moment about the origin (N m, right-handed: counter-clockwise), as a bed gives it.
    Here alone moments of the results change their sense.
    """
    about = np.asarray(about)
    turned: Vector = about[..., 0] * wrench[:, 1] - about[..., 1] * wrench[:, 0] - wrench[:, 2]
    return turned


def forces(names: tuple[str, ...], terms: Vector, about: Vector, *, at_pivot: bool) -> Series:
    """Forces of the medium: of each named term (n, terms, 3), as of `clockwise_moment`.

    about: the pivot (2,) m, or of a mechanism without one its centre of mass (n, 2) m; at_pivot: which of them.
    """
    series: Series = {}
    column = MOMENT if at_pivot else CENTRAL_MOMENT
    of = "the pivot" if at_pivot else "the centre of mass of the whole mechanism"
    for i, term in enumerate(names):
        fx, fy, _ = terms[:, i].T
        what = f"{term.replace('_', ' ')} force of the medium"
        series[f"{term}_force_x_N"] = (f"{what}, horizontal", fx)
        series[f"{term}_force_y_N"] = (f"{what}, upward", fy)
        words = f"moment of the {what} about {of}, clockwise positive"
        series[f"{term}_{column}"] = (words, clockwise_moment(terms[:, i], about))
    return series


def resultant(results: Results, terms: Sequence[str]) -> Vector:
    """Sum of the forces of some terms of the medium, (2, rows) N, in space (3, rows) N."""
    axes = "xyz" if any(name.endswith("_force_z_N") for name in results.names) else "xy"
    found = [sum((results[f"{term}_force_{axis}_N"] for term in terms), np.zeros(len(results.table))) for axis in axes]
    return np.array(found)
