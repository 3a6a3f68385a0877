"""Columns of the time series, the same for every engine: names, units, descriptions, signs.

Angles, rates and moments are all positive clockwise, so that moment times rate is a power (see models/README.md).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from granular_contact.results import CENTRAL_MOMENT, MOMENT, Column, Results
from granular_contact.values.arrays import Vector

Series = dict[str, tuple[str, Vector]]


def tabulate(series: Series) -> tuple[tuple[Column, ...], Vector]:
    """Return the columns, and the table (instants, columns)."""
    columns = tuple(Column(name, description) for name, (description, _) in series.items())
    return columns, np.column_stack([values for _, values in series.values()])


def joint(name: str, child: str, parent: str | None, angle: Vector, rate: Vector, *, in_space: bool = False) -> Series:
    """Columns of the angle (n,) rad and rate (n,) rad/s of a hinge, clockwise, in space right-handed.

    parent: None for the ground.
    """
    reference = "below the horizontal" if parent is None else f"relative to {parent}"
    description = f"angle of {child} at {name}, {reference}, clockwise positive"
    if in_space:
        description = f"angle of {child} at {name} relative to {parent or 'the ground'}, right-handed about its axis"
    return _turn(name, description, angle, rate)


def ball(name: str, child: str, parent: str | None, angle: Vector, rate: Vector) -> Series:
    """Columns of the angle (n,) rad of the rotation of a ball joint from home, and of its rate (n,) rad/s."""
    description = f"angle of the rotation of {child} at {name} relative to {parent or 'the ground'}, from home"
    return _turn(name, description, angle, rate)


def _turn(name: str, description: str, angle: Vector, rate: Vector) -> Series:
    return {
        f"{name}_angle_deg": (description, np.degrees(angle)),
        f"{name}_rate_rad_s": (f"rate of {name}_angle", rate),
    }


def slider(name: str, child: str, parent: str | None, position: Vector, speed: Vector) -> Series:
    """Columns of the position (n,) m and speed (n,) m/s of a slider."""
    description = f"position of {child} along the axis of {name} in {parent or 'the ground'}"
    return {
        f"{name}_position_m": (description, position),
        f"{name}_speed_m_s": (f"rate of {name}_position", speed),
    }


def drive(joint: str, hinge: bool, force: Vector, power: Vector, *, in_space: bool = False) -> Series:
    """Columns of the torque (n,) N m or force (n,) N of a drive, and of its power (n,) W."""
    column, load = ("torque_Nm", "torque, clockwise") if hinge else ("force_N", "force, along the axis")
    load = "torque, right-handed about the axis" if hinge and in_space else load
    return {
        f"{joint}_{column}": (f"{load}, of the drive of {joint} on the child", force),
        f"{joint}_power_W": (f"power of the drive of {joint}", power),
    }


def body(name: str, center: Vector, angle: Vector, velocity: Vector, spin: Vector) -> Series:
    """Columns of a body's motion: centre of mass (n, 2) m, angle (n,) rad, velocity (n, 2) m/s and rate (n,) rad/s.

    Angle and rate are positive clockwise.
    """
    return {
        f"{name}_x_m": (f"horizontal position of the centre of mass of {name}", center[:, 0]),
        f"{name}_y_m": (f"height of the centre of mass of {name}", center[:, 1]),
        f"{name}_orientation_deg": (f"angle of {name} below the horizontal, clockwise positive", np.degrees(angle)),
        f"{name}_vx_m_s": (f"horizontal velocity of the centre of mass of {name}", velocity[:, 0]),
        f"{name}_vy_m_s": (f"upward velocity of the centre of mass of {name}", velocity[:, 1]),
        f"{name}_spin_rad_s": (f"rate of {name}_orientation", spin),
    }


def body_force(name: str, force: Vector, center: Vector) -> Series:
    """Columns of the medium's force on a body: wrench (n, 3), see `clockwise_moment`; center: its centre of mass."""
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
    """Column of the depth (n,) m of a body's deepest point, negative above the surface."""
    return {f"{name}_depth_m": (f"depth of the deepest point of {name} below the surface", depth)}


def tip(place: Vector, mean_rate: Vector | None) -> Series:
    """Columns of the position (n, 2) m of the tip, and of the mean rate (n,) rad/s; None for a model without pivot."""
    description = "angular momentum over moment of inertia about the pivot, clockwise positive"
    series: Series = {} if mean_rate is None else {"mean_rate_rad_s": (description, mean_rate)}
    series["tip_x_m"] = ("horizontal position of the tip", place[:, 0])
    series["tip_y_m"] = ("height of the tip", place[:, 1])
    return series


def clockwise_moment(wrench: Vector, about: Vector) -> Vector:
    """Moment (n,) N m about points (n, 2) m or one point (2,), positive clockwise as in all results.

    wrench (n, 3): force x, y (N) and moment about the origin (N m, positive counter-clockwise), as the bed computes it.
    The sign of moments changes in this function alone.
    """
    about = np.asarray(about)
    turned: Vector = about[..., 0] * wrench[:, 1] - about[..., 1] * wrench[:, 0] - wrench[:, 2]
    return turned


def forces(names: tuple[str, ...], terms: Vector, about: Vector, *, at_pivot: bool) -> Series:
    """Columns of the named terms of the medium's force: wrenches (n, terms, 3), see `clockwise_moment`.

    about: reference point of moments, the pivot (2,) m if at_pivot, otherwise the centre of mass (n, 2) m.
    """
    series: Series = {}
    column = MOMENT if at_pivot else CENTRAL_MOMENT
    reference = "the pivot" if at_pivot else "the centre of mass of the whole mechanism"
    for i, term in enumerate(names):
        fx, fy, _ = terms[:, i].T
        quantity = f"{term.replace('_', ' ')} force of the medium"
        series[f"{term}_force_x_N"] = (f"{quantity}, horizontal", fx)
        series[f"{term}_force_y_N"] = (f"{quantity}, upward", fy)
        description = f"moment of the {quantity} about {reference}, clockwise positive"
        series[f"{term}_{column}"] = (description, clockwise_moment(terms[:, i], about))
    return series


def resultant(results: Results, terms: Sequence[str]) -> Vector:
    """Sum of the forces of the given terms of the medium, (2, rows) N, in space (3, rows) N."""
    axes = "xyz" if any(name.endswith("_force_z_N") for name in results.names) else "xy"
    zero = np.zeros(len(results.table))
    return np.array([sum((results[f"{term}_force_{axis}_N"] for term in terms), zero) for axis in axes])
