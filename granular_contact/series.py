"""Columns of the time series, the same for every way of solving a scene: names, units, descriptions, signs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.results import Column

Vector = NDArray[np.float64]
Series = dict[str, tuple[str, Vector]]


def tabulate(series: Series) -> tuple[tuple[Column, ...], Vector]:
    """Columns, and the table (instants, columns)."""
    columns = tuple(Column(name, description) for name, (description, _) in series.items())
    return columns, np.column_stack([values for _, values in series.values()])


def joint(name: str, child: str, parent: str | None, angle: Vector, rate: Vector) -> Series:
    """Angle (n,) rad and rate (n,) rad/s of a hinge, clockwise; parent None is the ground."""
    what = "below the horizontal" if parent is None else f"relative to {parent}"
    return {
        f"{name}_angle_deg": (f"angle of {child} at {name}, {what}, clockwise positive", np.degrees(angle)),
        f"{name}_rate_rad_s": (f"rate of {name}_angle", rate),
    }


def shape(mean_rate: Vector, tip: Vector, deflection: Vector | None, depth: Vector | None) -> Series:
    """Mean rate (n,) rad/s, tip (n, 2) m, deflection of the last flexible link (n,) m, depth (n,) m."""
    series: Series = {
        "mean_rate_rad_s": ("angular momentum over moment of inertia about the pivot, clockwise positive", mean_rate),
        "tip_x_m": ("horizontal position of the tip", tip[:, 0]),
        "tip_y_m": ("height of the tip", tip[:, 1]),
    }
    if deflection is not None:
        series["deflection_m"] = ("tip deflection across the axis of the link's root, clockwise positive", deflection)
    if depth is not None:
        series["depth_m"] = ("depth of the deepest end or node below the surface", depth)
    return series


def forces(names: tuple[str, ...], terms: Vector, pivot: Vector) -> Series:
    """Forces of the medium, (n, terms, 3): resultant x, y (N) and moment about the origin (N m) of each named term."""
    series: Series = {}
    for i, term in enumerate(names):
        fx, fy, moment = terms[:, i].T
        what = f"{term.replace('_', ' ')} force of the medium"
        series[f"{term}_force_x_N"] = (f"{what}, horizontal", fx)
        series[f"{term}_force_y_N"] = (f"{what}, upward", fy)
        series[f"{term}_moment_Nm"] = (
            f"moment of the {what} about the pivot, counter-clockwise",
            moment - (pivot[0] * fy - pivot[1] * fx),
        )
    return series


def energies(kinetic: Vector, gravity: Vector, elastic: Vector | None, work: Vector, damping: Vector) -> Series:
    """Energies, and work done by the medium and by internal damping so far, (n,) J each."""
    total = kinetic + gravity
    series: Series = {
        "kinetic_J": ("kinetic energy", kinetic),
        "gravity_J": ("potential energy of gravity, from the start", gravity),
    }
    if elastic is not None:
        series["elastic_J"] = ("strain energy of the flexible links", elastic)
        total = total + elastic
    series["granular_work_J"] = ("work of the medium on the mechanism so far", work)
    series["damping_work_J"] = ("work of the links' internal damping so far", damping)
    series["energy_imbalance_J"] = (
        "energy less what was done by medium and damping, from the start",
        total - work - damping - total[0],
    )
    return series
